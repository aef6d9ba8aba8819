//! Standard deviations: stated, from repeated readings, from the scatter about smooth curves.

use stickslip::measurement::{NoiseSource, Point, Scatter, scatter};

use super::{PRACTICE, csv};

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
pub struct Noise(pub u64);

impl Noise {
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
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
            series: 0,
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
fn the_order_of_rows_does_not_change_estimates_by_a_bit() {
    let mut noise = Noise(4242);
    let mut rows: Vec<String> = (0..48)
        .map(|n| {
            let (frequency, amplitude) = (52 + 2 * (n % 24), 1e-6 * (1.0 + 0.01 * noise.normal()));
            format!("0,20,1e-6,{frequency},{amplitude:e},{}", 0.01 * noise.normal())
        })
        .collect();
    let table = |rows: &[String]| {
        csv(&format!("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,phase_rad\n{}\n", rows.join("\n")))
    };
    let first = table(&rows);
    assert_eq!((first.points.len(), first.points[0].replicates), (24, 2));
    for _ in 0..20 {
        for at in (1..rows.len()).rev() {
            rows.swap(at, (noise.uniform() * (at + 1) as f64) as usize);
        }
        let again = table(&rows);
        for (a, b) in first.points.iter().zip(&again.points) {
            let numbers = |p: &Point| [Some(p.frequency), Some(p.amplitude), p.phase, Some(p.amplitude_sd), p.phase_sd];
            assert_eq!(numbers(a), numbers(b));
        }
        assert_eq!(first.notes, again.notes);
    }
}

/// Resonances at 72 Hz with Q = 60 at three drives, 80 frequencies each: noise in proportion, and that of an amplifier
/// in both parts.
fn with_floor(noise: &mut Noise, share: f64, floor: f64) -> Vec<Point> {
    let point = |row: usize| {
        let (series, n) = (row / 80, row % 80);
        let frequency = 66.0 + 0.15 * n as f64;
        let (re, im) = (1.0 - (frequency / 72.0).powi(2), frequency / 72.0 / 60.0);
        let drive = 3f64.powi(series as i32);
        let (size, turn) = (drive / re.hypot(im), -im.atan2(re) + share * noise.normal());
        let size = size * (1.0 + share * noise.normal());
        let (x, y) = (size * turn.cos() + floor * noise.normal(), size * turn.sin() + floor * noise.normal());
        Point {
            row,
            line: row,
            speed: 0.0,
            load: 0.0,
            drive,
            frequency,
            amplitude: x.hypot(y),
            phase: Some(y.atan2(x)),
            amplitude_sd: f64::NAN,
            phase_sd: None,
            mean: None,
            replicates: 1,
            series,
        }
    };
    (0..240).map(point).collect()
}

#[test]
fn what_does_not_grow_with_the_reading_is_told_from_what_does() {
    let (mut told, mut near, mut false_ones) = (0, 0, 0);
    for seed in 1..=20 {
        let mut noise = Noise(0x9e37_79b9_7f4a_7c15 ^ seed);
        let Scatter { amplitude, phase } = scatter(&with_floor(&mut noise, 3e-3, 0.3));
        for found in [amplitude, phase].map(|spread| spread.expect("noise")) {
            told += usize::from(found.parts.is_some());
            // From the smallest readings to the largest: 60, 5.8 and 3.1 thousandths.
            let is_near = |(reading, size): &(f64, f64)| (0.5..2.0).contains(&(found.at(*reading, 0.0) / size));
            near += [(5.0, 0.06), (60.0, 5.83e-3), (400.0, 3.09e-3)].iter().filter(|one| is_near(one)).count();
        }
        let Scatter { amplitude, phase } = scatter(&with_floor(&mut noise, 1e-2, 0.0));
        false_ones += [amplitude, phase].iter().flatten().filter(|spread| spread.parts.is_some()).count();
    }
    assert!(told >= 38 && near >= 108 && false_ones <= 1, "{told} told, {near} of 120 near, {false_ones} false");
}

/// Resonances at 2 Hz with Q = 200 at two drives, 80 frequencies each over six widths: noise in proportion, and a
/// resonance that is at every reading another by a share of its width.
fn with_waver(noise: &mut Noise, share: f64, waver: f64) -> Vec<Point> {
    let mut points = with_floor(noise, share, 0.0);
    points.truncate(160);
    for point in &mut points {
        let n = (point.row % 80) as f64;
        point.frequency = 2.0 * (1.0 + (n - 39.5) / 39.5 * 3.0 / 200.0);
        let ratio = point.frequency * (1.0 + waver / 200.0 * noise.normal()) / 2.0;
        let (re, im) = (1.0 - ratio * ratio, ratio / 200.0);
        point.amplitude = point.drive / re.hypot(im) * (1.0 + share * noise.normal());
        point.phase = Some(-im.atan2(re) + share * noise.normal());
    }
    points
}

#[test]
fn what_a_frequency_that_wavers_leaves_is_told_from_what_is_the_same_everywhere() {
    let (mut told, mut near, mut false_ones) = (0, 0, 0);
    for seed in 1..=20 {
        let mut noise = Noise(0x9e37_79b9_7f4a_7c15 ^ seed);
        let Scatter { amplitude, phase } = scatter(&with_waver(&mut noise, 3e-3, 0.03));
        for found in [amplitude, phase].map(|spread| spread.expect("noise")) {
            let waver = found.parts.map_or(0.0, |parts| parts.waver);
            told += usize::from(waver > 0.0);
            near += usize::from((0.5..2.0).contains(&(waver / 1.5e-4)));
        }
        let Scatter { amplitude, phase } = scatter(&with_waver(&mut noise, 3e-3, 0.0));
        false_ones += [amplitude, phase].iter().flatten().filter(|spread| spread.parts.is_some()).count();
    }
    assert!(told >= 32 && near >= 30 && false_ones <= 1, "{told} of 40 told, {near} near, {false_ones} false");
}

/// A scale read to half a division: rounding leaves more than the scatter of neighbours that happen to agree with a
/// curve.
#[test]
fn no_reading_is_known_better_than_the_steps_it_is_written_in() {
    let read = |step: f64, digits: usize| {
        let size = |f: f64| (20.0 / (1.0 - (f / 80.0).powi(2)).hypot(f / 80.0 / 5.0) / step).round() * step;
        let rows: String =
            (0..40).map(|n| 60.0 + f64::from(n)).map(|f| format!("{f},1,{:.digits$}\n", size(f))).collect();
        super::oscillators::load("t.csv", format!("frequency_hz,force_n,amplitude_mm\n{rows}").as_bytes(), "", "")
            .expect("sound")
    };
    for (step, digits) in [(0.5, 1), (0.2, 1)] {
        let table = read(step, digits);
        let least = table.points.iter().map(|p| p.amplitude_sd).fold(f64::INFINITY, f64::min);
        assert!(least >= 0.999e-3 * step / 12f64.sqrt(), "{step}: {least:e}");
        assert!(table.notes.iter().any(|note| note.contains("steps so coarse")), "{:?}", table.notes);
    }
    let fine = read(1e-6, 6);
    assert!(!fine.notes.iter().any(|note| note.contains("steps so coarse")), "{:?}", fine.notes);
}
