//! A linear resonance estimated from readings alone: where a calibration of a rig starts, however far off its stated
//! values.
//!
//! Drive over motion is the dynamic stiffness K - M w^2 + i w C up to the gains of the instruments. Against d =
//! w^2/wc^2 - 1 it is nearly a straight line in the complex plane (the inverse of the resonance circle), and its
//! squared magnitude a parabola; both are linear least squares, each reading weighted by its size.

mod floor;

use crate::linear::least_squares;
use crate::measurement::{Point, TOLD};
use crate::model::Model;
use crate::scenario::Rig;
use crate::statistics::{median, wrap};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Shares of the largest response above which readings tell a resonance: all, a tenth, half power.
const NEAR: [f64; 3] = [0.0, 0.1, std::f64::consts::FRAC_1_SQRT_2];
/// Quality factors beyond these are estimates of noise; below the first a displacement or an acceleration has no peak.
const QUALITY: (f64, f64) = (0.5, 1e7);

/// So many widths off, or so many times as sharp or as broad, a resonance is another one than that of the readings: an
/// order of magnitude, which no law bends a peak by.
const ASTRAY: f64 = 10.0;

/// A linear resonance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// f0 \[Hz\].
    pub frequency: f64,
    /// Q \[-\].
    pub quality: f64,
    /// Reading over drive at f0.
    pub peak: f64,
    /// Phase of the reading at f0 relative to that of the drive \[rad\], where phases are measured.
    pub phase: Option<f64>,
    /// Whether the readings reach the resonance from both sides.
    pub spanned: bool,
    /// Whether it has a peak that can be told from anything that falls: a displacement or an acceleration by its quality
    /// factor, a velocity, which has one at any, where the readings reach half power on both sides.
    pub peaked: bool,
}

/// The resonance of one series of readings that are the motion differentiated `order` times; `None` where they tell
/// none. Where it lies beyond the readings, or a parabola tells as much of them, one is looked for beside something
/// constant that is read with it.
pub fn resonance(points: &[&Point], order: u8) -> Option<Resonance> {
    let usable: Vec<&Point> =
        points.iter().copied().filter(|p| p.amplitude > 0.0 && p.drive > 0.0 && p.frequency > 0.0).collect();
    let response = |p: &Point| p.amplitude / p.drive;
    let most = usable.iter().map(|p| response(p)).fold(0.0, f64::max);
    // Each reading counts by its size: where those far from the peak are many and mostly noise they outweigh it.
    let above = |share: f64| usable.iter().copied().filter(|p| response(p) >= share * most).collect::<Vec<_>>();
    let found = NEAR.into_iter().filter_map(|share| alone(&above(share), order));
    let of = |resonance: Resonance| {
        let peaked = resonance.quality > QUALITY.0 || order == 1 && halved(&usable, &resonance);
        let quality = if peaked { resonance.quality } else { QUALITY.0 };
        let seen = Resonance { quality, spanned: spanned(&usable, &resonance), peaked, ..resonance };
        (left(&usable, &resonance, order), seen)
    };
    let alone = found.map(of).min_by(|a, b| a.0.total_cmp(&b.0));
    let responses: Vec<(f64, f64)> =
        usable.iter().map(|p| (p.frequency / usable[0].frequency - 1.0, response(p))).collect();
    let shows = |(left, resonance): &(f64, Resonance)| resonance.spanned && floor::is_no_parabola(&responses, *left);
    let shown = alone.filter(shows).map(|(_, resonance)| resonance);
    match shown {
        Some(resonance) if resonance.peaked => Some(resonance),
        Some(resonance) => by_amplitudes(&usable, order).or(Some(resonance)),
        None => {
            let floor = floor::on_floor(&usable).or_else(|| floor::in_part(&usable));
            let other = floor.or_else(|| by_amplitudes(&usable, order));
            other.or(alone.map(|(_, resonance)| resonance))
        }
    }
}

