//! The variables that what is missing may depend on.

use crate::measurement::{Point, Series};
use schemars::JsonSchema;
use serde::Serialize;

/// A variable of the free force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variable {
    /// Amplitude of the motion of the coordinate.
    Amplitude,
    /// Frequency of the drive.
    Frequency,
    /// Speed of the roller.
    RollerSpeed,
    /// Normal load.
    Load,
    /// Drive of the series, its median.
    DriveLevel,
    /// Every series by itself.
    Drift,
}

/// All of them, in the order in which they are told.
pub const ALL: [Variable; 6] = [
    Variable::Amplitude,
    Variable::Frequency,
    Variable::RollerSpeed,
    Variable::Load,
    Variable::DriveLevel,
    Variable::Drift,
];

/// Relative difference below which drives of series are one level.
const LEVEL: f64 = 0.02;

impl Variable {
    /// As it is called in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Amplitude => "amplitude",
            Self::Frequency => "frequency",
            Self::RollerSpeed => "roller speed",
            Self::Load => "load",
            Self::DriveLevel => "drive level",
            Self::Drift => "series (drift)",
        }
    }

    /// As it is called in JSON.
    pub fn key(self) -> &'static str {
        match self {
            Self::Amplitude => "amplitude",
            Self::Frequency => "frequency",
            Self::RollerSpeed => "roller-speed",
            Self::Load => "load",
            Self::DriveLevel => "drive-level",
            Self::Drift => "drift",
        }
    }

    /// Its unit, where the last two of these are those of the amplitude and of the drive.
    pub fn unit(self, &[_, _, motion, drive]: &[&'static str; 4]) -> &'static str {
        match self {
            Self::Amplitude => motion,
            Self::Frequency => "Hz",
            Self::RollerSpeed => "m/s",
            Self::Load => "N",
            Self::DriveLevel => drive,
            Self::Drift => "1",
        }
    }

    /// Values at all points; of the amplitude none, which a motion has only when it is solved. `None` where it does not
    /// vary.
    pub fn values(self, points: &[&Point], series: &[Series]) -> Option<Vec<f64>> {
        let levels = levels(series);
        let of = |p: &&Point| match self {
            Self::Amplitude => 0.0,
            Self::Frequency => p.frequency,
            Self::RollerSpeed => p.speed,
            Self::Load => p.load,
            Self::DriveLevel => levels[p.series],
            Self::Drift => p.series as f64,
        };
        let values: Vec<f64> = points.iter().map(of).collect();
        (self == Self::Amplitude || values.iter().any(|value| *value != values[0])).then_some(values)
    }

    /// Where values lie on the scale on which curves are smooth: logarithms, beside a zero those of what is added to
    /// the smallest other value; the number of a series as it is.
    pub fn places(self, values: &[f64]) -> Vec<f64> {
        if self == Self::Drift {
            return values.to_vec();
        }
        let smallest = values.iter().copied().filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
        let beside = if values.iter().any(|value| *value <= 0.0) { smallest } else { 0.0 };
        values.iter().map(|value| (value + beside).ln()).collect()
    }
}

/// The drive of every series, alike ones made one level.
fn levels(series: &[Series]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..series.len()).collect();
    order.sort_by(|a, b| series[*a].drive.total_cmp(&series[*b].drive));
    let mut levels = vec![0.0; series.len()];
    let mut level = f64::NAN;
    for at in order {
        let drive = series[at].drive;
        if level.is_nan() || (drive / level).ln().abs() > LEVEL {
            level = drive;
        }
        levels[at] = level;
    }
    levels
}
