//! Successive halving (Jamieson and Talwalkar 2016): all competitors with little work, the better share with twice the
//! points and twice the evaluations, until as many are left as are wanted.

use rayon::prelude::*;

/// Work of one round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Round {
    /// Points of the table.
    pub points: usize,
    /// Evaluations of one fit.
    pub evaluations: usize,
    /// Steady states that each may solve.
    pub states: u64,
}

/// Something that gets better with work.
pub trait Competitor: Send {
    /// What it is of: two of the same that have come to the same place are one.
    fn of(&self) -> usize;
    /// Works on.
    fn advance(&mut self, round: Round);
    /// Typical size of what it leaves, in units of the noise.
    fn typical(&self) -> f64;
    /// How bad it is, if residuals many times larger than `typical` are outliers; the same units for all after a round.
    fn badness(&self, typical: f64) -> f64;
    /// Whether what it was worked on decides against it already, seen how far the first of all has come.
    fn is_beaten(&self, first: &Self) -> bool;
}

/// A round is worked on in so many turns, between which is seen what is left.
const TURNS: usize = 4;

/// The rules of a race.
#[derive(Debug, Clone, Copy)]
pub struct Race {
    /// Work of the first round.
    pub first: Round,
    /// Points that there are.
    pub points: usize,
    /// Share that goes on.
    pub kept: f64,
    /// Competitors at the end.
    pub survivors: usize,
}

/// How a race ended: each group best first.
pub struct Result<C> {
    /// Those that came to the end.
    pub survivors: Vec<C>,
    /// Those that did not, the last to leave first.
    pub dropped: Vec<C>,
}

impl Race {
    /// Runs the race; before each round `share` is asked how many steady states each of so many may solve.
    pub fn run<C: Competitor>(&self, mut field: Vec<C>, share: impl Fn(usize) -> u64) -> Result<C> {
        let mut round = self.first;
        let mut dropped = Vec::new();
        loop {
            // Half of what is left is for those that go on.
            round.states = share(2 * field.len());
            if round.states == 0 {
                break;
            }
            dropped.splice(0..0, Self::advance(&mut field, round, &share));
            // What is left after the last halving on all points goes to its end elsewhere.
            if round.points >= self.points && self.share(field.len()) <= self.survivors {
                break;
            }
            self.rank(&mut field);
            let mut out = Self::out(&field).into_iter();
            let (gone, mut left): (Vec<C>, Vec<C>) = field.into_iter().partition(|_| out.next().unwrap_or(false));
            dropped.splice(0..0, gone);
            let wanted = self.share(left.len()).max(self.survivors).min(left.len());
            dropped.splice(0..0, left.split_off(wanted));
            field = left;
            // All points where the round after would leave fewer out than it has.
            let points = if 4 * round.points > self.points { self.points } else { 2 * round.points };
            round = Round { points, evaluations: 2 * round.evaluations, ..round };
        }
        self.rank(&mut field);
        dropped.splice(0..0, field.split_off(self.survivors.min(field.len())));
        Result { survivors: field, dropped }
    }

    /// Lets a field work on in turns, the most promising first, until half of what there was is spent; those whose turn
    /// does not come are returned.
    fn advance<C: Competitor>(field: &mut Vec<C>, round: Round, share: impl Fn(usize) -> u64) -> Vec<C> {
        let ranked = Self::ranked(field);
        field.extend(ranked.into_iter().map(|(_, competitor)| competitor));
        let (size, before) = (field.len().div_ceil(TURNS).max(1), share(1));
        for first in (0..field.len()).step_by(size) {
            if share(1) < before / 2 {
                return field.split_off(first);
            }
            let turn = first..(first + size).min(field.len());
            field[turn].par_iter_mut().for_each(|competitor| competitor.advance(round));
        }
        Vec::new()
    }

    /// How many of a field go on.
    fn share(&self, count: usize) -> usize {
        (count as f64 * self.kept) as usize
    }

