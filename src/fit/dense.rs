//! A densely measured series is a smooth curve: it is solved at as many of its frequencies as its shape needs, and read
//! between them.

use super::Prediction;
use crate::measurement::Point;
use crate::solver::Status;
use nalgebra::Complex;

/// Frequencies of a series at which it is solved first; one with fewer than twice as many is solved at all.
const FIRST: usize = 32;
/// Error of what is read between them, in standard deviations of a reading, beyond which more are solved.
const ERROR: f64 = 0.01;
/// Frequencies from which one between them is read: a cubic; next to where there is no steady state a straight line.
const STENCIL: usize = 4;

/// A model at a point: its reading, and the derivatives of amplitude and phase by its parameters.
pub type Solved = (Prediction, Vec<(f64, f64)>);

/// The readings of one series at one setting, in the order of their frequencies.
#[derive(Debug, Clone)]
pub struct Chain {
    members: Vec<usize>,
}

/// Sorts points into chains that are worth reading between, and the rest.
pub fn chains(points: &[&Point]) -> (Vec<Chain>, Vec<usize>) {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let setting = |i: usize| (points[i].series, points[i].speed, points[i].load, points[i].drive);
    let compare = |&i: &usize, &j: &usize| {
        let (a, b) = (setting(i), setting(j));
        a.0.cmp(&b.0)
            .then(a.1.total_cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
            .then(a.3.total_cmp(&b.3))
            .then(points[i].frequency.total_cmp(&points[j].frequency))
    };
    if points.len() >= 2 * FIRST {
        order.sort_by(compare);
    }
    let (mut dense, mut rest) = (Vec::new(), Vec::new());
    for members in order.chunk_by(|&i, &j| setting(i) == setting(j)) {
        let distinct = members.windows(2).all(|pair| points[pair[0]].frequency < points[pair[1]].frequency);
        if members.len() >= 2 * FIRST && distinct {
            dense.push(Chain { members: members.to_vec() });
        } else {
            rest.extend_from_slice(members);
        }
    }
    (dense, rest)
}

/// A chain while its points are being solved.
pub struct Reading<'c> {
    chain: &'c Chain,
    /// Places along the chain that are solved, in order.
    nodes: Vec<usize>,
    /// Neighbouring places that are solved, and the one between them that tells whether what is read there is right.
    probes: Vec<(usize, usize, usize)>,
}

impl<'c> Reading<'c> {
    /// With the points to be solved first.
    pub fn new(chain: &'c Chain) -> (Self, Vec<usize>) {
        let last = chain.members.len() - 1;
        let nodes: Vec<usize> = (0..FIRST).map(|i| i * last / (FIRST - 1)).collect();
        let first = nodes.iter().map(|&place| chain.members[place]).collect();
        let probes = nodes.windows(2).filter_map(|pair| middle(pair[0], pair[1])).collect();
        (Self { chain, nodes, probes }, first)
    }

    /// The points to be solved next, once all before are.
    pub fn next(&self) -> Vec<usize> {
        self.probes.iter().map(|&(_, place, _)| self.chain.members[place]).collect()
    }

    /// Takes up what was solved, and halves where it is not what would have been read.
    pub fn refine(&mut self, points: &[&Point], solved: &[Option<Solved>]) {
        let mut probes = Vec::new();
        let at = |place: usize| solved[self.chain.members[place]].as_ref();
        for &(low, place, high) in &self.probes {
            let lost = |place: usize| at(place).is_none_or(|(p, _)| p.status != Status::Steady);
            // Where there is no steady state at either end nor between them there is none.
            let done = match self.read(place, STENCIL, points, solved) {
                Some((read, _)) => at(place).is_some_and(|(p, _)| close(points[self.chain.members[place]], &read, p)),
                None => lost(low) && lost(place) && lost(high),
            };
            if !done {
                probes.extend(middle(low, place).into_iter().chain(middle(place, high)));
            }
        }
        self.nodes.extend(self.probes.iter().map(|&(_, place, _)| place));
        self.nodes.sort_unstable();
        // Where a cubic reaches over what was solved anew, what it reads elsewhere only becomes better.
        self.probes = probes;
    }

    /// Reads every point that was not solved.
    pub fn fill(&self, points: &[&Point], solved: &mut [Option<Solved>]) {
        let mut read = Vec::new();
        for (place, &index) in self.chain.members.iter().enumerate() {
            if solved[index].is_none() {
                let cubic = self.read(place, STENCIL, points, solved);
                read.push((index, cubic.or_else(|| self.read(place, 2, points, solved))));
            }
        }
        for (index, found) in read {
            solved[index] = Some(found.unwrap_or_else(|| {
                let status = Status::Failed("between points without a steady state".into());
                (
                    Prediction { amplitude: f64::NAN, phase: f64::NAN, status, others: Vec::new(), beyond: false },
                    Vec::new(),
                )
            }));
        }
    }

