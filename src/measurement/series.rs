//! Series: one sweep of the frequency each, along which structure, noise and shape are judged.

use super::Point;
use crate::scenario::Scenario;

/// Which way the frequency was swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// From low to high.
    Up,
    /// From high to low.
    Down,
    /// Not known: the rows are in no order, or their order is not known.
    Unknown,
}

/// One sweep.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
    /// The scenario with what the table says of drive and reading.
    pub fn applied_to(&self, scenario: &Scenario) -> Scenario {
        Scenario { signals: self.signals, ..scenario.clone() }
    }
}

/// Series of points in canonical order that share load, speed and drive exactly; says in every point to which it belongs.
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
