//! The free form in the JSON of a discovery.

use super::{Curve, Dependence, FreeForm, Shape, Standing, Variable};
use schemars::JsonSchema;
use serde::Serialize;

/// What `stickslip discover --json` writes of it; without a free form the lists are empty.
#[derive(Debug, Clone, Default, JsonSchema, Serialize)]
pub struct FreeFormJson {
    /// What smooth stiffness and damping of each variable leave, less their means over the readings, with 95 % bands;
    /// empty where it was not asked for. `docs/free-form.md` tells what each number is.
    depends_on: Vec<DependenceJson>,
    /// Named effects with the shape of the leading class, nearest first.
    shapes: Vec<Shape>,
    #[serde(skip_serializing_if = "Option::is_none")]
    free_form: Option<Summary>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct Summary {
    statement: String,
    acts_on: &'static str,
    notes: Vec<String>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct DependenceJson {
    variable: String,
    standing: Standing,
    left_rms_percent: f64,
    explained_percent: f64,
    predicted_rms_percent: Option<f64>,
    /// The curve; of a pair those of both, that of a constant is null.
    curve: Option<CurveJson>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    further_curves: Vec<CurveJson>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct CurveJson {
    variable: Variable,
    unit: &'static str,
    values: Vec<f64>,
    stiffness_unit: &'static str,
    stiffness: Vec<BandJson>,
    damping_unit: &'static str,
    damping: Vec<BandJson>,
}

#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
struct BandJson {
    value: f64,
    low: f64,
    high: f64,
}

/// The view that scripts read.
pub fn json(found: Option<&FreeForm>) -> FreeFormJson {
    let Some(found) = found else { return FreeFormJson::default() };
    FreeFormJson {
        depends_on: found.classes.iter().map(|class| dependence(class, found)).collect(),
        shapes: found.shapes.clone(),
        free_form: Some(Summary {
            statement: found.statement.clone(),
            acts_on: found.acts_on,
            notes: found.notes.clone(),
        }),
    }
}

fn dependence(class: &Dependence, found: &FreeForm) -> DependenceJson {
    let mut curves = class.curves.iter().map(|one| curve(one, found));
    let variables: Vec<String> = class.variables.iter().map(|v| v.key().into()).collect();
    DependenceJson {
        variable: if variables.is_empty() { "constant".into() } else { variables.join("+") },
        standing: class.standing,
        left_rms_percent: class.left_rms_percent,
        explained_percent: class.explained_percent,
        predicted_rms_percent: class.predicted_rms_percent,
        curve: curves.next(),
        further_curves: curves.collect(),
    }
}

fn curve(curve: &Curve, found: &FreeForm) -> CurveJson {
    let band = |[value, low, high]: &[f64; 3]| BandJson { value: *value, low: *low, high: *high };
    CurveJson {
        variable: curve.variable,
        unit: curve.variable.unit(&found.units),
        values: curve.values.clone(),
        stiffness_unit: found.units[0],
        stiffness: curve.stiffness.iter().map(band).collect(),
        damping_unit: found.units[1],
        damping: curve.damping.iter().map(band).collect(),
    }
}
