//! Measured moduli as series of relaxations: closed forms, another package's errors, units, tables of all sorts.

#[path = "figures/layout.rs"]
mod layout;

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use std::f64::consts::TAU;
use std::path::Path;
use stickslip::prony::{Analysis, Contact, Interval, Kind, Law, Moduli, fragment, read_bytes};

const MASTER: &str = "tests/data/prony/master.csv";

fn table(text: &str) -> Moduli {
    read_bytes(Path::new("table.csv"), text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// Frequencies over so many decades from 1 Hz.
fn frequencies(decades: f64, rows: usize) -> impl Iterator<Item = f64> {
    (0..rows).map(move |i| 10f64.powf(decades * i as f64 / (rows - 1) as f64))
}

/// A table of complex moduli in MPa against Hz.
fn dynamic(decades: f64, rows: usize, mut modulus: impl FnMut(f64) -> (f64, f64)) -> String {
    let row = |f: f64| {
        let (storage, loss) = modulus(TAU * f);
        format!("{f:.17e},{storage:.17e},{loss:.17e}\n")
    };
    String::from("frequency_hz,storage_mpa,loss_mpa\n") + &frequencies(decades, rows).map(row).collect::<String>()
}

/// The closed form of a generalised Maxwell solid of (modulus, time).
fn maxwell(elastic: f64, terms: &[(f64, f64)], omega: f64) -> (f64, f64) {
    terms.iter().fold((elastic, 0.0), |(storage, loss), (modulus, time)| {
        let q = omega * time;
        (storage + modulus * q * q / (1.0 + q * q), loss + modulus * q / (1.0 + q * q))
    })
}

/// Numbers of a normal distribution, from twelve of a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

#[test]
fn a_series_is_recovered_with_its_terms_where_there_is_no_noise() {
    let terms: Vec<(f64, f64)> = [3.0, 1.0, 4.0, 1.5, 9.0]
        .into_iter()
        .enumerate()
        .map(|(j, modulus)| (modulus, 1.0 / (TAU * 10f64.powf(1.25 * j as f64))))
        .collect();
    let analysis = Analysis::of(table(&dynamic(5.0, 61, |omega| maxwell(2.0, &terms, omega))));
    assert_eq!(analysis.terms(), 5, "{:?}", analysis.scores);
    for (amount, modulus) in analysis.series.amounts.iter().zip(std::iter::once(2.0).chain(terms.iter().map(|t| t.0))) {
        assert!((amount.value / (1e6 * modulus) - 1.0).abs() < 1e-9, "{amount:?} {modulus}");
    }
    assert!(analysis.moduli.rms(&analysis.series.fitted).iter().all(|rms| *rms < 1e-10));
    assert!(analysis.remarks.is_empty(), "{:?}", analysis.remarks);
}

/// Whatever the times are and however noisy: no more terms than there are, which leave the noise, and no word against
/// the moduli.
#[test]
fn relaxations_anywhere_in_the_band_are_found_with_their_times() {
    let mut noise = Noise(11);
    for (number, decades) in [(0, 4.0), (1, 4.0), (2, 3.0), (3, 5.0), (4, 4.0)] {
        let times = [0.12 + 0.06 * f64::from(number), 0.62 + 0.05 * f64::from(number)];
        let terms = times.map(|share| 1.0 / (TAU * 10f64.powf(decades * share)));
        let text = dynamic(decades, 41, |omega| {
            let (storage, loss) = maxwell(1.0, &[(2.0, terms[0]), (3.0, terms[1])], omega);
            (storage * (1.0 + 0.01 * noise.normal()), loss * (1.0 + 0.01 * noise.normal()))
        });
        let analysis = Analysis::of(table(&text));
        assert_eq!(analysis.terms(), 2, "{number}: {:?}", analysis.scores);
        for (found, time) in analysis.times().iter().zip(terms) {
            assert!((found / time).ln().abs() < 0.1, "{number}: {:?} {terms:?}", analysis.times());
        }
        assert!(analysis.moduli.rms(&analysis.series.fitted).iter().all(|rms| *rms < 0.015), "{number}");
        assert!(analysis.remarks.is_empty(), "{number}: {:?}", analysis.remarks);
    }
}

#[test]
fn the_exponent_of_a_spring_pot_lies_in_its_interval_as_often_as_it_says() {
    let mut noise = Noise(7);
    let (mut inside, mut told) = (0, 0);
    const CASES: usize = 40;
    for _ in 0..CASES {
        let (a, elastic, amount) = (0.1 + 0.7 * noise.uniform(), noise.uniform(), 0.3 + noise.uniform());
        let text = dynamic(3.0, 40, |omega| {
            let size = amount * (omega / (TAU * 31.0)).powf(a);
            let (sin, cos) = (std::f64::consts::FRAC_PI_2 * a).sin_cos();
            let mut scatter = |value: f64| value * (0.02 * noise.normal()).exp();
            (scatter(elastic + size * cos), scatter(size * sin))
        });
        let analysis = Analysis::of(table(&text));
        inside += usize::from(analysis.exponent.low <= a && a <= analysis.exponent.high);
        told += usize::from(analysis.spring_pot.score.mean < 2.0 * 0.02f64.powi(2));
        assert!((analysis.exponent.value - a).abs() < 0.05, "{a}: {:?}", analysis.exponent);
        assert!(analysis.exponent.high - analysis.exponent.low < 0.2, "{a}: {:?}", analysis.exponent);
    }
    println!("{inside} of {CASES} exponents in their intervals");
    // 38 of 40 are expected; fewer than 34 has a probability below 2 %.
    assert!(inside >= 34, "{inside} of {CASES}");
    assert_eq!(told, CASES, "blocks that were left out are missed by the noise");
}

#[test]
fn the_units_of_a_table_change_nothing() {
    let text = std::fs::read_to_string(MASTER).unwrap();
    let mut rows = text.lines().skip(2).step_by(4).collect::<Vec<_>>();
    let mega = Analysis::of(table(&format!("f,E_stor,E_loss\nHz,MPa,MPa\n{}", rows.join("\n"))));
    let converted = |row: &&str| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{:e};{:e};{:e}", 1e6 * cells[2], 1e6 * cells[1], TAU * cells[0]).replace('.', ",")
    };
    rows.reverse();
    let rows: Vec<String> = rows.iter().map(converted).collect();
    let si = Analysis::of(table(&format!("\u{feff}E'' / Pa;E' / Pa;omega_rad_s\n{}", rows.join("\n"))));
    assert_eq!(si.terms(), mega.terms());
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6 || a.abs().max(b.abs()) < 1.0;
    assert!(si.series.amounts.iter().zip(&mega.series.amounts).all(|(a, b)| close(a.value, b.value)));
    assert!(si.scores.iter().zip(&mega.scores).all(|(a, b)| close(1e9 * a.mean, 1e9 * b.mean)));
    assert!(close(si.exponent.value, mega.exponent.value) && close(si.exponent.low, mega.exponent.low));
    assert_eq!(si.remarks, mega.remarks);
}

/// Relative root mean square errors (storage, loss) of pyvisco 2.1.3 by the number of terms, with fixed and with fitted
/// relaxation times, as `tests/data/prony/errors.py` prints them (pip install pyvisco==2.1.3; python errors.py).
const PYVISCO: [(usize, [(f64, f64); 2]); 4] = [
    (5, [(3.5957, 2.5416), (0.2364, 0.8535)]),
    (10, [(0.3657, 0.8722), (0.0843, 0.6009)]),
    (15, [(0.1091, 0.6394), (0.0391, 0.5389)]),
    (20, [(0.0547, 0.6318), (0.0237, 0.5239)]),
];

#[test]
fn a_measured_master_curve_is_missed_by_less_than_by_another_package() {
    let moduli = stickslip::prony::read(Path::new(MASTER)).unwrap();
    assert_eq!((moduli.kind, moduli.points.len()), (Kind::Dynamic, 206));
    let both = |storage: f64, loss: f64| (0.5 * (storage * storage + loss * loss)).sqrt();
    for (terms, theirs) in PYVISCO {
        let rms = moduli.rms(&Law::series(terms, &moduli).fit(&moduli, &moduli.points));
        println!("{terms} terms: storage {:.4} loss {:.4}, pyvisco {theirs:?}", rms[0], rms[1]);
        for (storage, loss) in theirs {
            assert!(
                both(rms[0], rms[1]) < 1.001 * both(storage, loss),
                "{terms} terms: {rms:?}, pyvisco {storage} {loss}"
            );
        }
    }
    let analysis = Analysis::of(moduli);
    println!("{} terms chosen, {:?}", analysis.terms(), analysis.series.score);
    assert!((12..=30).contains(&analysis.terms()), "{}", analysis.terms());
    assert!(analysis.remarks.iter().any(|remark| remark.contains("contradict")), "{:?}", analysis.remarks);
    assert!(analysis.spring_pot.score.mean > 2.0 * analysis.series.score.mean);
    let contact = Contact::nearest(&analysis, (50.0, 100.0)).unwrap();
    assert!(contact.rms.iter().all(|rms| *rms < 0.01), "{contact:?}");
    let drawing = stickslip::figures::prony::draw(&analysis, Some(&contact)).unwrap();
    layout::check_drawing("master", &drawing);
    let measured = layout::rows(&drawing).into_iter().filter(|row| row[1] == "measured");
    assert_eq!(measured.count(), 2 * 206);
}

#[test]
fn relaxation_and_creep_are_those_of_the_solid_that_has_the_modulus() {
    // Times and amounts of a standard linear solid in its three closed forms.
    let (e0, e1, tau) = (2.0, 3.0, 0.5);
    let (retardation, glassy) = (tau * (e0 + e1) / e0, 1.0 / (e0 + e1));
    // The time lies in the middle of the band, where every series with an odd number of terms has one.
    let times = |middle: f64, f: fn(f64, [f64; 4]) -> f64| {
        let at = [e0, e1, tau, retardation];
        let times = (0..60).map(|i| middle * 10f64.powf(-2.0 + 4.0 * f64::from(i) / 59.0));
        times.map(|t| format!("{t:.17e}\t{:.17e}\n", f(t, at))).collect::<String>()
    };
    let relaxation = times(tau, |t, [e0, e1, tau, _]| e0 + e1 * (-t / tau).exp());
    let creep = times(retardation, |t, [e0, e1, _, late]| {
        1.0 / (e0 + e1) + (1.0 / e0 - 1.0 / (e0 + e1)) * -(-t / late).exp_m1()
    });
    let analysis = Analysis::of(table(&format!("time_s\trelaxation_mpa\n{relaxation}")));
    assert_eq!(analysis.moduli.kind, Kind::Relaxation);
    let near = |analysis: &Analysis, what: &str| {
        for omega in [0.5, 2.0, 8.0] {
            let modulus = analysis.series.fitted.modulus(analysis.moduli.kind, omega);
            let (storage, loss) = maxwell(1e6 * e0, &[(1e6 * e1, tau)], omega);
            let off = (modulus.re / storage - 1.0).abs().max((modulus.im / loss - 1.0).abs());
            assert!(off < 1e-6, "{what} {omega}: {modulus} {storage} {loss}");
        }
    };
    near(&analysis, "relaxation");
    let analysis = Analysis::of(table(&format!("t / s\tcompliance_1_mpa\n{creep}")));
    assert_eq!(analysis.moduli.kind, Kind::Creep);
    assert!(analysis.series.amounts[0].value < 1e-6 * 1.001 * glassy);
    near(&analysis, "creep");
    layout::check_drawing("creep", &stickslip::figures::prony::draw(&analysis, None).unwrap());
}

#[test]
fn what_the_data_cannot_tell_is_said() {
    let said = |text: &str| Analysis::of(table(text)).remarks.join("\n");
    let mut noise = Noise(3);
    let mut scatter = |value: f64| value * (0.01 * noise.normal()).exp();
    let structural = said(&dynamic(0.15, 30, |_| (scatter(5.0), scatter(0.3))));
    assert!(structural.contains("structural damping") && structural.contains("one relaxation"), "{structural}");
    let mut pot =
        |omega: f64| (scatter(3.0 * omega.powf(0.2)), scatter(3.0 * omega.powf(0.2) * (0.1 * TAU / 2.0).tan()));
    let pot = said(&dynamic(3.0, 40, &mut |omega| pot(omega)));
    assert!(pot.contains("spring-pot, three numbers"), "{pot}");
    let contradiction = said(&dynamic(4.0, 40, |omega| (5.0 * omega.powf(0.01), 4.0)));
    assert!(contradiction.contains("contradict each other"), "{contradiction}");
}

const RIG: &str = r#"title = "A rubber on a rig"
[rig]
kind = "oscillator"
mass = "2 kg"
natural_frequency = "80 Hz"
quality_factor = 300
drive = "force"
[sweep]
frequency = { from = "60 Hz", to = "100 Hz", points = 5 }
drive = "1 N"
"#;

#[test]
fn the_fragment_is_a_contact_whose_stiffness_is_the_modulus_times_the_geometry() {
    let analysis = Analysis::of(table(&dynamic(4.0, 60, |omega| maxwell(2.0, &[(3.0, 1.0 / (TAU * 100.0))], omega))));
    let contact = Contact::nearest(&analysis, (60.0, 100.0)).unwrap();
    for (factor, scale) in [(Some(0.02), 0.02), (None, 1.0 / contact.elastic)] {
        let text = fragment(&analysis, &contact, factor);
        let text = text.replace("\n[contact]\n", "\nspeed = 0\nload = 20\n[contact]\nfriction = 0.5\n");
        let text = format!("{RIG}{text}");
        let scenario =
            stickslip::scenario::load_text("rig.toml", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let contact = scenario.contact.unwrap();
        let [effect] = &scenario.effects[..] else { panic!("{text}") };
        assert_eq!(effect.name(), "maxwell-branch");
        for omega in [TAU * 60.0, TAU * 100.0] {
            let q = omega * effect.parameters[1];
            let stiffness = contact.stiffness + effect.parameters[0] * q * q / (1.0 + q * q);
            let loss = omega * contact.damping + effect.parameters[0] * q / (1.0 + q * q);
            let (e, l) = maxwell(2e6, &[(3e6, 1.0 / (TAU * 100.0))], omega);
            assert!((stiffness / (scale * e) - 1.0).abs() < 0.01 && (loss / (scale * l) - 1.0).abs() < 0.02, "{text}");
        }
        assert_eq!(factor.is_none(), (contact.stiffness - 1.0).abs() < 1e-12, "{text}");
    }
    let rows = (1..9).map(|t| format!("{t},5\n")).collect::<String>();
    let elastic = Analysis::of(table(&format!("time_s,relaxation_mpa\n{rows}")));
    let nearest = Contact::nearest(&elastic, (0.05, 0.1)).unwrap();
    assert!((nearest.elastic + nearest.branches[0].amount - 5e6).abs() < 1e4 && nearest.viscous < 1.0, "{nearest:?}");
    assert!(!fragment(&elastic, &nearest, None).contains("NaN"));
    let why = Contact::nearest(&analysis, (1e5, 2e5)).unwrap_err();
    assert!(why.contains("100 to 200 kHz") || why.contains("100 kHz to 200 kHz"), "{why}");
}

/// Three relaxations over eight decades need three branches; at 1 % noise one octave of them needs one.
#[test]
fn a_contact_has_as_many_branches_as_its_band_needs() {
    let terms = [(3.0, 0.1), (2.0, 1e-3), (4.0, 1e-5)];
    let mut noise = Noise(7);
    let mut off = || 1.0 + 0.01 * noise.normal();
    let noisy = |omega: f64| {
        let (storage, loss) = maxwell(2.0, &terms, omega);
        (storage * off(), loss * off())
    };
    let analysis = Analysis::of(table(&dynamic(8.0, 120, noisy)));
    let known = analysis.moduli.band();
    for (band, count) in [((known.0 / TAU, known.1 / TAU), 3), ((60.0, 100.0), 1)] {
        let contact = Contact::nearest(&analysis, band).unwrap();
        assert_eq!(contact.branches.len(), count, "{contact:?}");
        assert!(contact.branches.windows(2).all(|pair| pair[0].amount >= pair[1].amount), "{contact:?}");
        let text = fragment(&analysis, &contact, Some(0.02));
        let text = text.replace("\n[contact]\n", "\nspeed = 0\nload = 20\n[contact]\nfriction = 0.5\n");
        let scenario = stickslip::scenario::load_text("rig.toml", &format!("{RIG}{text}")).unwrap();
        let names: Vec<&str> = scenario.effects.iter().map(|effect| effect.name()).collect();
        assert_eq!(names, ["maxwell-branch", "maxwell-branch-2", "maxwell-branch-3"][..count]);
        for place in 0..=20 {
            let omega = TAU * band.0 * (band.1 / band.0).powf(f64::from(place) / 20.0);
            let of: Vec<(f64, f64)> = scenario.effects.iter().map(|e| (e.parameters[0], e.parameters[1])).collect();
            let stated = scenario.contact.unwrap();
            let (storage, loss) = maxwell(stated.stiffness, &of, omega);
            let (e, l) = maxwell(2e6, &terms.map(|(amount, tau)| (1e6 * amount, tau)), omega);
            let found = (storage / (0.02 * e), (loss + omega * stated.damping) / (0.02 * l));
            assert!((found.0 - 1.0).abs() < 0.02 && (found.1 - 1.0).abs() < 0.04, "{omega}: {found:?} {text}");
        }
    }
}

#[test]
fn tables_are_read_as_laboratories_write_them() {
    let plain = table(&dynamic(2.0, 9, |_| (2.5, 0.5)));
    let rows = |mark: &str, cells: &str| {
        let row = |f: f64| format!("{f:.17e}{mark}{cells}\n").replace('.', ",");
        frequencies(2.0, 9).map(row).collect::<String>()
    };
    for (header, cells, mark) in [
        ("\u{feff}Frequency / Hz;E' / MPa;E'' / MPa", "2.5;0.5", ";"),
        ("Freq (Hz)\tStorage Modulus (MPa)\tLoss Modulus (MPa)", "2.5\t0.5", "\t"),
        ("f [Hz];G′ [kPa];G″ [kPa]", "2500;500", ";"),
        ("FREQUENCY_HZ;STORAGE_KPA;loss_n_mm2", "2500;0.5", ";"),
        ("f;E_stor;E_loss\nHz;N/mm^2;MPa", "2.5;0.5", ";"),
        ("frequency_hz;storage_mpa;tan_delta;remark", "2.5;0.2;ok", ";"),
    ] {
        let read = table(&format!("{header}\n{}", rows(mark, cells)));
        assert_eq!(read.kind, Kind::Dynamic, "{header}");
        for (a, b) in read.points.iter().zip(&plain.points) {
            let off = [a.x / b.x, a.y[0] / b.y[0], a.y[1] / b.y[1]].map(|ratio| (ratio - 1.0).abs());
            assert!(off.iter().all(|off| *off < 1e-12), "{header}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_hostile_table_is_an_error_that_says_where() {
    let good = dynamic(2.0, 9, |_| (2.5, 0.5));
    let line = |number: usize, text: &str| {
        let mut lines: Vec<&str> = good.lines().collect();
        lines[number - 1] = text;
        lines.join("\n")
    };
    let twice = good.lines().enumerate().map(|(at, row)| format!("{},{row}\n", if at == 0 { "E' [MPa]" } else { "1" }));
    let twice = twice.collect::<String>();
    for (text, says) in [
        (
            line(1, "speed,storage_mpa,loss_mpa"),
            &["`speed`, `storage_mpa`, `loss_mpa`", "frequency_hz,storage_mpa,loss_mpa", "t.csv:1:1"][..],
        ),
        (line(1, "frequency_hz,storage,loss_mpa"), &["states no unit", "storage_mpa", "t.csv:1:14"]),
        (line(1, "frequency_hz,storage_mpa,loss [N]"), &["a force", "t.csv:1:26"]),
        (line(1, "frequency_hz,storage_mpa [kPa],loss_mpa"), &["different units"]),
        (twice, &["two columns hold the same quantity"]),
        (line(3, "1.8,2.5,-0.5"), &["`-0.5` is not more than zero", "t.csv:3:9"]),
        (line(3, "1.8,NaN,0.5"), &["`NaN` is not a finite number", "t.csv:3:5"]),
        (line(3, "1.8,,0.5"), &["the cell is empty"]),
        (line(3, "1.8,1e400,0.5"), &["`1e400`"]),
        (line(3, "0,2.5,0.5"), &["not more than zero"]),
        (line(3, "1.8,2.5"), &["1 cell missing"]),
        (line(3, "1.8,1e-300,0.5"), &["differ by more"]),
        (good.lines().take(5).collect::<Vec<_>>().join("\n"), &["only 4 different"]),
        (String::new(), &["is empty"]),
        ("frequency_hz,storage_mpa,loss_mpa\n".into(), &["no rows"]),
        ("\0\u{1}".into(), &["binary"]),
        (format!("{good}{}", "3,2.5,0.5\n".repeat(2000)), &["at most 2000"]),
        (good.lines().skip(1).collect::<Vec<_>>().join("\n"), &["no header", "of moduli"]),
    ] {
        let error = read_bytes(Path::new("t.csv"), text.as_bytes()).map(|moduli| moduli.points).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        let error = error.to_string();
        assert!(says.iter().all(|say| error.contains(say)), "{says:?}\n{error}");
    }
}

/// Bytes changed at random end in an error or in a table whose analysis is made of numbers.
#[test]
fn damaged_tables_make_no_panic_and_no_broken_number() {
    let mut noise = Noise(11);
    let rows = (1..9).map(|t| format!("{t};{},5\n", 20 - t)).collect::<String>();
    let seeds = [
        dynamic(2.0, 9, |omega| maxwell(2.0, &[(3.0, 0.01)], omega)),
        format!("t / s;E(t) / MPa\n{rows}"),
        format!("time_s;compliance_1_gpa\n{rows}"),
    ];
    let mut read = 0;
    for number in 0..1500 {
        let mut bytes = seeds[number % seeds.len()].clone().into_bytes();
        for _ in 0..1 + number % 4 {
            let (at, other) = ((noise.uniform() * bytes.len() as f64) as usize, (noise.uniform() * 256.0) as u8);
            let digit = b"0123456789,;.eE-\n\"'"[other as usize % 19];
            bytes[at] = if number % 2 == 0 { digit } else { other };
        }
        let Ok(moduli) = read_bytes(Path::new("t.csv"), &bytes) else { continue };
        read += 1;
        let analysis = Analysis::of(moduli);
        let ends = analysis.series.amounts.iter().chain([&analysis.exponent]).flat_map(|i| [i.value, i.low, i.high]);
        assert!(ends.into_iter().all(f64::is_finite), "{}", String::from_utf8_lossy(&bytes));
        let (low, high) = analysis.moduli.band();
        let contact = Contact::nearest(&analysis, (low / TAU, high / TAU)).unwrap();
        assert!(
            contact.elastic > 0.0 && contact.branches.iter().all(|b| b.amount.is_finite() && b.time > 0.0),
            "{contact:?}"
        );
        stickslip::figures::prony::draw(&analysis, Some(&contact)).unwrap();
    }
    assert!(read > 100, "{read}");
}

#[test]
fn extreme_numbers_make_no_panic_and_no_broken_number() {
    for (decades, size) in [(0.1, 1e-290), (90.0, 1.0), (3.0, 1e200), (0.001, 1.0)] {
        let text = dynamic(decades, 12, |omega| (size * (1.0 + 1.0 / (1.0 + 1.0 / omega)), size * 1e-3));
        let analysis = Analysis::of(table(&text));
        let amounts = analysis.series.amounts.iter().chain(&analysis.spring_pot.amounts).chain([&analysis.exponent]);
        let finite = |i: &Interval| [i.value, i.low, i.high].iter().all(|end| end.is_finite());
        assert!(amounts.into_iter().all(finite), "{decades} {size}: {analysis:?}");
        let (low, high) = analysis.moduli.band();
        let contact = Contact::nearest(&analysis, (low / TAU, high / TAU)).unwrap();
        assert!(contact.branches.iter().all(|b| b.amount.is_finite() && b.time > 0.0), "{decades} {size}: {contact:?}");
    }
}

#[test]
fn the_command_writes_its_files_and_replaces_no_other() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    write("rubber.csv", &dynamic(4.0, 30, |omega| maxwell(2.0, &[(3.0, 1.0 / (TAU * 100.0))], omega)));
    write("rig.toml", RIG);
    let run = |arguments: &str| {
        let mut command = Command::cargo_bin("stickslip").unwrap();
        command
            .current_dir(dir.path())
            .env("XDG_CACHE_HOME", dir.path())
            .arg("prony")
            .args(arguments.split_whitespace());
        command.assert()
    };
    let all = "rubber.csv --geometry 20mm --scenario rig.toml --out results --json rubber.json";
    run(all).success().stdout(contains("one maxwell-branch").and(contains("spring-pot: a =")));
    let read = |name: &str| std::fs::read(dir.path().join(name)).unwrap();
    let names = ["svg", "png", "csv"].map(|end| format!("results/rubber/moduli.{end}"));
    let names = names.iter().map(String::as_str).chain(["results/rubber/effects.toml", "rubber.json"]);
    let before: Vec<Vec<u8>> = names.clone().map(read).collect();
    run(&format!("{all} --threads 1")).success();
    assert!(before == names.map(read).collect::<Vec<_>>(), "the same bytes for any number of threads");
    run("rubber.csv --geometry 20N").code(2).stderr(contains("a length"));
    run("rubber.csv --json rig.toml").code(2).stderr(contains("is not overwritten"));
    write("results/rubber/effects.toml", "mine");
    run(all).code(2).stderr(contains("is not overwritten"));
    assert_eq!(read("results/rubber/effects.toml"), b"mine");
    write("fast.toml", &RIG.replace("60 Hz", "60 MHz").replace("100 Hz", "90 MHz"));
    run("rubber.csv --scenario fast.toml").code(2).stderr(contains("nothing is determined outside the band"));
}
