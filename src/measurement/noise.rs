//! Every point gets its standard deviations: stated, from repeated readings, or from the scatter about smooth curves.

use schemars::JsonSchema;
use std::path::Path;

use super::frame::amplitude_header;
use super::pool::{Pooled, Repeats};
use super::scatter::{Parts, slopes};
use super::{NoiseSource, Point, Spread, scatter};
use crate::error::{Error, Result};
use crate::scenario::Signals;
use crate::scenario::diagnostic::whole_file;
use crate::statistics::median;

/// No instrument is believed to be better than this, relative and in rad.
const FLOOR: f64 = 1e-6;

/// Standard deviations that are gone by, over those of a table: by the scatter of the residuals about anything smooth,
/// where that contradicts the stated ones.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct Noise {
    /// Of the amplitudes.
    pub amplitude: f64,
    /// Of the phases.
    pub phase: f64,
}

impl Noise {
    /// As the table has it.
    pub const STATED: Self = Self { amplitude: 1.0, phase: 1.0 };

    /// These, in units of others.
    pub fn times(self, unit: Self) -> Self {
        Self { amplitude: self.amplitude * unit.amplitude, phase: self.phase * unit.phase }
    }

    /// Both in one number, for so many amplitudes and phases.
    pub fn together(&self, amplitudes: usize, phases: usize) -> f64 {
        let (amplitudes, phases) = (amplitudes as f64, phases as f64);
        ((amplitudes * self.amplitude.powi(2) + phases * self.phase.powi(2)) / (amplitudes + phases)).sqrt()
    }

    /// What the readings say of the deviations that they came with: of amplitudes and phases, which are from there.
    pub fn words(&self, (amplitudes, phases): (NoiseSource, Option<NoiseSource>)) -> Option<String> {
        let than = |source| if source == NoiseSource::Estimated { "along their series" } else { "stated" };
        let (of_amplitudes, of_phases) = (than(amplitudes), than(phases.unwrap_or(amplitudes)));
        let full =
            |name: &str, factor: f64, than: &str| format!("the {name} scatter {factor:.2} times as much as {than}");
        let Self { amplitude, phase } = *self;
        let first = (amplitude != 1.0).then(|| full("amplitudes", amplitude, of_amplitudes));
        let second = (phase != 1.0).then(|| match first {
            Some(_) if of_amplitudes == of_phases => format!("the phases {phase:.2} times"),
            _ => full("phases", phase, of_phases),
        });
        let said: Vec<String> = first.into_iter().chain(second).collect();
        (!said.is_empty()).then(|| said.join(", "))
    }

    /// Whether they contradict them; deviations that were estimated from the readings claim nothing that could be.
    pub fn contradicts(&self, (amplitudes, phases): (NoiseSource, Option<NoiseSource>)) -> bool {
        let claimed = |source| source != NoiseSource::Estimated;
        (self.amplitude != 1.0 && claimed(amplitudes)) || (self.phase != 1.0 && phases.is_some_and(claimed))
    }
}

/// Repetitions that suffice to tell the noise from them alone.
const ENOUGH_REPEATS: usize = 5;

