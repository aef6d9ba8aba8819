//! A user's own effect: one expression of a scenario, read once and evaluated with its derivatives.

mod expression;
mod program;

pub use expression::{Blame, FUNCTIONS, Fault, PI};
pub use program::PARAMETERS;

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::{ANY, Scales};
use expression::{Step, parse};
use program::{Jet, Program, Shape, VARIABLES};
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Mutex;
use strsim::osa_distance;

/// Magnitudes of the variables at which a formula is tried, in SI; at the first two it has to be finite whatever the
/// rig, beyond them an exponential may overflow.
const TRIED: [f64; 5] = [0.0, 1e-9, 1e-6, 1e-3, 1.0];
const NEAR: f64 = 1e-9;
/// Phases of an oscillation at which a force is looked at.
const PHASES: usize = 16;
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

/// What a formula is a term of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The force or torque on the coordinate.
    Force,
    /// The friction coefficient.
    Friction,
    /// The force of the bristles.
    ContactForce,
}

impl ActsOn {
    /// All of them with their words in a scenario.
    pub const ALL: [(&'static str, Self); 3] =
        [("force", Self::Force), ("friction", Self::Friction), ("contact-force", Self::ContactForce)];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, one)| *one == self).map_or("", |(word, _)| word)
    }

    /// The variables of its formulas.
    pub fn variables(self) -> &'static [&'static str] {
        match self {
            Self::Force => &["x", "v"],
            Self::Friction => &["s"],
            Self::ContactForce => &["stretch", "stretch_rate"],
        }
    }
}

/// A parameter as a scenario states it; SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Its name.
    pub key: String,
    /// Its SI unit; `1` where it is stated in bare numbers.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Magnitudes that a search should cover, and whether of either sign.
    pub range: Option<(f64, f64, bool)>,
}

/// A formula as a scenario states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Name of the effect.
    pub name: String,
    /// The expression.
    pub text: String,
    /// What it is a term of.
    pub acts_on: ActsOn,
    /// Its parameters.
    pub parameters: Vec<Stated>,
}

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

impl Statement {
    fn fault(&self, title: &str, label: &str, help: &str) -> Fault {
        let blame = Blame::Text(0..self.text.len());
        Fault { blame, title: title.into(), label: label.into(), help: help.into() }
    }

    /// Whether every name means something, and every parameter occurs.
    fn check_names(&self, steps: &[Step]) -> Result<(), Fault> {
        let variables = self.acts_on.variables();
        let parameter = |index: usize, title: String, label: &str, help: &str| {
            Err(Fault { blame: Blame::Parameter(index), title, label: label.into(), help: help.into() })
        };
        for (index, stated) in self.parameters.iter().enumerate() {
            let key = stated.key.as_str();
            if variables.contains(&key) || key == PI || FUNCTIONS.iter().any(|(name, ..)| *name == key) {
                let what = if variables.contains(&key) { "a variable" } else { "a name that every formula knows" };
                let title = format!("the parameter `{key}` has the name of {what}");
                return parameter(index, title, "taken", "give the parameter another name, here and in the formula");
            }
        }
        let names = || steps.iter().filter_map(|step| if let Step::Name(span) = step { Some(span) } else { None });
        for span in names() {
            let name = &self.text[span.clone()];
            let known = || variables.iter().copied().chain(self.parameters.iter().map(|p| p.key.as_str()));
            if known().any(|one| one == name) {
                continue;
            }
            let near = known().min_by_key(|one| osa_distance(one, name)).filter(|one| osa_distance(one, name) < 2);
            let label = match near {
                Some(near) if name.len() > 1 => format!("did you mean `{near}`?"),
                _ => "neither a variable nor a parameter".into(),
            };
            let help = format!(
                "the variables of acts_on = \"{}\" are {}; a parameter is a key of this effect: add {name} = {{ value = 0 }}",
                self.acts_on.word(),
                variables.join(", ")
            );
            let title = format!("the formula has an unknown name `{name}`");
            return Err(Fault { blame: Blame::Text(span.clone()), title, label, help });
        }
        if let Some(index) = self.parameters.iter().position(|p| !names().any(|span| self.text[span.clone()] == p.key))
        {
            let title = format!("the parameter `{}` does not occur in the formula", self.parameters[index].key);
            return parameter(index, title, "not in the formula", "remove it, or write it into the formula");
        }
        if self.parameters.is_empty() {
            let help = "write e.g. formula = \"-k*x^5\" and below it k = { value = 0 }";
            return Err(self.fault("the formula has no parameter", "nothing in it can be fitted", help));
        }
        if self.parameters.len() > PARAMETERS {
            let title = format!("the formula has {} parameters, at most {PARAMETERS} are read", self.parameters.len());
            let help = "write fixed numbers into the formula, or two effects: forces of several add up";
            return parameter(PARAMETERS, title, "one too many", help);
        }
        Ok(())
    }
}

