//! The report: serialisable views whose strings are already formatted, rendered as one HTML file and written as JSON.
//!
//! Data flows one way here too: outcomes, drawings and claims become a [`ReportView`] ([`scenario_view`], [`ReportView::assemble`]),
//! the view becomes HTML ([`render`]) and JSON ([`json`]). The templates lay out and never compute, so that whatever the page says
//! can be read from `report.json` as well. Titles, captions and paths come from users and are escaped; only drawings made by
//! the program go in as they are, after [`svg::inline`] has found nothing but drawing in them.

mod again;
pub mod anchor;
mod atlas;
mod baseline;
mod baseline_view;
mod comparison;
mod comparison_view;
mod discovery;
mod discovery_view;
mod figure_view;
mod free_form;
mod free_form_view;
mod gates;
mod glossary;
mod junit;
mod markdown;
mod mathml;
mod packed;
mod parameters;
pub mod provenance;
mod question;
mod question_view;
mod render;
mod rig;
mod rig_view;
mod scenario;
mod summary;
pub mod svg;
mod trend;
mod trust;
mod trust_view;
mod values;
mod verdict;
mod view;

use crate::units::readable as format;

pub use again::{figures, read};
pub use atlas::effect_view;
pub use baseline::{TOLERANCE, baseline};
pub use baseline_view::{BaselineView, ChangeView, ChangedInputView, HistoryView, PictureView, StepChangeView};
pub use comparison::comparison_view;
pub use discovery::discovery_view;
pub use free_form_view::{DependenceView, FreeFormView, ShapeView};
pub use glossary::glossary;
pub use junit::junit;
pub use markdown::markdown;
pub use parameters::formulation;
pub use provenance::{Provenance, SECTION as PROVENANCE_SECTION};
pub use question::question_view;
pub use render::{PAGES, RenderError, json, others, render};
pub use scenario::{FigureInput, NARROW_ENDING, scenario_view};
pub use trend::{Trend, figure_view};
pub use trust::trust_view;
pub use trust_view::TrustView;
pub use values::{Value, values};
pub use verdict::{Agreement, Change, Completeness, Found, Match, Passed, Tone, Verdict};
pub use view::{
    AbleView, AxisView, CandidateView, CheckView, ClaimView, ComparisonView, CurveView, DiscoveryView,
    EffectParameterView, EffectView, EquationView, FigureView, FileView, FittedView, GateView, Headline, InputView,
    LimitView, MatchView, NextView, NotTestableView, NoteView, OutlierView, ParameterView, PeakView, ProvenanceView,
    Quantity, QuestionView, ReportView, RigView, SCHEMA, ScenarioView, SettingView, SignalView, SignalsView, StepView,
    SummaryView, SymbolView, TallyView, TimingView,
};
