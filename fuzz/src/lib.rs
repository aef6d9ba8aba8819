//! What is fuzzed: every reader of files, with any bytes. A target passes when it returns; what the reader says is not judged,
//! but for what must hold of everything that it accepts.

use std::path::Path;
use std::sync::LazyLock;

use stickslip::effects::formula::{ActsOn, Blame, Formula, Stated, Statement};
use stickslip::effects::{Effect, Scales};
use stickslip::scenario::{self, Scenario};
use stickslip::{cache, claims, history, measurement, report, trial, units};

/// A target and its name, that of its corpus.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: &[Target] = &[
    ("scenario", scenario),
    ("delimited", delimited),
    ("universal", universal),
    ("workbook", workbook),
    ("report", report),
    ("history", history),
    ("claims", claims),
    ("trials", trials),
    ("cache", cache),
    ("quantity", quantity),
    ("formula", formula),
];

/// The readers' own tests cover larger files; these would only be slow here.
const LONGEST: usize = 1 << 16;

const RIG: &str = include_str!("../../tests/broken/base.toml");

/// A scenario of the paper's rig whose table has this name.
fn with_table(name: &str) -> Scenario {
    let sweep = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = 20\ndrive = 2.5e-6\n";
    let folder = std::env::temp_dir().join("stickslip-fuzz");
    std::fs::create_dir_all(&folder).expect("a folder");
    // The table must be there; its bytes are given to the reader.
    std::fs::write(folder.join(name), "none").expect("a file");
    let text = format!("{RIG}\n{sweep}\n[measurement]\nfile = '{name}'\n");
    scenario::load_text(folder.join("scenario.toml"), &text).expect("a sound scenario")
}

/// Reads a table for a scenario and, where it states enough itself, without one; numbers that are accepted are numbers.
fn table(scenario: &Scenario, name: &str, data: &[u8]) {
    if data.len() > LONGEST {
        return;
    }
    let read = measurement::load_bytes(scenario, data).ok().flatten();
    let surveyed = measurement::survey_bytes(Path::new(name), data).ok().map(|survey| survey.table);
    for table in read.into_iter().chain(surveyed) {
        let numbers =
            table.points.iter().flat_map(|p| [p.speed, p.load, p.drive, p.frequency, p.amplitude, p.amplitude_sd]);
        assert!(numbers.into_iter().all(f64::is_finite) && !table.points.is_empty());
        assert!(!table.summary().is_empty() && !table.ranges().is_empty());
    }
}

/// A scenario in TOML.
pub fn scenario(data: &[u8]) {
    if let Some(text) = short(data) {
        let _ = scenario::load_text("/nowhere/scenario.toml", text);
    }
}

/// A table of text.
pub fn delimited(data: &[u8]) {
    static SCENARIO: LazyLock<Scenario> = LazyLock::new(|| with_table("t.csv"));
    table(&SCENARIO, "t.csv", data);
}

/// A universal file.
pub fn universal(data: &[u8]) {
    static SCENARIO: LazyLock<Scenario> = LazyLock::new(|| with_table("t.uff"));
    table(&SCENARIO, "t.uff", data);
}

/// A workbook; what is no archive is put into one, so that the checksums do not hide what is inside. Two parts with a zero
/// between them are the sheet and the shared texts of Excel, one is the content of LibreOffice.
pub fn workbook(data: &[u8]) {
    static SCENARIO: LazyLock<Scenario> = LazyLock::new(|| with_table("t.xlsx"));
    if data.starts_with(b"PK") {
        return table(&SCENARIO, "t.xlsx", data);
    }
    let archive = match data.iter().position(|byte| *byte == 0) {
        None => archive(&[("content.xml", data)]),
        Some(at) => archive(&[
            ("xl/workbook.xml", b"<workbook><sheet name='A' id='1'/></workbook>"),
            ("xl/_rels/workbook.xml.rels", RELATIONS.as_bytes()),
            ("xl/sheet.xml", &data[..at]),
            ("xl/shared.xml", &data[at + 1..]),
        ]),
    };
    table(&SCENARIO, "t.xlsx", &archive);
}

const RELATIONS: &str =
    "<r><r Id='1' Type='/worksheet' Target='sheet.xml'/><r Id='2' Type='/sharedStrings' Target='shared.xml'/></r>";