    /// Who of a ranked field needs no more work: what is beaten, and the worse half of those that are of the same.
    fn out<C: Competitor>(field: &[C]) -> Vec<bool> {
        let same = |of: usize, part: &[C]| part.iter().filter(|other| other.of() == of).count();
        let worse_half = |at: usize, of: usize| 2 * same(of, &field[..at]) >= same(of, field);
        let first = field.first();
        let out = |(at, c): (usize, &C)| worse_half(at, c.of()) || first.is_some_and(|first| c.is_beaten(first));
        field.iter().enumerate().map(out).collect()
    }

    /// The competitors with their badness, the best first.
    fn ranked<C: Competitor>(field: &mut Vec<C>) -> Vec<(f64, C)> {
        let typical = field.iter().map(Competitor::typical).fold(f64::INFINITY, f64::min).max(1.0);
        let mut ranked: Vec<(f64, C)> = field.drain(..).map(|c| (c.badness(typical), c)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked
    }

    /// Sorts the competitors, the best first, and leaves one of those that have come to the same place: the criterion
    /// of the same candidate twice, closer than one unit.
    fn rank<C: Competitor>(&self, field: &mut Vec<C>) {
        let ranked = Self::ranked(field);
        let mut seen: Vec<(usize, f64)> = Vec::new();
        for (badness, competitor) in ranked {
            let again = seen.iter().any(|(of, other)| *of == competitor.of() && (badness - other).abs() < 1.0);
            if !again {
                seen.push((competitor.of(), badness));
                field.push(competitor);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    /// Comes from where it starts to its end as fast as work is spent on it.
    struct Fake<'a> {
        of: usize,
        end: f64,
        start: f64,
        spent: usize,
        hopeless: bool,
        total: &'a AtomicUsize,
    }

    impl Competitor for Fake<'_> {
        fn of(&self) -> usize {
            self.of
        }
        fn advance(&mut self, round: Round) {
            self.spent += round.evaluations;
            self.total.fetch_add(round.evaluations * round.points, Relaxed);
        }
        fn typical(&self) -> f64 {
            1.0
        }
        fn is_beaten(&self, first: &Self) -> bool {
            self.hopeless && self.badness(1.0) > first.badness(1.0)
        }
        fn badness(&self, _: f64) -> f64 {
            self.end + (self.start - self.end) * (-(self.spent as f64) / 8.0).exp()
        }
    }

    const RULES: Race =
        Race { first: Round { points: 64, evaluations: 4, states: 0 }, points: 312, kept: 0.25, survivors: 3 };

    fn field(total: &AtomicUsize) -> Vec<Fake<'_>> {
        let of = |i: usize| Fake {
            of: i,
            end: 100.0 + 10.0 * i as f64,
            start: 5000.0 - i as f64,
            spent: 0,
            hopeless: false,
            total,
        };
        (0..200).map(of).collect()
    }

    #[test]
    fn who_ends_best_wins() {
        let total = AtomicUsize::new(0);
        let mut all = field(&total);
        all[7].end = 1.0;
        all[7].start = 4000.0;
        let ended = RULES.run(all, |_| u64::MAX);
        assert_eq!(ended.survivors.len(), 3);
        assert_eq!(ended.survivors[0].of, 7);
        assert_eq!(ended.survivors.len() + ended.dropped.len(), 200);
    }

    #[test]
    fn rounds_cost_about_the_same_and_far_less_than_working_on_all() {
        let total = AtomicUsize::new(0);
        RULES.run(field(&total), |_| u64::MAX);
        let first = 200 * 64 * 4;
        assert!(total.load(Relaxed) < 4 * first, "{}", total.load(Relaxed));
    }

    #[test]
    fn half_of_the_same_and_what_is_beaten_leave_after_a_round() {
        let total = AtomicUsize::new(0);
        let mut all: Vec<Fake<'_>> = field(&total).into_iter().take(8).collect();
        (all[0].of, all[1].of, all[2].of, all[3].of) = (50, 50, 50, 50);
        all[5].hopeless = true;
        let rules = Race { survivors: 8, kept: 1.0, ..RULES };
        let ended = rules.run(all, |_| u64::MAX);
        let of = |group: &[Fake<'_>]| group.iter().map(|c| c.of).collect::<Vec<_>>();
        assert_eq!(of(&ended.survivors), [50, 4, 6, 7]);
        assert_eq!(ended.dropped.iter().filter(|c| c.of == 50).count(), 3);
        assert_eq!(ended.dropped.iter().filter(|c| c.of == 5).count(), 1);
    }

    #[test]
    fn competitors_that_come_to_the_same_place_are_one() {
        let total = AtomicUsize::new(0);
        let of = |i: usize| Fake {
            of: usize::from(i == 3),
            end: 5.0,
            start: 6.0 + i as f64,
            spent: 0,
            hopeless: false,
            total: &total,
        };
        let ended = RULES.run((0..8).map(of).collect(), |_| u64::MAX);
        assert_eq!(ended.survivors.iter().map(|c| c.of).collect::<Vec<_>>(), [0, 1]);
    }

    #[test]
    fn without_a_budget_nothing_is_worked_on_and_the_order_is_that_of_the_start() {
        let total = AtomicUsize::new(0);
        let ended = RULES.run(field(&total), |_| 0);
        assert_eq!(total.load(Relaxed), 0);
        assert_eq!(ended.survivors[0].of, 199);
    }

    /// Tells of every round how much it may work, and takes all of that.
    struct Sharing<'a>(usize, &'a std::sync::Mutex<Vec<Round>>);

    impl Competitor for Sharing<'_> {
        fn of(&self) -> usize {
            self.0
        }
        fn advance(&mut self, round: Round) {
            self.1.lock().expect("no panic").push(round);
        }
        fn typical(&self) -> f64 {
            1.0
        }
        fn is_beaten(&self, _: &Self) -> bool {
            false
        }
        fn badness(&self, _: f64) -> f64 {
            10.0 * self.0 as f64
        }
    }

