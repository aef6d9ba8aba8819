//! What decides nothing: order, separators, units, spellings; and how foreign tables are mapped.

use stickslip::measurement::{NoiseSource, Point, Table};

use super::{HEADER, PRACTICE, SWEEP, csv, read, with_row};

fn same(a: &Table, b: &Table, what: &str) {
    assert_eq!(a.points.len(), b.points.len(), "{what}");
    for (a, b) in a.points.iter().zip(&b.points) {
        let numbers = |p: &Point| [p.speed, p.load, p.drive, p.frequency, p.amplitude];
        assert_eq!(numbers(a), numbers(b), "{what}");
        let near = |a: Option<f64>, b: Option<f64>| {
            a.zip(b).map_or(a == b, |(a, b)| (a - b).abs() <= 1e-14 * b.abs().max(1e-9))
        };
        assert!(
            near(a.phase, b.phase) && near(a.phase_sd, b.phase_sd) && near(Some(a.amplitude_sd), Some(b.amplitude_sd)),
            "{what}: {a:?} {b:?}"
        );
    }
}

#[test]
fn the_order_of_rows_and_columns_decides_nothing() {
    let table = csv(PRACTICE);
    assert_eq!((table.points.len(), table.amplitude_noise), (312, NoiseSource::Stated));
    assert_eq!(
        table.summary(),
        "312 points, 13 conditions, 52-98 Hz, amplitude and phase, noise stated 1.0 % and 0.57 deg"
    );
    assert_eq!(table.hash, blake3::hash(PRACTICE.as_bytes()).to_hex().to_string());
    assert!(table.notes.is_empty(), "{:?}", table.notes);
    let (header, rows) = PRACTICE.split_once('\n').expect("a header");
    let mut lines: Vec<&str> = rows.lines().collect();
    lines.reverse();
    let reversed = csv(&format!("{header}\n{}\n", lines.join("\n")));
    same(&table, &reversed, "rows reversed");
    for (a, b) in table.points.iter().zip(&reversed.points) {
        assert_eq!((a.row + b.row, a.line), (313, a.row + 1), "rows and lines are those of the file");
    }
    let mirror = |line: &str| line.split(',').rev().collect::<Vec<_>>().join(",");
    same(&table, &csv(&PRACTICE.lines().map(mirror).collect::<Vec<_>>().join("\n")), "columns reversed");
}

#[test]
fn separators_line_ends_and_remarks_decide_nothing() {
    let table = csv(PRACTICE);
    same(&table, &csv(&PRACTICE.replace(',', ";")), "semicolons");
    same(&table, &csv(&PRACTICE.replace(',', ";").replace('.', ",")), "semicolons and decimal commas");
    same(&table, &csv(&PRACTICE.replace(',', "\t")), "tabs");
    same(&table, &csv(&PRACTICE.replace(',', " , ")), "blanks");
    same(&table, &csv(&format!("\u{feff}{}", PRACTICE.replace('\n', "\r\n"))), "Windows");
    same(&table, &csv(&PRACTICE.replace('\n', "\r")), "old Macintosh");
    let remarks = format!("# first\n\n{}\n# last", PRACTICE.replace("\n0.0,", "\n\n# remark\n0.0,"));
    let remarked = csv(&remarks);
    same(&table, &remarked, "remarks");
    let point = &remarked.points[100];
    let line = remarks.lines().nth(point.line - 1).expect("a line");
    assert!(
        line.contains(&format!("{:.5e}", point.amplitude)) || line.contains(&format!("{:.1}", point.frequency)),
        "{line}"
    );
    let latin = HEADER.replace("phase_rad", "phase [°]").chars().map(|c| c as u8).collect::<Vec<_>>();
    let table = read("t.csv", &[&latin[..], b"\n0,20,1e-6,60,1e-6,1e-8,90,0.1\n"].concat(), "").expect("Latin-1");
    assert_eq!(table.points[0].phase, Some(90f64.to_radians()));
    assert!(table.notes[0].contains("Latin-1"));
}