/// The resonance that the amplitudes show among them, whatever the phases beside them are: these may be folded, or in
/// another unit than is said.
fn by_amplitudes(usable: &[&Point], order: u8) -> Option<Resonance> {
    if usable.iter().all(|p| p.phase.is_none()) {
        return None;
    }
    let amplitudes: Vec<Point> = usable.iter().map(|p| Point { phase: None, ..(*p).clone() }).collect();
    resonance(&amplitudes.iter().collect::<Vec<_>>(), order).filter(|r| r.spanned && r.peaked)
}

/// Squares that a resonance leaves of the responses, at the size that leaves least.
fn left(usable: &[&Point], of: &Resonance, order: u8) -> f64 {
    let values = usable.iter().map(|p| {
        let ratio = p.frequency / of.frequency;
        let shape = ratio.powi(order.into()) / Complex::new(1.0 - ratio * ratio, ratio / of.quality).norm();
        (p.amplitude / p.drive, shape)
    });
    let (yy, ys, ss) = values.fold((0.0, 0.0, 0.0), |(yy, ys, ss), (y, s)| (yy + y * y, ys + y * s, ss + s * s));
    // Never less than rounding.
    (yy - ys * ys / ss).max(f64::EPSILON * yy)
}

/// Whether readings lie on both sides of a resonance.
fn spanned(usable: &[&Point], of: &Resonance) -> bool {
    usable.iter().any(|p| p.frequency < of.frequency) && usable.iter().any(|p| p.frequency > of.frequency)
}

/// Whether readings lie beyond half power on both sides of a resonance of velocities.
fn halved(usable: &[&Point], of: &Resonance) -> bool {
    let half = 0.5 / of.quality;
    let [low, high] = [-half, half].map(|half| of.frequency * ((1.0 + half * half).sqrt() + half));
    usable.iter().any(|p| p.frequency < low) && usable.iter().any(|p| p.frequency > high)
}

/// The resonance of readings of nothing else.
fn alone(usable: &[&Point], order: u8) -> Option<Resonance> {
    let highest = usable.iter().max_by(|a, b| (a.amplitude / a.drive).total_cmp(&(b.amplitude / b.drive)))?;
    if usable.len() < TOLD {
        return None;
    }
    let center = highest.frequency;
    let detuning = |p: &Point| (p.frequency / center).powi(2) - 1.0;
    // In units of the smallest.
    let least = highest.drive / highest.amplitude;
    let size = |p: &Point| p.drive / p.amplitude * (p.frequency / center).powi(order.into()) / least;
    let turn = std::f64::consts::FRAC_PI_2 * f64::from(order);
    let with_phase: Vec<&Point> = usable.iter().copied().filter(|p| p.phase.is_some()).collect();
    let line = if with_phase.len() >= TOLD {
        let value = |p: &Point| Complex::from_polar(size(p), turn - p.phase.unwrap_or(0.0));
        straight_line(&with_phase.iter().map(|p| (detuning(p), value(p))).collect::<Vec<_>>())
    } else {
        None
    };
    // z = slope (d - d0 - i/Q ..): where the line passes the origin, and how far from it.
    let (shift, width, slope, angle) = if let Some((offset, slope)) = line {
        let at = -offset / slope;
        (at.re, at.im.abs(), slope.norm(), Some(slope.arg()))
    } else {
        let squares: Vec<(f64, f64)> = usable.iter().map(|p| (detuning(p), size(p).powi(2))).collect();
        let (shift, width, slope) = parabola(&squares)?;
        (shift, width, slope, None)
    };
    let frequency = center * (1.0 + shift).max(0.0).sqrt();
    // i w C = i (w/w0) (w0^2/Q) M.
    let least_quality = if order == 1 { 1.0 / QUALITY.1 } else { QUALITY.0 };
    let quality = ((frequency / center).powi(2) / width).clamp(least_quality, QUALITY.1);
    if !(frequency > 0.0 && quality.is_finite() && slope > 0.0) {
        return None;
    }
    let stiffness_at_resonance = slope * least * (frequency / center).powi(2) / quality;
    let peak = (frequency / center).powi(order.into()) / stiffness_at_resonance;
    // At resonance z = i M w0^2/Q turned as the slope -M wc^2 is.
    let phase = angle.map(|angle| wrap(turn - (angle + std::f64::consts::PI + std::f64::consts::FRAC_PI_2)));
    Some(Resonance { frequency, quality, peak, phase, spanned: false, peaked: false })
}

