//! Tables looked at before there is a scenario: the same as a fitting scenario would read.

use stickslip::measurement::{self, Survey};
use stickslip::scenario::Coordinate;

use super::PRACTICE;
use super::oscillators::load;

fn survey(name: &str, text: &str) -> Result<Survey, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("a file");
    measurement::survey(&path).map_err(|error| {
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    })
}

/// Rows of `columns` numbers each at twelve frequencies.
fn rows(columns: usize) -> String {
    (0..12)
        .map(|n| format!("{}{}\n", 80 + n, format!(",{}", 1.0 + 0.1 * f64::from(n * n % 7)).repeat(columns)))
        .collect()
}

#[test]
fn a_survey_reads_what_a_fitting_scenario_reads() {
    let cases = [
        ("frequency_hz,force_n,amplitude_m_s2,phase_rad", "", Some(Coordinate::Displacement)),
        ("f [Hz],Force [mN],Acceleration [g],phi [rad]", "", Some(Coordinate::Displacement)),
        ("frequency_hz,drive_g,amplitude_mm,phase_rad", "drive = 'base'", Some(Coordinate::Displacement)),
        ("frequency_hz,drive_v,amplitude_mv,phase_rad", "", Some(Coordinate::Displacement)),
        ("frequency_hz,torque_n_m,amplitude_urad,phase_rad", "coordinate = 'angle'", Some(Coordinate::Angle)),
        (
            "frequency_hz,drive_rad,amplitude_v,phase_rad",
            "drive = 'base'\ncoordinate = 'angle'",
            Some(Coordinate::Angle),
        ),
    ];
    for (header, rig, coordinate) in cases {
        let text = format!("{header}\n{}", rows(3));
        let seen = survey("t.csv", &text).unwrap_or_else(|error| panic!("{error}"));
        let table = load("t.csv", text.as_bytes(), rig, "").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((seen.coordinate(), seen.table.signals), (coordinate, table.signals), "{header}");
        assert_eq!((&seen.table.points, &seen.table.series), (&table.points, &table.series), "{header}");
        assert!(seen.mapping.is_empty() && seen.has("phase") && !seen.has("load"), "{:?}", seen.columns);
    }
    let seen = survey("t.csv", &format!("f [Hz],Force [mN],accel_g,comment\n{}", rows(3))).expect("sound");
    let columns: Vec<_> = seen.columns.iter().map(|c| (c.header.as_str(), c.key, c.unit.as_deref())).collect();
    let expected = [
        ("f [Hz]", Some("frequency"), Some("Hz")),
        ("Force [mN]", Some("drive"), Some("mN")),
        ("accel_g", Some("amplitude"), Some("g")),
        ("comment", None, None),
    ];
    assert_eq!(columns, expected);
    // The paper's rig is driven by a displacement and read as an angle: no oscillator is.
    let seen = survey("t.csv", PRACTICE).expect("sound");
    assert_eq!(
        (seen.coordinate(), seen.table.series.len(), seen.has("load"), seen.has("speed")),
        (None, 13, true, true)
    );
    assert_eq!(seen.table.points.iter().map(|point| point.load).fold(0.0, f64::max), 20.0);
}

#[test]
fn of_several_columns_one_is_chosen_and_said() {
    let both = format!("frequency_hz,drive_v,force_n,amplitude_v,amplitude_mm\n{}", rows(4));
    let seen = survey("t.csv", &both).expect("sound");
    assert_eq!((seen.table.signals.drive.unit, seen.table.signals.reading.unit), ("N", "m"));
    assert!(seen.mapping.is_empty(), "a scenario prefers them as well: {:?}", seen.mapping);
    let several = format!("frequency_hz,drive_m_s2,force_n,amplitude_g,amplitude_mm\n{}", rows(4));
    let seen = survey("t.csv", &several).expect("sound");
    assert_eq!((seen.table.signals.drive.unit, seen.table.signals.reading.unit), ("N", "m/s^2"));
    let of = |key: &str, header: &str| (key.to_string(), header.to_string());
    assert_eq!(seen.mapping, [of("drive", "force_n"), of("amplitude", "amplitude_g")]);
    let mapped = "columns = { drive = 'force_n', amplitude = 'amplitude_g' }";
    let table = load("t.csv", several.as_bytes(), "", mapped).expect("sound");
    assert_eq!(table.points, seen.table.points);
    let aliases = format!("f [Hz],Force [N],Displacement [mm],Velocity [mm/s]\n{}", rows(3));
    assert_eq!(survey("t.csv", &aliases).expect("sound").mapping, [of("amplitude", "Displacement [mm]")]);
}

