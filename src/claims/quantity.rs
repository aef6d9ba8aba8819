//! The quantities that decide claims.

use super::{CurveText, QuantityText};
use crate::model::{Model, Operation};
use crate::scenario::DEFAULT_EULER_STEPS;
use crate::scenario::{Formulation, Scenario};
use crate::solver::analytic::Oscillator;
use crate::solver::cycle::Tolerance;
use crate::solver::{LANES, Warm, solve, solve_paper};
use crate::sweep::{LimitingCase, limiting_oscillator};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The paper's range of frequencies \[Hz\] and the step of the grid on which claims are judged.
const FROM: f64 = 50.0;
const TO: f64 = 100.0;
const STEP: f64 = 0.5;
/// The paper's load \[N\] and drive \[m\], where a curve names none.
const LOAD: f64 = 20.0;
const DRIVE: f64 = 2.5e-6;

/// What all claims are computed for.
pub struct Context {
    model: Model,
}

impl Context {
    pub fn new(scenario: &Scenario) -> Self {
        Self { model: Model::new(scenario) }
    }
}

type Result<T> = std::result::Result<T, String>;

/// A curve: a limiting case or an operating point.
#[derive(Clone)]
pub enum Curve {
    Limit(LimitingCase, f64),
    Operation { speed: f64, load: f64, drive: f64, friction: Option<f64>, formulation: Formulation },
}

impl Curve {
    fn read(text: &CurveText) -> Result<Self> {
        let drive = text.drive.as_ref().map_or(Ok(DRIVE), |n| n.si("m"))?;
        if let Some(case) = &text.case {
            let case = match case.as_str() {
                "free-or-full-slip" => LimitingCase::FreeOrFullSlip,
                "static-contact" => LimitingCase::StaticContact,
                other => {
                    return Err(format!("case `{other}` is unknown; it can be free-or-full-slip or static-contact"));
                }
            };
            return Ok(Self::Limit(case, drive));
        }
        let speed = text.speed.as_ref().ok_or("a curve needs `case` or `speed`")?.si("m/s")?;
        let load = text.load.as_ref().map_or(Ok(LOAD), |n| n.si("N"))?;
        let formulation = text.formulation.unwrap_or(Formulation::Series);
        Ok(Self::Operation { speed, load, drive, friction: None, formulation })
    }

    fn driven(&self, new: Option<f64>) -> Self {
        let mut curve = self.clone();
        if let Some(value) = new {
            match &mut curve {
                Self::Limit(_, drive) | Self::Operation { drive, .. } => *drive = value,
            }
        }
        curve
    }

    fn words(&self) -> String {
        match self {
            Self::Limit(LimitingCase::FreeOrFullSlip, _) => "case I/III".into(),
            Self::Limit(LimitingCase::StaticContact, _) => "case II".into(),
            Self::Operation { speed, formulation, .. } => {
                let how = if *formulation == Formulation::Paper { " (paper formulation)" } else { "" };
                format!("V = {}{how}", crate::units::format(*speed, "m/s"))
            }
        }
    }

    fn amplitudes(&self, context: &Context, frequencies: &[f64]) -> Vec<f64> {
        match *self {
            Self::Limit(case, drive) => {
                let oscillator = limiting_oscillator(&context.model, case, drive);
                frequencies.iter().map(|&f| oscillator.response(f).0).collect()
            }
            Self::Operation { speed, load, drive, friction, formulation } => {
                let mut model = context.model.clone();
                model.contact.formulation = formulation;
                model.contact.friction = friction.unwrap_or(model.contact.friction);
                if formulation == Formulation::Paper {
                    let at = |&frequency: &f64| Operation { speed, load, drive, frequency, series: 0 };
                    let at: Vec<Operation> = frequencies.iter().map(at).collect();
                    let lanes = at.par_chunks(LANES);
                    let states = lanes.flat_map_iter(|at| solve_paper(&model, at, DEFAULT_EULER_STEPS));
                    return states.map(|state| state.amplitude).collect();
                }
                frequencies
                    .par_chunks(13)
                    .flat_map_iter(|chunk| {
                        let mut warm = Warm::default();
                        let model = &model;
                        chunk.iter().map(move |&frequency| {
                            let at = Operation { speed, load, drive, frequency, series: 0 };
                            let tolerance = Tolerance::default();
                            solve(model, &at, DEFAULT_EULER_STEPS, &tolerance, false, &mut warm).state.amplitude
                        })
                    })
                    .collect()
            }
        }
    }

    /// Frequency \[Hz\] and height \[rad\] of the peak, refined by a parabola through three points of the grid.
    fn peak(&self, context: &Context) -> (f64, f64) {
        if let Self::Limit(case, drive) = *self {
            let oscillator: Oscillator = limiting_oscillator(&context.model, case, drive);
            return oscillator.peak(FROM, TO, 0);
        }
        let frequencies = grid();
        let amplitudes = self.amplitudes(context, &frequencies);
        let best = (0..amplitudes.len()).max_by(|&i, &j| amplitudes[i].total_cmp(&amplitudes[j])).unwrap_or(0);
        if best == 0 || best + 1 == amplitudes.len() {
            return (frequencies[best], amplitudes[best]);
        }
        let (left, middle, right) = (amplitudes[best - 1], amplitudes[best], amplitudes[best + 1]);
        let offset = 0.5 * (left - right) / (left - 2.0 * middle + right);
        (frequencies[best] + offset * STEP, middle - 0.25 * (left - right) * offset)
    }
}

fn grid() -> Vec<f64> {
    let count = ((TO - FROM) / STEP).round() as usize;
    (0..=count).map(|i| FROM + STEP * i as f64).collect()
}