/// A formula that is being tried.
struct Tried<'a> {
    statement: &'a Statement,
    program: &'a Program,
}

impl Tried<'_> {
    /// Values of the parameters to try it with: as stated, in the middle of their ranges, or 1.
    fn nominal(&self) -> Vec<f64> {
        let of = |stated: &Stated| match (stated.value, stated.range) {
            (0.0, Some((low, high, _))) => low.max(1e-4 * high).sqrt() * high.sqrt(),
            (0.0, None) => 1.0,
            (value, _) => value,
        };
        self.statement.parameters.iter().map(of).collect()
    }

    /// Places at which it is tried.
    fn places(&self) -> Vec<[f64; VARIABLES]> {
        let either: Vec<f64> = TRIED.iter().flat_map(|x| [*x, -x]).collect();
        match self.statement.acts_on {
            ActsOn::Friction => TRIED.iter().map(|s| [*s, 0.0]).collect(),
            _ => either.iter().flat_map(|x| either.iter().map(move |v| [*x, *v])).collect(),
        }
    }

    fn value(&self, place: [f64; VARIABLES], parameters: &[f64]) -> f64 {
        self.program.jet(&place, parameters)[0]
    }

    /// The place in words.
    fn words(&self, place: [f64; VARIABLES]) -> String {
        let one = |(name, value): (&&str, f64)| format!("{name} = {value:e}");
        self.statement.acts_on.variables().iter().zip(place).map(one).collect::<Vec<_>>().join(", ")
    }

    /// Whether it has finite values and slopes where the variables are small, and does not jump where they change sign.
    fn check_finite(&self) -> Result<(), Fault> {
        let nominal = self.nominal();
        let friction = self.statement.acts_on == ActsOn::Friction;
        let near = |place: &[f64; VARIABLES]| friction || place.iter().all(|x| x.abs() <= NEAR);
        for place in self.places().into_iter().filter(near) {
            let jet = self.program.jet(&place, &nominal);
            if jet.iter().any(|x| !x.is_finite()) {
                let what = if jet[0].is_finite() { "a slope" } else { "a value" };
                let title = format!("the formula has {what} that is not finite at {}", self.words(place));
                let help = "variables take either sign and pass through zero (s is never negative): write abs(v)^p*sign(v) \
                            for a power p of a speed, ln(1 + s/v_0) for a logarithm";
                return Err(self.statement.fault(&title, "not finite there", help));
            }
        }
        let variables = self.statement.acts_on.variables();
        for (variable, name) in variables.iter().enumerate().filter(|_| !friction) {
            if self.jumps(variable, |jet| jet[0]) {
                let title = format!("the formula jumps where {name} changes sign");
                let help =
                    format!("solvers need a force without jumps: write e.g. tanh({name}/{name}_0) for sign({name})");
                return Err(self.statement.fault(&title, "not continuous", &help));
            }
        }
        Ok(())
    }

    /// Whether its value, or a slope, jumps or has no bound where a variable changes sign.
    fn jumps(&self, variable: usize, of: impl Fn(Jet) -> f64) -> bool {
        let nominal = self.nominal();
        let at = |beside: f64, t: f64| {
            let mut place = [beside; VARIABLES];
            place[variable] = t;
            of(self.program.jet(&place, &nominal))
        };
        // Of what is continuous the difference falls with the distance, by less than that for powers near zero only;
        // what has no bound grows.
        [0.0, 1e-6].into_iter().any(|beside| {
            let [near, far] = [1e-40, 1e-20].map(|t| [at(beside, t), at(beside, -t)]);
            let across = |ends: [f64; 2]| (ends[0] - ends[1]).abs();
            across(near).is_nan() || across(near) > 0.5 * across(far) || near[0].abs() > 2.0 * far[0].abs()
        })
    }

    /// The parameters that take it away when they are zero: one of them, or the fewest together.
    fn zero(&self) -> Result<Vec<Zero>, Fault> {
        let nominal = self.nominal();
        // Far out an exponential may overflow, and a logarithm end.
        let finite = |place: &[f64; VARIABLES]| self.value(*place, &nominal).is_finite();
        let places: Vec<[f64; VARIABLES]> = self.places().into_iter().filter(finite).collect();
        if !places.iter().any(|place| self.value(*place, &nominal).abs() > 0.0) {
            let help = "check its brackets and the values of its parameters";
            return Err(self.statement.fault("the formula is zero wherever it is tried", "always zero", help));
        }
        let count = nominal.len();
        let mut sets: Vec<u32> = (1..1 << count).collect();
        sets.sort_by_key(|set| set.count_ones());
        let vanishes = |set: &u32| {
            let without: Vec<f64> = (0..count).map(|i| if set >> i & 1 == 1 { 0.0 } else { nominal[i] }).collect();
            places.iter().all(|place| self.value(*place, &without) == 0.0)
        };
        let Some(set) = sets.into_iter().find(vanishes) else {
            let help = "give it a strength: a factor such as k in k*(…), with which it vanishes at 0";
            let title = "the formula does not vanish at 0 of any of its parameters";
            return Err(self.statement.fault(title, "no strength", help));
        };
        let zero = (0..count).filter(|i| set >> i & 1 == 1).map(|parameter| Zero { parameter, value: 0.0 });
        Ok(zero.collect())
    }

    /// Whether a search knows where to look for every parameter.
    fn check_ranges(&self, zero: &[Zero]) -> Result<(), Fault> {
        for (index, stated) in self.statement.parameters.iter().enumerate() {
            let strength = zero.iter().any(|zero| zero.parameter == index);
            if stated.range.is_some() || (stated.value != 0.0 && !strength) || (strength && self.is_linear(index)) {
                continue;
            }
            let title = format!("it cannot be told how large `{}` may be", stated.key);
            let label = if strength { "the formula is not in proportion to it" } else { "stated as zero" };
            let key = &stated.key;
            let help = format!("say what a search should cover: {key} = {{ value = …, low = …, high = … }}");
            return Err(Fault { blame: Blame::Parameter(index), title, label: label.into(), help });
        }
        Ok(())
    }

    /// Whether the formula is in proportion to a parameter.
    fn is_linear(&self, parameter: usize) -> bool {
        let with = |value: f64| {
            let mut parameters = self.nominal();
            parameters[parameter] = value;
            parameters
        };
        let [none, one, two] = [0.0, 1.0, 2.0].map(with);
        self.places().into_iter().all(|place| {
            let [a, b, c] = [&none, &one, &two].map(|p| self.value(place, p));
            let size = a.abs() + b.abs() + c.abs();
            !size.is_finite() || (c - 2.0 * b + a).abs() <= 1e-9 * size
        })
    }

    /// Largest value with a strength of one over an oscillation of these amplitudes, the least and the largest of what
    /// the other parameters make of it; `None` where there is none.
    fn sizes(&self, strength: usize, zero: &[Zero], amplitudes: [f64; VARIABLES]) -> Option<(f64, f64)> {
        let nominal = self.nominal();
        let choices: Vec<Vec<f64>> = (0..nominal.len())
            .map(|i| match self.statement.parameters[i].range {
                _ if i == strength => vec![1.0],
                _ if zero.iter().any(|zero| zero.parameter == i) => vec![0.0],
                Some((low, high, _)) => vec![low, nominal[i], high],
                None => vec![nominal[i]],
            })
            .collect();
        let mut corners = vec![Vec::new()];
        for of in &choices {
            corners = corners.iter().flat_map(|c: &Vec<f64>| of.iter().map(|x| [&c[..], &[*x]].concat())).collect();
        }
        let largest = |parameters: &Vec<f64>| {
            let at = |j: usize| {
                let (sine, cosine) = (TAU * j as f64 / PHASES as f64).sin_cos();
                let place = match self.statement.acts_on {
                    ActsOn::Friction => [amplitudes[0] * (1.0 + cosine), 0.0],
                    _ => [amplitudes[0] * sine, amplitudes[1] * cosine],
                };
                self.value(place, parameters).abs()
            };
            (0..PHASES).map(at).fold(0.0, f64::max)
        };
        let all = corners.iter().map(largest).filter(|size| *size > 0.0 && size.is_finite());
        all.fold(None, |range: Option<(f64, f64)>, size| {
            Some(range.map_or((size, size), |(low, high)| (low.min(size), high.max(size))))
        })
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
