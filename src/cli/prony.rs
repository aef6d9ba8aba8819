//! `stickslip prony`: a material's measured moduli as a series of relaxations, and as the contact of a scenario.

use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::{Global, Json, say, simulate};
use crate::error::{Error, Result};
use crate::figures;
use crate::measurement;
use crate::prony::{self, Analysis, Branch, Contact, Interval, Kind, SCHEMA, Score, branches, fragment, hertz, told};
use crate::scenario;
use crate::scenario::diagnostic::whole_file;
use crate::units::{self, readable::percent};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::TAU;
use std::path::PathBuf;

/// The terms of what is printed, for `--help`.
pub const TERMS: &str = "The table has one row per frequency (storage and loss modulus, or storage modulus and loss factor) or per time (relaxation \
    modulus, or creep compliance), its header naming quantities and units: frequency_hz,storage_mpa,loss_mpa or time_s,relaxation_mpa or \
    time_s,compliance_1_mpa. What is printed: a series is E_0 and terms of a modulus E_j and a relaxation time tau_j (generalised Maxwell \
    model; of a compliance, J_0 and retardations). left out is the root mean square of the relative error at blocks of neighbouring rows \
    that were predicted from the others; of all series within a standard error of the best the one with the fewest terms is taken. A \
    spring-pot is E_0 + A (i f/f_m)^a, an elastic part and a fractional element. Ranges in brackets are 95 % intervals. effects.toml holds \
    stiffness and damping of [contact] and as few maxwell-branch effects, of up to eight, as come as near to the series as that does to the table. \
    docs/prony.md has the method.";

/// Arguments of the command.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// The table of moduli
    table: PathBuf,
    /// Stiffness per modulus, a length: stiffness = modulus x this [default: a contact of 1 N/m, to be multiplied]
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    geometry: Option<f64>,
    /// Scenario in whose band of frequencies the contact has to be near [default: the band of the table]
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Folder of the figure and of effects.toml
    #[arg(long, default_value = "output", value_name = "DIR")]
    out: PathBuf,
    /// Write series, spring-pot and contact as JSON; - for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    drawn: FigureOutput,
}

fn length(text: &str) -> std::result::Result<f64, String> {
    match units::parse(text, "m") {
        Ok(value) if value > 0.0 => Ok(value),
        Ok(_) => Err("it needs to be more than zero".into()),
        Err(why) => Err(why.to_string()),
    }
}

/// Fits, prints, draws and writes.
pub fn execute(arguments: &Arguments, global: &Global) -> Result<()> {
    let a = arguments;
    let moduli = prony::read(&a.table)?;
    let band = band(a)?;
    let json = a.json.clone().map(Json::from);
    if let Some(json) = &json {
        json.free(SCHEMA, Some(&a.out))?;
    }
    let inputs = [Some(a.table.as_path()), a.scenario.as_deref()].into_iter().flatten();
    let out = Folder::open(&a.out, &a.drawn, inputs)?;
    let analysis = Analysis::of(moduli);
    let known = analysis.moduli.band();
    let contact = Contact::nearest(&analysis, band.unwrap_or((known.0 / TAU, known.1 / TAU))).map_err(|why| {
        let help = "nothing is determined outside the band of the table: shift it to the experiment's temperature, or measure there";
        Error::Input(whole_file(&format!("`{}`: {why}", a.table.display()), help))
    })?;
    if let Some(json) = &json {
        json.write(&View::of(&analysis, &contact, a.geometry), SCHEMA)?;
    }
    let drawing = figures::prony::draw(&analysis, band.map(|_| &contact));
    let id = a.table.file_stem().map_or("prony".into(), |stem| stem.to_string_lossy().into_owned());
    let drawing = drawing.map_err(|why| Error::Unfinished(why.to_string()))?;
    let mut files = simulate::write(drawing, &id, &out)?.files;
    files.push(format!("{id}/effects.toml"));
    out.write(&files[files.len() - 1], fragment(&analysis, &contact, a.geometry).as_bytes())?;
    if !json.as_ref().is_some_and(Json::to_standard_output) {
        words(&analysis, &contact, a.geometry).iter().try_for_each(|line| say(global, line))?;
        files.iter().try_for_each(|name| say(global, &format!("  {}", a.out.join(name).display())))?;
    }
    Ok(())
}

/// Lowest and highest frequency of the scenario's sweep and measurements \[Hz\].
fn band(a: &Arguments) -> Result<Option<(f64, f64)>> {
    let Some(path) = &a.scenario else { return Ok(None) };
    let scenario = scenario::load(path)?;
    let table = measurement::load(&scenario)?;
    let measured = table.iter().flat_map(|table| table.points.iter().map(|point| point.frequency));
    let swept = scenario.sweep.iter().flat_map(|sweep| sweep.frequency.iter().copied());
    let (low, high) = figures::axes::range(measured.chain(swept));
    Ok((low <= high).then_some((low, high)))
}

