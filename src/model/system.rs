//! What a solver sees of a model: a forced system of differential equations with one algebraic unknown and modes.
//!
//! In mode m the states z (n of them) and the algebraic unknown s (the slip rate) obey z' = f(t, z, s), 0 = g(t, z, s).
//! A mode holds while its event function is positive; where it falls to zero the system names the next mode.

use super::continuum::Element;
use crate::effects::Branch;

/// Most differential states a system can have.
pub const MAX_STATES: usize = 8;
/// Most rows that are not affine in one mode: the arm's under a torque law, heat and interface state.
pub const MAX_NONLINEAR: usize = 3;
/// Most columns of parameter derivatives a system can hand out.
pub const MAX_COLUMNS: usize = 48;

/// Which equations hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The interface sticks: s = 0.
    Stick,
    /// The interface slips forwards (the roller runs ahead of the arm): s > 0.
    SlipForward,
    /// The interface slips backwards: s < 0.
    SlipBackward,
    /// No slip interface, the relative speed is positive.
    RateForward,
    /// No slip interface, the relative speed is negative.
    RateBackward,
}

/// Values and Jacobians of f and g at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Evaluation {
    /// f, rates of the states.
    pub f: [f64; MAX_STATES],
    /// df/dz, row per rate.
    pub fz: [[f64; MAX_STATES]; MAX_STATES],
    /// df/ds.
    pub fs: [f64; MAX_STATES],
    /// g, residual of the constraint.
    pub g: f64,
    /// dg/dz.
    pub gz: [f64; MAX_STATES],
    /// dg/ds.
    pub gs: f64,
}

impl Default for Evaluation {
    fn default() -> Self {
        Self {
            f: [0.0; MAX_STATES],
            fz: [[0.0; MAX_STATES]; MAX_STATES],
            fs: [0.0; MAX_STATES],
            g: 0.0,
            gz: [0.0; MAX_STATES],
            gs: 0.0,
        }
    }
}

/// Derivatives of f and g by the columns (lumped coefficients and law parameters).
#[derive(Debug, Clone)]
pub struct ParameterColumns {
    /// df/dp, one array of rates per column.
    pub f: [[f64; MAX_STATES]; MAX_COLUMNS],
    /// dg/dp.
    pub g: [f64; MAX_COLUMNS],
}

/// The known forcing at one instant: angle and angular velocity of the arm without contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct Forcing {
    /// sin(w t).
    pub sine: f64,
    /// cos(w t).
    pub cosine: f64,
    /// Angle without contact \[rad\].
    pub angle: f64,
    /// Angular velocity without contact \[rad/s\].
    pub velocity: f64,
}

/// What of a mode is affine in the states, the algebraic unknown and the forcing, with coefficients that do not change
/// in time: a solver need not look for it by Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Affine {
    /// Rates of the states, row by row.
    pub rows: [bool; MAX_STATES],
    /// The constraint.
    pub constraint: bool,
    /// The margins of the mode.
    pub margins: bool,
}

impl Affine {
    /// Whether everything is.
    pub fn all(&self) -> bool {
        self.constraint && self.margins && self.rows.iter().all(|&row| row)
    }
}

