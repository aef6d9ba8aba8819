//! Universal files and workbooks.

use stickslip::measurement::Table;

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

#[cfg(not(feature = "xlsx"))]
#[test]
fn workbooks_need_the_feature() {
    insta::assert_snapshot!(
        "xlsx-without-feature",
        read("t.xlsx", include_bytes!("../data/two-sheets.xlsx"), "").expect_err("not built in")
    );
}

#[cfg(feature = "xlsx")]
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
