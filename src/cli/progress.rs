//! How far a search is: a bar on a terminal, a line every few seconds elsewhere where that is asked for.

use super::Global;
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two looks on a terminal, and between two lines elsewhere.
const LOOK: Duration = Duration::from_millis(200);
const LINE: Duration = Duration::from_secs(3);

/// Does work that counts what each of so many searches spends of its budget of steady states.
pub fn of_searches<T>(global: &Global, searches: usize, budget: u64, work: impl FnOnce(&[Arc<AtomicU64>]) -> T) -> T {
    let solved: Vec<Arc<AtomicU64>> = std::iter::repeat_with(Arc::default).take(searches).collect();
    let budget = budget * searches as u64;
    let shown = !global.quiet && terminal::shows_progress();
    if !shown && !global.verbose {
        return work(&solved);
    }
    let bar = if shown { bar(budget) } else { ProgressBar::hidden() };
    let (working, done) = channel::<()>();
    std::thread::scope(|scope| {
        let (bar, seen) = (&bar, solved.clone());
        scope.spawn(move || {
            let began = Instant::now();
            while done.recv_timeout(if shown { LOOK } else { LINE }) == Err(RecvTimeoutError::Timeout) {
                let spent = seen.iter().map(|one| one.load(Relaxed)).sum::<u64>().min(budget);
                bar.set_position(spent);
                if !shown {
                    let seconds = began.elapsed().as_secs();
                    terminal::tell(&format!("searching: {seconds} s, {spent} of at most {budget} steady states"));
                }
            }
        });
        let found = work(&solved);
        drop(working);
        bar.finish_and_clear();
        found
    })
}

fn bar(budget: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("searching {bar:30} {pos} of at most {len} steady states, {elapsed}");
    ProgressBar::new(budget).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
