//! Tables of measured steady states: every form that is read, what becomes of it, and what is said about broken ones.
//!
//! The message for each broken table is a snapshot under `tests/snapshots`, word for word.

use std::path::Path;

use stickslip::measurement::{self, NoiseSource, Point, Scatter, Table, scatter};
use stickslip::scenario;

const BASE: &str = include_str!("broken/base.toml");
const PRACTICE: &str = include_str!("data/practice-1.csv");
const HEADER: &str = "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad,phase_rad,phase_sd_rad";
const SWEEP: &str = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = 20\ndrive = 2.5e-6\n";

/// Reads a file beside a scenario that says `more` under `[measurement]`; messages name it without its folder.
fn read(name: &str, bytes: &[u8], more: &str) -> Result<Table, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(folder.path().join(name), bytes).expect("a file");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = '{name}'\n{more}\n")).expect("a file");
    let told = |error: stickslip::error::Error| {
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let table = measurement::load(&scenario::load(scenario).map_err(told)?).map_err(told)?;
    Ok(table.expect("the scenario names a table"))
}

fn csv(text: &str) -> Table {
    read("table.csv", text.as_bytes(), "").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    read("table.csv", text.as_bytes(), "").expect_err("the table is broken")
}

/// A table of the standard columns with one sound row and then `row`.
fn with_row(row: &str) -> String {
    format!("{HEADER}\n0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01\n{row}\n")
}

