//! The symbols of the equations, once, for the table of symbols and for the hints on symbols elsewhere.

use super::view::{EquationView, SymbolView};
use minijinja::HtmlEscape;

/// Symbol and meaning of the parameter that a key such as `rig.stiffness` or `effect.cubic-stiffness.K_3` names, of a
/// torsional `arm` or an oscillator; nothing where it is a formula's.
pub fn parameter(key: &str, arm: bool) -> String {
    let of_effect = || {
        let (effect, own) = key.strip_prefix("effect.")?.rsplit_once('.')?;
        crate::effects::find_among(crate::effects::REGISTRY, effect)?.parameters().iter().find(|info| info.key == own)
    };
    let found = crate::scenario::parameters::of_key(key, arm).or_else(of_effect);
    found.map_or(String::new(), |info| match info.symbol {
        "" => info.meaning.into(),
        symbol => format!("{symbol}, {}", info.meaning),
    })
}

/// Id, symbol, SI unit, meaning.
const SYMBOLS: &[(&str, &str, &str, &str)] = &[
    ("inertia", "J", "kg m²", "inertia of the arm about the torsional axis"),
    ("K0", "K₀", "N m/rad", "stiffness of the torsional spring"),
    ("C0", "C₀", "N m s/rad", "damping of the torsional spring"),
    ("spring-k0", "k₀", "N/m", "stiffness of each translational spring"),
    ("spring-c0", "c₀", "N s/m", "damping of each translational spring"),
    ("arm-a", "a", "m", "arm of the translational springs"),
    ("arm-b", "b", "m", "arm of the contact"),
    ("contact-kc", "k_c", "N/m", "stiffness of the bristles of the contact"),
    ("contact-cc", "c_c", "N s/m", "damping of the bristles of the contact"),
    ("mu", "μ", "", "coefficient of friction"),
    ("load-W", "W", "N", "normal load; 0 means no contact"),
    ("speed-V", "V", "m/s", "peripheral speed of the roller"),
    ("drive-u0", "u₀", "m", "amplitude of the actuator"),
    ("frequency-f", "f", "Hz", "drive frequency"),
    ("omega", "ω", "rad/s", "angular drive frequency, 2πf"),
    ("alpha", "α", "rad", "amplitude of the arm's angle at the drive frequency"),
    ("phi", "φ", "rad", "phase of that component, relative to the actuator"),
    ("theta0", "θ₀", "rad", "mean angle of the arm"),
    ("arm-speed", "bωα", "m/s", "amplitude of the arm's speed at the contact"),
    ("force-F", "F", "N", "tangential force of the roller on the arm"),
    ("f1-f2", "f₁, f₂", "Hz", "lower and upper frequency at which the arm's speed amplitude bωα equals V"),
    ("sigma", "σ", "", "standard deviation of a reading: 1 in 20 errors of pure noise is larger than 2 σ"),
    ("chi2", "χ²", "", "mean square of the errors in standard deviations; noise alone gives 1"),
    (
        "delta-bic",
        "ΔBIC",
        "",
        "Bayesian information criterion (Schwarz 1978) above that of the best candidate; below 6 the two are a tie",
    ),
];

/// The equations of the model without effects.
const EQUATIONS: [(&str, &str); 4] = [
    ("the arm, driven through one spring and rubbed by the roller", "Jθ″ + Cθ′ + Kθ = a(k₀u + c₀u′) + bF"),
    ("its damping and stiffness", "C = C₀ + 2c₀a², K = K₀ + 2k₀a²"),
    ("bristles of stretch x in series with a slider of slip rate s", "x′ = V − bθ′ − s, F = kc x + cc x′"),
    ("the slider rests below the Coulomb limit, and slips at it", "s = 0 while |F| < μW, else |F| = μW"),
];

/// Symbols that are marked wherever a text has them; others could be words or units.
const MARKED: [&str; 12] = ["bωα", "ΔBIC", "χ²", "u₀", "θ₀", "F₀", "T₀", "a₀", "U₀", "α", "φ", "σ"];
/// Ids of what is said of any rig.
const OF_EVERYTHING: [&str; 3] = ["sigma", "chi2", "delta-bic"];

fn view(&(id, symbol, unit, meaning): &(&str, &str, &str, &str)) -> SymbolView {
    SymbolView { anchor: format!("symbol-{id}"), symbol: symbol.into(), unit: unit.into(), meaning: meaning.into() }
}

