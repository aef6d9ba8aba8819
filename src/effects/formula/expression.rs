//! The text of a formula to its steps in postfix order, or to what is wrong with it and where.

use std::ops::Range;
use strsim::osa_distance;
use winnow::ascii::{digit0, digit1};
use winnow::combinator::{Infix, Prefix, alt, cut_err, delimited, expression, opt, preceded, separated};
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stream};
use winnow::token::{one_of, take_while};

/// Longest formula that is read, in bytes, and brackets in brackets: none that anybody can check by eye has more.
const LONGEST: usize = 500;
const DEEPEST: usize = 32;

/// What a fault is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Blame {
    /// Bytes of the text.
    Text(Range<usize>),
    /// A parameter, by its number.
    Parameter(usize),
}

/// What is wrong with a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What it is about.
    pub blame: Blame,
    /// What is wrong.
    pub title: String,
    /// What stands under the carets.
    pub label: String,
    /// What to do.
    pub help: String,
}

/// A function that a formula may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// |a|.
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// Square root.
    Sqrt,
    /// e^a.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 10.
    Log10,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Inverse tangent.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// The smaller of two.
    Min,
    /// The larger of two.
    Max,
}

/// Functions with their names and numbers of arguments.
pub const FUNCTIONS: &[(&str, Function, usize)] = &[
    ("abs", Function::Abs, 1),
    ("sign", Function::Sign, 1),
    ("sqrt", Function::Sqrt, 1),
    ("exp", Function::Exp, 1),
    ("ln", Function::Ln, 1),
    ("log10", Function::Log10, 1),
    ("sin", Function::Sin, 1),
    ("cos", Function::Cos, 1),
    ("atan", Function::Atan, 1),
    ("sinh", Function::Sinh, 1),
    ("cosh", Function::Cosh, 1),
    ("tanh", Function::Tanh, 1),
    ("min", Function::Min, 2),
    ("max", Function::Max, 2),
];

/// The ratio of a circle's circumference to its diameter, by name.
pub const PI: &str = "pi";

/// A step of a calculation on a stack.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Puts a number on it.
    Number(f64),
    /// Puts a variable or a parameter on it: the bytes of its name.
    Name(Range<usize>),
    /// Changes the sign of the topmost.
    Negate,
    /// Takes two, puts their sum.
    Add,
    /// Takes two, puts their difference.
    Subtract,
    /// Takes two, puts their product.
    Multiply,
    /// Takes two, puts their quotient.
    Divide,
    /// Takes two, puts the power.
    Power,
    /// Takes the arguments, puts the value.
    Call(Function),
}

/// The steps of a formula.
///
/// # Errors
/// The first thing that is wrong with its form; whether its names mean anything is not looked at.
pub fn parse(text: &str) -> Result<Vec<Step>, Fault> {
    bounded(text)?;
    (preceded_by_space(sum), space).map(|(steps, ())| steps).parse(LocatingSlice::new(text)).map_err(|error| {
        let at = error.offset();
        error.into_inner().fault(text, at)
    })
}

/// Whether a formula is short enough, and its brackets not too many within each other.
fn bounded(text: &str) -> Result<(), Fault> {
    let fault = |span, title: String, help: &str| {
        Err(Fault { blame: Blame::Text(span), title, label: "too much for one formula".into(), help: help.into() })
    };
    if text.len() > LONGEST {
        let title = format!("the formula has {} characters, at most {LONGEST} are read", text.chars().count());
        return fault(0..text.len(), title, "shorten it, or write two effects: forces of several add up");
    }
    let mut depth = 0usize;
    for (at, c) in text.char_indices() {
        depth = match c {
            '(' => depth + 1,
            ')' => depth.saturating_sub(1),
            _ => depth,
        };
        if depth > DEEPEST {
            let title = format!("more than {DEEPEST} brackets within each other");
            return fault(at..at + 1, title, "take out brackets that are not needed");
        }
    }
    Ok(())
}

type Input<'t> = LocatingSlice<&'t str>;
type Parsed<T> = Result<T, ErrMode<Problem>>;

/// What a part of the parser has to say, where that is more than that it cannot go on; bytes that it is about.
#[derive(Debug, Clone, Default, PartialEq)]
struct Problem {
    length: usize,
    title: String,
    label: String,
}

