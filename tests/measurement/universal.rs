//! Universal files and workbooks.

use stickslip::measurement::{Table, survey_bytes};

use super::{SWEEP, read};

#[test]
fn universal_files_give_what_was_computed_by_hand() {
    let bytes = include_bytes!("../data/frf.uff");
    let sd = |error: String| assert!(error.contains("states no noise of the amplitude"), "{error}");
    // Three frequencies do not tell their noise, so more are added to the first function: |3+4i| = 5, |-2i| = 2, |-1| = 1.
    sd(read("frf.uff", bytes, &format!("record = 1\n{SWEEP}")).expect_err("too few points"));
    let text = String::from_utf8(bytes.to_vec()).expect("ASCII");
    let more: String = (0..5)
        .map(|n| format!("{:13.5e}{:20.11e}{:20.11e}\n", 80.0 + f64::from(n), -1.0 / f64::from(n + 2), 0.0))
        .collect();
    let text = text.replacen("         6         3         0", "         6         8         0", 1);
    let end = text.find("-1.00000000000e+00").expect("the last value");
    let end = end + text[end..].find('\n').expect("its end") + 1;
    let longer = format!("{}{more}{}", &text[..end], &text[end..]);
    let table =
        read("frf.uff", longer.as_bytes(), &format!("record = 1\n{SWEEP}")).unwrap_or_else(|error| panic!("{error}"));
    let expected = [
        (50.0, 5.0, (4.0f64).atan2(3.0)),
        (60.0, 2.0, -std::f64::consts::FRAC_PI_2),
        (75.0, 1.0, std::f64::consts::PI),
    ];
    for (point, (frequency, size, phase)) in table.points.iter().zip(expected) {
        assert_eq!((point.frequency, point.speed, point.load, point.drive), (frequency, 0.02, 20.0, 2.5e-6));
        assert!((point.amplitude / (size * 2.5e-6) - 1.0).abs() < 1e-12, "{point:?}");
        assert!((point.phase.expect("a phase") - phase).abs() < 1e-12, "{point:?}");
    }
    assert_eq!((table.points.len(), table.points[0].line), (8, 19));
    insta::assert_snapshot!("uff-notes", table.notes[..4].join("\n"));
    let unphased = read("frf.uff", longer.as_bytes(), &format!("record = 1\ncolumns = {{ phase = '' }}\n{SWEEP}"));
    let unphased = unphased.unwrap_or_else(|error| panic!("{error}"));
    assert!(unphased.points.iter().all(|point| point.phase.is_none()) && unphased.points.len() == 8);
    assert!(!unphased.notes.iter().any(|note| note.contains("`columns` is not used")), "{:?}", unphased.notes);
}

