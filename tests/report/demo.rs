//! A report with plausible content, built as the program builds it.

use stickslip::compare::{Options, compare};
use stickslip::report::{
    Agreement, CheckView, ClaimView, FigureInput, Provenance, ReportView, ScenarioView, Verdict, anchor, effect_view,
    scenario_view,
};
use stickslip::scenario::{
    Contact, EffectSetting, Formulation, Instrument, Rig, Scenario, Signals, Sweep, TorsionalArm,
};
use stickslip::solver::{Method, Status, SteadyState};
use stickslip::sweep::{Condition, Curve, LimitCurve, LimitingCase, Outcome};

/// The values of the paper.
pub fn scenario(id: &str, title: &str) -> Scenario {
    Scenario {
        id: id.into(),
        path: format!("scenarios/{id}.toml").into(),
        hash: "9f2c1e7ab04d5563c8e1f09a7b3d2c4e5f60718293a4b5c6d7e8f90123456789".into(),
        title: title.into(),
        description: "Resonance curves between static contact and full slip, for a list of speeds of the roller."
            .into(),
        provenance: "printed in the paper".into(),
        origins: std::collections::BTreeMap::new(),
        rig: Rig::TorsionalArm(TorsionalArm {
            inertia: 5.0e-3,
            torsional_stiffness: 990.0,
            torsional_damping: 0.43,
            spring_stiffness: 1.6e4,
            spring_damping: 12.0,
            spring_arm: 0.03,
            contact_arm: 0.06,
        }),
        contact: Some(Contact { stiffness: 8.9e4, damping: 26.0, friction: 0.5, formulation: Formulation::Series }),
        instrument: Instrument::default(),
        signals: Signals::ARM,
        sweep: Some(Sweep {
            frequency: (0..101).map(|i| 50.0 + 0.5 * f64::from(i)).collect(),
            speed: SPEEDS.to_vec(),
            load: vec![20.0],
            drive: vec![2.5e-6],
            friction: vec![0.5],
            formulation: vec![Formulation::Series],
            euler_steps: vec![20_000],
        }),
        effects: vec![EffectSetting {
            effect: stickslip::effects::find("rate-strengthening").unwrap(),
            parameters: vec![0.12, 1e-3],
        }],
        measurement: None,
        question: None,
        free: Vec::new(),
        figures: None,
        gate: Default::default(),
    }
}

const SPEEDS: [f64; 5] = [1e-6, 1e-5, 2e-5, 5e-5, 2e-2];

/// A resonance curve that looks like one; the numbers mean nothing.
pub fn amplitude(frequency: f64, softness: f64) -> f64 {
    let ratio = frequency / (81.57 - 10.4 * softness);
    let zeta = 0.16 - 0.045 * softness;
    1.3e-6 / ((1.0 - ratio * ratio).powi(2) + (2.0 * zeta * ratio).powi(2)).sqrt()
}

/// What a sweep of the scenario could have given.
pub fn outcome(scenario: Scenario, status: &Status) -> Outcome {
    let frequency: Vec<f64> = (0..101).map(|i| 50.0 + 0.5 * f64::from(i)).collect();
    let state = |frequency: f64, softness: f64| {
        let amplitude = amplitude(frequency, softness);
        SteadyState {
            amplitude,
            phase: -((frequency - 50.0) / 20.0),
            mean: 5.9e-4,
            speed_amplitude: 0.06 * std::f64::consts::TAU * frequency * amplitude,
            stick_fraction: 1.0 - softness,
            force_minimum: -10.0,
            force_maximum: 10.0,
            cycles: 41,
            periodicity_error: 3e-11,
            status: if frequency == 90.0 && softness == 1.0 { status.clone() } else { Status::Steady },
            method: Method::Shooting,
        }
    };
    let curve = |(index, &speed): (usize, &f64)| Curve {
        condition: Condition {
            formulation: Formulation::Series,
            euler_steps: 20_000,
            drive: 2.5e-6,
            load: 20.0,
            friction: 0.5,
            speed,
            series: 0,
        },
        frequency: frequency.clone(),
        states: frequency.iter().map(|&f| state(f, index as f64 / 4.0)).collect(),
        down: Vec::new(),
        orbits: Vec::new(),
    };
    let limit = |case, peak_frequency, peak_amplitude, speed_peak_frequency, speed_peak| LimitCurve {
        case,
        drive: 2.5e-6,
        frequency: Vec::new(),
        amplitude: Vec::new(),
        phase: Vec::new(),
        speed_amplitude: Vec::new(),
        peak_frequency,
        peak_amplitude,
        speed_peak_frequency,
        speed_peak,
    };
    Outcome {
        scenario,
        curves: SPEEDS.iter().enumerate().map(curve).collect(),
        limits: vec![
            limit(LimitingCase::FreeOrFullSlip, 71.194, 6.2401e-6, 71.916, 0.16833e-3),
            limit(LimitingCase::StaticContact, 81.569, 4.5814e-6, 82.49, 0.14167e-3),
        ],
        seconds: 0.42,
    }
}

