//! Tables of rigs without a contact, as laboratories have them: what a new user does, and the same physics at any size.

use std::fs;
use std::path::{Path, PathBuf};
use stickslip::discover::{Basis, Candidate, Discovery, SearchOptions, Verdict, discover, sentence};
use stickslip::fit::Identified;
use stickslip::{measurement, scenario};

fn table(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/oscillators").join(name).with_extension("csv")
}

/// `stickslip new TABLE -o SCENARIO`.
fn new(table: &Path, scenario: &Path) {
    assert_cmd::Command::cargo_bin("stickslip")
        .expect("built")
        .args(["new", "--quiet"])
        .arg(table)
        .arg("-o")
        .arg(scenario)
        .assert()
        .success();
}

fn found(path: &Path) -> Discovery {
    let scenario = scenario::load(path).unwrap_or_else(|error| panic!("{error}"));
    let table = measurement::load(&scenario).unwrap_or_else(|error| panic!("{error}")).expect("measurements");
    discover(&scenario, &table, &SearchOptions::default())
}

/// A table with nothing but frequency, drive and reading: `new`, then `discover`, without an edit.
#[test]
fn what_the_generator_hid_is_found_from_the_table_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        ("a", Verdict::EffectMissing, &["cubic-stiffness"][..]),
        ("b", Verdict::EffectMissing, &["friction-joint"]),
        ("c", Verdict::NothingMissing, &[]),
        ("d", Verdict::EffectMissing, &["quadratic-damping"]),
        // The eight starting points that a linear estimate likes best all lie where the joint never slips as a whole.
        ("slip", Verdict::EffectMissing, &["friction-joint"]),
        // Elements that all slip at once: the exponent ends at its bound, where the other numbers must go on.
        ("corner", Verdict::EffectMissing, &["friction-joint", "cubic-stiffness"]),
        // Neither does any good alone: what softens slips, and what slips hardens.
        ("together", Verdict::EffectMissing, &["cubic-stiffness", "friction-joint"]),
        // A spring that softens to one side, by an integrator of its own: a cubic one does nearly as well, and is raced
        // first.
        ("rivals", Verdict::EffectMissing, &["asymmetric-stiffness"]),
        // Volts of a velocity: as a displacement, residual modes or crosstalk would seem to be missing.
        ("velocity", Verdict::NothingMissing, &[]),
    ];
    for (name, verdict, effects) in cases {
        let path = folder.path().join(name).with_extension("toml");
        new(&table(name), &path);
        let d = found(&path);
        let (mut named, mut hidden) = (d.explanation().hypothesis.effects(), effects.to_vec());
        named.sort();
        hidden.sort();
        assert_eq!((d.verdict, named), (verdict, hidden.iter().map(|e| (*e).into()).collect()), "{name}");
        assert!(d.explanation().comparison.overall.chi2_per_point < 1.5, "{name}");
    }
}

/// Tables with a law that is none of the catalogue (`tests/data/free-form`). Of the second the search finds what lowers
/// the misfit of what is fitted, and says less of another series.
#[test]
fn what_predicts_left_out_series_worse_is_no_part_of_what_helps() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, is_taken_off) in [("01", false), ("02", true), ("14", false)] {
        let path = folder.path().join(name).with_extension("toml");
        new(
            &PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/free-form").join(name).with_extension("csv"),
            &path,
        );
        let d = found(&path);
        assert_eq!(d.verdict, Verdict::Unexplained, "{name}");
        let left_out: Vec<f64> = d.steps.iter().map(|s| s.held_out.expect("several series").chi2_per_point).collect();
        let best = left_out.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(left_out.len() > 1 && left_out[left_out.len() - 1] == best, "{name}: {left_out:?}");
        let why = d.notes.iter().find(|note| note.contains("series that are left out are predicted worse with"));
        assert_eq!(why.is_some(), is_taken_off, "{name}: {:?}", d.notes);
    }
}