impl<I: Stream> ParserError<I> for Problem {
    type Inner = Self;
    fn from_input(_: &I) -> Self {
        Self::default()
    }
    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

impl Problem {
    fn fault(self, text: &str, at: usize) -> Fault {
        let help = "a formula has numbers, names, + - * / ^, brackets, and the functions ".to_string()
            + &FUNCTIONS.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
        if !self.title.is_empty() {
            let blame = Blame::Text(at..at + self.length);
            return Fault { blame, title: self.title, label: self.label, help };
        }
        let at = at + (text[at..].len() - text[at..].trim_start().len());
        let Some(c) = text[at..].chars().next() else {
            let title = "the formula ends too early".into();
            let label = "a number, a name or a bracket is missing here".into();
            return Fault { blame: Blame::Text(at..at), title, label, help };
        };
        let before = text[..at].trim_end().chars().next_back();
        let operand = before.is_some_and(|c| c.is_alphanumeric() || matches!(c, '_' | ')' | '.'));
        let label = match (c, operand) {
            ('*', false) if before == Some('*') => "write ^ for a power",
            (')', true) => "no bracket is open here",
            (_, true) => "an operator is needed here, such as * between factors",
            (_, false) => "a number, a name or a bracket is needed here",
        };
        let title = format!("the formula cannot be read at `{c}`");
        Fault { blame: Blame::Text(at..at + c.len_utf8()), title, label: label.into(), help }
    }
}

fn space(input: &mut Input<'_>) -> Parsed<()> {
    take_while(0.., char::is_whitespace).void().parse_next(input)
}

fn preceded_by_space<'t, T>(
    parser: impl Parser<Input<'t>, T, ErrMode<Problem>>,
) -> impl Parser<Input<'t>, T, ErrMode<Problem>> {
    preceded(space, parser)
}

/// The steps of two operands, then one that joins them.
fn joined(mut a: Vec<Step>, b: Vec<Step>, by: Step) -> Vec<Step> {
    a.extend(b);
    a.push(by);
    a
}

/// A whole expression. A sign binds less than a power: -x^2 is -(x^2).
fn sum(input: &mut Input<'_>) -> Parsed<Vec<Step>> {
    let sign = alt((
        '-'.map(|_| {
            Prefix(8, |_: &mut _, mut a: Vec<Step>| {
                a.push(Step::Negate);
                Ok(a)
            })
        }),
        '+'.map(|_| Prefix(8, |_: &mut _, a| Ok(a))),
    ));
    let operator = alt((
        '+'.map(|_| Infix::Left(4, |_: &mut _, a, b| Ok(joined(a, b, Step::Add)))),
        '-'.map(|_| Infix::Left(4, |_: &mut _, a, b| Ok(joined(a, b, Step::Subtract)))),
        '*'.map(|_| Infix::Left(6, |_: &mut _, a, b| Ok(joined(a, b, Step::Multiply)))),
        '/'.map(|_| Infix::Left(6, |_: &mut _, a, b| Ok(joined(a, b, Step::Divide)))),
        '^'.map(|_| Infix::Right(10, |_: &mut _, a, b| Ok(joined(a, b, Step::Power)))),
    ));
    expression(preceded_by_space(operand))
        .prefix(preceded_by_space(sign))
        .infix(preceded_by_space(operator))
        .parse_next(input)
}

fn operand(input: &mut Input<'_>) -> Parsed<Vec<Step>> {
    let bracket = delimited('(', cut_err(sum), closing);
    alt((number, named, bracket)).parse_next(input)
}

fn closing(input: &mut Input<'_>) -> Parsed<()> {
    let start = input.checkpoint();
    let found = preceded_by_space(')').void().parse_next(input);
    found.map_err(|_: ErrMode<Problem>| {
        input.reset(&start);
        let _ = space(input);
        let label = "close the bracket before this, or join what stands here with an operator";
        said(input.peek_token().map_or(0, char::len_utf8), "a bracket is not closed".into(), label.into())
    })
}

/// A failure that ends the reading at the place of the input, which is about so many bytes.
fn said(length: usize, title: String, label: String) -> ErrMode<Problem> {
    ErrMode::Cut(Problem { length, title, label })
}

fn number(input: &mut Input<'_>) -> Parsed<Vec<Step>> {
    let start = input.checkpoint();
    let exponent = || opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1));
    let whole = (digit1, opt(('.', digit0)), exponent()).take();
    let part = ('.', digit1, exponent()).take();
    let text: &str = alt((whole, part)).parse_next(input)?;
    match text.parse() {
        Ok(value) if f64::is_finite(value) => Ok(vec![Step::Number(value)]),
        _ => {
            input.reset(&start);
            Err(said(text.len(), format!("`{text}` is not a finite number"), "beyond what can be held".into()))
        }
    }
}

