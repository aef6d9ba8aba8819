//! STUB to be replaced.
#![allow(missing_docs)]
use crate::error::Result;
use crate::scenario::Scenario;
use std::path::PathBuf;
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Point {
    pub row: usize,
    pub line: usize,
    pub speed: f64,
    pub load: f64,
    pub drive: f64,
    pub frequency: f64,
    pub amplitude: f64,
    pub phase: Option<f64>,
    pub amplitude_sd: f64,
    pub phase_sd: Option<f64>,
    pub mean: Option<f64>,
    pub replicates: usize,
}
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum NoiseSource {
    Stated,
    Estimated,
    Replicates,
}
#[derive(Debug, Clone, serde::Serialize)]
pub struct Table {
    pub file: PathBuf,
    pub hash: String,
    pub points: Vec<Point>,
    pub amplitude_noise: NoiseSource,
    pub phase_noise: Option<NoiseSource>,
    pub notes: Vec<String>,
}
pub fn load(scenario: &Scenario) -> Result<Option<Table>> {
    let Some(m) = &scenario.measurement else { return Ok(None) };
    let text = crate::scenario::embedded_text(&m.file)
        .map_or_else(|| std::fs::read_to_string(&m.file).unwrap(), str::to_string);
    let mut points = Vec::new();
    for (i, l) in text.lines().skip(1).enumerate() {
        let v: Vec<f64> = l.split(',').map(|x| x.parse().unwrap()).collect();
        points.push(Point {
            row: i + 1,
            line: i + 2,
            speed: v[0],
            load: v[1],
            drive: v[2],
            frequency: v[3],
            amplitude: v[4],
            phase: Some(v[6]),
            amplitude_sd: v[5],
            phase_sd: Some(v[7]),
            mean: None,
            replicates: 1,
        });
    }
    points.sort_by(|a, b| {
        (a.load, a.speed, a.drive, a.frequency).partial_cmp(&(b.load, b.speed, b.drive, b.frequency)).unwrap()
    });
    Ok(Some(Table {
        file: m.file.clone(),
        hash: String::new(),
        points,
        amplitude_noise: NoiseSource::Stated,
        phase_noise: Some(NoiseSource::Stated),
        notes: vec![],
    }))
}