/// A resonance whose table states no drive, read relative to a base that moves by the same at all frequencies: taken for
/// a force something seems to be missing, and `new` takes it for a base.
#[test]
fn a_base_that_nothing_states_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let (table, path) = (folder.path().join("t.csv"), folder.path().join("t.toml"));
    let mut noise = noise(0.002);
    let row = |k: u32| {
        let f = 0.7 + 0.01 * f64::from(k);
        let (along, across) = (1.0 - f * f, f / 8.0);
        let amplitude = 20.0 * f * f / along.hypot(across) * (1.0 + noise());
        format!("{f:.2},{amplitude:.5},{:.3}\n", (-across).atan2(along).to_degrees() + 100.0 * noise())
    };
    let rows: String = (0..60).map(row).collect();
    std::fs::write(&table, format!("f [Hz],amplitude [mm],phase [deg]\n{rows}")).expect("a table");
    let new = assert_cmd::Command::cargo_bin("stickslip").expect("built").arg("new").arg(&table).assert().success();
    let said = String::from_utf8(new.get_output().stdout.clone()).expect("text");
    assert!(said.contains("the rig is taken as driven by a base"), "{said}");
    assert_eq!(found(&path).verdict, Verdict::NothingMissing);
    let text = std::fs::read_to_string(&path).expect("a scenario");
    let force = text.replace("drive = \"base\" ", "drive = \"force\" ").replace("V/m", "V/N");
    std::fs::write(&path, force.replace("reading = \"relative\"", "#")).expect("a scenario");
    assert_ne!(found(&path).verdict, Verdict::NothingMissing);
}

/// What follows the amplitudes of one sweep is a law of the amplitude or one of the frequency: without phases, a second
/// drive or two stable states nothing is named.
#[test]
fn one_sweep_of_amplitudes_names_no_law_of_the_amplitude() {
    let folder = tempfile::tempdir().expect("a folder");
    // A hardening spring below its fold, of one harmonic: f0 60 Hz, Q 15.
    let (mut scatter, q, hardening) = (noise(2e-3), 15.0, 0.05);
    let mut rows = Vec::new();
    for n in 0..60 {
        let ratio = (50.0 + 0.35 * f64::from(n)) / 60.0;
        let parts = |a: f64| (1.0 + hardening * a * a - ratio * ratio, ratio / q);
        let mut a = 0.0;
        for _ in 0..200 {
            a = 0.7 * a + 0.3 / (q * parts(a).0.hypot(parts(a).1));
        }
        rows.push((60.0 * ratio, a * (1.0 + scatter()), -parts(a).1.atan2(parts(a).0) + scatter()));
    }
    let verdict = |name: &str, text: String| {
        let csv = folder.path().join(name).with_extension("csv");
        std::fs::write(&csv, text).expect("a table");
        let path = csv.with_extension("toml");
        new(&csv, &path);
        let d = found(&path);
        (d.verdict, stickslip::discover::sentence(&d))
    };
    let alone: String = rows.iter().map(|(f, a, _)| format!("{f},1,{a:.5}\n")).collect();
    let (bare, sentence) = verdict("alone", format!("frequency_hz,force_n,amplitude_mm\n{alone}"));
    assert_eq!(bare, Verdict::Unexplained, "{sentence}");
    assert!(sentence.contains("one sweep without phases does not tell"), "{sentence}");
    let both: String = rows.iter().map(|(f, a, p)| format!("{f},1,{a:.5},{p:.5}\n")).collect();
    let (full, sentence) = verdict("both", format!("frequency_hz,force_n,amplitude_mm,phase_rad\n{both}"));
    assert_eq!(full, Verdict::EffectMissing, "{sentence}");
}

/// The levels of a notch, as an analyser saves them: a flank of a resonance outside the readings leaves less than a
/// peak where the dip is, and yet the search begins at the dip.
#[test]
fn of_a_few_readings_it_is_told_from_how_many_their_noise_is_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let (table, scenario) = (folder.path().join("t.csv"), folder.path().join("t.toml"));
    let row = |(n, scatter): (usize, f64)| {
        let r = 1.0 + 0.004 * (n as f64 - 4.0);
        format!("{:.3},{:.5e}\n", 80.0 * r, 1e-5 * (1.0 + scatter) / (1.0 - r * r).hypot(r / 50.0))
    };
    let scatter = [0.012, -0.02, 0.008, 0.021, -0.014, 0.003, -0.019, 0.016, -0.006];
    let rows: String = scatter.into_iter().enumerate().map(row).collect();
    fs::write(&table, format!("frequency_hz,amplitude_m\n{rows}")).expect("a table");
    new(&table, &scenario);
    let d = found(&scenario);
    let freedom = d.explanation().comparison.table.freedom.round();
    let said = sentence(&d);
    assert!(freedom > 1.0 && said.starts_with("undecided: the series are too short"), "{said}");
    assert!(said.ends_with(&format!("by a noise known from {freedom} degrees of freedom")), "{said}");
    // With deviations that are stated it is known.
    fs::remove_file(&scenario).expect("written");
    fs::write(&table, format!("frequency_hz,amplitude_m,amplitude_sd_percent\n{}", rows.replace('\n', ",1.5\n")))
        .expect("a table");
    new(&table, &scenario);
    let said = sentence(&found(&scenario));
    assert!(!said.contains("degrees of freedom"), "{said}");
}