/// A drawing of the curves, with ids as other programs would write them.
pub fn figure(id: &str, name: &str, title: &str) -> FigureInput {
    let colours = ["#0072b2", "#009e73", "#e69f00", "#d55e00", "#cc79a7"];
    let mut svg = String::from(
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1100\" height=\"620\" viewBox=\"0 0 1100 620\" role=\"img\" \
         font-family=\"DejaVu Sans, sans-serif\"><clipPath id=\"plot\"><rect x=\"90\" y=\"30\" width=\"980\" height=\"510\"/></clipPath>\
         <rect width=\"1100\" height=\"620\" fill=\"#ffffff\"/><path d=\"M90 30V540H1070\" fill=\"none\" stroke=\"#222\"/>\n",
    );
    for tick in 0..6 {
        let (x, f) = (90 + 196 * tick, 50 + 10 * tick);
        svg += &format!("<text x=\"{x}\" y=\"568\" font-size=\"18\" text-anchor=\"middle\">{f}</text>\n");
        svg +=
            &format!("<text x=\"78\" y=\"{}\" font-size=\"18\" text-anchor=\"end\">{tick}</text>\n", 546 - 90 * tick);
    }
    svg += "<text x=\"580\" y=\"604\" font-size=\"20\" text-anchor=\"middle\">Drive frequency f [Hz]</text>\n<g clip-path=\"url(#plot)\">";
    for (index, colour) in colours.iter().enumerate() {
        let point = |i: usize| {
            let f = 50.0 + 0.25 * i as f64;
            let y = 540.0 - amplitude(f, index as f64 / 4.0) * 9.0e7;
            format!("{:.1} {y:.1}", 90.0 + 19.6 * (f - 50.0))
        };
        let path: Vec<String> = (0..201).map(point).collect();
        svg += &format!("<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\"/>\n", path.join("L"));
    }
    svg += "</g></svg>";
    FigureInput {
        name: name.into(),
        title: title.into(),
        caption: "Amplitude of the arm's angle against drive frequency, one curve per speed of the roller. Look for the top, which is \
                  cut first without a shift of the resonance; at lower speeds the peak moves right, towards static contact."
            .into(),
        alt: "Five resonance curves; the peak moves from 71 to 82 hertz and falls as the roller slows.".into(),
        svg,
        narrow: None,
        notes: vec![
            ("Peak in full slip".into(), "6.240 µrad at 71.19 Hz".into()),
            ("Peak in static contact".into(), "4.581 µrad at 81.57 Hz".into()),
            ("Largest speed amplitude".into(), "0.1683 mm/s at 71.92 Hz".into()),
        ],
        csv: "frequency [Hz],amplitude [µrad]\n71.19,6.24\n".into(),
        reading: [
            "A row of peaks that moves to the right as the roller slows.",
            "A peak that moves the other way.",
            "Compare the frequencies of the peaks with measured ones.",
        ]
        .map(String::from),
        files: ["svg", "png", "csv"].map(|kind| format!("{id}/{name}.{kind}")).to_vec(),
    }
}

/// Claims of each verdict.
pub fn claims() -> Vec<ClaimView> {
    let figure = Some(anchor::figure("paper/figure-6", "transition"));
    let claim =
        |id: &str, section: &str, statement: &str, expected: &str, computed: &str, verdict, note: &str| ClaimView {
            id: id.into(),
            section: section.into(),
            statement: statement.into(),
            quantity: "peak of α(f)".into(),
            expected: expected.into(),
            computed: computed.into(),
            tolerance: "0.5 %".into(),
            reason: "the figure's line width".into(),
            verdict,
            note: note.into(),
            figure: figure.clone(),
            ..ClaimView::default()
        };
    vec![
        claim(
            "static-shift",
            "Results, Figure 5",
            "In static contact the resonance shifts to a higher frequency.",
            "f_II > f_I",
            "81.57 Hz > 71.19 Hz",
            Verdict::Reproduced,
            "",
        ),
        claim(
            "no-influence-of-mu",
            "Numerical, Figure 3",
            "The coefficient of friction has no influence on the curves.",
            "largest difference 0",
            "8.1×10⁻¹²",
            Verdict::Caveat,
            "Holds as long as F never reaches −μW, which is so for all six coefficients.",
        ),
        claim(
            "figure-6-speeds",
            "Results, Figure 6",
            "The transition is seen for speeds from 0.1 to 0.5 mm/s.",
            "partial stick at 0.1 … 0.5 mm/s",
            "partial stick below 0.1683 mm/s only",
            Verdict::NotReproducible,
            "Every speed above 0.1683 mm/s gives exactly full slip with the printed u₀ = 2.5 µm; u₀ = 7.5 µm would make the range follow.",
        ),
        claim(
            "full-slip-is-free",
            "Theory, Eq. 16",
            "Full slip has the same curve as no contact.",
            "α_III = α_I",
            "differs by 2 %",
            Verdict::Failed,
            "The sweep did not reach a steady state at 90 Hz.",
        ),
    ]
}

