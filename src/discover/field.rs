//! Which competitors go on in a race of a search.

use super::hypothesis::Hypothesis;

/// Who goes on in a race.
#[derive(Clone, Copy)]
pub(super) enum Field<'h> {
    /// The best of all, from starting points of this part of the sequence.
    Best(usize),
    /// Every candidate by itself, unless it cannot come below this hypothesis, squares in this unit.
    Each(Option<(&'h Hypothesis, f64)>),
}
