//! CSV files.

use std::sync::{Arc, OnceLock};

use cvtcycle::calibrate::data::{self, Form};
use cvtcycle::config::bounded::ReadError;
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{Format, read_columns, read_csv, write};
use cvtcycle::config::setup::{self, Files, Options, embedded_vehicles};
use cvtcycle::config::{Document, Problems, Reader, Section, render};
use cvtcycle::model::keys::Values;
use cvtcycle::model::keys::file_table::FileTable;
use cvtcycle::model::maps::{Basis, NoMap};
use cvtcycle::model::transmission::box_map::{self, MANUAL_BOX};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::model::transmission::cvt::variator::point::PointStatus;
use cvtcycle::output::History;
use cvtcycle::validate::belt::{self, Job, Model, Solved, Take};

use super::within_memory;

/// Asserts that a refusal has at least one problem, and renders it.
fn checked<T>(answer: Result<T, Problems>) -> Option<T> {
    answer
        .map_err(|problems| {
            assert!(!problems.is_empty(), "refused without a word");
            assert!(!render(&problems, false).is_empty());
        })
        .ok()
}

/// Cycle of another program, over time or distance.
pub fn cycle(data: &[u8]) {
    drivable(data, &Columns::default());
}

/// Column mapping in the first line, and the table below it.
pub fn logger(data: &[u8]) {
    let (list, table) = match data.iter().position(|byte| *byte == b'\n') {
        Some(end) => (&data[..end], &data[end + 1..]),
        None => (data, &[][..]),
    };
    let columns = Columns::parse(&String::from_utf8_lossy(list)).map_err(Problems::from);
    if let Some(columns) = checked(columns) {
        drivable(table, &columns);
    }
}

/// Asserts that a valid cycle can be driven, and is unchanged after being written in any form and read again.
fn drivable(data: &[u8], columns: &Columns) {
    within_memory(data.len(), || {
        let Some(cycle) = checked(read_columns("fuzz.csv", data, columns)) else {
            return;
        };
        // The reader has limits in s and km/h; a number that rounding moves beyond one of them is refused.
        for (name, format) in Format::NAMES {
            let text = write(&cycle, &cycle.manual, format).text;
            let Ok(again) = read_csv("again.csv", text.as_bytes()) else {
                continue;
            };
            let (own, other) = (&cycle.manual.intervals, &again.manual.intervals);
            assert_eq!(own.len(), other.len(), "{name}");
            for (a, b) in own.iter().zip(other.iter()) {
                let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
                assert!(is_near(a.end_s, b.end_s), "{name}: {a:?} {b:?}");
                assert!(
                    is_near(a.end_speed_m_s, b.end_speed_m_s),
                    "{name}: {a:?} {b:?}"
                );
            }
        }
        for automatic in [false, true] {
            let trace = cycle.trace_for(automatic);
            let (duration_s, distance_m) = (trace.duration_s(), trace.distance_m());
            assert!(
                duration_s.is_finite() && duration_s > 0.0,
                "a cycle of {duration_s} s"
            );
            assert!(
                distance_m.is_finite() && distance_m >= 0.0,
                "a cycle of {distance_m} m"
            );
        }
    });
}

/// Single file in memory, returned for any map that a vehicle names.
#[derive(Debug)]
struct SingleFile(Arc<[u8]>);

impl Files for SingleFile {
    fn read(&self, _: &str) -> Result<Vec<u8>, ReadError> {
        Ok(self.0.to_vec())
    }
}

cvtcycle::model::keys! {
    /// A table that names a map.
    NAMED: NamedKeys = "named" [] {
        map: csv(), "a map";
    }
}

/// Rover 216: swept volume and fuel of the engine.
const BASIS: Basis = Basis {
    heating_value_j_kg: 43e6,
    displacement_m3: 1.588e-3,
    cylinders: Some(4.0),
};
/// Swept volume of another engine that was measured: that of the maps of the corpus which have torque and pressure.
const ANOTHER: Basis = Basis {
    displacement_m3: 1.998e-3,
    ..BASIS
};

/// Makes the map of a key; false after a refusal.
fn made(which: usize, s: &Section<'_>) -> bool {
    let of_box = |table: &'static FileTable| {
        let Some(rows) = s.file_table(&NAMED.map, table) else {
            return false;
        };
        // With and without a loss at no torque, which efficiencies need.
        let [made, _] = [None, Some(4.0)].map(|idle_nm| {
            box_map::points(&rows, idle_nm)
                .and_then(|points| box_map::of_points(&rows, &points, table.is_grid))
        });
        let report = |why: NoMap| Values::complain(s, "map", &why.allowed, &why.message, &why.hint);
        made.map_err(report).is_ok()
    };
    match which {
        0 => {
            let maps = [BASIS, ANOTHER].map(|basis| s.bsfc_map(&NAMED.map, &basis));
            for map in maps.iter().flatten() {
                let verdict = map.judge(|_| 1e6);
                assert!(verdict.refusal.is_none() || verdict.doubts.is_empty());
                let numbers = map.fuel_pa.iter().flatten();
                numbers.for_each(|fuel| assert!(fuel.is_finite(), "fuel of {fuel} Pa"));
            }
            maps.iter().any(Option::is_some)
        }
        1 | 2 => s.loss_map(&NAMED.map, "ratio").is_some(),
        _ => of_box(&MANUAL_BOX),
    }
}

