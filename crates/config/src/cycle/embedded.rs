//! The cycles that the program carries. Where their tables come from: `cycles/SOURCES.md`.
//!
//! Only the one that is asked for is parsed.

use std::sync::{Arc, OnceLock};

use super::gears::GearCommand;
use super::plain::plain_trace;
use super::{Cycle, Interval, Trace, Weighting};

/// Cycle variant for an automatic or CVT.
#[derive(Clone, Copy)]
enum Automatic {
    /// The trace of the manual car.
    Same,
    /// Another table.
    Table(&'static str),
    /// The last `duration_s` of another table.
    TailOf { name: &'static str, duration_s: f64 },
    /// The first `idle_s` of the manual car's trace, then another table.
    IdleThen { idle_s: f64, name: &'static str },
}

/// Gears of a car with six gears, where the table has no column for it.
#[derive(Clone, Copy)]
enum SixGears {
    AsTable,
    /// The regulation's table prescribes the same gears for every gearbox.
    LikeFive,
    /// The first `idle_s` like five gears, then those of another table.
    IdleThen {
        idle_s: f64,
        name: &'static str,
    },
}

struct Entry {
    name: &'static str,
    title: &'static str,
    table: &'static str,
    automatic: Automatic,
    six_gears: SixGears,
}

macro_rules! entries {
    (@ $default:expr) => { $default };
    (@ $default:expr, $given:expr) => { $given };
    ($($name:literal $title:literal $(drives $automatic:expr)? $(, with $six:expr)?;)*) => {
        static ENTRIES: [Entry; 27] = [$(Entry {
            name: $name,
            title: $title,
            table: include_str!(concat!("../../data/cycles/", $name, ".csv")),
            automatic: entries!(@ Automatic::Same $(, $automatic)?),
            six_gears: entries!(@ SixGears::AsTable $(, $six)?),
        },)*];
    };
}

const EUDC_S: f64 = 400.0;
const MVEGA_IDLE_S: f64 = 40.0;

entries! {
    "artemis_motorway130" "Artemis motorway, 130 km/h version";
    "artemis_motorway150" "Artemis motorway, 150 km/h version";
    "artemis_road" "Artemis rural road";
    "artemis_urban" "Artemis urban";
    "ece15" "ECE 15, one elementary urban cycle (UN R83 part one)" drives Automatic::Table("ece15_auto"), with SixGears::LikeFive;
    "ece15_auto" "ECE 15, one elementary urban cycle without gear-change plateaux";
    "ece15_eudc" "NEDC: four ECE 15 and one EUDC, 1180 s (UN R83)" drives Automatic::Table("ece15_eudc_auto");
    "ece15_eudc_auto" "NEDC without gear-change plateaux";
    "ece15_eudc_low" "NEDC for low-powered cars: EUDC up to 90 km/h" drives Automatic::Table("ece15_eudc_low_auto");
    "ece15_eudc_low_auto" "NEDC for low-powered cars without gear-change plateaux";
    "eudc" "EUDC, extra-urban cycle (UN R83 part two)" drives Automatic::Table("eudc_auto");
    "eudc_auto" "EUDC without gear-change plateaux";
    "eudc_low" "EUDC for low-powered cars, up to 90 km/h" drives Automatic::TailOf { name: "ece15_eudc_low_auto", duration_s: EUDC_S };
    "ftp75" "FTP-75 with 600 s engine-off soak (40 CFR 86)";
    "hwfet" "HWFET, highway fuel economy test (40 CFR 600)";
    "jc08" "JC08 (Japan)";
    "jp_10_15_mode" "10-15 mode (Japan)";
    "la92" "LA92, unified cycle (California)";
    "mvega_idle40" "MVEG-A: 40 s idle before sampling, then the NEDC (until 2000)" drives Automatic::IdleThen { idle_s: MVEGA_IDLE_S, name: "ece15_eudc_auto" }, with SixGears::IdleThen { idle_s: MVEGA_IDLE_S, name: "ece15_eudc" };
    "nycc" "NYCC, New York City cycle (40 CFR 86)";
    "sc03" "SC03, air-conditioning test (40 CFR 86)";
    "udds" "UDDS, urban dynamometer driving schedule (40 CFR 86)";
    "us06" "US06, aggressive driving (40 CFR 86)";
    "wltc_class1" "WLTC class 1 (UN GTR 15)";
    "wltc_class2" "WLTC class 2 (UN GTR 15)";
    "wltc_class3a" "WLTC class 3a (UN GTR 15)";
    "wltc_class3b" "WLTC class 3b (UN GTR 15)";
}

static NAMES: [&str; ENTRIES.len()] = {
    let mut names = [""; ENTRIES.len()];
    let mut at = 0;
    while at < names.len() {
        names[at] = ENTRIES[at].name;
        at += 1;
    }
    names
};

/// Names of the cycles that the program carries, sorted. Constant speeds ([`super::constant_speed`]) are not among them.
#[must_use]
pub fn names() -> &'static [&'static str] {
    &NAMES
}

/// The cycle of this name, `None` if the program carries none. For the ECE cycles an automatic drives the table without
/// gear-change plateaux; a name that ends in `_auto` gives every car that table. FTP75 has its engine off in `hot_soak`.
///
/// A table is parsed when its name is first asked for.
#[must_use]
pub fn embedded(name: &str) -> Option<Cycle> {
    shared(name).cloned()
}

/// As [`embedded`], without a copy.
#[must_use]
pub fn shared(name: &str) -> Option<&'static Cycle> {
    static PARSED: [OnceLock<Option<Cycle>>; ENTRIES.len()] =
        [const { OnceLock::new() }; ENTRIES.len()];
    let place = NAMES.iter().position(|known| *known == name)?;
    let cycle = PARSED[place].get_or_init(|| parsed(&ENTRIES[place]));
    cycle.as_ref()
}

/// The cycle of this name if it takes so many seconds, give or take two; its table is parsed only then.
pub(crate) fn of_seconds(name: &str, seconds: usize) -> Option<&'static Cycle> {
    let found = entry(name)?;
    let rows = found.table.bytes().filter(|byte| *byte == b'\n').count();
    // A line of names, and a row at 0 s; the composed ones begin with 40 s of rest.
    let near = |own: usize| own.saturating_sub(2).abs_diff(seconds) <= 2;
    near(rows).then(|| shared(name)).flatten()
}