/// A function of arguments, a constant, or a name.
fn named(input: &mut Input<'_>) -> Parsed<Vec<Step>> {
    let start = input.checkpoint();
    let from = input.current_token_start();
    let first = |c: char| c.is_ascii_alphabetic() || c == '_';
    let name: &str =
        (one_of(first), take_while(0.., |c: char| c.is_ascii_alphanumeric() || c == '_')).take().parse_next(input)?;
    let opened = opt(preceded_by_space('(')).parse_next(input)?.is_some();
    let known = FUNCTIONS.iter().find(|(known, ..)| *known == name);
    let mut refuse = |title: String, label: String| {
        input.reset(&start);
        Err(said(name.len(), title, label))
    };
    let Some(&(_, function, count)) = known else {
        if opened {
            let near = FUNCTIONS.iter().map(|(name, ..)| *name).min_by_key(|other| osa_distance(name, other));
            let near = near.filter(|other| osa_distance(name, other) < 3);
            let label =
                near.map_or("write * where a product is meant".into(), |near| format!("did you mean `{near}`?"));
            return refuse(format!("there is no function `{name}`"), label);
        }
        let pi = Step::Number(std::f64::consts::PI);
        return Ok(vec![if name == PI { pi } else { Step::Name(from..from + name.len()) }]);
    };
    if !opened {
        return refuse(format!("the function `{name}` lacks its argument"), format!("write {name}(…)"));
    }
    let arguments: Vec<Vec<Step>> = cut_err(separated(1.., sum, preceded_by_space(','))).parse_next(input)?;
    if arguments.len() != count {
        input.reset(&start);
        let (title, needed) = (format!("`{name}` has {} arguments", arguments.len()), format!("{count} needed"));
        return Err(said(name.len(), title, needed));
    }
    closing(input)?;
    let mut steps = arguments.concat();
    steps.push(Step::Call(function));
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> String {
        let word = |step: &Step| match step {
            Step::Number(value) => format!("{value}"),
            Step::Name(span) => text[span.clone()].to_string(),
            Step::Call(function) => format!("{function:?}").to_lowercase(),
            step => format!("{step:?}").to_lowercase(),
        };
        parse(text).unwrap_or_else(|fault| panic!("{fault:?}")).iter().map(word).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn operators_bind_as_on_paper() {
        assert_eq!(shown("-k*x^2"), "k negate x 2 power multiply");
        assert_eq!(shown("-x^2"), "x 2 power negate");
        assert_eq!(shown("2^-x^2"), "2 x 2 power negate power");
        assert_eq!(shown("a^b^c"), "a b c power power");
        assert_eq!(shown("a - b - c / d / e"), "a b subtract c d divide e divide subtract");
        assert_eq!(shown(" max( 0 , abs (x) - g )*1.5e-3"), "0 x abs g subtract max 0.0015 multiply");
        assert_eq!(shown("2*pi + .5"), "2 3.141592653589793 multiply 0.5 add");
    }

    /// The text under the carets, and what is said there.
    fn fault(text: &str) -> (String, String) {
        let fault = parse(text).expect_err(text);
        let Blame::Text(span) = fault.blame else { unreachable!("a text alone") };
        (text[span].to_string(), format!("{}: {}", fault.title, fault.label))
    }

    #[test]
    fn a_fault_is_told_at_its_place() {
        let is = |text: &str, under: &str, words: &str| {
            let (at, told) = fault(text);
            assert!(at == under && told.contains(words), "{text}: `{at}`: {told}");
        };
        is("", "", "ends too early");
        is("-k*", "", "ends too early");
        is("-k*(x", "", "not closed");
        is("k*(x+1 2)", "2", "not closed");
        is("(xé", "é", "not closed");
        is("k*x)", ")", "no bracket is open");
        is("k**x", "*", "write ^");
        is("2x", "x", "an operator is needed");
        is("k $ x", "$", "an operator is needed");
        is("k*/x", "/", "a number, a name or a bracket");
        is("k*sn(x)", "sn", "did you mean");
        is("k*power(x)", "power", "no function");
        is("abs*x", "abs", "lacks its argument");
        is("max(x)", "max", "2 needed");
        is("max()", ")", "a number, a name");
        is("1e999*x", "1e999", "not a finite number");
        is("x²", "²", "an operator is needed");
        is(&"x+".repeat(251), &"x+".repeat(251), "at most 500");
        is(&format!("{}x{}", "(".repeat(33), ")".repeat(33)), "(", "more than 32");
    }

    #[test]
    fn the_deepest_that_is_read_fits_any_stack() {
        let deep = [
            "-".repeat(LONGEST - 1) + "x",
            "x^".repeat(LONGEST / 2 - 1) + "x",
            "abs(".repeat(DEEPEST) + &"-".repeat(LONGEST - 6 * DEEPEST) + "x" + &")".repeat(DEEPEST),
        ];
        for text in deep {
            let read = std::thread::Builder::new().stack_size(1 << 20).spawn(move || parse(&text).is_ok());
            assert!(read.expect("a thread").join().expect("no overflow"));
        }
    }
}
