//! Shares of trials with Wilson's interval.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// 97.5 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// So many of so many, with Wilson's 95 % interval of the share.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Proportion {
    /// Successes.
    pub successes: usize,
    /// Trials.
    pub of: usize,
    /// Share; `None` of none.
    pub share: Option<f64>,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Proportion {
    /// `successes` of `of`.
    pub fn new(successes: usize, of: usize) -> Self {
        if of == 0 {
            return Self { successes, of, share: None, low: 0.0, high: 1.0 };
        }
        let (n, p) = (of as f64, successes as f64 / of as f64);
        let scale = 1.0 / (1.0 + Z * Z / n);
        let middle = scale * (p + Z * Z / (2.0 * n));
        let half = scale * Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        Self { successes, of, share: Some(p), low: (middle - half).max(0.0), high: (middle + half).min(1.0) }
    }

    /// Counts what is true among the answers there are.
    pub fn count(answers: impl IntoIterator<Item = Option<bool>>) -> Self {
        let (mut successes, mut of) = (0, 0);
        for answer in answers.into_iter().flatten() {
            of += 1;
            successes += usize::from(answer);
        }
        Self::new(successes, of)
    }
}

impl Default for Proportion {
    fn default() -> Self {
        Self::new(0, 0)
    }
}

impl std::fmt::Display for Proportion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = match self.share {
            None => "-".to_string(),
            Some(_) => {
                format!("{}/{} ({:.0}-{:.0} %)", self.successes, self.of, 100.0 * self.low, 100.0 * self.high)
            }
        };
        f.pad(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilsons_interval_has_the_published_values() {
        // Brown, Cai and DasGupta (2001): 0 of 10, 5 of 10.
        let none = Proportion::new(0, 10);
        assert!(none.low < 1e-12 && (none.high - 0.2775).abs() < 1e-4, "{none:?}");
        let half = Proportion::new(5, 10);
        assert!((half.low - 0.2366).abs() < 1e-4 && (half.high - 0.7634).abs() < 1e-4, "{half:?}");
        assert_eq!(Proportion::new(0, 0).to_string(), "-");
        assert_eq!(Proportion::count([Some(true), None, Some(false)]).of, 2);
    }
}