fn parsed(entry: &Entry) -> Option<Cycle> {
    let mut phases = Vec::new();
    let mut manual = table(entry, &mut phases)?;
    let automatic = match entry.automatic {
        Automatic::Same => None,
        Automatic::Table(name) => Some(named(name, &mut phases)?),
        Automatic::TailOf { name, duration_s } => {
            Some(tail(&named(name, &mut Vec::new())?, duration_s))
        }
        Automatic::IdleThen { idle_s, name } => {
            Some(idle_then(&manual, idle_s, &named(name, &mut phases)?))
        }
    };
    let six = match entry.six_gears {
        SixGears::AsTable => None,
        SixGears::LikeFive => manual.gears(5).map(<[GearCommand]>::to_vec),
        SixGears::IdleThen { idle_s, name } => {
            idle_then_gears(&manual, idle_s, &named(name, &mut phases)?)
        }
    };
    if six.is_some() {
        manual.gear_columns_mut().six = six;
    }
    let weighting = if entry.name == "ftp75" {
        Weighting::Ftp75
    } else {
        Weighting::None
    };
    if weighting == Weighting::Ftp75 {
        stop_engine(&mut manual, &phases, "hot_soak");
    }
    if US_CITY.contains(&entry.name) {
        manual = manual.with_selector_s(US_CITY_SELECTOR_S);
    }
    if US.contains(&entry.name) {
        manual = manual.with_tolerance_m_s(US_TOLERANCE_M_S);
    }
    let (name, title) = (entry.name.to_owned(), entry.title.to_owned());
    Some(Cycle {
        name,
        title,
        phases,
        weighting,
        manual,
        automatic,
        read_as: None,
        recording: None,
        is_wltc: entry.name.starts_with("wltc_class"),
    })
}

