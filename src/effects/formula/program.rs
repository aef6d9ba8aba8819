//! The steps of a formula, ready to be evaluated with derivatives by its variables and parameters.

use super::expression::{Function, Step};

/// Variables that a law has at most.
pub const VARIABLES: usize = 2;
/// Parameters that a formula has at most.
pub const PARAMETERS: usize = 4;
/// Numbers that are kept at once at most.
const DEEPEST: usize = 24;

/// A value, then its derivatives by the variables and by the parameters.
pub type Jet = [f64; 1 + VARIABLES + PARAMETERS];

/// An operation on the stack.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Operation {
    Constant(f64),
    /// A variable, or from [`VARIABLES`] on a parameter.
    Input(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    WholePower(i32),
    FixedPower(f64),
    Call(Function),
}

/// A formula whose names have been found.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    operations: Vec<Operation>,
}

/// What the form of a formula says of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Whether it changes sign, and nothing else, where all variables do.
    pub odd: bool,
    /// Whether it has a kink where the second variable is zero.
    pub kinked_at_rest: bool,
    /// Whether it has no kinks elsewhere.
    pub smooth_elsewhere: bool,
}

impl Program {
    /// The program of steps whose names `input` gives numbers; `None` where it would keep too many numbers at once.
    pub fn new(steps: &[Step], input: impl Fn(&std::ops::Range<usize>) -> usize) -> Option<Self> {
        let mut program = Self { operations: Vec::with_capacity(steps.len()) };
        let mut depth = 0usize;
        for step in steps {
            let (operation, taken) = match step {
                Step::Number(value) => (Operation::Constant(*value), 0),
                Step::Name(span) => (Operation::Input(input(span)), 0),
                Step::Negate => (Operation::Negate, 1),
                Step::Add => (Operation::Add, 2),
                Step::Subtract => (Operation::Subtract, 2),
                Step::Multiply => (Operation::Multiply, 2),
                Step::Divide => (Operation::Divide, 2),
                Step::Power => (Operation::Power, 2),
                Step::Call(f @ (Function::Min | Function::Max)) => (Operation::Call(*f), 2),
                Step::Call(f) => (Operation::Call(*f), 1),
            };
            depth = depth + 1 - taken;
            if depth > DEEPEST {
                return None;
            }
            program.push(operation, taken);
        }
        Some(program)
    }

    /// Adds an operation on so many numbers; what has none but constants is calculated at once.
    fn push(&mut self, operation: Operation, taken: usize) {
        let constant = |operation: &Operation| matches!(operation, Operation::Constant(_));
        let first = self.operations.len() - taken.min(self.operations.len());
        if taken > 0 && self.operations[first..].iter().all(constant) {
            let constants = self.operations.split_off(first);
            let alone = Self { operations: constants.into_iter().chain([operation]).collect() };
            self.operations.push(Operation::Constant(alone.jet(&[], &[])[0]));
            return;
        }
        if let (Operation::Power, Some(&Operation::Constant(power))) = (operation, self.operations.last()) {
            self.operations.pop();
            let whole = power.fract() == 0.0 && power.abs() <= 64.0;
            self.operations.push(if whole {
                Operation::WholePower(power as i32)
            } else {
                Operation::FixedPower(power)
            });
            return;
        }
        self.operations.push(operation);
    }

    /// Value and derivatives.
    pub fn jet(&self, variables: &[f64], parameters: &[f64]) -> Jet {
        let mut stack = [[0.0; 1 + VARIABLES + PARAMETERS]; DEEPEST];
        let mut top = 0;
        for operation in &self.operations {
            match *operation {
                Operation::Constant(value) => {
                    stack[top] = constant(value);
                    top += 1;
                }
                Operation::Input(input) => {
                    let value = match input.checked_sub(VARIABLES) {
                        None => variables[input],
                        Some(parameter) => parameters[parameter],
                    };
                    stack[top] = constant(value);
                    stack[top][1 + input] = 1.0;
                    top += 1;
                }
                Operation::Negate => stack[top - 1] = stack[top - 1].map(|x| -x),
                Operation::WholePower(n) => {
                    let a = &mut stack[top - 1];
                    let value = a[0];
                    chain(a, value.powi(n), if n == 0 { 0.0 } else { f64::from(n) * value.powi(n - 1) });
                }
                Operation::FixedPower(n) => {
                    let a = &mut stack[top - 1];
                    let value = a[0];
                    chain(a, value.powf(n), n * value.powf(n - 1.0));
                }
                Operation::Call(f @ (Function::Min | Function::Max)) => {
                    top -= 1;
                    let (a, b) = (stack[top - 1], stack[top]);
                    let first = if f == Function::Min { a[0] <= b[0] } else { a[0] >= b[0] };
                    stack[top - 1] = if first || a[0].is_nan() { a } else { b };
                }
                Operation::Call(function) => apply(function, &mut stack[top - 1]),
                binary => {
                    top -= 1;
                    let b = stack[top];
                    join(binary, &mut stack[top - 1], &b);
                }
            }
        }
        stack[0]
    }

