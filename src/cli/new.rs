//! `stickslip new`: looks at a measured table, says what it sees, and writes a scenario that fits it.

use super::progress::of_search;
use super::{Global, say};
use crate::compare::{EXCESS, calibrate, judge};
use crate::discover::{Candidates, Hypothesis, MARGIN, SearchOptions, explain};
use crate::effects::REGISTRY;
use crate::error::{Error, Result};
use crate::files;
use crate::fit::resonance::{Resonance, of_all, resonance};
use crate::fit::{deviance, price, robust_square, typical_of};
use crate::free_form;
use crate::measurement::{Direction, Mode, Point, Series, Survey, Table, load, modes, survey, survey_between};
use crate::model::Model;
use crate::scenario::diagnostic::whole_file;
use crate::scenario::{Coordinate, Scenario, Signal};
use crate::solver::cycle::Tolerance;
use crate::statistics::{median, wrap};
use crate::units::{self, count};
use nalgebra::DVector;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, LazyLock};

/// Two neighbours along a series whose responses per drive differ by this many times what their neighbours do are a
/// jump, if by more than this many standard deviations.
const JUMP: (f64, f64) = (5.0, 8.0);

/// The search that decides between kinds of readings: by what acts on the motion. What is read beside it makes one kind
/// of another, since an acceleration and a share of the drive are a displacement.
static SHORT: LazyLock<SearchOptions> = LazyLock::new(|| {
    let whole = SearchOptions::default();
    let of_motion = REGISTRY.iter().filter(|effect| !effect.is_read_beside()).map(|effect| effect.name()).collect();
    SearchOptions { max_effects: 2, budget: whole.budget / 10, candidates: Candidates::Named(of_motion), ..whole }
});

/// What can be left of readings by a scenario with what it lacks.
struct Left {
    /// Residuals in standard deviations.
    residuals: DVector<f64>,
    parameters: usize,
    /// Degrees of freedom that the deviations are known from.
    freedom: f64,
    /// What the criterion charges for having looked at many effects.
    looked_at: f64,
}

impl Left {
    /// By effects of the catalogue and, where a search is too short for these, by any law of the amplitude.
    fn by(scenario: &Scenario, table: &Table, solved: &Arc<AtomicU64>) -> Vec<Self> {
        let model = Model::new(&table.applied_to(scenario));
        let calibration = calibrate(&model, &scenario.free, &table.points, Tolerance::FIT, 0);
        let law = free_form::left_by_amplitude(&judge(scenario, table, &calibration, None));
        let (Hypothesis { fit, .. }, looked_at) = explain(scenario, table, &SHORT, solved);
        let freedom = table.freedom;
        let effects =
            Self { residuals: fit.evaluation.residuals, parameters: fit.parameters.len(), freedom, looked_at };
        let law = law.map(|(residuals, parameters)| Self { residuals, parameters, freedom, looked_at: 0.0 });
        let readings = effects.residuals.len();
        law.into_iter().filter(|law| law.residuals.len() == readings).chain([effects]).collect()
    }

    /// The criterion, squares in this unit.
    fn criterion(&self, unit: f64) -> f64 {
        let readings = self.residuals.len();
        let square = deviance(robust_square(&self.residuals, unit), readings, self.freedom);
        square + price(self.parameters, readings, self.freedom) + self.looked_at
    }
}

/// Looks at `table` and writes the scenario to `output`, or beside the table under its name.
pub fn execute(table: &Path, output: Option<&Path>, global: &Global) -> Result<()> {
    let mut seen = survey(table)?;
    let modes = modes(&seen.table);
    if let Some(strongest) = modes.first() {
        seen = survey_between(table, strongest.band)?;
    }
    let target = output.map_or_else(|| table.with_extension("toml"), PathBuf::from);
    if target.symlink_metadata().is_ok() {
        let title = format!("{} exists already, nothing was written", target.display());
        return Err(Error::Input(whole_file(&title, "name another file with -o, or move it away")));
    }
    let draft = Draft::new(&seen, table, &modes)?;
    let (text, chosen) = draft.best_scenario(&target, global)?;
    files::create(&target, text.as_bytes())?;
    for line in draft.description() {
        say(global, &line)?;
    }
    if let Some(chosen) = chosen {
        say(global, &format!("  note: {chosen}"))?;
    }
    say(global, &format!("wrote {}", target.display()))?;
    say(global, &format!("next: stickslip discover {}", target.display()))?;
    Ok(())
}

