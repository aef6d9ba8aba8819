//! What a table tells of its rig before any model.

use crate::error::{Error, Result};
use crate::fit::resonance::{Resonance, of_all};
use crate::measurement::{Mode, Point, Series, Survey};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::{Coordinate, Signal};
use crate::statistics::wrap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

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
    pub seen: &'a Survey,
    pub table: &'a Path,
    pub coordinate: Coordinate,
    pub resonance: Resonance,
    /// The resonance with the contact stuck, where one is told by roller speeds or loads.
    pub stuck: Option<Resonance>,
    pub rolls: bool,
    /// The resonances of the whole table, where there are several: the readings about the first are used.
    pub modes: &'a [Mode],
}

impl<'a> Draft<'a> {
    /// What is seen in a table, `modes` of which are resonances.
    ///
    /// # Errors
    /// Where it is no oscillator of one coordinate, or shows no resonance.
    pub fn new(seen: &'a Survey, table: &'a Path, modes: &'a [Mode]) -> Result<Self> {
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

    /// The series with their points.
    pub fn series(&self) -> impl Iterator<Item = (&Series, Vec<&Point>)> {
        let table = &self.seen.table;
        let of = |index: usize| table.points.iter().filter(move |p| p.series == index).collect();
        table.series.iter().enumerate().map(move |(index, series)| (series, of(index)))
    }
}

/// The number with so many significant digits.
pub fn digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}