#[test]
fn what_states_no_unit_is_of_the_unit_that_stands_for_it() {
    let of = |header: &str| {
        let seen = survey("t.csv", &format!("{header}\n{}", rows(header.matches(',').count()))).expect(header);
        let signals = seen.table.signals;
        ((signals.drive.unit, signals.reading.unit), seen.mapping)
    };
    let volts = ("V", "V");
    for header in ["frequency,drive,amplitude", "f,amp", "frequency,amplitude", "Freq (Hz),Peak to peak (V)"] {
        assert_eq!(of(header), (volts, Vec::new()), "{header}");
    }
    assert_eq!(of("f,signal"), (volts, vec![("amplitude".to_string(), "signal".to_string())]));
    assert_eq!(of("f [Hz],drive_n,ampl").0, ("N", "V"));
}

/// A rig of a micrometre is driven by piconewtons; a drive in a unit that nobody knows is asked about, not left out.
#[test]
fn small_units_are_read_and_unknown_ones_asked_about() {
    let of = |unit: &str| survey("t.csv", &format!("frequency_hz,F [{unit}],amplitude_m\n{}", rows(2)));
    let drive = |unit: &str| of(unit).unwrap_or_else(|error| panic!("{error}")).table.points[0].drive;
    assert!((drive("pN") / 1e-12 - 1.0).abs() < 1e-12 && (drive("fN") / 1e-15 - 1.0).abs() < 1e-12);
    let refused = of("qN").expect_err("refused");
    assert!(refused.contains("no unit that is known: `F [qN]`"), "{refused}");
}

/// Phases in radians under a header that says degrees are asked about, and hide no resonance; flanks of a peak are no
/// branch of their own.
#[test]
fn phases_that_hardly_turn_and_flanks_are_told_for_what_they_are() {
    let text = |per_radian: f64, columns: &str| {
        let row = |i: usize| {
            let ratio = (12.0 + i as f64) / 24.0;
            let (re, im) = (1.0 - ratio * ratio, ratio / 5.0);
            let phase =
                if columns.contains("phase") { format!(",{:.6}", -per_radian * im.atan2(re)) } else { String::new() };
            format!("{},1,{:.6}{phase}\n", 12 + i, 1.0 / re.hypot(im))
        };
        format!("f (Hz),F (N),{columns}\n{}", (0..25).map(row).collect::<String>())
    };
    let notes = |text: &str| survey("t.csv", text).unwrap_or_else(|error| panic!("{error}")).table.notes.join("\n");
    assert!(notes(&text(1.0, "x (mm),phase (deg)")).contains("are they in radians?"));
    assert!(!notes(&text(1f64.to_degrees(), "x (mm),phase (deg)")).contains("radians"));
    assert!(!notes(&text(1.0, "x (mm)")).contains("curve of their own"));
}

/// A generator that sags where the rig takes most, read with two digits: one sweep, each reading by its own drive. Levels
/// that are swept after each other are several.
#[test]
fn a_drive_that_sags_on_the_way_is_one_sweep() {
    let drives = [2.9, 3.0, 3.0, 3.0, 2.9, 2.8, 2.8, 2.9, 2.9, 2.9, 2.9, 2.9];
    let reading = |i: usize| 2.0 / (1.0 + (i as f64 - 6.0).powi(2) / 8.0);
    let row = |(i, drive): (usize, &f64)| format!("{},{drive},{:.2}\n", 80 + i, reading(i));
    let sagging: String = drives.iter().enumerate().map(row).collect();
    let series = |rows: &str| {
        let seen = survey("t.csv", &format!("f (Hz),drive (V),ampl (V)\n{rows}"));
        seen.unwrap_or_else(|error| panic!("{error}")).table.series.len()
    };
    assert_eq!(series(&sagging), 1);
    let sweep = |drive: f64| (0..12).map(move |i| row((i, &drive))).collect::<String>();
    assert_eq!(series(&[sweep(2.8), sweep(3.0), sweep(3.2)].concat()), 3);
}

