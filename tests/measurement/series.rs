//! Series: which rows are one sweep, which way it went, and what is judged along it.

use stickslip::measurement::{Direction, NoiseSource, Table};

use super::csv;
use super::noise::Noise;
use super::oscillators::load;

/// Frequency, drive, amplitude and phase of a row.
type Row = [f64; 4];

/// How the drive is held.
#[derive(Clone, Copy)]
enum Hold {
    /// At a level.
    Drive,
    /// At a level that a shaker does not keep at the resonance.
    Weakly,
    /// Such that the response is level.
    Response,
}

/// Rows of an oscillator of 80 Hz and Q = 100 at frequencies from 76 to 84 Hz; the drive is read with a relative noise.
fn sweep(level: f64, hold: Hold, steps: impl Iterator<Item = usize>, noise: &mut Noise) -> Vec<Row> {
    let row = |n: usize| {
        let frequency = 76.0 + 0.1 * n as f64;
        let ratio = frequency / 80.0;
        let (re, im) = (1.0 - ratio * ratio, ratio / 100.0);
        let size = 1.0 / re.hypot(im);
        let drive = match hold {
            Hold::Drive => level,
            Hold::Weakly => level / (1.0 + 0.05 * size),
            Hold::Response => level / size,
        };
        [frequency, drive * (1.0 + 0.002 * noise.normal()), 1e-6 * drive * size, -im.atan2(re)]
    };
    steps.map(row).collect()
}

fn up() -> impl Iterator<Item = usize> {
    0..81
}

fn down() -> impl Iterator<Item = usize> {
    (0..81).rev()
}

fn text(rows: &[Row]) -> String {
    let lines = rows.iter().map(|[f, drive, amplitude, phase]| format!("{f},{drive:e},{amplitude:e},{phase},1,0.01\n"));
    format!(
        "frequency_hz,force_n,amplitude_m,phase_rad,amplitude_sd_percent,phase_sd_rad\n{}",
        lines.collect::<String>()
    )
}

fn oscillator(text: &str) -> Table {
    load("t.csv", text.as_bytes(), "", "").unwrap_or_else(|error| panic!("{error}"))
}

/// Number of points and direction of every series.
fn found(table: &Table) -> Vec<(usize, Direction)> {
    let count = |number: usize| table.points.iter().filter(|point| point.series == number).count();
    table.series.iter().enumerate().map(|(number, series)| (count(number), series.direction)).collect()
}

/// Two loads and two speeds, each of one sweep of 12 rows, all read row by row about their settings.
#[test]
fn loads_and_speeds_that_are_measured_row_by_row_are_settings() {
    let text = |scatter: f64, steps: f64| {
        let of = |row: u32, dimension: u32, value: f64| {
            let share = 1.0 + scatter * (f64::from(sobol_burley::sample(row, dimension, 9)) - 0.5);
            (value * share / steps).round() * steps
        };
        let row = |row: u32| {
            let (load, speed) = ([4.0, 6.0][row as usize / 24], [0.01, 0.02][row as usize / 12 % 2]);
            let (n, size) = (row % 12, 1e-5 * (1.0 + f64::from(row % 5)));
            format!("{},{},{},0.3,{size},-1\n", 34 + n, of(row, 0, load), of(row, 1, speed))
        };
        format!("frequency_hz,load_n,speed_m_s,force_n,amplitude_m,phase_rad\n{}", (0..48).map(row).collect::<String>())
    };
    let settings = |text: &str| {
        let seen =
            stickslip::measurement::survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        let said = seen.table.notes.iter().filter(|note| note.contains("waver from row to row")).count();
        (seen.table.series.iter().map(|s| (s.load, s.speed)).collect::<Vec<_>>(), said)
    };
    let made = [(4.0, 0.01), (4.0, 0.02), (6.0, 0.01), (6.0, 0.02)];
    assert_eq!(settings(&text(0.0, 1e-9)).1, 0);
    // As finely as they were read, and as a display rounds them.
    for (scatter, steps) in [(0.04, 1e-9), (0.01, 1e-9), (0.01, 1e-3)] {
        let (found, said) = settings(&text(scatter, steps));
        assert_eq!(found.len(), 4, "{scatter} {steps}: {found:?}");
        assert!(said > 0);
        for ((load, speed), (own_load, own_speed)) in found.iter().zip(made) {
            assert!((load / own_load - 1.0).abs() < scatter && (speed / own_speed - 1.0).abs() < scatter, "{found:?}");
        }
    }
    // Settings that differ as little stay apart, also where they are gone through at every frequency.
    let near = text(0.0, 1e-9).replace(",6,", ",4.2,");
    let (found, said) = settings(&near);
    assert_eq!((found.len(), said), (4, 0), "{found:?}");
    let mut lines: Vec<&str> = near.lines().collect();
    lines[1..].sort_by_key(|line| line.split(',').next().map(str::to_string));
    let (found, said) = settings(&(lines.join("\n") + "\n"));
    assert_eq!((found.len(), said), (4, 0), "{found:?}");
}

