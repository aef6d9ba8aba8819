//! Beyond the catalogue: on which variable what is missing depends, before any law is named.
//!
//! Let the force that is missing beside the calibrated model have any first harmonic dF = \[k(v) + i w c(v)\] x with k
//! and c smooth curves of one variable v: the amplitude, the frequency, the speed of the roller, the load, the level of
//! the drive, or a value of their own for every series (drift). The misfit that a class leaves is the least that any
//! law of that class can leave, as far as one harmonic goes. What recalibration can do, a constant k and c, the gain
//! and the free parameters, is refitted beside every curve, so that a constant explains nothing.
//!
//! An amplitude is that of the motion that the model itself is led to, not the measured one: a curve of the measured
//! amplitude would repeat its noise, and could follow any readings of one series.

mod class;
mod fit;
mod force;
mod json;
mod judge;
mod linear;
mod readings;
mod shapes;
mod spline;
mod variable;
mod words;

pub use json::{FreeFormJson, json};
pub use judge::MOST;
pub use shapes::Shape;
pub use variable::Variable;
pub use words::lines;

use crate::compare::{Comparison, units_of_force};
use crate::model::lumps::Lumps;
use class::Class;
use fit::Fitted;
use judge::Judged;
use nalgebra::DVector;
use rayon::prelude::*;
use readings::Readings;
use schemars::JsonSchema;

/// Places at which a smooth curve is given.
const PLACES: usize = 41;
/// Standard deviations on either side of a 95 % band.
const BAND: f64 = 1.959_963_984_540_054;

/// What the data say of a class of laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// A constant: what the others are held against.
    Base,
    /// What is missing depends on it: it leaves least.
    Leading,
    /// It leaves no more than the leading one by more than chance.
    Tied,
    /// It leaves more.
    Excluded,
    /// Two variables, which leave less than the leading one alone by more than chance.
    Further,
    /// Nothing is claimed of any variable.
    Undecided,
    /// These readings cannot tell: its curves could follow whatever there is.
    Untestable,
}

/// A class of laws and what the best of it leaves.
#[derive(Debug, Clone)]
pub struct Dependence {
    /// Its variables: none for a constant, two for a pair whose curves are added.
    pub variables: Vec<Variable>,
    /// What the data say.
    pub standing: Standing,
    /// Root mean square of the relative error in amplitude that is left \[%\].
    pub left_rms_percent: f64,
    /// Share of the sum of squares of what a constant leaves that it can explain at most \[%\].
    pub explained_percent: f64,
    /// The error of the amplitude of each series as predicted from all others \[%\].
    pub predicted_rms_percent: Option<f64>,
    /// Its curves, one per variable.
    pub curves: Vec<Curve>,
}

/// Stiffness and damping of the missing force against a variable, less their means over the readings.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The variable.
    pub variable: Variable,
    /// Its values in SI, or numbers of series from 1.
    pub values: Vec<f64>,
    /// k with the ends of its 95 % band, in the units of [`FreeForm::units`].
    pub stiffness: Vec<[f64; 3]>,
    /// c with the ends of its 95 % band.
    pub damping: Vec<[f64; 3]>,
}

/// What the data say of what is missing.
#[derive(Debug, Clone)]
pub struct FreeForm {
    /// The classes, a constant first.
    pub classes: Vec<Dependence>,
    /// What follows, in a sentence.
    pub statement: String,
    /// Where the force acts.
    pub acts_on: &'static str,
    /// What limits it, in plain words.
    pub notes: Vec<String>,
    /// Effects of the catalogue with the shape of the leading class, nearest first.
    pub shapes: Vec<Shape>,
    /// Units of stiffness, damping, the amplitude of the motion and the drive.
    pub units: [&'static str; 4],
    /// Stiffness and damping of the calibrated rig, in those units.
    pub of_rig: [f64; 2],
}

impl FreeForm {
    /// The class that leaves least, where anything is claimed.
    pub fn leading(&self) -> Option<&Dependence> {
        self.classes.iter().find(|class| class.standing == Standing::Leading)
    }