/// The function of `record` extended to `count` values by repeating its data, so that its noise can be told.
fn function(record: usize, from: &str, to: &str, extra: &str) -> Table {
    let text = include_str!("../data/frf.uff").replacen(from, to, 1);
    let start = text.find(to).expect("the form record");
    let end = start + text[start..].find("\n    -1").expect("the end of the dataset");
    let text = format!("{}\n{extra}{}", &text[..end], &text[end..]);
    read("frf.uff", text.as_bytes(), &format!("record = {record}\n{SWEEP}")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn velocity_and_acceleration_are_integrated() {
    let expected = [(5.0, (4.0f64).atan2(3.0)), (2.0, -std::f64::consts::FRAC_PI_2), (1.0, std::f64::consts::PI)];
    let pairs = |n: usize| {
        (0..n).map(|n| format!("{:13.5e}{:13.5e}", -1e3 / (n + 2) as f64, 1.0)).collect::<Vec<_>>().join("\n")
    };
    let acceleration = function(2, "         5         3         1", "         5         9         1", &pairs(6));
    for (point, (size, phase)) in acceleration.points.iter().zip(expected) {
        assert!((point.amplitude / (size * 2.5e-6) - 1.0).abs() < 1e-5, "{point:?}");
        assert!((point.phase.expect("a phase").cos() - f64::cos(phase)).abs() < 1e-5, "{point:?}");
        assert!((point.phase.expect("a phase").sin() - f64::sin(phase)).abs() < 1e-5, "{point:?}");
    }
    let velocity = function(3, "         6         3         1  0", "         6         9         1  0", &pairs(6));
    assert_eq!((velocity.points.len(), velocity.points[0].frequency), (8, 25.0));
    for (point, (size, phase)) in velocity.points.iter().zip(&expected[..2]) {
        assert!((point.amplitude / (size * 2.5e-6) - 1.0).abs() < 1e-9, "{point:?}");
        assert!((point.phase.expect("a phase") - phase).abs() < 1e-9, "{point:?}");
    }
    assert!(velocity.notes.iter().any(|note| note.contains("0 Hz")), "{:?}", velocity.notes);
}

#[test]
fn every_broken_universal_file_has_its_message() {
    let text = include_str!("../data/frf.uff");
    let fails = |text: &str, more: &str| read("frf.uff", text.as_bytes(), more).expect_err("refused");
    let one = format!("record = 1\n{SWEEP}");
    insta::assert_snapshot!("uff-several", fails(text, SWEEP));
    insta::assert_snapshot!("uff-no-such-record", fails(text, &format!("record = 4\n{SWEEP}")));
    insta::assert_snapshot!("uff-without-sweep", fails(text, "record = 2"));
    insta::assert_snapshot!(
        "uff-binary",
        fails(
            &text.replacen("    58 ", "    58b", 1).replacen(
                "    58\n",
                "    58b     1     2          11        4096\n",
                1
            ),
            &one
        )
    );
    insta::assert_snapshot!("uff-no-dataset", fails("    -1\n   151\nx\n    -1\n", &one));
    insta::assert_snapshot!("uff-not-universal", fails("speed,load\n1,2\n", &one));
    insta::assert_snapshot!("uff-cut-off", fails(&text[..1100], &one));
    insta::assert_snapshot!(
        "uff-too-few-numbers",
        fails(&text.replacen("         6         3 ", "         6         4 ", 1), &one)
    );
    insta::assert_snapshot!(
        "uff-not-a-number",
        fails(&text.replacen("3.00000000000e+00", "    xxxxxxxxxxxxx", 1), &one)
    );
    insta::assert_snapshot!(
        "uff-not-complex",
        fails(&text.replacen("         6         3 ", "         4         3 ", 1), &one)
    );
    insta::assert_snapshot!(
        "uff-linear-response",
        fails(&text.replacen("rad ", "mm  ", 1).replacen("rad\n", "mm\n", 1), &one)
    );
    insta::assert_snapshot!(
        "uff-force-reference",
        fails(
            &text.replacen("         8    0    0    0 Displacement", "        13    0    0    0 Displacement", 1),
            &one
        )
    );
    insta::assert_snapshot!(
        "uff-only-coherence",
        fails(&text[text.find("    -1\n    58\nCoherence").expect("the last dataset")..], &one)
    );
}

#[test]
fn workbooks_are_tables_too() {
    let bytes = include_bytes!("../data/two-sheets.xlsx");
    let table = read("t.xlsx", bytes, "").unwrap_or_else(|error| panic!("{error}"));
    let seen: Vec<_> = table.points.iter().map(|p| (p.row, p.line, p.frequency, p.amplitude)).collect();
    assert_eq!(seen, [(1, 2, 60.0, 1.5e-6), (2, 4, 61.0, 1.625e-6), (3, 5, 62.0, 1.75e-6)]);
    assert_eq!((table.points[0].speed, table.points[0].drive), (0.02, 2.5e-6));
    assert_eq!(table.notes, ["of 2 sheets the first, `Sweep`, is read", "not used: `remark`"]);
    insta::assert_snapshot!("xlsx-text-in-a-number", read("t.xlsx", bytes, "sheet = 'Faulty'").expect_err("n/a"));
    insta::assert_snapshot!("xlsx-no-such-sheet", read("t.xlsx", bytes, "sheet = 'Sweap'").expect_err("a typo"));
    insta::assert_snapshot!("xlsx-broken", read("t.xlsx", b"PK no", "").expect_err("not a workbook"));
}

/// A universal file with one function of a response over a reference, ten values.
fn response(response: (i64, &str), reference: (i64, &str)) -> String {
    let side = |(kind, unit): (i64, &str)| format!("{kind:>10}    0    0    0 {:<20} {unit:<20}\n", "NONE");
    let values: String = (0..10)
        .map(|n| format!("{:13.5e}{:20.11e}{:20.11e}\n", 50.0 + f64::from(n), 3.0, 4.0 + f64::from(n * n % 5)))
        .collect();
    format!(
        "    -1\n    58\nA function\nNONE\nNONE\nNONE\nNONE\n{:>5}         0    0         0       BEAM         1   3     SHAKER         2   3\n\
         {:>10}{:>10}{:>10}  0.00000e+00  0.00000e+00  0.00000e+00\n{}{}{}{}{values}    -1\n",
        4,
        6,
        10,
        0,
        side((18, "Hz")),
        side(response),
        side(reference),
        side((0, "NONE"))
    )
}

#[test]
fn functions_of_any_oscillator_are_read_as_they_are() {
    let sweep = "[sweep]\nfrequency = 80\ndrive = 2";
    let angle = "coordinate = 'angle'";
    let cases = [
        ((8, "mm"), (13, "N"), "", ("N", "m"), 5e-3 * 2.0),
        ((12, "m/s^2"), (13, "kN"), "", ("N", "m/s^2"), 5e-3 * 2.0),
        // Over the acceleration of the base, of which [sweep] states the displacement.
        ((12, "g"), (12, "g"), "drive = 'base'", ("m", "m/s^2"), -5.0 * 2.0 * (std::f64::consts::TAU * 50.0).powi(2)),
        ((11, "mm/s"), (8, "mm"), "drive = 'base'", ("m", "m/s"), 5.0 * 2.0),
        ((8, "mrad"), (13, "Nm"), angle, ("N m", "rad"), 5e-3 * 2.0),
        ((0, ""), (0, ""), "", ("N", "m"), 5.0 * 2.0),
    ];
    for (above, below, rig, units, amplitude) in cases {
        let text = response(above, below);
        let table =
            super::oscillators::load("t.uff", text.as_bytes(), rig, sweep).unwrap_or_else(|error| panic!("{error}"));
        let point = &table.points[0];
        assert_eq!((table.signals.drive.unit, table.signals.reading.unit), units, "{above:?} {below:?}");
        assert!((point.amplitude / f64::abs(amplitude) - 1.0).abs() < 1e-9, "{above:?} {below:?}: {}", point.amplitude);
        let turned = if amplitude < 0.0 { std::f64::consts::PI } else { 0.0 };
        assert!((point.phase.expect("a phase") + turned - 4f64.atan2(3.0)).abs() < 1e-9, "{point:?}");
        assert_eq!(point.drive, 2.0);
    }
    let fails = |above, below, rig: &str, more: &str| {
        super::oscillators::load("t.uff", response(above, below).as_bytes(), rig, more).expect_err("refused")
    };
    insta::assert_snapshot!("uff-of-another-drive", fails((8, "mm"), (12, "g"), "", sweep));
    insta::assert_snapshot!("uff-of-no-quantity", fails((15, "Pa"), (13, "N"), "", sweep));
    insta::assert_snapshot!("uff-unit-and-kind", fails((12, "mm"), (13, "N"), "", sweep));
}

/// The same file in binary form.
fn binary(text: &str, double: bool, little: bool) -> Vec<u8> {
    let records: Vec<&str> = text.lines().collect();
    let (head, body) = records[2..records.len() - 1].split_at(11);
    let numbers =
        body.iter().flat_map(|line| line.split_whitespace()).map(|text| text.parse::<f64>().expect("a number"));
    let stored = |x: f64| match (double, little) {
        (true, true) => x.to_le_bytes().to_vec(),
        (true, false) => x.to_be_bytes().to_vec(),
        (false, true) => (x as f32).to_le_bytes().to_vec(),
        (false, false) => (x as f32).to_be_bytes().to_vec(),
    };
    let stored: Vec<u8> = numbers.flat_map(stored).collect();
    let (order, length) = (if little { 1 } else { 2 }, stored.len());
    let mut file = format!("    -1\n    58b{order:6}{:6}{:12}{length:12}     0     0           0           0\n", 2, 11);
    for (number, record) in head.iter().enumerate() {
        let of_kind = number == 6 && !double;
        let record = if of_kind { record.replacen("         6", "         5", 1) } else { (*record).into() };
        file += &format!("{record}\n");
    }
    [file.as_bytes(), &stored, b"\n    -1\n"].concat()
}

#[test]
fn the_binary_form_is_read_as_the_text() {
    let text = response((8, "mm"), (13, "N"));
    let of = |bytes: &[u8]| survey_bytes("t.uff", bytes).unwrap_or_else(|error| panic!("{error}")).table.points;
    let expected = of(text.as_bytes());
    for (double, little) in [(true, true), (true, false), (false, true), (false, false)] {
        // A second dataset begins where the first one's numbers end.
        let one = binary(&text, double, little);
        for bytes in [one.clone(), [one.as_slice(), one.as_slice()].concat()] {
            let points = of(&bytes);
            assert_eq!(points.len(), expected.len());
            for (point, expected) in points.iter().zip(&expected) {
                let within = if double { 1e-15 } else { 1e-6 };
                assert!((point.amplitude / expected.amplitude - 1.0).abs() < within, "{double} {little}: {point:?}");
                assert!((point.frequency / expected.frequency - 1.0).abs() < within, "{double} {little}: {point:?}");
            }
        }
    }
    let whole = binary(&text, true, true);
    let fails = |bytes: &[u8]| survey_bytes("t.uff", bytes).expect_err("refused").to_string();
    insta::assert_snapshot!("uff-binary-cut-off", fails(&whole[..whole.len() - 40]));
    // Whatever number of records a broken header promises.
    let endless = String::from_utf8_lossy(&whole).replacen("          11", "  9000000000000000000", 1);
    assert!(fails(endless.as_bytes()).contains("is cut off"));
    let other: Vec<u8> = whole.iter().enumerate().map(|(at, byte)| if at == 24 { b'3' } else { *byte }).collect();
    insta::assert_snapshot!("uff-binary-of-another-form", fails(&other));
}

#[test]
fn a_function_without_a_drive_is_of_one_unit_of_it() {
    let text = response((12, "g"), (12, "g"));
    let table = super::oscillators::load("t.uff", text.as_bytes(), "drive = 'base'", "").expect("sound");
    assert_eq!((table.signals.drive.unit, table.points[0].drive), ("m/s^2", 1.0));
    assert!((table.points[0].amplitude - 5.0).abs() < 1e-9, "{:?}", table.points[0]);
    assert!(table.notes.iter().any(|note| note.contains("a drive of 1 m/s^2")), "{:?}", table.notes);
    // By itself it says the same, and its units what it is of where it states no kind of data.
    for ((above, unit), below, units, amplitude) in [
        ((8, "mm"), (13, "N"), ("N", "m"), 5e-3),
        ((8, "mrad"), (13, "Nm"), ("N m", "rad"), 5e-3),
        ((1, "m/s^2"), (1, "kN"), ("N", "m/s^2"), 5e-3),
        ((1, "g"), (1, "N"), ("N", "m/s^2"), 5.0 * 9.80665),
    ] {
        let of = |text: &str| survey_bytes("t.uff", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        let text = response((above, unit), below);
        let (one, twice) = (of(&text), of(&(response((above, unit), below) + &text)));
        assert_eq!((one.table.signals.drive.unit, one.table.signals.reading.unit), units);
        assert!((one.table.points[0].amplitude / amplitude - 1.0).abs() < 1e-9, "{:?}", one.table.points[0]);
        assert_eq!((one.record, twice.record), (None, Some(1)), "the first of two");
        // Where response and reference are one place it is the one to look at.
        let driving = text.replace("     SHAKER         2   3", "       BEAM         1   3");
        assert_eq!(of(&(text + &driving)).record, Some(2));
    }
    let unknown = survey_bytes("t.uff", response((1, ""), (1, "")).as_bytes()).expect_err("no quantity").to_string();
    insta::assert_snapshot!("uff-survey-of-no-quantity", unknown);
}
