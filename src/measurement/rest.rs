//! Columns to which no header gave a use, and what their units, letters and numbers say of them.

use super::frame::{Frame, READINGS};
use super::header;
use super::likely::{in_hertz, is_deviation, is_other, is_setting};
use super::names::AMPLITUDE;
use super::sheet::{Sheet, Tally};
use super::swings::{Swing, is_peak_to_peak};
use super::unit::{Unit, Wanted};

/// A column that may serve.
#[derive(Clone)]
pub(super) struct Candidate {
    /// Where it stands in the table.
    pub index: usize,
    /// The unit of its numbers.
    pub unit: Unit,
    /// Whether the table states that unit.
    pub stated: bool,
}

/// A column whose unit a reading may have.
struct Possible {
    index: usize,
    name: String,
    unit: Unit,
}

/// The letter of an amplitude, whatever word stands behind it: `A_Skt`.
fn is_a(name: &str) -> bool {
    name.split('_').next() == Some("a")
}

/// The letter of a voltage, with a letter or digit behind it: `U`, `UC`, `U0`.
fn is_voltage(name: &str) -> bool {
    name.starts_with(['u', 'v']) && name.replace('_', "").chars().count() <= 2
}

/// What has no use yet.
pub(super) struct Rest<'a> {
    pub sheet: &'a Sheet,
    pub frame: &'a Frame<'a>,
    /// Which columns have a use, or were complained about.
    pub taken: &'a [bool],
    /// What the numbers of every column of the table are like.
    pub tallies: &'a [Tally],
}

impl Rest<'_> {
    fn unused(&self) -> impl Iterator<Item = usize> {
        (0..self.taken.len()).filter(|index| !self.taken[*index])
    }

    /// Whether a name is that of another column's deviation.
    fn deviates(&self, name: &str) -> bool {
        self.sheet.names().any(|of| is_deviation(name, &of))
    }

    /// The one frequency by its unit; or by an `F` that states no unit beside a phase, as what has a phase is no force.
    pub fn hertz(&self, phased: bool) -> Option<Candidate> {
        let in_hertz = |index: usize| {
            let header = self.sheet.headed(index);
            let (name, bracket) = header::split(&header);
            Some(Candidate { index, unit: in_hertz(&header::plain(name), bracket)?, stated: true })
        };
        let mut found: Vec<Candidate> = self.unused().filter_map(in_hertz).collect();
        if found.is_empty() && phased {
            let bare = self.unused().filter(|index| self.sheet.headed(*index).trim() == "F");
            found = bare.map(|index| Candidate { index, unit: Unit::of("Hz"), stated: false }).collect();
        }
        let [one] = found.try_into().ok()?;
        Some(one)
    }

    /// Those that are not zero throughout and have a unit that a reading may have.
    fn possible(&self) -> impl Iterator<Item = Possible> {
        let wanted = Wanted { possible: READINGS, natural: None, share: false, per_drive: false };
        self.unused().filter(|index| !self.tallies[*index].is_zero()).filter_map(move |index| {
            let header = self.sheet.headed(index);
            let (name, bracket) = header::split(&header);
            let unit = match bracket {
                Some(text) => wanted.unit(text).ok()?,
                // The end of a name is a word more often than a unit.
                None => wanted.unit(name.rsplit_once('_')?.1).ok().filter(Unit::is_voltage)?,
            };
            Some(Possible { index, name: header::plain(name), unit })
        })
    }

    /// Those whose unit serves as the reading's, deviations and statistics apart; an angle only beside a phase, unless
    /// nothing else is there to be read. A whole swing counts where there is nothing else, or where it alone has a stated
    /// deviation, as what was measured for its own sake has.
    pub fn readings(&self, phased: bool) -> Vec<Candidate> {
        let whole = |index: usize| is_peak_to_peak(&self.sheet.header.cells[index]);
        let plain = |index: usize| header::plain(header::split(&self.sheet.headed(index)).0);
        let phased = phased || self.unused().filter(|index| !self.deviates(&plain(*index))).count() == 1;
        let serves = |one: &Possible| {
            let known = phased || one.unit.si != "rad";
            known && self.frame.serving(AMPLITUDE).contains(&one.unit.si) && !self.deviates(&one.name)
        };
        let all: Vec<Possible> = self.possible().filter(serves).collect();
        // A current that is held from row to row while something else is not is set.
        let is_held = |one: &Possible| self.sheet.change(one.index) == 0.0;
        let moves = !all.iter().all(is_held);
        let is_set = |one: &Possible| moves && one.unit.is_current() && is_held(one);
        let (swings, others): (Vec<_>, Vec<_>) =
            all.into_iter().filter(|one| !is_set(one)).partition(|one| whole(one.index));
        let others: Vec<Possible> = others.into_iter().filter(|one| !is_other(&one.name)).collect();
        let is_stated = |one: &Possible| self.sheet.names().any(|own| is_deviation(&own, &one.name));
        let only_swings = others.len() > 1 && swings.iter().any(is_stated) && !others.iter().any(is_stated);
        let found = if others.is_empty() || only_swings { swings } else { others };
        let candidate = |Possible { index, unit, .. }| {
            let unit = if whole(index) { unit.swinging(Swing::Whole) } else { unit };
            Candidate { index, unit, stated: true }
        };
        found.into_iter().map(candidate).collect()
    }

    /// The one column of no statistics whose unit fits.
    pub fn only(&self, fits: impl Fn(&Unit) -> bool) -> Option<Candidate> {
        let is_plain = |name: &str| !is_other(name) && !is_setting(name) && !self.deviates(name);
        let mut all = self.possible().filter(|one| fits(&one.unit) && is_plain(&one.name));
        let Possible { index, unit, .. } = all.next()?;
        all.next().is_none().then_some(Candidate { index, unit, stated: true })
    }

    /// The first column without a unit that has such a name.
    pub fn bare(&self, is_named: impl Fn(&str) -> bool) -> Option<usize> {
        self.unused().find(|index| {
            let header = self.sheet.headed(*index);
            let (name, unit) = header::split(&header);
            unit.is_none() && is_named(name)
        })
    }

    /// The column whose name is the letter of an amplitude; a small one, which may be a distance on the screen of an
    /// oscilloscope, not beside voltages.
    pub fn letter(&self) -> Option<usize> {
        let capital = self.bare(|name| name.starts_with('A') && is_a(&header::plain(name)));
        let voltage = || self.bare(|name| is_voltage(&header::plain(name)));
        capital
            .or_else(|| self.bare(|name| is_a(&header::plain(name))))
            .filter(|_| capital.is_some() || voltage().is_none())
    }
}
