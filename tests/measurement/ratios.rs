//! Frequency response functions, levels, and readings as two parts: the same motion however it is written.

use super::oscillators::load;
use std::f64::consts::TAU;

const ROWS: usize = 40;
const DRIVE: f64 = 0.2;

/// Frequency and complex response \[m/N\] of a mode at 80 Hz.
fn response(row: usize) -> (f64, f64, f64) {
    let f = 76.0 + 0.2 * row as f64;
    let (w, w0) = (TAU * f, TAU * 80.0);
    let (along, across) = (w0 * w0 - w * w, w * w0 / 100.0);
    let square = along * along + across * across;
    (f, along / square, -across / square)
}

/// A table with this header whose rows are made of frequency, real and imaginary part.
fn table(header: &str, row: impl Fn(f64, f64, f64) -> String) -> String {
    let rows = (0..ROWS).map(|k| {
        let (f, re, im) = response(k);
        row(f, re, im)
    });
    format!("{header}\n{}\n", rows.collect::<Vec<_>>().join("\n"))
}

/// Amplitude over drive, drive and phase of every row.
fn read(text: &str, more: &str) -> Vec<(f64, f64, f64)> {
    let table = load("t.csv", text.as_bytes(), "", more).unwrap_or_else(|error| panic!("{error}\n{text}"));
    table.points.iter().map(|p| (p.amplitude / p.drive, p.drive, p.phase.expect("phases"))).collect()
}

fn agrees(found: &[(f64, f64, f64)], drive: f64, what: &str) {
    assert_eq!(found.len(), ROWS, "{what}");
    for (k, (ratio, driven, phase)) in found.iter().enumerate() {
        let (_, re, im) = response(k);
        assert!(
            (ratio / re.hypot(im) - 1.0).abs() < 1e-6 && (driven - drive).abs() < 1e-12,
            "{what}, row {k}: {ratio}"
        );
        assert!((phase - im.atan2(re)).abs() < 1e-6, "{what}, row {k}: {phase}");
    }
}

#[test]
fn a_ratio_is_read_whatever_its_unit_level_or_parts() {
    let level = |size: f64| 20.0 * size.log10();
    let tables = [
        table("f [Hz],H [mm/kN],phase [deg]", |f, re, im| {
            format!("{f},{},{}", 1e6 * re.hypot(im), im.atan2(re).to_degrees())
        }),
        table("f [Hz],Receptance (dB re 1 m/N),phase_rad", |f, re, im| {
            format!("{f},{},{}", level(re.hypot(im)), im.atan2(re))
        }),
        table("f [Hz],Magnitude [dB re um/N],phase_rad", |f, re, im| {
            format!("{f},{},{}", level(1e6 * re.hypot(im)), im.atan2(re))
        }),
        table("f [Hz],H real [um/N],H imag [um/N]", |f, re, im| format!("{f},{},{}", 1e6 * re, 1e6 * im)),
        table("f [Hz],Re(H) [m/N],Im(H) [m/N]", |f, re, im| format!("{f},{re},{im}")),
    ];
    for text in &tables {
        agrees(&read(text, ""), 1.0, text.lines().next().unwrap_or_default());
    }
}

#[test]
fn the_drive_of_a_ratio_is_that_of_its_column_or_of_the_sweep() {
    let beside =
        table("f [Hz],force_n,H [m/N],phase_rad", |f, re, im| format!("{f},{DRIVE},{},{}", re.hypot(im), im.atan2(re)));
    agrees(&read(&beside, ""), DRIVE, "a column");
    let alone = table("f [Hz],H [m/N],phase_rad", |f, re, im| format!("{f},{},{}", re.hypot(im), im.atan2(re)));
    let sweep = "[sweep]\nfrequency = '80 Hz'\ndrive = '0.2 N'";
    agrees(&read(&alone, sweep), DRIVE, "the sweep");
}

#[test]
fn the_parts_of_a_lock_in_amplifier_are_read() {
    let parts = table("f [Hz],force_n,X [V],Y [V]", |f, re, im| format!("{f},{DRIVE},{},{}", re * DRIVE, im * DRIVE));
    agrees(&read(&parts, ""), DRIVE, "X and Y");
    // Coordinates are no parts.
    let places = "f [Hz],force_n,x [mm],y [mm],amplitude_sd_percent\n80,1,2,3,1\n81,1,2,3,1\n";
    let table = load("t.csv", places.as_bytes(), "", "").unwrap();
    assert!((table.points[0].amplitude - 2e-3).abs() < 1e-15 && table.points[0].phase.is_none());
}

#[test]
fn readings_outside_the_frequencies_of_the_scenario_are_not_used() {
    let text = table("f [Hz],H [m/N],phase_rad", |f, re, im| format!("{f},{},{}", re.hypot(im), im.atan2(re)));
    let band = "frequency = { from = '78 Hz', to = '82 Hz' }";
    let table = load("t.csv", text.as_bytes(), "", band).unwrap();
    assert!(table.points.iter().all(|p| (78.0..=82.0).contains(&p.frequency)) && table.points.len() == 21);
    assert!(table.notes.iter().any(|note| note.starts_with("19 of 40 rows are not used")), "{:?}", table.notes);
    let none = load("t.csv", text.as_bytes(), "", "frequency = { from = '90 Hz', to = '91 Hz' }").unwrap_err();
    assert!(none.contains("has no reading between 90 Hz and 91 Hz"), "{none}");
    let turned = load("t.csv", text.as_bytes(), "", "frequency = { from = '82 Hz', to = '78 Hz' }").unwrap_err();
    assert!(turned.contains("`from` needs to be less than `to`"), "{turned}");
}

#[test]
fn a_level_needs_what_it_refers_to() {
    let text = "f [Hz],force_n,phase [dB]\n80,1,-3\n81,1,-3\n";
    let error = load("t.csv", text.as_bytes(), "", "").unwrap_err();
    assert!(error.contains("dB"), "{error}");
}
