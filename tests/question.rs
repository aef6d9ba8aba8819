//! The open question: what is asked for is what the words describe, and what is found does not depend on chance.

#[path = "figures/layout.rs"]
mod layout;

use std::f64::consts::TAU;
use std::sync::OnceLock;
use stickslip::model::{Model, Operation};
use stickslip::question::{self, Answer};
use stickslip::scenario::{self, Question, Scenario};
use stickslip::solver::{Status, Warm, cycle::Tolerance, solve_steady};
use stickslip::{figures, report};

fn scenario() -> Scenario {
    scenario::load_embedded("paper/open-question").expect("sound")
}

fn with_threads(scenario: &Scenario, threads: usize) -> Answer {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| question::answer(scenario)).expect("a question")
}

/// The answer, found on two threads.
fn answer() -> &'static Answer {
    static ANSWER: OnceLock<Answer> = OnceLock::new();
    ANSWER.get_or_init(|| with_threads(&scenario(), 2))
}

/// Number of the effects that act on a rig with a contact.
fn beside_contact() -> usize {
    // A drift is of measured series.
    let asked = |effect: &&&dyn stickslip::effects::Effect| {
        stickslip::effects::fits_rig(**effect, true).is_ok() && effect.of_series().is_none()
    };
    stickslip::effects::REGISTRY.iter().filter(asked).count()
}

#[test]
fn the_curve_asked_for_is_lower_further_right_and_full_slip_at_the_ends() {
    let d = &answer().described;
    assert!(d.all(), "{d:?}");
    assert!((d.lower - 0.273).abs() < 0.005 && (1.2..1.7).contains(&d.shift_hz), "{d:?}");
    assert!(d.ends.iter().all(|end| end.abs() < 1e-6) && d.rms == 0.0, "{d:?}");
    for (i, f) in answer().target.frequency.iter().enumerate() {
        let full_slip = (answer().target.states[i].amplitude / answer().full_slip[i] - 1.0).abs() < 1e-3;
        assert_eq!(full_slip, *f < 58.0 || *f > 89.0, "{f} Hz");
    }
}

#[test]
fn with_the_printed_drive_there_is_nothing_to_resemble() {
    let mut printed = scenario();
    printed.sweep.as_mut().expect("a sweep").drive = vec![2.5e-6];
    let base = Model::new(&printed);
    let state = |speed: f64| {
        let at = Operation { speed, load: 20.0, drive: 2.5e-6, frequency: 72.0, series: 0 };
        solve_steady(&base, &at, &Tolerance::default(), false, &mut Warm::default()).state.amplitude
    };
    assert!((state(2e-4) / state(2e-2) - 1.0).abs() < 1e-9);
}

#[test]
fn one_thread_finds_the_same() {
    assert_eq!(question::table(&with_threads(&scenario(), 1)), question::table(answer()));
    assert_eq!(answer().hypotheses.len(), beside_contact());
}

#[test]
fn those_that_can_are_steady_have_all_features_and_come_first() {
    let able = answer().able().count();
    assert!(answer().hypotheses.iter().take(able).all(|h| h.can()));
    assert!(answer().able().any(|h| h.effect.name() == "rate-strengthening"));
    let strains: Vec<f64> = answer().able().map(|h| h.shown().strain).collect();
    assert!(strains.is_sorted(), "{strains:?}");
    for h in answer().able() {
        let mild = h.mildest.as_ref().expect("it can");
        assert!(mild.strain <= h.best.strain + 1e-12, "{}", h.effect.name());
        for setting in [mild, &h.best] {
            assert!(setting.features.all(), "{}: {:?}", h.effect.name(), setting.features);
            assert!(setting.curve.states.iter().all(|state| state.status == Status::Steady), "{}", h.effect.name());
        }
    }
    let unseen = ["sensor-delay", "partial-slip", "maxwell-branch", "roller-compliance"];
    for h in answer().hypotheses.iter().filter(|h| unseen.contains(&h.effect.name())) {
        assert!(!h.can(), "{} does nothing in full slip", h.effect.name());
    }
}

