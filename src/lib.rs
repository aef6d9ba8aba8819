//! Simulation of a friction experiment, comparison with measurements, and the search for a missing effect.
//!
//! Data flows one way, in the order of the modules below: a scenario file becomes a validated [`scenario::Scenario`],
//! that a [`model::Model`], the model [steady states](solver::SteadyState), those a sweep's [`sweep::Outcome`], figures and a
//! report. A module reads only those that come before it in this list, which `tests/architecture.rs` checks; [`cli`]
//! assembles the steps. What computes is a crate of its own, `stickslip-engine`, whose modules are those of this one.
//!
//! ```no_run
//! use stickslip::{compare, discover, measurement, scenario, sweep};
//!
//! let scenario = scenario::load("rig/scenario.toml")?;
//! let outcome = sweep::run(&scenario, &sweep::Options::default());
//! println!("{} resonance curves", outcome.curves.len());
//! if let Some(table) = measurement::load(&scenario)? {
//!     let comparison = compare::compare(&scenario, &table, &compare::Options { seed: 0 });
//!     println!("chi2 per point: {:.2}", comparison.overall.chi2_per_point);
//!     let discovery = discover::discover(&scenario, &table, &discover::SearchOptions::default());
//!     println!("{}", discover::sentence(&discovery));
//! }
//! # Ok::<(), stickslip::error::Error>(())
//! ```
//!
//! `examples/` has these steps one by one, and an effect of one's own.
//!
//! What everything may use:
//!
//! * [`error`] - what can go wrong, and the exit status of each.
//! * [`interrupt`], [`terminal`], [`files`], [`results`] - what every write goes through.
//! * [`statistics`], [`dual`], `roots`, `linear` - medians and angles, numbers with gradients, zeros of functions, least squares.
//! * [`units`] - numbers with units, read and written.
//! * [`parameter`] - what is known of a number of the model: key, symbol, unit, bounds, scale, and its index.
//!
//! From a file to steady states:
//!
//! * [`effects`] - one registry; everything else knows an effect only through it.
//! * [`scenario`] - raw TOML to a validated scenario in SI: what was written and what is meant are two types.
//! * [`measurement`] - tables of measured steady states with their uncertainties, from files that are only read.
//! * [`model`] - rig, contact and effects assembled; no numerics.
//! * [`solver`] - knows no physics: closed forms, Euler procedure, harmonic balance, shooting.
//! * [`sweep`] - rayon over cases, input order preserved, progress.
//!
//! What measurements say of the model:
//!
//! * [`fit`] - parameters by least squares, their intervals by profiles of the likelihood.
//! * [`compare`] - the model calibrated, and what it leaves judged.
//! * [`free_form`] - on which variable what is missing depends, before any law is named.
//! * [`discover`] - the search for a missing effect.
//! * [`question`] - which effects can make one curve look like another, ranked by how far they have to be strained.
//! * [`prony`] - measured moduli of a material as a series of relaxations, and the contact nearest to it.
//! * [`trial`] - blind trials of the discovery: planted causes, sealed answers, scores.
//!
//! Evidence:
//!
//! * [`atlas`] - what each effect of the registry does to resonance curves, by strength.
//! * [`verification`] - numbers that prove the solvers in every run.
//! * [`claims`] - the ledger of published statements, each computed and judged.
//! * [`gate`] - what a scenario or the command line demands, judged.
//! * [`history`] - a record of every run, and where its values moved from one level to another.
//! * [`cache`] - results of earlier runs, kept under a hash of everything that they follow from.
//!
//! What people see:
//!
//! * [`figures`] - outcome or comparison in, SVG, PNG and CSV out; never simulates.
//! * [`report`] - serialisable views, rendered as HTML and written as JSON.
//! * [`cli`] - the commands.

#[doc(inline)]
pub use stickslip_engine::{
    compare, discover, dual, effects, error, files, fit, free_form, interrupt, linear, measurement, model, parameter,
    prony, question, results, roots, scenario, solver, statistics, sweep, terminal, trial, units,
};

pub mod atlas;
pub mod cache;
pub mod claims;
pub mod cli;
pub mod figures;
pub mod gate;
pub mod history;
pub mod report;
pub mod verification;
