//! Series: one sweep of the frequency each, along which structure, noise and shape are judged.

use schemars::JsonSchema;
use std::collections::{BTreeMap, BTreeSet};

use super::Point;
use super::reading::{Direction, Reading};
use crate::effects;
use crate::scenario::Scenario;
use crate::statistics::{is_alike, median, spread};

/// One sweep.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Series {
    /// What the table calls it; empty where it does not.
    pub name: String,
    /// Which way it was swept.
    pub direction: Direction,
    /// V \[m/s\].
    pub speed: f64,
    /// W \[N\].
    pub load: f64,
    /// Median of the drive, in the unit of [`super::Table::signals`].
    pub drive: f64,
    /// Smallest and largest drive.
    pub drives: (f64, f64),
}

impl super::Table {
    /// The scenario with what the table says of drive and reading; effects that have numbers of each series have those
    /// of its series.
    pub fn applied_to(&self, scenario: &Scenario) -> Scenario {
        let mut scenario = Scenario { signals: self.signals, ..scenario.clone() };
        for setting in &mut scenario.effects {
            if let Ok(effect) = effects::for_series(setting.effect, self.series.len()) {
                setting.effect = effect;
                setting.parameters.truncate(effect.parameters().len());
            }
        }
        scenario
    }
}

/// Series of points in canonical order that share load, speed and drive exactly; says in every point to which it
/// belongs.
pub fn by_condition(points: &mut [Point]) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for point in points {
        let same = |s: &Series| (s.load, s.speed, s.drive) == (point.load, point.speed, point.drive);
        point.series = all.iter().position(same).unwrap_or_else(|| {
            let (speed, load, drive) = (point.speed, point.load, point.drive);
            let (name, direction) = (String::new(), Direction::Unknown);
            all.push(Series { name, direction, speed, load, drive, drives: (drive, drive) });
            all.len() - 1
        });
    }
    all
}

/// Rows of one load, speed and drive from which on they are swept at a set drive.
pub(super) const SEVERAL: usize = 3;
/// Rows of a sweep, at least, that is told from others by the order of the rows.
pub(super) const SWEPT: usize = 4;
/// A way back that covers less than this share of the way is none, but a frequency that wavers.
const WAVERS: f64 = 0.1;
/// Relative change of the drive, as a logarithm, that may be another level.
pub(super) const LEVEL: f64 = 0.18;
/// ... where it is this many times the usual change from row to row.
const JUMP: f64 = 8.0;
/// Share of the steps of the frequency that go one way in a sweep.
const ONE_WAY: f64 = 0.8;

/// Finds the sweeps that the readings belong to, which stand in the order of the file, and numbers them by load, speed
/// and drive; says which were kept apart though they repeat each other. `arm` tells the paper's rig, whose drive is set: rows that share it are one sweep whatever their order.
///
/// What the table says of series and directions comes first. Else rows that share load, speed and drive belong together
/// where most rows do so in groups. Else the drive was measured: rows at one load and speed that follow each other are
/// one sweep as long as the frequency goes one way.
pub(super) fn group(list: &mut [Reading], arm: bool, notes: &mut Vec<String>) -> Vec<Series> {
    let named = list.iter().any(|reading| !reading.name.is_empty());
    let all: Vec<usize> = (0..list.len()).collect();
    let way = |reading: &Reading| reading.sweep.map(|sweep| sweep == Direction::Up);
    let bases = split(list, &all, |r| (r.name.clone(), way(r), r.load.to_bits(), r.speed.to_bits()));
    let set = named || is_set(list, &bases) || bases.iter().all(|rows| frequencies(list, rows) < SEVERAL);
    let mut sweeps: Vec<(Vec<usize>, bool)> = Vec::new();
    let mut apart = 0;
    for rows in bases {
        let levels = split(list, &rows, |reading| reading.drive.to_bits());
        let alike = is_set(list, std::slice::from_ref(&rows));
        let parts = match (named, set) {
            (true, _) if alike && levels.len() > 1 && is_interleaved(list, &rows, levels.len()) => levels,
            (true, _) => vec![rows],
            (_, true) if !arm && is_one_sweep(list, &rows, &levels) => vec![rows],
            (_, true) => levels,
            _ => by_order(list, &rows),
        };
        for part in parts {
            let both = if arm && !named { Vec::new() } else { both_ways(list, &part) };
            let unordered = arm && set && !named;
            let ways = if both.is_empty() { vec![part] } else { both };
            for way in ways {
                let parts = if named || unordered { vec![way] } else { changed(list, &way) };
                apart += if parts.len() > 1 { parts.len() } else { 0 };
                sweeps.extend(parts.into_iter().map(|part| (part, unordered)));
            }
        }
    }
    if apart > 0 {
        notes.push(format!(
            "sweeps that were repeated differ by more than they scatter: they are {apart} series, not pooled; \
             what changed between them may be a drift"
        ));
    }
    let mut series: Vec<(Series, Vec<usize>)> =
        sweeps.into_iter().map(|(rows, unordered)| (one(list, &rows, unordered), rows)).collect();
    series.sort_by(|(a, rows), (b, others)| {
        let keys = |s: &Series| [s.load, s.speed, s.drive];
        let pairs = keys(a).into_iter().zip(keys(b)).map(|(a, b)| a.total_cmp(&b));
        let order = pairs.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then);
        order.then_with(|| rows.iter().min().cmp(&others.iter().min()))
    });
    for (number, (_, rows)) in series.iter().enumerate() {
        for row in rows {
            list[*row].series = number;
        }
    }
    series.into_iter().map(|(series, _)| series).collect()
}

