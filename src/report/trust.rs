//! How far the search can be trusted, from the trials that come with the program.

use super::format::{NONE, quantity};
use super::scenario::{FigureInput, figure};
use super::trust_view::{CauseView, OtherwiseView, ScoreView, TrustView};
use super::view::ReportView;
use crate::trial::{ByCause, Kind, Proportion, Score, Scores, Series, Summary};

impl ReportView {
    /// The report with the section on how far the search can be trusted.
    pub fn with_trust(mut self, trust: TrustView) -> Self {
        self.trust = Some(trust);
        self
    }
}

/// The section: the `main` series of trials, those under other conditions, and the figures of all.
pub fn trust_view(main: &Series, others: &[Series], figures: &[FigureInput]) -> TrustView {
    let s = &main.summary;
    let all = &s.scores[0];
    let noise: Vec<String> = noise_levels(s).iter().map(|n| quantity(100.0 * n, "%", 2)).collect();
    let right = |p: &Proportion| format!("{} of {}", p.successes, p.of);
    let mut sentence = format!(
        "In blind trials the kind of the answer (nothing missing, recalibrate, an effect, unexplained) was right in {}",
        right(&all.verdict)
    );
    if all.visible.successes < all.visible.of {
        let unseen = all.visible.of - all.visible.successes;
        sentence += &format!(" ({unseen} more draws of a cause were too weak to show in the data and are not counted)");
    }
    if all.named.of > 0 {
        sentence += &format!("; planted effects were named, or in a declared tie, in {}", right(&all.named));
    }
    if all.false_alarm.of > 0 {
        sentence += &format!("; false alarms where nothing was planted: {}", right(&all.false_alarm));
    }
    if all.flagged.of > 0 {
        sentence += &format!("; causes outside the catalogue were called unexplained in {}", right(&all.flagged));
        // A share over several causes hides one that always fails.
        let never: Vec<&str> =
            s.causes.iter().filter(|c| c.scores.flagged.share == Some(0.0)).map(|c| c.cause.as_str()).collect();
        if !never.is_empty() {
            sentence += &format!(", {} never", never.join(" and "));
        }
    }
    let method = format!(
        "{} trials: causes drawn over the ranges of the catalogue, measured by plain time integration at {} points each with noise \
         of {}{}, sealed, searched for in the table alone, opened and scored. Draws of a cause that leave the calibrated base with χ² \
         below {} per reading are invisible and counted apart.",
        all.trials,
        s.points,
        noise.join(", "),
        if s.phase { "" } else { ", without phases" },
        quantity(s.visible, "1", 2)
    );
    let command = main.command.into();
    TrustView {
        sentence: sentence + ".",
        method,
        command,
        program: program(s),
        scores: scores(all),
        otherwise: if others.is_empty() { Vec::new() } else { otherwise(main, others) },
        commands: others.iter().map(|series| series.command.into()).collect(),
        programs: others.iter().map(|series| program(&series.summary)).collect(),
        causes: s.causes.iter().map(|cause| cause_view(s, cause)).collect(),
        figures: figures.iter().map(|input| figure("trust", input)).collect(),
    }
}

fn program(s: &Summary) -> String {
    format!("{}, build {}", s.program, s.builds.join(", "))
}

