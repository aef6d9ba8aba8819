//! The symbols of the equations, once, for the table of symbols and for the hints on symbols elsewhere.

use super::view::SymbolView;

/// Symbol, SI unit, meaning.
const SYMBOLS: &[(&str, &str, &str)] = &[
    ("J", "kg m²", "inertia of the arm about the torsional axis"),
    ("K₀", "N m/rad", "stiffness of the torsional spring"),
    ("C₀", "N m s/rad", "damping of the torsional spring"),
    ("k₀", "N/m", "stiffness of each translational spring"),
    ("c₀", "N s/m", "damping of each translational spring"),
    ("a", "m", "arm of the translational springs"),
    ("b", "m", "arm of the contact"),
    ("k_c", "N/m", "stiffness of the bristles of the contact"),
    ("c_c", "N s/m", "damping of the bristles of the contact"),
    ("μ", "", "coefficient of friction"),
    ("W", "N", "normal load; 0 means no contact"),
    ("V", "m/s", "peripheral speed of the roller"),
    ("u₀", "m", "amplitude of the actuator"),
    ("f", "Hz", "drive frequency"),
    ("ω", "rad/s", "angular drive frequency, 2πf"),
    ("α", "rad", "amplitude of the arm's angle at the drive frequency"),
    ("φ", "rad", "phase of that component, relative to the actuator"),
    ("θ₀", "rad", "mean angle of the arm"),
    ("bωα", "m/s", "amplitude of the arm's speed at the contact"),
    ("F", "N", "tangential force of the roller on the arm"),
    ("f₁, f₂", "Hz", "lower and upper frequency at which the arm's speed amplitude bωα equals V"),
];

/// All symbols, in the order in which the model introduces them.
pub fn glossary() -> Vec<SymbolView> {
    let view = |&(symbol, unit, meaning): &(&str, &str, &str)| SymbolView {
        symbol: symbol.into(),
        unit: unit.into(),
        meaning: meaning.into(),
    };
    SYMBOLS.iter().map(view).collect()
}

/// What a symbol means; empty for one that is not in the table.
pub fn meaning(symbol: &str) -> &'static str {
    SYMBOLS.iter().find(|(known, ..)| *known == symbol).map_or("", |(.., meaning)| meaning)
}
