//! The rigs: one oscillator in two ways of stating it, and what is driven and read.
//!
//! Both are M x'' + C x' + K x = drive + q F(contact) with one coordinate x, an angle or a displacement.

use super::parameters::RIG;
use crate::parameter::{Coordinate, ParameterInfo, RIG_PARAMETERS};
use std::f64::consts::TAU;

/// A rig, SI units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Rig {
    /// The rig of the paper (Eqs. 1-8).
    TorsionalArm(TorsionalArm),
    /// Any single mode.
    Oscillator(Oscillator),
}

/// A rigid arm on a torsional spring, pinched by two springs of which an actuator drives one (paper Eqs. 1-8), SI
/// units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TorsionalArm {
    /// J, inertia of the arm about the torsional axis \[kg m^2\].
    pub inertia: f64,
    /// K0, stiffness of the torsional spring \[N m/rad\].
    pub torsional_stiffness: f64,
    /// C0, damping of the torsional spring \[N m s/rad\].
    pub torsional_damping: f64,
    /// k0, stiffness of each translational (pinching) spring \[N/m\].
    pub spring_stiffness: f64,
    /// c0, damping of each translational spring \[N s/m\].
    pub spring_damping: f64,
    /// a, arm of the translational springs \[m\].
    pub spring_arm: f64,
    /// b, arm of the contact \[m\].
    pub contact_arm: f64,
}

/// A single mode M x'' + C x' + K x = drive + q F, SI units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
// Wide: the numbers of one rig, each beside the form in which it was stated.
pub struct Oscillator {
    /// What x is.
    pub coordinate: Coordinate,
    /// How it is driven.
    pub excitation: Excitation,
    /// Whether the reading of a base-driven rig is the motion in space, not that relative to the base.
    pub absolute: bool,
    /// M, mass \[kg\] or inertia \[kg m^2\]; 1 where it is not stated and the drive is known up to a factor.
    pub mass: f64,
    /// Whether M is stated.
    pub mass_stated: bool,
    /// K \[N/m, N m/rad\] or f0 \[Hz\], as it is stated.
    pub elasticity: f64,
    /// Which of the two.
    pub elasticity_form: Elasticity,
    /// C \[N s/m, N m s/rad\], Q or 1/(2Q), as it is stated.
    pub dissipation: f64,
    /// Which of the three.
    pub dissipation_form: Dissipation,
    /// k_s of a drive through a spring, part of K \[N/m, N m/rad\].
    pub spring_stiffness: f64,
    /// c_s of a drive through a spring, part of C \[N s/m, N m s/rad\].
    pub spring_damping: f64,
    /// q, motion at the contact per unit of the coordinate \[-, m/rad\].
    pub contact_factor: f64,
    /// Gamma, modal participation of the base's motion times the mode's shape where it is read: 1 of a mass on a
    /// spring, 1.57 at the tip of a clamped beam (Erturk and Inman 2008).
    pub participation: f64,
}

/// How an oscillator is driven (right-hand side of the equation of motion).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Excitation {
    /// A force or torque f(t).
    Force,
    /// Motion y of the base: -Gamma M y''.
    Base,
    /// Motion u of the end of a spring: k_s u + c_s u'.
    Spring,
}

/// How the stiffness of an oscillator is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Elasticity {
    /// K.
    Stiffness,
    /// f0 = sqrt(K/M)/2 pi.
    NaturalFrequency,
}

/// How the damping of an oscillator is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dissipation {
    /// C.
    Damping,
    /// Q = sqrt(M K)/C.
    QualityFactor,
    /// C/(2 sqrt(M K)).
    DampingRatio,
}

/// A quantity that is set or read at the frequency of the drive: name, symbol, SI unit, and how many times it is the
/// motion (or, of a drive, the motion of base or actuator) differentiated in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Signal {
    /// Name in running text, e.g. `acceleration`.
    pub name: &'static str,
    /// Symbol in figures and sentences.
    pub symbol: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Derivatives in time.
    pub order: u8,
}