/// A quantity with its arguments.
pub enum Setting {
    LargestDifference { a: Box<(Curve, Curve)>, only_slow_arm: bool },
    PeakShift(Box<(Curve, Curve)>),
    PeakRatio(Box<(Curve, Curve)>),
    InfluenceOfFriction { curve: Curve, friction: Vec<f64> },
    SpeedsInTransition(Vec<f64>),
}

impl Setting {
    pub fn read(text: &QuantityText) -> Result<Self> {
        let curve = |text: &Option<CurveText>, name: &str| {
            Curve::read(text.as_ref().ok_or_else(|| format!("the quantity needs the curve `{name}`"))?)
        };
        let pair = || Ok::<_, String>(Box::new((curve(&text.a, "a")?, curve(&text.b, "b")?)));
        match text.name.as_str() {
            "largest-difference" => {
                let only_slow_arm = match text.region.as_deref() {
                    None => false,
                    Some("arm-slower-than-roller") => true,
                    Some(other) => {
                        return Err(format!("`where = \"{other}\"` is unknown; it can be \"arm-slower-than-roller\""));
                    }
                };
                Ok(Self::LargestDifference { a: pair()?, only_slow_arm })
            }
            "peak-shift" => Ok(Self::PeakShift(pair()?)),
            "peak-ratio" => Ok(Self::PeakRatio(pair()?)),
            "largest-influence-of-friction" => {
                if text.friction.len() < 2 {
                    return Err("the quantity needs at least two values in `friction`".into());
                }
                Ok(Self::InfluenceOfFriction { curve: curve(&text.a, "a")?, friction: text.friction.clone() })
            }
            "speeds-in-transition" => {
                Ok(Self::SpeedsInTransition(text.speeds.iter().map(|n| n.si("m/s")).collect::<Result<_>>()?))
            }
            other => Err(format!(
                "quantity `{other}` is unknown; it can be largest-difference, peak-shift, peak-ratio, \
                 largest-influence-of-friction or speeds-in-transition"
            )),
        }
    }

    pub fn unit(&self) -> &'static str {
        if matches!(self, Self::PeakShift(_)) { "Hz" } else { "1" }
    }

    pub fn words(&self) -> String {
        match self {
            Self::LargestDifference { a, only_slow_arm } => {
                let region = if *only_slow_arm { " where the arm is slower than the roller" } else { "" };
                format!("largest relative difference in α between {} and {}{region}", a.0.words(), a.1.words())
            }
            Self::PeakShift(p) => format!("shift of the peak from {} to {}", p.0.words(), p.1.words()),
            Self::PeakRatio(p) => format!("height of the peak of {} relative to {}", p.1.words(), p.0.words()),
            Self::InfluenceOfFriction { curve, friction } => {
                format!("largest relative difference in α between {} values of μ at {}", friction.len(), curve.words())
            }
            Self::SpeedsInTransition(speeds) => {
                format!("how many of the {} printed speeds give a curve that differs from full slip", speeds.len())
            }
        }
    }

    /// The value in SI; `drive` replaces u0 everywhere.
    pub fn value(&self, context: &Context, drive: Option<f64>) -> Result<f64> {
        Ok(match self {
            Self::LargestDifference { a, only_slow_arm } => {
                let (a, b) = (a.0.driven(drive), a.1.driven(drive));
                let frequencies: Vec<f64> = if *only_slow_arm {
                    let Curve::Operation { speed, drive, .. } = a else {
                        return Err("`where` needs an operating point as curve `a`".into());
                    };
                    let free = limiting_oscillator(&context.model, LimitingCase::FreeOrFullSlip, drive);
                    let arm = context.model.rig.lever();
                    grid().into_iter().filter(|&f| arm * TAU * f * free.response(f).0 < speed).collect()
                } else {
                    grid()
                };
                let (x, y) = (a.amplitudes(context, &frequencies), b.amplitudes(context, &frequencies));
                largest(x.iter().zip(&y).map(|(x, y)| (x / y - 1.0).abs()))
            }
            Self::PeakShift(p) => p.1.driven(drive).peak(context).0 - p.0.driven(drive).peak(context).0,
            Self::PeakRatio(p) => p.1.driven(drive).peak(context).1 / p.0.driven(drive).peak(context).1,
            Self::InfluenceOfFriction { curve, friction } => {
                let curves: Vec<Vec<f64>> = friction
                    .iter()
                    .map(|&value| {
                        let mut curve = curve.driven(drive);
                        if let Curve::Operation { friction, .. } = &mut curve {
                            *friction = Some(value);
                        }
                        curve.amplitudes(context, &grid())
                    })
                    .collect();
                largest(curves.iter().flat_map(|c| c.iter().zip(&curves[0]).map(|(x, y)| (x / y - 1.0).abs())))
            }
            Self::SpeedsInTransition(speeds) => {
                let drive = drive.unwrap_or(DRIVE);
                let free = Curve::Limit(LimitingCase::FreeOrFullSlip, drive).amplitudes(context, &grid());
                let differs = |&&speed: &&f64| {
                    let formulation = Formulation::Series;
                    let curve = Curve::Operation { speed, load: LOAD, drive, friction: None, formulation };
                    let amplitudes = curve.amplitudes(context, &grid());
                    largest(amplitudes.iter().zip(&free).map(|(x, y)| (x / y - 1.0).abs())) > 1e-4
                };
                speeds.iter().filter(differs).count() as f64
            }
        })
    }
}

/// The largest value; NaN where one is NaN, so that a failed point is never overlooked.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| if v.is_nan() || m.is_nan() { f64::NAN } else { m.max(v) })
}