/// How many sweeps the rows are, each of enough of them to be told, and whether each agrees with the one before, as
/// those of one drive do.
pub(super) fn sweeps(list: &[Reading]) -> (usize, bool) {
    let rows: Vec<usize> = (0..list.len()).collect();
    let passes = passes(list, &rows);
    if is_in_no_order(list) && is_one_curve(list) {
        return (1, true);
    }
    let most = passes.iter().map(|pass| span(list, pass)).fold(0.0, f64::max);
    let told: Vec<&Vec<usize>> =
        passes.iter().filter(|pass| pass.len() >= SWEPT && span(list, pass) >= WAVERS * most).collect();
    let agree = told.windows(2).all(|pair| is_of_its_drive(list, pair[0], pair[1]));
    (told.len(), agree)
}

/// Whether the frequency turns at least half as often as in an order left to chance, in which two of three rows are a
/// turning point (Bienaymé).
fn is_in_no_order(list: &[Reading]) -> bool {
    let turns =
        |three: &[Reading]| (three[1].frequency - three[0].frequency) * (three[2].frequency - three[1].frequency) < 0.0;
    list.len() > 2 * SWEPT && 3 * list.windows(3).filter(|three| turns(three)).count() >= list.len() - 2
}

/// Whether readings are mostly as large as those beside them along the frequency, as those of one drive are.
fn is_one_curve(list: &[Reading]) -> bool {
    let mut along: Vec<(f64, f64)> = list.iter().map(|one| (one.frequency, one.amplitude.ln())).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let off = |three: &[(f64, f64)]| {
        let share = (three[1].0 - three[0].0) / (three[2].0 - three[0].0);
        three[1].1 - three[0].1 - share * (three[2].1 - three[0].1)
    };
    spread(along.windows(3).map(off).filter(|off| off.is_finite()), 0.0) < 0.5 * LEVEL
}

/// Whether a sweep is as large as another where the two meet, or one goes on where the other ends: within what they
/// scatter about one another, or by less than another level of the drive would make it.
fn is_of_its_drive(list: &[Reading], sweep: &[usize], other: &[usize]) -> bool {
    let mut along: Vec<(f64, f64)> =
        sweep.iter().map(|row| (list[*row].frequency, list[*row].amplitude.ln())).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    along.dedup_by_key(|(frequency, _)| *frequency);
    if along.len() < 2 {
        return false;
    }
    let beside = |row: &usize| {
        let own = (list[*row].frequency, list[*row].amplitude.ln());
        let above = along.partition_point(|(frequency, _)| *frequency < own.0).clamp(1, along.len() - 1);
        let (a, b) = (along[above - 1], along[above]);
        let (near, far) = if own.0 - a.0 < b.0 - own.0 { (a, b) } else { (b, a) };
        Beside { own, near, far, between: (a.0..=b.0).contains(&own.0) }
    };
    let all: Vec<Beside> = other.iter().map(beside).collect();
    let ratios: Vec<f64> = all.iter().filter(|one| one.between).map(Beside::ratio).filter(|r| r.is_finite()).collect();
    if ratios.len() >= SWEPT {
        let middle = median(ratios.iter().copied());
        return middle.abs() <= spread(ratios.iter().copied(), middle).max(0.5 * LEVEL);
    }
    let Some(nearest) = all.iter().min_by(|a, b| a.away().total_cmp(&b.away())) else { return false };
    let step = (nearest.near.0 - nearest.far.0).abs();
    let reach = (2.0 * step).max(WAVERS * span(list, sweep).min(span(list, other)));
    // As the slope at the end has it, or, where frequencies waver and that is noise, as the end itself is.
    let ratio = nearest.ratio().abs().min((nearest.own.1 - nearest.near.1).abs());
    nearest.away() <= reach && ratio < 0.5 * LEVEL
}