/// Cycles of the US, ...
const US: [&str; 7] = ["ftp75", "udds", "hwfet", "us06", "sc03", "nycc", "la92"];
/// ... and their tolerance of speed, m/s: 2 mph (40 CFR 1066.425, from memory; TR-3).
const US_TOLERANCE_M_S: f64 = 2.0 * 0.44704;
/// Cycles of the US city test, ...
const US_CITY: [&str; 2] = ["udds", "ftp75"];
/// ... and the time from a start of the engine until the selector is moved to drive, s (40 CFR 86.136-90).
const US_CITY_SELECTOR_S: f64 = 15.0;

fn entry(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

fn named(name: &str, phases: &mut Vec<String>) -> Option<Trace> {
    table(entry(name)?, phases)
}

// A test reads every table as a user's file: to the same trace, without a problem.
fn table(entry: &Entry, phases: &mut Vec<String>) -> Option<Trace> {
    plain_trace(entry.table, phases)
}

fn shifted(interval: &Interval, by_s: f64) -> Interval {
    Interval {
        start_s: interval.start_s + by_s,
        end_s: interval.end_s + by_s,
        ..*interval
    }
}

// The part is a cycle of its own, without phases.
fn tail(whole: &Trace, duration_s: f64) -> Trace {
    let from_s = whole.duration_s() - duration_s;
    let part = whole
        .intervals
        .iter()
        .filter(|interval| interval.start_s >= from_s);
    Trace::without_gears(
        part.map(|interval| Interval {
            phase: 0,
            ..shifted(interval, -from_s)
        })
        .collect(),
    )
}

fn idle(trace: &Trace, idle_s: f64) -> impl Iterator<Item = &Interval> {
    trace
        .intervals
        .iter()
        .take_while(move |interval| interval.end_s <= idle_s)
}

fn idle_then(first: &Trace, idle_s: f64, then: &Trace) -> Trace {
    let rest = then
        .intervals
        .iter()
        .map(|interval| shifted(interval, idle_s));
    Trace::without_gears(idle(first, idle_s).copied().chain(rest).collect())
}

fn idle_then_gears(first: &Trace, idle_s: f64, then: &Trace) -> Option<Vec<GearCommand>> {
    let idle = first.gears(5)?.iter().take(idle(first, idle_s).count());
    Some(idle.chain(then.gears(6)?).copied().collect())
}

fn stop_engine(trace: &mut Trace, phases: &[String], soak: &str) {
    let soak = (0_u16..)
        .zip(phases)
        .find(|phase| phase.1 == soak)
        .map(|phase| phase.0);
    for interval in Arc::make_mut(&mut trace.intervals) {
        interval.engine_off = Some(interval.phase) == soak;
    }
}

#[cfg(test)]
mod tests {
    use super::super::read::read_trace;
    use super::*;
    use crate::csv::Columns;

    /// Truth: the reader of users' files, which finds no problem in any table of the program. A known phase, and one that is not in the table, come before.
    #[test]
    fn every_table_is_as_a_users_file() {
        for entry in &ENTRIES {
            for before in [&[][..], &["bag1", "UDC"]] {
                let before: Vec<String> = before.iter().map(|name| (*name).to_owned()).collect();
                let own = (entry.name, &Columns::default());
                let (mut phases, mut plain_phases) = (before.clone(), before);
                let read = read_trace(own, entry.table.as_bytes(), &mut phases);
                let plain = table(entry, &mut plain_phases);
                match (read, plain) {
                    (Ok((read, None)), Some(plain)) => assert_eq!(read, plain, "{}", entry.name),
                    (read, plain) => panic!("{}: {read:?} {plain:?}", entry.name),
                }
                assert_eq!(phases, plain_phases, "{}", entry.name);
            }
        }
    }

    #[test]
    fn the_urban_part_prescribes_the_same_for_six_gears_as_for_five() {
        // what SixGears::LikeFive is based on
        let trace = table(entry("ece15_eudc").unwrap(), &mut Vec::new()).unwrap();
        assert_eq!(
            trace.gears(5).unwrap()[..780],
            trace.gears(6).unwrap()[..780]
        );
        assert_ne!(trace.gears(5).unwrap(), trace.gears(6).unwrap());
    }
}
