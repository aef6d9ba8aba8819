//! Tables of any oscillator: what drives it and what is read of it, in which units.

use stickslip::measurement::{self, Table};
use stickslip::scenario;

/// A scenario of kind `oscillator`; `rig` and `more` are lines of `[rig]` and of the rest.
pub fn load(name: &str, bytes: &[u8], rig: &str, more: &str) -> Result<Table, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scenario.toml");
    std::fs::write(folder.path().join(name), bytes).expect("a file");
    let text = format!(
        "title = 'An oscillator'\n[rig]\nkind = 'oscillator'\nnatural_frequency = 80\nquality_factor = 100\n{rig}\n\
         [measurement]\nfile = '{name}'\n{more}\n"
    );
    std::fs::write(&path, text).expect("a file");
    let told = |error: stickslip::error::Error| {
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let table = measurement::load(&scenario::load(path).map_err(told)?).map_err(told)?;
    Ok(table.expect("the scenario names a table"))
}

/// A table of one row with two columns for drive and reading, and a stated noise.
fn row(drive: &str, reading: &str) -> String {
    format!("frequency_hz,{drive},{reading},amplitude_sd_percent\n80,2,3,1\n")
}

#[test]
fn the_unit_says_what_is_driven_and_read() {
    let angle = "coordinate = 'angle'\n";
    let cases = [
        ("", "force_n", "amplitude_m", ("N", 2.0), ("m", 3.0), (0, 0)),
        ("", "force_mn", "amplitude_um_s", ("N", 2e-3), ("m/s", 3e-6), (0, 1)),
        ("", "drive_v", "amplitude_g", ("V", 2.0), ("m/s^2", 3.0 * 9.80665), (0, 2)),
        ("drive = 'base'", "drive_g", "amplitude_mv", ("m/s^2", 2.0 * 9.80665), ("V", 3e-3), (2, 0)),
        ("drive = 'base'", "drive_um", "amplitude_mm", ("m", 2e-6), ("m", 3e-3), (0, 0)),
        ("drive = 'base'", "drive_m_s2", "amplitude_mm_s", ("m/s^2", 2.0), ("m/s", 3e-3), (2, 1)),
        ("drive = 'spring'\nspring_stiffness = 5", "drive_mm", "amplitude_m", ("m", 2e-3), ("m", 3.0), (0, 0)),
        (angle, "torque_mn_m", "amplitude_urad", ("N m", 2e-3), ("rad", 3e-6), (0, 0)),
        (angle, "torque_nm", "amplitude_deg_s", ("N m", 2.0), ("rad/s", 3f64.to_radians()), (0, 1)),
        (
            "coordinate = 'angle'\ndrive = 'base'",
            "drive_rad_s2",
            "amplitude_rad_s2",
            ("rad/s^2", 2.0),
            ("rad/s^2", 3.0),
            (2, 2),
        ),
        ("coordinate = 'angle'\ndrive = 'base'", "drive_mrad", "amplitude_v", ("rad", 2e-3), ("V", 3.0), (0, 0)),
    ];
    for (rig, drive, reading, of_drive, of_reading, orders) in cases {
        let table = load("t.csv", row(drive, reading).as_bytes(), rig, "").unwrap_or_else(|error| panic!("{error}"));
        let (signals, point) = (table.signals, &table.points[0]);
        assert_eq!((signals.drive.unit, signals.reading.unit), (of_drive.0, of_reading.0), "{drive} {reading}");
        assert_eq!((signals.drive.order, signals.reading.order), orders, "{drive} {reading}");
        let near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-14;
        assert!(near(point.drive, of_drive.1) && near(point.amplitude, of_reading.1), "{point:?}");
        assert_eq!((point.speed, point.load, point.series), (0.0, 0.0, 0), "no contact");
        let volts = table.notes.iter().filter(|note| note.contains("1 V per unit")).count();
        assert_eq!(volts, [drive, reading].iter().filter(|header| header.ends_with('v')).count(), "{:?}", table.notes);
    }
}

#[test]
fn a_sensitivity_says_what_the_volts_are() {
    let more = "[instrument]\nsensitivity = '2 V s^2/m'\ndrive_sensitivity = '0.1 V s^2/m'";
    let table = load("t.csv", row("drive_v", "amplitude_mv").as_bytes(), "drive = 'base'", more).expect("sound");
    let of = |signal: scenario::Signal| (signal.unit, signal.order);
    assert_eq!((of(table.signals.drive), of(table.signals.reading)), (("V", 2), ("V", 2)));
    assert!(table.notes.is_empty(), "{:?}", table.notes);
    // The physical reading beside the volts is used where no sensitivity is stated, and the other way round.
    let both = "frequency_hz,drive_v,force_n,amplitude_v,amplitude_mm,amplitude_sd_percent\n80,2,3,4,5,1\n";
    let table = load("t.csv", both.as_bytes(), "", "").expect("sound");
    assert_eq!((table.signals.drive.unit, table.signals.reading.unit), ("N", "m"));
    assert_eq!(table.notes, ["not used: `drive_v`, `amplitude_v`"]);
    let table = load("t.csv", both.as_bytes(), "", "[instrument]\nsensitivity = '1 V/m'").expect("sound");
    assert_eq!((table.signals.drive.unit, table.signals.reading.unit, table.points[0].amplitude), ("N", "V", 4.0));
}

