//! Equations of the catalogue, written in plain characters, as MathML.
//!
//! One letter is one symbol, but for the pairs of [`PAIRS`]; letters and digits below the line belong to the symbol
//! before them, primes and raised ones too; words of three letters are text; `a b/c d` divides the product before the
//! stroke by the one factor after it.

use minijinja::HtmlEscape;

/// Two letters that are one symbol: the second stands below the first.
const PAIRS: [&str; 3] = ["kc", "cc", "Dc"];
/// Names of functions, set upright.
const FUNCTIONS: [&str; 5] = ["exp", "log", "max", "sin", "ln"];
/// Characters below the line with what they stand for.
const LOWERED: &str = "₀₁₂₃₄ₐₛₘₙᵣ";
const LOW: &str = "01234asmnr";
/// Characters above the line.
const RAISED: &str = "²³ⁿ′″";
const HIGH: &str = "23n′″";

/// The equation as a block of MathML, its plain text as the alternative.
pub fn block(equation: &str) -> String {
    let characters: Vec<char> = equation.chars().collect();
    let mut parser = Parser { text: &characters, at: 0 };
    let mut row = String::new();
    while parser.at < characters.len() {
        row.push_str(&parser.row(&[]));
        // A closing bracket without its opening one.
        if let Some(stray) = parser.next() {
            row.push_str(&operator(stray));
        }
    }
    format!("<math display=\"block\" alttext=\"{}\"><mrow>{row}</mrow></math>", HtmlEscape(equation))
}

struct Parser<'a> {
    text: &'a [char],
    at: usize,
}

fn operator(character: char) -> String {
    format!("<mo>{}</mo>", HtmlEscape(character.encode_utf8(&mut [0; 4])))
}

fn upright(text: &str) -> String {
    format!("<mtext>{}</mtext>", HtmlEscape(&text.replace(' ', "\u{a0}")))
}

fn letter(character: char) -> bool {
    character.is_alphabetic() && !LOWERED.contains(character) && !RAISED.contains(character)
}

