//! What a search finds against the noise of the readings.

use crate::figures::axes::{Axis, Panel, range};
use crate::figures::canvas::{Stroke, document};
use crate::figures::legend::{Key, legend, legend_width};
use crate::figures::marks::Mark;
use crate::figures::style::{Color, GREY, INK, ROLLER, SLIP, STATIC, Table, WHITE, WIDTH, cell, count};
use crate::figures::{Drawing, Figure, FigureError};
use crate::trial::{Proportion, Scores, Summary};

const TOP: f64 = 24.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 92.0;
/// Shift of a series beside its neighbour, so that bars do not lie on one another \[px\].
const ASIDE: f64 = 7.0;

/// Shares of fewer are not joined: a line would promise a course.
const FEW: usize = 10;

/// The figure.
pub struct Power;

/// A share that is drawn over the noise.
struct Series {
    name: &'static str,
    of: fn(&Scores) -> &Proportion,
    look: (Mark, Color),
    filled: bool,
}

const SERIES: [Series; 5] = [
    Series { name: "draws that the data could show", of: |s| &s.visible, look: (Mark::Diamond, GREY), filled: true },
    Series { name: "right verdict", of: |s| &s.verdict, look: (Mark::Circle, INK), filled: true },
    Series { name: "effects named, or in a tie", of: |s| &s.named, look: (Mark::Square, STATIC), filled: true },
    Series { name: "outside causes flagged", of: |s| &s.flagged, look: (Mark::Triangle, ROLLER), filled: true },
    Series { name: "false alarms", of: |s| &s.false_alarm, look: (Mark::Circle, SLIP), filled: false },
];

fn draw(levels: &[(f64, &Scores)], title: &str, alt: &str) -> Result<String, FigureError> {
    let of = |s: &Series| {
        let (least, most) = range(levels.iter().map(|(_, scores)| (s.of)(scores).of as f64));
        if least == most { format!("{most}") } else { format!("{least} to {most}") }
    };
    let keys: Vec<_> = SERIES
        .iter()
        .map(|s| (Key::Mark(s.look.0, s.look.1, s.filled), format!("{} (of {})", s.name, of(s))))
        .collect();
    let width = WIDTH - LEFT - legend_width(&keys) - 40.0;
    let noises: Vec<f64> = levels.iter().map(|(noise, _)| 100.0 * noise).collect();
    document((WIDTH, TOP + HEIGHT + 62.0), (title, alt), |canvas| {
        let x = Axis::logarithmic("noise of the readings [%]", noises.iter().copied(), 0.08).at(&noises);
        let y = Axis::linear("share [%]", 0.0, 100.0).step(20.0);
        let panel = Panel { left: LEFT, top: TOP, width, height: HEIGHT, x, y };
        panel.frame(canvas, true, true);
        for (index, Series { of, look: (mark, color), filled, .. }) in SERIES.iter().enumerate() {
            let aside = ASIDE * (index as f64 - 0.5 * (SERIES.len() - 1) as f64);
            let mut last = None;
            for (noise, scores) in levels {
                let p = of(scores);
                let Some(share) = p.share else { continue };
                let at = (panel.px(100.0 * noise) + aside, panel.py(100.0 * share));
                if let Some(last) = last.replace(at).filter(|_| p.of >= FEW) {
                    canvas.line(last, at, Stroke::solid(*color, 1.2));
                }
                let ends = [p.low, p.high].map(|share| (at.0, panel.py(100.0 * share)));
                canvas.line(ends[0], ends[1], Stroke::solid(*color, 2.0));
                let (fill, outline) =
                    if *filled { (*color, Stroke::solid(INK, 0.6)) } else { (WHITE, Stroke::solid(*color, 1.6)) };
                canvas.mark(*mark, at, 5.0, fill, outline);
            }
        }
        legend(canvas, LEFT + width + 20.0, TOP - 6.0, &keys);
    })
}

impl Figure<Summary> for Power {
    fn name(&self) -> &'static str {
        "power"
    }

    fn title(&self) -> &'static str {
        "What the search finds against the noise"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Black, blue and green near 100 % and red at 0 % at every noise; grey falls as the noise grows.",
            "Blue falling with the noise while grey does not: causes that the data show are missed or mistaken.",
            "Measure with less noise, or more points; below the noise where blue falls the verdict is worth little.",
        ]
    }

    fn draw(&self, summary: &Summary) -> Result<Drawing, FigureError> {
        let mut levels: Vec<(f64, &Scores)> = summary.scores.iter().filter_map(|s| Some((s.noise?, s))).collect();
        levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        if levels.len() < 2 {
            return Err(FigureError::missing(self.name(), "trials at two levels of noise"));
        }
        let trials: usize = levels.iter().map(|(_, s)| s.trials).sum();
        let alt = format!("Shares with bars at {} of noise.", count(levels.len(), "level"));
        let caption = format!(
            "{} at {} levels of noise: share of the draws that the data could show (each trial draws until one is), and of the trials the \
             shares of right verdicts, of planted effects that were named, of causes outside the catalogue that were flagged, and of false \
             alarms where nothing was planted. Bars are Wilson's 95 % intervals; the marks of one level stand side by side; of how many a share is, \
             stands in brackets, and those of fewer than {FEW} are not joined.",
            count(trials, "trial"),
            levels.len()
        );
        let mut table = Table::new(&["noise", "share", "successes", "of", "low", "high"]);
        for (noise, scores) in &levels {
            for series in &SERIES {
                let p = (series.of)(scores);
                let numbers = [p.successes as f64, p.of as f64, p.low, p.high].map(cell);
                table.row([cell(*noise), series.name.to_string()].into_iter().chain(numbers));
            }
        }
        let svg = draw(&levels, self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), Vec::new()))
    }
}