#[test]
fn a_notch_of_levels_alone_is_a_resonance_beside_a_crosstalk() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("notch.csv");
    let level = |row: i32| {
        let frequency = 5440.0 + 0.4 * f64::from(row);
        let detuning = 2.0 * 1000.0 * (frequency / 5478.0 - 1.0);
        // 1 - 0.6 exp(0.2 i)/(1 + i detuning), read to 0.01 dB.
        let (re, im) = (0.6 * 0.2f64.cos(), 0.6 * 0.2f64.sin());
        let norm = 1.0 + detuning * detuning;
        let rest = (1.0 - (re + im * detuning) / norm).hypot((im - re * detuning) / norm);
        let noise = 0.01 * (f64::from(row * 7919 % 101) / 50.0 - 1.0);
        format!("{frequency},{:.4}\n", 20.0 * rest.log10() - 9.0 + noise)
    };
    std::fs::write(&csv, format!("f [MHz],S21 [dB]\n{}", (0..201).map(level).collect::<String>())).expect("a table");
    let path = folder.path().join("notch.toml");
    new(&csv, &path);
    let found = found(&path);
    let [base, .., last] = &found.steps[..] else { panic!("nothing was found") };
    let note = "the model resonates at ";
    assert!(base.comparison.notes.iter().any(|one| one.starts_with(note)), "{:?}", base.comparison.notes);
    assert_eq!(last.hypothesis.label(), "crosstalk");
    assert!(last.comparison.overall.rms_error_percent < 0.2, "{:?}", last.comparison.overall);
    assert!(!last.comparison.notes.iter().any(|one| one.starts_with(note)), "{:?}", last.comparison.notes);
}

/// The impedance of a loudspeaker: what its coil has at rest, and a resonance of the velocity beside it. Without the
/// former a calibration goes far off the resonance, to where the numbers of the rig reach none of its readings.
#[test]
fn a_resonance_beside_a_resistance_is_found_from_a_calibration_that_went_far_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise(3e-4);
    let impedance = |row: i32| {
        let frequency = 10.0 * 50f64.powf(f64::from(row) / 149.0);
        let detuning = 2.0 * (frequency / 46.0 - 46.0 / frequency);
        let (re, im) = (7.0 + 20.0 / (1.0 + detuning * detuning), -20.0 * detuning / (1.0 + detuning * detuning));
        format!("{frequency:.4} {:.5} {:.4}\n", re.hypot(im) * (1.0 + noise()), (im.atan2(re) + noise()).to_degrees())
    };
    std::fs::write(folder.path().join("coil.zma"), (0..150).map(impedance).collect::<String>()).expect("a table");
    // Nothing of the motion alone explains it: the phase at the resonance says what is read.
    let written = folder.path().join("new.toml");
    new(&folder.path().join("coil.zma"), &written);
    assert!(std::fs::read_to_string(written).expect("a scenario").contains("reading per velocity"));
    let path = folder.path().join("coil.toml");
    let text = "title = 'A coil'
[rig]
kind = 'oscillator'
drive = 'force'
natural_frequency = '43.6 Hz'
quality_factor = 2.3
[instrument]
sensitivity = '2000 V s/m'
drive_sensitivity = '1 V/N'
phase_offset = '0 rad'
[measurement]
file = 'coil.zma'
[fit]
free = ['rig.natural_frequency', 'rig.quality_factor', 'instrument.sensitivity', 'instrument.phase_offset']
";
    std::fs::write(&path, text).expect("a scenario");
    let found = found(&path);
    let [base, .., last] = &found.steps[..] else { panic!("nothing was found") };
    let frequency = |step: &stickslip::discover::Step| step.hypothesis.fit.values[0];
    assert!((frequency(base) / 46.0).ln().abs() > 1.0, "{}", frequency(base));
    assert_eq!((found.verdict, last.hypothesis.label()), (Verdict::EffectMissing, "crosstalk".into()));
    assert!((frequency(last) / 46.0 - 1.0).abs() < 1e-3, "{}", frequency(last));
}

/// Deviates of this standard deviation: sums of twelve uniform ones, normal enough.
fn noise(deviation: f64) -> impl FnMut() -> f64 {
    let mut state = 88_172_645_463_325_252_u64;
    move || {
        let uniform = |_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        deviation * ((0..12).map(uniform).sum::<f64>() - 6.0)
    }
}

