//! A rig that is another one from series to series: tables from the closed form of a linear resonance, through the
//! search and back.

use std::fmt::Write as _;
use std::path::Path;
use stickslip::discover::{Candidates, Discovery, SearchOptions, Verdict, discover, fit_addition};
use stickslip::effects;
use stickslip::measurement::{self, Table};
use stickslip::scenario::{self, Scenario};

/// Stiffness and gain of every series beside those of the first.
const CHANGES: [(f64, f64); 3] = [(0.0, 0.0), (0.012, -0.06), (-0.02, 0.11)];
const RIG: &str = "title = \"t\"\n[rig]\nkind = \"oscillator\"\nmass = \"2 kg\"\nnatural_frequency = \"80 Hz\"\nquality_factor = 50\n\
    drive = \"force\"\n[measurement]\nfile = \"t.csv\"\n[fit]\nfree = [\"rig.mass\", \"rig.natural_frequency\", \"rig.quality_factor\"]\n";

/// So many of the series, at one drive, with one percent of noise.
fn written(folder: &Path, series: usize) -> (Scenario, Table) {
    let linear = |(d, g): (f64, f64), ratio: f64| ((1.0 + d - ratio * ratio) / (1.0 + g), ratio / 50.0 / (1.0 + g));
    tabled(folder, series, |number, ratio| (1.0, linear(CHANGES[number], ratio)))
}

/// So many series of a level of the drive and the real and imaginary part of drive over motion, each in units of those at
/// rest, by number of the series and frequency over 80 Hz.
fn tabled(folder: &Path, series: usize, of: impl Fn(usize, f64) -> (f64, (f64, f64))) -> (Scenario, Table) {
    let mut text =
        String::from("series,frequency_hz,force_n,amplitude_m,phase_rad,amplitude_sd_percent,phase_sd_rad\n");
    let mut row = 0_u32;
    for number in 0..series {
        for step in 0..41 {
            let ratio = 1.0 + 0.002 * (f64::from(step) - 20.0);
            let (level, (re, im)) = of(number, ratio);
            let noise = |of: u32| {
                let sum: f64 = (0..12).map(|i| f64::from(sobol_burley::sample(row, 12 * of + i, 5))).sum();
                0.01 * (sum - 6.0)
            };
            let amplitude = 1e-5 * level / re.hypot(im) * (1.0 + noise(0));
            let phase = -im.atan2(re) + noise(1);
            let force = level * 1e-5 * 2.0 * (std::f64::consts::TAU * 80.0).powi(2);
            writeln!(text, "{number},{:.6},{force:.8e},{amplitude:.8e},{phase:.7},1,0.01", 80.0 * ratio).unwrap();
            row += 1;
        }
    }
    std::fs::write(folder.join("t.csv"), text).unwrap();
    std::fs::write(folder.join("t.toml"), RIG).unwrap();
    let scenario = scenario::load(folder.join("t.toml")).unwrap();
    let table = measurement::load(&scenario).unwrap().unwrap();
    (scenario, table)
}

fn asked(scenario: &Scenario, table: &Table) -> Discovery {
    let candidates = Candidates::of(&["drift"], &[]).unwrap();
    discover(scenario, table, &SearchOptions { candidates, ..SearchOptions::default() })
}

#[test]
fn a_drift_is_found_with_the_numbers_of_every_series_and_predicts_none_that_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, table) = written(folder.path(), 3);
    let found = discover(&scenario, &table, &SearchOptions::default());
    assert_eq!(found.verdict, Verdict::EffectMissing, "{:?}", found.notes);
    let last = found.steps.last().unwrap();
    assert_eq!(last.hypothesis.label(), "drift");
    for (number, (d, g)) in CHANGES.iter().enumerate().skip(1) {
        for (key, truth) in [("d", d), ("g", g)] {
            let key = format!("effect.drift.{key}_{}", number + 1);
            let place = last.comparison.fit.parameters.iter().position(|p| p.key == key).unwrap();
            let interval = last.comparison.intervals[place];
            assert!(interval.low < *truth && *truth < interval.high, "{key} {truth}: {interval:?}");
        }
    }
    // What a fourth series will have nobody knows.
    assert!(found.next_measurement.is_none());
    let (held_out, own) = (last.held_out.unwrap(), &last.comparison.overall);
    assert!(own.chi2_per_point < 1.3 && held_out.chi2_per_point > 30.0, "{held_out:?} {own:?}");
}

#[test]
fn a_drift_that_is_added_by_hand_has_as_many_numbers_as_there_are_series() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, table) = written(folder.path(), 3);
    let drift = effects::for_series(effects::find("drift").unwrap(), table.series.len()).unwrap();
    let change = fit_addition(&scenario, &table, drift, 0);
    assert_eq!(change.decided(), Some(true));
    assert_eq!(change.after.fit.parameters.iter().filter(|p| p.key.starts_with("effect.drift.")).count(), 4);
    // As it is read again: with numbers of nine series, of which those that there are count.
    let text = format!(
        "{}, \"effect.drift.d_2\"]\n[[effect]]\nname = \"drift\"\nd_2 = 0.012\n",
        RIG.trim_end().trim_end_matches(']')
    );
    std::fs::write(folder.path().join("again.toml"), text).unwrap();
    let again = scenario::load(folder.path().join("again.toml")).unwrap();
    assert_eq!((again.effects[0].parameters.len(), table.applied_to(&again).effects[0].parameters.len()), (16, 4));
}