    /// What its form says.
    pub fn shape(&self) -> Shape {
        let mut shape = Shape { odd: false, kinked_at_rest: false, smooth_elsewhere: true };
        let mut stack: Vec<Seen> = Vec::new();
        for operation in &self.operations {
            let seen = match *operation {
                Operation::Constant(_) => Seen::CONSTANT,
                Operation::Input(input) if input < VARIABLES => {
                    Seen { parity: Some(Parity::Odd), by: [input == 0, input == 1] }
                }
                Operation::Input(_) => Seen::CONSTANT,
                ref operation => {
                    let last = stack.pop().unwrap_or(Seen::CONSTANT);
                    let both = matches!(
                        operation,
                        Operation::Add
                            | Operation::Subtract
                            | Operation::Multiply
                            | Operation::Divide
                            | Operation::Power
                            | Operation::Call(Function::Min | Function::Max)
                    );
                    let first = if both { stack.pop().unwrap_or(Seen::CONSTANT) } else { last };
                    shape.note_kink(operation, first, last);
                    first.then(operation, last)
                }
            };
            stack.push(seen);
        }
        shape.odd = stack.first().is_some_and(|seen| seen.parity == Some(Parity::Odd));
        shape
    }
}

impl Shape {
    fn note_kink(&mut self, operation: &Operation, first: Seen, last: Seen) {
        let depends = |seen: Seen| seen.by[0] || seen.by[1];
        match operation {
            // An odd function of the second variable alone.
            Operation::Call(Function::Abs | Function::Sign)
                if last.by == [false, true] && last.parity == Some(Parity::Odd) =>
            {
                self.kinked_at_rest = true;
            }
            Operation::Call(Function::Abs | Function::Sign) if depends(last) => self.smooth_elsewhere = false,
            Operation::Call(Function::Min | Function::Max) if depends(first) || depends(last) => {
                self.smooth_elsewhere = false;
            }
            _ => {}
        }
    }
}

/// What becomes of a value where all variables change sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parity {
    Even,
    Odd,
}

/// A value as its form tells: its parity where it has one, and the variables that it depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    parity: Option<Parity>,
    by: [bool; VARIABLES],
}

impl Seen {
    const CONSTANT: Self = Self { parity: Some(Parity::Even), by: [false; VARIABLES] };

    /// What an operation on it, of two numbers with the `last` one, makes of it.
    fn then(self, operation: &Operation, last: Self) -> Self {
        use Parity::{Even, Odd};
        let by = [self.by[0] || last.by[0], self.by[1] || last.by[1]];
        let even = |parity| if parity == Some(Even) { Some(Even) } else { None };
        let parity = match operation {
            Operation::Negate => self.parity,
            Operation::Add | Operation::Subtract if self.parity == last.parity => self.parity,
            Operation::Multiply | Operation::Divide => match (self.parity, last.parity) {
                (Some(a), Some(b)) => Some(if a == b { Even } else { Odd }),
                _ => None,
            },
            Operation::WholePower(n) if n % 2 == 0 && self.parity.is_some() => Some(Even),
            Operation::WholePower(_) => self.parity,
            Operation::Call(Function::Abs | Function::Cos | Function::Cosh) if self.parity.is_some() => Some(Even),
            Operation::Call(Function::Sign | Function::Sin | Function::Atan | Function::Sinh | Function::Tanh) => {
                self.parity
            }
            _ if self.parity == last.parity => even(self.parity),
            _ => None,
        };
        Self { parity, by }
    }
}

