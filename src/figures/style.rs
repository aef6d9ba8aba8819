//! What all figures share in looks: sizes, colours, font, numbers with units, CSV, and pixels.

use super::FigureError;
use super::pixels::FINE;
pub use crate::units::count;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
use plotters::style::{FontDesc, FontFamily, FontStyle, RGBColor, register_font};
use resvg::{tiny_skia, usvg};
use std::io::Write as _;
use std::sync::{Arc, Once, OnceLock};

/// Width of a figure in logical pixels.
pub const WIDTH: f64 = 1100.0;
/// Height of a figure of one plot \[px\].
pub const HEIGHT: f64 = 740.0;
/// About the panels of a figure \[px\]: at the left, where the labels of an axis stand, at the right, above, where a line
/// of text stands, and between two panels.
pub const LEFT: f64 = 94.0;
/// See [`LEFT`].
pub const RIGHT: f64 = 20.0;
/// See [`LEFT`].
pub const TOP: f64 = 48.0;
/// See [`LEFT`].
pub const GAP: f64 = 34.0;
/// Size of tick and legend text \[px\].
pub const TICK_SIZE: f64 = 15.0;
/// Size of axis labels \[px\].
pub const LABEL_SIZE: f64 = 16.5;
/// Font families: DejaVu Sans is what the PNG uses; Verdana has nearly its widths.
pub const FONT: &str = "DejaVu Sans, Verdana, sans-serif";

/// An sRGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

impl Color {
    /// The colour at `share` of the way to another one.
    pub fn mix(self, other: Self, share: f64) -> Self {
        let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Self(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }

    /// The same, faded towards the background.
    pub fn faded(self) -> Self {
        self.mix(WHITE, 0.72)
    }
}

/// Text and frames.
pub const INK: Color = Color(0x22, 0x22, 0x22);
/// Secondary lines.
pub const GREY: Color = Color(0x77, 0x77, 0x77);
/// Grid lines.
pub const GRID: Color = Color(0xe4, 0xe4, 0xe4);
/// Background.
pub const WHITE: Color = Color(0xff, 0xff, 0xff);
/// Shading of sticking intervals.
pub const SHADE: Color = Color(0xdc, 0xe9, 0xf5);
/// Static contact (Okabe and Ito's blue).
pub const STATIC: Color = Color(0x00, 0x72, 0xb2);
/// Full slip (Okabe and Ito's vermilion).
pub const SLIP: Color = Color(0xcc, 0x2b, 0x1d);
/// Roller and computed curve (Okabe and Ito's bluish green).
pub const ROLLER: Color = Color(0x00, 0x8a, 0x63);

/// Static contact as a wide pale line.
pub const STATIC_BAND: Color = Color(0xa6, 0xce, 0xe8);
/// Full slip as a wide pale line.
pub const SLIP_BAND: Color = Color(0xf7, 0xc9, 0xa3);

/// How a line is interrupted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dash {
    /// Not at all.
    Solid,
    /// Dashes of a length and the gaps between them \[px\].
    Dashes(f64, f64),
    /// The same with a dot in every gap.
    DashDots(f64, f64),
}

/// Dash of the wide static-contact limit.
pub const DASH_BAND: Dash = Dash::Dashes(16.0, 5.0);
/// Dash of the static-contact limit.
pub const DASH_STATIC: Dash = Dash::Dashes(9.0, 5.0);
/// Dash of the no-contact and full-slip limit.
pub const DASH_SLIP: Dash = Dash::Dashes(6.0, 4.0);
/// Dash of the roller's speed.
pub const DASH_ROLLER: Dash = Dash::Dashes(14.0, 5.0);
/// Dots of guides and thresholds.
pub const DOTS: Dash = Dash::Dashes(2.0, 3.0);
/// Dashes of groups of curves, in the order in which they are given out.
pub const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashes(11.0, 4.0), Dash::Dashes(3.0, 3.0), Dash::DashDots(11.0, 9.0)];

/// Viridis at `t` in 0..1, for areas.
pub fn viridis(t: f64) -> Color {
    let RGBColor(red, green, blue) = ViridisRGB.get_color(if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 });
    Color(red, green, blue)
}