/// Offset and slope of z = offset + slope d.
fn straight_line(values: &[(f64, Complex<f64>)]) -> Option<(Complex<f64>, Complex<f64>)> {
    let (mut n, mut d, mut dd) = (0.0, 0.0, 0.0);
    let (mut z, mut dz) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
    for (detuning, value) in values {
        let weight = 1.0 / value.norm_sqr();
        n += weight;
        d += weight * detuning;
        dd += weight * detuning * detuning;
        z += value * weight;
        dz += value * (weight * detuning);
    }
    let determinant = n * dd - d * d;
    if determinant <= f64::EPSILON * n * dd {
        return None;
    }
    Some(((z * dd - dz * d) / determinant, (dz * n - z * d) / determinant))
}

/// Shift, width at resonance and slope of y = slope^2 [(d - shift)^2 + width^2 (1 + d) / (1 + shift)].
fn parabola(values: &[(f64, f64)]) -> Option<(f64, f64, f64)> {
    let reach = values.iter().map(|(d, _)| d.abs()).fold(0.0, f64::max);
    let rows = DMatrix::from_fn(values.len(), 3, |i, j| (values[i].0 / reach).powi(j as i32) / values[i].1);
    let right = DVector::from_element(values.len(), 1.0);
    let found = least_squares(rows, &right, 1e-12)?;
    let (a, b, c) = (found[0], found[1] / reach, found[2] / (reach * reach));
    if c <= 0.0 {
        return None;
    }
    let shift = -0.5 * b / c;
    let square = a / c - shift * shift;
    // Of a damping so large that the squares have no minimum at any frequency.
    let broad = Some((1.0 + shift).powi(2) + square).filter(|whole| square <= 0.0 && *whole > 0.0);
    if let Some(at) = broad.map(|whole| whole.sqrt() - 1.0).filter(|at| *at > shift) {
        return Some((at, (2.0 * (at - shift) * (1.0 + at)).sqrt(), c.sqrt()));
    }
    // Where noise hides the width, that of the amplitudes within a factor of the root of two of the largest.
    let near: Vec<f64> = values.iter().filter(|(_, y)| *y < 2.0).map(|(d, _)| (d - shift).abs()).collect();
    let square = if square > 0.0 { square } else { near.iter().copied().fold(0.0, f64::max).powi(2) };
    // The damping grows with the frequency: y = slope^2 [(d - at)^2 + loss (1 + d)] has the same three numbers.
    let loss = 2.0 * square / (1.0 + shift + (1.0 + shift).hypot(square.sqrt()));
    let at = shift + 0.5 * loss;
    let width = (loss * (1.0 + at)).sqrt();
    (width > 0.0).then(|| (at, width, c.sqrt()))
}

/// The resonances of all series, the median of each of their numbers; `None` where no series tells one.
pub fn of_all(points: &[Point], order: u8) -> Option<Resonance> {
    let mut found = Vec::new();
    for series in 0..=points.iter().map(|p| p.series).max()? {
        let own: Vec<&Point> = points.iter().filter(|p| p.series == series).collect();
        found.extend(resonance(&own, order));
    }
    let first = found.first()?;
    let phases: Vec<f64> = found.iter().filter_map(|r| r.phase).collect();
    let phase = phases.first().map(|one| wrap(one + median(phases.iter().map(|phase| wrap(phase - one)))));
    Some(Resonance {
        frequency: median(found.iter().map(|r| r.frequency)),
        quality: median(found.iter().map(|r| r.quality)),
        peak: median(found.iter().map(|r| r.peak)),
        phase,
        spanned: first.spanned,
        peaked: 2 * found.iter().filter(|r| r.peaked).count() >= found.len(),
    })
}