impl Parser<'_> {
    fn peek(&self) -> Option<char> {
        self.text.get(self.at).copied()
    }

    fn next(&mut self) -> Option<char> {
        let character = self.peek()?;
        self.at += 1;
        Some(character)
    }

    fn spaces(&mut self) {
        while self.peek() == Some(' ') {
            self.at += 1;
        }
    }

    /// The characters from here on for which `wanted` holds.
    fn run(&mut self, wanted: impl Fn(char) -> bool) -> String {
        let mut found = String::new();
        while let Some(character) = self.peek().filter(|c| wanted(*c)) {
            found.push(character);
            self.at += 1;
        }
        found
    }

    /// Everything up to one of the closing characters.
    fn row(&mut self, close: &[char]) -> String {
        let (mut row, mut product) = (String::new(), String::new());
        loop {
            self.spaces();
            match self.peek() {
                None => break,
                Some(c) if close.contains(&c) || ")]".contains(c) => break,
                Some('/') => {
                    self.at += 1;
                    self.spaces();
                    let below = self.factor(true);
                    product = format!("<mfrac><mrow>{product}</mrow><mrow>{below}</mrow></mfrac>");
                }
                Some(c) if "+−=→,·<".contains(c) => {
                    self.at += 1;
                    row.push_str(&std::mem::take(&mut product));
                    row.push_str(&operator(c));
                    if c == ',' {
                        row.push_str("<mspace width=\"0.7em\"/>");
                    }
                }
                Some(_) => product.push_str(&self.factor(false)),
            }
        }
        row + &product
    }

    /// One factor with what is raised at it; without its brackets where it stands below a stroke.
    fn factor(&mut self, bare: bool) -> String {
        let base = self.base(bare);
        let low = self.run(|c| LOWERED.contains(c));
        let high = self.run(|c| RAISED.contains(c));
        let set = |text: &str, from: &str, to: &str| -> String {
            let one = |c: char| from.chars().position(|known| known == c).and_then(|i| to.chars().nth(i)).unwrap_or(c);
            let text: String = text.chars().map(one).collect();
            let kind = if text.chars().all(|c| c.is_ascii_digit()) { "mn" } else { "mi" };
            let kind = if text.contains(['′', '″']) { "mo" } else { kind };
            format!("<{kind}>{text}</{kind}>")
        };
        match (low.is_empty(), high.is_empty()) {
            (true, true) => base,
            (false, true) => format!("<msub>{base}{}</msub>", set(&low, LOWERED, LOW)),
            (true, false) => format!("<msup>{base}{}</msup>", set(&high, RAISED, HIGH)),
            (false, false) => {
                format!("<msubsup>{base}{}{}</msubsup>", set(&low, LOWERED, LOW), set(&high, RAISED, HIGH))
            }
        }
    }

    fn base(&mut self, bare: bool) -> String {
        match self.peek() {
            Some(open @ ('(' | '[')) => {
                self.at += 1;
                let inside = self.row(&[]);
                let close = self.next().unwrap_or(')');
                let raised = self.peek().is_some_and(|c| RAISED.contains(c));
                if bare && !raised {
                    return format!("<mrow>{inside}</mrow>");
                }
                format!("<mrow>{}{inside}{}</mrow>", operator(open), operator(close))
            }
            Some('|') => {
                self.at += 1;
                let inside = self.row(&['|']);
                self.at += usize::from(self.peek() == Some('|'));
                format!("<mrow>{}{inside}{}</mrow>", operator('|'), operator('|'))
            }
            Some('√') => {
                self.at += 1;
                format!("<msqrt>{}</msqrt>", self.factor(true))
            }
            Some(c) if c.is_ascii_digit() => self.number(),
            Some(c) if letter(c) => self.letters(),
            _ => self.next().map_or_else(String::new, operator),
        }
    }

    /// A number, with its unit where one follows after a space.
    fn number(&mut self) -> String {
        let number = format!("<mn>{}</mn>", self.run(|c| c.is_ascii_digit() || c == '.'));
        let start = self.at;
        self.spaces();
        let unit = if self.at > start { self.run(|c| c.is_ascii_alphabetic() || c == '/') } else { String::new() };
        if (2..5).contains(&unit.len()) {
            return number + &upright(&format!(" {unit}"));
        }
        self.at = start;
        number
    }

    /// A symbol, the name of a function, or words.
    fn letters(&mut self) -> String {
        let start = self.at;
        let run = self.run(letter);
        if let Some(name) = FUNCTIONS.into_iter().find(|name| run == *name) {
            let low = self.run(|c| LOWERED.contains(c));
            // Set close to what stands before it but for the sine, which follows a letter.
            let apart = if name == "sin" { "<mspace width=\"0.17em\"/>" } else { "" };
            let name = format!("{apart}<mi>{name}</mi>");
            let index: String =
                low.chars().filter_map(|c| LOW.chars().nth(LOWERED.chars().position(|l| l == c)?)).collect();
            return if low.is_empty() { name } else { format!("<msub>{name}<mn>{index}</mn></msub>") };
        }
        if run.len() > 2 && run.is_ascii() {
            let mut words = run;
            let mut end = self.at;
            loop {
                let space = self.run(|c| c == ' ');
                let word = self.run(letter);
                if space.is_empty() || word.len() < 2 || !word.is_ascii() {
                    self.at = end;
                    break;
                }
                words += &format!(" {word}");
                end = self.at;
            }
            return upright(&format!(" {words} "));
        }
        self.at = start;
        let rest: String = self.text[self.at..].iter().take(2).collect();
        if PAIRS.contains(&rest.as_str()) {
            self.at += 2;
            let (first, second) = rest.split_at(1);
            return format!("<msub><mi>{first}</mi><mi>{second}</mi></msub>");
        }
        let first = self.next().unwrap_or(' ');
        if first == 'Δ' && self.peek().is_some_and(letter) {
            return format!("<mi>Δ{}</mi>", self.next().unwrap_or(' '));
        }
        format!("<mi>{}</mi>", HtmlEscape(first.encode_utf8(&mut [0; 4])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::REGISTRY;

    #[test]
    fn fractions_indices_and_functions_have_their_form() {
        let math = |text: &str| {
            let block = block(text);
            block.split_once("<mrow>").map(|(_, rest)| rest.trim_end_matches("</mrow></math>").to_owned()).unwrap()
        };
        assert_eq!(
            math("μ(s) = μ + β ln(1 + s/v₀)"),
            "<mi>μ</mi><mrow><mo>(</mo><mi>s</mi><mo>)</mo></mrow><mo>=</mo><mi>μ</mi><mo>+</mo><mi>β</mi><mi>ln</mi><mrow>\
             <mo>(</mo><mn>1</mn><mo>+</mo><mfrac><mrow><mi>s</mi></mrow><mrow><msub><mi>v</mi><mn>0</mn></msub></mrow></mfrac>\
             <mo>)</mo></mrow>"
        );
        assert_eq!(
            math("kc|v|x′"),
            "<msub><mi>k</mi><mi>c</mi></msub><mrow><mo>|</mo><mi>v</mi><mo>|</mo></mrow>\
             <msup><mi>x</mi><mo>′</mo></msup>"
        );
        assert_eq!(math("1 nm/s"), "<mn>1</mn><mtext>\u{a0}nm&#x2f;s</mtext>");
    }

    #[test]
    fn every_equation_of_the_catalogue_is_well_formed_and_complete() {
        let of_model = super::super::glossary::equations();
        let equations = REGISTRY.iter().map(|effect| effect.equation());
        for equation in equations.chain(of_model.iter().map(|e| e.equation.as_str())) {
            let math = block(equation);
            let closed = math.matches("</").count();
            let opened = math.matches('<').count() - closed - math.matches("/>").count();
            assert_eq!(opened, closed, "{math}");
            let mut shown = String::new();
            math.split('<').filter_map(|rest| rest.split_once('>')).for_each(|(_, text)| shown.push_str(text));
            for c in equation.chars().filter(|c| letter(*c) && !"kcD".contains(*c)) {
                assert!(shown.contains(c), "{c} of {equation}");
            }
        }
    }

    #[test]
    fn hostile_equations_are_escaped_and_end() {
        let math = block("</math><script>\"x\" ) ] (");
        assert!(!math.contains("<script") && math.contains("&lt;"), "{math}");
    }
}
