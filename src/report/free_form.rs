//! On which variable what is missing depends: a part of a scenario's section.

use super::anchor;
use super::comparison::{none, shown};
use super::free_form_view::{DependenceView, FreeFormView, ShapeView};
use super::scenario::{FigureInput, figure};
use super::view::ScenarioView;
use crate::free_form::{FreeForm, Shape, Standing};

/// Shapes that are listed.
const SHAPES: usize = 8;

impl ScenarioView {
    /// The section with a free form in it.
    pub fn with_free_form(mut self, found: &FreeForm, figures: &[FigureInput]) -> Self {
        let class = |class: &crate::free_form::Dependence| DependenceView {
            name: class.name(),
            standing: words(class.standing).into(),
            left: shown(class.left_rms_percent, "%", 3),
            explained: if class.standing == Standing::Base { none() } else { shown(class.explained_percent, "%", 3) },
            predicted: class.predicted_rms_percent.map_or(none(), |percent| shown(percent, "%", 3)),
        };
        let shape = |shape: &Shape| ShapeView {
            effect: shape.effect.into(),
            left: shown(shape.left_rms_percent, "%", 3),
            explained: shown(shape.explained_percent, "%", 3),
        };
        let mut statement = found.statement.clone();
        statement[..1].make_ascii_uppercase();
        self.free_form = Some(FreeFormView {
            anchor: anchor::free_form(&self.id),
            statement: format!("{statement}."),
            acts_on: found.acts_on.into(),
            notes: found.notes.clone(),
            classes: found.classes.iter().map(class).collect(),
            shapes: found.shapes.iter().take(SHAPES).map(shape).collect(),
            figures: figures.iter().map(|input| figure(&self.id, input)).collect(),
        });
        self
    }
}

fn words(standing: Standing) -> &'static str {
    match standing {
        Standing::Base => "what the others are held against",
        Standing::Leading => "leaves least",
        Standing::Tied => "tied with it",
        Standing::Excluded => "leaves more",
        Standing::Undecided => "undecided",
        Standing::Further => "two variables leave less yet",
        Standing::Untestable => "these readings cannot tell",
    }
}