/// A voltage that is neither a displacement nor an acceleration, but an acceleration beside a share of the drive: that
/// share makes one of the other, and does not speak for either. The nearer of the two is taken, and the steadier
/// voltage for the drive.
#[test]
fn what_is_read_beside_the_motion_decides_no_kind_of_reading() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("kind.csv");
    let mut noise = noise(0.01);
    let row = |row: i32| {
        let frequency = 3.0 * 20f64.powf(f64::from(row) / 39.0);
        let (ratio, quality) = (frequency / 26.3, 6.0);
        let (re, im) = (1.0 - ratio * ratio, ratio / quality);
        let amplitude = 10.0 * im.hypot(1.0) / re.hypot(im) * (1.0 + noise());
        let phase = im.atan() - im.atan2(re) + noise();
        format!("{frequency:.3},{amplitude:.5},10,{:.3}\n", phase.to_degrees())
    };
    std::fs::write(&csv, format!("f [kHz],U_C [V],U_0 [V],phase [deg]\n{}", (0..40).map(row).collect::<String>()))
        .expect("a table");
    let path = folder.path().join("kind.toml");
    new(&csv, &path);
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.contains("reading per displacement"), "{text}");
    assert!(text.contains("drive = \"U_0 [V]\""), "{text}");
}

/// The impedance of a loudspeaker is a velocity beside a share of the drive, its coil's resistance: nothing that acts on
/// the motion makes that of a displacement or an acceleration.
#[test]
fn what_is_read_beside_the_motion_tells_a_velocity() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("speaker.csv");
    let mut noise = noise(0.005);
    let row = |row: i32| {
        let frequency = 20.0 * 10f64.powf(f64::from(row) / 59.0);
        let detuned = 7.0 * (frequency / 57.7 - 57.7 / frequency);
        let (re, im) = (7.0 + 30.0 / (1.0 + detuned * detuned), -30.0 * detuned / (1.0 + detuned * detuned));
        let amplitude = re.hypot(im) * (1.0 + noise());
        format!("{frequency:.3},{amplitude:.4},{:.3}\n", (im.atan2(re) + noise()).to_degrees())
    };
    std::fs::write(&csv, format!("f [Hz],|Z| [Ohm],phase [deg]\n{}", (0..60).map(row).collect::<String>()))
        .expect("a table");
    let path = folder.path().join("speaker.toml");
    new(&csv, &path);
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.contains("reading per velocity"), "{text}");
    let d = found(&path);
    assert_eq!((d.verdict, d.explanation().hypothesis.label()), (Verdict::EffectMissing, "crosstalk".into()));
}

/// A linear rig whose resonance wavers by a thirtieth of its width from reading to reading: those on the flanks and the
/// phases at the peak scatter more than others, as much as the noise that is estimated says.
#[test]
fn a_resonance_that_wavers_lacks_nothing() {
    let mut noise = noise(1.0);
    for number in 0..2 {
        let d = wavering(&mut noise, 22);
        assert_eq!(d.verdict, Verdict::NothingMissing, "{number}: {:?}", d.explanation().hypothesis.effects());
    }
}

/// The same, where too few readings tell how it wavers: a clearance that follows them predicts no other series. (Of three
/// such tables the third: what the others leave nothing follows.)
#[test]
fn what_follows_larger_scatter_and_predicts_nothing_is_not_missing() {
    let mut noise = noise(1.0);
    let found: Vec<Discovery> = (0..3).map(|_| wavering(&mut noise, 8)).collect();
    assert!(found.iter().all(|d| d.verdict == Verdict::NothingMissing));
    assert!(
        found[2].notes.iter().any(|note| note.contains("predicted no better with clearance")),
        "{:?}",
        found[2].notes
    );
}

/// What is found of a linear rig whose resonance wavers, at two drives, with so many readings on either side of it.
fn wavering(noise: &mut impl FnMut() -> f64, half: i32) -> Discovery {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("wavers.csv");
    let quality = 200.0;
    let mut row = |drive: f64, number: i32| {
        let frequency = 2.0 * (1.0 + f64::from(number) / f64::from(half) * 3.0 / quality);
        let ratio = 0.5 * frequency * (1.0 + 0.03 / quality * noise());
        let (re, im) = (1.0 - ratio * ratio, ratio / quality);
        let amplitude = drive / re.hypot(im) * (1.0 + 0.003 * noise());
        format!("{frequency:.5},{drive},{amplitude:.5},{:.5}\n", 0.003 * noise() - im.atan2(re))
    };
    let rows: String =
        [10.0, 40.0].iter().flat_map(|drive| (-half..=half).map(|n| row(*drive, n)).collect::<Vec<_>>()).collect();
    std::fs::write(&csv, format!("frequency_hz,torque_un_m,amplitude_mrad,phase_rad\n{rows}")).expect("a table");
    let path = folder.path().join("wavers.toml");
    new(&csv, &path);
    found(&path)
}

