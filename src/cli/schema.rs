//! `stickslip schema`: the JSON Schemas of what the program writes, from the types that write it.

use super::discover::Told;
use super::json::Stamped;
use super::prony::View;
use crate::compare::{self, ComparisonJson};
use crate::error::{Error, Result};
use crate::report::ReportView;
use crate::{discover, history, prony, report, terminal, trial};
use clap::ValueEnum;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

/// What has a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// `compare --json`
    Comparison,
    /// `discover --json`
    Discovery,
    /// A line of `report --history`
    History,
    /// `prony --json`
    Prony,
    /// `report.json`
    Report,
    /// `trial --json`
    Trial,
}

/// Prints a schema.
///
/// # Errors
/// That standard output cannot be written to.
pub fn execute(name: Name) -> Result<()> {
    let text = serde_json::to_string_pretty(&schema(name)).map_err(|why| Error::Unfinished(why.to_string()))?;
    terminal::print(&(text + "\n"))
}

/// The schema of draft 2020-12 of what is written under a name.
fn schema(name: Name) -> Schema {
    let (mut schema, version, title, description) = match name {
        Name::Comparison => (
            of::<Stamped<'_, ComparisonJson>>(),
            compare::SCHEMA,
            "Comparison",
            "What stickslip compare --json writes. Of a rig that is not the paper's, conditions have drive and drive_unit and their \
             series, peaks amplitude and amplitude_unit; speed_m_s and load_n only where there is a contact, keys with a unit only \
             where it is theirs; missing_force in place of contact where there is none.",
        ),
        Name::Discovery => (
            of::<Stamped<'_, Told<'_>>>(),
            discover::SCHEMA,
            "Discovery",
            "What stickslip discover --json writes. Of a rig that is not the paper's, next_measurement has drive and drive_unit; \
             speed_m_s and load_n only where there is a contact; missing_force in place of contact where there is none.",
        ),
        Name::History => (
            of::<history::Record>(),
            history::SCHEMA,
            "Record of a run",
            "One line of the history.jsonl that stickslip report --history extends.",
        ),
        Name::Prony => (of::<View<'_>>(), prony::SCHEMA, "Moduli as a series", "What stickslip prony --json writes."),
        Name::Report => (of::<ReportView>(), report::SCHEMA, "Report", "report.json of stickslip report."),
        Name::Trial => (of::<trial::Summary>(), trial::SCHEMA, "Blind trials", "What stickslip trial --json writes."),
    };
    schema.insert("title".into(), format!("stickslip: {title}").into());
    schema.insert("description".into(), description.into());
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        properties.insert("schema".into(), json!({ "const": version }));
    }
    schema
}

fn of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.with_transform(RecursiveTransform(plain)).into_generator().into_root_schema_for::<T>()
}

/// A number that is not finite is written as null; the sizes of the program's own numbers are nobody's concern. Texts
/// as they are read, not as the source marks them up.
fn plain(schema: &mut Schema) {
    schema.remove("format");
    if let Some(Value::String(text)) = schema.get_mut("description") {
        *text = text.replace('\n', " ").replace("\\[", "[").replace("\\]", "]").replace("[`", "`").replace("`]", "`");
    }
    if schema.get("type") == Some(&"number".into()) {
        schema.insert("type".into(), json!(["number", "null"]));
    }
}