#[test]
// Long: a list of cases made from the same sweeps.
fn sweeps_are_told_by_the_order_of_the_rows_where_the_drive_was_measured() {
    use Direction::{Down, Unknown, Up};
    use Hold::{Drive, Response, Weakly};
    let mut noise = Noise(0x5eed_0001);
    let mut of = |level: f64, hold: Hold, steps: &mut dyn Iterator<Item = usize>| sweep(level, hold, steps, &mut noise);
    let levels: Vec<Vec<Row>> = [1.0, 3.0, 10.0].map(|level| of(level, Drive, &mut up())).into();
    let shuffled = |rows: &[Row], seed: u64| {
        let (mut rows, mut noise) = (rows.to_vec(), Noise(seed));
        for at in (1..rows.len()).rev() {
            rows.swap(at, (noise.uniform() * (at + 1) as f64) as usize);
        }
        rows
    };
    let transposed: Vec<Row> = (0..81).flat_map(|n| levels.iter().map(move |rows| rows[n])).collect();
    let mut slipped = of(1.0, Drive, &mut up());
    slipped.swap(30, 31);
    // A fold: the amplitude jumps up by five, and the shaker yields.
    let mut fold = of(1.0, Weakly, &mut up());
    for row in &mut fold[35..] {
        (row[1], row[2]) = (0.6 * row[1], 5.0 * row[2]);
    }
    let coarse: Vec<Row> = of(1.0, Response, &mut up())
        .into_iter()
        .map(|[f, drive, amplitude, phase]| [f, format!("{drive:.1e}").parse().expect("a number"), amplitude, phase])
        .collect();
    // A level that was set, and another at two readings.
    let mut set = of(1.0, Drive, &mut up());
    set.iter_mut().for_each(|row| row[1] = 1.0);
    (set[40][1], set[80][1]) = (0.97, 0.99);
    let cases = [
        ("one level but at two readings", set, vec![(81, Up)]),
        ("three levels", levels.concat(), vec![(81, Up); 3]),
        ("up and down", [of(1.0, Drive, &mut up()), of(1.0, Drive, &mut down())].concat(), vec![(81, Up), (81, Down)]),
        (
            "level by level",
            [of(1.0, Drive, &mut up()), of(2.0, Drive, &mut down())].concat(),
            vec![(81, Up), (81, Down)],
        ),
        ("a shaker that yields", of(1.0, Weakly, &mut up()), vec![(81, Up)]),
        ("the response held", of(1.0, Response, &mut up()), vec![(81, Up)]),
        ("the response held twice", [1.0, 1.1].map(|level| of(level, Response, &mut up())).concat(), vec![(81, Up); 2]),
        ("the response held, read coarsely", coarse, vec![(81, Up)]),
        ("a fold", fold, vec![(81, Up)]),
        ("downwards", of(1.0, Weakly, &mut down()), vec![(81, Down)]),
        ("two rows swapped", slipped, vec![(81, Up)]),
        ("no order", shuffled(&levels.concat(), 7), vec![(81, Unknown); 3]),
        ("no order, the response held", shuffled(&of(1.0, Response, &mut up()), 8), vec![(81, Unknown)]),
        ("all levels at each frequency", transposed, vec![(81, Up); 3]),
        (
            "a coarse sweep and a fine one",
            [of(1.0, Drive, &mut (0..81).step_by(4)), of(1.0, Drive, &mut (30..50))].concat(),
            vec![(21, Up), (20, Up)],
        ),
    ];
    for (name, rows, expected) in cases {
        let table = oscillator(&text(&rows));
        let mut seen = found(&table);
        let mut expected = expected;
        // Series at nearly the same level may stand either way round.
        seen.sort_by_key(|(count, way)| (*count, *way == Up));
        expected.sort_by_key(|(count, way)| (*count, *way == Up));
        assert_eq!(seen, expected, "{name}");
        let sorted = table.points.windows(2).all(|p| (p[0].series, p[0].frequency) < (p[1].series, p[1].frequency));
        assert!(sorted, "{name}: by series, then frequency");
        for (number, series) in table.series.iter().enumerate() {
            let drives = table.points.iter().filter(|point| point.series == number).map(|point| point.drive);
            let range = drives.fold((f64::INFINITY, 0.0_f64), |(low, high), drive| (low.min(drive), high.max(drive)));
            assert!(series.drives == range && range.0 <= series.drive && series.drive <= range.1, "{name}: {series:?}");
        }
        let told = format!("{} series", table.series.len());
        assert!(table.summary().contains(&told), "{name}: {}", table.summary());
    }
}