/// A reading and its neighbours in another sweep: frequency and logarithm of the amplitude of each.
struct Beside {
    own: (f64, f64),
    near: (f64, f64),
    far: (f64, f64),
    /// Whether it stands between the two.
    between: bool,
}

impl Beside {
    /// The logarithm of the ratio to the line through the neighbours.
    fn ratio(&self) -> f64 {
        let slope = (self.near.1 - self.far.1) / (self.near.0 - self.far.0);
        self.own.1 - self.near.1 - slope * (self.own.0 - self.near.0)
    }

    /// How far it is from the nearer \[Hz\].
    fn away(&self) -> f64 {
        (self.own.0 - self.near.0).abs()
    }
}

/// What is said of a sweep; the order of rows tells nothing where it is `unordered`.
fn one(list: &[Reading], rows: &[usize], unordered: bool) -> Series {
    let first = &list[rows[0]];
    let drives = rows.iter().map(|row| list[*row].drive);
    let range = drives.clone().fold((f64::INFINITY, 0.0_f64), |(low, high), drive| (low.min(drive), high.max(drive)));
    let drive = if range.0 == range.1 { range.0 } else { median(drives) };
    let direction = match first.sweep {
        Some(direction) => direction,
        None if unordered => Direction::Unknown,
        None => direction(list, rows),
    };
    Series { name: first.name.clone(), direction, speed: first.speed, load: first.load, drive, drives: range }
}

/// Curves that points tell, of amplitudes and, where most have one, of phases, one of each series.
pub fn curves<'p>(points: impl IntoIterator<Item = &'p Point>) -> usize {
    let (mut series, mut phases, mut all) = (BTreeSet::new(), 0, 0);
    for point in points {
        series.insert(point.series);
        phases += usize::from(point.phase.is_some());
        all += 1;
    }
    series.len() * if 2 * phases > all { 2 } else { 1 }
}

/// Which way the frequency goes from row to row.
fn direction(list: &[Reading], rows: &[usize]) -> Direction {
    let steps = rows.windows(2).map(|pair| list[pair[1]].frequency - list[pair[0]].frequency);
    let steps: Vec<f64> = steps.filter(|step| *step != 0.0).collect();
    let share = steps.iter().filter(|step| **step > 0.0).count() as f64 / steps.len() as f64;
    match steps.len() {
        0 | 1 => Direction::Unknown,
        _ if share >= ONE_WAY => Direction::Up,
        _ if share <= 1.0 - ONE_WAY => Direction::Down,
        _ => Direction::Unknown,
    }
}

/// Groups of rows with one key, in the order of their first.
fn split<K: Ord>(list: &[Reading], rows: &[usize], key: impl Fn(&Reading) -> K) -> Vec<Vec<usize>> {
    let mut numbers: BTreeMap<K, usize> = BTreeMap::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for row in rows {
        let number = *numbers.entry(key(&list[*row])).or_insert(groups.len());
        if number == groups.len() {
            groups.push(Vec::new());
        }
        groups[number].push(*row);
    }
    groups
}

/// Whether most rows share their drive with several others: it was set, not measured.
fn is_set(list: &[Reading], bases: &[Vec<usize>]) -> bool {
    let (mut shared, mut all) = (0, 0);
    for rows in bases {
        all += rows.len();
        let mut drives: Vec<f64> = rows.iter().map(|row| list[*row].drive).collect();
        drives.sort_by(f64::total_cmp);
        shared += drives.chunk_by(|a, b| a == b).map(<[f64]>::len).filter(|count| *count >= SEVERAL).sum::<usize>();
    }
    2 * shared >= all
}

/// How many frequencies there are.
fn frequencies(list: &[Reading], rows: &[usize]) -> usize {
    let mut all: Vec<f64> = rows.iter().map(|row| list[*row].frequency).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all.len()
}

