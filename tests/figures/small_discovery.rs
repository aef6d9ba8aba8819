//! A discovery that is cheap: few conditions, every second frequency, one effect at most.

use stickslip::discover::{Discovery, SearchOptions, discover};
use stickslip::measurement::{self, Table};
use stickslip::scenario::{self, Scenario};

/// The scenario of an embedded practice table and four conditions of that table, thinned out.
pub fn small(number: usize) -> (Scenario, Table) {
    let scenario = scenario::load_embedded(&format!("practice/{number}/scenario")).unwrap();
    let mut table = measurement::load(&scenario).unwrap().unwrap();
    let mut settings: Vec<(f64, f64, f64)> = Vec::new();
    for p in &table.points {
        let setting = (p.speed, p.load, p.drive);
        if !settings.contains(&setting) {
            settings.push(setting);
        }
    }
    let step = settings.len().div_ceil(4);
    let kept: Vec<_> = settings.into_iter().step_by(step).collect();
    let mut count = 0;
    table.points.retain(|p| {
        count += 1;
        kept.contains(&(p.speed, p.load, p.drive)) && count % 2 == 0
    });
    (scenario, table)
}

/// What is missing there.
pub fn discovered(number: usize, change: impl FnOnce(&mut Scenario, &mut Table)) -> Discovery {
    let (mut scenario, mut table) = small(number);
    change(&mut scenario, &mut table);
    discover(&scenario, &table, &SearchOptions { max_effects: 1, ..SearchOptions::default() })
}