    /// The classes that are tied with it.
    pub fn tied(&self) -> impl Iterator<Item = &Dependence> {
        self.classes.iter().filter(|class| class.standing == Standing::Tied)
    }
}

/// On which variable depends what the calibrated model of a comparison leaves.
pub fn analyse(c: &Comparison) -> FreeForm {
    let [k, d, x] = if c.model.has_contact { ["N/m", "N s/m", "m"] } else { units_of_force(&c.model) };
    let acts_on = if c.model.has_contact {
        "the body, where and beside the contact's force; k and c are per motion at the contact"
    } else {
        "the coordinate, beside the forces of the model"
    };
    let readings = Readings::of(c);
    let square = lever(c, &readings).powi(2);
    let mut found = FreeForm {
        classes: Vec::new(),
        statement: String::new(),
        acts_on,
        notes: Vec::new(),
        shapes: Vec::new(),
        units: [k, d, x, c.table.signals.drive.unit],
        of_rig: readings.rig.map(|one| one / square),
    };
    if !readings.solvable() || readings.points.is_empty() {
        found.statement =
            "on which variable what is missing depends cannot be told of this contact: its steady states have no \
                           derivatives"
                .into();
        return found;
    }
    let judged = judge::judge(c, &readings);
    found.notes.extend(judged.notes.clone());
    found.classes = told(c, &readings, &judged);
    if let Some(best) = judged.leading {
        found.shapes = shapes::shapes(c, &readings, &judged, best);
    }
    found.statement = words::statement(&found, &judged);
    found
}

/// What a missing force leaves whose stiffness and damping are any smooth functions of the amplitude of the motion:
/// residuals of amplitudes and phases in standard deviations, and the number of unknowns; `None` where there is no such
/// force of the model.
pub fn left_by_amplitude(c: &Comparison) -> Option<(DVector<f64>, usize)> {
    let readings = Readings::of(c);
    if !readings.solvable() || readings.points.is_empty() {
        return None;
    }
    judge::left_by_amplitude(c, &readings)
}

/// Motion at the place that k and c are told of, per unit of the coordinate.
fn lever(c: &Comparison, readings: &Readings<'_>) -> f64 {
    let first = readings.points.first().filter(|_| c.model.has_contact);
    first.map_or(1.0, |p| Lumps::new(&c.model, &crate::fit::operation(p)).arm.value)
}

/// The classes as they are told, curves in the units of the rig.
fn told(c: &Comparison, readings: &Readings<'_>, judged: &Judged<'_>) -> Vec<Dependence> {
    let lever = lever(c, readings);
    let units = readings.units.map(|unit| unit / (lever * lever));
    let told = |(index, class): (usize, &judge::Tried<'_>)| Dependence {
        variables: class.variables.clone(),
        standing: judged.standing(index),
        left_rms_percent: class.left_rms_percent,
        explained_percent: judged.explained(index),
        predicted_rms_percent: class.predicted_rms_percent,
        curves: class.class.axes.iter().map(|axis| curve(axis, &class.fitted, class.scale, (units, lever))).collect(),
    };
    judged.tried.par_iter().enumerate().map(told).collect()
}

fn curve(axis: &class::Axis, fitted: &Fitted, scale: f64, (units, lever): ([f64; 2], f64)) -> Curve {
    let mut places = axis.places.clone();
    let mut values = axis.values.clone();
    if axis.variable == Variable::Amplitude {
        values = places.iter().map(|place| place.exp() * lever).collect();
    }
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
    order.dedup_by(|a, b| places[*a] == places[*b]);
    (places, values) = order.iter().map(|i| (places[*i], values[*i])).unzip();
    if places.len() > PLACES {
        // Between two values as between their places, which are logarithms.
        let (low, high) = (places[0], places[places.len() - 1]);
        let ratio = values[0] / low.exp();
        places = (0..PLACES).map(|i| low + (high - low) * i as f64 / (PLACES - 1) as f64).collect();
        values = places.iter().map(|place| ratio * place.exp()).collect();
    }
    if axis.variable == Variable::Drift {
        values.iter_mut().for_each(|number| *number += 1.0);
    }
    let bands: Vec<[[f64; 3]; 2]> = places
        .iter()
        .map(|place| {
            let (at, sd) = (Class::curve(axis, &fitted.state, *place), Class::deviation(axis, fitted, *place));
            [0, 1].map(|i| [0.0, -BAND, BAND].map(|times| (at[i] + times * sd[i] * scale) * units[i]))
        })
        .collect();
    let part = |i: usize| bands.iter().map(|band| band[i]).collect();
    Curve { variable: axis.variable, values, stiffness: part(0), damping: part(1) }
}