/// Blue for -1, near white for 0, red for 1 (ColorBrewer's RdBu, told apart by colour-blind readers), for areas.
pub fn diverging(t: f64) -> Color {
    const STOPS: [Color; 9] = [
        Color(0x05, 0x30, 0x61),
        Color(0x21, 0x66, 0xac),
        Color(0x5f, 0xa5, 0xcd),
        Color(0xbf, 0xdc, 0xec),
        Color(0xf7, 0xf7, 0xf7),
        Color(0xfb, 0xcf, 0xb7),
        Color(0xe5, 0x83, 0x68),
        Color(0xb2, 0x18, 0x2b),
        Color(0x67, 0x00, 0x1f),
    ];
    let place = if t.is_finite() { 4.0 * (t.clamp(-1.0, 1.0) + 1.0) } else { 4.0 };
    let index = (place as usize).min(7);
    STOPS[index].mix(STOPS[index + 1], place - index as f64)
}

/// Colour of line `index` of `count`: viridis, its pale end darkened so that lines stay readable on white.
pub fn ramp(index: usize, count: usize) -> Color {
    readable(if count <= 1 { viridis(0.45) } else { viridis(0.87 * index as f64 / (count - 1) as f64) })
}

/// Least contrast with white of what carries meaning (WCAG 2.2, success criterion 1.4.11).
const CONTRAST: f64 = 3.0;

/// A colour, darkened as far as needed to be seen on white.
pub fn readable(color: Color) -> Color {
    let darkened = |percent: u32| color.mix(Color(0, 0, 0), f64::from(percent) / 100.0);
    (0..100).map(darkened).find(|color| contrast_with_white(*color) >= CONTRAST).unwrap_or(INK)
}

/// Contrast ratio with white of WCAG 2.2.
fn contrast_with_white(Color(red, green, blue): Color) -> f64 {
    let linear = |channel: u8| {
        let c = f64::from(channel) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    1.05 / (0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue) + 0.05)
}

/// A unit with its prefix: displayed value = SI value / `factor`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// SI value of one unit.
    pub factor: f64,
    /// The unit as written on an axis.
    pub label: String,
}

impl Unit {
    /// Fixed unit.
    pub fn new(factor: f64, label: &str) -> Self {
        Self { factor, label: label.into() }
    }

    /// The largest prefix that shows `largest` as at least 0.1 (1 where nothing is known).
    pub fn fitting(largest: f64, base: &str) -> Self {
        let prefixes = [(1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"), (1e-15, "f")];
        let known = largest.is_finite() && largest > 0.0;
        let found = prefixes.iter().find(|(factor, _)| known && largest / factor >= 0.1 * (1.0 - 1e-9));
        let &(factor, prefix) = found.unwrap_or(if known { &prefixes[6] } else { &prefixes[1] });
        Self { factor, label: format!("{prefix}{base}") }
    }

    /// The same for what drives a rig or is read of it, in print; nobody writes km or krad.
    pub fn of_signal(largest: f64, unit: &str) -> Self {
        let motion = unit.starts_with('m') || unit.starts_with("rad");
        let largest = if motion { largest.min(99.0) } else { largest };
        Self::fitting(largest, &crate::units::printed(unit))
    }

    /// The same for one signal over another, the prefix being that of the first.
    pub fn of_ratio(largest: f64, (unit, other): (&str, &str)) -> Self {
        let Self { factor, label } = Self::of_signal(largest, unit);
        let one = if label.contains('/') { format!("({label})") } else { label };
        let other = crate::units::printed(other);
        let other = if other.contains(['/', ' ']) { format!("({other})") } else { other };
        Self { factor, label: format!("{one}/{other}") }
    }

    /// Hz, kHz or MHz.
    pub fn frequency(highest: f64) -> Self {
        let crate::units::Frequencies { factor, unit, .. } = crate::units::Frequencies::of([highest]);
        Self::new(factor, unit)
    }

    /// Millimetres per second, the unit of speeds throughout.
    pub fn speed() -> Self {
        Self::new(1e-3, "mm/s")
    }

    /// The value in this unit.
    pub fn of(&self, value: f64) -> f64 {
        value / self.factor
    }

    /// The value with `digits` significant digits and the unit.
    pub fn show(&self, value: f64, digits: usize) -> String {
        let space = if self.label.is_empty() || self.label == "°" { "" } else { " " };
        format!("{}{space}{}", significant(self.of(value), digits), self.label)
    }
}

/// `value` with at most `digits` significant digits, no trailing zeros, a true minus sign, and powers of ten far from 1.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "–".into();
    }
    let rounded: f64 = format!("{value:.*e}", digits.max(1) - 1).parse().unwrap_or(value);
    let exponent = rounded.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return trimmed(&format!("{rounded:.decimals$}"));
    }
    let mantissa = rounded / 10f64.powi(exponent);
    format!("{}×{}", trimmed(&format!("{mantissa:.*}", digits.max(1) - 1)), power_of_ten(exponent))
}