/// All symbols of the paper's rig, in the order in which the model introduces them.
pub fn glossary() -> Vec<SymbolView> {
    SYMBOLS.iter().map(view).collect()
}

/// Symbols of what is said of the readings of any rig.
pub fn of_everything() -> Vec<SymbolView> {
    SYMBOLS.iter().filter(|(id, ..)| OF_EVERYTHING.contains(id)).map(view).collect()
}

/// The equations of the paper's rig, each with what it is of.
pub fn equations() -> Vec<EquationView> {
    let view = |&(of, equation): &(&str, &str)| EquationView { of: of.into(), equation: equation.into() };
    EQUATIONS.iter().map(view).collect()
}

/// What a symbol means; empty for one that is not in the table.
pub fn meaning(symbol: &str) -> &'static str {
    SYMBOLS.iter().find(|(_, known, ..)| *known == symbol).map_or("", |(.., meaning)| meaning)
}

/// A symbol in italics, its index lowered.
pub fn set(symbol: &str) -> String {
    let (letter, index) = symbol.split_once('_').unwrap_or((symbol, ""));
    let index = if index.is_empty() { String::new() } else { format!("<sub>{}</sub>", HtmlEscape(index)) };
    format!("<var>{}</var>{index}", HtmlEscape(letter))
}

/// The symbols of a page, to which texts lead.
pub struct Links(Vec<(String, String)>);

impl Links {
    /// Links to these symbols; of two that are written alike, to the first.
    pub fn to(symbols: &[SymbolView]) -> Self {
        Self(symbols.iter().map(|view| (view.symbol.clone(), view.anchor.clone())).collect())
    }

    fn anchor(&self, symbol: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == symbol).map(|(_, anchor)| anchor.as_str())
    }

    /// A symbol in italics, its index lowered; a link to its meaning where the table has it.
    pub fn linked(&self, symbol: &str) -> String {
        let html = set(symbol);
        match self.anchor(symbol) {
            Some(anchor) => format!("<a class=\"term\" href=\"#{anchor}\" aria-describedby=\"{anchor}\">{html}</a>"),
            None => html,
        }
    }

    /// A text with the first of each marked symbol linked to its meaning.
    pub fn terms(&self, text: &str) -> String {
        let mut html = String::with_capacity(2 * text.len());
        let (mut rest, mut seen) = (text, Vec::new());
        let known: Vec<&str> = MARKED.into_iter().filter(|symbol| self.anchor(symbol).is_some()).collect();
        while !rest.is_empty() {
            let found = known.iter().filter(|symbol| !seen.contains(symbol)).filter_map(|s| Some((rest.find(s)?, s)));
            let Some((at, symbol)) = found.min_by_key(|(at, symbol)| (*at, std::cmp::Reverse(symbol.len()))) else {
                break;
            };
            let (before, after) = rest.split_at(at);
            html += &format!("{}{}", HtmlEscape(before), self.linked(symbol));
            seen.push(symbol);
            rest = &after[symbol.len()..];
        }
        html + &HtmlEscape(rest).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_escaped_and_lead_to_their_meaning() {
        assert_eq!(set("<b>_c"), "<var>&lt;b&gt;</var><sub>c</sub>");
        let links = Links::to(&glossary());
        let (linked, terms) = (|s: &str| links.linked(s), |s: &str| links.terms(s));
        assert_eq!(linked("zz"), "<var>zz</var>");
        let alpha = "<a class=\"term\" href=\"#symbol-alpha\" aria-describedby=\"symbol-alpha\"><var>α</var></a>";
        assert_eq!(linked("α"), alpha);
        assert_eq!(terms("<i> α, α & β"), format!("&lt;i&gt; {alpha}, α &amp; β"));
        assert!(terms("bωα").contains("symbol-arm-speed"));
    }

    #[test]
    fn marked_symbols_are_in_the_table_and_ids_are_unique() {
        let drives = crate::scenario::Signal::DRIVES.map(|drive| drive.symbol);
        assert!(MARKED.iter().all(|symbol| !meaning(symbol).is_empty() || drives.contains(symbol)));
        assert_eq!(of_everything().len(), OF_EVERYTHING.len());
        let mut ids: Vec<&str> = SYMBOLS.iter().map(|(id, ..)| *id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), SYMBOLS.len());
    }
}