/// A scenario with measurements and nothing else, compared.
pub fn measured(number: usize, title: &str) -> ScenarioView {
    let mut scenario = stickslip::scenario::load_embedded(&format!("practice/{number}/scenario")).unwrap();
    scenario.title = title.into();
    let mut table = stickslip::measurement::load(&scenario).unwrap().unwrap();
    table.points.retain(|point| point.row % 2 == 0);
    table.notes = vec![format!("the noise is that of the table of {title}")];
    let comparison = compare(&scenario, &table, &Options { seed: 0 });
    let names = ["overlay", "misfit-map", "contact-fingerprint", "peaks"];
    let figures = names.map(|name| figure(&scenario.id, name, name));
    let outcome = Outcome { scenario, curves: Vec::new(), limits: Vec::new(), seconds: 0.0 };
    scenario_view(&outcome, &[]).with_comparison(&comparison, &figures)
}

/// A scenario with measurements and nothing else, compared, and searched for what is missing.
pub fn discovered(number: usize, title: &str) -> ScenarioView {
    let discovery = super::small_discovery::discovered(number, |scenario, table| {
        scenario.title = title.into();
        table.notes = vec![format!("the noise is that of the table of {title}")];
    });
    let base = &discovery.steps[0].comparison;
    let outcome = Outcome { scenario: base.scenario.clone(), curves: Vec::new(), limits: Vec::new(), seconds: 0.0 };
    let names = ["ladder", "ladder-overlay", "ranking", "parameters"];
    let figures = names.map(|name| figure(&base.scenario.id, name, name));
    scenario_view(&outcome, &[]).with_comparison(base, &[]).with_discovery(&discovery, &figures)
}

/// The report with the given title, fixed so that two are the same.
pub fn report(title: &str) -> ReportView {
    let figures = |id: &str| {
        [
            figure(id, "transition", "Transition between sticking and slipping"),
            figure(id, "ridge", "Peak frequency and amplitude against speed"),
        ]
    };
    let scenarios = vec![
        scenario_view(&outcome(scenario("paper/figure-6", title), &Status::Steady), &figures("paper/figure-6")),
        scenario_view(
            &outcome(
                scenario("paper/beyond", "Beyond the printed figures"),
                &Status::SelfExcited("a multiplier of modulus 1.31".into()),
            ),
            &figures("paper/beyond"),
        ),
    ];
    let check = |name: &str, compares: &str, expected: &str, computed: &str, difference: &str, verdict| CheckView {
        name: name.into(),
        compares: compares.into(),
        expected: expected.into(),
        computed: computed.into(),
        difference: difference.into(),
        tolerance: "1×10⁻⁵".into(),
        verdict,
        ..CheckView::default()
    };
    let checks = vec![
        check(
            "Case I in closed form",
            "shooting with W = 0 against Eq. 9",
            "6.2401 µrad",
            "6.2401 µrad",
            "3.1×10⁻⁸",
            Agreement::Agrees,
        ),
        check(
            "Energy balance",
            "work of the drive against dissipation",
            "1",
            "1.00013",
            "1.3×10⁻⁴",
            Agreement::Disagrees,
        ),
    ];
    let mut provenance = Provenance::fixed("stickslip report scenarios/paper");
    provenance.timings = vec![("paper/figure-6: sweep".into(), 0.42), ("figures".into(), 0.31)];
    let effect = |effect: &&'static dyn stickslip::effects::Effect| {
        effect_view(*effect, &figure("atlas", effect.name(), effect.title()))
    };
    let atlas = stickslip::effects::REGISTRY.iter().map(effect).collect();
    ReportView::assemble(title, claims(), scenarios, atlas, checks, &provenance)
}