#[test]
fn what_the_rig_does_not_have_is_told_with_the_key_to_change() {
    let angle = "coordinate = 'angle'";
    let cases = [
        ("drive-by-base-of-a-forced-rig", "", "drive_m_s2", "amplitude_m"),
        ("drive-by-force-of-a-base", "drive = 'base'", "force_mn", "amplitude_m"),
        ("drive-by-torque-of-a-displacement", "", "torque_n_m", "amplitude_m"),
        ("drive-by-displacement-of-a-forced-rig", "", "drive_um", "amplitude_m"),
        ("drive-in-m-s", "drive = 'base'", "drive_m_s", "amplitude_m"),
        ("reading-angle-of-a-displacement", "", "force_n", "amplitude_rad"),
        ("reading-displacement-of-an-angle", angle, "torque_n_m", "amplitude_mm"),
        ("reading-in-newtons", "", "force_n", "amplitude_n"),
        ("reading-lacks", "", "force_n", "tip"),
    ];
    for (name, rig, drive, reading) in cases {
        insta::assert_snapshot!(name, load("t.csv", row(drive, reading).as_bytes(), rig, "").expect_err(name));
    }
    let sensitive = "[instrument]\nsensitivity = '1 V/m'\ndrive_sensitivity = '1 V/N'";
    let refused = |text: &str, more: &str| load("t.csv", text.as_bytes(), "", more).expect_err("refused");
    insta::assert_snapshot!("sensitivity-and-no-volts", refused(&row("force_n", "amplitude_m"), sensitive));
    insta::assert_snapshot!(
        "deviation-of-another-quantity",
        refused("frequency_hz,force_n,amplitude_m,amplitude_sd_g\n80,1,1,1\n", "")
    );
    insta::assert_snapshot!("two-readings", refused("frequency_hz,force_n,amplitude_m,amplitude_g\n80,1,1,1\n", ""));
    insta::assert_snapshot!(
        "series-without-a-name",
        refused("series,frequency_hz,force_n,amplitude_m\na,80,1,1\n,81,1,1\n,82,1,1\n", "")
    );
    insta::assert_snapshot!("two-series", refused("series,frequency_hz,force_n,amplitude_m,Series\na,80,1,1,b\n", ""));
    insta::assert_snapshot!(
        "sweep-of-no-direction",
        refused("frequency_hz,force_n,amplitude_m,sweep\n80,1,1,left\n81,1,1,up\n", "")
    );
    insta::assert_snapshot!("force-negative", refused("frequency_hz,force_n,amplitude_g\n80,-1,1\n81,1,-1\n", ""));
    insta::assert_snapshot!(
        "force-and-drive-mapped",
        refused(&row("force_n", "amplitude_m"), "columns = { force = 'force_n', drive = 'frequency_hz' }")
    );
}

#[test]
fn harmonics_are_kept_aside() {
    let text = "frequency_hz,force_n,amplitude_m,amplitude_sd_percent,amplitude_3_m,phase_3_deg\n80,2,3,1,4,5\n";
    let table = load("t.csv", text.as_bytes(), "", "").expect("sound");
    assert_eq!(table.notes, ["harmonics are not used yet: `amplitude_3_m`, `phase_3_deg`"]);
}

#[test]
fn loads_and_speeds_without_a_contact_are_noted() {
    let text =
        "frequency_hz,force_n,amplitude_m,amplitude_sd_percent,load_n,speed_mm_s\n80,2,3,1,20,5\n80,2,3,1,10,5\n";
    let table = load("t.csv", text.as_bytes(), "", "").expect("sound");
    assert_eq!((table.points.len(), table.series.len()), (2, 2));
    assert!(table.points.iter().all(|point| (point.speed, point.load) == (0.0, 0.0)));
    assert!(table.notes[0].contains("`speed_mm_s` and `load_n` tell series apart"), "{:?}", table.notes);
    let contact = "[contact]\nstiffness = 1e5\ndamping = 0\nfriction = 0.5";
    let table = load("t.csv", text.as_bytes(), "", contact).expect("sound");
    assert_eq!((table.points[0].load, table.points[1].load, table.notes.len()), (10.0, 20.0, 0));
    let lacking = load("t.csv", row("force_n", "amplitude_m").as_bytes(), "", contact).expect_err("no load");
    insta::assert_snapshot!("load-and-speed-lack", lacking);
}