#[test]
fn of_one_series_no_drift_is_searched_and_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, table) = written(folder.path(), 1);
    let found = asked(&scenario, &table);
    let said =
        "drift was asked for and is not searched: `drift` has numbers of each of 2 to 9 series, and the table has 1";
    assert!(found.notes.iter().any(|note| note == said), "{:?}", found.notes);
    let (scenario, table) = written(folder.path(), 2);
    assert!(!asked(&scenario, &table).notes.iter().any(|note| note.contains("asked for")));
}

/// Levels of the drive, each of a series that has drifted.
const LEVELS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

#[test]
fn a_gain_that_alone_follows_the_drive_is_told_as_no_other_rig() {
    let folder = tempfile::tempdir().unwrap();
    let told = |gains: [f64; 4], d: f64| {
        let (scenario, table) = tabled(folder.path(), LEVELS.len(), |number, ratio| {
            let stiff = 1.0 + d * number as f64 - ratio * ratio;
            (LEVELS[number], (stiff / (1.0 + gains[number]), ratio / 50.0 / (1.0 + gains[number])))
        });
        let found = asked(&scenario, &table);
        let label = found.steps.last().unwrap().hypothesis.label();
        assert_eq!(label, "drift", "{gains:?} {d}: {:?}", found.notes);
        found.notes.iter().find(|note| note.contains("only the gain differs")).cloned()
    };
    let falls = told([0.0, -0.04, -0.09, -0.2], 0.0).unwrap();
    assert!(falls.contains("it falls with the drive"), "{falls}");
    let rises = told([0.0, 0.04, 0.09, 0.2], 0.0).unwrap();
    assert!(rises.contains("it rises with the drive"), "{rises}");
    // One that does not follow it, and a rig that is another one as well.
    let other = told([0.0, -0.09, -0.04, -0.2], 0.0).unwrap();
    assert!(other.contains("range or sensitivity"), "{other}");
    assert_eq!(told([0.0, -0.04, -0.09, -0.2], 0.01), None);
}

#[test]
fn a_damping_that_drifted_with_the_rest_is_no_law_of_the_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    let losses = [0.02, 0.021, 0.0226, 0.0235];
    let (scenario, table) = tabled(folder.path(), LEVELS.len(), |number, ratio| {
        let d = [0.0, 0.004, -0.003, 0.007][number];
        (LEVELS[number], (1.0 + d - ratio * ratio, ratio * losses[number]))
    });
    let found = discover(&scenario, &table, &SearchOptions::default());
    let label = found.steps.last().unwrap().hypothesis.label();
    assert!(label.contains("drift") && label.contains("damping"), "{label}");
    assert_eq!(found.verdict, Verdict::Unexplained, "{label}: {:?}", found.notes);
    let said = stickslip::discover::sentence(&found);
    assert!(said.contains("a rig of its own in every series"), "{said}");
}

/// What is found of a spring that hardens with the square of the amplitude in series of these levels and stiffnesses.
fn hardening(levels: [f64; 4], stiffness: [f64; 4]) -> Discovery {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, table) = tabled(folder.path(), levels.len(), |number, ratio| {
        let (d, level) = (stiffness[number], levels[number]);
        // Of one harmonic: the amplitude at which drive over motion is as large as it has to be.
        let of = |a: f64| (1.0 + d + 6e-8 * a * a - ratio * ratio, ratio / 50.0);
        let (mut low, mut high) = (0.0, 1e3);
        for _ in 0..200 {
            let a = 0.5 * (low + high);
            let (re, im) = of(a);
            if a * re.hypot(im) < level { low = a } else { high = a }
        }
        (level, of(low))
    });
    let found = discover(&scenario, &table, &SearchOptions::default());
    let names: Vec<String> = found.steps.last().unwrap().hypothesis.effects();
    assert_eq!(found.verdict, Verdict::EffectMissing, "{names:?} {:?}", found.notes);
    assert!(
        names.iter().any(|name| name == "drift") && names.iter().any(|name| name.contains("stiffness")),
        "{names:?}"
    );
    found
}

#[test]
fn a_spring_that_hardens_within_the_series_is_named_beside_a_drift() {
    hardening(LEVELS, [0.0, 0.004, -0.003, 0.007]);
}

#[test]
fn a_drift_between_two_sweeps_at_one_drive_is_no_law_of_the_amplitude() {
    let found = hardening([1.0, 4.0, 2.0, 1.0], [0.0, -0.004, -0.008, -0.012]);
    let tied: Vec<&String> = found.indistinguishable.iter().flatten().collect();
    assert!(!tied.iter().any(|name| name.contains("amplitude")), "{tied:?}");
}