/// An archive of these parts, not packed.
fn archive(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in parts {
        let length = (content.len() as u32).to_le_bytes();
        let fields =
            [&[20, 0, 0, 0, 0, 0, 0, 0, 0, 0][..], &checksum(content).to_le_bytes(), &length, &length].concat();
        let fields = [&fields[..], &(name.len() as u16).to_le_bytes(), &[0, 0]].concat();
        directory.extend(
            [&b"PK\x01\x02\x14\0"[..], &fields, &[0; 10], &(bytes.len() as u32).to_le_bytes(), name.as_bytes()]
                .concat(),
        );
        bytes.extend([&b"PK\x03\x04"[..], &fields, name.as_bytes(), content].concat());
    }
    let at = (bytes.len() as u32).to_le_bytes();
    bytes.extend([&directory[..], b"PK\x05\x06\0\0\0\0\0\0\0\0\0\0\0\0", &at, &[0, 0]].concat());
    bytes
}

/// The CRC of ZIP archives.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| sum >> 1 ^ 0xedb8_8320 & (sum & 1).wrapping_neg())
    })
}

/// A report that is read back.
pub fn report(data: &[u8]) {
    if let Some(Ok(view)) = short(data).map(report::read) {
        let values = report::values(&view);
        let _ = (report::baseline(&view, &view, "before"), values);
        let _ = report::markdown(&view);
        let _ = report::render(&view);
    }
}

/// A history.
pub fn history(data: &[u8]) {
    if data.len() <= LONGEST
        && let Ok(records) = history::records(data, Path::new("history.jsonl"))
    {
        let _ = history::series(&records, true);
    }
}

/// A ledger of claims.
pub fn claims(data: &[u8]) {
    if let Some(text) = short(data) {
        let _ = claims::ids(text, "claims.toml");
    }
}

/// Scores of trials that a new run is held against.
pub fn trials(data: &[u8]) {
    if let Some(summary) = short(data).and_then(|text| trial::parse(text).ok()) {
        assert!(trial::agreement(&summary, &summary).iter().all(trial::Both::agree));
        let _ = summary.scores_alone();
    }
}

/// An entry of the cache; what has no hash gets the right one, so that this does not hide what is inside.
pub fn cache(data: &[u8]) {
    let Some(text) = short(data) else { return };
    let sealed = if text.starts_with("stickslip-cache") { text.into() } else { cache::sealed(text) };
    let _ = cache::opened::<Vec<report::ClaimView>>(&sealed);
    let _ = cache::opened::<Vec<report::FigureView>>(&sealed);
}

/// A number with its unit.
pub fn quantity(data: &[u8]) {
    let Some(text) = short(data) else { return };
    for unit in ["1", "m/s", "N m s/rad", "Hz"] {
        if let Ok(value) = units::parse(text, unit) {
            let _ = units::format(value, unit);
        }
    }
}

/// A formula of a force with the parameters `a` and `b`; where it is one it is evaluated, and vanishes as it says.
pub fn formula(data: &[u8]) {
    let Some(text) = short(data) else { return };
    let stated = |key: &str| Stated { key: key.into(), unit: "1".into(), value: 1.0, range: None };
    let parameters = ["a", "b"].into_iter().filter(|key| text.contains(key)).map(stated).collect();
    let statement = Statement { name: "own".into(), text: text.into(), acts_on: ActsOn::Force, parameters };
    match Formula::read(statement) {
        Ok(formula) => {
            let mut p = formula.nominal();
            assert!(formula.torque(&p, 0.0, 0.0).is_some_and(|law| law.value.is_finite()));
            let _ = formula.torque(&p, f64::MAX, f64::NEG_INFINITY);
            let scales = Scales { has_contact: false, ..Scales::PAPER };
            for index in 0..p.len() {
                let (low, high) = formula.search_range(index, &scales);
                assert!(low <= high);
            }
            formula.zero().iter().for_each(|zero| p[zero.parameter] = zero.value);
            assert!(formula.vanishes(&p) && formula.torque(&p, 1e-9, -1e-9).is_some_and(|law| law.value == 0.0));
        }
        Err(fault) => {
            if let Blame::Text(span) = fault.blame {
                assert!(text.get(span).is_some());
            }
        }
    }
}

/// The bytes as text, where they are text and not too long.
fn short(data: &[u8]) -> Option<&str> {
    std::str::from_utf8(data).ok().filter(|text| text.len() <= LONGEST)
}
