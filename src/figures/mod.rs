//! Figures: a [`crate::sweep::Outcome`] or a [`crate::compare::Comparison`] in, SVG, CSV and caption out; PNG from the
//! SVG. Nothing is simulated here.
//!
//! One file per figure: a pure function extracts what is shown, another draws it. [`style`] holds everything they look
//! alike in, [`canvas`] a thin layer over plotters, [`axes`] panels on its coordinates, [`data`] selections.

pub mod atlas;
pub mod axes;
pub mod baseline;
pub mod canvas;
pub mod clip;
pub mod collapse;
mod compact;
pub mod comparison;
pub mod data;
pub mod discovery;
pub mod formulations;
mod frame;
pub mod friction_independence;
mod groups;
pub mod history;
mod hooks;
pub mod legend;
pub mod loops;
pub mod marks;
pub mod orbits;
pub mod pen;
pub mod pixels;
pub mod preset;
pub mod prony;
pub mod question;
pub mod regime_map;
pub mod resonance;
pub mod ridge;
pub mod rig_sketch;
pub mod scheme;
pub mod style;
mod ticks;
pub mod time_histories;
pub mod trial;
pub mod velocity_amplitude;

use crate::scenario::Scenario;
use crate::sweep::Outcome;
use rayon::prelude::*;

/// Why a figure could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// The outcome lacks what the figure shows; the text states what the scenario needs.
    #[error("{0}")]
    MissingData(String),
    /// The SVG could not be turned into pixels.
    #[error("cannot render the figure as PNG: {0}")]
    Render(String),
}

impl FigureError {
    /// Missing data of the named figure, with what its scenario has to provide.
    pub fn missing(figure: &str, need: &str) -> Self {
        Self::MissingData(format!("figure `{figure}` needs {need}"))
    }
}

/// A finished figure.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Drawing {
    /// Name in the registry; also the file's stem.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it shows and what to look for, with numbers from the data.
    pub caption: String,
    /// Text alternative.
    pub alt: String,
    /// The drawing, deterministic.
    pub svg: String,
    /// The same for a narrow screen, where it has such a form.
    pub narrow: Option<String>,
    /// Exactly what is shown, with units in the header.
    pub csv: String,
    /// Key numbers: name, and value with unit.
    pub notes: Vec<(String, String)>,
    /// What good looks like, what bad looks like, what to do.
    pub reading: [String; 3],
}

impl Drawing {
    /// The drawing of a figure: caption and text alternative, SVG and CSV, key numbers.
    fn of<T>(
        figure: &dyn Figure<T>,
        (caption, alt): (String, String),
        (svg, csv): (String, String),
        notes: Vec<(String, String)>,
    ) -> Self {
        let drawing = Self::new((figure.name(), figure.title()), (caption, alt), (svg, csv), figure.reading());
        Self { notes, ..drawing }
    }

    /// The same in the words of the rig: figures of a contact are written for the paper's arm.
    fn told_of(mut self, scenario: &Scenario) -> Self {
        if scenario.rig.is_arm() {
            return self;
        }
        let signals = &scenario.signals;
        let (reading, drive) = (signals.reading.symbol, signals.drive.symbol);
        let words = [
            ("arm displacement b(θ − θ₀)", "displacement at the contact"),
            ("arm bθ′", "rig, at the contact"),
            ("Arm, bωα", "Rig"),
            ("the amplitude bωα of the arm's speed", "the amplitude of the rig's speed at the contact"),
            ("Amplitude bωα of the arm's speed at the contact", "Amplitude of the rig's speed at the contact"),
            ("speed amplitude bωα", "speed amplitude at the contact"),
            ("bωα", "the speed at the contact"),
            ("u₀", drive),
            ("u0", drive),
            ("α", reading),
            ("alpha", reading),
        ];
        let tell = |text: &str| {
            let text = words.iter().fold(text.to_string(), |text, (old, new)| text.replace(old, new));
            replaced(&replaced(&text, "arm", "rig"), "roller", "counterface")
        };
        for text in [&mut self.title, &mut self.caption, &mut self.alt, &mut self.svg, &mut self.csv] {
            *text = tell(text);
        }
        self.narrow = self.narrow.map(|text| tell(&text));
        for (label, text) in &mut self.notes {
            (*label, *text) = (tell(label), tell(text));
        }
        self.reading = self.reading.map(|text| tell(&text));
        self
    }