fn trimmed(text: &str) -> String {
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
    short.replace('-', "−")
}

/// 10 with a raised exponent.
pub fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = exponent.abs().to_string();
    let raised = digits.chars().map(|digit| digit.to_digit(10).map_or(digit, |d| RAISED[d as usize]));
    format!("10{}{}", if exponent < 0 { "⁻" } else { "" }, raised.collect::<String>())
}

/// A difference in percent, of an error budget say; what the solvers cannot resolve is said to be below that.
pub fn budget_percent(percent: f64) -> String {
    if percent.is_nan() {
        return "not compared".into();
    }
    if percent < 1e-3 { "< 0.001 %".into() } else { format!("{} %", significant(percent, 3)) }
}

/// The font of all figures as plotters knows it; its size is in units of the backend.
pub fn typeface(size: f64, bold: bool) -> FontDesc<'static> {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        // Fails for a broken font only; widths of texts are then estimated.
        let _ = register_font(FONT, FontStyle::Normal, dejavu::sans::regular());
        let _ = register_font(FONT, FontStyle::Bold, dejavu::sans::bold());
    });
    FontDesc::new(FontFamily::Name(FONT), size, if bold { FontStyle::Bold } else { FontStyle::Normal })
}

/// Width of a text in DejaVu Sans \[px\].
pub fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    // plotters measures with the size as the height of the font, which is 1.164 em.
    let measured = typeface(1.164 * FINE * size, bold).box_size(text);
    measured.map_or(0.65 * size * text.chars().count() as f64, |(width, _)| f64::from(width) / FINE)
}

/// What a CSV file holds.
#[derive(Debug, Clone, Default)]
pub struct Table {
    text: String,
}

impl Table {
    /// A table with its header.
    pub fn new(header: &[&str]) -> Self {
        let mut table = Self::default();
        table.row(header.iter().map(ToString::to_string));
        table
    }

    /// Appends a row; cells with commas or quotes are quoted.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let quoted = |cell: String| {
            if cell.contains([',', '"', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
        };
        let cells: Vec<String> = cells.into_iter().map(quoted).collect();
        self.text.push_str(&cells.join(","));
        self.text.push('\n');
    }

    /// The file's text.
    pub fn finish(self) -> String {
        self.text
    }
}

/// A number for a CSV cell: ten significant digits, empty where there is none.
pub fn cell(value: f64) -> String {
    let rounded = format!("{value:.9e}").parse::<f64>().unwrap_or(value);
    if rounded.is_finite() { format!("{}", if rounded == 0.0 { 0.0 } else { rounded }) } else { String::new() }
}

/// Parsing options with the embedded fonts, and no font of the system.
pub fn options() -> usvg::Options<'static> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut database = usvg::fontdb::Database::new();
        database.load_font_data(dejavu::sans::regular().to_vec());
        database.load_font_data(dejavu::sans::bold().to_vec());
        Arc::new(database)
    });
    usvg::Options { fontdb: Arc::clone(fonts), font_family: "DejaVu Sans".into(), ..usvg::Options::default() }
}