#[test]
fn units_and_spellings_decide_nothing() {
    let row = |text: &str| {
        let (header, cells) = text.split_once('|').expect("both");
        let table = csv(&format!("{header}\n{cells}\n"));
        table.points[0].clone()
    };
    let si = row(
        "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad|0.02,1200,2.5e-6,61.7,1.48041e-6,1.48041e-8",
    );
    for text in [
        "speed_mm_s,load_kn,drive_um,frequency_khz,amplitude_urad,amplitude_sd_percent|20,1.2,2.5,0.0617,1.48041,1",
        "Speed [mm/s],Load [kN],Drive [µm],Frequency [kHz],Amplitude [µrad],Amplitude SD [%]|20,1.2,2.5,0.0617,1.48041,1",
        "SPEED_CM_S,LOAD_N,DRIVE_NM,FREQUENCY_HZ,AMPLITUDE_MRAD,AMPLITUDE_SD_URAD|2,1200,2500,61.7,1.48041e-3,1.48041e-2",
        "speed (mm/s);load;drive [μm];frequency;amplitude_nrad;amplitude_sd_mrad|20;1200;2,5;61,7;1480,41;1,48041e-5",
    ] {
        let point = row(text);
        assert_eq!((point.speed, point.load, point.drive), (si.speed, si.load, si.drive), "{text}");
        assert_eq!((point.frequency, point.amplitude), (si.frequency, si.amplitude), "{text}");
        assert!((point.amplitude_sd / si.amplitude_sd - 1.0).abs() < 1e-12, "{text}");
    }
    let angular = row(
        "speed_m_s,load_n,drive_m,frequency [rad/s],amplitude_rad,amplitude_sd_percent|0,0,1e-6,376.99111843077515,1e-6,1",
    );
    assert!((angular.frequency - 60.0).abs() < 1e-12);
    for (written, meant) in [(190.0, -170.0), (-190.0, 170.0), (180.0, 180.0), (-180.0, 180.0), (-700.0, 20.0)] {
        let text = format!(
            "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_percent,phase_deg,phase_sd_deg|0,0,1e-6,60,1e-6,1,{written},1"
        );
        let phase = row(&text).phase.expect("a phase");
        assert!((phase - f64::to_radians(meant)).abs() < 1e-12, "{written}: {phase}");
    }
}

#[test]
fn foreign_tables_are_mapped_and_the_rest_is_named() {
    let text = "run\tv_mm_s\tf [kHz]\tRe\tampltude\tphase_deg\n7\t20\t0.06\t1\t1e-6\t-5\n8\t20\t0.07\t1\t2e-6\t\n";
    let more = format!(
        "columns = {{ speed = 'v_mm_s', frequency = 'F [kHz]', amplitude = 'ampltude', amplitude_sd = 'Re' }}\n{SWEEP}"
    );
    let text = text.replace("\t1\t", "\t1e-8\t");
    let table = read("t.txt", text.replace("phase_deg", "phase_sd_deg").as_bytes(), &more).expect("sound");
    let point = &table.points[1];
    assert_eq!((point.speed, point.frequency, point.amplitude, point.amplitude_sd), (0.02, 70.0, 2e-6, 1e-8));
    assert_eq!((point.load, point.drive, point.phase, point.phase_sd), (20.0, 2.5e-6, None, None));
    insta::assert_snapshot!("table-notes", table.notes.join("\n"));
    let swept = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = [10, 20]\ndrive = 2.5e-6\n";
    insta::assert_snapshot!(
        "table-load-swept",
        read("t.csv", b"frequency_hz,amplitude_rad\n1,1\n", swept).expect_err("no load")
    );
    let table =
        read("t.csv", with_row("").as_bytes(), "columns = { amplitude = 'amplitude_rad' }\nrecord = 1\nsheet = 'x'")
            .expect("sound");
    assert!(
        table.notes.iter().filter(|note| note.contains("is not used: it belongs to")).count() == 2,
        "{:?}",
        table.notes
    );
}

#[test]
fn a_phase_may_be_missing_in_single_rows() {
    let table = csv(&with_row("0.02,20,2.5e-6,61,1.5e-6,1.5e-8,,"));
    assert_eq!((table.points[1].phase, table.points[1].phase_sd, table.points[1].frequency), (None, None, 61.0));
    assert_eq!(table.phase_noise, Some(NoiseSource::Stated));
    assert_eq!(table.notes, ["1 of 2 rows have no phase"]);
    assert!(table.summary().contains("amplitude and some phases"), "{}", table.summary());
}

#[test]
fn values_that_differ_by_rounding_are_one_condition() {
    let table = csv(&with_row(&format!("0.02,20,2.5e-6,{},1.51e-6,1.5e-8,-0.1,0.01", 60.0 + 1e-12)));
    assert_eq!((table.points.len(), table.points[0].replicates, table.points[0].frequency), (1, 2, 60.0));
}
