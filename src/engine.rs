//! What stickslip computes, from a scenario file to the effect that is missing: the first three parts of the library's
//! page, which lists every module. A crate of its own, so that figures and pages are compiled beside it and with less
//! effort.

pub mod compare;
pub mod discover;
pub mod dual;
pub mod effects;
pub mod error;
pub mod files;
pub mod fit;
pub mod free_form;
pub mod interrupt;
pub mod linear;
pub mod measurement;
pub mod model;
pub mod parameter;
pub mod prony;
pub mod question;
pub mod results;
pub mod roots;
pub mod scenario;
pub mod solver;
pub mod statistics;
pub mod sweep;
pub mod terminal;
pub mod trial;
pub mod units;