/// The same, or where none is told, as beside what grows with the frequency, one that they show among them when taken as
/// the motion differentiated otherwise.
pub fn shown(points: &[Point], order: u8) -> Option<Resonance> {
    let is_peak = |r: &Resonance| r.spanned && r.peaked;
    of_all(points, order).or_else(|| (0..=2).filter_map(|other| of_all(points, other)).find(is_peak))
}

/// The resonance of readings of which it is not known how many times they are the motion differentiated: as the one of
/// `orders` of which it leaves the least squares. Any but the first has to have its resonance among the readings, and a
/// peak.
pub fn of_any(points: &[Point], orders: impl IntoIterator<Item = u8>) -> Option<Resonance> {
    let series = points.iter().map(|p| p.series).max()?;
    let left_over = |resonance: &Resonance, order: u8| -> f64 {
        let of = |index: usize| points.iter().filter(|p| p.series == index && p.drive > 0.0).collect::<Vec<_>>();
        (0..=series).map(of).filter(|own| !own.is_empty()).map(|own| left(&own, resonance, order)).sum()
    };
    let mut best: Option<(f64, Resonance)> = None;
    for (number, order) in orders.into_iter().enumerate() {
        let Some(found) = of_all(points, order) else { continue };
        let left = left_over(&found, order);
        let is_peak = number == 0 || found.spanned && found.peaked;
        if is_peak && best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, found));
        }
    }
    best.map(|(_, resonance)| resonance)
}

/// The natural frequency \[Hz\] of a rig by itself that lies outside the readings, though these show a resonance among
/// them, and where that is.
pub fn left_readings(model: &Model, points: &[Point]) -> Option<(f64, f64)> {
    let Rig::Oscillator(rig) = &model.rig else { return None };
    let own = (rig.stiffness() / rig.mass).sqrt() / TAU;
    let frequencies = || points.iter().map(|p| p.frequency);
    if model.has_contact || (frequencies().any(|f| f <= own) && frequencies().any(|f| f >= own)) {
        return None;
    }
    let seen = shown(points, model.signals.reading.order)?;
    seen.spanned.then_some((own, seen.frequency))
}

/// Natural frequency \[Hz\] and quality factor of a rig by itself that are not those of the resonance which its readings
/// show among them, and that resonance.
pub fn astray(model: &Model, points: &[Point]) -> Option<((f64, f64), Resonance)> {
    let Rig::Oscillator(rig) = &model.rig else { return None };
    if model.has_contact {
        return None;
    }
    let (stiffness, damping) = (rig.stiffness(), rig.damping());
    let own = ((stiffness / rig.mass).sqrt() / TAU, (stiffness * rig.mass).sqrt() / damping);
    let seen = shown(points, model.signals.reading.order)?;
    let shift = (own.0 - seen.frequency).abs() / (seen.frequency / seen.quality);
    let sharper = (own.1 / seen.quality).ln().abs();
    // Beyond the readings a width is enough.
    let beyond = |f: f64| points.iter().all(|p| p.frequency < f) || points.iter().all(|p| p.frequency > f);
    let near = if beyond(own.0) { 1.0 } else { ASTRAY };
    let is_astray = seen.spanned && seen.peaked && !(shift < near && sharper < ASTRAY.ln());
    is_astray.then_some((own, seen))
}

