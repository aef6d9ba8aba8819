//! Simulation of a friction experiment, comparison with measurements, and the search for a missing effect.
//!
//! Data flows one way, in the order of the modules below: a scenario file becomes a validated [`scenario::Scenario`],
//! that a [`model`], the model [steady states](solver::SteadyState), those a sweep [`sweep::Outcome`], figures and a report.
//! Imports only go up this list (apart from [`error`], [`statistics`], [`units`], the finding of roots, and what every write
//! goes through: [`files`], [`results`], [`terminal`], [`interrupt`]); `cli` assembles the steps.
//!
//! * [`scenario`] - raw serde TOML to validated scenario in SI: what was written and what is meant are two types.
//! * [`measurement`] - tables of measured steady states with their uncertainties, from files that are only read.
//! * [`effects`] - one registry; everything else knows an effect only through it.
//! * [`model`] - rig, contact and effects assembled; no numerics.
//! * [`solver`] - knows no physics: closed forms, Euler procedure, harmonic balance, shooting.
//! * [`sweep`] - rayon over cases, input order preserved, progress.
//! * [`atlas`] - what each effect of the registry does to resonance curves, by strength.
//! * [`question`] - which effects can make one curve look like another, ranked by how far they have to be strained.
//! * [`verification`] - numbers that prove the solvers in every run.
//! * [`claims`] - the ledger of published statements, each computed and judged.
//! * [`gate`] - what a scenario or the command line demands, judged.
//! * [`history`] - a record of every run, and where its values moved from one level to another.
//! * [`trial`] - blind trials of the discovery: planted causes, sealed answers, scores.
//! * [`free_form`] - on which variable what is missing depends, before any law is named.
//! * [`figures`] - outcome or comparison in, SVG, PNG and CSV out; never simulates.
//! * [`cache`] - results of earlier runs, kept under a hash of everything that they follow from.
//! * [`report`] - serialisable views, rendered as HTML and written as JSON.
pub mod atlas;
pub mod cache;
pub mod claims;
pub mod cli;
pub mod compare;
pub mod discover;
pub mod effects;
pub mod error;
pub mod figures;
pub mod files;
pub mod fit;
pub mod free_form;
pub mod gate;
pub mod history;
pub mod interrupt;
pub mod measurement;
pub mod model;
pub mod question;
pub mod report;
pub mod results;
mod roots;
pub mod scenario;
pub mod solver;
pub mod statistics;
pub mod sweep;
pub mod terminal;
pub mod trial;
pub mod units;
pub mod verification;