/// What a reading is of, where the table does not say.
#[derive(Clone, Copy)]
struct Kind {
    /// Times that the motion is differentiated before a reading in volts.
    order: u8,
    /// Whether the motion of the base is part of it.
    absolute: bool,
}

/// What a table tells of its rig.
struct Draft<'a> {
    seen: &'a Survey,
    table: &'a Path,
    coordinate: Coordinate,
    resonance: Resonance,
    /// The resonance with the contact stuck, where one is told by roller speeds or loads.
    stuck: Option<Resonance>,
    rolls: bool,
    /// The resonances of the whole table, where there are several: the readings about the first are used.
    modes: &'a [Mode],
}

/// A scenario in the making.
#[derive(Default)]
struct Written {
    /// The file as far as it is written.
    text: String,
    /// Lines of the table `[instrument]`.
    instrument: String,
    /// Keys of `[fit] free`.
    free: Vec<&'static str>,
}

impl<'a> Draft<'a> {
    fn new(seen: &'a Survey, table: &'a Path, modes: &'a [Mode]) -> Result<Self> {
        let refuse =
            |title: &str, help: &str| Err(Error::Input(whole_file(&format!("`{}`: {title}", table.display()), help)));
        let Some(coordinate) = seen.coordinate() else {
            return refuse(
                "the drive is a displacement and the reading an angle, or the other way round",
                "that is no oscillator of one coordinate; `stickslip init` writes the template of a torsional arm",
            );
        };
        let points = &seen.table.points;
        let rolls = points.iter().any(|p| p.speed > 0.0 || p.load > 0.0);
        // Without load, or where the roller is fastest, the rig is alone; at the lowest speed under load the contact
        // sticks.
        let fastest = points.iter().map(|p| p.speed).fold(0.0, f64::max);
        let unloaded = points.iter().any(|p| p.load == 0.0);
        let alone = |p: &&Point| if unloaded { p.load == 0.0 } else { p.speed == fastest };
        let slowest = points.iter().filter(|p| p.load > 0.0).map(|p| p.speed).fold(f64::INFINITY, f64::min);
        let of = |part: Vec<Point>| {
            of_all(&part, seen.table.signals.reading.order).filter(|resonance| !resonance.is_overdamped())
        };
        // At the smallest drive, where a rig that is not linear is nearest to it.
        let gentlest = seen.table.series.iter().map(|s| s.drive).fold(f64::INFINITY, f64::min);
        let gentle = |p: &&Point| seen.table.series[p.series].drive <= gentlest;
        let free = if rolls {
            points.iter().filter(alone).cloned().collect()
        } else {
            points.iter().filter(gentle).cloned().collect()
        };
        let stuck: Vec<Point> = points.iter().filter(|p| p.load > 0.0 && p.speed == slowest).cloned().collect();
        let Some(resonance) = of(free).or_else(|| of(points.clone())) else {
            return refuse(
                "no resonance is seen in any series",
                "a series needs five frequencies or more across the resonance; check which columns are drive and amplitude",
            );
        };
        let stuck = if rolls { of(stuck) } else { None };
        Ok(Self { seen, table, coordinate, resonance, stuck, rolls, modes })
    }

    fn signals(&self) -> (Signal, Signal) {
        (self.seen.table.signals.drive, self.seen.table.signals.reading)
    }

    /// Whether the drive is a motion of the base.
    fn base_driven(&self) -> bool {
        ["m", "rad", "m/s^2", "rad/s^2"].contains(&self.signals().0.unit)
    }

    /// Reading per drive at resonance of a rig of mass one without gains.
    fn expected_peak(&self) -> f64 {
        let (drive, reading) = self.signals();
        let w = TAU * self.resonance.frequency;
        let per_force = self.resonance.quality / (w * w) * w.powi(reading.order.into());
        match (self.base_driven(), drive.order) {
            (true, 0) => per_force * w * w,
            _ => per_force,
        }
    }

    /// What differs in phase at resonance from a rig whose reading follows the drive, where phases are there.
    fn phase_offset(&self) -> Option<f64> {
        let (drive, reading) = self.signals();
        // The inertial force of a base is against its acceleration.
        let against = if self.base_driven() && drive.order == 2 { PI } else { 0.0 };
        let expected = FRAC_PI_2 * (f64::from(reading.order) - 1.0) + against;
        self.resonance.phase.map(|phase| wrap(phase - expected))
    }