#[test]
fn within_five_percent_no_single_effect_can() {
    let strict = Scenario { question: Some(Question { resembles: 2e-4, tolerance: 0.05 }), ..scenario() };
    let answer = question::answer(&strict).expect("a question");
    assert_eq!(answer.able().count(), 0);
    // What the answer to the looser question says of this one.
    let told: Vec<(f64, usize)> = self::answer().otherwise.iter().map(|o| (o.tolerance, o.able.len())).collect();
    let [(tolerance, able), .., (loosest, most)] = told[..] else { panic!("{told:?}") };
    assert_eq!((tolerance, able), (0.05, 0));
    assert!(loosest > 0.1 && most >= self::answer().able().count(), "{told:?}");
    assert!(answer.deciding.is_none());
    assert_eq!(answer.hypotheses.len(), beside_contact());
}

/// For small vibrations strengthening is a damper N beta/(V + v0) in series with the bristles.
#[test]
fn strengthening_is_a_damper_in_series_with_the_bristles() {
    let base = Model::new(&scenario());
    let h = answer().hypotheses.iter().find(|h| h.effect.name() == "rate-strengthening").expect("in the catalogue");
    let (model, c, drive) = (h.model(&base, h.shown()), &answer().condition, 1e-10);
    let (beta, v_0) = (h.shown().values[0], h.shown().values[1]);
    let eta = c.load * beta / (c.speed + v_0);
    let (rig, contact) = (model.rig.arm(), &model.contact);
    for f in [50.0, 60.0, 70.0, 72.0, 75.0, 85.0, 100.0] {
        let w = TAU * f;
        // Series of kc + i w cc and i w eta: the product over the sum, in real and imaginary parts.
        let (re, im) = (-w * w * contact.damping * eta, w * eta * contact.stiffness);
        let (a, b) = (contact.stiffness, w * (contact.damping + eta));
        let z = ((re * a + im * b) / (a * a + b * b), (im * a - re * b) / (a * a + b * b));
        let (arm2, a2) = (rig.contact_arm.powi(2), rig.spring_arm.powi(2));
        let real = rig.torsional_stiffness + 2.0 * a2 * rig.spring_stiffness - rig.inertia * w * w + arm2 * z.0;
        let imaginary = w * (rig.torsional_damping + 2.0 * a2 * rig.spring_damping) + arm2 * z.1;
        let torque = rig.spring_arm * drive * rig.spring_stiffness.hypot(w * rig.spring_damping);
        let exact = torque / real.hypot(imaginary);
        let at = Operation { speed: c.speed, load: c.load, drive, frequency: f, series: 0 };
        let found = solve_steady(&model, &at, &Tolerance::default(), false, &mut Warm::default()).state.amplitude;
        assert!((found / exact - 1.0).abs() < 1e-4, "{f} Hz: {found:e}, {exact:e}");
    }
}

#[test]
fn the_reading_that_decides_separates_more_than_the_condition_of_the_question() {
    let Some(d) = &answer().deciding else { panic!("two or more can") };
    assert!(d.least_difference > d.without_change, "{d:?}");
    assert!((2..=question::MOST_RIVALS).contains(&d.predictions.len()));
    for pair in d.predictions.windows(2) {
        let (a, b) = (pair[0].amplitude_rad, pair[1].amplitude_rad);
        assert!(2.0 * (b - a) / (a + b) > d.least_difference - 1e-6, "{d:?}");
    }
}

#[test]
fn the_figure_is_laid_out_and_says_that_all_is_simulated() {
    let drawing = figures::question::draw(answer()).expect("drawn");
    assert_eq!(drawing, figures::question::draw(answer()).expect("drawn"));
    assert!(drawing.caption.starts_with("All curves are simulated"));
    assert!(drawing.caption.ends_with("hypotheses, not findings."));
    assert!(!drawing.svg.contains("NaN") && report::svg::inline(&drawing.svg, "a-").is_some());
    layout::check_drawing("question", &drawing);
    assert!(!layout::rows(&drawing).is_empty());
}