/// Points with all deviations, where those of amplitude and phase come from, and from how many degrees of freedom they
/// are known together.
pub(crate) fn assign(
    pooled: Pooled,
    file: &Path,
    signals: Signals,
    notes: &mut Vec<String>,
) -> Result<(Vec<Point>, NoiseSource, Option<NoiseSource>, f64)> {
    let Pooled { mut points, spreads, amplitude_stated, phase_stated, amplitude_repeats, phase_repeats, .. } = pooled;
    let seen = scatter(&points);
    let slopes = slopes(&points);
    let phases = points.iter().any(|point| point.phase.is_some());

    let (mut of_amplitudes, mut of_phases) = (f64::INFINITY, f64::INFINITY);
    let amplitude_noise = if amplitude_stated {
        let stated = median(points.iter().map(|p| p.amplitude_sd / p.amplitude * (p.replicates as f64).sqrt()));
        contradiction("amplitude", stated, seen.amplitude, notes);
        NoiseSource::Stated
    } else {
        let (sd, source) = estimate("amplitude", amplitude_repeats, seen.amplitude, (file, signals), notes)?;
        of_amplitudes = sd.degrees_of_freedom as f64;
        let mut rounded = 0;
        for ((point, own), [slope, _]) in points.iter_mut().zip(&spreads).zip(&slopes) {
            let single = sd.at(point.amplitude, *slope) * point.amplitude;
            let pooled = single.max(FLOOR * point.amplitude) / (point.replicates as f64).sqrt();
            rounded += usize::from(own.rounding[0] > pooled);
            point.amplitude_sd = pooled.max(own.amplitude.unwrap_or(0.0)).max(own.rounding[0]);
            if point.amplitude_sd <= 0.0 {
                let title = format!("`{}`, line {}: the amplitude is zero", file.display(), point.line);
                let help = "its standard deviation cannot be a share of it; state one, or remove the row";
                return Err(Error::Input(whole_file(&title, help)));
            }
        }
        coarse("amplitudes", rounded, points.len(), notes);
        source
    };
    if !phases {
        return Ok((points, amplitude_noise, None, of_amplitudes));
    }
    let phase_noise = if phase_stated {
        let single = |p: &Point| p.phase_sd.map(|sd| sd * (p.replicates as f64).sqrt());
        contradiction("phase", median(points.iter().filter_map(single)), seen.phase, notes);
        NoiseSource::Stated
    } else {
        let (sd, source) = estimate("phase", phase_repeats, seen.phase, (file, signals), notes)?;
        of_phases = sd.degrees_of_freedom as f64;
        let mut rounded = 0;
        for ((point, own), [_, slope]) in points.iter_mut().zip(&spreads).zip(&slopes) {
            let pooled = sd.at(point.amplitude, *slope).max(FLOOR) / (own.phases.max(1) as f64).sqrt();
            rounded += usize::from(own.rounding[1] > pooled);
            point.phase_sd = point.phase.map(|_| pooled.max(own.phase.unwrap_or(0.0)).max(own.rounding[1]));
        }
        coarse("phases", rounded, points.len(), notes);
        source
    };
    let freedom = freedom(&points, [of_amplitudes, of_phases]);
    Ok((points, amplitude_noise, Some(phase_noise), freedom))
}

/// From how many degrees of freedom the unit of a sum of squares over all readings is known, those of amplitudes and of
/// phases being known from so many.
pub(super) fn freedom(points: &[Point], of: [f64; 2]) -> f64 {
    let both = [points.len(), points.iter().filter(|point| point.phase.is_some()).count()].map(|count| count as f64);
    let share = |kind: usize| both[kind] / (both[0] + both[1]);
    (0..2).filter(|&kind| both[kind] > 0.0).map(|kind| share(kind).powi(2) / of[kind]).sum::<f64>().recip()
}

/// Noise of a single reading.
fn estimate(
    what: &str,
    repeats: Repeats,
    seen: Option<Spread>,
    (file, signals): (&Path, Signals),
    notes: &mut Vec<String>,
) -> Result<(Spread, NoiseSource)> {
    let of = |sd: f64| Spread { sd, degrees_of_freedom: repeats.freedom, order: 0, parts: None };
    let repeated = || (repeats.squares / repeats.freedom as f64).sqrt().max(FLOOR);
    let (sd, source) = match seen {
        _ if repeats.freedom >= ENOUGH_REPEATS => (of(repeated()), NoiseSource::Replicates),
        Some(spread) => (Spread { sd: spread.sd.max(FLOOR), ..spread }, NoiseSource::Estimated),
        None if repeats.freedom > 0 => (of(repeated()), NoiseSource::Replicates),
        None => {
            let title = format!("`{}` states no noise of the {what}, and it cannot be estimated", file.display());
            let column = if what == "phase" {
                "phase_sd_rad or phase_sd_deg".into()
            } else {
                let header = amplitude_header(signals.reading.unit).replacen("amplitude", "amplitude_sd", 1);
                format!("{header} or amplitude_sd_percent")
            };
            let sweep = if signals == Signals::ARM {
                "condition (same load, speed and drive)"
            } else {
                "series (rows that follow each other, or a column `series`)"
            };
            let help = format!(
                "add a column {column}, or measure at least 6 frequencies in one {sweep}, or repeat readings; \
                 without a standard deviation no misfit can be judged"
            );
            return Err(Error::Input(whole_file(&title, &help)));
        }
    };
    let from = match source {
        NoiseSource::Replicates => format!("the spread of repeated readings ({} degrees of freedom)", repeats.freedom),
        _ => {
            format!("the scatter about smooth curves ({} degrees of freedom)", seen.map_or(0, |s| s.degrees_of_freedom))
        }
    };
    let size = sd.parts.map_or_else(|| shown(what, sd.sd), |parts| in_parts(what, parts, signals));
    notes.push(format!("no noise of the {what} is stated: {size} was estimated from {from}"));
    Ok((sd, source))
}