/// Readings in some huge unit of their own: what `new` writes can be read.
#[test]
fn what_new_writes_of_huge_readings_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise(0.003);
    let mut row = |number: i32| {
        let ratio = 1.0 + 0.002 * f64::from(number);
        let amplitude = 2e19 / (1.0 - ratio * ratio).hypot(ratio / 80.0) * (1.0 + noise());
        format!("{},0.02,{amplitude:e}\n", 40.0 * ratio)
    };
    let rows: String = (-30..=30).map(&mut row).collect();
    for columns in ["drive_g,amplitude_g", "drive_g,amplitude_m", "force_n,amplitude_m"] {
        let csv = folder.path().join(format!("{columns}.csv"));
        std::fs::write(&csv, format!("frequency_hz,{columns}\n{rows}")).expect("a table");
        new(&csv, &csv.with_extension("toml"));
        found(&csv.with_extension("toml"));
    }
}

/// A coil that is wound the other way round reads a velocity with its sign reversed: no acceleration, of which the phase
/// at resonance would be another by a quarter of a turn.
#[test]
fn a_sensor_turned_round_is_none_of_another_kind() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("wire.csv");
    let mut noise = noise(0.003);
    let row = |number: i32| {
        let frequency = 2000.0 + f64::from(number);
        let ratio = frequency / 2030.0;
        let (re, im) = (1.0 - ratio * ratio, ratio / 60.0);
        let phase = std::f64::consts::PI + std::f64::consts::FRAC_PI_2 - im.atan2(re) + 0.1 + noise();
        let (size, turned) = (ratio / re.hypot(im) * (1.0 + noise()), phase);
        format!("{frequency},{:.5e},{:.5e},1\n", 1e-6 * size * turned.cos(), 1e-6 * size * turned.sin())
    };
    let rows: String = (-40..=90).map(row).collect();
    std::fs::write(&csv, format!("f (Hz),X (V),Y (V),drive (V)\n{rows}")).expect("a table");
    let path = folder.path().join("wire.toml");
    new(&csv, &path);
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.contains("reading per velocity"), "{text}");
}

/// Twenty readings of a linear resonance by hand, with the deviations of
/// the meter: what they really scatter by is nine times as much.
#[test]
fn deviations_that_are_stated_too_small_make_nothing_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise(0.09);
    for number in 0..6 {
        let path = folder.path().join(format!("{number}.csv"));
        let row = |row: usize| {
            let frequency = 10.0 + 1.5 * row as f64;
            let ratio = frequency / 26.4;
            let amplitude = 1.8 / (1.0 - ratio * ratio).hypot(0.25 * ratio) * (1.0 + noise());
            format!("{frequency},{amplitude},{}\n", 0.01 * amplitude)
        };
        let rows: String = (0..20).map(row).collect();
        std::fs::write(&path, format!("frequency_hz,amplitude_v,amplitude_sd_v\n{rows}")).expect("written");
        let scenario = path.with_extension("toml");
        new(&path, &scenario);
        let d = found(&scenario);
        assert_ne!(d.verdict, Verdict::EffectMissing, "{number}: {:?}", d.explanation().hypothesis.effects());
    }
}

/// The same of a table in which something is missing: it is found, and the deviations are said to be too small.
#[test]
fn what_is_missing_is_found_beside_deviations_that_are_stated_too_small() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = std::fs::read_to_string(table("a")).expect("a table");
    let path = folder.path().join("a.csv");
    let row = |(number, row): (usize, &str)| match number {
        0 => format!("{row},amplitude_sd_percent\n"),
        _ => format!("{row},0.1\n"),
    };
    std::fs::write(&path, text.lines().enumerate().map(row).collect::<String>()).expect("written");
    let scenario = path.with_extension("toml");
    new(&path, &scenario);
    let d = found(&scenario);
    assert_eq!(
        (d.verdict, d.explanation().hypothesis.effects()),
        (Verdict::EffectMissing, vec!["cubic-stiffness".into()])
    );
    assert!(d.noise.amplitude > 5.0 && d.noise.amplitude < 20.0, "{:?}", d.noise);
}