/// Keys and headers of the columns that are read of twelve rows.
fn of(header: &str, row: &dyn Fn(f64) -> String) -> Vec<(&'static str, String)> {
    let text: String = (0..12).map(|i| row(f64::from(i)) + "\n").collect();
    let seen = survey("t.csv", &format!("{header}\n{text}")).unwrap_or_else(|error| panic!("{error}"));
    seen.columns.iter().filter_map(|c| Some((c.key?, c.header.clone()))).collect()
}

/// A resonance in the middle of twelve rows.
fn voltage(i: f64) -> f64 {
    2.0 / (1.0 + (i - 6.0).powi(2) / 8.0)
}

/// Heights of a Lissajous figure stand beside the voltage that was measured, and the voltage of a generator beside an
/// amplitude in divisions of a scale.
#[test]
fn the_reading_is_what_a_deviation_is_stated_of_and_the_drive_what_is_held() {
    let read = of("f (Hz),peak-to-peak voltage (V),unc voltage (V),y0 (V),y1 (V),unc y (V)", &|i| {
        format!("{},{:.2},0.05,{:.2},{:.2},0.05", 80.0 + i, voltage(i), voltage(i), 0.3 + 0.1 * (i * i % 7.0))
    });
    let is = |key: &str, header: &str| read.iter().any(|(k, h)| *k == key && h == header);
    assert!(is("amplitude", "peak-to-peak voltage (V)") && is("amplitude_sd", "unc voltage (V)"), "{read:?}");
    assert!(!read.iter().any(|(key, _)| *key == "drive"), "{read:?}");
    let read = of("U (V),f (Hz),amplitude", &|i| format!("4,{},{:.2}", 80.0 + i, voltage(i)));
    assert!(read.contains(&("drive", "U (V)".to_string())), "{read:?}");
    // A letter says more than a unit: the voltage of a motor sets the frequency.
    let read =
        of("U_V,A_Skt,T_s", &|i| format!("{:.1},{:.2},{:.4}", 2.0 + 0.1 * i, voltage(i), 1.0 / (0.8 + 0.04 * i)));
    assert!(read.contains(&("amplitude", "A_Skt".to_string())), "{read:?}");
    // A small one may be a distance on a screen: which of the voltages is read is asked.
    let text: String = (0..12).map(f64::from).map(|i| format!("{},3,{:.2},2.{i}\n", 80.0 + i, voltage(i))).collect();
    let error = survey("t.csv", &format!("f,U0,UC,a\n{text}")).expect_err("no reading is named").to_string();
    assert!(error.contains("no column for amplitude"), "{error}");
    // A reading over a drive is a response.
    let read = of("f (Hz),Acceleration/Force (m/s^2/N)", &|i| format!("{},{:.2}", 80.0 + i, voltage(i)));
    assert!(read.contains(&("amplitude", "Acceleration/Force (m/s^2/N)".to_string())), "{read:?}");
    let read = of("Bias (V),f (Hz),amplitude", &|i| format!("4,{},{:.2}", 80.0 + i, voltage(i)));
    assert!(!read.iter().any(|(key, _)| *key == "drive"), "a bias: {read:?}");
}

