//! What the report says of a rig: its signals, its equations and their symbols, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rig that is not the paper's.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct RigView {
    /// What drives it and what is read of it in a sweep.
    #[serde(flatten)]
    pub signals: SignalsView,
    /// Whether it has a contact.
    pub contact: bool,
    /// Its equations without effects.
    pub equations: Vec<EquationView>,
    /// Symbols of these and of what is said of its readings.
    pub symbols: Vec<SymbolView>,
}

/// What drives a rig and what is read of it.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SignalsView {
    /// The drive.
    pub drive: SignalView,
    /// The reading.
    pub reading: SignalView,
}

/// A drive or a reading.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SignalView {
    /// Name in running text.
    pub name: String,
    /// Symbol.
    pub symbol: String,
    /// SI unit in the notation of scenario files.
    pub unit: String,
}

/// A symbol of the equations.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SymbolView {
    /// Id in the page.
    #[serde(default)]
    pub anchor: String,
    /// Symbol.
    pub symbol: String,
    /// SI unit.
    pub unit: String,
    /// Meaning.
    pub meaning: String,
}

/// An equation of the model.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct EquationView {
    /// What it is of.
    pub of: String,
    /// The equation in plain characters.
    pub equation: String,
}