    fn series(&self) -> impl Iterator<Item = (&Series, Vec<&Point>)> {
        let table = &self.seen.table;
        let of = |index: usize| table.points.iter().filter(move |p| p.series == index).collect();
        table.series.iter().enumerate().map(move |(index, series)| (series, of(index)))
    }

    /// What is seen, in lines.
    fn description(&self) -> Vec<String> {
        let table = &self.seen.table;
        let (drive, reading) = self.signals();
        let mut lines = vec![format!("{}: {}", self.table.display(), table.summary())];
        for (number, (series, points)) in self.series().enumerate() {
            lines.push(format!("  {}", self.of_series(number, series, &points, drive, reading)));
        }
        lines.extend(table.notes.iter().map(|note| format!("  note: {note}")));
        let r = &self.resonance;
        lines.push(format!(
            "resonance near {}, quality factor about {}",
            units::format(digits(r.frequency, resolving(r.quality)), "Hz"),
            digits(r.quality, 2)
        ));
        lines.extend(self.lacking().into_iter().map(|text| format!("  note: {text}")));
        lines
    }

    fn of_series(&self, number: usize, series: &Series, points: &[&Point], drive: Signal, reading: Signal) -> String {
        let show = |value: f64, unit: &str| units::format(digits(value, 3), unit);
        let name =
            if series.name.is_empty() { format!("series {}", number + 1) } else { format!("series {}", series.name) };
        let [low, high] = [series.drives.0, series.drives.1].map(|level| show(level, drive.unit));
        let driven = if low == high { low } else { format!("{low} to {high}") };
        let range = |of: &dyn Fn(&Point) -> f64| {
            points.iter().map(|p| of(p)).fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (least, most) = range(&|p| p.amplitude);
        let swept = match series.direction {
            Direction::Up => ", swept up",
            Direction::Down => ", swept down",
            Direction::Unknown => "",
        };
        let contact = if self.rolls {
            format!("V = {}, W = {}, ", show(series.speed, "m/s"), show(series.load, "N"))
        } else {
            String::new()
        };
        let seen = resonance(points, reading.order).map_or(String::new(), |r| {
            let frequency = units::format(digits(r.frequency, resolving(r.quality)), "Hz");
            format!(", resonance near {frequency} with Q about {}", digits(r.quality, 2))
        });
        let jumps = match jumps(points) {
            0 => String::new(),
            n => format!(", {} (two stable states?)", count(n, "jump")),
        };
        format!(
            "{name}: {}, {contact}{} {driven}, {} {} to {}{swept}{seen}{jumps}",
            count(points.len(), "point"),
            drive.name,
            reading.name,
            show(least, reading.unit),
            show(most, reading.unit)
        )
    }

    /// What the table lacks, and what that costs.
    fn lacking(&self) -> Vec<String> {
        let mut lacking = Vec::new();
        if let [first, others @ ..] = self.modes {
            let show = |f: f64| units::format(digits(f, 3), "Hz");
            let others: Vec<String> = others.iter().map(|mode| show(mode.frequency)).collect();
            lacking.push(format!(
                "{} resonances: a scenario is of one mode, here of that near {}; for the others, near {}, change `frequency` in \
                 [measurement]",
                self.modes.len(),
                show(first.frequency),
                others.join(", ")
            ));
        }
        let (drive, reading) = self.signals();
        if drive.unit == "V" && reading.unit != "V" && !self.seen.has("drive") {
            let motion = if self.coordinate == Coordinate::Angle { "rad" } else { "m" };
            lacking.push(format!(
                "what drives is not stated: it is taken as a force of one size; where a base moves by the same at all frequencies, \
                 write drive = \"base\" under [rig] and V/{motion} as the unit of drive_sensitivity: that bends the shape of a \
                 resonance as a missing effect does"
            ));
        }
        if self.resonance.phase.is_none() {
            lacking.push("no phases: delays cannot be told, damping and nonlinearity less well".into());
        }
        let drives: Vec<f64> = self.seen.table.series.iter().map(|s| s.drive).collect();
        let spread = drives.iter().copied().fold(0.0, f64::max) / drives.iter().copied().fold(f64::INFINITY, f64::min);
        if spread < 1.2 {
            lacking.push(
                "one drive level: whether anything depends on the amplitude shows only in the shape of the peak; sweep again \
                 at a third and at three times the drive"
                    .into(),
            );
        }
        if !self.resonance.spanned {
            lacking.push("the readings lie on one side of the resonance only".into());
        }
        lacking
    }

    /// The scenario that explains the readings best with what it lacks, and what was chosen between, in words: of a
    /// reading in volts it is not said whether it is of displacement, velocity or acceleration, and of a rig on a
    /// moving base not whether its motion is read relative to that; they differ in shape and phase.
    fn best_scenario(&self, target: &Path, global: &Global) -> Result<(String, Option<String>)> {
        let kinds = self.kinds();
        if let [only] = kinds[..] {
            return Ok((self.scenario(target, only), None));
        }
        let mut drafts = Vec::new();
        for kind in kinds {
            let text = self.scenario(target, kind);
            let scenario = crate::scenario::load_text(target, &text)?;
            if let Some(table) = load(&scenario)? {
                drafts.push((kind, text, scenario, table));
            }
        }
        let explained: Vec<Vec<Left>> = of_search(global, SHORT.budget * drafts.len() as u64, |solved| {
            drafts.iter().map(|(.., scenario, table)| Left::by(scenario, table, solved)).collect()
        });
        let typical = |left: &Left| typical_of(&left.residuals);
        let unit = explained.iter().flatten().map(typical).fold(f64::INFINITY, f64::min).powi(2);
        let least = |all: &Vec<Left>| all.iter().map(|left| left.criterion(unit)).fold(f64::INFINITY, f64::min);
        // What explains nothing is no testimony against what the phase at resonance says.
        let first = drafts.first().map(|(kind, ..)| kind.order);
        let by_phase = unit > EXCESS && self.resonance.phase.is_some();
        let eligible = |at: usize| !by_phase || Some(drafts[at].0.order) == first;
        let mut criteria: Vec<f64> = explained.iter().map(least).collect();
        let better = |best: usize, at: usize| eligible(at) && criteria[at] + MARGIN < criteria[best];
        let best = (1..criteria.len()).fold(0, |best, at| if better(best, at) { at } else { best });
        let (kind, text, ..) = drafts.remove(best);
        let own = criteria.remove(best);
        let margin = criteria.iter().map(|other| other - own).fold(f64::INFINITY, f64::min);
        let by = if margin > MARGIN && unit <= EXCESS {
            format!("explains the readings, with what is missing, better by {margin:.0} in BIC")
        } else if margin > MARGIN {
            "leaves less of the readings, but nothing that was tried explains them: it is an assumption".into()
        } else if by_phase {
            "is an assumption by the phase at resonance, nothing that was tried explains the readings".into()
        } else {
            "is an assumption, the readings do not decide".into()
        };
        let others: Vec<String> = drafts.iter().map(|(other, ..)| self.words(*other)).collect();
        let chosen = format!("the reading is taken as {}, not {}: that {by}", self.words(kind), others.join(" or "));
        Ok((text, Some(chosen)))
    }

    /// What the reading may be of: first what needs the least offset of the phases, and the usual before others.
    fn kinds(&self) -> Vec<Kind> {
        let reading = self.signals().1;
        let mut orders = if reading.unit == "V" { vec![0, 1, 2] } else { vec![0] };
        if let Some(offset) = self.phase_offset() {
            let needed = |order: u8| wrap(offset - FRAC_PI_2 * f64::from(order)).abs();
            // To the degree: the noise of the phases is no reason.
            orders.sort_by_key(|order| needed(*order).to_degrees().round() as u16);
        }
        let of = |order: u8| {
            let absolute: &[bool] = if self.base_driven() { &[false, true] } else { &[false] };
            absolute.iter().map(move |&absolute| Kind { order, absolute })
        };
        orders.into_iter().flat_map(of).collect()
    }

    fn words(&self, kind: Kind) -> String {
        let order = kind.order.max(self.signals().1.order);
        let of = ["displacement", "velocity", "acceleration"][usize::from(order.min(2))];
        match (self.base_driven(), kind.absolute) {
            (false, _) => of.into(),
            (true, false) => format!("{of} relative to the base"),
            (true, true) => format!("absolute {of}"),
        }
    }

    /// The scenario in the notation of its file.
    fn scenario(&self, target: &Path, Kind { order, absolute }: Kind) -> String {
        let number = |value: f64| digits(value, 5);
        let r = &self.resonance;
        let mut written = Written { text: self.heading(absolute), ..Written::default() };
        written.free.extend(["rig.natural_frequency", "rig.quality_factor"]);
        let ratio = r.peak / self.expected_peak();
        self.write_size(&mut written, ratio, Kind { order, absolute });
        if let Some(offset) = self.phase_offset().map(|offset| wrap(offset - FRAC_PI_2 * f64::from(order))) {
            let inverted = offset.abs() > FRAC_PI_2;
            let remark = if inverted { "    # the reading has the opposite sign" } else { "" };
            let offset = number(if inverted { PI } else { 0.0 });
            let _ = writeln!(written.instrument, "phase_offset = \"{offset} rad\"{remark}");
            written.free.push("instrument.phase_offset");
        }
        let Written { mut text, instrument, mut free } = written;
        let (frequency, quality) = (digits(r.frequency, 7), number(r.quality));
        let _ = writeln!(text, "natural_frequency = \"{frequency} Hz\"\nquality_factor = {quality}");
        if self.rolls {
            self.write_contact(&mut text, 1.0 / ratio);
            free.extend(["contact.stiffness", "contact.damping", "contact.friction"]);
        }
        if !instrument.is_empty() {
            let _ = write!(text, "\n[instrument]\n{instrument}");
        }
        let _ = write!(text, "\n[measurement]\nfile = \"{}\"\n", path_from(target, self.table));
        if let Some(record) = self.seen.record {
            let _ = writeln!(text, "record = {record}");
        }
        if let Some(Mode { band: (from, to), .. }) = self.modes.first() {
            let _ = writeln!(
                text,
                "frequency = {{ from = \"{from} Hz\", to = \"{to} Hz\" }}    # the readings that are used"
            );
        }
        if !self.seen.mapping.is_empty() {
            let pairs: Vec<String> =
                self.seen.mapping.iter().map(|(key, header)| format!("{key} = {header:?}")).collect();
            let _ = writeln!(text, "columns = {{ {} }}", pairs.join(", "));
        }
        let free: Vec<String> = free.iter().map(|key| format!("\"{key}\"")).collect();
        let _ = write!(text, "\n[fit]\nfree = [{}]\n", free.join(", "));
        text
    }

    /// What stands before the numbers: title, origin, and how the rig is driven and read.
    fn heading(&self, absolute: bool) -> String {
        let plain = |name: &std::ffi::OsStr| name.to_string_lossy().replace(['"', '\\'], "'");
        let stem = self.table.file_stem().map_or("table".into(), plain);
        let mut text = format!(
            "# Written by `stickslip new` from what the readings show; every number may be corrected.\ntitle = \"Resonance of {stem}\"\n\
             provenance = \"not stated: readings of {file}; starting values estimated from them\"    # where they come from\n\n\
             [rig]\nkind = \"oscillator\"\n",
            file = self.table.file_name().map_or(stem.clone(), plain)
        );
        if self.coordinate == Coordinate::Angle {
            text += "coordinate = \"angle\"\n";
        }
        if self.base_driven() {
            text += "drive = \"base\"                 # or \"spring\", with spring_stiffness\n";
            text += if absolute {
                "reading = \"absolute\"           # or \"relative\" to the base\n"
            } else {
                "reading = \"relative\"           # to the base; or \"absolute\"\n"
            };
        } else {
            text += "drive = \"force\"                # or \"base\"; \"spring\"\n";
        }
        text
    }

    /// What the size of the readings tells: the mass, or a sensitivity where drive or reading is a voltage. `ratio` is
    /// the peak over that of a single mass.
    fn write_size(&self, Written { text, instrument, free }: &mut Written, ratio: f64, Kind { order, absolute }: Kind) {
        let (drive, reading) = self.signals();
        let volts = (drive.unit == "V", reading.unit == "V");
        let number = |value: f64| digits(value, 5);
        let angle = self.coordinate == Coordinate::Angle;
        let (motion, force) = if angle { ("rad", "V/(N m)") } else { ("m", "V/N") };
        match (self.base_driven(), volts) {
            (false, (false, false)) => {
                let (key, unit) = if angle { ("inertia", "kg m^2") } else { ("mass", "kg") };
                let _ = writeln!(text, "{key} = \"{} {unit}\"", number(1.0 / ratio));
                free.insert(0, if angle { "rig.inertia" } else { "rig.mass" });
            }
            (_, (_, true)) => {
                *text += "# the mass is not known: it is 1, and the drive is known up to a factor\n";
                let order = usize::from(order.min(2));
                let unit = ["V", "V s", "V s^2"][order];
                let of = ["displacement", "velocity", "acceleration"][order];
                let value = number(ratio / (TAU * self.resonance.frequency).powi(order as i32));
                let _ = writeln!(instrument, "sensitivity = \"{value} {unit}/{motion}\"    # reading per {of}");
                free.push("instrument.sensitivity");
            }
            (false, (true, false)) => {
                *text += "# the mass is not known: it is 1, and the drive is known up to a factor\n";
                let value = number(1.0 / ratio);
                let _ = writeln!(instrument, "drive_sensitivity = \"{value} {force}\"    # reading per force");
                free.push("instrument.drive_sensitivity");
            }
            (true, _) if absolute => {
                let value = number(ratio);
                let _ = writeln!(
                    text,
                    "participation = {value}    # motion of the place that is read over that of a single mass"
                );
                free.insert(0, "rig.participation");
            }
            (true, _) => {
                let value = number(ratio);
                let _ = writeln!(instrument, "amplitude_gain = {value}    # reading over the motion of a single mass");
                free.push("instrument.amplitude_gain");
            }
        }
        if volts == (true, true) {
            let _ = writeln!(instrument, "drive_sensitivity = \"1 {force}\"    # not known: it sets the unit of force");
        }
    }

    /// A contact that does to the resonance what the one of the table does.
    fn write_contact(&self, text: &mut String, mass: f64) {
        let mass = if self.base_driven() || self.signals().1.unit == "V" { 1.0 } else { mass };
        let w0 = TAU * self.resonance.frequency;
        let stuck = self.stuck.unwrap_or(self.resonance);
        let w1 = TAU * stuck.frequency;
        let stiffness = (mass * (w1 * w1 - w0 * w0)).max(0.1 * mass * w0 * w0);
        let damping = (mass * (w1 / stuck.quality - w0 / self.resonance.quality)).max(0.01 * stiffness / w1);
        let _ = write!(
            text,
            "\n[contact]                        # from what it does to the resonance\nstiffness = \"{} N/m\"\n\
             damping = \"{} N s/m\"\nfriction = 0.5\n",
            digits(stiffness, 3),
            digits(damping, 3)
        );
    }
}

/// The number with so many significant digits.
fn digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// Digits of a frequency that tell a tenth of the width of its resonance, at least three.
fn resolving(quality: f64) -> usize {
    2 + quality.log10().ceil().max(1.0) as usize
}

/// Steps of the response per drive between neighbours along the frequency that are far larger, and far steeper, than
/// the steps about them, which do not take them back: of readings that lie in groups the steps between these are large.
fn jumps(points: &[&Point]) -> usize {
    let response = |p: &Point| p.amplitude / p.drive;
    let step = |pair: &[&Point]| (response(pair[1]) / response(pair[0])).ln();
    let steps: Vec<f64> = points.windows(2).map(step).collect();
    let noise = median(points.iter().map(|p| p.amplitude_sd / p.amplitude));
    let apart = |i: usize| points[i + 1].frequency - points[i].frequency;
    let is_jump = |i: usize| {
        let (first, end) = (i.saturating_sub(2), (i + 3).min(steps.len()));
        let largest = (first..end).filter(|&j| j != i).map(|j| steps[j].abs()).fold(noise, f64::max);
        let (step, kept) = (steps[i].abs(), steps[first..end].iter().sum::<f64>() * steps[i].signum());
        let others = (first..end).filter(|&j| j != i).map(|j| [steps[j].abs(), apart(j)]);
        let [about, over] = others.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        let steep = step * over > JUMP.0 * about * apart(i);
        steep && step > JUMP.0 * largest && step > JUMP.1 * noise && 2.0 * kept > step
    };
    (0..steps.len()).filter(|&i| is_jump(i)).count()
}

/// The path of the table as a scenario at `target` has to state it.
fn path_from(target: &Path, table: &Path) -> String {
    let folder =
        |path: &Path| path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).canonicalize();
    let plain = |path: &Path| path.to_string_lossy().replace('\\', "\\\\").replace('"', "\\\"");
    let name = table.file_name().map(PathBuf::from).unwrap_or_default();
    match (folder(target), folder(table)) {
        (Ok(here), Ok(there)) => match there.strip_prefix(&here) {
            Ok(below) => plain(&below.join(name)),
            Err(_) => plain(&there.join(name)),
        },
        _ => plain(table),
    }
}