impl Signal {
    /// A drive by force.
    pub const FORCE: Self = Self { name: "force", symbol: "F₀", unit: "N", order: 0 };
    /// A drive by torque.
    pub const TORQUE: Self = Self { name: "torque", symbol: "T₀", unit: "N m", order: 0 };
    /// The actuator's displacement, or that of the base.
    pub const DRIVE_DISPLACEMENT: Self = Self { name: "drive", symbol: "u₀", unit: "m", order: 0 };
    /// The rotation of actuator or base.
    pub const DRIVE_ANGLE: Self = Self { name: "drive", symbol: "u₀", unit: "rad", order: 0 };
    /// The acceleration of the base.
    pub const DRIVE_ACCELERATION: Self = Self { name: "base acceleration", symbol: "a₀", unit: "m/s^2", order: 2 };
    /// The angular acceleration of the base.
    pub const DRIVE_ANGULAR_ACCELERATION: Self =
        Self { name: "base acceleration", symbol: "a₀", unit: "rad/s^2", order: 2 };
    /// A drive read in volts; its order is that of the sensitivity's unit.
    pub const DRIVE_VOLTAGE: Self = Self { name: "drive", symbol: "U₀", unit: "V", order: 0 };
    /// An angle.
    pub const ANGLE: Self = Self { name: "angle", symbol: "α", unit: "rad", order: 0 };
    /// An angular velocity.
    pub const ANGULAR_VELOCITY: Self = Self { name: "angular velocity", symbol: "Ω", unit: "rad/s", order: 1 };
    /// An angular acceleration.
    pub const ANGULAR_ACCELERATION: Self =
        Self { name: "angular acceleration", symbol: "A", unit: "rad/s^2", order: 2 };
    /// A displacement.
    pub const DISPLACEMENT: Self = Self { name: "displacement", symbol: "X", unit: "m", order: 0 };
    /// A velocity.
    pub const VELOCITY: Self = Self { name: "velocity", symbol: "v", unit: "m/s", order: 1 };
    /// An acceleration.
    pub const ACCELERATION: Self = Self { name: "acceleration", symbol: "A", unit: "m/s^2", order: 2 };
    /// A reading in volts; its order is that of the sensitivity's unit.
    pub const VOLTAGE: Self = Self { name: "voltage", symbol: "U", unit: "V", order: 0 };

    /// Everything that may be read.
    pub const READINGS: [Self; 7] = [
        Self::ANGLE,
        Self::ANGULAR_VELOCITY,
        Self::ANGULAR_ACCELERATION,
        Self::DISPLACEMENT,
        Self::VELOCITY,
        Self::ACCELERATION,
        Self::VOLTAGE,
    ];
    /// Everything that may drive a rig.
    pub const DRIVES: [Self; 7] = [
        Self::DRIVE_DISPLACEMENT,
        Self::DRIVE_ANGLE,
        Self::DRIVE_ACCELERATION,
        Self::DRIVE_ANGULAR_ACCELERATION,
        Self::FORCE,
        Self::TORQUE,
        Self::DRIVE_VOLTAGE,
    ];

    /// Its column in a table as the reading, in SI.
    pub fn reading_column(&self) -> &'static str {
        match self.unit {
            "m" => "amplitude_m",
            "m/s" => "amplitude_m_s",
            "m/s^2" => "amplitude_m_s2",
            "rad/s" => "amplitude_rad_s",
            "rad/s^2" => "amplitude_rad_s2",
            "V" => "amplitude_v",
            _ => "amplitude_rad",
        }
    }

    /// Its column in a table as the drive, in SI.
    pub fn drive_column(&self) -> &'static str {
        match self.unit {
            "N" => "force_n",
            "N m" => "torque_n_m",
            "m/s^2" => "drive_m_s2",
            "rad" => "drive_rad",
            "rad/s^2" => "drive_rad_s2",
            "V" => "drive_v",
            _ => "drive_m",
        }
    }
}

/// What is driven and what is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Signals {
    /// The drive.
    pub drive: Signal,
    /// The reading.
    pub reading: Signal,
}

impl Signals {
    /// Those of the paper's rig: displacement of the actuator, angle of the arm.
    pub const ARM: Self = Self { drive: Signal::DRIVE_DISPLACEMENT, reading: Signal::ANGLE };

    /// Whether these are those of the paper's rig, which no other has: an actuator's displacement turns nothing but its
    /// arm.
    pub fn of_arm(&self) -> bool {
        *self == Self::ARM
    }
}

impl Oscillator {
    /// K \[N/m, N m/rad\].
    pub fn stiffness(&self) -> f64 {
        match self.elasticity_form {
            Elasticity::Stiffness => self.elasticity,
            Elasticity::NaturalFrequency => self.mass * (TAU * self.elasticity).powi(2),
        }
    }

    /// C \[N s/m, N m s/rad\].
    pub fn damping(&self) -> f64 {
        let critical = (self.mass * self.stiffness()).sqrt();
        match self.dissipation_form {
            Dissipation::Damping => self.dissipation,
            Dissipation::QualityFactor => critical / self.dissipation,
            Dissipation::DampingRatio => 2.0 * critical * self.dissipation,
        }
    }
}

