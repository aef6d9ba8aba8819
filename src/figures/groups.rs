//! Groups of a drawing: the panel and the series that a shape belongs to, entries of legends, colour bars and ticks.

use super::axes::Panel;
use super::canvas::Canvas;
use super::hooks::{ends, escape};
use super::pixels::fine;

impl Canvas<'_> {
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
        let lying = panel.width > panel.height;
        let (from, length, axis) =
            if lying { (panel.left, panel.width, &panel.x) } else { (panel.top, panel.height, &panel.y) };
        let ([from, length], ends, name) = ([from, length].map(fine), ends(axis), escape(&axis.label));
        let lying = if lying { " data-lying=\"\"" } else { "" };
        self.group(format!("<g data-bar=\"{from} {length}\"{lying} data-y=\"{ends}\" data-yl=\"{name}\">"), draw)
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

#[cfg(test)]
mod tests {
    use super::super::axes::Axis;
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
