//! What a table tells of its rig before any model.

use crate::compare::{calibrate, compared, judge};
use crate::discover::{Candidates, SearchOptions, are_better, explain, narrower};
use crate::effects::REGISTRY;
use crate::error::{Error, Result};
use crate::fit::resonance::{Resonance, astray, of_any};
use crate::measurement::{Mode, Point, Series, Survey, Table, load};
use crate::model::Model;
use crate::scenario::diagnostic::whole_file;
use crate::scenario::{self, Coordinate, Signal};
use crate::solver::cycle::Tolerance;
use crate::statistics::wrap;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;

/// Most readings of a series that a draft is held against: what tells kinds of rigs apart is the shape of the whole curve.
const MOST: usize = 512;

/// How a rig is driven and read, as far as the table does not say.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Whether its base moves, in place of a force that acts.
    pub base: bool,
    /// Times that the motion is differentiated before a reading in volts.
    pub order: u8,
    /// Whether the motion of the base is part of what is read.
    pub absolute: bool,
}

/// What a table tells of its rig.
pub struct Draft<'a> {
    pub seen: Survey,
    pub table: &'a Path,
    pub coordinate: Coordinate,
    pub resonance: Resonance,
    /// The resonance with the contact stuck, where one is told by roller speeds or loads.
    pub stuck: Option<Resonance>,
    pub rolls: bool,
    /// The resonances of the whole table, where there are several.
    pub modes: &'a [Mode],
    /// Between which frequencies \[Hz\] readings are used, where not all are.
    pub band: Option<(f64, f64)>,
}

impl<'a> Draft<'a> {
    /// What is `seen` of a table in a band of frequencies; `modes` of the whole one are resonances.
    ///
    /// # Errors
    /// Where it is no oscillator of one coordinate, or shows no resonance.
    pub fn new(seen: Survey, table: &'a Path, modes: &'a [Mode], band: Option<(f64, f64)>) -> Result<Self> {
        let refuse =
            |title: &str, help: &str| Err(Error::Input(whole_file(&format!("`{}`: {title}", table.display()), help)));
        let Some(coordinate) = seen.coordinate() else {
            return refuse(
                "the drive goes with a displacement and the reading with an angle, or the other way round",
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
        let orders = orders(seen.table.signals.reading);
        // On one side of a resonance that has no peak nothing is seen of it.
        let is_seen = |r: &Resonance| r.peaked && (r.spanned || r.quality > FRAC_1_SQRT_2);
        let of = |part: Vec<Point>| of_any(&part, orders.clone()).filter(is_seen);
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
        Ok(Self { seen, table, coordinate, resonance, stuck, rolls, modes, band })
    }

    /// The resonance that some readings show.
    pub fn resonance_of(&self, points: &[Point]) -> Option<Resonance> {
        of_any(points, orders(self.signals().1))
    }

    /// Drive and reading.
    pub fn signals(&self) -> (Signal, Signal) {
        (self.seen.table.signals.drive, self.seen.table.signals.reading)
    }

    /// Whether the table states a motion of the base as drive.
    pub fn base_driven(&self) -> bool {
        ["m", "rad", "m/s^2", "rad/s^2"].contains(&self.signals().0.unit)
    }

    /// Whether nothing is known of the drive but that it is the same throughout.
    pub fn is_drive_unstated(&self) -> bool {
        self.signals().0.unit == "V" && !self.seen.has("drive")
    }

    /// What differs in phase at resonance from a rig whose reading follows the drive, where phases are there.
    pub fn phase_offset(&self) -> Option<f64> {
        let (drive, reading) = self.signals();
        // The inertial force of a base is against its acceleration.
        let against = if self.base_driven() && drive.order == 2 { PI } else { 0.0 };
        let expected = FRAC_PI_2 * (f64::from(reading.order) - 1.0) + against;
        self.resonance.phase.map(|phase| wrap(phase - expected))
    }

    /// Between which frequencies \[Hz\] readings about the resonance are followed far better alone, where the scenario
    /// of this `text`, calibrated to all of them, has another resonance than they have: better than all are with
    /// something read beside the motion.
    ///
    /// # Errors
    /// Where the scenario cannot be read.
    pub fn followed_alone(&self, target: &Path, text: &str) -> Result<Option<(f64, f64)>> {
        let scenario = scenario::load_text(target, text)?;
        let Some(table) = load(&scenario)?.filter(|_| self.band.is_none()).map(thinned) else { return Ok(None) };
        let applied = table.applied_to(&scenario);
        let calibration = calibrate(&Model::new(&applied), &scenario.free, &table.points, Tolerance::FIT, 0);
        let calibrated = judge(&scenario, &table, &calibration, None).model;
        let Some((_, seen)) = astray(&calibrated, &table.points) else { return Ok(None) };
        let with = |table: &Table| {
            let options = SearchOptions { max_effects: 1, ..brief(true) };
            let (with, _) = explain(&scenario, table, &options, &Arc::default());
            compared(&table.points, &with.fit.evaluation.predictions)
        };
        let all = with(&table);
        let Some(found) = narrower(&applied, &table, &all, 0) else { return Ok(None) };
        let inside = |f: f64| (found.band.0..=found.band.1).contains(&f);
        // Of a notch the largest readings are beside it.
        if !inside(seen.frequency) {
            return Ok(None);
        }
        let mut about = table.clone();
        about.points.retain(|p| inside(p.frequency));
        Ok((found.is_better || are_better(&with(&about), &all)).then_some(found.band))
    }

    /// The series with their points.
    pub fn series(&self) -> impl Iterator<Item = (&Series, Vec<&Point>)> {
        let table = &self.seen.table;
        let of = |index: usize| table.points.iter().filter(move |p| p.series == index).collect();
        table.series.iter().enumerate().map(move |(index, series)| (series, of(index)))
    }
}

/// How many times a reading may be the motion differentiated: of a voltage it is not said, and what is broad as a
/// displacement may be none.
fn orders(reading: Signal) -> RangeInclusive<u8> {
    if reading.unit == "V" { 0..=2 } else { reading.order..=reading.order }
}

/// The number with so many significant digits.
pub fn digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// A table with at most [`MOST`] readings of each series, evenly over its rows.
pub fn thinned(table: Table) -> Table {
    let mut seen = vec![0; table.series.len()];
    let stride = |series: usize| table.points.iter().filter(|p| p.series == series).count().div_ceil(MOST);
    let strides: Vec<usize> = (0..table.series.len()).map(stride).collect();
    let is_kept = |series: usize, seen: &mut Vec<usize>| {
        seen[series] += 1;
        (seen[series] - 1).is_multiple_of(strides[series].max(1))
    };
    let points = table.points.iter().filter(|p| is_kept(p.series, &mut seen)).cloned().collect();
    Table { points, ..table }
}

/// A tenth of a search, by the effects that are read beside the motion or by those that act on it.
pub fn brief(beside: bool) -> SearchOptions {
    let whole = SearchOptions::default();
    let own = REGISTRY.iter().filter(|effect| effect.is_read_beside() == beside).map(|effect| effect.name()).collect();
    SearchOptions { budget: whole.budget / 10, candidates: Candidates::Named(own), ..whole }
}