/// Whether points show a resonance among them.
pub fn is_spanned(points: &[Point], order: u8) -> bool {
    of_all(points, order).is_some_and(|seen| seen.spanned)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reading of a drive of 3.
    pub(super) fn point(row: usize, frequency: f64, amplitude: f64, phase: Option<f64>) -> Point {
        Point {
            row,
            line: row,
            speed: 0.0,
            load: 0.0,
            drive: 3.0,
            frequency,
            amplitude,
            phase,
            amplitude_sd: 1.0,
            phase_sd: None,
            mean: None,
            replicates: 1,
            series: 0,
        }
    }

    fn points(frequency: f64, quality: f64, order: u8, offset: f64, with_phase: bool) -> Vec<Point> {
        let at = |row: usize| {
            let f = frequency * (1.0 + (row as f64 - 20.0) / 8.0 / quality);
            let w = TAU * f;
            let z = Complex::new((TAU * frequency).powi(2) - w * w, w * TAU * frequency / quality);
            let reading = Complex::new(0.0, w).powu(order.into()) * 3.0 / z;
            let phase = with_phase.then(|| wrap(reading.arg() + offset));
            point(row, f, reading.norm() * 7.0, phase)
        };
        (0..41).map(at).collect()
    }

    #[test]
    fn amplitudes_of_a_linear_rig_tell_it_exactly_however_broad_it_is() {
        for (quality, order) in [(0.2_f64, 1), (0.6, 1), (0.8, 2), (1.0, 0), (1.0, 1), (3.0, 2), (1e4, 0)] {
            let at = |row: usize| {
                let f = 750.0 * (1.0 + 1.0 / quality).powf((row as f64 - 19.3) / 20.0);
                let (w, w0) = (TAU * f, TAU * 750.0);
                let z = Complex::new(w0 * w0 - w * w, w * w0 / quality).norm();
                point(row, f, 3.0 * w.powi(order) / z, None)
            };
            let points: Vec<Point> = (0..41).map(at).collect();
            let found = of_all(&points, order as u8).expect("a resonance");
            assert!((found.frequency / 750.0 - 1.0).abs() < 1e-9, "{quality} {order}: {found:?}");
            assert!((found.quality / quality - 1.0).abs() < 1e-6, "{quality} {order}: {found:?}");
            let known = of_any(&points, [2, 1, 0]).expect("a resonance");
            assert!((found.frequency / known.frequency - 1.0).abs() < 1e-3, "{quality} {order}: {known:?}");
        }
    }

    #[test]
    fn a_tail_of_noise_over_decades_does_not_hide_a_resonance() {
        for with_phase in [true, false] {
            let mut points = points(1000.0, 40.0, 0, 0.3, with_phase);
            let most = points.iter().map(|p| p.amplitude).fold(0.0, f64::max);
            // Two hundred readings up to a hundred times the frequency, where an analyser reads its own noise.
            points.extend((0..200).map(|i| {
                let noise = ((i * 7919) % 101) as f64;
                let phase = with_phase.then_some(wrap(noise));
                point(100 + i, 1200.0 * 10f64.powf(i as f64 / 100.0), most * (1.0 + noise) / 1e4, phase)
            }));
            let found = of_all(&points, 0).expect("a resonance");
            assert!(
                (found.frequency / 1000.0 - 1.0).abs() < 1e-3 && (found.quality / 40.0 - 1.0).abs() < 0.1,
                "{found:?}"
            );
        }
    }

    #[test]
    fn a_resonance_of_any_size_is_found_with_and_without_phases() {
        for (frequency, quality) in [(0.1, 3.0), (80.0, 30.0), (1e6, 1e4)] {
            for order in 0..3 {
                for (offset, with_phase) in [(0.0, true), (std::f64::consts::PI, true), (-0.7, true), (0.0, false)] {
                    let points = points(frequency, quality, order, offset, with_phase);
                    let found = of_all(&points, order).expect("a resonance");
                    let close = 2.0 / quality;
                    assert!(
                        (found.frequency / frequency - 1.0).abs() < close / quality + 1e-6,
                        "{found:?} {frequency}"
                    );
                    assert!((found.quality / quality - 1.0).abs() < close + 1e-3, "{found:?} {quality}");
                    let w = TAU * frequency;
                    let peak = 7.0 * quality / (w * w) * w.powi(order.into());
                    assert!((found.peak / peak - 1.0).abs() < 2.0 * close + 1e-3, "{found:?} {peak}");
                    let expected = wrap(std::f64::consts::FRAC_PI_2 * (f64::from(order) - 1.0) + offset);
                    assert_eq!(found.phase.is_some(), with_phase);
                    assert!(
                        found.phase.is_none_or(|phase| wrap(phase - expected).abs() < close + 1e-3),
                        "{found:?} {expected}"
                    );
                }
            }
        }
    }
}
