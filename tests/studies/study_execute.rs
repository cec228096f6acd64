//! Execution of a study: complete parts with any number of threads, failing and slow sinks.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use cvtcycle::config::Problem;
use cvtcycle::output::progress::{NoProgress, Progress};
use cvtcycle::study::plan::Plan;
use cvtcycle::study::store::{Rows, Values};
use cvtcycle::study::{End, PartWriter, Study};

/// 70 points of two cars on a short cycle: 24 parts, the last one with one point, the others with three.
fn study(keep: &str) -> Study {
    let text = format!(
        "[study]\ntitle = \"t\"\nbaselines = [\"rover_216_5mt\"]\ncycle = \"ece15\"\nkeep = {keep}\n[study.design.monte_carlo]\nsamples = 70\n\
         [[factor]]\nkey = \"road_load.mass_kg\"\ncars = \"all\"\nstatus = \"assumed\"\ndistribution.uniform = {{ low = 1000, high = 1250 }}\n"
    );
    Study::prepare(Plan::read("p.toml", &text).unwrap()).unwrap()
}

fn execute(
    study: &Study,
    threads: usize,
    sink: &dyn PartWriter,
    watcher: &dyn Progress,
) -> Result<End, Problem> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| study.execute(&BTreeSet::from([5]), sink, watcher))
}

/// Collects every part.
#[derive(Default)]
struct MemorySink(Mutex<BTreeMap<u64, (Rows, Option<Rows>)>>);

impl PartWriter for MemorySink {
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem> {
        let before = self
            .0
            .lock()
            .unwrap()
            .insert(part, (runs.clone(), trace.cloned()));
        assert!(before.is_none(), "part {part} twice");
        Ok(())
    }
}

fn points(rows: &Rows) -> Vec<i64> {
    match &rows.values[0] {
        Values::Count(points) => points.clone(),
        other => panic!("{other:?}"),
    }
}

/// Property: every missing part is computed once, with its points in order and the same cells, with one and with many threads.
#[test]
fn parts_are_whole_and_the_same_on_any_number_of_threads() {
    for keep in [
        "\"summary\"",
        "[\"time_s\", \"gear\", \"flags\", \"phase\", \"slip_percent\"]",
    ] {
        let study = study(keep);
        let parts = |threads| {
            let shelf = MemorySink::default();
            assert_eq!(
                execute(&study, threads, &shelf, &NoProgress).unwrap(),
                End::Complete
            );
            shelf.0.into_inner().unwrap()
        };
        let alone = parts(1);
        assert!(alone.keys().copied().eq((0..24).filter(|part| *part != 5)));
        for (part, (runs, trace)) in &alone {
            let of_part = study.part_points(*part).flat_map(|point| [point as i64; 2]);
            assert!(points(runs).into_iter().eq(of_part), "part {part}");
            assert_eq!(trace.is_some(), keep != "\"summary\"");
            // 195 rows per run, one per second.
            assert!(
                trace.as_ref().is_none_or(
                    |trace| trace.len() == 195 * runs.len() && points(trace).is_sorted()
                ),
                "part {part}"
            );
        }
        // Compared as text, since NaN differs from itself.
        assert_eq!(format!("{:?}", parts(5)), format!("{alone:?}"));
    }
}

/// Refuses one part.
struct FailingSink(u64);

impl PartWriter for FailingSink {
    fn write(&self, part: u64, _: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        let problem = || Problem::invalid("no room");
        if part == self.0 {
            Err(problem())
        } else {
            Ok(())
        }
    }
}

/// Property: the sink's problem ends the study.
#[test]
fn a_sink_that_fails_ends_the_study_with_its_problem() {
    let study = study("\"summary\"");
    for part in [0, 11, 23] {
        for threads in [1, 4] {
            assert_eq!(
                execute(&study, threads, &FailingSink(part), &NoProgress)
                    .unwrap_err()
                    .message,
                "no room"
            );
        }
    }
}

/// The writer waits until a driving thread has written a part.
#[derive(Default)]
struct SlowSink {
    parts: AtomicU64,
    by_drivers: Mutex<u32>,
    changed: Condvar,
}

impl PartWriter for SlowSink {
    fn write(&self, _: u64, _: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        self.parts.fetch_add(1, Ordering::Relaxed);
        let mut by_drivers = self.by_drivers.lock().unwrap();
        if rayon::current_thread_index().is_some() {
            *by_drivers += 1;
            self.changed.notify_all();
        } else {
            let wait =
                self.changed
                    .wait_timeout_while(by_drivers, Duration::from_secs(120), |count| *count == 0);
            assert!(!wait.unwrap().1.timed_out(), "no other thread writes");
        }
        Ok(())
    }
}

/// Property: if writing takes longer than driving, the driving threads write too.
#[test]
fn driving_threads_write_when_the_writer_is_behind() {
    let slow = SlowSink::default();
    assert_eq!(
        execute(&study("\"summary\""), 1, &slow, &NoProgress).unwrap(),
        End::Complete
    );
    assert_eq!(slow.parts.load(Ordering::Relaxed), 23);
}

/// Stops after some runs.
struct StopAfter(Mutex<u64>);

impl Progress for StopAfter {
    fn advance(&self, runs: u64) {
        *self.0.lock().unwrap() += runs;
    }

    fn stopped(&self) -> bool {
        *self.0.lock().unwrap() >= 40
    }
}

/// Property: a stopped study reports it, and outputs complete parts only.
#[test]
fn a_stopped_study_leaves_whole_parts() {
    let study = study("\"summary\"");
    for threads in [1, 3] {
        let shelf = MemorySink::default();
        assert_eq!(
            execute(&study, threads, &shelf, &StopAfter(Mutex::new(0))).unwrap(),
            End::Stopped
        );
        let parts = shelf.0.into_inner().unwrap();
        assert!(!parts.is_empty() && parts.len() < 10, "{}", parts.len());
        assert!(parts.iter().all(|(part, (runs, _))| runs.len() as u64
            == 2 * (study.part_points(*part).end - study.part_points(*part).start)));
    }
}
