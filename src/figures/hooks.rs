//! What a page finds in a drawing besides its looks: which panel and which series a shape belongs to, which series a
//! legend entry names, and how places in a panel become values.
//!
//! plotters draws no groups, so a circle of a huge radius stands for each end of one until the drawing is [dressed](dress).

use super::axes::{Axis, Panel, Scale};
use super::pixels::fine;

/// Radius from which on a circle stands for one end of a group, its number added.
pub(super) const HUGE: i32 = 1_000_000_000;
/// Stands for the end of a group.
pub(super) const END: i32 = -1;

/// The groups of a drawing under construction.
#[derive(Debug, Default)]
pub(super) struct Hooks {
    /// Opening tags, in the order of their ends.
    tags: Vec<String>,
    panels: Vec<Panel>,
    /// The panel whose shapes are being drawn.
    pub(super) inside: Option<usize>,
    /// The series being drawn.
    pub(super) series: Option<String>,
}

impl Hooks {
    /// The number of a group that opens with this tag.
    pub(super) fn open(&mut self, tag: String) -> i32 {
        self.tags.push(tag);
        self.tags.len() as i32 - 1
    }

    /// The number of a panel, of which it takes note.
    pub(super) fn number(&mut self, panel: &Panel) -> usize {
        let known = |other: &Panel| {
            (other.left, other.top, other.width, other.height) == (panel.left, panel.top, panel.width, panel.height)
        };
        self.panels.iter().position(known).unwrap_or_else(|| {
            self.panels.push(panel.clone());
            self.panels.len() - 1
        })
    }

    /// One empty group per panel that says where it stands and what its axes are.
    pub(super) fn panels(&self) -> String {
        let one = |(number, p): (usize, &Panel)| {
            let [left, top, width, height] = [p.left, p.top, p.width, p.height].map(fine);
            format!(
                "<g data-panel=\"{number}\" data-box=\"{left} {top} {width} {height}\" data-x=\"{}\" data-y=\"{}\" \
                 data-xl=\"{}\" data-yl=\"{}\"></g>\n",
                ends(&p.x),
                ends(&p.y),
                escape(&p.x.label),
                escape(&p.y.label)
            )
        };
        self.panels.iter().enumerate().map(one).collect()
    }
}

/// Ends of an axis and how it is divided.
pub(super) fn ends(axis: &Axis) -> String {
    let kind = match axis.scale {
        Scale::Value if axis.log => "log".into(),
        Scale::Value => "lin".into(),
        Scale::Sinh(factor, stretch) => format!("asinh {factor} {stretch}"),
        Scale::Rows => "rows".into(),
    };
    format!("{} {} {kind}", short(axis.low / axis.per), short(axis.high / axis.per))
}

/// Enough digits for any reading.
fn short(value: f64) -> f64 {
    format!("{value:.7e}").parse().unwrap_or(value)
}

/// Text as the value of an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The body of a drawing with its groups; neighbours with the same tag become one.
pub(super) fn dress(body: &str, hooks: &Hooks) -> String {
    let mut text = String::with_capacity(body.len() + 4096);
    let mut open: Vec<&str> = Vec::new();
    let mut closed: Option<&str> = None;
    for line in body.lines() {
        let radius = line.strip_prefix("<circle cx=\"0\" cy=\"0\" r=\"");
        let number = radius.and_then(|rest| Some(rest.split('"').next()?.parse::<i32>().ok()? - HUGE));
        let number = number.filter(|number| *number >= END);
        let tag = number.and_then(|n| usize::try_from(n).ok()).and_then(|n| hooks.tags.get(n));
        match (number, tag) {
            (Some(_), Some(tag)) if closed == Some(tag) => {
                closed = None;
                open.push(tag);
                continue;
            }
            _ => {}
        }
        if closed.take().is_some() {
            text.push_str("</g>\n");
        }
        match (number, tag) {
            (Some(_), Some(tag)) => {
                open.push(tag);
                text.push_str(tag);
            }
            (Some(_), None) => closed = open.pop(),
            _ if line == "</svg>" => text.push_str(&(hooks.panels() + line)),
            _ => text.push_str(line),
        }
        if number.is_none() || tag.is_some() {
            text.push('\n');
        }
    }
    text
}
