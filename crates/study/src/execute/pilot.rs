//! Estimates time and size of a study from a few of its points, driven at once.

use std::ops::Range;
use std::time::Instant;

use super::prepare::Study;
use super::rows::{Filler, Traces};
use crate::store::{Head, Rows, write_parquet};
use serde::Serialize;

/// Points of a pilot.
const POINTS: u64 = 32;

/// Estimated cost of a study. Times and sizes vary with the draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pilot {
    /// Points that were driven.
    pub pilot_points: u64,
    /// Time of one thread for all points, s.
    pub cpu_s: f64,
    /// Time of one thread for a part, s.
    pub cpu_s_per_part: f64,
    /// Size of all parts as Parquet.
    pub bytes: u64,
}

impl Study {
    /// Parts of a share of the study, the `k`th of `n` from 0: from floor(k P/n) up to, and without, floor((k + 1) P/n) of P parts.
    pub fn shard(&self, k: u64, n: u64) -> Range<u64> {
        let parts = u128::from(self.parts());
        let at = |k: u64| u64::try_from(u128::from(k) * parts / u128::from(n.max(1)));
        at(k).unwrap_or(u64::MAX)..at(k + 1).unwrap_or(u64::MAX)
    }

    /// Drives some points of the design, evenly over it, on this thread, and estimates what all take.
    pub fn pilot(&self) -> Pilot {
        let count = POINTS.min(self.points).max(1);
        let point = |k: u64| u128::from(k) * u128::from(self.points) / u128::from(count);
        let points = (0..count).filter_map(|k| u64::try_from(point(k)).ok());
        let filler = Filler::new(self);
        let mut runs = Rows::with_capacity(&self.columns, 0);
        let mut traces = Traces::new(self, || 0);
        let mut half = None;
        // The first point of a thread reads the files of its cars, which is no part of the rest.
        self.points(0..1, None);
        let begun = Instant::now();
        for (k, point) in points.enumerate() {
            let of_points = self.points(point..point + 1, traces.as_mut());
            for of_point in &of_points {
                filler.push(point, of_point, &mut runs);
            }
            if k as u64 + 1 == count.div_ceil(2) {
                half = Some(runs.clone());
            }
        }
        let seconds = begun.elapsed().as_secs_f64() / count as f64;
        let traces = traces.map(Traces::into_rows).unwrap_or_default();
        let part = |rows: &Rows, heads: &[Head]| match heads.is_empty() {
            true => 0.0,
            false => size(heads, rows),
        };
        let whole = part(&runs, &self.columns);
        let half = half.map_or(0.0, |half| part(&half, &self.columns));
        // A file is a head and its rows.
        let rows = (count - count.div_ceil(2)).max(1) as f64;
        let per_point = (whole - half).max(0.0) / rows;
        let head = (whole - per_point * count as f64).max(0.0);
        let of_traces = part(&traces, &self.trace_columns) / count as f64;
        let bytes = self.parts() as f64 * head + self.points as f64 * (per_point + of_traces);
        Pilot {
            pilot_points: count,
            cpu_s: seconds * self.points as f64,
            cpu_s_per_part: seconds * self.points_per_part() as f64,
            bytes: bytes as u64,
        }
    }
}

/// Size of a table as Parquet.
fn size(heads: &[Head], rows: &Rows) -> f64 {
    let mut file = Vec::new();
    // Memory takes everything.
    let written = write_parquet(&mut file, heads, rows, &[]);
    written.map_or(f64::NAN, |()| file.len() as f64)
}
