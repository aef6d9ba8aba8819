//! From what was written to what is meant: the table of contents of a scenario file.

use std::collections::BTreeMap;

use super::additions::{effects, fits_formulation, free, measurement};
use super::axes;
use super::extends::Document;
use super::gate::gate;
use super::question::question;
use super::read_rig::{self, contact, instrument, rig};
use super::reader::{Reader, TOP_LEVEL, Table, WHOLE};
use super::rig::{Rig, Signals};
use super::source::Store;
use super::types::{Contact, Formulation, Instrument, Scenario, Sweep};
use super::written::{Entry, Node, inside};
use super::{LoadOptions, Role};
use crate::error::{Error, Result};
use crate::parameter::Coordinate;

/// Validates a document; all its problems are told at once.
pub(crate) fn scenario(
    document: &Document,
    id: String,
    store: Store,
    options: &LoadOptions<'_>,
    role: Role,
) -> Result<Scenario> {
    let mut reader = Reader::new(&document.sources);
    let meant = read(&mut reader, document, id, store, options, role);
    match (reader.into_message(), meant) {
        (None, Some(scenario)) => Ok(scenario),
        (Some(message), _) => Err(Error::Input(message)),
        (None, None) => Err(Error::Input(
            "error: the scenario is incomplete\n  = help: compare it with the file that `stickslip init` writes".into(),
        )),
    }
}

fn read(
    reader: &mut Reader<'_>,
    document: &Document,
    id: String,
    store: Store,
    options: &LoadOptions<'_>,
    role: Role,
) -> Option<Scenario> {
    let entries = document.entries.as_slice();
    let whole = Table { name: WHOLE.into(), place: reader.top(), entries };
    let optional: Vec<&str> = TOP_LEVEL.iter().copied().filter(|key| *key != "title").collect();
    reader.keys(&whole, &[("title", "text")], &optional);
    let get = |key: &str| entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node);
    let title = get("title").and_then(|node| title(reader, node));
    let mut text = |key: &str| {
        let text = get(key).map_or(Some(String::new()), |node| reader.text(key, node))?;
        Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    let (description, provenance) = (text("description"), text("provenance"));
    let figures =
        get("figures").map(|node| reader.names("figures", node, options.figure_names, "a figure that can be drawn"));

    let bench = Bench::read(reader, entries);
    let of = (bench.rig.map(|rig| rig.coordinate()), bench.contact.map(|contact| contact.is_some()));
    let effects = effects(reader, get("effect"), of, options);
    fits_formulation(reader, get("effect"), &effects, bench.is_of_paper());
    let Bench { rig, contact, instrument, signals, sweep } = bench;
    let measurement = measurement(reader, entries, store);
    let question = question(reader, entries, sweep.as_ref().and_then(Option::as_ref));
    let free = free(reader, entries, (rig.as_ref(), contact.flatten().is_some(), instrument.as_ref()), &effects);
    let of_options = options.effects.iter().map(|effect| effect.name());
    let known: Vec<&str> = of_options.chain(effects.iter().map(|setting| setting.name())).collect();
    let gate = gate(reader, entries, &readings(rig.as_ref()), &known);
    if get("sweep").is_none() && get("measurement").is_none() && role == Role::Complete {
        let help = "add [sweep] with frequency, speed, load and drive, or [measurement] with file; \
                    a file with neither can only be extended by others";
        reader.fail(&reader.top(), "the scenario has neither [sweep] nor [measurement]", "nothing to solve", help);
    }
    let path = document.sources.first()?.path.clone();
    Some(Scenario {
        id,
        path,
        hash: document.hash.clone(),
        title: title?,
        description: description?,
        provenance: provenance?,
        origins: origins(document),
        rig: rig?,
        contact: contact?,
        instrument: instrument?,
        signals: signals?,
        sweep: sweep?,
        effects,
        measurement: measurement?,
        question: question?,
        free,
        figures,
        gate: gate?,
    })
}

/// What is measured with and how; of each part nothing where it is not sound.
struct Bench {
    rig: Option<Rig>,
    contact: Option<Option<Contact>>,
    instrument: Option<Instrument>,
    signals: Option<Signals>,
    sweep: Option<Option<Sweep>>,
}

impl Bench {
    fn read(reader: &mut Reader<'_>, entries: &[Entry]) -> Self {
        let rig = rig(reader, entries);
        // The paper's rig is nothing without a contact.
        let arm = read_rig::means_arm(entries);
        let contact = contact(reader, entries, arm);
        let instrument = instrument(reader, entries, rig.as_ref());
        let signals = rig.zip(instrument).map(|(rig, instrument)| read_rig::signals(&rig, &instrument));
        // Without rig or instrument it is not known in which unit the drive of another rig is.
        let drive = signals.or(arm.then_some(Signals::ARM)).map(|signals| signals.drive.unit);
        let sweep = match &reader.table(entries, "sweep") {
            Some(table) => drive.and_then(|drive| axes::sweep(reader, table, drive, contact)).map(Some),
            None => Some(None),
        };
        Self { rig, contact, instrument, signals, sweep }
    }

    /// Whether anything is solved in the paper's formulation.
    fn is_of_paper(&self) -> bool {
        match &self.sweep {
            Some(Some(sweep)) => sweep.formulation.contains(&Formulation::Paper),
            _ => self.contact.flatten().is_some_and(|contact| contact.formulation == Formulation::Paper),
        }
    }
}

/// Units of what may be read of a rig, that of its coordinate first.
fn readings(rig: Option<&Rig>) -> Vec<&'static str> {
    let oscillator = rig.is_some_and(|rig| !rig.is_arm());
    match rig.map_or(Coordinate::Angle, Rig::coordinate) {
        Coordinate::Angle if oscillator => vec!["rad", "rad/s", "rad/s^2", "V"],
        Coordinate::Angle => vec!["rad"],
        Coordinate::Displacement => vec!["m", "m/s", "m/s^2", "V"],
    }
}

/// Origins of the numbers of rig, contact and instrument that stand in another file than the first.
fn origins(document: &Document) -> BTreeMap<String, String> {
    let mut origins = BTreeMap::new();
    for table in document.entries.iter().filter(|table| ["rig", "contact", "instrument"].contains(&table.key.as_str()))
    {
        for entry in inside(&table.node).iter().filter(|entry| entry.node.place.file > 0) {
            if let Some(origin) = document.provenances.get(entry.node.place.file).filter(|origin| !origin.is_empty()) {
                origins.insert(format!("{}.{}", table.key, entry.key), origin.clone());
            }
        }
    }
    origins
}

fn title(reader: &mut Reader<'_>, node: &Node) -> Option<String> {
    let help = "write one line that says what is shown: title = \"…\"";
    let text = reader.text("title", node)?;
    if text.trim().is_empty() || text.chars().count() > 200 || text.chars().any(char::is_control) {
        reader.fail(&node.place, "`title` needs one line of 1 to 200 characters", "not such a line", help);
        return None;
    }
    Some(text)
}
