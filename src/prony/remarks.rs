//! What the data cannot tell, in sentences.

use super::law::Fitted;
use super::{Kind, Moduli, Score, chosen, reach};
use crate::statistics::spread;
use crate::units::readable::percent;

/// How many times the scatter between neighbours a series with all its terms may leave.
const CONTRADICTION: f64 = 3.0;

/// Where another law does as well, and where none does.
pub fn remarks(
    moduli: &Moduli,
    fits: &[Fitted],
    scores: &[Score],
    (spring_pot, constant): (Score, Option<Score>),
) -> Vec<String> {
    let limit = reach(scores);
    let of = |score: Score| percent(score.mean.sqrt(), 2);
    let mut remarks = Vec::new();
    let terms = chosen(scores) + 1;
    if terms == 1 {
        remarks.push(format!(
            "over {:.1} decades one relaxation does as well as more: neither a second one nor a distribution of times can be \
             told; a wider band would",
            moduli.decades()
        ));
    }
    if spring_pot.mean <= limit {
        remarks.push(format!(
            "a spring-pot, three numbers, predicts blocks that were left out as well as a series, or better ({} and {}): the data \
             call for no more numbers",
            of(spring_pot),
            of(scores[terms - 1])
        ));
    }
    if let Some(constant) = constant.filter(|constant| constant.mean <= limit) {
        remarks.push(format!(
            "a storage and a loss modulus that do not depend on the frequency (structural damping) do as well ({}): the data \
             tell no relaxation",
            of(constant)
        ));
    }
    if moduli.kind == Kind::Dynamic {
        remarks.extend(contradiction(moduli, &fits[fits.len() - 1]));
    }
    remarks
}

/// Said where even all terms leave far more than the scatter between neighbours.
fn contradiction(moduli: &Moduli, richest: &Fitted) -> Option<String> {
    let left = moduli.rms(richest);
    let scatter = [0, 1].map(|k| scatter(moduli, k));
    let beyond = (0..2).any(|k| left[k] > CONTRADICTION * scatter[k].max(f64::EPSILON.sqrt()));
    beyond.then(|| {
        let show = |share: f64| percent(share, 2);
        format!(
            "with however many terms {} of the storage and {} of the loss modulus are left, where neighbours scatter by {} and \
             {}: no relaxations inside the band have both moduli. Beyond it there are others, or the moduli contradict each \
             other (shift factors of a master curve, amplitudes that are not small, the frame of the machine)",
            show(left[0]),
            show(left[1]),
            show(scatter[0]),
            show(scatter[1])
        )
    })
}

/// Robust standard deviation, relative, of a reading about the line through its neighbours in the logarithms.
fn scatter(moduli: &Moduli, k: usize) -> f64 {
    let off = moduli.points.windows(3).filter(|three| three[2].x > three[0].x).map(|three| {
        let [a, b, c] = [0, 1, 2].map(|i| (three[i].x.ln(), three[i].y[k].ln()));
        let share = (b.0 - a.0) / (c.0 - a.0);
        (b.1 - a.1 - share * (c.1 - a.1)) / (1.0 + share * share + (1.0 - share).powi(2)).sqrt()
    });
    spread(off, 0.0)
}