#[test]
fn set_drives_are_conditions_and_both_ways_are_told_apart() {
    let set = |level: f64, steps: &mut dyn Iterator<Item = usize>| {
        let mut rows = sweep(level, Hold::Drive, steps, &mut Noise(5));
        rows.iter_mut().for_each(|row| row[1] = level);
        rows
    };
    use Direction::{Down, Up};
    let two = oscillator(&text(&[set(1.0, &mut up()), set(2.0, &mut up())].concat()));
    assert_eq!(found(&two), [(81, Up), (81, Up)]);
    assert!(two.summary().starts_with("162 points, 2 conditions, 76-84 Hz"), "{}", two.summary());
    assert_eq!(two.ranges(), "force 1 N to 2 N, displacement 9.71 µm to 200 µm");
    let both = oscillator(&text(&[set(1.0, &mut up()), set(1.0, &mut down())].concat()));
    assert_eq!(found(&both), [(81, Up), (81, Down)]);
    assert!(both.summary().starts_with("162 points, 2 series"), "{}", both.summary());
    // The same sweep twice is a repetition.
    let mut again = set(1.0, &mut up());
    again.iter_mut().for_each(|row| row[2] *= 1.001);
    let twice = oscillator(&text(&[set(1.0, &mut up()), again].concat()));
    assert_eq!((found(&twice), twice.points[0].replicates), (vec![(81, Up)], 2));
}

#[test]
fn columns_for_series_and_sweep_come_first() {
    let mut noise = Noise(0x5eed_0002);
    let rows: Vec<Row> = [1.0, 3.0].map(|level| sweep(level, Hold::Weakly, up(), &mut noise)).concat();
    let named = |name: &dyn Fn(usize) -> String, header: &str| {
        let plain = text(&rows);
        let lines = plain.lines().enumerate();
        let line = |(n, line): (usize, &str)| format!("{line},{}\n", if n == 0 { header.into() } else { name(n - 1) });
        oscillator(&lines.map(line).collect::<String>())
    };
    let table = named(&|n| format!("run {}", n / 81 + 1), "series");
    let names: Vec<_> = table.series.iter().map(|series| (series.name.as_str(), series.direction)).collect();
    assert_eq!(names, [("run 1", Direction::Up), ("run 2", Direction::Up)]);
    assert!(table.summary().contains("2 series"), "{}", table.summary());
    // The column decides, whatever the levels.
    assert_eq!(found(&named(&|_| "a".into(), "series")), [(162, Direction::Up)]);
    let table = named(&|n| if n < 81 { "down".into() } else { "UP".into() }, "sweep");
    assert_eq!(found(&table), [(81, Direction::Down), (81, Direction::Up)]);
    let table = named(&|n| format!("{}", n % 2), "series");
    assert_eq!(found(&table).iter().map(|(count, _)| *count).collect::<Vec<_>>(), [81, 81]);
}

#[test]
fn measured_drives_of_the_arm_are_one_series_too() {
    let mut noise = Noise(0x5eed_0003);
    let rows: String = [10, 20]
        .map(|load| {
            let line =
                |n: usize| format!("0.02,{load},{:e},{},1e-6\n", 2.5e-6 * (1.0 + 0.001 * noise.normal()), 52 + 2 * n);
            (0..24).map(line).collect::<String>()
        })
        .concat();
    let table = csv(&format!("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad\n{rows}"));
    assert_eq!(found(&table), [(24, Direction::Up), (24, Direction::Up)]);
    assert_eq!((table.series[0].load, table.series[1].load), (10.0, 20.0));
    assert!(table.ranges().starts_with("speed 20 mm/s, load 10 N to 20 N, drive 2.4"), "{}", table.ranges());
}

