//! Counting the scores.

use super::cause::{Kind, shown};
use super::proportion::Proportion;
use super::record::Record;
use super::score::{Score, Share};
use super::{Options, VISIBLE, program};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Version of the JSON.
pub const SCHEMA: &str = "stickslip.trial/1";

/// Scores over some trials.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a key of the file, and a column of the table.
pub struct Scores {
    /// Level of noise; `None` for all together.
    pub noise: Option<f64>,
    /// Trials that were searched.
    pub trials: usize,
    /// Draws of causes with a steady state everywhere: those that the data could show, of all.
    #[serde(default)]
    pub visible: Proportion,
    /// The verdict is right.
    pub verdict: Proportion,
    /// A planted effect is the first that is named.
    pub first: Proportion,
    /// Every planted effect is named, or not told apart from one that is.
    pub named: Proportion,
    /// Exactly what was planted is named.
    pub exact: Proportion,
    /// Something was found where nothing is.
    pub false_alarm: Proportion,
    /// A cause outside the catalogue is left as unexplained.
    pub flagged: Proportion,
    /// The right number is recalibrated.
    pub recalibration: Proportion,
    /// 95 % intervals that hold the truth, of parameters that are bounded from both sides.
    pub coverage: Proportion,
    /// Median over the trials of the final error over the noise, and the largest.
    pub final_error: Option<[f64; 2]>,
    /// Median of the search's time \[s\].
    pub seconds: Option<f64>,
}

/// How one cause fared.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ByCause {
    /// Its name.
    pub cause: String,
    /// Trials for which no draw was kept.
    pub given_up: usize,
    /// Draws that the data could not show, over all trials.
    pub invisible: usize,
    /// Draws without a steady state somewhere.
    pub unsteady: usize,
    /// The scores.
    pub scores: Scores,
}

/// Intervals of one parameter over all trials in which what was planted was found.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Coverage {
    /// Its key.
    pub key: String,
    /// Intervals that hold the truth, where bounded from both sides.
    pub identified: Proportion,
    /// All intervals, open ones too, that hold the truth.
    pub all: Proportion,
    /// Median of estimate over truth less one.
    pub median_bias: Option<f64>,
}

/// Planted against named.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Confusion {
    /// Names of the rows.
    pub planted: Vec<String>,
    /// Names of the columns.
    pub named: Vec<String>,
    /// Trials, row by row.
    pub counts: Vec<Vec<usize>>,
    /// Of those with another answer, the trials in which it is said not to be told apart from the right one.
    #[serde(default)]
    pub tied: Vec<Vec<usize>>,
}

/// Everything about a series of trials.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a key of the file, in the order in which it is written.
pub struct Summary {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub program: String,
    /// Builds that the results come from.
    pub builds: Vec<String>,
    /// Points of every table.
    pub points: usize,
    /// Seeds: the first, and how many.
    pub seeds: [u32; 2],
    /// chi2 per reading from which on a draw counts as visible.
    pub visible: f64,
    /// Share of readings thrown far off.
    pub outliers: f64,
    /// Whether the tables have phases.
    pub phase: bool,
    /// Scores by level of noise, all together first.
    pub scores: Vec<Scores>,
    /// Scores by cause.
    pub causes: Vec<ByCause>,
    /// Intervals by parameter.
    pub coverage: Vec<Coverage>,
    /// Planted against named.
    pub confusion: Confusion,
    /// The trials.
    pub trials: Vec<Record>,
}

impl Summary {
    /// The scores alone, without the trials.
    pub fn scores_alone(self) -> Self {
        Self { trials: Vec::new(), ..self }
    }
}

/// Counts the scores of finished trials.
pub fn summarise(records: Vec<Record>, options: &Options, points: usize) -> Summary {
    let mut scores = vec![over(records.iter(), None)];
    if options.noise.len() > 1 {
        scores.extend(options.noise.iter().map(|n| over(records.iter().filter(|r| r.answer.noise == *n), Some(*n))));
    }
    let names = unique(records.iter().map(|r| r.answer.cause.clone()));
    let of = |name: &String| {
        let mine = || records.iter().filter(|r| r.answer.cause == *name);
        ByCause {
            cause: name.clone(),
            given_up: mine().filter(|r| r.found.is_none()).count(),
            invisible: mine().map(|r| r.answer.draws.invisible).sum(),
            unsteady: mine().map(|r| r.answer.draws.unsteady).sum(),
            scores: over(mine(), None),
        }
    };
    Summary {
        schema: SCHEMA.into(),
        program: program(),
        builds: unique(records.iter().map(|r| r.build.clone())),
        points,
        seeds: [options.seed, options.seeds],
        visible: VISIBLE,
        outliers: options.outliers,
        phase: options.phase,
        causes: names.iter().map(of).collect(),
        coverage: coverage(&records),
        confusion: confusion(&records, names),
        scores,
        trials: records,
    }
}

