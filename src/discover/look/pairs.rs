//! Two laws of the motion at once, estimated where neither does any good alone.
//!
//! Every reading asks for a dynamic stiffness, drive over motion. At the motion that was measured that is linear in the strengths of all laws of
//! force, and in stiffness and damping of the rig: what any two of many laws leave together is a least-squares problem of two numbers.

use super::{Count, Parent, SINGULAR, Start};
use crate::discover::data::Data;
use crate::discover::hypothesis::{Addition, Hypothesis, compatible};
use crate::effects::Effect;
use crate::fit::{Parameter, Prediction, Problem, operation, parameter};
use crate::linear::svd;
use crate::measurement::Point;
use crate::model::Model;
use crate::model::alone::Alone;
use crate::parameter::Scales;
use crate::solver::cycle::Tolerance;
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

impl Pair {
    /// Turns the order of its effects.
    pub fn turn(&mut self) {
        self.additions.swap(0, 1);
        let last = self.model.effects.len() - 1;
        self.model.effects.swap(last - 1, last);
    }
}

/// Halvings of the step, at first a quarter of a range, with which the best place of a pair is looked for.
const HALVINGS: i32 = 6;
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

/// Two laws that together lessen the sum of squares by so much with these strengths.
struct Together<'l> {
    gain: f64,
    laws: [Cow<'l, Law>; 2],
    strengths: [f64; 2],
}