#[test]
fn every_broken_table_has_its_message() {
    let rows = [
        ("table-text-in-a-number", "0.02,20,2.5e-6,61,n/a,1.5e-8,-0.1,0.01"),
        ("table-nan", "0.02,20,2.5e-6,61,NaN,1.5e-8,-0.1,0.01"),
        ("table-infinite", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-inf,0.01"),
        ("table-too-large-for-a-double", "0.02,20,2.5e-6,61,1e999,1.5e-8,-0.1,0.01"),
        ("table-negative-amplitude", "0.02,20,2.5e-6,61,-1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-frequency-zero", "0.02,20,2.5e-6,0,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-negative-load", "0.02,-20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-negative-speed", "-0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-drive-zero", "0.02,20,0,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-deviation-zero", "0.02,20,2.5e-6,61,1.5e-6,0,-0.1,0.01"),
        ("table-deviation-negative", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,-0.01"),
        ("table-deviation-empty", "0.02,20,2.5e-6,61,1.5e-6,,-0.1,0.01"),
        ("table-amplitude-empty", "0.02,20,2.5e-6,61,,1.5e-8,-0.1,0.01"),
        ("table-amplitude-in-wrong-unit", "0.02,20,2.5e-6,61,1.5,1.5e-8,-0.1,0.01"),
        ("table-phase-in-degrees", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-170,0.01"),
        ("table-unit-in-a-cell", "20 mm/s,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-row-too-short", "0.02,20,2.5e-6,61,1.5e-6"),
        ("table-row-too-long", "0,02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-row-twice", "# a remark\n\n0.02,20,2.5e-6,60.0,1.50e-6,1.5e-8,-0.1,0.01"),
        ("table-several-problems", "0.02,20,2.5e-6,-1,x,1.5e-8,-0.1,\n0.02,W,2.5e-6,60,1,1.5e-8,-0.1,0.01"),
    ];
    for (name, row) in rows {
        insta::assert_snapshot!(name, refused(&with_row(row)));
    }
    let row = "0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01";
    let whole = [
        ("table-header-only", format!("{HEADER}\n")),
        ("table-remarks-only", "# nothing\n".into()),
        ("table-empty", "\n".into()),
        ("table-without-header", format!("{row}\n{row}\n")),
        ("table-column-missing", format!("{}\n{row}\n", HEADER.replace("amplitude_rad", "ampltude_rad"))),
        ("table-columns-missing", "f [Hz];A [rad]\n60;1e-6\n".into()),
        ("table-column-twice", format!("{}\n{row}\n", HEADER.replace("phase_sd_rad", "amplitude_urad"))),
        ("table-unit-of-another-kind", format!("{}\n{row}\n", HEADER.replace("speed_m_s", "speed [N]"))),
        ("table-unit-unknown", format!("{}\n{row}\n", HEADER.replace("drive_m", "drive [furlong]"))),
        ("table-phase-in-percent", format!("{}\n{row}\n", HEADER.replace("phase_rad", "phase_percent"))),
        (
            "table-decimal-commas-and-points",
            with_row("0.03,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01").replace(',', ";").replacen("0.03", "0,03", 1),
        ),
        ("table-decimal-commas-and-tabs", with_row(row).replace(',', "\t").replace("0.02", "0,02")),
        (
            "table-amplitude-zero",
            "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_percent\n0,20,1e-6,60,0,1\n".into(),
        ),
        (
            "table-noise-unknown",
            "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad\n0,20,1e-6,60,1e-6\n0,20,1e-6,61,1e-6\n".into(),
        ),
    ];
    for (name, text) in whole {
        insta::assert_snapshot!(name, refused(&text));
    }
    let noise =
        "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_percent,phase_rad\n0,20,1e-6,60,1e-6,1,0\n";
    insta::assert_snapshot!("table-phase-noise-unknown", refused(noise));
    let many: String = (0..1000).map(|n| format!("0.02,20,2.5e-6,{n},x,1.5e-8,-0.1,0.01\n")).collect();
    let message = refused(&with_row(&many));
    assert!(message.ends_with("more problems are not shown") && message.len() < 10_000, "{message}");
}

#[test]
fn files_of_other_kinds_are_refused() {
    let fails = |name: &str, bytes: &[u8], more: &str| read(name, bytes, more).expect_err("refused");
    insta::assert_snapshot!("table-binary", fails("table.csv", b"a,b\n\x00\x01", ""));
    insta::assert_snapshot!("table-utf-16", fails("table.csv", b"\xff\xfes\0p\0", ""));
    insta::assert_snapshot!("table-of-unknown-kind", fails("table.pdf", b"x", ""));
    insta::assert_snapshot!(
        "table-mapping-without-column",
        fails("table.csv", with_row("").as_bytes(), "columns = { phase = 'phse_rad' }")
    );
    insta::assert_snapshot!(
        "table-mapping-twice",
        fails("table.csv", with_row("").as_bytes(), "columns = { phase = 'load_n', mean = 'load_n' }")
    );
    insta::assert_snapshot!(
        "table-mapping-wrong-unit",
        fails("table.csv", b"f [N]\n1\n", "columns = { frequency = 'f [N]' }")
    );
    insta::assert_snapshot!("table-record-not-a-number", fails("table.csv", b"", "record = 1.5"));
}

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
fn repeated_readings_are_pooled() {
    let head = "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad,phase_deg,phase_sd_deg";
    let table = csv(&format!(
        "{head}\n0,20,1e-6,60,1e-6,1e-8,179,1\n0,20,1e-6,60,1.03e-6,2e-8,-179,1\n0,20,1e-6,61,1e-6,1e-8,0,1\n"
    ));
    let point = &table.points[0];
    assert_eq!((point.replicates, point.row, table.points.len()), (2, 1, 2));
    // Weights 4 : 1, and 1/sd^2 = (1/4 + 1) 1e16; the phases lie on both sides of 180 degrees.
    assert!(
        (point.amplitude / 1.006e-6 - 1.0).abs() < 1e-12 && (point.amplitude_sd / 0.8f64.sqrt() - 1e-8).abs() < 1e-20
    );
    assert!((point.phase.expect("a phase").abs() - std::f64::consts::PI).abs() < 1e-12);
    assert!((point.phase_sd.expect("sd") - 1f64.to_radians() / 2f64.sqrt()).abs() < 1e-12);
    assert!(table.notes[0].contains("3 rows are 2 points"), "{:?}", table.notes);
    // Three readings that differ by more than they state: spread 0.1/sqrt(3) of the mean 1.1.
    let table = csv(&format!(
        "{head}\n0,20,1e-6,60,1e-6,1e-9,0,1\n0,20,1e-6,60,1.1e-6,1e-9,1,1\n0,20,1e-6,60,1.2e-6,1e-9,2,1\n"
    ));
    assert!((table.points[0].amplitude_sd / (1e-7 / 3f64.sqrt()) - 1.0).abs() < 1e-9);
    // A column of one's own tells a repetition with equal digits from a copy.
    let table = csv(
        "run,speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad\n1,0,20,1e-6,60,1e-6,1e-8\n2,0,20,1e-6,60,1e-6,1e-8\n",
    );
    assert_eq!(table.points[0].replicates, 2);
}

/// Normal deviates from a fixed seed.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// A resonance at 72 Hz with Q = 7, 24 frequencies; relative noise of the amplitude, noise of the phase.
fn resonance(noise: &mut Noise, relative: f64, turn: Option<f64>) -> Vec<Point> {
    let point = |n: usize| {
        let frequency = 52.0 + 2.0 * n as f64;
        let (re, im) = (1.0 - (frequency / 72.0).powi(2), frequency / 72.0 / 7.0);
        let amplitude = 1e-6 / re.hypot(im) * (1.0 + relative * noise.normal());
        let phase = turn.map(|turn| -im.atan2(re) + turn * noise.normal());
        let (amplitude_sd, phase_sd) = (relative * amplitude, turn);
        Point {
            row: n + 1,
            line: n + 2,
            speed: 0.0,
            load: 20.0,
            drive: 2.5e-6,
            frequency,
            amplitude,
            phase,
            amplitude_sd,
            phase_sd,
            mean: None,
            replicates: 1,
        }
    };
    (0..24).map(point).collect()
}

#[test]
fn the_noise_of_a_resonance_is_found() {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    for (relative, turn) in [
        (0.003, Some(0.003)),
        (0.01, Some(0.01)),
        (0.03, Some(0.03)),
        (0.003, None),
        (0.01, None),
        (0.03, None),
        (0.01, Some(0.03)),
        (0.003, Some(0.01)),
    ] {
        let seen: Vec<Scatter> = (0..100).map(|_| scatter(&resonance(&mut noise, relative, turn))).collect();
        let mean = |of: fn(&Scatter) -> f64| seen.iter().map(of).sum::<f64>() / seen.len() as f64;
        let amplitude = mean(|s| s.amplitude.expect("24 points").sd) / relative;
        assert!((amplitude - 1.0).abs() < 0.15, "amplitude, {relative} {turn:?}: {amplitude}");
        if let Some(turn) = turn {
            let phase = mean(|s| s.phase.expect("24 points").sd) / turn;
            assert!((phase - 1.0).abs() < 0.15, "phase, {relative} {turn}: {phase}");
        }
    }
}

#[test]
fn outliers_and_jumps_do_not_count_as_noise() {
    let mut noise = Noise(0x1234_5678_9abc_def1);
    let mean = (0..100).map(|_| {
        let mut points = resonance(&mut noise, 0.01, Some(0.01));
        points[5].amplitude *= 1.5;
        points.iter_mut().skip(18).for_each(|point| point.amplitude *= 1.2);
        scatter(&points).amplitude.expect("24 points").sd / 100.0
    });
    let mean: f64 = mean.sum();
    assert!((0.008..0.016).contains(&mean), "{mean}");
}

#[test]
fn noise_that_is_not_stated_is_estimated_and_said_to_be() {
    let bare = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [&cells[..5], &cells[6..7]].concat().join(",")
    };
    let table = csv(&PRACTICE.lines().map(bare).collect::<Vec<_>>().join("\n"));
    assert_eq!((table.amplitude_noise, table.phase_noise), (NoiseSource::Estimated, Some(NoiseSource::Estimated)));
    for point in &table.points {
        let (relative, phase) = (point.amplitude_sd / point.amplitude, point.phase_sd.expect("estimated"));
        assert!((0.0085..0.0115).contains(&relative) && (0.0085..0.0115).contains(&phase), "{relative} {phase}");
    }
    assert!(
        table.notes[0].starts_with("no noise of the amplitude is stated: 1 % was estimated")
            || table.notes[0].contains("1.1 %"),
        "{:?}",
        table.notes
    );
    let mut noise = Noise(77);
    let rows = (0..60).map(|n| {
        let frequency = 60 + n / 6;
        format!("0,20,1e-6,{frequency},{:e}\n", 1e-6 * (1.0 + 0.02 * noise.normal()))
    });
    let table = csv(&format!("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad\n{}", rows.collect::<String>()));
    assert_eq!((table.amplitude_noise, table.phase_noise, table.points.len()), (NoiseSource::Replicates, None, 10));
    let relative =
        table.points.iter().map(|p| p.amplitude_sd / p.amplitude).fold(f64::INFINITY, f64::min) * 6f64.sqrt();
    assert!((0.016..0.024).contains(&relative), "{relative}");
    let wrong = csv(&PRACTICE.replace(",0.01\n", ",0.0001\n"));
    assert!(wrong.notes[0].contains("check the column"), "{:?}", wrong.notes);
}

#[test]
fn universal_files_give_what_was_computed_by_hand() {
    let bytes = include_bytes!("data/frf.uff");
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
    let text = include_str!("data/frf.uff").replacen(from, to, 1);
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
    let text = include_str!("data/frf.uff");
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
        read("t.xlsx", include_bytes!("data/two-sheets.xlsx"), "").expect_err("not built in")
    );
}

#[cfg(feature = "xlsx")]
#[test]
fn workbooks_are_tables_too() {
    let bytes = include_bytes!("data/two-sheets.xlsx");
    let table = read("t.xlsx", bytes, "").unwrap_or_else(|error| panic!("{error}"));
    let seen: Vec<_> = table.points.iter().map(|p| (p.row, p.line, p.frequency, p.amplitude)).collect();
    assert_eq!(seen, [(1, 2, 60.0, 1.5e-6), (2, 4, 61.0, 1.625e-6), (3, 5, 62.0, 1.75e-6)]);
    assert_eq!((table.points[0].speed, table.points[0].drive), (0.02, 2.5e-6));
    assert_eq!(table.notes, ["of 2 sheets the first, `Sweep`, is read", "not used: `remark`"]);
    insta::assert_snapshot!("xlsx-text-in-a-number", read("t.xlsx", bytes, "sheet = 'Faulty'").expect_err("n/a"));
    insta::assert_snapshot!("xlsx-no-such-sheet", read("t.xlsx", bytes, "sheet = 'Sweap'").expect_err("a typo"));
    insta::assert_snapshot!("xlsx-broken", read("t.xlsx", b"PK no", "").expect_err("not a workbook"));
}

#[test]
fn the_measured_file_is_never_touched() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    std::fs::write(&path, PRACTICE).expect("a file");
    let scenario = folder.path().join("own.toml");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = 'table.csv'\n")).expect("a file");
    let modified = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified()).expect("a time");
    let before = modified(&path);
    let mut permissions = std::fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).expect("read only");
    stickslip::cli::check::execute(std::slice::from_ref(&scenario)).expect("sound");
    assert_eq!((std::fs::read(&path).expect("there"), modified(&path)), (PRACTICE.as_bytes().to_vec(), before));
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 2, "nothing is written beside it");
    std::fs::write(folder.path().join("broken.csv"), with_row("x")).expect("a file");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = 'broken.csv'\n")).expect("a file");
    let error = stickslip::cli::check::execute(&[scenario]).expect_err("ragged").to_string();
    assert!(error.contains("broken.csv:3"), "{error}");
}

