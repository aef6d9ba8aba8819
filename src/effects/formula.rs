//! A user's own effect: one expression of a scenario, read once and evaluated with its derivatives.

mod expression;
mod program;
mod statement;
mod tried;

pub use expression::{Blame, FUNCTIONS, Fault, PI};
pub use program::PARAMETERS;
pub use statement::{ActsOn, Stated, Statement};

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::{ANY, Scales};
use expression::parse;
use program::{Program, Shape, VARIABLES};
use std::ops::Range;
use std::sync::Mutex;
use tried::Tried;

/// A stated number that is no strength is searched within this factor: its order of magnitude is known.
const STATED: f64 = 10.0;
/// Strengths that a search covers, in units of one as strong as what the law stands beside: of a force without a
/// contact those of the catalogue's stiffnesses, which are in units of a bend by the width of the resonance; of a force
/// beside a contact those of its cubic stiffness on the paper's rig; of friction and of the bristles those of its laws
/// and its viscoelastic branch.
const ALONE: (f64, f64) = (0.01, 1000.0);
const BESIDE_CONTACT: (f64, f64) = (1e-5, 300.0);
const OF_FRICTION: (f64, f64) = (2e-3, 2.0);
const OF_BRISTLES: (f64, f64) = (1e-2, 10.0);

/// A formula that has been read and tried.
pub struct Formula {
    statement: Statement,
    name: &'static str,
    title: &'static str,
    equation: &'static str,
    infos: &'static [ParameterInfo],
    zero: &'static [Zero],
    program: Program,
    shape: Shape,
    corner_at_rest: bool,
}

impl Formula {
    /// The effect that a scenario states; the same statement is always the same effect.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn new(statement: Statement) -> Result<&'static Self, Fault> {
        static KNOWN: Mutex<Vec<&'static Formula>> = Mutex::new(Vec::new());
        let mut known = KNOWN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // Of a strength it does not matter how large it is.
        let same = |own: &Stated, other: &Stated, index: usize, formula: &Formula| {
            let strength = formula.zero.iter().any(|zero| zero.parameter == index);
            own.key == other.key
                && own.unit == other.unit
                && own.range == other.range
                && (strength || own.value == other.value)
        };
        let found = known.iter().copied().find(|formula| {
            let own = &formula.statement;
            (&own.name, &own.text, own.acts_on) == (&statement.name, &statement.text, statement.acts_on)
                && own.parameters.len() == statement.parameters.len()
                && own
                    .parameters
                    .iter()
                    .zip(&statement.parameters)
                    .enumerate()
                    .all(|(index, (own, other))| same(own, other, index, formula))
        });
        if let Some(formula) = found {
            return Ok(formula);
        }
        let formula: &'static Self = Box::leak(Box::new(Self::read(statement)?));
        known.push(formula);
        Ok(formula)
    }

    /// The formula of a statement, read and tried.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(statement: Statement) -> Result<Self, Fault> {
        let steps = parse(&statement.text)?;
        statement.check_names(&steps)?;
        let variables = statement.acts_on.variables();
        let number = |span: &Range<usize>| {
            let name = &statement.text[span.clone()];
            let parameter = || statement.parameters.iter().position(|p| p.key == name).unwrap_or(0);
            variables.iter().position(|variable| *variable == name).unwrap_or_else(|| VARIABLES + parameter())
        };
        let Some(program) = Program::new(&steps, number) else {
            let title = "the formula keeps too many intermediate results";
            return Err(statement.fault(title, "too deeply nested", "write it with fewer brackets, or as two effects"));
        };
        let tried = Tried { statement: &statement, program: &program };
        tried.check_finite()?;
        let zero = tried.zero()?;
        tried.check_ranges(&zero)?;
        let info = |stated: &Stated| {
            let key: &'static str = stated.key.clone().leak();
            let signed = stated.range.is_none_or(|(.., signed)| signed);
            ParameterInfo {
                key,
                symbol: key,
                unit: stated.unit.clone().leak(),
                minimum: ANY.0,
                maximum: ANY.1,
                range: None,
                measure: Measure::Number,
                alone: None,
                signed,
                change: false,
                meaning: "parameter of the formula",
                held: false,
            }
        };
        let of = match statement.acts_on {
            ActsOn::Force => "force",
            ActsOn::Friction => "term of μ",
            ActsOn::ContactForce => "force of the bristles",
        };
        let equation = format!("{of} {}", statement.text.split_whitespace().collect::<Vec<_>>().join(" "));
        let mut infos: Vec<ParameterInfo> = statement.parameters.iter().map(info).collect();
        for (index, info) in infos.iter_mut().enumerate() {
            let strength = zero.iter().any(|zero| zero.parameter == index);
            let stated = &statement.parameters[index];
            info.signed &= strength || stated.range.is_some() || stated.value < 0.0;
            info.meaning = if strength { format!("strength of the {equation}").leak() } else { info.meaning };
        }
        Ok(Self {
            name: statement.name.clone().leak(),
            title: format!("Formula of the scenario: {}", statement.name).leak(),
            equation: equation.leak(),
            infos: infos.leak(),
            zero: zero.leak(),
            shape: program.shape(),
            corner_at_rest: tried.jumps(1, |jet| jet[2]),
            program,
            statement,
        })
    }

    /// Whether nothing is left of it at these values of its parameters.
    pub fn vanishes(&self, parameters: &[f64]) -> bool {
        self.zero.iter().all(|zero| parameters.get(zero.parameter) == Some(&0.0))
    }

    /// Whether its slope jumps, or has no bound, where the second variable changes sign.
    pub fn has_corner_at_rest(&self) -> bool {
        self.corner_at_rest
    }

    /// Values of its parameters with which it is tried.
    pub fn nominal(&self) -> Vec<f64> {
        self.tried().nominal()
    }

    fn law(&self, acts_on: ActsOn, p: &[f64], variables: [f64; VARIABLES]) -> Option<Law> {
        (self.statement.acts_on == acts_on).then(|| {
            let [value, d_first, d_second, d_parameters @ ..] = self.program.jet(&variables, p);
            Law { value, d_first, d_second, d_parameters }
        })
    }

    fn tried(&self) -> Tried<'_> {
        Tried { statement: &self.statement, program: &self.program }
    }
}