/// Pixels of an SVG as PNG.
pub(super) fn rasterise(svg: &str, scale: f32) -> Result<Vec<u8>, FigureError> {
    let failed = |reason: String| FigureError::Render(reason);
    let tree = usvg::Tree::from_str(svg, &options()).map_err(|error| failed(error.to_string()))?;
    let (width, height) = (tree.size().width() * scale, tree.size().height() * scale);
    if !(1.0..=20_000.0).contains(&width) || !(1.0..=20_000.0).contains(&height) {
        return Err(failed(format!("scale {scale} gives an image of {width} x {height} pixels")));
    }
    let mut pixels = tiny_skia::Pixmap::new(width.round() as u32, height.round() as u32)
        .ok_or_else(|| failed(format!("no memory for {width} x {height} pixels")))?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    encode(&pixels).map_err(|error| failed(error.to_string()))
}

/// Opaque pixels as PNG, row by row. Lines on white are smaller without a filter, and at this level of compression in a
/// third of the time of the usual one.
fn encode(pixels: &tiny_skia::Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_deflate_compression(png::DeflateCompression::Level(3));
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let width = pixels.width() as usize;
    let mut row = vec![0; 3 * width];
    for rgba in pixels.data().chunks_exact(4 * width) {
        for (rgb, rgba) in row.chunks_exact_mut(3).zip(rgba.chunks_exact(4)) {
            // Each by itself: three bytes are not worth a call.
            (rgb[0], rgb[1], rgb[2]) = (rgba[0], rgba[1], rgba[2]);
        }
        stream.write_all(&row)?;
    }
    stream.finish()?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_runs_from_dark_to_light() {
        assert_eq!([f64::NAN, -1.0, 0.0].map(viridis), [Color(68, 1, 84); 3]);
        assert_eq!([1.0, 7.0].map(viridis), [Color(254, 232, 37); 2]);
        let light = |i: i32| viridis(f64::from(i) / 50.0).1;
        assert!((0..50).all(|i| light(i) <= light(i + 1)), "{:?}", (0..=50).map(light).collect::<Vec<_>>());
    }

    #[test]
    fn lines_are_seen_on_white_and_told_apart() {
        assert!((contrast_with_white(Color(0, 0, 0)) - 21.0).abs() < 1e-9);
        // 4.54 is the ratio that WCAG's technique G18 is often shown with.
        assert!((contrast_with_white(Color(0x76, 0x76, 0x76)) - 4.54).abs() < 0.01);
        for count in 1..9 {
            let colors: Vec<Color> = (0..count).map(|index| ramp(index, count)).collect();
            assert!(colors.iter().all(|color| contrast_with_white(*color) >= CONTRAST), "{colors:?}");
            let apart = |pair: &[Color]| {
                let [Color(a, b, c), Color(d, e, f)] = [pair[0], pair[1]];
                [a.abs_diff(d), b.abs_diff(e), c.abs_diff(f)].iter().any(|difference| *difference > 16)
            };
            assert!(colors.windows(2).all(apart), "{colors:?}");
        }
        assert_eq!(readable(Color(68, 1, 84)), Color(68, 1, 84));
    }

    #[test]
    fn units_of_signals_have_prefixes_that_people_write() {
        assert_eq!(Unit::of_signal(0.06, "m/s^2").label, "mm/s²");
        assert_eq!(Unit::of_signal(2500.0, "m/s^2").show(2500.0, 3), "2500 m/s²");
        assert_eq!(Unit::of_signal(2500.0, "N").show(2500.0, 3), "2.5 kN");
        assert_eq!(Unit::of_ratio(60.0, ("m/s^2", "N")).label, "(m/s²)/N");
        assert_eq!(Unit::of_ratio(2e-5, ("m", "N m")).label, "µm/(N m)");
        assert_eq!((Unit::frequency(98.0).label, Unit::frequency(1.2e6).factor), ("Hz".into(), 1e3));
    }

    #[test]
    fn texts_are_as_wide_as_their_glyphs() {
        // Advance of `0` in DejaVu Sans: 1303 of 2048 units; bold: 1425.
        assert!((text_width("00", 100.0, false) - 127.2).abs() < 0.3, "{}", text_width("00", 100.0, false));
        assert!((text_width("00", 100.0, true) - 139.2).abs() < 0.3, "{}", text_width("00", 100.0, true));
    }
}
