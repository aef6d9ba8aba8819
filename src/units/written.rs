//! Numbers with units as scenario files, messages and axes write them.

/// A unit of the scenario files in print: `kg m^2` becomes `kg m²`; that of a pure number stays `1`.
pub fn printed(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace("^5", "⁵").replace("^-1", "⁻¹")
}

/// A value in SI with a prefix and digits for people: `2.5e-6 m` becomes `2.5 µm`, `1e-4 m/s` becomes `0.1 mm/s`.
/// Six significant digits; the text can be parsed again.
pub fn format(value: f64, si_unit: &str) -> String {
    with_digits(value, si_unit, 6)
}

fn with_digits(value: f64, si_unit: &str, figures: usize) -> String {
    const SCALES: &[(&str, f64)] =
        &[("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)];
    let size = value.abs();
    if si_unit == "1" {
        return digits(figures, value);
    }
    if !value.is_finite() || size == 0.0 {
        return format!("{} {si_unit}", digits(figures, value));
    }
    // Speeds of this experiment are read in mm/s, down to a thousandth of it.
    if si_unit == "m/s" && (0.9999e-6..1.0).contains(&size) {
        return format!("{} mm/s", digits(figures, value * 1e3));
    }
    if !matches!(
        si_unit,
        "m" | "s" | "N" | "N m" | "Hz" | "W" | "rad" | "m/s" | "V" | "m/s^2" | "rad/s" | "rad/s^2" | "Pa"
    ) {
        return format!("{} {si_unit}", digits(figures, value));
    }
    // Nobody writes krad or km/s^2.
    let largest = if matches!(si_unit, "rad" | "rad/s" | "rad/s^2" | "m/s" | "m/s^2") { 1.0 } else { f64::INFINITY };
    let mut scales = SCALES.iter().filter(|(_, scale)| *scale <= largest);
    let (prefix, scale) = scales.find(|(_, scale)| size >= scale * 0.999_999_5).unwrap_or(&("n", 1e-9));
    format!("{} {prefix}{si_unit}", digits(figures, value / scale))
}

/// Significant digits of the estimate and the ends of an interval: up to the second digit of the shorter half; three
/// where the interval is as wide as the estimate is large.
pub fn interval_digits([value, low, high]: [f64; 3]) -> [usize; 3] {
    let width = (high - value).abs().min((value - low).abs());
    if !(width.is_finite() && width > 0.0 && (high - low).abs() < value.abs()) {
        return [3; 3];
    }
    let order = |x: f64| format!("{x:e}").split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()).unwrap_or(0);
    [value, low, high].map(|x| (order(x) - order(width) + 2).clamp(2, 12) as usize)
}

/// Estimate and ends of an interval as [`format()`] shows them, with digits that suit it.
pub fn format_interval(values: [f64; 3], si_unit: &str) -> [String; 3] {
    let digits = interval_digits(values);
    let rounded = |i: usize| format!("{:.*e}", digits[i] - 1, values[i]).parse().unwrap_or(values[i]);
    [0, 1, 2].map(|i| with_digits(rounded(i), si_unit, digits[i].max(6)))
}

/// So many significant digits without trailing zeros; powers of ten only where the plain form is long.
fn digits(figures: usize, value: f64) -> String {
    let rounded: f64 = format!("{value:.*e}", figures - 1).parse().unwrap_or(value) + 0.0;
    if rounded != 0.0 && !(1e-4..1e6).contains(&rounded.abs()) { format!("{rounded:e}") } else { format!("{rounded}") }
}

/// Frequencies are written to about this part of their spacing.
const FINER: f64 = 70.0;

/// How the frequencies of a curve are written, whether they are around 0.5 Hz or 1 MHz: in which unit, and with as many
/// decimals as their spacing resolves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// Hertz per unit.
    pub factor: f64,
    /// Hz, kHz or MHz.
    pub unit: &'static str,
    /// Decimals in that unit.
    pub decimals: usize,
}

impl Frequencies {
    /// Those that suit frequencies in ascending order, of several curves one after the other.
    pub fn of(frequencies: impl IntoIterator<Item = f64>) -> Self {
        let all: Vec<f64> = frequencies.into_iter().filter(|f| f.is_finite()).collect();
        let mut steps: Vec<f64> = all.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        let highest = all.iter().copied().fold(0.0, f64::max);
        let (factor, unit) = match highest {
            f if f < 2e4 => (1.0, "Hz"),
            f if f < 2e7 => (1e3, "kHz"),
            _ => (1e6, "MHz"),
        };
        let step = steps.get(steps.len() / 2).copied().unwrap_or(highest / 100.0) / factor;
        let decimals = if step > 0.0 { (FINER / step).log10().round().clamp(0.0, 9.0) as usize } else { 2 };
        Self { factor, unit, decimals }
    }

    /// Number and unit, with all decimals.
    pub fn fixed(&self, frequency: f64) -> String {
        format!("{:.*} {}", self.decimals, frequency / self.factor, self.unit)
    }

    /// The number alone, without needless digits.
    pub fn number(&self, frequency: f64) -> String {
        let text = format!("{:.*}", self.decimals, frequency / self.factor);
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    }

    /// Number and unit.
    pub fn show(&self, frequency: f64) -> String {
        format!("{} {}", self.number(frequency), self.unit)
    }

    /// A difference of two, with a digit less.
    pub fn difference(&self, frequency: f64) -> String {
        let shown = frequency / self.factor;
        // Never nothing of what is more than that.
        let first = if shown > 0.0 { (-shown.log10().floor()).max(0.0) as usize } else { 0 };
        format!("{shown:.*} {}", self.decimals.saturating_sub(1).max(1).max(first), self.unit)
    }
}
