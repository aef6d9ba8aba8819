//! What the report says of a figure, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A drawing.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FigureView {
    /// Name of the figure.
    pub name: String,
    /// Stable id in the page.
    pub anchor: String,
    /// Title.
    pub title: String,
    /// What it shows and what to look for.
    pub caption: String,
    /// The drawing in words, for those who cannot see it.
    pub alt: String,
    /// Numbers that belong to it.
    pub notes: Vec<NoteView>,
    /// What good looks like, what bad looks like, what to do.
    #[serde(default)]
    pub reading: Vec<NoteView>,
    /// Files beside the report.
    pub files: Vec<FileView>,
    /// The drawing, checked when the page is made. Not part of the JSON: it is among the files.
    #[serde(skip)]
    pub svg: String,
    /// The same for a narrow screen, where it has such a form; among the files too.
    #[serde(skip)]
    pub narrow: Option<String>,
    /// What is shown as a table. Not part of the JSON either.
    #[serde(skip)]
    pub csv: String,
}

/// A labelled remark under a figure.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct NoteView {
    /// Label, e.g. "largest difference".
    pub label: String,
    /// Text.
    pub text: String,
}

/// A file beside the report.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FileView {
    /// Path relative to the report.
    pub name: String,
    /// The same as a safe relative link.
    pub href: String,
    /// What it is: `SVG`, `PNG`, `CSV`.
    pub kind: String,
}