/// A periodically forced system with modes.
pub trait HybridSystem {
    /// Number of differential states.
    fn states(&self) -> usize;
    /// Period of the forcing \[s\].
    fn period(&self) -> f64;
    /// Damping ratio of the least damped oscillation without contact: what the numerical damping has to stay below.
    fn damping_ratio(&self) -> f64;
    /// Magnitude of each state's oscillation, the measure of convergence.
    fn scales(&self) -> [f64; MAX_STATES];
    /// Magnitude of s.
    fn slip_scale(&self) -> f64;
    /// The forcing at time t.
    fn forcing(&self, t: f64) -> Forcing {
        let (sine, cosine) = (std::f64::consts::TAU / self.period() * t).sin_cos();
        self.forcing_at(sine, cosine)
    }
    /// The forcing at the phase with this sine and cosine.
    fn forcing_at(&self, sine: f64, cosine: f64) -> Forcing;
    /// Whether a slope of the rates has a kink within a mode.
    fn is_kinked(&self) -> bool;
    /// Smooth, and zero where that kink is.
    fn kink(&self, forcing: &Forcing, z: &[f64]) -> f64;
    /// Whether the equations of a mode are smooth but for that kink, wherever a motion may take them.
    fn is_smooth(&self) -> bool;
    /// f, g and their Jacobians.
    fn evaluate(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation) {
        const ALL: [usize; MAX_STATES] = [0, 1, 2, 3, 4, 5, 6, 7];
        self.rates(&ALL[..self.states()], forcing, z, s, mode, out);
        self.constraint(forcing, z, s, mode, out);
    }
    /// Some rows of f and their Jacobians alone.
    fn rates(&self, rows: &[usize], forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation);
    /// g and its Jacobian alone.
    fn constraint(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation);
    /// What of a mode is affine.
    fn affine(&self, mode: Mode) -> Affine;
    /// Both positive while the mode holds; scaled so that 1 is large.
    fn margins(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> [f64; 2];
    /// Positive while the mode holds: the smaller margin.
    fn event(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> f64 {
        let [one, other] = self.margins(forcing, z, s, mode);
        one.min(other)
    }
    /// The mode that follows an event, with a first value of s.
    fn next_mode(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> (Mode, f64);
    /// Moves states that the equations cannot hold onto the nearest that they can; returns the state that was moved.
    fn project(&self, forcing: &Forcing, z: &mut [f64]) -> Option<usize>;
    /// The mode at time 0 with a first value of s: the branch that continues `last` (mode and s at the end of the cycle
    /// before), or without one the branch that a cycle started in full motion would be on. Several branches can be
    /// consistent with the same states, so that a periodic motion has to end on the one on which it started.
    fn enter(&self, forcing: &Forcing, z: &[f64], last: Option<(Mode, f64)>) -> (Mode, f64);
    /// Whether a contact in these states, over a roller at rest, would hold the stuck motion for ever: it strengthens
    /// as it rests, and is strong enough already.
    fn locks(&self, z: &[f64]) -> bool;
    /// Over a roller at rest: the state that is the age of a contact that strengthens without bound as it rests, if age
    /// is all that its strength at rest depends on.
    fn age_at_rest(&self) -> Option<usize>;
    /// A first guess of the periodic state at time 0.
    fn initial_state(&self) -> [f64; MAX_STATES];
    /// Deflections under the mean force: what a start taken from a neighbouring problem is measured from.
    fn reference(&self) -> [f64; MAX_STATES];
    /// States that a cycle without slip leaves undetermined, with the value they take from a start at rest.
    /// `None` for the determined ones.
    fn resting_state(&self, z: &[f64]) -> [Option<(f64, [f64; MAX_STATES])>; MAX_STATES];
    /// Whether a cycle without slip can be a steady state at all.
    fn can_rest(&self) -> bool;
    /// Number of columns of parameter derivatives.
    fn columns(&self) -> usize;
    /// Derivatives of f and g by the columns.
    fn parameter_columns(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut ParameterColumns);
    /// Tangential force on the arm and stretch of the bristles.
    fn force(&self, forcing: &Forcing, z: &[f64], s: f64) -> (f64, f64);
}

/// An oscillator x'' = -stiffness x - damping x' + f (arm or support).
#[derive(Debug, Clone, Copy)]
pub struct Linear {
    /// Stiffness over inertia \[1/s^2\].
    pub stiffness: f64,
    /// Damping over inertia \[1/s\].
    pub damping: f64,
}

/// A single mode without a contact: M x'' + C x' + K x = drive + force(x, x') - joint(history of x) - dry friction.
pub trait SingleMode {
    /// M, C and K.
    fn linear(&self) -> [f64; 3];
    /// The drive as Im(drive e^{iwt}) (real, imaginary).
    fn drive(&self) -> (f64, f64);
    /// w \[rad/s\].
    fn omega(&self) -> f64;
    /// Force of the laws with its slopes by x and x'.
    fn force(&self, x: f64, v: f64) -> [f64; 3];
    /// Whether opposite motions of this amplitude have opposite forces of the laws.
    fn is_odd(&self, amplitude: f64) -> bool;
    /// Whether the slopes of the forces of the laws may jump, so that many instants of a cycle have to be looked at.
    fn has_corners(&self) -> bool;
    /// Slip elements to ground, where there are any: stiffness, force at full slip, exponent.
    fn joint(&self) -> Option<[f64; 3]>;
    /// Dry friction against ground; zero where there is none.
    fn dry_friction(&self) -> f64;
    /// Whether its slope by x' has no bound at rest.
    fn is_steep(&self) -> bool;
    /// Adds the derivatives of the force by the parameters of the laws, times `weight`, to `sums`.
    fn add_columns(&self, x: f64, v: f64, weight: f64, sums: &mut [f64]);
    /// Number of these parameters.
    fn columns(&self) -> usize;
    /// Takes note of work that was done on it, in multiplications, about.
    fn spend(&self, _multiplications: usize) {}
    /// Whether more was done on it than a fit spends on a motion.
    fn is_given_up(&self) -> bool {
        false
    }
    /// Multiplications that take as long as its force.
    fn force_cost(&self) -> usize {
        A_FORCE
    }
}

/// Multiplications that a force of the laws takes.
pub const A_FORCE: usize = 20;
/// The same of a power that is not whole, beside it.
pub const A_POWER: usize = 60;

/// Sliders in parallel between the arm and the roller, as pieces: what they share and what each obeys.
pub trait SliderSystem {
    /// Period \[s\].
    fn period(&self) -> f64;
    /// The elements.
    fn elements(&self) -> &[Element];
    /// Forcing at time t.
    fn forcing(&self, t: f64) -> Forcing;
    /// Arm, relative to its motion without contact.
    fn arm(&self) -> Linear;
    /// Acceleration of the arm by the contact force and by torques: (per force, torque acceleration at angle and
    /// speed).
    fn arm_load(&self, forcing: &Forcing, angle: f64, velocity: f64) -> (f64, f64);
    /// The support, and its acceleration per contact force, where there is one.
    fn support(&self) -> Option<(Linear, f64)>;
    /// Relative speed of roller and arm at the arm's relative velocity and the support's velocity.
    fn relative_speed(&self, forcing: &Forcing, velocity: f64, support: f64) -> f64;
    /// (kc, cc, rate of renewal).
    fn bristles(&self) -> [f64; 3];
    /// Stiffness and rate of the viscoelastic branches beside them.
    fn branches(&self) -> &[(f64, f64)];
    /// Their force that depends on the history of their stretch, as [`crate::effects::Effect::hysteresis`]: where it
    /// stands when the stretch has moved by `by`, and its slope; none where there is none.
    fn hysteresis(&self, from: Branch, by: f64) -> Option<(Branch, f64)>;
    /// (gain, rate) of the heating T' = gain F s - rate T; zero where there is none.
    fn heating(&self) -> (f64, f64);
    /// mu N and its slope at slip rate s >= 0, arm angle, interface state and heating.
    fn limit(&self, forcing: &Forcing, angle: f64, s: f64, psi: f64, heat: f64) -> (f64, f64);
    /// Whether that depends neither on the slip rate nor on an interface state.
    fn rate_independent(&self) -> bool;
    /// Interface state: rate at slip rate s is `rate.0 + rate.1 psi`, where there is one.
    fn interface(&self, s: f64) -> Option<(f64, f64)>;
    /// Scales of stroke \[m\] and slip rate \[m/s\].
    fn scale(&self) -> (f64, f64);
    /// Shared states at the start: angle, velocity, support, its velocity, heating; and psi of the sliders.
    fn start(&self) -> ([f64; 5], f64);
    /// Whether the roller is at rest, so that sliders that never slip keep the stretch of a start from rest.
    fn at_rest(&self) -> bool;
    /// Arm displacement per angle \[m\].
    fn lever(&self) -> f64;
    /// Viscous coefficient where the interface is a rate element instead of a slider.
    fn rate_viscosity(&self) -> Option<f64>;
}