fn unique(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut seen: Vec<String> = Vec::new();
    all.for_each(|name| {
        if !seen.contains(&name) {
            seen.push(name);
        }
    });
    seen
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

fn over<'a>(records: impl Iterator<Item = &'a Record> + Clone, noise: Option<f64>) -> Scores {
    let drawn = records.clone().filter(|r| r.answer.kind != Kind::None).flat_map(|r| {
        let unseen = std::iter::repeat_n(Some(false), r.answer.draws.invisible);
        unseen.chain(r.found.is_some().then_some(Some(true)))
    });
    let visible = Proportion::count(drawn);
    let found: Vec<(&Record, &Score)> = records.filter_map(|r| Some((r, r.score.as_ref()?))).collect();
    let count = |of: &dyn Fn(&Score) -> Option<bool>| Proportion::count(found.iter().map(|(_, s)| of(s)));
    let parameters = found.iter().flat_map(|(_, s)| &s.parameters).filter(|p| p.identified);
    let errors: Vec<f64> = found.iter().map(|(_, s)| s.final_error).collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    Scores {
        noise,
        trials: found.len(),
        visible,
        verdict: count(&|s| Some(s.verdict)),
        first: count(&|s| s.first),
        named: count(&|s| s.named),
        exact: count(&|s| s.exact),
        false_alarm: count(&|s| s.false_alarm),
        flagged: count(&|s| s.flagged),
        recalibration: count(&|s| s.recalibration),
        coverage: Proportion::count(parameters.map(|p| Some(p.covered))),
        final_error: median(errors).map(|m| [m, largest]),
        seconds: median(found.iter().filter_map(|(r, _)| Some(r.found.as_ref()?.seconds)).collect()),
    }
}

fn coverage(records: &[Record]) -> Vec<Coverage> {
    let all: Vec<&Share> = records.iter().filter_map(|r| r.score.as_ref()).flat_map(|s| &s.parameters).collect();
    let mut keys = unique(all.iter().map(|p| p.key.clone()));
    keys.sort();
    let of = |key: String| {
        let mine = || all.iter().filter(|p| p.key == key);
        Coverage {
            identified: Proportion::count(mine().filter(|p| p.identified).map(|p| Some(p.covered))),
            all: Proportion::count(mine().map(|p| Some(p.covered))),
            median_bias: median(mine().map(|p| p.bias).collect()),
            key,
        }
    };
    keys.into_iter().map(of).collect()
}

fn confusion(records: &[Record], planted: Vec<String>) -> Confusion {
    let tied = |r: &Record| r.score.as_ref().is_some_and(|s| s.named == Some(true) || s.recalibration == Some(true));
    let answers = records.iter().filter_map(|r| Some((r.answer.cause.as_str(), r.found.as_ref()?.label(), tied(r))));
    let answers: Vec<(&str, String, bool)> = answers.collect();
    // What is named as it is planted stands on the diagonal, the rest behind it.
    let own = |name: &String| sorted(name);
    let known = unique(planted.iter().map(own).chain(answers.iter().map(|(_, label, _)| label.clone())));
    let named: Vec<String> = known.into_iter().filter(|n| answers.iter().any(|(_, label, _)| label == n)).collect();
    let count = |wanted: &dyn Fn(&String, &String, bool) -> bool| -> Vec<Vec<usize>> {
        let cell = |row: &String, column: &String| {
            answers.iter().filter(|(p, n, tied)| p == row && n == column && wanted(row, column, *tied)).count()
        };
        planted.iter().map(|row| named.iter().map(|column| cell(row, column)).collect()).collect()
    };
    let counts = count(&|_, _, _| true);
    // Where structure is left nothing is claimed, not even a tie.
    let tied = count(&|row, column, tied| tied && column != "unexplained" && own(row) != *column);
    Confusion { planted, named, counts, tied }
}

/// A planted name as a search would write it.
pub fn sorted(name: &str) -> String {
    let mut names: Vec<&str> = shown(name).split('+').collect();
    names.sort_unstable();
    names.join(" + ")
}