/// Whether levels of the drive alternate along the frequency, as those of several sweeps do.
fn is_interleaved(list: &[Reading], rows: &[usize], levels: usize) -> bool {
    let mut sorted: Vec<&Reading> = rows.iter().map(|row| &list[*row]).collect();
    sorted.sort_by(|a, b| a.frequency.total_cmp(&b.frequency).then(a.drive.total_cmp(&b.drive)));
    let runs = 1 + sorted.windows(2).filter(|pair| pair[0].drive != pair[1].drive).count();
    runs > 3 * levels
}

/// Whether rows at several levels are one sweep in which the drive was read with few digits, sagged, or was another at
/// single readings.
fn is_one_sweep(list: &[Reading], rows: &[usize], levels: &[Vec<usize>]) -> bool {
    let count = levels.len();
    let is_one_pass = passes(list, rows).len() == 1;
    let wavers = || {
        let held: Vec<&Vec<usize>> = levels.iter().filter(|level| level.len() >= SEVERAL).collect();
        let drive = |row: usize| list[row].drive;
        let is_near = |level: &[usize]| rows.iter().all(|row| (drive(*row) / drive(level[0])).ln().abs() < LEVEL);
        let is_held = if is_one_pass { !held.is_empty() } else { held.len() == 1 };
        is_held && held.iter().all(|level| is_near(level))
    };
    let uneven = count > SEVERAL && !is_interleaved(list, rows, count) || count > 1 && wavers();
    uneven && (is_one_pass || frequencies(list, rows) == rows.len())
}

/// How far the frequency goes within some rows \[Hz\].
fn span(list: &[Reading], rows: &[usize]) -> f64 {
    let all = rows.iter().map(|row| list[*row].frequency);
    let (low, high) = all.fold((f64::INFINITY, 0.0f64), |(a, b), f| (a.min(f), b.max(f)));
    high - low
}

/// Sweeps up and down within the rows of one level; nothing where all go one way, or none is told.
fn both_ways(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    if list[rows[0]].sweep.is_some() {
        return Vec::new();
    }
    let passes = passes(list, rows);
    let ways: Vec<Direction> = passes.iter().map(|pass| direction(list, pass)).collect();
    let both = ways.contains(&Direction::Up) && ways.contains(&Direction::Down);
    let spans: Vec<f64> = passes.iter().map(|pass| span(list, pass)).collect();
    let (least, most) = spans.iter().fold((f64::INFINITY, 0.0f64), |(a, b), span| (a.min(*span), b.max(*span)));
    // Read frequencies that waver turn, too.
    if !both
        || least < WAVERS * most
        || passes.iter().any(|pass| pass.len() < SWEPT)
        || ways.contains(&Direction::Unknown)
    {
        return Vec::new();
    }
    let of = |way: Direction| {
        passes.iter().zip(&ways).filter(|(_, other)| **other == way).flat_map(|(pass, _)| pass.clone()).collect()
    };
    vec![of(Direction::Up), of(Direction::Down)]
}

/// Sweeps of one drive and direction, those together that differ by no more than they scatter: a rig that has changed
/// between them differs by what goes on from reading to reading.
fn changed(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    let mut alike: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for pass in passes(list, rows) {
        match alike.last_mut().filter(|(first, _)| !differs(list, first, &pass)) {
            Some((_, all)) => all.extend(pass),
            None => alike.push((pass.clone(), pass)),
        }
    }
    alike.into_iter().map(|(_, all)| all).collect()
}

/// Whether the readings of two sweeps at the same frequencies differ more alike from one to the next than by chance, and
/// by more than what is stated of them.
fn differs(list: &[Reading], sweep: &[usize], other: &[usize]) -> bool {
    let sorted = |rows: &[usize]| {
        let mut all: Vec<&Reading> = rows.iter().map(|row| &list[*row]).collect();
        all.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        all
    };
    let (sweep, other) = (sorted(sweep), sorted(other));
    let ratio = |own: &&Reading| {
        let at = sweep.binary_search_by(|beside| beside.frequency.total_cmp(&own.frequency)).ok()?;
        Some((own.amplitude / sweep[at].amplitude).ln()).filter(|ratio| ratio.is_finite())
    };
    let ratios: Vec<f64> = other.iter().filter_map(ratio).collect();
    let stated = median(other.iter().filter_map(|own| Some(own.amplitude_sd? / own.amplitude)));
    is_alike(&ratios) && spread(ratios.iter().copied(), 0.0) > stated
}