    /// What a polynomial through so many of the nearest points that are solved reads at a place; `None` where one of
    /// them has no steady state, or more than one.
    fn read(&self, place: usize, count: usize, points: &[&Point], solved: &[Option<Solved>]) -> Option<Solved> {
        let above = self.nodes.partition_point(|&node| node < place);
        let first = above.saturating_sub(count / 2).min(self.nodes.len() - count);
        let stencil: Vec<usize> = self.nodes[first..first + count].iter().map(|&n| self.chain.members[n]).collect();
        let f = points[self.chain.members[place]].frequency;
        let mut value = Complex::new(0.0, 0.0);
        let mut slopes: Vec<Complex<f64>> = Vec::new();
        for &i in &stencil {
            let (prediction, gradient) = solved[i].as_ref()?;
            if prediction.status != Status::Steady || prediction.beyond || !prediction.others.is_empty() {
                return None;
            }
            let own = points[i].frequency;
            let share = |&j: &usize| (f - points[j].frequency) / (own - points[j].frequency);
            let weight: f64 = stencil.iter().filter(|&&j| j != i).map(share).product();
            let (a, phase) = (prediction.amplitude, prediction.phase);
            value += Complex::from_polar(a, phase) * weight;
            slopes.resize(gradient.len(), Complex::new(0.0, 0.0));
            for (slope, &(by_amplitude, by_phase)) in slopes.iter_mut().zip(gradient) {
                *slope += Complex::new(by_amplitude, a * by_phase) * Complex::from_polar(weight, phase);
            }
        }
        let (amplitude, phase) = value.to_polar();
        let turned = |slope: Complex<f64>| slope * Complex::from_polar(1.0, -phase);
        let gradient = slopes.into_iter().map(|slope| (turned(slope).re, turned(slope).im / amplitude)).collect();
        (amplitude > 0.0).then(|| {
            (Prediction { amplitude, phase, status: Status::Steady, others: Vec::new(), beyond: false }, gradient)
        })
    }
}

/// A place between two, if there is one.
fn middle(low: usize, high: usize) -> Option<(usize, usize, usize)> {
    let place = low.midpoint(high);
    (place > low).then_some((low, place, high))
}

/// Whether two readings of a point differ by less than matters.
fn close(point: &Point, read: &Prediction, solved: &Prediction) -> bool {
    if solved.status != Status::Steady || solved.beyond || !solved.others.is_empty() {
        return false;
    }
    let amplitude = (read.amplitude - solved.amplitude) / point.amplitude_sd;
    let phase = point.phase_sd.map_or(0.0, |sd| crate::statistics::wrap(read.phase - solved.phase) / sd);
    // Elsewhere between the two it may be larger than in their middle.
    amplitude.abs() <= 0.25 * ERROR && phase.abs() <= 0.25 * ERROR
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn points(count: usize) -> Vec<Point> {
        let point = |row: usize| Point {
            row,
            line: row,
            speed: 0.0,
            load: 0.0,
            drive: 1.0,
            frequency: 50.0 + 50.0 * row as f64 / count as f64,
            amplitude: 1.0,
            phase: Some(0.0),
            amplitude_sd: 0.01 / 49.0,
            phase_sd: Some(0.01),
            mean: None,
            replicates: 1,
            series: 0,
        };
        (0..count).map(point).collect()
    }

    /// A resonance of Q = 30 whose stiffness has a kink at 80 Hz; its derivative by the natural frequency. None near 95
    /// Hz.
    fn solve(f: f64) -> Solved {
        let (w, w0) = (TAU * f, TAU * 70.0 * (1.0 + 1e-3 * (f - 80.0).max(0.0)));
        let z = Complex::new(w0 * w0 - w * w, w * w0 / 30.0);
        let reading = Complex::new(1e3, 0.0) / z;
        let by_w0 = -reading / z * Complex::new(2.0 * w0, w / 30.0);
        let turned = by_w0 * Complex::from_polar(1.0, -reading.arg());
        let status = if (94.0..96.0).contains(&f) { Status::Failed("none".into()) } else { Status::Steady };
        let prediction =
            Prediction { amplitude: reading.norm(), phase: reading.arg(), status, others: Vec::new(), beyond: false };
        (prediction, vec![(turned.re, turned.im / reading.norm())])
    }

    /// Errors in standard deviations, largest relative error of the derivative, and how many were solved.
    fn read(points: &[Point]) -> (f64, f64, usize) {
        let all: Vec<&Point> = points.iter().collect();
        let (dense, rest) = chains(&all);
        assert!(dense.len() == 1 && rest.is_empty());
        let mut solved: Vec<Option<Solved>> = vec![None; points.len()];
        let (mut reading, mut wave) = Reading::new(&dense[0]);
        let mut count = 0;
        let mut first = true;
        while !wave.is_empty() {
            count += wave.len();
            wave.iter().for_each(|&i| solved[i] = Some(solve(points[i].frequency)));
            if !std::mem::take(&mut first) {
                reading.refine(&all, &solved);
            }
            wave = reading.next();
        }
        reading.fill(&all, &mut solved);
        let (mut error, mut slope) = (0.0f64, 0.0f64);
        for (point, found) in points.iter().zip(&solved) {
            let (found, gradient) = found.as_ref().expect("read");
            let (true_one, true_gradient) = solve(point.frequency);
            assert_eq!(found.status == Status::Steady, true_one.status == Status::Steady, "{}", point.frequency);
            if found.status == Status::Steady {
                error = error.max((found.amplitude - true_one.amplitude).abs() / point.amplitude_sd);
                error = error.max((found.phase - true_one.phase).abs() / 0.01);
                slope = slope.max((gradient[0].0 / true_gradient[0].0 - 1.0).abs());
            }
        }
        (error, slope, count)
    }

    #[test]
    fn a_dense_curve_is_read_within_a_hundredth_of_the_noise_from_a_bounded_number_of_points() {
        for (count, most) in [(640, 300), (6_400, 400), (64_000, 500)] {
            let (error, _, solved) = read(&points(count));
            assert!(error <= ERROR && solved < most, "{count}: {error} {solved}");
        }
    }

    #[test]
    fn short_series_and_drives_that_differ_are_solved_at_every_point() {
        let few = points(2 * FIRST - 1);
        assert!(chains(&few.iter().collect::<Vec<_>>()).0.is_empty());
        let mut varied = points(200);
        varied.iter_mut().enumerate().for_each(|(i, p)| p.drive += 1e-3 * i as f64);
        assert!(chains(&varied.iter().collect::<Vec<_>>()).0.is_empty());
    }
}
