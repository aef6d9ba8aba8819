//! What a page finds in a drawing besides its looks: which panel and which series a shape belongs to, which series a
//! legend entry names, and how places in a panel become values.
//!
//! plotters draws no groups, so a circle of a huge radius stands for each end of one until the drawing is [dressed](dress).

use super::axes::{Axis, Panel, Scale};
use super::canvas::{Canvas, fine};

/// Radius from which on a circle stands for one end of a group, its number added.
pub(super) const HUGE: i32 = 1_000_000_000;
/// Stands for the end of a group.
const END: i32 = -1;

/// The groups of a drawing under construction.
#[derive(Debug, Default)]
pub(super) struct Hooks {
    /// Opening tags, in the order of their ends.
    tags: Vec<String>,
    panels: Vec<Panel>,
    /// The panel whose shapes are being drawn.
    inside: Option<usize>,
    /// The series being drawn.
    series: Option<String>,
}

impl Hooks {
    fn number(&mut self, panel: &Panel) -> usize {
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
fn ends(axis: &Axis) -> String {
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

impl Canvas<'_> {
    /// Draws into a group that opens with this tag.
    pub(super) fn group<R>(&mut self, tag: String, draw: impl FnOnce(&mut Self) -> R) -> R {
        self.end(self.hooks.tags.len() as i32);
        self.hooks.tags.push(tag);
        let drawn = draw(self);
        self.end(END);
        drawn
    }

    /// Takes note of a panel and the names of its axes; the first note of a place holds.
    pub fn register(&mut self, panel: &Panel) {
        self.hooks.number(panel);
    }

    /// Draws a series of that name; what it puts into panels belongs to it.
    pub fn series<R>(&mut self, name: &str, draw: impl FnOnce(&mut Self) -> R) -> R {
        let before = self.hooks.series.replace(name.into());
        let drawn = draw(self);
        self.hooks.series = before;
        drawn
    }

    /// Draws what belongs to a panel and moves with its axes.
    pub fn within<R>(&mut self, panel: &Panel, draw: impl FnOnce(&mut Self) -> R) -> R {
        self.belonging(panel, "", draw)
    }

    /// The same for areas, which grow with the axes however small they are.
    pub fn areas<R>(&mut self, panel: &Panel, draw: impl FnOnce(&mut Self) -> R) -> R {
        self.belonging(panel, " data-area=\"\"", draw)
    }

    fn belonging<R>(&mut self, panel: &Panel, more: &str, draw: impl FnOnce(&mut Self) -> R) -> R {
        let number = self.hooks.number(panel);
        if self.hooks.inside == Some(number) {
            return draw(self);
        }
        let name = self.hooks.series.as_ref().map(|name| format!(" data-s=\"{}\"", escape(name)));
        let outer = self.hooks.inside.replace(number);
        let tag = format!("<g data-p=\"{number}\"{}{more}>", name.unwrap_or_default());
        let drawn = self.group(tag, draw);
        self.hooks.inside = outer;
        drawn
    }

    /// Draws the colour bar that stands in a panel: what has one of its colours has the value beside it.
    pub fn color_bar<R>(&mut self, panel: &Panel, draw: impl FnOnce(&mut Self) -> R) -> R {
        let [top, height] = [panel.top, panel.height].map(fine);
        let (ends, name) = (ends(&panel.y), escape(&panel.y.label));
        self.group(format!("<g data-bar=\"{top} {height}\" data-y=\"{ends}\" data-yl=\"{name}\">"), draw)
    }

    /// Draws the legend entry of the series of that name.
    pub fn key<R>(&mut self, name: &str, draw: impl FnOnce(&mut Self) -> R) -> R {
        self.group(format!("<g data-key=\"{}\">", escape(name)), draw)
    }

    /// Draws the ticks of a panel, with names below and beside it or not: a view of another part replaces them.
    pub(super) fn ticks<R>(&mut self, panel: &Panel, names: (bool, bool), draw: impl FnOnce(&mut Self) -> R) -> R {
        let number = self.hooks.number(panel);
        let shows = format!("{}{}", if names.0 { "x" } else { "" }, if names.1 { "y" } else { "" });
        self.group(format!("<g data-ticks=\"{number}\" data-shows=\"{shows}\">"), draw)
    }
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

#[cfg(test)]
mod tests {
    use super::super::canvas::{Stroke, document};
    use super::super::style::INK;
    use super::*;

    #[test]
    fn shapes_say_their_panel_and_series_once_for_neighbours() {
        let (x, y) = (Axis::linear("f [Hz]", 50.0, 100.0), Axis::logarithmic("\"a\" [µrad]", [1.0, 100.0], 0.0));
        let panel = Panel { left: 1.0, top: 2.0, width: 30.0, height: 20.0, x, y };
        let line =
            |canvas: &mut Canvas<'_>| panel.curve(canvas, &[(60.0, 10.0), (80.0, 20.0)], Stroke::solid(INK, 1.0));
        let svg = document((40.0, 30.0), ("", ""), |canvas| {
            canvas.series("<one>", |canvas| {
                line(canvas);
                line(canvas);
            });
            line(canvas);
            canvas.areas(&panel, |canvas| canvas.rectangle((2.0, 3.0), 4.0, 5.0, INK, None));
        });
        let svg = svg.unwrap();
        assert_eq!(svg.matches("<g data-p=\"0\" data-s=\"&lt;one&gt;\">").count(), 1, "{svg}");
        assert_eq!(svg.matches("<g data-p=\"0\">").count(), 1, "{svg}");
        assert!(svg.contains("<g data-p=\"0\" data-area=\"\">"), "{svg}");
        assert!(svg.contains("data-box=\"16 32 480 320\" data-x=\"50 100 lin\" data-y=\"1 100 log\""), "{svg}");
        assert!(svg.contains("data-yl=\"&quot;a&quot; [µrad]\""), "{svg}");
        assert_eq!(svg.matches("<g").count(), svg.matches("</g>").count());
        assert!(!svg.contains("<circle"), "{svg}");
    }
}