#[test]
fn a_scenario_without_measurements_has_no_table() {
    assert_eq!(measurement::load(&scenario::paper()).expect("nothing to read"), None);
}

#[test]
fn nothing_panics_whatever_the_bytes() {
    let sources = [
        ("t.csv", PRACTICE.lines().take(8).collect::<Vec<_>>().join("\n")),
        ("t.uff", include_str!("data/frf.uff").to_string()),
    ];
    const SPLICES: &[&str] =
        &["9e999", "\"", ",", ";", "\t", "[", "]", "\n", "µ", "-", "nan", "#", "%", "\u{feff}", "\r", "🙂", "    -1\n"];
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = Noise(99);
    let mut random = |below: usize| (noise.uniform() * below as f64) as usize;
    for (name, text) in sources {
        let path = folder.path().join("scenario.toml");
        std::fs::write(folder.path().join(name), &text).expect("a file");
        std::fs::write(&path, format!("{BASE}\n[measurement]\nfile = '{name}'\nrecord = 1\n{SWEEP}")).expect("a file");
        let scenario = scenario::load(&path).expect("sound");
        for _ in 0..1000 {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..=random(4) {
                let at = random(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
                match random(3) {
                    0 if !bytes.is_empty() => bytes[at] = random(256) as u8,
                    1 => drop(bytes.drain(at..(at + random(60)).min(bytes.len()))),
                    _ => drop(bytes.splice(at..at, SPLICES[random(SPLICES.len())].bytes())),
                }
            }
            std::fs::write(folder.path().join(name), &bytes).expect("a file");
            if let Err(error) = measurement::load(&scenario) {
                assert_eq!(error.exit_code(), 2, "{error}");
            }
        }
    }
}