fn constant(value: f64) -> Jet {
    let mut jet = [0.0; 1 + VARIABLES + PARAMETERS];
    jet[0] = value;
    jet
}

/// A function of `a` with this value and slope. Where the slope is infinite, what `a` does not depend on stays without
/// effect.
fn chain(a: &mut Jet, value: f64, slope: f64) {
    a[0] = value;
    if slope.is_finite() {
        a[1..].iter_mut().for_each(|d| *d *= slope);
    } else {
        a[1..].iter_mut().filter(|d| **d != 0.0).for_each(|d| *d *= slope);
    }
}

fn apply(function: Function, a: &mut Jet) {
    let x = a[0];
    let (value, slope) = match function {
        Function::Abs => (x.abs(), sign(x)),
        Function::Sign => (sign(x), 0.0),
        Function::Sqrt => (x.sqrt(), 0.5 / x.sqrt()),
        Function::Exp => (x.exp(), x.exp()),
        Function::Ln => (x.ln(), 1.0 / x),
        Function::Log10 => (x.log10(), std::f64::consts::LOG10_E / x),
        Function::Sin => (x.sin(), x.cos()),
        Function::Cos => (x.cos(), -x.sin()),
        Function::Atan => (x.atan(), 1.0 / (1.0 + x * x)),
        Function::Sinh => (x.sinh(), x.cosh()),
        Function::Cosh => (x.cosh(), x.sinh()),
        Function::Tanh => (x.tanh(), 1.0 - x.tanh().powi(2)),
        Function::Min | Function::Max => (x, 1.0),
    };
    chain(a, value, slope);
}

/// -1, 0 or 1; no number where there is none.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

