//! A rig that is another one from series to series.

use super::{Effect, Group, Measure, OfSeries, ParameterInfo, Zero};
use crate::dual::Dual;

/// Most series that it has numbers for, the first included: those of more would leave no room for any other effect.
pub const MOST: usize = 9;

/// Drift, with numbers for so many series after the first.
pub struct Drift(usize);

/// One form for each number of series, from two on.
static FORMS: [Drift; MOST - 1] = [Drift(1), Drift(2), Drift(3), Drift(4), Drift(5), Drift(6), Drift(7), Drift(8)];

/// That of a scenario, whose table is not known yet.
pub static DRIFT: &Drift = &FORMS[MOST - 2];

/// More than a softening to nothing, and no more than any rig that is still itself.
const POSSIBLE: (f64, f64) = (-0.9, 10.0);

const fn stiffness(key: &'static str, symbol: &'static str, meaning: &'static str) -> ParameterInfo {
    // Of a resonance that moves by a hundredth of its width up to ten widths.
    ParameterInfo::searched((key, symbol, "1"), POSSIBLE, (2e-3, 0.5), meaning)
        .in_units_of(Measure::Loss)
        .alone(0.01, 10.0)
        .of_change()
}

const fn gain(key: &'static str, symbol: &'static str, meaning: &'static str) -> ParameterInfo {
    ParameterInfo::searched((key, symbol, "1"), POSSIBLE, (1e-3, 0.5), meaning).of_change()
}

const LIST: [ParameterInfo; 2 * (MOST - 1)] = [
    stiffness("d_2", "d₂", "change of the stiffness in series 2"),
    gain("g_2", "g₂", "change of the gain in series 2"),
    stiffness("d_3", "d₃", "change of the stiffness in series 3"),
    gain("g_3", "g₃", "change of the gain in series 3"),
    stiffness("d_4", "d₄", "change of the stiffness in series 4"),
    gain("g_4", "g₄", "change of the gain in series 4"),
    stiffness("d_5", "d₅", "change of the stiffness in series 5"),
    gain("g_5", "g₅", "change of the gain in series 5"),
    stiffness("d_6", "d₆", "change of the stiffness in series 6"),
    gain("g_6", "g₆", "change of the gain in series 6"),
    stiffness("d_7", "d₇", "change of the stiffness in series 7"),
    gain("g_7", "g₇", "change of the gain in series 7"),
    stiffness("d_8", "d₈", "change of the stiffness in series 8"),
    gain("g_8", "g₈", "change of the gain in series 8"),
    stiffness("d_9", "d₉", "change of the stiffness in series 9"),
    gain("g_9", "g₉", "change of the gain in series 9"),
];

const NONE: [Zero; 2 * (MOST - 1)] = {
    let mut all = [Zero { parameter: 0, value: 0.0 }; 2 * (MOST - 1)];
    let mut index = 0;
    while index < all.len() {
        all[index].parameter = index;
        index += 1;
    }
    all
};

impl Effect for Drift {
    fn name(&self) -> &'static str {
        "drift"
    }
    fn title(&self) -> &'static str {
        "Drift from series to series"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "K → K (1 + d_s), reading → (1 + g_s) reading, s the number of the series from 2"
    }
    fn meaning(&self) -> &'static str {
        "The rig was not the same in all series: it had become warmer, a bolt had settled, it was another day. The stiffness and the gain of \
         the reading differ in each series from those of the first by numbers of its own, all of which are counted. Series are numbered \
         as `compare` lists them. Damping, drive and everything else stay. Up to nine series."
    }
    fn source(&self) -> &'static str {
        "A linear rig for each series (D. J. Ewins, Modal Testing, 2000, on the checks of repeatability)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: every series is a resonance of its own shape and width, at a frequency and of a \
         size of its own; within a series nothing bends."
    }
    fn impersonator(&self) -> &'static str {
        "where each series has a drive level of its own, any stiffness or damping that depends on the amplitude as long as no series bends: \
         repeating the first sweep at the end tells them apart"
    }
    fn zero(&self) -> &'static [Zero] {
        &NONE[..2 * self.0]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        &LIST[..2 * self.0]
    }
    fn unstated(&self, _index: usize) -> Option<f64> {
        Some(0.0)
    }
    fn of_series(&self) -> Option<OfSeries> {
        Some(|count| Some(FORMS.get(count.checked_sub(2)?)? as &dyn Effect))
    }

    fn between_series(&self, p: &[Dual], series: usize) -> Option<(Dual, Dual)> {
        let one = Dual::constant(1.0);
        let own = series.checked_sub(1).and_then(|before| p.get(2 * before..2 * before + 2));
        Some(own.map_or((one, one), |own| (one + own[0], one + own[1])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_series_has_its_own_numbers_and_the_first_none() {
        let p: Vec<Dual> = (0..6).map(|i| Dual::parameter(0.01 * f64::from(i + 1), i as usize)).collect();
        let of = |series: usize| Drift(3).between_series(&p, series).map(|(k, g)| (k.value, g.value));
        assert_eq!((of(0), of(1)), (Some((1.0, 1.0)), Some((1.01, 1.02))));
        assert_eq!((of(3), of(4)), (Some((1.05, 1.06)), Some((1.0, 1.0))));
    }

    #[test]
    fn there_is_a_form_for_every_number_of_series_that_has_room() {
        let form = DRIFT.of_series().expect("numbers of each series");
        let count = |series: usize| form(series).map(|effect| effect.parameters().len());
        assert_eq!((count(0), count(1), count(MOST + 1)), (None, None, None));
        for series in 2..=MOST {
            assert_eq!(count(series), Some(2 * (series - 1)));
            let effect = form(series).expect("a form");
            assert_eq!(effect.zero().len(), effect.parameters().len());
        }
        assert_eq!(DRIFT.parameters().len(), 2 * (MOST - 1));
    }
}