    #[test]
    fn who_takes_all_that_a_round_gives_leaves_enough_for_the_rounds_after() {
        let told: std::sync::Mutex<Vec<Round>> = std::sync::Mutex::default();
        let left = || 100_000 - told.lock().expect("no panic").iter().map(|round| round.states).sum::<u64>();
        RULES.run((0..80).map(|of| Sharing(of, &told)).collect(), |among| left() / among as u64);
        assert!(left() > 10_000, "{}", left());
        assert!(told.into_inner().expect("no panic").iter().any(|round| round.points == RULES.points));
    }

    /// One evaluation of a slow model takes more than its share.
    #[test]
    fn where_a_round_would_take_more_than_half_of_what_is_left_the_most_promising_have_their_turn() {
        let told: std::sync::Mutex<Vec<Round>> = std::sync::Mutex::default();
        let spent = || 3000 * told.lock().expect("no panic").len() as u64;
        let share = |among: usize| 100_000_u64.saturating_sub(spent()) / among.max(4) as u64;
        let ended = RULES.run((0..80).rev().map(|of| Sharing(of, &told)).collect(), share);
        // Twenty of eighty at first, of which five go on, and three of them to all points.
        assert_eq!(spent(), 3000 * (20 + 5 + 3));
        assert_eq!(ended.survivors.iter().map(|one| one.0).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(ended.dropped.len(), 77);
    }

    #[test]
    fn all_of_a_round_share_what_is_left() {
        let told = std::sync::Mutex::default();
        RULES.run((0..40).map(|of| Sharing(of, &told)).collect(), |among| 4000 / among as u64);
        let told: Vec<u64> = told.into_inner().expect("no panic").iter().map(|round: &Round| round.states).collect();
        assert_eq!((told[0], told.iter().filter(|states| **states == 50).count()), (50, 40));
        let rounds: std::collections::BTreeSet<u64> = told.iter().copied().collect();
        let share = |states: u64| told.iter().filter(|t| **t == states).count() as u64 * states;
        assert!(rounds.len() > 1 && rounds.iter().all(|&states| share(states) <= 4000));
    }
}
