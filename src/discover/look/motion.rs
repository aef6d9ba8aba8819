//! Laws of the body's motion where it was measured, one or two at once: where neither of two does any good alone, and
//! beside any fold.
//!
//! Every reading asks for a dynamic stiffness, drive over motion. At the motion that was measured that is linear in the
//! strengths of all laws of force, and in stiffness and damping of the rig: what one or two of many laws leave is a
//! least-squares problem of as many numbers.

use super::{Count, Parent, SINGULAR, Start};
use crate::discover::data::Data;
use crate::discover::hypothesis::{Addition, Hypothesis, compatible};
use crate::effects::Effect;
use crate::fit::{Parameter, TAIL, model_with, operation, parameter, robust_chi2, typical_of, values_in};
use crate::linear::svd;
use crate::measurement::Point;
use crate::model::Model;
use crate::model::alone::Alone;
use crate::parameter::Scales;
use crate::solver::describing::describing;
use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Step of a difference on the natural scale of a parameter in which the dynamic stiffness is all but linear.
const STEP: f64 = 1e-4;

/// Two effects which together give the readings about the dynamic stiffness that these ask for.
pub struct Pair {
    /// The effects.
    pub additions: [Addition; 2],
    /// The model with both, and with its own numbers as they are beside them.
    pub model: Model,
}

/// Halvings of the step, at first a quarter of a range, with which the best place of a pair is looked for.
const HALVINGS: i32 = 6;
/// How often the rig's own numbers are linear about where the last round took them, at most.
const ROUNDS: usize = 4;
/// An effect at the motion that was measured takes this part of a steady state.
const PART: usize = 16;

/// An effect at one place of its ranges.
#[derive(Clone)]
struct Law {
    effect: &'static dyn Effect,
    model: Model,
    /// What it changes of what is left, ...
    change: DVector<f64>,
    /// ... and how much of that the numbers of the model cannot do.
    own: DVector<f64>,
}

impl Law {
    /// Whether it may be so many times as strong.
    fn allows(&self, strength: f64) -> bool {
        strength.is_finite() && (strength > 0.0 || self.effect.parameters().first().is_some_and(|info| info.signed))
    }

    fn values(&self) -> &[f64] {
        self.model.effects.last().map_or(&[], |(_, values)| values)
    }

    /// Whether a parameter is in proportion to the strength of the force.
    fn is_strength(&self, number: usize) -> bool {
        is_strength(self.effect, number, &self.model.scales)
    }
}

/// Laws, one or two, that together lessen the sum of squares by so much with these strengths.
struct Together<'l> {
    gain: f64,
    laws: Vec<Cow<'l, Law>>,
    strengths: Vec<f64>,
}

