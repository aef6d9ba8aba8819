//! What the report says, as data. The JSON is this; the HTML shows this and nothing else.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use super::baseline_view::{BaselineView, HistoryView, StepChangeView};
pub use super::comparison_view::{ComparisonView, FittedView, MatchView, OutlierView, PeakView};
pub use super::discovery_view::{CandidateView, DiscoveryView, NextView, NotTestableView, StepView};
pub use super::figure_view::{FigureView, FileView, NoteView};
pub use super::free_form_view::FreeFormView;
pub use super::question_view::{AbleView, QuestionView, SettingView};
pub use super::rig_view::{EquationView, RigView, SignalView, SignalsView, SymbolView};
pub use super::trust_view::TrustView;
use super::verdict::{Agreement, Completeness, Passed, Verdict};
pub use crate::units::readable::Quantity;

/// Schema of `report.json`.
pub const SCHEMA: &str = "stickslip.report/1";

/// The whole report.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct ReportView {
    /// [`SCHEMA`].
    pub schema: String,
    /// Title of the page.
    pub title: String,
    /// One paragraph: what this is.
    pub lead: String,
    /// Verdicts first.
    pub summary: SummaryView,
    /// What scenarios and command line demand, failures first.
    #[serde(default)]
    pub gates: Vec<GateView>,
    /// The claims ledger, in the order of the paper.
    pub claims: Vec<ClaimView>,
    /// One section per scenario.
    pub scenarios: Vec<ScenarioView>,
    /// The atlas of effects, in the order of the catalogue; empty where it was not drawn.
    pub atlas: Vec<EffectView>,
    /// The numbers that prove the solvers.
    pub verification: Vec<CheckView>,
    /// This run against an earlier one, where there is one to hold it against.
    #[serde(default)]
    pub baseline: Option<BaselineView>,
    /// The runs before, where they are kept.
    #[serde(default)]
    pub history: Option<HistoryView>,
    /// How far the search can be trusted, where the report has one.
    #[serde(default)]
    pub trust: Option<TrustView>,
    /// The equations of the model without effects.
    #[serde(default)]
    pub equations: Vec<EquationView>,
    /// Symbols.
    pub glossary: Vec<SymbolView>,
    /// Versions, inputs, timings, host: the only part that may differ between two runs on the same input.
    pub provenance: ProvenanceView,
}

/// What to know first.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema, Serialize, Deserialize)]
pub struct SummaryView {
    /// One sentence with the result of everything.
    pub sentence: String,
    /// Number of claims by verdict, the most serious first.
    pub claims: Vec<TallyView>,
    /// Number of checks of the solvers by verdict.
    pub verification: Vec<TallyView>,
    /// Number of scenarios by completeness.
    pub scenarios: Vec<TallyView>,
    /// Number of comparisons with measurements by what the model leaves.
    pub comparisons: Vec<TallyView>,
    /// One line per scenario with measurements, failures first.
    pub compared: Vec<Headline>,
    /// What else deserves attention, failures first.
    pub headlines: Vec<Headline>,
}

/// A demand and what came of it.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct GateView {
    /// Id of the scenario.
    pub scenario: String,
    /// Where the report treats what is judged.
    pub anchor: String,
    /// Key in the table `[gate]`.
    pub gate: String,
    /// What was found.
    pub found: Quantity,
    /// What is demanded.
    pub demanded: Quantity,
    /// Whether it holds.
    pub verdict: Passed,
}

/// How many have one verdict.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct TallyView {
    /// The verdict in words.
    pub verdict: String,
    /// How many.
    pub count: usize,
}

/// A sentence that leads to its place in the report.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Headline {
    /// The verdict in words.
    pub verdict: String,
    /// What has that verdict.
    pub subject: String,
    /// Why, or with what numbers; may be empty.
    pub detail: String,
    /// Where the report treats it.
    pub anchor: String,
}

/// A published statement, computed and judged.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct ClaimView {
    /// Stable identifier, e.g. `no-influence-of-mu`.
    pub id: String,
    /// Id in the page; [`ReportView::assemble`] fills it.
    pub anchor: String,
    /// Section of the paper where it stands.
    pub section: String,
    /// The statement in our words.
    pub statement: String,
    /// The quantity that decides it.
    pub quantity: String,
    /// Expected value or relation.
    pub expected: String,
    /// What the program computed.
    pub computed: String,
    /// Tolerance.
    pub tolerance: String,
    /// Why this tolerance.
    pub reason: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Caveat, or what would make it follow; may be empty.
    pub note: String,
    /// Anchor of the figure that shows it ([`super::anchor::figure`]); dropped where the report has no such figure.
    pub figure: Option<String>,
}

/// A scenario: what was simulated, with which numbers, and what came out.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct ScenarioView {
    /// Stable identifier of the scenario.
    pub id: String,
    /// Stable id of its section in the page.
    pub anchor: String,
    /// Title of the user.
    pub title: String,
    /// What it is about; may be empty.
    pub description: String,
    /// Where its numbers come from; may be empty.
    pub provenance: String,
    /// Effects beyond the base contact, each with its parameters.
    pub effects: Vec<String>,
    /// Whether every point is steady.
    pub status: Completeness,
    /// Number of steady states asked for.
    pub points: usize,
    /// Of these, steady.
    pub steady: usize,
    /// Of these, self-excited.
    pub self_excited: usize,
    /// Of these, without an answer.
    pub failed: usize,
    /// First reasons given by points that are not steady, each once.
    pub reasons: Vec<String>,
    /// Figures.
    pub figures: Vec<FigureView>,
    /// Every number that went in.
    pub parameters: Vec<ParameterView>,
    /// What distinguishes the curves: the columns of their table.
    pub axes: Vec<AxisView>,
    /// One row per curve.
    pub curves: Vec<CurveView>,
    /// Limiting cases in closed form.
    pub limits: Vec<LimitView>,
    /// Model against measurements, where there are any.
    pub comparison: Option<ComparisonView>,
    /// The rig, where it is not the paper's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rig: Option<RigView>,
    /// What is missing, where there are measurements.
    #[serde(default)]
    pub discovery: Option<DiscoveryView>,
    /// On which variable what is missing depends, where something is left unexplained.
    #[serde(default)]
    pub free_form: Option<FreeFormView>,
    /// Which effects can give the curve that the scenario asks for.
    #[serde(default)]
    pub question: Option<QuestionView>,
    /// The file as the user named it.
    pub path: String,
    /// BLAKE3 hash of the file and everything it extends.
    pub hash: String,
}

