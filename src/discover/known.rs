//! What a search has fitted so far.

use super::hypothesis::{Addition, Basis, Hypothesis};
use crate::model::Model;
use rayon::prelude::*;

/// A hypothesis with one more addition, and what the look at that saw.
#[derive(Clone)]
pub(super) struct Entry {
    pub hypothesis: Hypothesis,
    /// As of [`Look`].
    pub visibility: f64,
    pub strongest: Vec<Model>,
}

impl Entry {
    /// Keeps the better of two fits: one to more points before one to fewer, and before an estimate, which it may have
    /// refuted.
    pub fn keep(&mut self, hypothesis: Hypothesis) {
        let points = |h: &Hypothesis| match h.basis() {
            Basis::AllPoints | Basis::Contained => usize::MAX,
            Basis::SomePoints(some) => some,
            Basis::Linear => 0,
        };
        let (own, new) = (points(&self.hypothesis), points(&hypothesis));
        if new > own || new == own && hypothesis.fits_better_than(&self.hypothesis) {
            self.hypothesis = hypothesis;
        }
    }

    /// Of a single addition that was fitted: that and the model.
    pub fn single(&self) -> Option<(Addition, Model)> {
        let [addition] = self.hypothesis.additions[..] else { return None };
        (self.hypothesis.basis() != Basis::Linear).then(|| (addition, self.hypothesis.fitted()))
    }
}

/// All hypotheses that were fitted, the best fit of each.
#[derive(Default)]
pub(super) struct Known {
    pub entries: Vec<Entry>,
    /// What every candidate was raced beside.
    pub parents: Vec<Vec<Addition>>,
    /// What pairs of laws were fitted beside, and with them.
    pub pairs: Vec<(Vec<Addition>, Vec<Vec<Addition>>)>,
}

impl Known {
    /// The same with every entry changed.
    pub fn map(mut self, change: impl Fn(Entry) -> Entry + Sync + Send) -> Self {
        self.entries = self.entries.into_par_iter().map(change).collect();
        self
    }

    /// Whether all candidates were raced beside these.
    pub fn raced(&self, additions: &[Addition]) -> bool {
        self.parents.iter().any(|known| known.len() == additions.len() && known.iter().all(|a| additions.contains(a)))
    }

    /// What was fitted to all points with these additions, in this order of them.
    pub fn with(&self, additions: &[Addition]) -> Vec<Hypothesis> {
        let same = |h: &&Hypothesis| {
            h.estimate.is_none()
                && h.additions.len() == additions.len()
                && additions.iter().all(|a| h.additions.contains(a))
        };
        let found = self.entries.iter().map(|e| &e.hypothesis).filter(same).cloned();
        found.map(|h| Hypothesis { additions: additions.to_vec(), ..h }).collect()
    }

    /// What was fitted to all points with one addition more than these, that last.
    pub fn beside(&self, additions: &[Addition]) -> Vec<Hypothesis> {
        let one_more = |h: &&Hypothesis| {
            h.estimate.is_none()
                && h.additions.len() == additions.len() + 1
                && additions.iter().all(|a| h.additions.contains(a))
        };
        let mut found: Vec<Hypothesis> = self.entries.iter().map(|e| &e.hypothesis).filter(one_more).cloned().collect();
        for hypothesis in &mut found {
            hypothesis.additions.sort_by_key(|a| !additions.contains(a));
        }
        found
    }

    /// What was not fitted to all points with one addition more than these.
    pub fn left_beside(&self, additions: &[Addition]) -> Vec<(Addition, Entry)> {
        let one_more = |e: &Entry| {
            let own = &e.hypothesis.additions;
            let is_left = matches!(e.hypothesis.basis(), Basis::Linear | Basis::SomePoints(_));
            let beside = is_left && own.len() == additions.len() + 1 && additions.iter().all(|a| own.contains(a));
            beside.then(|| own.iter().copied().find(|a| !additions.contains(a))).flatten()
        };
        self.entries.iter().filter_map(|e| Some((one_more(e)?, e.clone()))).collect()
    }

    /// Takes over a better fit of what is known.
    pub fn improve(&mut self, hypothesis: &Hypothesis) {
        if let Some(own) = self.entries.iter_mut().find(|e| e.hypothesis.same_additions(hypothesis)) {
            own.keep(hypothesis.clone());
        }
    }

    /// Takes over what was found.
    pub fn keep(&mut self, found: Vec<Entry>) {
        for entry in found {
            let Some(own) = self.entries.iter_mut().find(|e| e.hypothesis.same_additions(&entry.hypothesis)) else {
                self.entries.push(entry);
                continue;
            };
            if entry.visibility > own.visibility {
                (own.visibility, own.strongest) = (entry.visibility, entry.strongest);
            }
            own.keep(entry.hypothesis);
        }
    }
}