impl Parent<'_> {
    /// The model with an addition about as the readings ask for it, and with its own numbers as they are beside that;
    /// `None` of what is no law of force, and of a model with a contact, whose forces are no law of one motion.
    pub fn with_law(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        addition: Addition,
        which: (usize, u32),
    ) -> Option<Model> {
        if let Some(model) = self.of_each_series(data, from, addition) {
            return Some(model);
        }
        let numbers = Numbers::of(self, self.model.clone(), &from.fit.parameters, None);
        let laws = self.laws(data, from, addition, &numbers, which);
        let spent = AtomicUsize::new(laws.len());
        let best = laws.iter().filter_map(|law| numbers.together(vec![Cow::Borrowed(law)])).max_by(Together::order)?;
        let found = self.polished(&from.fit.parameters, numbers.found(best, &spent), 1, &spent);
        self.count(data, spent);
        Some(found.model)
    }

    /// The model with numbers of each series as the readings ask for them, beside its own; `None` of any other effect.
    fn of_each_series(&self, data: &Data<'_>, from: &Hypothesis, addition: Addition) -> Option<Model> {
        let Addition::Effect(effect) = addition else { return None };
        if effect.of_series().is_none() || self.model.has_contact {
            return None;
        }
        let mut model = self.model.clone();
        model.effects.push((effect, vec![0.0; effect.parameters().len()]));
        let parameters = data.beside(&model, from, addition);
        let numbers = Numbers::of(self, model, &parameters, None);
        let spent = AtomicUsize::new(parameters.len());
        let none = Together { gain: 0.0, laws: Vec::new(), strengths: Vec::new() };
        let found = self.polished(&parameters, numbers.found(none, &spent), 0, &spent);
        self.count(data, spent);
        Some(found.model)
    }

    /// The most promising pairs of effects, so many at most, the best first, each once.
    pub fn pairs(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        pool: &[Addition],
        (most, which): (usize, (usize, u32)),
    ) -> Vec<Pair> {
        let numbers = Numbers::of(self, self.model.clone(), &from.fit.parameters, None);
        let laws = pool.par_iter().map(|addition| self.laws(data, from, *addition, &numbers, which));
        let laws: Vec<Vec<Law>> = laws.filter(|of| !of.is_empty()).collect();
        let fits = |a: &[Law], b: &[Law]| compatible(&self.model, &[a, b].map(|of| Addition::Effect(of[0].effect)));
        let work: Vec<[&[Law]; 2]> = (0..laws.len())
            .flat_map(|i| (i + 1..laws.len()).map(move |j| [i, j]))
            .map(|of| of.map(|i| &laws[i][..]))
            .filter(|[a, b]| fits(a, b))
            .collect();
        let spent = AtomicUsize::new(laws.iter().map(Vec::len).sum());
        let looked = |[a, b]: [&[Law]; 2]| numbers.best(a, b).map(|best| numbers.found(best, &spent));
        let mut found: Vec<Found> = work.into_par_iter().filter_map(looked).collect();
        // Those that may be of use once readings that are far off have lost their pull.
        ranked(&mut found);
        found.truncate(2 * most);
        found = found.into_par_iter().map(|one| self.polished(&from.fit.parameters, one, 2, &spent)).collect();
        self.count(data, spent);
        ranked(&mut found);
        found.truncate(most);
        let first = self.model.effects.len();
        let additions = |model: &Model| [0, 1].map(|i| Addition::Effect(model.effects[first + i].0));
        found.into_iter().map(|found| Pair { additions: additions(&found.model), model: found.model }).collect()
    }

    /// So many laws about what was found, in rounds: the rig's own numbers may have been calibrated far from where they are
    /// beside the laws, where they are no longer linear, and readings that are far off what the laws leave lose their
    /// pull.
    fn polished(&self, parameters: &[Parameter], mut found: Found, laws: usize, spent: &AtomicUsize) -> Found {
        for _ in 0..ROUNDS {
            let mut base = found.model.clone();
            let laws = base.effects.split_off(base.effects.len() - laws);
            let numbers = Numbers::of(self, base.clone(), parameters, Some(&found));
            let law = |law: (&'static dyn Effect, Vec<f64>)| {
                let model = Model { effects: base.effects.iter().cloned().chain([law]).collect(), ..base.clone() };
                numbers.law(model).map(Cow::Owned)
            };
            let laws: Option<Vec<Cow<'_, Law>>> = laws.into_iter().map(law).collect();
            let Some(best) = laws.and_then(|laws| numbers.together(laws)) else { break };
            let next = numbers.found(best, spent);
            let typical = found.typical.min(next.typical);
            if next.left(typical) >= found.left(typical) {
                break;
            }
            found = next;
        }
        found
    }

    fn count(&self, data: &Data<'_>, laws: AtomicUsize) {
        data.count((laws.into_inner() * self.problem.points().len() / PART) as u64);
    }

    /// A starting point of the second effect of a pair beside the first.
    pub fn start_of(&self, data: &Data<'_>, first: &Hypothesis, pair: &Pair) -> Start {
        let values = values_in(&pair.model, &data.beside(&pair.model, first, pair.additions[1]));
        Start { model: pair.model.clone(), values, residuals: self.evaluated(data, &pair.model).residuals }
    }

    /// An addition at places of its ranges, if it is a law of force that is not there.
    fn laws(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        addition: Addition,
        numbers: &Numbers<'_>,
        (starts, seed): (usize, u32),
    ) -> Vec<Law> {
        let Addition::Effect(effect) = addition else { return Vec::new() };
        let present = self.model.effects.iter().any(|(own, _)| own.name() == effect.name());
        let other = self.model.has_contact || effect.formula().is_some() || effect.of_series().is_some();
        let mut own = 0..effect.parameters().len();
        let is_force = effect.torque_is_odd() && own.any(|number| is_strength(effect, number, &self.model.scales));
        if present || other || !is_force {
            return Vec::new();
        }
        let samples =
            Count { known: None, asked: None, starts, shared: 1, turn: 0, seed }.samples(from, addition).into_iter();
        let place = |model: Model| {
            let mut with = numbers.model.clone();
            with.effects.extend(model.effects.last().cloned());
            numbers.law(with)
        };
        samples.filter_map(|sample| place(sample.of(data, self, addition))).collect()
    }
}