#[test]
fn what_is_held_is_set_and_no_reading() {
    // What is held is set, and drives where it is a voltage beside another.
    let both = of("I (mA),f (Hz),F (N),A (V)", &|i| {
        format!("{},{},2,{:.2}", if i < 6.0 { 200 } else { 400 }, 80.0 + i, voltage(i))
    });
    assert!(
        both.contains(&("amplitude", "A (V)".to_string())) && both.contains(&("drive", "F (N)".to_string())),
        "{both:?}"
    );
    let row = |i: f64| format!("{},{:.2},{:.2},0.01,{:.0}", 80.0 + i, 4.2 + 0.01 * i, voltage(i), -20.0 * i);
    let read = of("frequenza [Hz],ampiezza V_g [V],ampiezza V_R [V],errore V_R [V],fase V_R [gradi]", &row);
    for (key, header) in
        [("drive", "ampiezza V_g [V]"), ("amplitude", "ampiezza V_R [V]"), ("phase", "fase V_R [gradi]")]
    {
        assert!(read.contains(&(key, header.to_string())), "{key}: {read:?}");
    }
    // Also where the reading has a peak in a few rows alone, and not beside what is called a drive.
    let peak = |i: f64| if i == 6.0 { 2.0 } else { 0.02 };
    let read = of("f [Hz],ampiezza V_g [V],ampiezza V_R [V]", &|i| {
        format!("{},{:.2},{}", 80.0 + i, 4.2 + 0.01 * (i % 2.0), peak(i))
    });
    assert!(read.contains(&("drive", "ampiezza V_g [V]".to_string())), "{read:?}");
    let read =
        of("f (Hz),drive,ampiezza V_g [V],ampiezza V_R [V]", &|i| format!("{},1,4.2,{:.2}", 80.0 + i, voltage(i)));
    assert!(read.contains(&("drive", "drive".to_string())), "{read:?}");
    // A response that was held is read: its voltage drives.
    let read =
        of("f (Hz),x (mm),U (V)", &|i| format!("{},{},{:.2}", 80.0 + i, if i < 6.0 { 1 } else { 2 }, 3.0 / voltage(i)));
    assert!(
        read.contains(&("amplitude", "x (mm)".to_string())) && read.contains(&("drive", "U (V)".to_string())),
        "{read:?}"
    );
    // `new` reads its scenario back with the column that it chose.
    let rows: String = (0..12).map(f64::from).map(|i| format!("{},2,{:.2},5.0\n", 80.0 + i, voltage(i))).collect();
    let seen = survey("t.csv", &format!("f (Hz),F (N),x (mm),displacement (mm)\n{rows}")).expect("a table");
    assert!(seen.mapping.contains(&("amplitude".into(), "x (mm)".into())), "{:?}", seen.mapping);
    // What another voltage is called, with a letter before it, is no deviation of the first.
    let read = of("f (Hz),U0 (V),dU (V)", &|i| format!("{},4.2,{:.2}", 80.0 + i, voltage(i)));
    assert!(!read.iter().any(|(key, _)| *key == "amplitude_sd"), "{read:?}");
    // An index is a letter, a unit behind a letter is longer.
    let read = of("f_Hz,force_N,x_um", &|i| format!("{},2,{:.2}", 80.0 + i, voltage(i)));
    assert!(read.contains(&("amplitude", "x_um".to_string())), "{read:?}");
    let read = of("Frequenz / Hz;Amplitude / V;dA [V]", &|i| format!("{};{:.2};0.05", 80.0 + i, voltage(i)));
    assert!(read.contains(&("amplitude_sd", "dA [V]".to_string())), "{read:?}");
}

#[test]
fn phases_that_were_not_measured_are_not_read() {
    // A phase that is one number was not measured.
    let read = of("f (Hz),x (mm),phase (deg)", &|i| format!("{},{:.2},0", 80.0 + i, voltage(i)));
    assert!(!read.iter().any(|(key, _)| *key == "phase"), "{read:?}");
    // Nor is one that points anywhere; a loop that keeps to the resonance has one phase, a long cable turns it evenly.
    for (phase, is_used) in [
        (&(|i: f64| ((12.9898 * i).sin() * 43758.5453).fract() * 360.0) as &dyn Fn(f64) -> f64, false),
        (&|_| -90.0, true),
        (&|i| (-100.0 * i) % 360.0, true),
        (&|i| -(i - 20.0).atan2(3.0).to_degrees() - 90.0, true),
    ] {
        let rows: String =
            (0..41).map(f64::from).map(|i| format!("{},{:.3},{:.1}\n", 80.0 + i, voltage(i / 4.0), phase(i))).collect();
        let seen = survey("t.csv", &format!("f (Hz),x (mm),phase (deg)\n{rows}")).expect("a table");
        assert_eq!(seen.table.points.iter().all(|point| point.phase.is_some()), is_used, "{:?}", seen.table.notes);
        assert_eq!(seen.mapping.contains(&("phase".into(), String::new())), !is_used, "{:?}", seen.mapping);
    }
}