fn noise_levels(s: &Summary) -> Vec<f64> {
    let mut levels: Vec<f64> = s.trials.iter().map(|record| record.answer.noise).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

fn scores(all: &Scores) -> Vec<ScoreView> {
    let rows = [
        ("right kind of answer (verdict)", &all.verdict),
        ("right effect named first", &all.first),
        ("planted effects named, or in a declared tie", &all.named),
        ("exactly what was planted named", &all.exact),
        ("false alarms where nothing was planted", &all.false_alarm),
        ("causes outside the catalogue called unexplained", &all.flagged),
        ("right recalibration", &all.recalibration),
        ("95 % intervals that hold the truth", &all.coverage),
    ];
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let row = |(what, p): (&str, &Proportion)| {
        Some(ScoreView {
            what: what.into(),
            count: format!("{} of {}", p.successes, p.of),
            share: percent(p.share?),
            interval: format!("{:.0} to {}", 100.0 * p.low, percent(p.high)),
        })
    };
    rows.into_iter().filter_map(row).collect()
}

/// A row for each level of noise of each series.
fn otherwise(main: &Series, others: &[Series]) -> Vec<OtherwiseView> {
    let share = |p: &Proportion| {
        p.share.map_or(NONE.into(), |share| format!("{:.0} % ({} of {})", 100.0 * share, p.successes, p.of))
    };
    let row = |conditions: String, s: &Scores| OtherwiseView {
        conditions,
        trials: s.trials,
        visible: share(&s.visible),
        verdict: share(&s.verdict),
        named: share(&s.named),
        false_alarm: share(&s.false_alarm),
        flagged: share(&s.flagged),
        coverage: share(&s.coverage),
    };
    let mut rows = vec![row("as above".into(), &main.summary.scores[0])];
    for series in others {
        let levels: Vec<&Scores> = series.summary.scores.iter().filter(|s| s.noise.is_some()).collect();
        if levels.is_empty() {
            let noise: Vec<String> =
                noise_levels(&series.summary).iter().map(|n| quantity(100.0 * n, "%", 2)).collect();
            let conditions = match noise.as_slice() {
                [] => series.otherwise.to_string(),
                some => format!("{}, noise of {}", series.otherwise, some.join(", ")),
            };
            rows.extend(series.summary.scores.first().map(|s| row(conditions, s)));
        }
        let noise = |s: &&Scores| quantity(100.0 * s.noise.unwrap_or(f64::NAN), "%", 2);
        rows.extend(levels.iter().map(|s| row(format!("{}, noise of {}", series.otherwise, noise(s)), s)));
    }
    rows
}

fn cause_view(s: &Summary, cause: &ByCause) -> CauseView {
    let x = &cause.scores;
    let mine: Vec<_> = s.trials.iter().filter(|record| record.answer.cause == cause.cause).collect();
    let kind = mine.first().map(|record| record.answer.kind);
    let named = match kind {
        Some(Kind::Effect | Kind::Pair) => Some(&x.named),
        Some(Kind::Recalibration) => Some(&x.recalibration),
        // The verdict says it all.
        Some(Kind::None | Kind::Outside) | None => None,
    };
    let mut others: Vec<(String, usize)> = Vec::new();
    let missed = |score: &Score| !score.verdict || score.named == Some(false) || score.recalibration == Some(false);
    let own = crate::trial::sorted(&cause.cause);
    for record in &mine {
        let (Some(found), Some(score)) = (&record.found, &record.score) else { continue };
        if found.label() == own || (kind == Some(Kind::Outside) && score.verdict) {
            continue;
        }
        let tied = if missed(score) { "" } else { ", in a tie with what was planted" };
        let label = format!("{}{tied}", found.label());
        match others.iter_mut().find(|(name, _)| *name == label) {
            Some((_, count)) => *count += 1,
            None => others.push((label, 1)),
        }
    }
    let instead: Vec<String> =
        others.iter().map(|(name, n)| if *n > 1 { format!("{name} ({n})") } else { name.clone() }).collect();
    CauseView {
        cause: crate::trial::shown(&cause.cause).into(),
        trials: x.trials,
        verdict: format!("{} of {}", x.verdict.successes, x.verdict.of),
        named: named.map_or(NONE.into(), |p| format!("{} of {}", p.successes, p.of)),
        instead: instead.join("; "),
        not_drawn: cause.invisible + cause.unsteady,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::committed;

    #[test]
    fn every_series_and_level_of_noise_has_its_row_and_every_series_its_command_and_program() {
        let [main, others @ ..] = committed() else { panic!("no committed trials") };
        let view = trust_view(main, others, &[]);
        assert_eq!((view.commands.len(), view.programs.len()), (others.len(), others.len()));
        for (series, program) in others.iter().zip(&view.programs) {
            assert!(series.summary.builds.iter().all(|build| program.contains(build)), "{program}");
            let mine: Vec<_> =
                view.otherwise.iter().filter(|row| row.conditions.starts_with(series.otherwise)).collect();
            let levels: Vec<&Scores> = series.summary.scores.iter().filter(|s| s.noise.is_some()).collect();
            let scores = if levels.is_empty() { vec![&series.summary.scores[0]] } else { levels };
            assert_eq!(mine.len(), scores.len(), "{}", series.otherwise);
            for (row, s) in mine.iter().zip(scores) {
                assert_eq!(row.trials, s.trials);
                let counted = format!("({} of {})", s.verdict.successes, s.verdict.of);
                assert!(row.verdict.ends_with(&counted), "{} {counted}", row.verdict);
            }
        }
        assert_eq!(view.otherwise[0].trials, main.summary.scores[0].trials);
    }
}