impl Parent<'_> {
    /// The most promising pairs of effects, the best first, each once; none of a model with a contact, whose forces are no law of one motion.
    pub fn pairs(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        pool: &[Addition],
        (starts, seed): (usize, u32),
    ) -> Vec<Pair> {
        if self.model.has_contact {
            return Vec::new();
        }
        let numbers = Numbers::of(self, &from.fit.parameters);
        let laws = self.laws(data, from, pool, &numbers, (starts, seed));
        let fits = |a: &[Law], b: &[Law]| compatible(&self.model, &[a, b].map(|of| Addition::Effect(of[0].effect)));
        let work: Vec<[&[Law]; 2]> = (0..laws.len())
            .flat_map(|i| (i + 1..laws.len()).map(move |j| [i, j]))
            .map(|of| of.map(|i| &laws[i][..]))
            .filter(|[a, b]| fits(a, b))
            .collect();
        let spent = AtomicUsize::new(0);
        let mut found: Vec<Together<'_>> = work
            .into_par_iter()
            .filter_map(|[a, b]| numbers.best(a, b))
            .map(|together| numbers.refined(together, &spent))
            .collect();
        data.count((spent.into_inner() * self.problem.points().len() / PART) as u64);
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        found.into_iter().map(|together| numbers.pair(&together)).collect()
    }

    /// A starting point of the second effect of a pair beside the first.
    pub fn start_of(&self, data: &Data<'_>, first: &Hypothesis, pair: &Pair) -> Start {
        let none: [&Point; 0] = [];
        let parameters = data.beside(&pair.model, first, pair.additions[1]);
        let values = Problem::new(pair.model.clone(), none, parameters, Tolerance::COARSE).values();
        Start { model: pair.model.clone(), values, residuals: self.evaluated(data, &pair.model).residuals }
    }

    /// Laws of force, each at places of its ranges.
    fn laws(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        pool: &[Addition],
        numbers: &Numbers<'_>,
        (starts, seed): (usize, u32),
    ) -> Vec<Vec<Law>> {
        let count = Count { known: None, starts, shared: 1, turn: 0, seed };
        let of = |addition: &Addition| -> Vec<Law> {
            let Addition::Effect(effect) = *addition else { return Vec::new() };
            let own = || 0..effect.parameters().len();
            let present = self.model.effects.iter().any(|(own, _)| own.name() == effect.name());
            let is_law =
                !present && effect.formula().is_none() && effect.of_series().is_none() && effect.torque_is_odd();
            if !is_law || !own().any(|number| is_strength(effect, number, &self.model.scales)) {
                return Vec::new();
            }
            let places = count.samples(from, *addition).into_iter().map(|sample| sample.of(data, self, *addition));
            places.filter_map(|model| numbers.law(model)).collect()
        };
        let laws: Vec<Vec<Law>> = pool.par_iter().map(of).filter(|of| !of.is_empty()).collect();
        data.count((laws.iter().map(Vec::len).sum::<usize>() * self.problem.points().len() / PART) as u64);
        laws
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
    parameters: &'p [Parameter],
    left: DVector<f64>,
    /// Derivatives by the natural scale of each number, and their pseudo-inverse.
    columns: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl<'p> Numbers<'p> {
    fn of(parent: &'p Parent<'p>, parameters: &'p [Parameter]) -> Self {
        let [columns, inverse] = [(); 2].map(|()| DMatrix::zeros(0, 0));
        let mut numbers = Self { parent, parameters, left: DVector::zeros(0), columns, inverse };
        numbers.left = numbers.left_by(&parent.model);
        let by = |number: usize| {
            let mut steps = vec![0.0; parameters.len()];
            steps[number] = STEP;
            (numbers.left_by(&numbers.moved(&parent.model, &steps)) - &numbers.left) / STEP
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

    /// The dynamic stiffness of a model at every motion that was measured, over the one that the reading asks for, less one: in standard
    /// deviations of the amplitude (real part) and of the phase. A phase that was not measured is that of the parent.
    fn left_by(&self, model: &Model) -> DVector<f64> {
        let of = |(point, prediction): (&&Point, &Prediction)| {
            let mode = Alone::new(model, &operation(point));
            let lumps = &mode.lumps;
            let motion = lumps.motion((point.amplitude, point.phase.unwrap_or(prediction.phase)));
            let (k, c) = describing(&mode, motion.norm());
            let stiffness = lumps.stiffness.value + k - lumps.inertia.value * lumps.omega.powi(2);
            let given = Complex::new(stiffness, lumps.damping.value * lumps.omega + c);
            let beside = given * motion / Complex::new(lumps.torque_re.value, lumps.torque_im.value) - 1.0;
            let beside = if beside.is_finite() { beside } else { Complex::ZERO };
            let amplitude = beside.re * point.amplitude / point.amplitude_sd;
            std::iter::once(amplitude).chain(point.phase_sd.map(|sd| beside.im / sd))
        };
        let pairs = self.parent.problem.points().iter().zip(&self.parent.evaluation.predictions);
        DVector::from_vec(pairs.flat_map(of).collect())
    }

    /// A model with its numbers moved so far on their natural scales.
    fn moved(&self, model: &Model, steps: &[f64]) -> Model {
        let none: [&Point; 0] = [];
        let problem = Problem::new(model.clone(), none, self.parameters.to_vec(), Tolerance::COARSE);
        let values = problem.values();
        let moved = self.parameters.iter().zip(&values).zip(steps).map(|((p, value), step)| p.moved(*value, *step));
        problem.model(&moved.collect::<Vec<_>>())
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

    /// Two laws with the strengths that lessen the sum of squares most, where they may have these.
    fn together<'l>(&self, a: Cow<'l, Law>, b: Cow<'l, Law>) -> Option<Together<'l>> {
        let (aa, ab, bb) = (a.own.norm_squared(), a.own.dot(&b.own), b.own.norm_squared());
        // What is projected out of a law is out of its product with what is left.
        let (x, y) = (-a.own.dot(&self.left), -b.own.dot(&self.left));
        let determinant = aa * bb - ab * ab;
        let strengths = [(bb * x - ab * y) / determinant, (aa * y - ab * x) / determinant];
        let allowed = determinant > SINGULAR * aa * bb && a.allows(strengths[0]) && b.allows(strengths[1]);
        let gain = strengths[0] * x + strengths[1] * y;
        allowed.then_some(Together { gain, laws: [a, b], strengths })
    }

    /// The best of all places of two laws.
    fn best<'l>(&self, a: &'l [Law], b: &'l [Law]) -> Option<Together<'l>> {
        let all = a.iter().flat_map(|a| b.iter().map(move |b| (Cow::Borrowed(a), Cow::Borrowed(b))));
        all.filter_map(|(a, b)| self.together(a, b)).max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// The same at a better place near it, by steps along one parameter after the other; counts the laws that were looked at.
    fn refined<'l>(&self, mut best: Together<'l>, spent: &AtomicUsize) -> Together<'l> {
        let step = |halving: i32| 0.5_f64.powi(halving + 2);
        for halving in 0..HALVINGS {
            for which in 0..2 {
                // Of all that is the strength one is enough.
                let first = (0..best.laws[which].values().len()).find(|&number| best.laws[which].is_strength(number));
                for number in (0..best.laws[which].values().len()).filter(|number| Some(*number) != first) {
                    for step in [step(halving), -step(halving)] {
                        spent.fetch_add(1, Relaxed);
                        let Some(moved) = self.beside(&best.laws[which], number, step) else { continue };
                        let mut laws = best.laws.clone();
                        laws[which] = Cow::Owned(moved);
                        let [a, b] = laws;
                        best = self.together(a, b).filter(|found| found.gain > best.gain).unwrap_or(best);
                    }
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

    /// The model with two laws, and with its own numbers as they are beside these.
    fn pair(&self, Together { laws, strengths, .. }: &Together<'_>) -> Pair {
        let additions = [0, 1].map(|i| Addition::Effect(laws[i].effect));
        let changed = &self.left + &laws[0].change * strengths[0] + &laws[1].change * strengths[1];
        let mut model = self.moved(&self.parent.model, self.against(&changed).as_slice());
        for (law, strength) in laws.iter().zip(strengths) {
            let of = |(number, value): (usize, &f64)| if law.is_strength(number) { value * strength } else { *value };
            model.effects.push((law.effect, law.values().iter().enumerate().map(of).collect()));
        }
        Pair { additions, model }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{Calibration, calibrate};
    use crate::effects::find;
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

    /// Readings at three drives of a joint that slips as a whole and a spring that hardens: the joint alone, or the spring alone, leaves nearly all.
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
        let data = Data::new(base, &scenario.free, &points, (u64::MAX, &Arc::default()));
        let pool: Vec<Addition> =
            ["power-damping", "quadratic-damping", "friction-joint", "clearance", "cubic-stiffness"]
                .map(|name| Addition::Effect(find(name).expect("an effect")))
                .into();
        let parent = Parent::new(&data, &from, from.fit.values.clone(), points.len());
        let found = parent.pairs(&data, &from, &pool, (12, 0));
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
