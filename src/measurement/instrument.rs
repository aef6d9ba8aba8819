//! Tables whose columns the kind of file states, not a header: Touchstone (Version 1.1, EIA/IBIS 2002) and what
//! loudspeaker programs write (`.zma`, `.frd`). They become tables of text with a header, line for line.

use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::source::Source;

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Parameters of a network of so many ports.
    Touchstone(usize),
    /// An impedance.
    Impedance,
    /// A level and its phase.
    Response,
}

impl Kind {
    /// That of a lower-case extension.
    pub fn of(extension: &str) -> Option<Self> {
        match extension {
            "s1p" => Some(Self::Touchstone(1)),
            "s2p" => Some(Self::Touchstone(2)),
            "zma" => Some(Self::Impedance),
            "frd" => Some(Self::Response),
            _ => None,
        }
    }

    /// The header of its columns, parted by commas.
    fn header(self, options: &str) -> std::result::Result<String, String> {
        match self {
            Self::Impedance => Ok("frequency [Hz],|Z| [Ohm],arg Z [deg]".into()),
            Self::Response => Ok("frequency [Hz],level [dB],phase [deg]".into()),
            Self::Touchstone(ports) => touchstone(ports, options),
        }
    }
}

/// The header that an option line stands for: unit of the frequency, parameter and format, each with its default. Of two
/// ports what goes through them is read; the other columns have names that a scenario may choose.
fn touchstone(ports: usize, options: &str) -> std::result::Result<String, String> {
    let (mut unit, mut parameter, mut format) = ("GHz", "S".to_string(), "MA".to_string());
    let mut words = options.split_whitespace().map(str::to_uppercase);
    while let Some(word) = words.next() {
        match word.as_str() {
            "HZ" => unit = "Hz",
            "KHZ" => unit = "kHz",
            "MHZ" => unit = "MHz",
            "GHZ" => unit = "GHz",
            "S" | "Y" | "Z" => parameter = word,
            "RI" | "MA" | "DB" => format = word,
            "R" => drop(words.next()),
            _ => return Err(word),
        }
    }
    let of_parameter = match parameter.as_str() {
        "Y" => " [S]",
        "Z" => " [Ohm]",
        _ => "",
    };
    // In the order of the standard.
    let all: &[&str] = if ports == 1 { &["11"] } else { &["11", "21", "12", "22"] };
    let columns = |port: &&str| {
        let name = format!("{parameter}{port}");
        let is_read = ports == 1 || *port == "21";
        match format.as_str() {
            _ if !is_read => format!(",{name} first,{name} second"),
            "RI" => format!(",Re({name}){of_parameter},Im({name}){of_parameter}"),
            "DB" => format!(",{name} [dB],phase [deg]"),
            _ => format!(",amplitude{of_parameter},phase [deg]"),
        }
    };
    Ok(format!("frequency [{unit}]{}", all.iter().map(columns).collect::<String>()))
}

/// The text as a table: the header in the line of the options or of the first remark, every line of numbers parted by
/// commas, all else a remark.
pub(super) fn table(source: Source, kind: Kind) -> Result<Source> {
    let is_remark = |line: &str| line.starts_with(['!', '*', '#', '"', ';']);
    let is_option = |line: &str| line.trim_start().starts_with('#');
    let options = source.text.lines().position(is_option).filter(|_| matches!(kind, Kind::Touchstone(_)));
    let place = options.or_else(|| source.text.lines().position(|line| is_remark(line.trim())));
    let stated = options.and_then(|line| source.text.lines().nth(line)).unwrap_or("");
    let header = kind.header(stated.trim().trim_start_matches('#')).map_err(|word| {
        let title = format!("`{}`: the option line says {word}, which is not read", source.name);
        let help = "it states the unit of the frequency (Hz to GHz), the parameter (S, Y or Z) and the format (RI, MA or DB), as `# GHz S RI R 50`";
        Error::Input(whole_file(&title, help))
    })?;
    let mut lines: Vec<String> = Vec::new();
    for (number, line) in source.text.lines().enumerate() {
        // A remark may stand behind the numbers.
        let numbers = line.split('!').next().unwrap_or("").trim();
        lines.push(match () {
            () if Some(number) == place => header.clone(),
            () if numbers.is_empty() || is_remark(numbers) => "#".into(),
            () => numbers.split([' ', '\t', ',']).filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(","),
        });
    }
    if place.is_none() {
        lines.insert(0, header);
    }
    Ok(Source { text: lines.join("\n") + "\n", ..source })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(kind: Kind, text: &str) -> Result<String> {
        table(Source { name: "x".into(), path: "x".into(), text: text.into() }, kind).map(|source| source.text)
    }

    #[test]
    fn options_name_the_columns_line_for_line() {
        let text = "! analyser\n# MHz S DB R 50\n 1.0 -3 10 -20 30 0 0 -3 1 ! first\n";
        let table = read(Kind::Touchstone(2), text).expect("a table");
        let expected = "#\nfrequency [MHz],S11 first,S11 second,S21 [dB],phase [deg],S12 first,S12 second,S22 first,S22 second\n\
                        1.0,-3,10,-20,30,0,0,-3,1\n";
        assert_eq!(table, expected);
        let one = read(Kind::Touchstone(1), "#\n1 0.5 10\n").expect("a table");
        assert_eq!(one, "frequency [GHz],amplitude,phase [deg]\n1,0.5,10\n");
        assert!(
            read(Kind::Touchstone(1), "# GHz H RI\n1 0.5 10\n").expect_err("hybrid").to_string().contains("says H")
        );
    }

    #[test]
    fn loudspeaker_files_have_columns_by_their_kind() {
        let table = read(Kind::Impedance, "* Arb1\n 10.0 +7.1 25\n").expect("a table");
        assert_eq!(table, "frequency [Hz],|Z| [Ohm],arg Z [deg]\n10.0,+7.1,25\n");
        assert_eq!(read(Kind::Response, "1,2,3\n").expect("a table"), "frequency [Hz],level [dB],phase [deg]\n1,2,3\n");
    }
}
