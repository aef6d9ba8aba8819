//! Which files of a figure are written, and for what use.

use crate::figures::preset::Preset;
use clap::{Args, ValueEnum};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Lines and texts
    Svg,
    /// Pixels
    Png,
    /// The numbers shown
    Csv,
}

impl Format {
    /// Ending of the file's name.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Csv => "csv",
        }
    }
}

/// What is wanted of every figure.
#[derive(Debug, Clone, Args)]
pub struct FigureOutput {
    /// Files of each figure
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "svg,png,csv")]
    pub format: Vec<Format>,
    /// Size and resolution of SVG and PNG [default: 1100 pixels wide, PNG twice that]
    #[arg(long, value_name = "USE")]
    pub preset: Option<Preset>,
}

impl Default for FigureOutput {
    fn default() -> Self {
        Self { format: vec![Format::Svg, Format::Png, Format::Csv], preset: None }
    }
}
