//! The friction of filled rubber: a smooth hysteresis of the bristles' stretch.

use super::{Branch, Effect, Group, Measure, ParameterInfo, Zero};
use crate::parameter::{POSITIVE, ZERO_OR_MORE};

/// Share of the stretch x_2 by which a turn back is more than rounding: it changes the force by 1e-8 of its limit.
const ROUNDING: f64 = 1e-8;

/// Friction within the rubber.
pub struct BergFriction;

impl Effect for BergFriction {
    fn name(&self) -> &'static str {
        "berg-friction"
    }
    fn title(&self) -> &'static str {
        "Friction within the rubber (Berg)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "F += Fᵣ + (x − xᵣ)(Fₘ − Fᵣ sign x′)/(x₂(1 − (Fᵣ/Fₘ) sign x′) + |x − xᵣ|) from the last reversal (xᵣ, Fᵣ)"
    }
    fn meaning(&self) -> &'static str {
        "Filled rubber is stiffer at small strokes than at large ones, and its loss has a maximum between (Payne effect): \
         particles of the filler rub on each other. After every reversal the force sets out with the slope Fₘ/x₂ and approaches \
         its limit Fₘ; from rest it has half of it at the stretch x₂."
    }
    fn source(&self) -> &'static str {
        "M. Berg, A non-linear rubber spring model for rail vehicle dynamics analysis, Veh. Syst. Dyn. 30 (1998) 197; A. R. Payne, \
         The dynamic properties of carbon black-loaded natural rubber vulcanizates, J. Appl. Polym. Sci. 6 (1962) 57."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: a small drive finds a contact that is stiffer by Fₘ/x₂; as the stroke passes x₂ the peak moves down and its damping \
         has a maximum, whatever the load. Partial stick: stiffer and more damped as long as the stroke is of the size of x₂. Full \
         slip: nothing, since the bristles do not move."
    }
    fn impersonator(&self) -> &'static str {
        "at one drive level another stiffness and damping of the contact; partial-slip softens with the stroke as well, but later the \
         larger the load, and this does not ask for the load"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("F_max", "Fₘ", "N"), ZERO_OR_MORE, (1e-3, 1e-1), "largest force of the friction")
                .in_units_of(Measure::StrokeForce),
            ParameterInfo::searched(
                ("x_2", "x₂", "m"),
                POSITIVE,
                (3e-8, 3e-6),
                "stretch that takes half of it from rest",
            )
            .in_units_of(Measure::Stroke),
        ];
        LIST
    }

    fn hysteresis(&self, p: &[f64], from: Branch, by: f64) -> Option<(Branch, f64)> {
        let [limit, stretch] = [p[0], p[1]];
        if limit <= 0.0 {
            return None;
        }
        let before = if from.reach < 0.0 || (from.reach == 0.0 && by < 0.0) { -1.0 } else { 1.0 };
        let turns = before * by < -ROUNDING * stretch;
        let sign = if turns { -before } else { before };
        // What is left to the limit: here, and at the reversal from which this branch comes.
        let left = (limit - sign * from.force).max(f64::MIN_POSITIVE);
        let reach = match from.reach.abs() {
            _ if turns => left,
            0.0 => limit,
            reach => reach,
        };
        // Berg's branch, solved for what is left: 1/left grows in proportion to the stretch.
        let rate = limit / (stretch * reach * reach);
        let along = left * rate * sign * by;
        let left = if along >= 0.0 { left / (1.0 + along) } else { left * (1.0 - along) };
        Some((Branch { force: sign * (limit - left), reach: sign * reach }, left * left * rate))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: [f64; 2] = [3.0, 0.2];

    fn moved(from: Branch, by: f64) -> (Branch, f64) {
        BergFriction.hysteresis(&P, from, by).expect("a strength")
    }

    #[test]
    fn a_branch_is_bergs_and_does_not_depend_on_the_steps_along_it() {
        let [limit, stretch] = P;
        let (up, slope) = moved(Branch::default(), stretch);
        assert!((up.force - 0.5 * limit).abs() < 1e-15 && (slope - 0.25 * limit / stretch).abs() < 1e-14);
        for by in [-0.01, -0.3, -2.0] {
            let sign = -1.0;
            let expected =
                up.force + by * (limit - sign * up.force) / (stretch * (1.0 - sign * up.force / limit) + f64::abs(by));
            let steps = (0..7).fold(up, |from, _| moved(from, by / 7.0).0);
            assert!((moved(up, by).0.force - expected).abs() < 1e-14 && (steps.force - expected).abs() < 1e-13, "{by}");
        }
        let (_, slope) = moved(up, -1e-7);
        assert!((slope / (limit / stretch) - 1.0).abs() < 1e-5, "the slope after a reversal");
        let (still, _) = moved(up, -1e-12);
        assert!(still.reach == up.reach && (still.force - up.force).abs() < 1e-10, "rounding is no reversal");
    }

    /// Berg's force at the ends of a steady loop of amplitude A: Fm/(2 x2) (sqrt(x2^2 + A^2 + 6 x2 A) - x2 - A).
    #[test]
    fn the_ends_of_a_loop_are_those_of_the_closed_form() {
        let [limit, stretch] = P;
        for amplitude in [0.05, 0.2, 3.0] {
            let mut at = moved(Branch::default(), amplitude).0;
            for _ in 0..400 {
                at = moved(moved(at, -2.0 * amplitude).0, 2.0 * amplitude).0;
            }
            let root = (stretch * stretch + amplitude * amplitude + 6.0 * stretch * amplitude).sqrt();
            let expected = limit / (2.0 * stretch) * (root - stretch - amplitude);
            assert!((at.force / expected - 1.0).abs() < 1e-9, "{amplitude}: {} {expected}", at.force);
        }
    }

    #[test]
    fn the_slope_is_that_of_differences() {
        for (from, by) in [(0.0, 0.1), (0.4, -0.15), (-0.3, 0.02)] {
            let start = moved(Branch::default(), from).0;
            let difference = (moved(start, by + 1e-7).0.force - moved(start, by - 1e-7).0.force) / 2e-7;
            assert!((moved(start, by).1 / difference - 1.0).abs() < 1e-6, "{from} {by}");
        }
    }
}