#[test]
fn spectra_periods_and_complex_numbers_are_read_as_their_programs_write_them() {
    let read = |text: &str| survey("t.csv", text).unwrap_or_else(|error| panic!("{error}")).table;
    let text = |header: &str, row: &dyn Fn(f64) -> String| {
        let rows: String = (0..12).map(|i| row(40.0 + f64::from(i)) + "\n").collect();
        format!("{header}\n{rows}")
    };
    let plain = read(&text("f (Hz),x (mm),phase (rad)", &|f| format!("{f},{},{}", f / 50.0, -f / 50.0)));
    let polar = |f: f64| ((f / 50.0) * (f / 50.0).cos(), -(f / 50.0) * (f / 50.0).sin());
    let same = |table: &stickslip::measurement::Table| {
        assert_eq!(table.points.len(), plain.points.len());
        for (point, other) in table.points.iter().zip(&plain.points) {
            assert!((point.frequency / other.frequency - 1.0).abs() < 1e-12);
            assert!((point.amplitude / other.amplitude - 1.0).abs() < 1e-12);
            assert!(point.phase.zip(other.phase).is_none_or(|(own, other)| (own - other).abs() < 1e-12));
        }
    };
    same(&read(&text("f (Hz),x (mm)", &|f| format!("{f},({:e}{:+e}j)", polar(f).0, polar(f).1))));
    // A lag stated as a time, unless an angle stands beside it.
    let lag = |f: f64| 1e3 * (f / 50.0) / (std::f64::consts::TAU * f);
    same(&read(&text("f (Hz),x (mm),time lag (ms)", &|f| format!("{f},{},{:.12}", f / 50.0, lag(f)))));
    same(&read(&text("f (Hz),x (mm),lag (ms),angle (rad)", &|f| format!("{f},{},0.3,{}", f / 50.0, -f / 50.0))));
    // An angle that is the reading tells no phase.
    let turned = read(&text("f (Hz),Amplitude (Grad),Zeitverschiebung (s)", &|f| {
        format!("{f},{},{:.12}", f / 50.0, lag(f) / 1e3)
    }));
    let phases = turned.points.iter().zip(&plain.points);
    assert!(
        phases
            .map(|(own, other)| (own.phase, other.phase))
            .all(|pair| { matches!(pair, (Some(own), Some(other)) if (own - other).abs() < 1e-9) })
    );
    same(&read(&text("Frequency (Hz),x (Real) [mm],x (Imag) [mm]", &|f| {
        format!("{f},{:e},{:e}", polar(f).0, polar(f).1)
    })));
    for header in ["Period (s),x (mm)", "T (s),x (mm)", "T/s,x/mm", "T_s,x (mm)"] {
        same(&read(&text(header, &|f| format!("{:e},{}", 1.0 / f, f / 50.0))));
    }
    // Beside a frequency it is something else, and so are times that grow evenly.
    same(&read(&text("T (s),f (Hz),x (mm)", &|f| format!("{},{f},{}", 3.0 * f, f / 50.0))));
    let recording = survey("t.csv", &text("T (s),U (V)", &|f| format!("{},{}", 0.1 * f, f / 50.0)));
    assert!(recording.expect_err("refused").contains("samples in time"));
    let per_second = |f: f64| format!("{:e},{}", std::f64::consts::TAU * f, f / 50.0);
    same(&read(&text("ω [1/s],x (mm)", &per_second)));
    let spectrum = read(&text("f (Hz),x (mm)\n0,7", &|f| format!("{f},{}", f / 50.0)));
    same(&spectrum);
    assert!(spectrum.notes.iter().any(|note| note.starts_with("1 row at 0 Hz")), "{:?}", spectrum.notes);
    // Nothing else is no spectrum.
    let nothing = survey("t.csv", "f (Hz),x (mm)\n0,7\n0,8\n").expect_err("refused").to_string();
    assert!(nothing.contains("outside its physical range"), "{nothing}");
}