/// What is printed.
fn words(analysis: &Analysis, contact: &Contact, factor: Option<f64>) -> Vec<String> {
    let m = &analysis.moduli;
    let unit = m.kind.unit();
    let (low, high) = m.band();
    let mut lines = vec![format!(
        "{}: {} of {}, {:.1} decades ({})",
        m.file,
        units::count(m.points.len(), "row"),
        m.kind.names().join(" and "),
        m.decades(),
        hertz(low / TAU, high / TAU)
    )];
    lines.extend(m.notes.iter().map(|note| format!("  note: {note}")));
    let misses = |fitted, score: Score| {
        let one = |(name, share): (&&str, &f64)| format!("{name} {}", percent(*share, 2));
        let rms: Vec<String> = m.kind.names().iter().zip(&m.rms(fitted)).map(one).collect();
        format!("rms error {}; left out {}", rms.join(", "), percent(score.mean.sqrt(), 2))
    };
    let (series, pot) = (&analysis.series, &analysis.spring_pot);
    let terms = units::count(analysis.terms(), "term");
    lines.push(format!(
        "series of {terms} (1 to {} tried): {}",
        analysis.scores.len(),
        misses(&series.fitted, series.score)
    ));
    let symbol = if m.kind == Kind::Creep { "J" } else { "E" };
    let amount = |name: &str, interval: &Interval| {
        let [value, low, high] = units::format_interval([interval.value, interval.low, interval.high], unit);
        format!("  {name} = {value} ({low} to {high})")
    };
    lines.push(amount(&format!("{symbol}_0"), &series.amounts[0]));
    for (j, (interval, time)) in series.amounts[1..].iter().zip(analysis.times()).enumerate() {
        let line = amount(&format!("{symbol}_{}", j + 1), interval);
        lines.push(format!("{line}, tau_{} = {}", j + 1, told(*time, "s")));
    }
    let [a, from, to] =
        units::format_interval([analysis.exponent.value, analysis.exponent.low, analysis.exponent.high], "1");
    lines.push(format!("spring-pot: a = {a} ({from} to {to}); {}", misses(&pot.fitted, pot.score)));
    lines.push(amount(&format!("{symbol}_0"), &pot.amounts[0]));
    lines.push(amount("A", &pot.amounts[1]));
    lines.extend(analysis.remarks.iter().map(|remark| format!("note: {remark}")));
    let [storage, loss] = contact.rms.map(|share| percent(share, 2));
    lines.push(format!(
        "as a contact, {}: {}, rms error to the series {storage} of the storage and {loss} of the loss modulus",
        hertz(contact.band_hz[0], contact.band_hz[1]),
        branches(contact)
    ));
    if factor.is_none() {
        lines.push(
            "  note: no --geometry, so for a contact stiffness of 1 N/m: multiply by that of your contact".into(),
        );
    }
    let outside = contact.band_hz[0] < low / TAU * (1.0 - f64::EPSILON.sqrt())
        || contact.band_hz[1] > high / TAU * (1.0 + f64::EPSILON.sqrt());
    if outside {
        lines.push("  note: part of that lies outside the band of the table, where nothing is determined".into());
    }
    lines
}

/// The JSON.
#[derive(JsonSchema, Serialize)]
pub struct View<'a> {
    schema: &'static str,
    program: &'static str,
    table: TableView<'a>,
    series: LawView,
    /// Of its terms in order; of a compliance retardation times.
    relaxation_times_s: &'a [f64],
    /// Of series of 1, 2, ... terms.
    left_out: Vec<LeftOut>,
    spring_pot: LawView,
    exponent: Interval,
    /// A storage and a loss modulus that do not depend on the frequency.
    constant: Option<LeftOut>,
    contact: ContactView<'a>,
    /// What the data cannot tell.
    remarks: &'a [String],
}

#[derive(JsonSchema, Serialize)]
struct TableView<'a> {
    file: &'a str,
    /// BLAKE3 of its bytes.
    hash: &'a str,
    kind: Kind,
    rows: usize,
    unit: &'static str,
    band_hz: [f64; 2],
    notes: &'a [String],
}

#[derive(JsonSchema, Serialize)]
struct LawView {
    /// Root mean square of the relative error of each reading: storage and loss modulus, or the one of a time.
    rms_error: Vec<f64>,
    left_out: LeftOut,
    /// Elastic part first, with 95 % intervals, in the unit of the table.
    amounts: Vec<Interval>,
    /// Where the amount of a spring-pot is that of its modulus: frequency \[rad/s\] or time \[s\].
    center: f64,
}

#[derive(JsonSchema, Serialize)]
struct LeftOut {
    /// Root mean square of the relative error at blocks that were left out.
    rms_error: f64,
    /// Mean over the blocks of its square.
    mean_square: f64,
    /// Standard error of that mean.
    standard_error: f64,
}

#[derive(JsonSchema, Serialize)]
struct ContactView<'a> {
    /// Stiffness per modulus \[m\]; none where the contact is one of 1 N/m.
    geometry_m: Option<f64>,
    #[serde(flatten)]
    contact: &'a Contact,
    /// The largest of its branches.
    #[serde(flatten)]
    branch: Branch,
}

impl From<Score> for LeftOut {
    fn from(Score { mean, standard_error }: Score) -> Self {
        Self { rms_error: mean.sqrt(), mean_square: mean, standard_error }
    }
}

impl<'a> View<'a> {
    fn of(analysis: &'a Analysis, contact: &'a Contact, geometry_m: Option<f64>) -> Self {
        let m = &analysis.moduli;
        let law = |judged: &prony::Judged| LawView {
            rms_error: m.rms(&judged.fitted),
            left_out: judged.score.into(),
            amounts: judged.amounts.clone(),
            center: judged.fitted.center,
        };
        let (low, high) = m.band();
        Self {
            schema: SCHEMA,
            program: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
            table: TableView {
                file: &m.file,
                hash: &m.hash,
                kind: m.kind,
                rows: m.points.len(),
                unit: m.kind.unit(),
                band_hz: [low / TAU, high / TAU],
                notes: &m.notes,
            },
            series: law(&analysis.series),
            relaxation_times_s: analysis.times(),
            left_out: analysis.scores.iter().map(|score| (*score).into()).collect(),
            spring_pot: law(&analysis.spring_pot),
            exponent: analysis.exponent,
            constant: analysis.constant.map(LeftOut::from),
            contact: ContactView { geometry_m, contact, branch: contact.branches[0] },
            remarks: &analysis.remarks,
        }
    }
}
