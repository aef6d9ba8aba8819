//! Which competitors go on in a race of a search.

use super::hypothesis::Hypothesis;

/// What cannot come below this hypothesis, squares in this unit, is of no use.
pub(super) type Aim<'h> = Option<(&'h Hypothesis, f64)>;

/// Who goes on in a race.
#[derive(Clone, Copy)]
pub(super) enum Field<'h> {
    /// The best of all, from starting points of this part of the sequence.
    Best(usize, Aim<'h>),
    /// Every candidate by itself.
    Each(Aim<'h>),
}
