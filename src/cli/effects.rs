//! `stickslip effects`: the catalogue, written from the registry.

use std::fmt::Write as _;
use std::path::Path;

use crate::effects::{Effect, ParameterInfo, REGISTRY, find_among, fits_rig, typical};
use crate::error::{Error, Result};
use crate::scenario::{self, Coordinate};
use crate::{terminal, units};

/// Widest line of the output.
const WIDTH: usize = 100;

/// Prints the table of all effects, or the page of one; with the formulas of a scenario, if one is named.
pub fn execute(name: Option<&str>, scenario: Option<&Path>) -> Result<()> {
    let own = scenario.map(formulas).transpose()?.unwrap_or_default();
    let of =
        |name: &str| find_among(REGISTRY, name).or_else(|| own.iter().copied().find(|effect| effect.name() == name));
    let text = match name {
        None => table(&own),
        Some(name) => page(of(name).ok_or_else(|| unknown(name))?),
    };
    terminal::print(&text)
}

/// The formulas that a scenario states.
///
/// # Errors
/// Of a scenario that is not sound.
pub fn formulas(scenario: &Path) -> Result<Vec<&'static dyn Effect>> {
    let effects = scenario::load(scenario)?.effects;
    Ok(effects.into_iter().map(|setting| setting.effect).filter(|effect| effect.formula().is_some()).collect())
}

fn unknown(name: &str) -> Error {
    let known: Vec<_> = REGISTRY.iter().map(|effect| effect.name()).collect();
    let shown: String = name.chars().take(60).flat_map(char::escape_debug).collect();
    let distance = |other: &&&str| strsim::osa_distance(&shown.to_lowercase(), other);
    let near = known.iter().min_by_key(distance).filter(|other| distance(other) <= 1 + other.len() / 3);
    let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    Error::Input(format!(
        "error: there is no effect `{shown}`{hint}\n  = help: the catalogue has\n{}",
        wrapped(&known.join(", "), "    ")
    ))
}

