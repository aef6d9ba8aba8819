//! Who made the report, when, where and from what: the only place for time stamps, timings and facts about the host.

use std::time::{SystemTime, UNIX_EPOCH};

use super::format;
use super::view::{InputView, ProvenanceView, SCHEMA, ScenarioView, TimingView};

/// Id of the section in the page; everything before it is the same for the same input.
pub const SECTION: &str = "provenance";

/// What the program knows about its own run.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// The command that makes the report again, without output folder and threads.
    pub command: String,
    /// When it was made, in words.
    pub generated: String,
    /// Threads used; absent in a fixed provenance.
    pub threads: Option<usize>,
    /// Wall times \[s\] of the parts of the run, in the order in which they ran.
    pub timings: Vec<(String, f64)>,
    /// Whether host and timings are left out, so that two runs can be compared byte by byte.
    pub fixed: bool,
}

impl Provenance {
    /// As the run is, with the present time.
    pub fn now(command: &str, threads: usize) -> Self {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        Self {
            command: command.into(),
            generated: timestamp(seconds),
            threads: Some(threads),
            timings: Vec::new(),
            fixed: false,
        }
    }

    /// Without anything that differs between two runs or hosts.
    pub fn fixed(command: &str) -> Self {
        Self { command: command.into(), generated: "-".into(), threads: None, timings: Vec::new(), fixed: true }
    }

    /// [`Self::fixed`] with the date of `SOURCE_DATE_EPOCH` where that is set (reproducible-builds.org), otherwise [`Self::now`].
    pub fn from_environment(command: &str, threads: usize) -> Self {
        Self::from_epoch(std::env::var("SOURCE_DATE_EPOCH").ok().as_deref(), command, threads)
    }

    fn from_epoch(epoch: Option<&str>, command: &str, threads: usize) -> Self {
        match epoch {
            None => Self::now(command, threads),
            Some(epoch) => {
                let generated = epoch.trim().parse().map_or_else(|_| "-".into(), timestamp);
                Self { generated, ..Self::fixed(command) }
            }
        }
    }

    /// The view, with the inputs of the scenarios.
    pub fn view(&self, scenarios: &[ScenarioView]) -> ProvenanceView {
        let input = |scenario: &ScenarioView| InputView {
            id: scenario.id.clone(),
            path: scenario.path.clone(),
            hash: scenario.hash.clone(),
        };
        let table = |scenario: &ScenarioView| {
            let comparison = scenario.comparison.as_ref()?;
            let (path, hash) = (comparison.file.clone(), comparison.hash.clone());
            Some(InputView { id: format!("{}, measurements", scenario.id), path, hash })
        };
        let inputs =
            |scenario: &ScenarioView| std::iter::once(input(scenario)).chain(table(scenario)).collect::<Vec<_>>();
        let timing = |(part, seconds): &(String, f64)| TimingView {
            part: part.clone(),
            time: if self.fixed { "-".into() } else { format::duration(*seconds) },
        };
        let host = |fact: &str| if self.fixed { "-".into() } else { fact.to_owned() };
        ProvenanceView {
            program: env!("CARGO_PKG_NAME").into(),
            version: env!("CARGO_PKG_VERSION").into(),
            comparator: crate::compare::COMPARATOR.into(),
            schemas: vec![SCHEMA.into()],
            inputs: scenarios.iter().flat_map(inputs).collect(),
            command: self.command.clone(),
            generated: self.generated.clone(),
            os: host(std::env::consts::OS),
            arch: host(std::env::consts::ARCH),
            threads: self.threads.map_or("-".into(), |threads| threads.to_string()),
            timings: self.timings.iter().map(timing).collect(),
            times: None,
            slower: Vec::new(),
        }
    }
}

/// Seconds since 1970 as date and time in UTC (proleptic Gregorian calendar, days counted from a first of March).
fn timestamp(seconds: u64) -> String {
    let (days, time) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day) = (days / 146_097, days % 146_097);
    let year_of_era = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02} UTC", time / 3600, time / 60 % 60, time % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(timestamp(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(timestamp(951_782_400), "2000-02-29 00:00:00 UTC");
        assert_eq!(timestamp(1_700_000_000), "2023-11-14 22:13:20 UTC");
        assert_eq!(timestamp(4_102_444_799), "2099-12-31 23:59:59 UTC");
    }

    #[test]
    fn a_fixed_provenance_forgets_host_and_times() {
        let mut fixed = Provenance::from_epoch(Some("951782400"), "stickslip", 8);
        fixed.timings.push(("sweeps".into(), 1.25));
        let view = fixed.view(&[]);
        assert_eq!(view.generated, "2000-02-29 00:00:00 UTC");
        assert_eq!([view.os, view.arch, view.threads, view.timings[0].time.clone()], ["-"; 4].map(String::from));
        let mut now = Provenance::from_epoch(None, "stickslip", 8);
        now.timings.push(("sweeps".into(), 1.25));
        assert_eq!(now.view(&[]).timings[0].time, "1.25 s");
        assert_eq!(now.view(&[]).threads, "8");
    }
}
