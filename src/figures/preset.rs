//! Sizes and resolutions of figures: for the two columns of a journal, a slide, a web page.
//!
//! A figure is laid out at one width, so a preset only says how wide that is on paper and how many pixels that takes.
//! Texts are [`TICK_SIZE`](super::style::TICK_SIZE) of [`WIDTH`](super::style::WIDTH) pixels: 7 to 9 pt at the width of
//! two columns. At the width of one column they could not be read, which is why there is no preset for it.

use super::{FigureError, style};

/// Logical pixels of SVG per millimetre: 96 per inch.
const PIXELS_PER_MM: f64 = 96.0 / 25.4;

/// How a figure is to be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Preset {
    /// Two columns of a journal: 183 mm wide, text of 7 to 9 pt, 600 dpi
    DoubleColumn,
    /// A slide of 13.33 inches: 338.7 mm wide, text of 13 pt and more, 150 dpi
    Slide,
    /// A web page: 1100 pixels wide
    Web,
}

impl Preset {
    /// Width \[mm\].
    pub fn width(self) -> f64 {
        match self {
            Self::DoubleColumn => 183.0,
            Self::Slide => 338.7,
            Self::Web => style::WIDTH / PIXELS_PER_MM,
        }
    }

    /// Pixels per inch.
    pub fn resolution(self) -> f64 {
        match self {
            Self::DoubleColumn => 600.0,
            Self::Slide => 150.0,
            Self::Web => 96.0,
        }
    }

    /// The drawing at its size; as it is where it does not say its size in pixels.
    pub fn svg(self, svg: &str) -> String {
        let Some((width, height)) = size(svg) else { return svg.into() };
        let millimetres = |pixels: f64| format!("{:.2}mm", pixels * self.width() / style::WIDTH);
        let old = format!(" width=\"{width}\" height=\"{height}\"");
        svg.replacen(&old, &format!(" width=\"{}\" height=\"{}\"", millimetres(width), millimetres(height)), 1)
    }

    /// The drawing in pixels, which carry the resolution.
    ///
    /// # Errors
    /// [`FigureError::Render`] where the SVG does not parse.
    pub fn png(self, svg: &str) -> Result<Vec<u8>, FigureError> {
        let scale = self.width() / 25.4 * self.resolution() / style::WIDTH;
        let png = style::rasterise(svg, scale as f32)?;
        Ok(with_resolution(png, self.resolution()))
    }
}

/// Width and height in the first tag.
fn size(svg: &str) -> Option<(f64, f64)> {
    let tag = &svg[..svg.find('>')?];
    let value = |name: &str| tag.split_once(&format!(" {name}=\""))?.1.split('"').next()?.parse().ok();
    Some((value("width")?, value("height")?))
}

/// A PNG that says how many pixels it has per metre, right after its header.
fn with_resolution(mut png: Vec<u8>, per_inch: f64) -> Vec<u8> {
    // Signature of 8 bytes; length, name, 13 bytes and checksum of the header.
    const HEADER: usize = 8 + 4 + 4 + 13 + 4;
    if png.len() < HEADER {
        return png;
    }
    let per_metre = ((per_inch / 0.0254).round() as u32).to_be_bytes();
    let body = [b"pHYs".as_slice(), &per_metre, &per_metre, &[1]].concat();
    let chunk = [9_u32.to_be_bytes().as_slice(), &body, &checksum(&body).to_be_bytes()].concat();
    png.splice(HEADER..HEADER, chunk);
    png
}

/// CRC-32 of ISO 3309, which PNG uses.
fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum as _;

    const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1100\" height=\"550\" viewBox=\"0 0 17600 8800\"><rect width=\"8\" height=\"8\"/></svg>";

    #[test]
    fn a_preset_sets_size_and_resolution_and_keeps_texts_readable() {
        let svg = Preset::DoubleColumn.svg(SVG);
        assert!(svg.contains("width=\"183.00mm\" height=\"91.50mm\" viewBox=\"0 0 17600 8800\""), "{svg}");
        assert_eq!(Preset::DoubleColumn.svg("<svg>"), "<svg>");
        for preset in Preset::value_variants() {
            let points = |pixels: f64| pixels * preset.width() / style::WIDTH / 25.4 * 72.0;
            assert!(points(style::TICK_SIZE) >= 7.0, "{preset:?}: {}", points(style::TICK_SIZE));
            let png = preset.png(SVG).unwrap();
            let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
            assert!((f64::from(number(16)) - preset.width() / 25.4 * preset.resolution()).abs() <= 1.0);
            assert_eq!((&png[37..41], number(41)), (&b"pHYs"[..], (preset.resolution() / 0.0254).round() as u32));
        }
        let double = Preset::DoubleColumn;
        assert!(style::LABEL_SIZE * double.width() / style::WIDTH / 25.4 * 72.0 <= 9.0);
    }

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // The end of every PNG.
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }
}