/// The catalogue and a scenario's own effects, one line per parameter.
pub fn table(own: &[&'static dyn Effect]) -> String {
    let mut rows = vec![["effect", "group", "parameter", "unit", "range of a search", "zero at"].map(String::from)];
    for effect in REGISTRY.iter().chain(own) {
        for (index, info) in effect.parameters().iter().enumerate() {
            let first = |text: &str| if index == 0 { text.to_string() } else { String::new() };
            let [unit, other] = of_both(info);
            let zero = effect.zero().iter().find(|zero| zero.parameter == index);
            let none = if effect.zero().is_empty() && index == 0 { "never" } else { "" };
            rows.push([
                first(effect.name()),
                first(effect.group().name()),
                info.key.into(),
                unit.into(),
                range(info),
                zero.map_or(none.into(), |zero| number(zero.value)),
            ]);
            if !other.is_empty() {
                rows.push(["", "", "", &format!("or {other}"), "", ""].map(String::from));
            }
        }
    }
    let mut text = aligned(&rows, "") + "\n";
    for (rigs, fits) in RIGS {
        let names: Vec<_> =
            REGISTRY.iter().chain(own).filter(|e| where_it_fits(**e) == *fits).map(|e| e.name()).collect();
        if !names.is_empty() {
            text.push_str(&wrapped(&format!("For {rigs}: {}.", names.join(", ")), ""));
        }
    }
    text + "\nA unit is that for an angle, after \"or\" that for a displacement.\n\
        A range is that on the published rig; on another it follows the size of the rig and its motion.\n\
        A fit begins within the range of its search, and may go beyond it by a factor of 3.\n\
        A law of your own is a formula in the scenario, [[effect]] with formula = \"-k5*x^5\" and\n\
        name = \"my-quintic\", acts_on = \"force\" (of x, v), \"friction\" (of s) or \"contact-force\" (of\n\
        stretch, stretch_rate), and a key for each parameter: k5 = { value = 0 }.\n\
        With --of SCENARIO its formulas are listed here.\n\
        stickslip effects NAME   equation, meaning, source, fingerprint and an example\n"
}

/// Rigs in words, and whether an effect fits those with a contact and those without.
const RIGS: &[(&str, (bool, bool))] = &[
    ("any rig, with or without a [contact]", (true, true)),
    ("a rig with a [contact] only", (true, false)),
    ("a rig without a [contact] only", (false, true)),
];

fn where_it_fits(effect: &dyn Effect) -> (bool, bool) {
    (fits_rig(effect, true).is_ok(), fits_rig(effect, false).is_ok())
}

/// Unit for an angle, and that for a displacement where it is another.
fn of_both(info: &ParameterInfo) -> [&'static str; 2] {
    let other = info.unit_for(Coordinate::Displacement);
    [if info.unit == "1" { "-" } else { info.unit }, if other == info.unit { "" } else { other }]
}

/// Everything that the catalogue knows of one effect.
pub fn page(effect: &dyn Effect) -> String {
    let title = format!("{} - {}", effect.name(), effect.title());
    let mut text = format!("{title}\n{}\n\n", "=".repeat(title.chars().count()));
    let mut section = |name: &str, body: String| text.extend([name, "\n", &body, "\n"]);
    section("Equation", equation(effect));
    section("Meaning", wrapped(effect.meaning(), "    "));
    let rigs = RIGS.iter().find(|(_, fits)| *fits == where_it_fits(effect)).map_or("no rig", |(rigs, _)| *rigs);
    section("For", wrapped(rigs, "    "));
    section("Parameters", parameters(effect));
    section("Returns the base at", wrapped(&zero(effect), "    "));
    section("What it does to a resonance curve", wrapped(effect.fingerprint(), "    "));
    if !effect.impersonator().is_empty() {
        section("What looks like it", wrapped(effect.impersonator(), "    "));
    }
    section("Source", wrapped(effect.source(), "    "));
    section("In a scenario (values for the form, not for a material)", indented(&example(effect)));
    text.trim_end().to_string() + "\n"
}

/// The law for an angle, and that for a displacement where an effect of the rig has a law of its own.
fn equation(effect: &dyn Effect) -> String {
    let text = wrapped(effect.equation(), "    ");
    let linear = effect.equation().replace("torque", "force").replace('θ', "x");
    if linear == effect.equation() || !where_it_fits(effect).1 {
        return text;
    }
    text + &wrapped(&format!("for a displacement x: {linear}"), "    ")
}

fn parameters(effect: &dyn Effect) -> String {
    let mut rows = vec![["key", "symbol", "unit", "range of a search", "accepted"].map(String::from)];
    for info in effect.parameters() {
        let [unit, other] = of_both(info);
        let accepted = format!("{} to {}", number(info.minimum), number(info.maximum));
        rows.push([info.key.into(), info.symbol.into(), unit.into(), range(info), accepted]);
        if !other.is_empty() {
            rows.push(["", "", &format!("or {other}"), "", ""].map(String::from));
        }
    }
    let mut text = aligned(&rows, "    ");
    for info in effect.parameters() {
        text.push_str(&wrapped(&format!("{}: {}", info.key, info.meaning), "    "));
    }
    text.push_str(&wrapped(
        "A fit begins within the range of its search, and may go beyond it by a factor of 3.",
        "    ",
    ));
    text
}

fn zero(effect: &dyn Effect) -> String {
    let key = |index: usize| effect.parameters().get(index).map_or("", |info| info.key);
    let all: Vec<_> =
        effect.zero().iter().map(|zero| format!("{} = {}", key(zero.parameter), number(zero.value))).collect();
    if all.is_empty() { "no value: it stands in place of a part of the base".into() } else { all.join(" and ") }
}

/// A block `[[effect]]` that a scenario may contain.
pub fn example(effect: &dyn Effect) -> String {
    let mut text = format!("[[effect]]\nname = \"{}\"\n", effect.name());
    for (info, value) in effect.parameters().iter().zip(typical(effect)) {
        let value = units::format(value, info.unit);
        let quoted = if info.unit == "1" { value } else { format!("\"{value}\"") };
        let _ = writeln!(text, "{} = {quoted}", info.key);
    }
    text
}

fn range(info: &ParameterInfo) -> String {
    if info.held {
        return "held".into();
    }
    let sign = if info.signed { "± " } else { "" };
    info.range.map_or(String::new(), |(low, high)| format!("{sign}{} to {}", number(low), number(high)))
}

fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-2..1e4).contains(&value.abs());
    if value.is_infinite() {
        "infinity".into()
    } else if plain {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Columns padded to equal width, two spaces apart.
fn aligned<const N: usize>(rows: &[[String; N]], indent: &str) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let mut line = String::from(indent);
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(line, "{cell}{}", " ".repeat(width - cell.chars().count() + 2));
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn indented(block: &str) -> String {
    block.lines().fold(String::new(), |text, line| text + "    " + line + "\n")
}

/// Words broken into lines of at most [`WIDTH`] characters.
fn wrapped(words: &str, indent: &str) -> String {
    let mut text = String::new();
    let mut line = String::from(indent);
    for word in words.split_whitespace() {
        let empty = line.trim().is_empty();
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            text.push_str(&line);
            text.push('\n');
            line = indent.into();
        } else if !empty {
            line.push(' ');
        }
        line.push_str(word);
    }
    text + &line + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_fits_100_columns_and_every_page_is_complete() {
        let pages: Vec<_> = REGISTRY.iter().map(|effect| page(*effect)).chain([table(&[])]).collect();
        for text in &pages {
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH && line == line.trim_end(), "{line}");
            }
        }
        for effect in REGISTRY {
            assert!(table(&[]).contains(effect.name()) && page(*effect).contains(&indented(&example(*effect))));
        }
    }

    #[test]
    fn a_misspelt_name_is_answered_with_the_nearest() {
        let error = execute(Some("stribek"), None).expect_err("no such effect");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("did you mean `stribeck`?"), "{error}");
        let error =
            execute(Some("\u{1b}[2Jgravity and everything else"), None).expect_err("no such effect").to_string();
        assert!(!error.contains('\u{1b}') && !error.contains("did you mean"), "{error}");
    }
}