#[test]
fn what_a_survey_cannot_tell_is_an_error() {
    let fails =
        |header: &str, columns: usize| survey("t.csv", &format!("{header}\n{}", rows(columns))).expect_err("refused");
    insta::assert_snapshot!("survey-no-unit", fails("frequency,deflection,temperature", 2));
    insta::assert_snapshot!("survey-no-drive", fails("frequency_hz,amplitude_m,U [V]", 2));
    insta::assert_snapshot!("survey-bad-unit", fails("frequency_hz,force_n,amplitude_kg", 2));
    insta::assert_snapshot!("survey-samples", fails("t,x,y", 2).replace("80", "…"));
    let few = "frequency_hz,force_n,amplitude_m\n80,1,1\n81,1,2\n";
    insta::assert_snapshot!("survey-noise-unknown", survey("t.csv", few).expect_err("no noise"));
    insta::assert_snapshot!("survey-no-file", measurement::survey("no/such.csv").expect_err("missing").to_string());
    insta::assert_snapshot!(
        "survey-universal",
        survey("t.uff", include_str!("../data/frf.uff")).expect_err("too short")
    );
}

/// Twenty decibels of a power are ten times the amplitude.
#[test]
fn levels_of_a_power_drive() {
    for header in ["Power (dBm)", "P/dB", "drive [dBm]", "P [dBm]", "Leistung / dBm"] {
        let of = |level: i32| (80..88).map(move |f| format!("{f};{level};-{}\n", 3 + f * f % 7)).collect::<String>();
        let text = format!("f [Hz];{header};S21 [dB]\n{}{}", of(-20), of(0));
        let table = survey("t.csv", &text).expect("sound").table;
        let drives: Vec<f64> = table.series.iter().map(|series| series.drive).collect();
        // A milliwatt at 50 ohms.
        assert!((drives[1].powi(2) / (2.0 * 50.0) / 1e-3 - 1.0).abs() < 1e-12, "{header}: {drives:?}");
        assert!((drives[1] / drives[0] - 10.0).abs() < 1e-12, "{header}: {drives:?}");
        // What is read is a ratio.
        assert!((table.points[8].amplitude / table.points[0].amplitude - 10.0).abs() < 1e-9, "{header}");
    }
    // What is read in dBm is none: 20 dB more of it are ten times the voltage, whatever drives.
    let rows: String = (80..88).map(|f| format!("{f};{};{}\n", if f % 2 == 0 { 0 } else { 20 }, f * f % 7)).collect();
    let table = survey("t.csv", &format!("f [Hz];amplitude [dBm];phase [deg]\n{rows}")).expect("sound").table;
    assert!((table.points[1].amplitude / table.points[0].amplitude - 10.0).abs() < 1e-9);
}

#[test]
fn a_name_with_an_index_has_its_unit_behind_a_stroke() {
    let rows = "12;3.1;2.9\n15;3.6;2.9\n17;4.4;2.9\n20;5.4;2.9\n22;7.2;2.9\n25;5.1;2.9\n28;4.1;2.9\n";
    let table = survey("t.csv", &format!("f/kHz;U_C/V;U/V\n{rows}")).expect("sound").table;
    assert_eq!((table.points[0].amplitude, table.points[0].drive), (3.1, 2.9));
}

/// A resonance of two numbers a row: frequency, amplitude and phase in degrees.
fn resonance(row: impl Fn(f64, f64, f64) -> String) -> String {
    let of = |k: u32| {
        let f = 80.0 + 0.5 * f64::from(k);
        let (along, across) = (1.0 - (f / 90.0).powi(2), f / 90.0 / 30.0);
        row(f, 1.0 / along.hypot(across), (-across).atan2(along).to_degrees())
    };
    (0..40).map(of).collect()
}