/// A model with laws, and what it leaves of the readings at the motion that was measured, of this typical size.
struct Found {
    model: Model,
    rows: DVector<f64>,
    typical: f64,
}

impl Found {
    /// Sum of squares, where residuals many times larger than `typical` are outliers.
    fn left(&self, typical: f64) -> f64 {
        robust_chi2(&self.rows, TAIL * typical)
    }
}

/// Sorts what was found, what leaves least first.
fn ranked(all: &mut [Found]) {
    let typical = all.iter().map(|one| one.typical).fold(f64::INFINITY, f64::min);
    all.sort_by(|a, b| a.left(typical).total_cmp(&b.left(typical)));
}

impl Together<'_> {
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.gain.total_cmp(&other.gain)
    }
}

/// Whether a parameter is in proportion to the strength of a force.
fn is_strength(effect: &dyn Effect, number: usize, scales: &Scales) -> bool {
    let measure = effect.parameters()[number].measure;
    measure.size(&Scales { stiffness: 2.0 * scales.stiffness, ..*scales }) == 2.0 * measure.size(scales)
}

/// What readings ask for beside what a model gives, and what its own numbers can do about that.
struct Numbers<'p> {
    parent: &'p Parent<'p>,
    model: Model,
    parameters: &'p [Parameter],
    /// Of amplitude and phase of every reading: one over the size of what the model gives, less where it is far off.
    weights: Vec<[f64; 2]>,
    left: DVector<f64>,
    /// Derivatives by the natural scale of each number, and their pseudo-inverse.
    columns: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl<'p> Numbers<'p> {
    /// About a model; readings weigh as they do beside what was found with it.
    fn of(parent: &'p Parent<'p>, model: Model, parameters: &'p [Parameter], found: Option<&Found>) -> Self {
        let [columns, inverse] = [(); 2].map(|()| DMatrix::zeros(0, 0));
        let (left, weights) = (DVector::zeros(0), Vec::new());
        let mut numbers = Self { parent, model, parameters, weights, left, columns, inverse };
        let given = numbers.given(found.map_or(&numbers.model, |found| &found.model));
        let mut weights: Vec<[f64; 2]> = given.iter().map(|given| [given.norm().recip(); 2]).collect();
        if let Some(Found { rows, typical, .. }) = found {
            let pull = |row: f64| (TAIL * typical / row.abs()).min(1.0);
            let mut rows = rows.iter();
            for (weights, point) in weights.iter_mut().zip(parent.problem.points()) {
                let own = if point.phase_sd.is_some() { 2 } else { 1 };
                weights.iter_mut().take(own).zip(&mut rows).for_each(|(weight, row)| *weight *= pull(*row));
            }
        }
        numbers.weights = weights;
        numbers.left = numbers.left_by(&numbers.model);
        let by = |number: usize| {
            let mut steps = vec![0.0; parameters.len()];
            steps[number] = STEP;
            (numbers.left_by(&numbers.moved(&numbers.model, &steps)) - &numbers.left) / STEP
        };
        let columns: Vec<DVector<f64>> = (0..parameters.len()).map(by).collect();
        if !columns.is_empty() {
            numbers.columns = DMatrix::from_columns(&columns);
            let parts = svd(numbers.columns.clone());
            let inverse = parts.and_then(|parts| {
                let least = SINGULAR * parts.singular_values.max();
                parts.pseudo_inverse(least).ok()
            });
            numbers.inverse = inverse.unwrap_or_default();
        }
        numbers
    }

    /// The dynamic stiffness of a model at every motion that was measured, over the one that the reading asks for. A
    /// phase that was not measured is the one that the model gives it.
    fn given(&self, model: &Model) -> Vec<Complex<f64>> {
        let of = |point: &&Point| {
            let mode = Alone::new(model, &operation(point));
            let lumps = &mode.lumps;
            let motion = lumps.motion((point.amplitude, point.phase.unwrap_or(0.0)));
            let (k, c) = describing(&mode, motion.norm());
            let stiffness = lumps.stiffness.value + k - lumps.inertia.value * lumps.omega.powi(2);
            let given = Complex::new(stiffness, lumps.damping.value * lumps.omega + c);
            let given = given * motion / Complex::new(lumps.torque_re.value, lumps.torque_im.value);
            if point.phase.is_some() { given } else { given.norm().into() }
        };
        self.parent.problem.points().iter().map(of).collect()
    }

    /// The same less one, in standard deviations of the amplitude (real part) and of the phase, each times its weight.
    fn rows(&self, given: &[Complex<f64>], weight: impl Fn(usize) -> [f64; 2]) -> DVector<f64> {
        let of = |(at, (point, given)): (usize, (&&Point, &Complex<f64>))| {
            let [of_amplitude, of_phase] = weight(at);
            let beside = if given.is_finite() { given - 1.0 } else { Complex::ZERO };
            let amplitude = of_amplitude * beside.re * point.amplitude / point.amplitude_sd;
            std::iter::once(amplitude).chain(point.phase_sd.map(|sd| of_phase * beside.im / sd))
        };
        DVector::from_vec(self.parent.problem.points().iter().zip(given).enumerate().flat_map(of).collect())
    }

    /// What a model leaves, about as it leaves it of the readings: the error of a motion is that of the stiffness over
    /// the stiffness (Sanathanan and Koerner 1963).
    fn left_by(&self, model: &Model) -> DVector<f64> {
        self.rows(&self.given(model), |at| self.weights[at])
    }

    /// The model of laws, at the best place near theirs.
    fn found(&self, best: Together<'_>, spent: &AtomicUsize) -> Found {
        let model = self.with(&self.refined(best, spent));
        let given = self.given(&model);
        let rows = self.rows(&given, |at| [given[at].norm().recip(); 2]);
        Found { model, typical: typical_of(&rows), rows }
    }

    /// A model with its numbers moved so far on their natural scales.
    fn moved(&self, model: &Model, steps: &[f64]) -> Model {
        let values = values_in(model, self.parameters);
        let moved = self.parameters.iter().zip(&values).zip(steps).map(|((p, value), step)| p.moved(*value, *step));
        model_with(model, self.parameters, &moved.collect::<Vec<_>>())
    }

    /// The steps of the numbers that take most of a change back.
    fn against(&self, change: &DVector<f64>) -> DVector<f64> {
        if self.inverse.is_empty() { DVector::zeros(self.parameters.len()) } else { -(&self.inverse * change) }
    }

    /// A change less what the numbers could undo.
    fn without(&self, change: &DVector<f64>) -> DVector<f64> {
        if self.inverse.is_empty() { change.clone() } else { change + &self.columns * self.against(change) }
    }

    /// The law that is the last effect of a model; `None` where it does nothing that the numbers cannot.
    fn law(&self, model: Model) -> Option<Law> {
        let change = self.left_by(&model) - &self.left;
        let (effect, own) = (model.effects.last()?.0, self.without(&change));
        (own.norm_squared() > SINGULAR * change.norm_squared()).then_some(Law { effect, model, change, own })
    }

    /// Laws with the strengths that lessen the sum of squares most, where they may have these.
    fn together<'l>(&self, laws: Vec<Cow<'l, Law>>) -> Option<Together<'l>> {
        // What is projected out of a law is out of its product with what is left.
        let wanted: Vec<f64> = laws.iter().map(|law| -law.own.dot(&self.left)).collect();
        let squares: Vec<f64> = laws.iter().map(|law| law.own.norm_squared()).collect();
        let strengths = match &laws[..] {
            [a, b] => {
                let both = a.own.dot(&b.own);
                let determinant = squares[0] * squares[1] - both * both;
                let is_one = determinant <= SINGULAR * squares[0] * squares[1];
                let of = |own: usize, other: usize| (squares[other] * wanted[own] - both * wanted[other]) / determinant;
                if is_one { return None } else { vec![of(0, 1), of(1, 0)] }
            }
            _ => wanted.iter().zip(&squares).map(|(wanted, square)| wanted / square).collect(),
        };
        let gain = strengths.iter().zip(&wanted).map(|(strength, wanted)| strength * wanted).sum();
        let allowed = laws.iter().zip(&strengths).all(|(law, strength)| law.allows(*strength));
        allowed.then_some(Together { gain, laws, strengths })
    }

    /// The best of all places of two laws.
    fn best<'l>(&self, a: &'l [Law], b: &'l [Law]) -> Option<Together<'l>> {
        let all = a.iter().flat_map(|a| b.iter().map(move |b| vec![Cow::Borrowed(a), Cow::Borrowed(b)]));
        all.filter_map(|laws| self.together(laws)).max_by(Together::order)
    }

    /// The same at a better place near it, by steps along one parameter after the other; counts the laws that were
    /// looked at.
    fn refined<'l>(&self, mut best: Together<'l>, spent: &AtomicUsize) -> Together<'l> {
        for halving in 0..HALVINGS {
            let step = 0.5_f64.powi(halving + 2);
            for which in 0..best.laws.len() {
                // Of all that is the strength one is enough.
                let all = || 0..best.laws[which].values().len();
                let first = all().find(|&number| best.laws[which].is_strength(number));
                for (number, step) in
                    all().filter(|number| Some(*number) != first).flat_map(|n| [(n, step), (n, -step)])
                {
                    spent.fetch_add(1, Relaxed);
                    let Some(moved) = self.beside(&best.laws[which], number, step) else { continue };
                    let mut laws = best.laws.clone();
                    laws[which] = Cow::Owned(moved);
                    best = self.together(laws).filter(|found| found.gain > best.gain).unwrap_or(best);
                }
            }
        }
        best
    }

    /// A law with one parameter moved by a share of its range.
    fn beside(&self, law: &Law, number: usize, step: f64) -> Option<Law> {
        let key = format!("effect.{}.{}", law.effect.name(), law.effect.parameters()[number].key);
        let parameter = parameter(&law.model, &key)?;
        let share = (parameter.share(law.values()[number]) + step).clamp(0.0, 1.0);
        let mut model = law.model.clone();
        model.effects.last_mut()?.1[number] = parameter.within(share);
        self.law(model)
    }

    /// The model with laws of these strengths, and with its own numbers as they are beside these.
    fn with(&self, Together { laws, strengths, .. }: &Together<'_>) -> Model {
        let changes = laws.iter().zip(strengths).map(|(law, strength)| &law.change * *strength);
        let changed = changes.fold(self.left.clone(), |sum, change| sum + change);
        let mut model = self.moved(&self.model, self.against(&changed).as_slice());
        for (law, strength) in laws.iter().zip(strengths) {
            let of = |(number, value): (usize, &f64)| if law.is_strength(number) { value * strength } else { *value };
            model.effects.push((law.effect, law.values().iter().enumerate().map(of).collect()));
        }
        model
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{Calibration, calibrate};
    use crate::effects::find;
    use crate::solver::cycle::Tolerance;
    use crate::solver::{Warm, solve_steady};
    use std::sync::Arc;

    const RIG: &str = "title = 'A mode on a spring'
[rig]
kind = 'oscillator'
drive = 'force'
mass = '1 kg'
natural_frequency = '10 Hz'
quality_factor = 100
[sweep]
frequency = '10 Hz'
drive = '1 N'
[fit]
free = ['rig.natural_frequency', 'rig.quality_factor']
";

    /// Readings at three drives of a joint that slips as a whole and a spring that hardens: the joint alone, or the
    /// spring alone, leaves nearly all.
    #[test]
    fn a_joint_and_a_spring_that_hardens_are_told_together_with_their_strengths() {
        let scenario = crate::scenario::load_text("rig.toml", RIG).expect("a scenario");
        let base = Model::new(&scenario);
        let joint = (find("friction-joint").expect("an effect"), vec![120.0, 0.5, 1.0]);
        let spring = (find("cubic-stiffness").expect("an effect"), vec![2e5]);
        let truth = Model { effects: vec![joint, spring], ..base.clone() };
        let at = |row: usize| {
            let (series, place) = (row / 31, row % 31);
            let drive = [0.2, 0.7, 2.0][series];
            let mut point = Point {
                row,
                line: row,
                speed: 0.0,
                load: 0.0,
                drive,
                frequency: 10.0 + 0.02 * (place as f64 - 12.0),
                amplitude: 1.0,
                phase: None,
                amplitude_sd: 1.0,
                phase_sd: Some(0.01),
                mean: None,
                replicates: 1,
                series,
            };
            let state = solve_steady(&truth, &operation(&point), &Tolerance::FIT, false, &mut Warm::default()).state;
            assert!(state.status.is_steady());
            (point.amplitude, point.amplitude_sd, point.phase) =
                (state.amplitude, 0.01 * state.amplitude, Some(state.phase));
            point
        };
        let points: Vec<Point> = (0..93).map(at).collect();
        let Calibration { base, fit, .. } = calibrate(&base, &scenario.free, &points, Tolerance::default(), 0);
        let from = Hypothesis { additions: Vec::new(), model: base.clone(), fit, estimate: None, bic: 0.0 };
        let data = Data::new(base, &scenario.free, (&points, f64::INFINITY), (u64::MAX, &Arc::default()));
        let pool: Vec<Addition> =
            ["power-damping", "quadratic-damping", "friction-joint", "clearance", "cubic-stiffness"]
                .map(|name| Addition::Effect(find(name).expect("an effect")))
                .into();
        let parent = Parent::new(&data, &from, from.fit.values.clone(), points.len());
        let found = parent.pairs(&data, &from, &pool, (8, (12, 0)));
        assert_eq!(found[0].additions.map(|a| a.name()), ["friction-joint", "cubic-stiffness"]);
        let values = |number: usize| &found[0].model.effects[number].1;
        let near = |a: f64, b: f64| (a / b).ln().abs() < 0.2;
        assert!(
            near(values(0)[0], 120.0) && near(values(0)[1], 0.5) && near(values(1)[0], 2e5),
            "{:?} {:?}",
            values(0),
            values(1)
        );
    }
}
