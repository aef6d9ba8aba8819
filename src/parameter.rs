//! What is known of a number of the model: key, symbol, unit, bounds, scale, and its place among all parameters.

/// Most parameters that a rig has.
pub const RIG_PARAMETERS: usize = 7;
/// Index of the first parameter of the contact, after those of the rig.
pub const FIRST_CONTACT_PARAMETER: usize = RIG_PARAMETERS;
/// Index of the first parameter of the instrument.
pub const FIRST_INSTRUMENT_PARAMETER: usize = FIRST_CONTACT_PARAMETER + 3;
/// Index of the first number of the operating point: speed, load, drive.
pub const FIRST_OPERATING_PARAMETER: usize = FIRST_INSTRUMENT_PARAMETER + 3;
/// Index of the first effect parameter among the parameters of a model.
pub const FIRST_EFFECT_PARAMETER: usize = FIRST_OPERATING_PARAMETER + 3;

/// Values that are positive, however small or large the rig.
pub const POSITIVE: (f64, f64) = (f64::MIN_POSITIVE, f64::MAX);
/// Values that are zero or more.
pub const ZERO_OR_MORE: (f64, f64) = (0.0, f64::MAX);
/// Values of either sign.
pub const ANY: (f64, f64) = (-f64::MAX, f64::MAX);

/// What the coordinate of an oscillator is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coordinate {
    /// A displacement \[m\].
    Displacement,
    /// An angle \[rad\].
    Angle,
}

/// A parameter of an effect, of the rig, the contact or the instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
// Wide: what a list of parameters says of one; constructors state the usual cases.
pub struct ParameterInfo {
    /// Key inside its table, e.g. `beta`, `torsional_stiffness`.
    pub key: &'static str,
    /// Symbol of the equations, e.g. `β`, `K₀`.
    pub symbol: &'static str,
    /// SI unit in the notation of scenario files, e.g. `N m/rad`; `1` for pure numbers.
    pub unit: &'static str,
    /// Smallest value that is physical.
    pub minimum: f64,
    /// Largest value that is physical.
    pub maximum: f64,
    /// Magnitudes that a search should cover on the paper's rig, the smaller may be 0; `None` where the catalogue gives
    /// none.
    pub range: Option<(f64, f64)>,
    /// What magnitudes are measured in on any other rig.
    pub measure: Measure,
    /// Magnitudes, in units of that measure, that a search should cover on a rig without a contact, where it differs.
    pub alone: Option<(f64, f64)>,
    /// Whether a search should try both signs.
    pub signed: bool,
    /// Whether it is a relative change, of which zero is the middle: one more than it is a magnitude.
    pub change: bool,
    /// Whether it only says at what the others are stated: a search keeps it at the size of its measure.
    pub held: bool,
    /// One phrase of meaning.
    pub meaning: &'static str,
}

impl ParameterInfo {
    /// A parameter of an effect: (key, symbol, unit), physical limits, range of a search, meaning.
    pub const fn searched(
        (key, symbol, unit): (&'static str, &'static str, &'static str),
        (minimum, maximum): (f64, f64),
        range: (f64, f64),
        meaning: &'static str,
    ) -> Self {
        Self {
            key,
            symbol,
            unit,
            minimum,
            maximum,
            range: Some(range),
            measure: Measure::Number,
            alone: None,
            signed: false,
            change: false,
            held: false,
            meaning,
        }
    }

    /// The same, its magnitude in this measure.
    pub const fn in_units_of(self, measure: Measure) -> Self {
        Self { measure, ..self }
    }

    /// The same, on a rig without a contact searched over these multiples of its measure.
    pub const fn alone(self, low: f64, high: f64) -> Self {
        Self { alone: Some((low, high)), ..self }
    }

    /// Magnitudes that a search should cover on a rig of these scales.
    pub fn search_range(&self, scales: &Scales) -> (f64, f64) {
        if let Some((low, high)) = self.alone.filter(|_| !scales.has_contact) {
            let size = self.measure.size(scales);
            return (low * size, high * size);
        }
        let (low, high) = self.range.unwrap_or((self.minimum.abs(), self.maximum));
        // The ranges of the catalogue are those of the paper's rig: for it this is one.
        let times = self.measure.size(scales) / self.measure.size(&Scales::PAPER);
        (low * times, high * times)
    }

    /// The same, of either sign.
    pub const fn either_sign(self) -> Self {
        Self { signed: true, ..self }
    }

    /// The same, a relative change.
    pub const fn of_change(self) -> Self {
        Self { change: true, signed: true, ..self }
    }

    /// The same, which no fit moves.
    pub const fn held(self) -> Self {
        Self { held: true, ..self }
    }

    /// Its unit on a rig with that coordinate: the catalogue states effects of the rig for an angle.
    pub fn unit_for(&self, coordinate: Coordinate) -> &'static str {
        match (coordinate, self.unit) {
            (Coordinate::Displacement, "N m") => "N",
            (Coordinate::Displacement, "rad") => "m",
            (Coordinate::Displacement, "N m/rad") => "N/m",
            (Coordinate::Displacement, "N m s/rad") => "N s/m",
            (Coordinate::Displacement, "N m/rad^2") => "N/m^2",
            (Coordinate::Displacement, "N m s^2/rad^2") => "N s^2/m^2",
            (Coordinate::Displacement, "N m/rad^3") => "N/m^3",
            (Coordinate::Displacement, "N m/rad^5") => "N/m^5",
            (Coordinate::Displacement, "rad/s") => "m/s",
            (Coordinate::Displacement, "rad/(N m)") => "m/N",
            (Coordinate::Displacement, "rad/(N m s^2)") => "m/(N s^2)",
            (_, unit) => unit,
        }
    }