fn join(operation: Operation, a: &mut Jet, b: &Jet) {
    let (x, y) = (a[0], b[0]);
    let (value, by_a, by_b) = match operation {
        Operation::Add => (x + y, 1.0, 1.0),
        Operation::Subtract => (x - y, 1.0, -1.0),
        Operation::Multiply => (x * y, y, x),
        Operation::Divide => (x / y, 1.0 / y, -x / (y * y)),
        _ => {
            let value = x.powf(y);
            // The power of zero is zero, whatever its positive exponent.
            let by_exponent = if x == 0.0 && y > 0.0 { 0.0 } else { value * x.ln() };
            (value, y * x.powf(y - 1.0), by_exponent)
        }
    };
    let part = |slope: f64, d: f64| if d == 0.0 { 0.0 } else { slope * d };
    a[0] = value;
    for (da, db) in a[1..].iter_mut().zip(&b[1..]) {
        *da = part(by_a, *da) + part(by_b, *db);
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::parse;
    use super::*;
    use rand::RngExt;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const NAMES: [&str; 6] = ["x", "v", "a", "b", "c", "d"];

    fn program(text: &str) -> Program {
        let steps = parse(text).unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
        let input = |span: &std::ops::Range<usize>| NAMES.iter().position(|name| *name == &text[span.clone()]);
        Program::new(&steps, |span| input(span).expect("a name")).expect("not too deep")
    }

    fn at(text: &str, x: f64, v: f64) -> Jet {
        program(text).jet(&[x, v], &[2.0, 0.5, -1.0, 3.0])
    }

    #[test]
    fn values_and_derivatives_are_those_of_closed_forms() {
        let jet = at("-a*x^3*exp(-b*v)", 1.5, 0.4);
        let decay = (-0.2f64).exp();
        let expected = [-6.75 * decay, -13.5 * decay, 3.375 * decay, -3.375 * decay, 2.7 * decay, 0.0, 0.0];
        for (found, expected) in jet.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{jet:?}");
        }
    }

    #[test]
    fn powers_at_zero_have_the_derivatives_of_their_limits() {
        assert_eq!(at("x^5", 0.0, 0.0)[..2], [0.0, 0.0]);
        assert_eq!(at("x^1", 0.0, 0.0)[..2], [0.0, 1.0]);
        assert_eq!(at("x^0", 0.0, 0.0)[..2], [1.0, 0.0]);
        assert_eq!(at("-a*sign(v)*abs(v)^1.5", 0.0, 0.0), [-0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        // A power below one: infinite slope by v there, none by the exponent.
        assert_eq!(at("a*sign(v)*abs(v)^b", 0.0, 0.0)[0], 0.0);
        assert!(at("a*sign(v)*abs(v)^b", 0.0, 0.0).iter().all(|d| d.is_finite()));
    }

    #[test]
    fn constants_are_calculated_once() {
        assert_eq!(program("2*3*x^(1+1)").operations.len(), 4);
        assert_eq!(program("-(2^3)*x").operations[0], Operation::Constant(-8.0));
    }

    #[test]
    fn form_tells_oddness_and_kinks() {
        let of = |text| {
            let Shape { odd, kinked_at_rest, smooth_elsewhere } = program(text).shape();
            (odd, kinked_at_rest, smooth_elsewhere)
        };
        assert_eq!(of("-a*x^5"), (true, false, true));
        assert_eq!(of("-a*x^2"), (false, false, true));
        assert_eq!(of("-a*x - b*x^2"), (false, false, true));
        assert_eq!(of("-a*v*abs(v)"), (true, true, true));
        assert_eq!(of("-a*v*abs(x)"), (true, false, false));
        assert_eq!(of("-a*sign(x)*max(0, abs(x) - b)"), (true, false, false));
        assert_eq!(of("-a*max(0, x - b)"), (false, false, false));
        assert_eq!(of("tanh(v/a)*cos(x)"), (true, false, true));
        assert_eq!(of("exp(x) - exp(-x)"), (false, false, true));
        assert_eq!(of("a*x*exp(-x^2)"), (true, false, true));
        assert_eq!(of("a*x + 1"), (false, false, true));
    }

    /// A random expression that is smooth in a neighbourhood of any point.
    fn random(of: &mut Pcg64, depth: u32) -> String {
        let one = |of: &mut Pcg64| random(of, depth - 1);
        if depth == 0 {
            return match of.random_range(0..8u32) {
                6 => format!("{:.2}", of.random_range(0.1..3.0)),
                7 => "pi".into(),
                name => NAMES[name as usize].into(),
            };
        }
        match of.random_range(0..12u32) {
            0 => format!("({} + {})", one(of), one(of)),
            1 => format!("({} - {})", one(of), one(of)),
            2 | 3 => format!("{} * {}", one(of), one(of)),
            4 => format!("{} / (2 + ({})^2)", one(of), one(of)),
            5 => format!("({})^3", one(of)),
            6 => format!("(1 + ({})^2)^({})", one(of), one(of)),
            7 => format!("sqrt(1 + abs({}))", one(of)),
            8 => format!("-ln(2 + ({})^2)", one(of)),
            9 => format!("sin({}) * cos({})", one(of), one(of)),
            10 => format!("tanh({}) + atan({})", one(of), one(of)),
            _ => format!("exp(-({})^2) + min({}, {})", one(of), one(of), one(of)),
        }
    }

    #[test]
    fn derivatives_of_random_expressions_are_those_of_differences() {
        let mut of = Pcg64::seed_from_u64(7);
        let mut compared = 0;
        for _ in 0..3000 {
            let depth = of.random_range(1..4);
            let text = random(&mut of, depth);
            if text.len() > 400 {
                continue;
            }
            let program = program(&text);
            let place: [f64; 6] = std::array::from_fn(|_| of.random_range(-1.5..1.5));
            let value = |place: &[f64; 6]| program.jet(&place[..2], &place[2..])[0];
            let jet = program.jet(&place[..2], &place[2..]);
            for input in 0..6 {
                let beside = |step: f64| {
                    let mut moved = place;
                    moved[input] += step;
                    value(&moved)
                };
                // Differences of two sizes agree where the fourth derivative is tame and no kink is near.
                let difference = |h: f64| (beside(h) - beside(-h)) / (2.0 * h);
                let (coarse, fine) = (difference(2e-4), difference(1e-4));
                let scale = 1.0 + fine.abs() + value(&place).abs();
                if !fine.is_finite() || (coarse - fine).abs() > 1e-6 * scale || scale > 1e6 {
                    continue;
                }
                compared += 1;
                let error = (jet[1 + input] - fine).abs() / scale;
                assert!(error < 2e-6, "{text} by {} at {place:?}: {} for {fine}", NAMES[input], jet[1 + input]);
            }
        }
        assert!(compared > 10_000, "{compared}");
    }
}
