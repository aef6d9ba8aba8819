//! Conditions in columns by the speed of the roller, or side by side where there is no contact.

use super::words;
use crate::compare::{Comparison, ContactPoint};
use crate::figures::marks::{MARKS, Mark};
use crate::figures::style::{Color, ROLLER, SLIP, STATIC, Unit, ramp, significant};

/// Columns at most.
const COLUMNS: usize = 4;
/// Curves in one column where there is no contact.
const TOGETHER: usize = 8;
/// Colours of up to four curves (a purple besides those of the limiting cases).
const PALETTE: [Color; 4] = [STATIC, SLIP, ROLLER, Color(0x8a, 0x4f, 0x9e)];

/// The contact under one condition.
pub struct Curve<'a> {
    /// What distinguishes it in its column.
    pub label: String,
    /// Colour.
    pub color: Color,
    /// Mark.
    pub mark: Mark,
    /// From the readings.
    pub measured: Vec<&'a ContactPoint>,
    /// Of the model, at the same points.
    pub model: Vec<&'a ContactPoint>,
}

/// Conditions of neighbouring speeds.
pub struct Column<'a> {
    /// The speeds.
    pub heading: String,
    /// The speeds \[m/s\], ascending; none where there is no contact.
    pub speeds: Vec<f64>,
    /// One curve per condition.
    pub curves: Vec<Curve<'a>>,
}

/// The conditions shown, in columns.
pub fn columns(c: &Comparison) -> Vec<Column<'_>> {
    let with_points = |i: &usize| c.contact.iter().any(|p| p.condition == *i);
    if !c.model.has_contact {
        return by_drive(c, words::shown(c).0.into_iter().filter(with_points).collect());
    }
    let mut shown: Vec<usize> = words::shown(c).0.into_iter().filter(with_points).collect();
    let speed = |i: &usize| c.conditions[*i].setting.speed;
    shown.sort_by(|a, b| speed(a).total_cmp(&speed(b)));
    let mut speeds: Vec<f64> = shown.iter().map(speed).collect();
    speeds.dedup();
    grouped(&speeds)
        .into_iter()
        .map(|group| {
            let members: Vec<usize> = shown.iter().copied().filter(|i| group.contains(&speed(i))).collect();
            let label = |condition| label(c, condition, group.len() > 1);
            Column { heading: heading(group), speeds: group.to_vec(), curves: curves(c, &members, label) }
        })
        .collect()
}

/// The curves of some conditions.
fn curves<'a>(c: &'a Comparison, members: &[usize], label: impl Fn(usize) -> String) -> Vec<Curve<'a>> {
    let curve = |(rank, &condition): (usize, &usize)| Curve {
        label: label(condition),
        color: if members.len() <= PALETTE.len() { PALETTE[rank] } else { ramp(rank, members.len()) },
        mark: MARKS[rank % MARKS.len()],
        measured: c.contact.iter().filter(|p| p.condition == condition).collect(),
        model: c.contact_model.iter().filter(|p| p.condition == condition).collect(),
    };
    members.iter().enumerate().map(curve).collect()
}

/// Conditions without contact by their drives, together as far as that can be read.
fn by_drive(c: &Comparison, mut shown: Vec<usize>) -> Vec<Column<'_>> {
    let drive = |i: &usize| c.conditions[*i].setting.drive;
    shown.sort_by(|a, b| drive(a).total_cmp(&drive(b)));
    let symbol = c.table.signals.drive.symbol;
    let column = |members: &[usize]| {
        let ends = [members[0], members[members.len() - 1]].map(|i| words::drive(&c.conditions[i].setting));
        let heading = match ends {
            [low, high] if low == high => format!("{symbol} = {low}"),
            [low, high] => format!("{symbol} = {low} to {high}"),
        };
        Column { heading, speeds: Vec::new(), curves: curves(c, members, |i| words::brief(c, i)) }
    };
    let size = shown.len().div_ceil(shown.len().div_ceil(TOGETHER).max(1)).max(1);
    shown.chunks(size).map(column).collect()
}

/// Rest apart, the other speeds in groups of about equal size.
fn grouped(speeds: &[f64]) -> Vec<&[f64]> {
    let rest = usize::from(speeds.first() == Some(&0.0) && speeds.len() > 1);
    let (at_rest, moving) = speeds.split_at(rest);
    let size = moving.len().div_ceil(COLUMNS - rest).max(1);
    let mut groups: Vec<&[f64]> = if rest > 0 { vec![at_rest] } else { Vec::new() };
    groups.extend(moving.chunks(size));
    groups
}

fn heading(speeds: &[f64]) -> String {
    let value = |speed: f64| significant(Unit::speed().of(speed), 3);
    match speeds {
        [0.0] => "V = 0 (rest)".into(),
        [one] => format!("V = {} mm/s", value(*one)),
        [one, two] => format!("V = {}, {} mm/s", value(*one), value(*two)),
        [first, .., last] => format!("V = {} to {} mm/s", value(*first), value(*last)),
        [] => String::new(),
    }
}

fn label(c: &Comparison, condition: usize, with_speed: bool) -> String {
    let setting = &c.conditions[condition].setting;
    if with_speed {
        words::brief(c, condition)
    } else {
        format!("{} N, {}", significant(setting.load, 3), words::drive(setting))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_stands_apart_and_the_others_fill_what_is_left() {
        assert_eq!(grouped(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [&[0.0][..], &[1.0, 2.0], &[3.0, 4.0], &[5.0, 6.0]]);
        assert_eq!(grouped(&[0.0]), [&[0.0][..]]);
        assert_eq!(grouped(&[1.0, 2.0]), [&[1.0][..], &[2.0]]);
        assert_eq!(grouped(&[1.0; 9]).len(), 3);
        assert_eq!(heading(&[5e-5, 1e-4]), "V = 0.05, 0.1 mm/s");
    }
}