/// A parameter with its origin.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ParameterView {
    /// Key in a scenario file, e.g. `rig.inertia`.
    pub key: String,
    /// Symbol.
    pub symbol: String,
    /// Meaning.
    pub name: String,
    /// Value with unit; a list for the axes of a sweep.
    pub value: String,
    /// SI unit in the notation of scenario files; `1` for pure numbers, empty for words.
    pub unit: String,
    /// Where it comes from.
    pub source: String,
}

/// An effect of the catalogue and what it does to resonance curves.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct EffectView {
    /// Name in the registry.
    pub name: String,
    /// Stable id in the page.
    pub anchor: String,
    /// What it is called.
    pub title: String,
    /// Part of the experiment that it belongs to.
    pub group: String,
    /// The law.
    pub equation: String,
    /// What it is physically.
    pub meaning: String,
    /// Its parameters.
    pub parameters: Vec<EffectParameterView>,
    /// Where the base returns.
    pub zero: String,
    /// Where the law comes from.
    pub source: String,
    /// Curves against strength.
    pub figure: FigureView,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct EffectParameterView {
    /// Key in a scenario file.
    pub key: String,
    /// Symbol.
    pub symbol: String,
    /// Meaning.
    pub meaning: String,
    /// SI unit in the notation of scenario files; `1` for pure numbers.
    pub unit: String,
    /// Magnitudes that a search covers.
    pub range: String,
}

/// A setting that distinguishes curves, or is the same for all of them.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct AxisView {
    /// Field of [`CurveView`].
    pub key: String,
    /// Symbol.
    pub symbol: String,
    /// Meaning.
    pub name: String,
    /// The common value where all curves have the same; such an axis is not a column.
    pub fixed: Option<Quantity>,
}

/// What one curve amounts to.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a column of the table.
pub struct CurveView {
    /// Formulation solved.
    pub formulation: Quantity,
    /// Steps per cycle of the Euler procedure.
    pub euler_steps: Quantity,
    /// u0.
    pub drive: Quantity,
    /// W.
    pub load: Quantity,
    /// mu.
    pub friction: Quantity,
    /// V.
    pub speed: Quantity,
    /// Frequency of the largest amplitude on the grid.
    pub peak_frequency: Quantity,
    /// Largest amplitude on the grid.
    pub peak_amplitude: Quantity,
    /// Phase there.
    pub peak_phase: Quantity,
    /// Amplitude of the arm's speed there.
    pub peak_speed_amplitude: Quantity,
    /// Share of the cycle spent sticking there.
    pub stick_fraction: Quantity,
    /// Steady points.
    pub steady: usize,
    /// Self-excited points.
    pub self_excited: usize,
    /// Points without an answer.
    pub failed: usize,
}

/// Peak of a limiting case in closed form.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct LimitView {
    /// Which case.
    pub case: String,
    /// u0.
    pub drive: Quantity,
    /// Frequency of the largest amplitude.
    pub peak_frequency: Quantity,
    /// Largest amplitude.
    pub peak_amplitude: Quantity,
    /// Frequency of the largest speed amplitude.
    pub speed_peak_frequency: Quantity,
    /// Largest speed amplitude.
    pub speed_peak: Quantity,
}

/// A number that proves a solver.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema, Serialize, Deserialize)]
pub struct CheckView {
    /// Id in the page; [`ReportView::assemble`] fills it.
    pub anchor: String,
    /// Name of the check.
    pub name: String,
    /// What is compared with what.
    pub compares: String,
    /// Expected, with unit.
    pub expected: String,
    /// Computed, with unit.
    pub computed: String,
    /// Difference.
    pub difference: String,
    /// Tolerance.
    pub tolerance: String,
    /// The verdict.
    pub verdict: Agreement,
}

/// Where the report comes from.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct ProvenanceView {
    /// Program.
    pub program: String,
    /// Its version.
    pub version: String,
    /// Version of the comparison with measurements.
    #[serde(default)]
    pub comparator: String,
    /// Schemas written or read.
    pub schemas: Vec<String>,
    /// Inputs with their hashes.
    pub inputs: Vec<InputView>,
    /// How to run it again.
    pub command: String,
    /// When it was made.
    pub generated: String,
    /// Operating system.
    pub os: String,
    /// Architecture.
    pub arch: String,
    /// Threads.
    pub threads: String,
    /// Wall times.
    pub timings: Vec<TimingView>,
    /// Wall times of the runs that are kept, this one included.
    #[serde(default)]
    pub times: Option<FigureView>,
    /// Where they moved.
    #[serde(default)]
    pub slower: Vec<StepChangeView>,
}

/// An input file.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct InputView {
    /// Scenario.
    pub id: String,
    /// The file as the user named it.
    pub path: String,
    /// BLAKE3 hash of the file and everything it extends.
    pub hash: String,
}

/// Wall time of one part of the run.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct TimingView {
    /// Part.
    pub part: String,
    /// Wall time with unit.
    pub time: String,
}