impl Rig {
    /// The paper's arm.
    ///
    /// # Panics
    /// Of another rig: for checks on the paper's own.
    pub fn arm(&self) -> &TorsionalArm {
        match self {
            Self::TorsionalArm(arm) => arm,
            Self::Oscillator(_) => unreachable!("asked of the paper's rig only"),
        }
    }

    /// The paper's arm, to be changed.
    ///
    /// # Panics
    /// Of another rig: for checks on the paper's own.
    pub fn arm_mut(&mut self) -> &mut TorsionalArm {
        match self {
            Self::TorsionalArm(arm) => arm,
            Self::Oscillator(_) => unreachable!("asked of the paper's rig only"),
        }
    }

    /// Whether this is the paper's kind of rig.
    pub fn is_arm(&self) -> bool {
        matches!(self, Self::TorsionalArm(_))
    }

    /// What the coordinate is.
    pub fn coordinate(&self) -> Coordinate {
        match self {
            Self::TorsionalArm(_) => Coordinate::Angle,
            Self::Oscillator(oscillator) => oscillator.coordinate,
        }
    }

    /// What is driven and read where no table says otherwise.
    pub fn signals(&self) -> Signals {
        let Self::Oscillator(oscillator) = self else { return Signals::ARM };
        let angle = oscillator.coordinate == Coordinate::Angle;
        let drive = match (oscillator.excitation, angle) {
            (Excitation::Force, false) => Signal::FORCE,
            (Excitation::Force, true) => Signal::TORQUE,
            (_, false) => Signal::DRIVE_DISPLACEMENT,
            (_, true) => Signal::DRIVE_ANGLE,
        };
        Signals { drive, reading: if angle { Signal::ANGLE } else { Signal::DISPLACEMENT } }
    }

    /// Motion at the contact per unit of the coordinate.
    pub fn lever(&self) -> f64 {
        match self {
            Self::TorsionalArm(arm) => arm.contact_arm,
            Self::Oscillator(oscillator) => oscillator.contact_factor,
        }
    }

    /// Its parameters with their places among [`RIG_PARAMETERS`]; those that play no part in it are left out.
    pub fn parameters(&self) -> Vec<(usize, &'static ParameterInfo)> {
        let Self::Oscillator(oscillator) = self else { return RIG.iter().enumerate().collect() };
        let angle = oscillator.coordinate == Coordinate::Angle;
        let spring = oscillator.excitation == Excitation::Spring;
        let all = [
            oscillator.mass_stated.then_some(if angle { "inertia" } else { "mass" }),
            Some(match oscillator.elasticity_form {
                Elasticity::Stiffness => "stiffness",
                Elasticity::NaturalFrequency => "natural_frequency",
            }),
            Some(match oscillator.dissipation_form {
                Dissipation::Damping => "damping",
                Dissipation::QualityFactor => "quality_factor",
                Dissipation::DampingRatio => "damping_ratio",
            }),
            spring.then_some("spring_stiffness"),
            spring.then_some("spring_damping"),
            (oscillator.contact_factor != 0.0).then_some("contact_factor"),
            // Of a relative reading it is the gain.
            oscillator.absolute.then_some("participation"),
        ];
        let infos = super::parameters::oscillator(oscillator.coordinate);
        let named = |key: &str| infos.iter().find(|info| info.key == key);
        all.into_iter().enumerate().filter_map(|(at, key)| Some((at, named(key?)?))).collect()
    }

    /// Value number `at`, as it is stated.
    pub fn slot(&mut self, at: usize) -> Option<&mut f64> {
        match self {
            Self::TorsionalArm(rig) => Some(match at {
                0 => &mut rig.inertia,
                1 => &mut rig.torsional_stiffness,
                2 => &mut rig.torsional_damping,
                3 => &mut rig.spring_stiffness,
                4 => &mut rig.spring_damping,
                5 => &mut rig.spring_arm,
                6 => &mut rig.contact_arm,
                _ => return None,
            }),
            Self::Oscillator(rig) => Some(match at {
                0 => &mut rig.mass,
                1 => &mut rig.elasticity,
                2 => &mut rig.dissipation,
                3 => &mut rig.spring_stiffness,
                4 => &mut rig.spring_damping,
                5 => &mut rig.contact_factor,
                6 => &mut rig.participation,
                _ => return None,
            }),
        }
    }

    /// All values in order; zero where there is none.
    pub fn values(&self) -> [f64; RIG_PARAMETERS] {
        let mut rig = *self;
        std::array::from_fn(|at| rig.slot(at).map_or(0.0, |value| *value))
    }
}