/// BSFC map or map of losses, chosen by the first byte: the map alone, and one that is valid in its whole car. Three quarters of the time went into keys of
/// the car that the input does not change.
pub fn map(data: &[u8]) {
    const USERS: [(usize, &str); 4] = [
        (0, "engine.model.bsfc_map.file=fuzz.csv"),
        (0, "transmission.cvt.maps.belt=fuzz.csv"),
        (0, "transmission.cvt.maps.pump=fuzz.csv"),
        (1, "transmission.manual.maps.box=fuzz.csv"),
    ];
    static ALONE: OnceLock<Document> = OnceLock::new();
    static CARS: OnceLock<[&'static str; 2]> = OnceLock::new();
    let Some((which, rest)) = data.split_first() else {
        return;
    };
    let cars = CARS.get_or_init(|| {
        ["rover_216_cvt", "rover_216_5mt"].map(|name| {
            let found = embedded_vehicles().iter().find(|(known, _)| *known == name);
            found.unwrap_or_else(|| panic!("no {name}")).1
        })
    });
    let which = usize::from(*which) % USERS.len();
    let alone = ALONE.get_or_init(|| {
        let text = "[named]\nmap = \"fuzz.csv\"\n";
        Document::parse("fuzz.toml", text).unwrap_or_else(|_| panic!("{text}"))
    });
    let bytes: Arc<[u8]> = rest.into();
    let files = SingleFile(Arc::clone(&bytes));
    let is_made = within_memory(rest.len(), || {
        let reader = Reader::new(alone).with_files(&files);
        let is_made = made(which, &reader.root().table("named"));
        let read = checked(reader.finish()).is_some();
        assert!(is_made || !read, "refused without a word");
        is_made
    });
    if !is_made {
        return;
    }
    let (car, set) = USERS[which];
    let options = Options {
        set: vec![set.parse().unwrap_or_else(|p| panic!("{p}"))],
        ..Options::default()
    };
    within_memory(rest.len(), || {
        checked(setup::read(
            "fuzz.toml",
            cars[car],
            Box::new(SingleFile(Arc::clone(&bytes))),
            &options,
        ))
    });
}

/// Checks every row of a table of belt points.
struct CheckPoints(bool);

impl Take for CheckPoints {
    fn begin(&mut self, _: bool) -> Result<(), Problems> {
        self.0 = true;
        Ok(())
    }

    fn put(&mut self, _: &str, row: &Solved) -> Result<(), Problems> {
        assert!(self.0, "a row before the line of names");
        let losses = [
            row.point.band_loss_nm,
            row.point.film_loss_nm,
            row.point.slip_loss_nm,
            row.point.wedge_loss_nm,
            row.point.penetration_loss_nm,
        ];
        if row.formulation == Formulation::Smooth {
            for loss in losses.into_iter().flatten() {
                assert!(
                    loss >= 0.0 && loss.is_finite(),
                    "a loss of {loss} Nm in {row:?}"
                );
            }
            let sum: f64 = losses.into_iter().flatten().sum();
            assert!(
                (row.point.loss_nm - sum).abs() <= 1e-9 * (1.0 + sum),
                "parts add up to {sum} Nm in {row:?}"
            );
        } else if row.point.status == PointStatus::Ok {
            assert!(
                row.point.loss_nm.is_finite(),
                "a loss of {} Nm in {row:?}",
                row.point.loss_nm
            );
        }
        Ok(())
    }
}

/// Belt of the shipped car.
fn belt_model() -> Model {
    let setup = setup::load("rover_216_cvt", &Options::default())
        .unwrap_or_else(|_| panic!("the shipped car"));
    Model::new(&setup, None).unwrap_or_else(|| panic!("a car with a belt"))
}

/// Evaluates a table of belt points; each line may be a point.
pub fn table_of_points(text: &[u8], formulation: Formulation) {
    thread_local!(static MODEL: Model = belt_model());
    let mut model = Some(MODEL.with(Model::clone));
    within_memory(text.len(), || {
        let mut look = CheckPoints(false);
        let job = Job {
            model: model.take(),
            formulation,
            rows: &mut look,
        };
        checked(belt::read("fuzz.csv", text, job))
    });
}

pub fn points(data: &[u8]) {
    let Some((which, rest)) = data.split_first() else {
        return;
    };
    table_of_points(
        rest,
        Formulation::NAMES[usize::from(*which) % Formulation::NAMES.len()].1,
    );
}

pub fn measured(data: &[u8]) {
    let Some((which, rest)) = data.split_first() else {
        return;
    };
    let form = Form::ALL[usize::from(*which) % Form::ALL.len()];
    within_memory(rest.len(), || checked(data::check(form, "fuzz.csv", rest)));
}

pub fn history(data: &[u8]) {
    within_memory(data.len(), || {
        checked(History::read_csv("history.csv", data))
    });
}