#[test]
fn the_noise_is_found_where_the_drive_varies() {
    for (hold, seed) in [(Hold::Weakly, 11), (Hold::Response, 12), (Hold::Drive, 13)] {
        let mut noise = Noise(0x5eed_0004 + seed);
        let mut rows = sweep(1.0, hold, up(), &mut noise);
        for row in &mut rows {
            (row[2], row[3]) = (row[2] * (1.0 + 0.01 * noise.normal()), row[3] + 0.01 * noise.normal());
        }
        let cut = |line: &str| line.split(',').take(4).collect::<Vec<_>>().join(",");
        let table = oscillator(&text(&rows).lines().map(cut).collect::<Vec<_>>().join("\n"));
        assert_eq!((table.amplitude_noise, table.phase_noise), (NoiseSource::Estimated, Some(NoiseSource::Estimated)));
        for point in &table.points {
            let (amplitude, phase) = (point.amplitude_sd / point.amplitude, point.phase_sd.expect("estimated"));
            assert!((0.007..0.013).contains(&amplitude) && (0.007..0.013).contains(&phase), "{amplitude} {phase}");
        }
    }
}

#[test]
fn a_slip_of_the_decimal_point_is_seen_where_the_drive_varies() {
    let mut noise = Noise(0x5eed_0005);
    let mut rows = sweep(1.0, Hold::Response, up(), &mut noise);
    let doubts = |rows: &[Row]| {
        let notes = oscillator(&text(rows)).notes;
        notes.into_iter().filter(|note| note.contains("decimal point")).collect::<Vec<_>>()
    };
    assert!(doubts(&rows).is_empty(), "the drive falls by 100 at the resonance, and nothing is wrong");
    rows[20][2] *= 10.0;
    assert!(doubts(&rows)[0].contains("(row 21)"), "{:?}", doubts(&rows));
}

/// Three sweeps up at one drive and noise of 0.1 %: pooled where the rig was the same in all, series of their own where
/// it had changed between them.
#[test]
fn repeated_sweeps_of_a_rig_that_has_changed_are_series_of_their_own() {
    for (shift, series) in [(0.0, 1), (0.02, 3)] {
        let mut noise = Noise(11);
        let rows: String = (0..3)
            .flat_map(|pass| up().map(move |n| (pass, 76.0 + 0.1 * n as f64)))
            .map(|(pass, f)| {
                let ratio = f / (80.0 - shift * f64::from(pass));
                let size = 1e-6 / (1.0 - ratio * ratio).hypot(ratio / 100.0) * (1.0 + 1e-3 * noise.normal());
                format!("{f},1,{size:e}\n")
            })
            .collect();
        let table = oscillator(&format!("frequency_hz,force_n,amplitude_m\n{rows}"));
        assert_eq!(found(&table).len(), series, "{shift}: {:?}", table.notes);
        let said = table.notes.iter().any(|note| note.contains("they are 3 series, not pooled"));
        assert_eq!(said, series == 3, "{:?}", table.notes);
    }
}

/// A drive that falls at the resonance as it will, read with few digits, and a row that was taken late: one sweep.
#[test]
fn a_sweep_goes_on_whatever_its_drive() {
    let rows = [
        [282.0, 6.88, 0.6],
        [358.0, 6.89, 0.98],
        [397.0, 6.8, 1.2],
        [440.0, 6.8, 1.48],
        [550.0, 6.64, 2.94],
        [595.0, 4.4, 4.24],
        [650.0, 3.16, 5.2],
        [500.0, 6.8, 2.12],
        [700.0, 4.4, 4.08],
        [752.0, 6.64, 3.12],
        [784.0, 6.72, 2.52],
        [900.0, 6.8, 1.5],
    ];
    let rows: String = rows.iter().map(|[f, drive, size]| format!("{f},{drive},{size:e}\n")).collect();
    let table = oscillator(&format!("frequency_hz,force_n,amplitude_mm\n{rows}"));
    assert_eq!(found(&table), [(12, Direction::Up)], "{:?}", table.series);
}