/// The parts of a noise in words.
fn in_parts(what: &str, Parts { share, floor, waver }: Parts, signals: Signals) -> String {
    let floor = (floor > 0.0).then(|| {
        let of_phase = if what == "phase" { "that of " } else { "" };
        let floor = crate::units::format(two_digits(floor), signals.reading.unit);
        format!("{of_phase}{floor}, which does not grow with the reading,")
    });
    let waver = (waver > 0.0).then(|| {
        let waver = crate::units::format(two_digits(100.0 * waver), "1");
        format!("what a frequency that wavers by {waver} % leaves on the flanks,")
    });
    let parts: Vec<String> = [Some(shown(what, share)), floor, waver].into_iter().flatten().collect();
    parts.join(" and ")
}

/// Says where the steps in which readings are written are coarser than what they scatter by.
fn coarse(name: &str, rounded: usize, all: usize, notes: &mut Vec<String>) {
    if rounded > 0 {
        notes.push(format!(
            "{rounded} of {all} {name} {} written in steps so coarse that rounding alone leaves more than the noise: it is \
             taken as theirs",
            if rounded == 1 { "is" } else { "are" }
        ));
    }
}

fn shown(what: &str, sd: f64) -> String {
    let digits = |value: f64| crate::units::format(two_digits(value), "1");
    if what == "phase" { format!("{} deg", digits(sd.to_degrees())) } else { format!("{} %", digits(100.0 * sd)) }
}

fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Says where the stated noise is not what the readings show.
fn contradiction(what: &str, stated: f64, seen: Option<Spread>, notes: &mut Vec<String>) {
    let Some(seen) = seen.filter(|seen| seen.degrees_of_freedom >= 20 && stated > 0.0) else { return };
    if !(0.5..=2.0).contains(&(seen.sd.max(FLOOR) / stated)) {
        let (stated, seen) = (shown(what, stated), shown(what, seen.sd.max(FLOOR)));
        notes.push(format!(
            "the {what} scatters by {seen} about smooth curves, but {stated} is stated; check the column"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use NoiseSource::{Estimated, Stated};

    #[test]
    fn amplitudes_and_phases_are_each_held_against_what_they_came_with() {
        let noise = |amplitude, phase| Noise { amplitude, phase };
        for (noise, sources, contradicts, words) in [
            (Noise::STATED, (Stated, Some(Stated)), false, None),
            (
                noise(2.0, 1.0),
                (Stated, Some(Estimated)),
                true,
                Some("the amplitudes scatter 2.00 times as much as stated"),
            ),
            (
                noise(1.0, 0.9),
                (Stated, Some(Estimated)),
                false,
                Some("the phases scatter 0.90 times as much as along their series"),
            ),
            (
                noise(0.9, 3.0),
                (Estimated, Some(Stated)),
                true,
                Some(
                    "the amplitudes scatter 0.90 times as much as along their series, the phases scatter 3.00 times as much as \
                     stated",
                ),
            ),
            (
                noise(2.0, 3.0),
                (Stated, Some(Stated)),
                true,
                Some("the amplitudes scatter 2.00 times as much as stated, the phases 3.00 times"),
            ),
        ] {
            assert_eq!((noise.contradicts(sources), noise.words(sources).as_deref()), (contradicts, words));
        }
    }
}