#[test]
fn an_angle_beside_a_reading_is_a_phase_and_never_the_reading() {
    for header in
        ["f [Hz];amplitud [mm];fase [deg]", "frequenza [Hz];ampiezza [mm];fase [deg]", "f [Hz];U [mV];ángulo [deg]"]
    {
        let text = format!("{header}\n{}", resonance(|f, a, phase| format!("{f};{a};{phase}\n")));
        let point = &survey("t.csv", &text).unwrap_or_else(|error| panic!("{error}")).table.points[0];
        assert!((point.amplitude - 4.76e-3).abs() < 1e-3 && point.phase.is_some(), "{header}: {point:?}");
    }
    // Nothing else is read: what stands beside it is its deviation.
    let text = format!("nu [Hz],theta [rad],sigma_theta [rad]\n{}", resonance(|f, a, _| format!("{f},{a},0.1\n")));
    assert!(survey("t.csv", &text).unwrap_or_else(|error| panic!("{error}")).table.points[0].amplitude > 1.0);
    // A unit that is none: refused, not the phase in the place of the amplitude.
    let text = format!("f [Hz];ampiezza [giri];fase [deg]\n{}", resonance(|f, a, phase| format!("{f};{a};{phase}\n")));
    assert!(survey("t.csv", &text).unwrap_err().contains("no column for amplitude"));
}

#[test]
fn what_cannot_be_read_is_named() {
    let refused = |text: &str| survey("t.csv", text).unwrap_err();
    let side = "f [Hz];70;71;72;73\nA [mm];1;2;3;2\nphase [deg];-1;-40;-90;-120\n";
    assert!(refused(side).contains("lies on its side"), "{}", refused(side));
    let rows = resonance(|f, a, phase| format!("{f};{a};{phase}\n"));
    let unit = refused(&format!("f [Hz];A [furlong];drive [V]\n{rows}"));
    assert!(unit.contains("no unit that is known: `A [furlong]`"), "{unit}");
    // Series in words are no names of rows.
    let words = resonance(|f, a, phase| format!("first;{f};{a};{phase}\n"));
    survey("t.csv", &format!("series;f (s^-1);A [mm];phase [deg]\n{words}")).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn traces_marks_and_real_numbers_of_an_analyser() {
    let text = format!(
        "#f(Hz)\tCH1_S11_1=S21_dB\tCH1_S11_1=S21_deg\n{}",
        resonance(|f, a, phase| { format!("{f}\t{}\t{phase}\n", 20.0 * a.log10()) })
    );
    assert!(survey("t.txt", &text).expect("sound").table.points[0].phase.is_some());
    let text = format!("# f / Hz  #  U / mV\n\n{}", resonance(|f, a, _| format!("  {f}     {a}\n")));
    assert!((survey("t.txt", &text).expect("sound").table.points[0].amplitude - 4.76e-3).abs() < 1e-3);
    // What is real is written as a real number.
    let text = format!(
        "f [Hz],H [V/N]\n70,1.5\n{}",
        resonance(|f, a, phase| {
            let (re, im) = (a * phase.to_radians().cos(), a * phase.to_radians().sin());
            format!("{f},{re}{im:+}i\n")
        })
    );
    assert_eq!(survey("t.csv", &text).expect("sound").table.points[0].amplitude, 1.5);
}

#[test]
fn channels_of_a_lock_in_amplifier_are_parts() {
    let row = |f: f64, a: f64, phase: f64| {
        let (re, im) = (a * phase.to_radians().cos(), a * phase.to_radians().sin());
        format!("{f},{re},0.01,{im},0.01\n")
    };
    let text = format!("f (Hz),X1 avg (V),X1 std dev (V),Y1 avg (V),Y1 std dev (V)\n{}", resonance(row));
    let point = &survey("t.csv", &text).unwrap_or_else(|error| panic!("{error}")).table.points[0];
    assert!((point.amplitude - 4.76).abs() < 0.1 && point.phase.is_some(), "{point:?}");
}

#[test]
fn a_lower_branch_is_no_lack_of_a_signal() {
    let branches = |low: f64| resonance(|f, a, _| format!("{f};{}\n", if f > 91.0 { a * low } else { a }));
    let doubted = |text: &str| {
        let table = survey("t.csv", &format!("f [Hz];x [mm]\n{text}")).expect("sound").table;
        table.notes.iter().any(|note| note.contains("was there a signal"))
    };
    assert!(!doubted(&branches(0.01)));
}

#[test]
fn what_may_be_the_drive_is_named() {
    let text = format!("Punkt;Frequenz;Amplitude;I_B (A)\n{}", resonance(|f, a, _| format!("1;{f};{a};0.2\n")));
    assert!(survey("t.csv", &text).unwrap_err().contains("if `I_B (A)` is the drive"));
}