    /// The same on a rig with that coordinate.
    pub fn on(&self, coordinate: Coordinate) -> Self {
        Self { unit: self.unit_for(coordinate), ..*self }
    }
}

/// The quantity in which magnitudes of a parameter are measured, so that a range holds for a rig of any size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// A number of no dimension.
    Number,
    /// 1/w0.
    Time,
    /// Speed of the motion at the contact; where a roller turns, its mean with that of the roller on a logarithmic
    /// scale.
    Speed,
    /// One over that speed.
    Slowness,
    /// Travel in 1/w0 at that speed.
    Travel,
    /// Largest motion at the contact without it.
    Stroke,
    /// Force of the bristles' stiffness at that stretch.
    StrokeForce,
    /// Stiffness of the bristles.
    ContactStiffness,
    /// Damping whose force at w0 is that of the bristles' stiffness.
    ContactDamping,
    /// Mass that the bristles' stiffness carries at w0.
    ContactMass,
    /// Power of friction at that speed.
    Power,
    /// Q.
    Quality,
    /// 1/Q.
    Loss,
    /// Cubic stiffness that bends a resonance by its width; beside a contact, one as strong as the stiffness at the
    /// deflection under friction.
    Cubic,
    /// Quadratic stiffness that bends a resonance by its width; beside a contact, one as strong as the stiffness at the
    /// deflection under friction.
    Even,
    /// The same of the fifth power.
    Quintic,
    /// Quadratic damping as strong as the linear one.
    Quadratic,
    /// Stiffness that moves the resonance by its width.
    Stiffness,
    /// Force that the drive has at resonance.
    Force,
    /// Median load.
    Load,
    /// Largest motion without contact.
    Motion,
    /// Its speed at w0.
    Rate,
    /// 1/K.
    Compliance,
    /// w0^2/K.
    InverseMass,
}

/// Sizes of a rig and its motion, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
// Wide: the sizes that ranges are measured in, of which an effect takes one or two.
pub struct Scales {
    /// w0 \[rad/s\].
    pub omega: f64,
    /// Q \[-\].
    pub quality: f64,
    /// K \[N/m, N m/rad\].
    pub stiffness: f64,
    /// Largest motion without contact \[m, rad\].
    pub motion: f64,
    /// q, motion at the contact per unit of the coordinate.
    pub lever: f64,
    /// kc \[N/m\].
    pub contact_stiffness: f64,
    /// mu W at the median load \[N\].
    pub friction_force: f64,
    /// Median load \[N\].
    pub load: f64,
    /// Largest speed of the roller \[m/s\]; 0 where none turns.
    pub roller_speed: f64,
    /// Whether there is a contact.
    pub has_contact: bool,
    /// Number of the series that were measured.
    pub series: usize,
    /// Median distance of neighbouring frequencies of a series \[rad/s\]; 0 where none was measured.
    pub spacing: f64,
}

impl Scales {
    /// The paper's rig at the conditions for which the ranges of the catalogue are stated: 20 N, rollers up to 0.1 m/s,
    /// drives up to 7.5 um.
    pub const PAPER: Self = Self {
        omega: 451.3978289712967,
        quality: 4.997761613942612,
        stiffness: 1018.8,
        motion: 1.860340336305119e-5,
        lever: 0.06,
        contact_stiffness: 8.9e4,
        friction_force: 10.0,
        load: 20.0,
        roller_speed: 0.1,
        has_contact: true,
        series: 0,
        spacing: 0.0,
    };

    /// Deflection under friction, or the motion where it is larger.
    fn deflection(&self) -> f64 {
        (self.lever * self.friction_force / self.stiffness).max(self.motion)
    }

    /// Speed of the motion at the contact, and of the roller where it turns.
    fn speed(&self) -> f64 {
        let moving = self.lever * self.motion * self.omega;
        if self.roller_speed > 0.0 { (moving * self.roller_speed).sqrt() } else { moving }
    }
}

impl Measure {
    /// Its size for a rig.
    pub fn size(self, of: &Scales) -> f64 {
        match self {
            Self::Number => 1.0,
            Self::Time => 1.0 / of.omega,
            Self::Speed => of.speed(),
            Self::Slowness => 1.0 / of.speed(),
            Self::Travel => of.speed() / of.omega,
            Self::Stroke => of.lever * of.motion,
            Self::StrokeForce => of.contact_stiffness * of.lever * of.motion,
            Self::ContactStiffness => of.contact_stiffness,
            Self::ContactDamping => of.contact_stiffness / of.omega,
            Self::ContactMass => of.contact_stiffness / of.omega.powi(2),
            Self::Power => of.friction_force * of.speed(),
            Self::Quality => of.quality,
            Self::Loss => 1.0 / of.quality,
            Self::Cubic if of.has_contact => of.stiffness / of.deflection().powi(2),
            Self::Even if of.has_contact => of.stiffness / of.deflection(),
            Self::Quintic if of.has_contact => of.stiffness / of.deflection().powi(4),
            // Its bend is that of a cubic stiffness of -10/9 K2^2/K.
            Self::Even => of.stiffness / (of.quality.sqrt() * of.motion),
            Self::Quintic => of.stiffness / (of.quality * of.motion.powi(4)),
            Self::Cubic => of.stiffness / (of.quality * of.motion.powi(2)),
            Self::Quadratic => of.stiffness / (of.quality * of.omega.powi(2) * of.motion),
            Self::Stiffness => of.stiffness / of.quality,
            Self::Force => of.stiffness * of.motion / of.quality,
            Self::Load => of.load,
            Self::Motion => of.motion,
            Self::Rate => of.motion * of.omega,
            Self::Compliance => 1.0 / of.stiffness,
            Self::InverseMass => of.omega.powi(2) / of.stiffness,
        }
    }
}