/// Sweeps of a measured drive, told by the order of the rows.
fn by_order(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    let repeated = rows.windows(2).filter(|pair| list[pair[0]].frequency == list[pair[1]].frequency).count();
    if 2 * repeated + 1 >= rows.len() && rows.len() > 1 {
        return by_block(list, rows);
    }
    let passes = passes(list, rows);
    let typical = median(passes.iter().map(|pass| pass.len() as f64));
    if passes.len() > SEVERAL && typical < SWEPT as f64 { by_level(list, rows) } else { passes }
}

/// Parts within which the frequency goes one way: a drive that changes on the way is another at a resonance.
fn passes(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    let frequency = |at: usize| list[rows[at]].frequency;
    let steps = (1..rows.len()).map(|at| (frequency(at) - frequency(at - 1)).abs());
    let typical = median(steps.filter(|step| *step > 0.0));
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut way = 0.0;
    for at in 0..rows.len() {
        let step = if at == 0 { 0.0 } else { frequency(at) - frequency(at - 1) };
        let turns = step * way < 0.0 && !is_slip(&frequency, rows.len(), at, way);
        if at == 0 || turns {
            // Of two readings where the sweep turns, one is of the way back.
            let back = turns && step.abs() <= 2.0 * typical && at > 1 && frequency(at - 1) == frequency(at - 2);
            let first = parts.last_mut().filter(|part| back && part.len() > 1).and_then(Vec::pop);
            way = if first.is_some() { step.signum() } else { 0.0 };
            parts.push(first.into_iter().collect());
        } else if step != 0.0 && way == 0.0 {
            way = step.signum();
        }
        if let Some(part) = parts.last_mut() {
            part.push(rows[at]);
        }
    }
    parts
}

/// Whether a step back is a slip of the order: at once the frequency is beyond where it started.
fn is_slip(frequency: &impl Fn(usize) -> f64, count: usize, at: usize, way: f64) -> bool {
    let beyond = |next: usize| next < count && (frequency(next) - frequency(at - 1)) * way > 0.0;
    beyond(at + 1) || beyond(at + 2)
}

/// Rows that go through the levels of the drive at one frequency after the other.
fn by_block(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    let mut sweeps: Vec<Vec<usize>> = Vec::new();
    let drive = |row: usize| list[row].drive;
    let mut rows = rows;
    while let Some(first) = rows.first() {
        let length = rows.iter().take_while(|row| list[**row].frequency == list[*first].frequency).count();
        let (block, rest) = rows.split_at(length);
        rows = rest;
        let mut block = block.to_vec();
        block.sort_by(|a, b| drive(*a).total_cmp(&drive(*b)));
        // Each level goes on with the sweep that is nearest; repeated readings go together.
        let mut taken = vec![false; sweeps.len()];
        for level in block.chunk_by(|a, b| (drive(*b) / drive(*a)).ln() < LEVEL) {
            let away = |sweep: usize| (drive(level[0]) / drive(sweeps[sweep][sweeps[sweep].len() - 1])).ln().abs();
            let open = (0..taken.len()).filter(|sweep| !taken[*sweep]);
            let nearest = open.min_by(|a, b| away(*a).total_cmp(&away(*b)));
            match nearest.filter(|sweep| away(*sweep) < 2.0 * LEVEL || length >= sweeps.len()) {
                Some(sweep) => {
                    taken[sweep] = true;
                    sweeps[sweep].extend(level);
                }
                None => {
                    sweeps.push(level.to_vec());
                    taken.push(true);
                }
            }
        }
    }
    sweeps.iter_mut().for_each(|sweep| sweep.sort_unstable());
    sweeps
}

/// Rows in no order, by levels of the drive where there are some.
fn by_level(list: &[Reading], rows: &[usize]) -> Vec<Vec<usize>> {
    let drive = |row: usize| list[row].drive;
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| drive(*a).total_cmp(&drive(*b)));
    let usual = median(sorted.windows(2).map(|pair| (drive(pair[1]) / drive(pair[0])).ln()));
    let level = |a: &usize, b: &usize| (drive(*b) / drive(*a)).ln() <= LEVEL.max(JUMP * usual);
    let mut levels: Vec<Vec<usize>> = sorted.chunk_by(level).map(<[usize]>::to_vec).collect();
    if levels.iter().any(|level| level.len() < SWEPT) {
        return vec![rows.to_vec()];
    }
    levels.iter_mut().for_each(|level| level.sort_unstable());
    levels
}