    /// A drawing without key numbers: name of its files and title, caption and text alternative, SVG and CSV, how to
    /// read it.
    fn new(
        (name, title): (&str, &str),
        (caption, alt): (String, String),
        (svg, csv): (String, String),
        reading: [&str; 3],
    ) -> Self {
        let reading = reading.map(String::from);
        let (name, title, notes) = (name.into(), title.into(), Vec::new());
        Self { name, title, caption, alt, svg, narrow: None, csv, notes, reading }
    }
}

/// The text with a word in place of another; what only contains it stays.
fn replaced(text: &str, word: &str, by: &str) -> String {
    let letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
    let mut told = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let (before, after) = (&rest[..at], &rest[at + word.len()..]);
        let inside = letter(before.chars().next_back().or(told.chars().next_back())) || letter(after.chars().next());
        told.push_str(before);
        told.push_str(if inside { word } else { by });
        rest = after;
    }
    told + rest
}

/// A figure of a `T`: of an outcome, a comparison, a discovery, a series of trials.
pub trait Figure<T = Outcome>: Sync {
    /// Name used in scenario files, in kebab-case; also the stem of its files.
    fn name(&self) -> &'static str;
    /// Title.
    fn title(&self) -> &'static str;
    /// How to read it: what good looks like, what bad looks like, what to do.
    fn reading(&self) -> [&'static str; 3];
    /// Whether the sweep must keep the orbits.
    fn needs_orbits(&self) -> bool {
        false
    }
    /// Draws the subject.
    ///
    /// # Errors
    /// [`FigureError::MissingData`] where the subject lacks what the figure shows.
    fn draw(&self, subject: &T) -> Result<Drawing, FigureError>;
}

/// Every figure, in the order in which a report shows them.
pub static REGISTRY: &[&dyn Figure] = &[
    &rig_sketch::RigSketch,
    &velocity_amplitude::VelocityAmplitude,
    &friction_independence::FrictionIndependence,
    &resonance::Resonance,
    &ridge::Ridge,
    &regime_map::RegimeMap,
    &collapse::Collapse,
    &loops::Loops,
    &time_histories::TimeHistories,
    &formulations::Formulations,
];

/// Names of all figures.
pub fn names() -> Vec<&'static str> {
    REGISTRY.iter().map(|figure| figure.name()).collect()
}

/// The figure of that name in a registry.
pub fn find<T: 'static>(registry: &[&'static dyn Figure<T>], name: &str) -> Option<&'static dyn Figure<T>> {
    registry.iter().copied().find(|figure| figure.name() == name)
}

/// Those figures of a registry that the subject can fill.
///
/// # Errors
/// [`FigureError::Render`] where one cannot be drawn.
pub fn drawings<T: Sync + 'static>(
    registry: &[&'static dyn Figure<T>],
    subject: &T,
) -> Result<Vec<Drawing>, FigureError> {
    let draw = |figure: &&dyn Figure<T>| match figure.draw(subject) {
        Err(FigureError::MissingData(_)) => None,
        drawn => Some(drawn),
    };
    registry.par_iter().filter_map(draw).collect()
}

/// The SVG as PNG, `scale` pixels per logical pixel.
///
/// # Errors
/// [`FigureError::Render`] where the SVG does not parse or the scale gives no image.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, FigureError> {
    style::rasterise(svg, scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_replaced_and_parts_of_words_stay() {
        assert_eq!(
            replaced("arm, the arm's harmonic and alarm arm", "arm", "rig"),
            "rig, the rig's harmonic and alarm rig"
        );
        assert_eq!(replaced("", "arm", "rig"), "");
    }
}