/// Two sweeps by hand at one drive, no frequency twice, of a rig that was damped four times as much in the second: along
/// the frequency what is left of both alternates. The same rig in both is explained.
#[test]
fn two_sweeps_that_differ_are_never_called_noise() {
    let folder = tempfile::tempdir().expect("a folder");
    for (number, (quality, differ)) in [(7.0, true), (28.0, false)].into_iter().enumerate() {
        for (stated, more) in [("", ""), (",amplitude_sd_percent", ",0.6")] {
            let mut noise = noise(0.006);
            let mut row = |quality: f64, frequency: f64| {
                let ratio = frequency / 0.519;
                let amplitude = 0.06 / (1.0 - ratio * ratio).hypot(ratio / quality) * (1.0 + noise());
                format!("{frequency},{amplitude:.6}{more}\n")
            };
            let places = [0.2, 0.3, 0.4, 0.47, 0.49, 0.51, 0.525, 0.545, 0.585, 0.685, 0.79, 0.9, 1.0];
            let first: String = places.iter().map(|f| row(28.0, *f)).collect();
            let second: String = places.iter().map(|f| row(quality, f - 0.003)).collect();
            let path = folder.path().join(format!("{number}{}.csv", more.len()));
            std::fs::write(&path, format!("f [Hz],amplitude_rad{stated}\n{first}{second}")).expect("written");
            let scenario = path.with_extension("toml");
            new(&path, &scenario);
            let d = found(&scenario);
            assert_eq!(d.verdict == Verdict::NothingMissing, !differ, "{quality} {stated}: {:?}", d.verdict);
        }
    }
}

/// A sharp resonance whose signal comes through a long cable: the phase turns by many times in the readings, and where
/// it is at none is known only from the slope.
#[test]
fn a_long_cable_is_a_delay() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("cable.csv");
    let (quality, resonance, tau) = (1e5, 5.92e9, 40e-9);
    let mut noise = noise(1e-3);
    let row = |row: i32| {
        let frequency = resonance * (1.0 + (f64::from(row) - 100.0) / 20.0 / quality);
        let detuning = 2.0 * quality * (frequency / resonance - 1.0);
        let amplitude = (1.0 + noise()) / detuning.hypot(1.0);
        let phase = 0.4 - detuning.atan() - std::f64::consts::TAU * tau * (frequency - 5e9) + noise();
        format!("{frequency:.1},{:.7},{:.7}\n", amplitude * phase.cos(), amplitude * phase.sin())
    };
    std::fs::write(&csv, format!("f (Hz),S21 real,S21 imag\n{}", (0..201).map(row).collect::<String>()))
        .expect("a table");
    let path = folder.path().join("cable.toml");
    new(&csv, &path);
    let found = found(&path);
    let explanation = found.explanation();
    assert_eq!((found.verdict, explanation.hypothesis.label()), (Verdict::EffectMissing, "sensor-delay".into()));
    let interval = |key: &str| {
        let at =
            explanation.comparison.fit.parameters.iter().position(|p| p.key == key).unwrap_or_else(|| panic!("{key}"));
        &explanation.comparison.intervals[at]
    };
    let delay = interval("effect.sensor-delay.tau");
    assert!(delay.low < tau && tau < delay.high && delay.high - delay.low < 0.05 * tau, "{delay:?}");
    // The slope tells the phase at no frequency to less than a turn.
    assert_eq!(interval("instrument.phase_offset").identified, Identified::No);
}

/// A notch that is narrow beside the readings, a thousand of them and each far better than the misfit: the calibration
/// follows a flank out of the readings, and yet the search begins where they show the dip; a model without a steady
/// state is no way out.
#[test]
fn a_narrow_notch_among_many_readings_is_a_resonance_beside_a_crosstalk() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("narrow.csv");
    let mut noise = noise(2e-5);
    let row = |row: i32| {
        let frequency = 4.22373e9 + 200.0 * f64::from(row);
        let detuning = 2.0 * 2.8e5 * (frequency / 4.223_828e9 - 1.0);
        // 1 - 0.8 exp(0.3 i)/(1 + i detuning), turned.
        let (a, b) = (0.8 * 0.3f64.cos(), 0.8 * 0.3f64.sin());
        let norm = 1.0 + detuning * detuning;
        let (re, im) = (1.0 - (a + b * detuning) / norm, (a * detuning - b) / norm);
        let level = 20.0 * (re.hypot(im) * (1.0 + noise())).log10() - 3.5;
        format!("{frequency},{level:.7},{:.6}\n", (im.atan2(re) + 0.35 + noise()).to_degrees())
    };
    std::fs::write(&csv, format!("f [Hz],S21 [dB],phase [deg]\n{}", (0..1001).map(row).collect::<String>()))
        .expect("a table");
    let path = folder.path().join("narrow.toml");
    new(&csv, &path);
    let found = found(&path);
    let [base, first, ..] = &found.steps[..] else { panic!("nothing was found") };
    assert!(base.comparison.overall.rms_error_percent > 20.0, "{:?}", base.comparison.overall);
    assert_eq!(first.hypothesis.label(), "crosstalk");
    assert!(first.comparison.overall.rms_error_percent < 0.1, "{:?}", first.comparison.overall);
}

