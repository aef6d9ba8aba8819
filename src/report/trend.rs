//! The runs of a history, as the report tells them.

use super::baseline::signed;
use super::baseline_view::{HistoryView, StepChangeView};
use super::scenario::{FigureInput, figure};
use super::verdict::Change;
use super::view::{FigureView, Quantity, ReportView};
use crate::figures::style::significant;
use crate::history::{Kind, Record, Records, Series, Step};

/// What a history comes to, before it is drawn.
#[derive(Debug, Clone, Default)]
pub struct Trend {
    /// Errors and peak frequencies by run.
    pub values: Vec<Series>,
    /// Wall times by run.
    pub times: Vec<Series>,
}

impl Trend {
    /// The series of the records, the last of which is this run.
    pub fn of(records: &Records) -> Self {
        Self { values: crate::history::series(records, false), times: crate::history::series(records, true) }
    }
}

/// A figure of a section of the page.
pub fn figure_view(section: &str, input: &FigureInput) -> FigureView {
    figure(section, input)
}

impl ReportView {
    /// The report with its history, drawn as `figures`; wall times go to the provenance with all that differs by host.
    pub fn with_history(
        mut self,
        path: &str,
        Records { before, latest: records }: &Records,
        trend: &Trend,
        (figures, times): (Vec<FigureView>, Option<FigureView>),
    ) -> Self {
        let steps = changes(&trend.values, records);
        let worse = steps.iter().filter(|step| step.verdict == Change::Regressed).count();
        let better = steps.iter().filter(|step| step.verdict == Change::Improved).count();
        let moved = match (steps.len(), records.len()) {
            (_, 1) => "This is the first run".to_string(),
            (0, n) => format!("In {n} runs no error and no peak moved to another level"),
            (all, n) => {
                let kinds = [
                    (worse, "of an error upwards"),
                    (better, "of an error downwards"),
                    (all - worse - better, "of a peak frequency"),
                ];
                let told = kinds.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
                format!("Steps in {n} runs: {}", told.collect::<Vec<_>>().join(", "))
            }
        };
        let mut notes = Vec::new();
        if *before > 0 {
            notes.push(format!("The {before} runs before these are left out."));
        }
        let this = records.last();
        let others = |differs: &dyn Fn(&Record, &Record) -> bool| {
            this.map_or(0, |this| records.iter().filter(|record| differs(record, this)).count())
        };
        let inputs = others(&|a, b| a.inputs != b.inputs);
        if inputs > 0 {
            notes.push(format!("{inputs} of the runs had other inputs than this one."));
        }
        let versions = others(&|a, b| (&a.program, &a.comparator) != (&b.program, &b.comparator));
        if versions > 0 {
            notes.push(format!(
                "{versions} of the runs were made by another version of the program or of the comparison."
            ));
        }
        self.provenance.slower = changes(&trend.times, records);
        self.provenance.times = times;
        let sentence = format!("{moved}.");
        self.history =
            Some(HistoryView { path: path.into(), runs: before + records.len(), sentence, notes, steps, figures });
        self
    }
}

/// The steps of all series, the latest first.
fn changes(series: &[Series], records: &[Record]) -> Vec<StepChangeView> {
    let mut all: Vec<StepChangeView> =
        series.iter().flat_map(|one| one.steps.iter().map(|step| change(one, step, records))).collect();
    all.sort_by_key(|step| std::cmp::Reverse(step.run));
    all
}

fn change(series: &Series, step: &Step, records: &[Record]) -> StepChangeView {
    let verdict = match (series.kind.falls(), step.after < step.before) {
        (false, _) => Change::Changed,
        (true, true) => Change::Improved,
        (true, false) => Change::Regressed,
    };
    let what = match series.kind {
        Kind::Misfit => "χ² per reading",
        Kind::Error => "rms error of the amplitude",
        Kind::Frequency => "peak frequency",
        Kind::Time => "wall time",
    };
    let unit = series.kind.unit();
    let show = |value: f64| Quantity {
        value: Some(value),
        text: if unit == "1" { significant(value, 4) } else { format!("{} {unit}", significant(value, 4)) },
    };
    // A step shows from its second run on, so that this run never is one; its time would differ from host to host.
    let time = records.get(step.at).map(|record| record.time.clone()).unwrap_or_default();
    let by = if step.before == 0.0 { String::new() } else { signed((step.after - step.before) / step.before.abs()) };
    let (before, after) = (show(step.before), show(step.after));
    StepChangeView {
        verdict,
        what: format!("{}: {what}", series.name),
        run: series.before + step.at + 1,
        time,
        before,
        after,
        by,
    }
}
