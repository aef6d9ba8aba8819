//! Runs of like elements of a drawing become one path each: small marks by the hundred are most of a figure of
//! measurements, and their attributes are most of a mark.

use std::fmt::Write as _;

/// A run of elements that look alike.
struct Run {
    style: String,
    path: String,
    first: String,
    count: usize,
}

impl Run {
    fn flush(self, text: &mut String) {
        match self.count {
            1 => text.push_str(&self.first),
            _ => {
                let _ = write!(text, "<path {} d=\"{}\"/>", self.style, self.path);
            }
        }
        text.push('\n');
    }
}

/// The body of a drawing with neighbouring segments, dots and patches of one look put together.
pub(super) fn compact(body: &str) -> String {
    let mut text = String::with_capacity(body.len());
    let mut open: Option<Run> = None;
    for line in body.lines() {
        let parsed = segment(line).or_else(|| dot(line)).or_else(|| patch(line)).or_else(|| area(line));
        match (parsed, open.as_mut()) {
            (Some((style, path)), Some(run)) if run.style == style => {
                run.path.push_str(&path);
                run.count += 1;
            }
            (parsed, _) => {
                if let Some(run) = open.take() {
                    run.flush(&mut text);
                }
                match parsed {
                    Some((style, path)) => open = Some(Run { style, path, first: line.into(), count: 1 }),
                    None => {
                        text.push_str(line);
                        text.push('\n');
                    }
                }
            }
        }
    }
    if let Some(run) = open {
        run.flush(&mut text);
    }
    text
}

/// Value of an attribute.
fn value<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// A straight line of two points.
fn segment(line: &str) -> Option<(String, String)> {
    if !line.starts_with("<polyline fill=\"none\" ") {
        return None;
    }
    let mut points = value(line, "points")?.split_ascii_whitespace();
    let (from, to) = (points.next()?.split_once(',')?, points.next()?.split_once(',')?);
    if points.next().is_some() {
        return None;
    }
    let style = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"",
        value(line, "stroke")?,
        value(line, "stroke-width")?
    );
    let path = match (from, to) {
        ((x, y), (same, end)) if x == same => format!("M{x},{y}V{end}"),
        ((x, y), (end, same)) if y == same => format!("M{x},{y}H{end}"),
        ((x, y), (end, down)) => format!("M{x},{y}L{end},{down}"),
    };
    Some((style, path))
}

/// A circle without outline: a line without length and with round ends.
fn dot(line: &str) -> Option<(String, String)> {
    if !line.starts_with("<circle ") || value(line, "stroke")? != "none" {
        return None;
    }
    let width = 2 * value(line, "r")?.parse::<i64>().ok()?;
    let fill = value(line, "fill")?;
    let style = format!("fill=\"none\" stroke=\"{fill}\" stroke-width=\"{width}\" stroke-linecap=\"round\"");
    Some((style, format!("M{},{}h0", value(line, "cx")?, value(line, "cy")?)))
}

/// A rectangle without outline.
fn patch(line: &str) -> Option<(String, String)> {
    if !line.starts_with("<rect ") || value(line, "stroke")? != "none" {
        return None;
    }
    let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| value(line, name));
    let (x, y, width, height) = (x?, y?, width?, height?);
    Some((format!("fill=\"{}\"", value(line, "fill")?), format!("M{x},{y}h{width}v{height}h-{width}z")))
}

/// A polygon without outline, all of them turning the same way so that overlaps stay filled.
fn area(line: &str) -> Option<(String, String)> {
    if !line.starts_with("<polygon fill=") || line.contains("stroke=") {
        return None;
    }
    let number = |text: &str| text.parse::<i64>().ok();
    let pairs = value(line, "points")?.split_ascii_whitespace().map(|pair| pair.split_once(','));
    let mut points: Vec<(i64, i64)> =
        pairs.map(|p| p.and_then(|(x, y)| Some((number(x)?, number(y)?)))).collect::<Option<_>>()?;
    let turns = |(a, b): (&(i64, i64), &(i64, i64))| a.0 * b.1 - b.0 * a.1;
    if points.iter().zip(points.iter().cycle().skip(1)).map(turns).sum::<i64>() < 0 {
        points.reverse();
    }
    let mut path = String::new();
    for (index, (x, y)) in points.iter().enumerate() {
        let _ = write!(path, "{}{x},{y}", if index == 0 { 'M' } else { 'L' });
    }
    Some((format!("fill=\"{}\"", value(line, "fill")?), path + "z"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_look_become_paths_and_single_elements_stay() {
        let grid = |points: &str| {
            format!("<polyline fill=\"none\" stroke=\"#E4E4E4\" stroke-width=\"16\" points=\"{points}\"/>\n")
        };
        let dot = "<circle cx=\"5\" cy=\"6\" r=\"4\" fill=\"#222222\" stroke=\"none\"/>\n";
        let body = [grid("1,2 1,9 "), grid("3,4 8,4 "), grid("3,4 8,5 "), grid("1,2 3,4 5,6 "), dot.into()].concat();
        let expected = format!(
            "<path fill=\"none\" stroke=\"#E4E4E4\" stroke-width=\"16\" d=\"M1,2V9M3,4H8M3,4L8,5\"/>\n{}{dot}",
            grid("1,2 3,4 5,6 ")
        );
        assert_eq!(compact(&body), expected);
        let dots = format!("{dot}{dot}");
        let path =
            "<path fill=\"none\" stroke=\"#222222\" stroke-width=\"8\" stroke-linecap=\"round\" d=\"M5,6h0M5,6h0\"/>\n";
        assert_eq!(compact(&dots), path);
    }

    #[test]
    fn patches_of_one_colour_become_one() {
        let patch = "<rect x=\"1\" y=\"2\" width=\"3\" height=\"4\" fill=\"#AABBCC\" stroke=\"none\"/>\n";
        assert_eq!(compact(&patch.repeat(2)), "<path fill=\"#AABBCC\" d=\"M1,2h3v4h-3zM1,2h3v4h-3z\"/>\n");
    }
}