/// `discover -o` writes what was found: nothing is missing in it any more, and it compares as the discovery ended.
#[test]
fn what_was_found_is_written_as_a_scenario_that_explains_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let [before, after] = ["before", "after"].map(|name| folder.path().join(name).with_extension("toml"));
    new(&table("volts"), &before);
    let run = || {
        let mut command = assert_cmd::Command::cargo_bin("stickslip").expect("built");
        command.args(["discover", "--quiet"]).arg(&before).arg("-o");
        command
    };
    // A gate of the command line is none of the scenario's.
    run().arg(&after).args(["--max-chi2", "1000"]).assert().success();
    let expected = found(&before);
    let d = found(&after);
    assert_eq!(d.verdict, Verdict::NothingMissing);
    let (there, here) = (&expected.explanation().comparison, &d.steps[0].comparison);
    let effects: Vec<&str> = here.scenario.effects.iter().map(|setting| setting.name()).collect();
    assert_eq!(effects, ["friction-joint"]);
    let chi2 = [there, here].map(|c| c.overall.chi2_per_point);
    assert!((chi2[0] - chi2[1]).abs() < 1e-3 * chi2[0], "{chi2:?}");
    let text = std::fs::read_to_string(&after).expect("a scenario");
    // Measured data are no scenario to write to.
    let measured = std::fs::read(table("volts")).expect("a table");
    run().arg(table("volts")).assert().code(2);
    assert_eq!(std::fs::read(table("volts")).expect("a table"), measured);
    // Nor is the place of another result.
    run().arg("both").args(["--json", "both"]).current_dir(&folder).assert().code(2);
    assert!(!folder.path().join("both").exists());
    // The same again gives the same bytes.
    run().arg(&after).assert().success();
    assert_eq!(std::fs::read_to_string(&after).expect("a scenario"), text);
}

/// The linear resonance that comes nearest at the smallest drive is that of an acceleration; with the joint it is the
/// displacement that was read.
#[test]
fn what_a_reading_in_volts_is_of_is_told_with_what_is_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("volts.toml");
    new(&table("volts"), &path);
    let text = std::fs::read_to_string(&path).expect("a scenario");
    assert!(text.contains("V/m\"    # reading per displacement"), "{text}");
    let d = found(&path);
    assert_eq!(
        (d.verdict, d.explanation().hypothesis.effects()),
        (Verdict::EffectMissing, vec!["friction-joint".into()])
    );
}

/// Where a joint only begins to slip, stiffness, slip force and exponent lie along a curved valley: intervals that lose
/// their way in it miss what was planted (k_t 1.39e5 N/m, F_s 0.0312 N, n 1.73, f0 6484.9 Hz).
#[test]
fn intervals_follow_a_curved_valley() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("microslip.toml");
    new(&table("microslip"), &path);
    let d = found(&path);
    let c = &d.explanation().comparison;
    for (key, planted) in [
        ("effect.friction-joint.k_t", 138_981.65),
        ("effect.friction-joint.F_s", 0.031_186_445),
        ("effect.friction-joint.n", 1.73),
        ("rig.natural_frequency", 6484.9),
        ("rig.quality_factor", 220.5),
    ] {
        let at = c.fit.parameters.iter().position(|p| p.key == key).expect(key);
        let interval = &c.intervals[at];
        assert!(interval.low <= planted && planted <= interval.high, "{key}: {interval:?}");
    }
}

#[test]
fn intervals_along_a_curved_valley_keep_the_budget() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("microslip.toml");
    new(&table("microslip"), &path);
    let scenario = scenario::load(&path).expect("a scenario");
    let table = measurement::load(&scenario).expect("a table").expect("measurements");
    for budget in [60_000, 120_000] {
        let d = discover(&scenario, &table, &SearchOptions { budget, ..SearchOptions::default() });
        // Fits finish the evaluations that they are at.
        assert!(d.spent && d.solved < budget + budget / 10, "{} of {budget}", d.solved);
    }
}