impl Effect for Formula {
    fn name(&self) -> &'static str {
        self.name
    }
    fn title(&self) -> &'static str {
        self.title
    }
    fn group(&self) -> Group {
        match self.statement.acts_on {
            ActsOn::Force => Group::RigAndInstrument,
            ActsOn::Friction => Group::Interface,
            ActsOn::ContactForce => Group::Contact,
        }
    }
    fn equation(&self) -> &'static str {
        self.equation
    }
    fn meaning(&self) -> &'static str {
        "A formula that the scenario states."
    }
    fn source(&self) -> &'static str {
        "The scenario."
    }
    fn fingerprint(&self) -> &'static str {
        "Not known beforehand."
    }
    fn zero(&self) -> &'static [Zero] {
        self.zero
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        self.infos
    }

    fn search_range(&self, index: usize, scales: &Scales) -> (f64, f64) {
        let stated = &self.statement.parameters[index];
        if let Some((low, high, _)) = stated.range {
            return (low, high);
        }
        let value = if stated.value == 0.0 { 1.0 } else { stated.value.abs() };
        if !self.zero.iter().any(|zero| zero.parameter == index) {
            return (value / STATED, value * STATED);
        }
        let (speed, travel) = (Measure::Speed.size(scales), Measure::Travel.size(scales));
        let deflection = (scales.lever * scales.friction_force / scales.stiffness).max(scales.motion);
        let moving = scales.omega * scales.motion;
        let ((low, high), reference, amplitudes) = match self.statement.acts_on {
            ActsOn::Force if scales.has_contact => {
                (BESIDE_CONTACT, scales.stiffness * deflection, [deflection, moving])
            }
            ActsOn::Force => (ALONE, scales.stiffness * scales.motion / scales.quality, [scales.motion, moving]),
            ActsOn::Friction => (OF_FRICTION, 1.0, [speed, 0.0]),
            ActsOn::ContactForce => (OF_BRISTLES, scales.contact_stiffness * travel, [travel, speed]),
        };
        match self.tried().sizes(index, self.zero, amplitudes) {
            Some((least, most)) => (low * reference / most, high * reference / least),
            None => (value / STATED.powi(3), value * STATED.powi(3)),
        }
    }

    fn formula(&self) -> Option<&Formula> {
        Some(self)
    }

    fn friction(&self, p: &[f64], s: f64, _psi: f64) -> Option<Law> {
        self.law(ActsOn::Friction, p, [s, 0.0])
    }
    fn torque(&self, p: &[f64], th: f64, w: f64) -> Option<Law> {
        self.law(ActsOn::Force, p, [th, w])
    }
    fn torque_is_kinked(&self) -> bool {
        self.statement.acts_on == ActsOn::Force && self.shape.kinked_at_rest
    }
    fn is_smooth(&self) -> bool {
        self.shape.smooth_elsewhere
    }
    fn torque_is_odd(&self) -> bool {
        self.shape.odd
    }
    fn bristle_force(&self, p: &[f64], stretch: f64, rate: f64) -> Option<Law> {
        self.law(ActsOn::ContactForce, p, [stretch, rate])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(key: &str, value: f64) -> Stated {
        Stated { key: key.into(), unit: "1".into(), value, range: None }
    }

    fn read(acts_on: ActsOn, text: &str, parameters: &[(&str, f64)]) -> Result<&'static Formula, Fault> {
        let parameters = parameters.iter().map(|(key, value)| stated(key, *value)).collect();
        Formula::new(Statement { name: "own".into(), text: text.into(), acts_on, parameters })
    }

    fn refused(acts_on: ActsOn, text: &str, parameters: &[(&str, f64)]) -> String {
        match read(acts_on, text, parameters) {
            Ok(_) => panic!("{text} was accepted"),
            Err(fault) => format!("{}: {}", fault.title, fault.label),
        }
    }

    #[test]
    fn a_statement_is_one_effect_whatever_its_strength() {
        let of = |k: f64, p: f64| read(ActsOn::Force, "-k*sign(v)*abs(v)^p", &[("k", k), ("p", p)]).expect("sound");
        assert!(std::ptr::eq(of(0.0, 1.5), of(3.0, 1.5)));
        assert!(!std::ptr::eq(of(0.0, 1.5), of(0.0, 1.4)));
        assert!(of(0.0, 1.5).vanishes(&[0.0, 1.5]) && !of(0.0, 1.5).vanishes(&[1.0, 1.5]));
    }

    #[test]
    fn what_is_no_law_is_refused() {
        use ActsOn::{ContactForce, Force, Friction};
        let k = &[("k", 0.0)];
        for (acts_on, text, words) in [
            (Force, "k*sqrt(x)", "not finite"),
            (Force, "k*ln(v)", "not finite"),
            (Force, "k/x", "not finite"),
            (Force, "k*x^0.5", "not finite"),
            (Force, "-k*sign(v)", "jumps where v"),
            (ContactForce, "k*stretch/abs(stretch_rate)", "not finite"),
            (Friction, "k*ln(s)", "not finite"),
            (Force, "x + k", "no strength"),
            (Force, "k*(x - x)", "always zero"),
            (Force, "tanh(k*x)", "not in proportion"),
            (Force, "k*s", "unknown name `s`"),
            (Friction, "k*x", "unknown name `x`"),
        ] {
            let told = refused(acts_on, text, k);
            assert!(told.contains(words), "{text}: {told}");
        }
        assert!(refused(Force, "k*x", &[("k", 1.0), ("c", 1.0)]).contains("`c` does not occur"));
        assert!(refused(Force, "k*x", &[("k", 1.0), ("x", 1.0)]).contains("name of a variable"));
        assert!(refused(Force, "exp*x", &[("exp", 1.0)]).contains("lacks its argument"));
        assert!(refused(Force, "k*pi*x", &[("k", 1.0), ("pi", 1.0)]).contains("every formula knows"));
        assert!(refused(Force, "-3*x^5", &[]).contains("no parameter"));
        assert!(refused(Force, "k*abs(v)^p*v", &[("k", 1.0), ("p", 0.0)]).contains("how large `p`"));
        let five = ["a", "b", "c", "d", "e"].map(|key| (key, 1.0));
        assert!(refused(Force, "a*x*b*c*d*e", &five).contains("at most 4"));
    }

    #[test]
    fn what_ends_far_out_is_a_law_where_it_does_not() {
        let far = [("-k*ln(1 - x/g)", 1e-5), ("k*exp(abs(v)/g) - k", 1e-4)];
        for (text, size) in far {
            let own = read(ActsOn::Force, text, &[("k", 1.0), ("g", size)]).unwrap_or_else(|fault| panic!("{fault:?}"));
            assert_eq!(own.zero(), [Zero { parameter: 0, value: 0.0 }], "{text}");
        }
    }

    #[test]
    fn a_slope_that_jumps_at_rest_is_a_corner() {
        let corner = |text| {
            let read = read(ActsOn::Force, text, &[("k", 1.0)]);
            read.unwrap_or_else(|fault| panic!("{fault:?}")).has_corner_at_rest()
        };
        assert!(corner("k*abs(v)") && corner("-k*x*abs(v)") && corner("-k*sign(v)*abs(v)^0.5"));
        assert!(!corner("-k*v*abs(v)") && !corner("-k*abs(x)") && !corner("-k*sign(v)*abs(v)^1.5"));
    }

    #[test]
    fn several_strengths_vanish_together() {
        let both = read(ActsOn::Force, "-a*x^2 - b*v", &[("a", 0.0), ("b", 0.0)]).expect("sound");
        assert_eq!(both.zero().iter().map(|zero| zero.parameter).collect::<Vec<_>>(), [0, 1]);
        let one = read(ActsOn::Friction, "d*exp(-s/w)", &[("d", 0.0), ("w", 0.1)]).expect("sound");
        assert_eq!(one.zero().iter().map(|zero| zero.parameter).collect::<Vec<_>>(), [0]);
    }

    #[test]
    fn ranges_from_the_data_are_those_of_the_catalogue() {
        let scales = Scales { has_contact: false, ..Scales::PAPER };
        let cubic = super::super::find("cubic-stiffness").expect("registered");
        let own = read(ActsOn::Force, "-k*x^3", &[("k", 0.0)]).expect("sound");
        let ((a, b), (c, d)) = (own.search_range(0, &scales), cubic.search_range(0, &scales));
        assert!((a / c - 1.0).abs() < 1e-9 && (b / d - 1.0).abs() < 1e-9, "{a} {b} for {c} {d}");
        let larger = Scales { motion: 10.0 * scales.motion, ..scales };
        assert!((own.search_range(0, &larger).0 / a - 0.01).abs() < 1e-9);
    }
}