/// Mass, length and time in other units: forces and readings follow.
fn rescaled(name: &str, [mass, length, time]: [f64; 3], folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(table(name)).expect("a table");
    let mut lines = text.trim_start_matches('\u{feff}').lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let factor = |column: &str| match column {
        "frequency_hz" => 1.0 / time,
        "force_n" => mass * length / (time * time),
        "amplitude_m" => length,
        "amplitude_m_s" => length / time,
        "amplitude_m_s2" => length / (time * time),
        _ => 1.0,
    };
    let mut out = header.join(",") + "\n";
    for line in lines {
        let cell = |(column, cell): (&&str, &str)| match factor(column) {
            1.0 => cell.to_string(),
            by => format!("{:e}", cell.parse::<f64>().expect("a number") * by),
        };
        let cells: Vec<String> = header.iter().zip(line.split(',')).map(cell).collect();
        out += &(cells.join(",") + "\n");
    }
    let path = folder.join(format!("{name}-{mass:e}-{length:e}-{time:e}.csv"));
    std::fs::write(&path, out).expect("written");
    let (mass_at, frequency, quality) = match name {
        "a" => (0.4, 55.0, 280.0),
        _ => (3e-6, 7958.0, 250.0),
    };
    let scenario = format!(
        "title = \"x\"\n[rig]\nkind = \"oscillator\"\nmass = {:e}\nnatural_frequency = {:e}\nquality_factor = {quality}\n\
         [measurement]\nfile = \"{}\"\n[fit]\nfree = [\"rig.mass\", \"rig.natural_frequency\", \"rig.quality_factor\"]\n",
        mass_at * mass,
        frequency / time,
        path.file_name().expect("a name").to_string_lossy()
    );
    let path = path.with_extension("toml");
    std::fs::write(&path, scenario).expect("written");
    path
}

#[test]
fn the_same_physics_at_another_size_gets_the_same_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = |d: &Discovery| -> Vec<(String, f64)> {
        // Of those whose fits came to their end: where the others stopped is no figure of theirs.
        let ended = |c: &&Candidate| c.hypothesis.basis() == Basis::AllPoints && !c.hypothesis.fit.is_exhausted();
        let fitted = d.candidates.iter().filter(ended);
        fitted.map(|c| (c.hypothesis.label(), c.delta_bic)).collect()
    };
    for name in ["a", "d"] {
        let stated = found(&rescaled(name, [1.0; 3], folder.path()));
        for scales in [[3.7e5, 2.9e-6, 8.1e3], [1.3e-6, 7.7e4, 4.9e-5], [6.1e-3, 5.3e5, 9.7e5]] {
            let other = found(&rescaled(name, scales, folder.path()));
            assert_eq!(other.verdict, stated.verdict, "{name} {scales:?}");
            assert_eq!(other.explanation().hypothesis.label(), stated.explanation().hypothesis.label());
            // Rounding may decide which of the hopeless candidates are fitted to their end.
            let (one, two) = (summary(&stated), summary(&other));
            let common: Vec<_> = one.iter().filter_map(|a| Some((a, two.iter().find(|b| a.0 == b.0)?))).collect();
            assert!(common.len() > 1 && one[0].0 == two[0].0, "{name} {scales:?}: {one:?} {two:?}");
            for ((label, bic), (_, of)) in common {
                assert!((bic - of).abs() < 1e-3 * (1.0 + bic.abs()), "{name} {scales:?} {label}: {bic} {of}");
            }
        }
    }
}

/// Start values far off end at the same optimum.
#[test]
fn a_calibration_has_no_hidden_box() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = rescaled("d", [1.0; 3], folder.path());
    let text = std::fs::read_to_string(&path).expect("a scenario");
    let fit = |text: &str| {
        std::fs::write(&path, text).expect("written");
        let scenario = scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
        let table = measurement::load(&scenario).expect("a table").expect("measurements");
        stickslip::compare::compare(&scenario, &table, &stickslip::compare::Options { seed: 0 }).fit.objective
    };
    let good = fit(&text);
    for (from, to) in [
        ("quality_factor = 250", "quality_factor = 2.5"),
        ("quality_factor = 250", "quality_factor = 25000"),
        ("mass = 3e-6", "mass = 3e-4"),
        ("mass = 3e-6", "mass = 3e-8"),
        ("natural_frequency = 7.958e3", "natural_frequency = 11000"),
        ("natural_frequency = 7.958e3", "natural_frequency = 5600"),
    ] {
        assert!(text.contains(from), "{text}");
        let far = fit(&text.replace(from, to));
        assert!((far / good - 1.0).abs() < 1e-4, "{to}: {far} for {good}");
    }
}
