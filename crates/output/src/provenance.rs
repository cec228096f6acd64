//! Origin of a car: its files with their hashes, the differences from the most similar shipped vehicle, and every value.

use crate::files::{hex, sha256};
use crate::number::{finite, push_debug, push_plain};
use crate::record::{
    CarRecord, Change, CycleRecord, FileRecord, FuelMapRecord, SpeedLine, ValueRecord,
};
use cvtcycle_config::cycle::{Cycle, GearCommand, Weighting};
use cvtcycle_config::setup::{
    Kind, Options, Setup, embedded_vehicles, is_path, is_twin, load, text_of,
};
use cvtcycle_config::{KeyInfo, Problems, unit_of};
use cvtcycle_model::drive::fuel_map;
use cvtcycle_model::engine::FuelModel;
use cvtcycle_model::keys::RAD_S;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::RatioDemand;

/// Maximum speed of the drawn lines of the variogram, km/h.
const FASTEST_KMH: f64 = 200.0;
/// Listed targets of a ratio control, as shares of rated power with their names.
const TARGETS: [(f64, &str); 4] = [
    (-0.05, "target in overrun"),
    (0.10, "target, 10 % of rated power"),
    (0.30, "target, 30 % of rated power"),
    (0.60, "target, 60 % of rated power"),
];

/// SHA-256 in hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    hex(&sha256(bytes))
}

/// Records a cycle's name and hash.
pub fn cycle_record(cycle: &Cycle) -> CycleRecord {
    CycleRecord {
        name: cycle.name.clone(),
        title: cycle.title.clone(),
        sha256: cycle_sha256(cycle),
        file: None,
    }
}

/// Hashes the text of a cycle's phases, intervals and gears.
pub fn cycle_sha256(cycle: &Cycle) -> String {
    hash(cycle_text(cycle).as_bytes())
}

/// Text of a cycle: weighting and phases, then for each trace one row an interval and the columns of its gears. Speeds are in m/s. Omits name
/// and title.
fn cycle_text(cycle: &Cycle) -> String {
    let mut text = match cycle.weighting {
        Weighting::None => "weighting = none\n".to_owned(),
        Weighting::Ftp75 => "weighting = ftp75\n".to_owned(),
    };
    text += &format!("phases = {}\n", cycle.phases.join(","));
    for (name, trace) in [
        ("manual", Some(&cycle.manual)),
        ("automatic", cycle.automatic.as_ref()),
    ] {
        let Some(trace) = trace else { continue };
        text += &format!("{name} = start_s,end_s,start_m_s,end_m_s,phase,grade,engine_off\n");
        for row in trace.intervals.iter() {
            let (start_m_s, end_m_s) = (row.start_speed_m_s, row.end_speed_m_s);
            let (start_s, end_s, phase) = (row.start_s, row.end_s, row.phase);
            for x in [
                start_s,
                end_s,
                start_m_s,
                end_m_s,
                f64::from(phase),
                row.grade,
            ] {
                push_plain(&mut text, x);
                text.push(',');
            }
            text += if row.engine_off { "1\n" } else { "0\n" };
        }
        for (column, commands) in trace.gear_columns() {
            text += &format!("{column} = ");
            for (k, command) in commands.iter().enumerate() {
                text += if k > 0 { "," } else { "" };
                push_command(&mut text, *command);
            }
            text.push('\n');
        }
    }
    text
}

/// Appends a command as its `Display` does, without the cost of formatting for the most common one.
fn push_command(text: &mut String, command: GearCommand) {
    match command {
        GearCommand::InGear(gear @ 0..=9) => text.push(char::from(b'0' + gear)),
        GearCommand::Neutral => text.push_str("0 PM"),
        _ => text.push_str(&command.to_string()),
    }
}

/// Hashes the text of a checked car's values and maps.
pub fn car_sha256(setup: &Setup) -> String {
    hash(car_text(setup).as_bytes())
}

/// Text of a checked car: lines `key = value`, sorted by key and in SI units, with the formulation of its belt and the points of the maps that
/// its files name. Omits names and descriptions of files (`[vehicle]`, titles), statuses and notes.
fn car_text(setup: &Setup) -> String {
    let is_value = |info: &&KeyInfo| {
        let names = info.key.starts_with("vehicle.") || info.key.ends_with(".title");
        !names && !info.value.is_empty()
    };
    let line = |info: &KeyInfo| {
        let mut line = String::with_capacity(info.key.len() + info.value.len() + 32);
        line += &info.key;
        line += " = ";
        match info.si {
            Some(si) => push_debug(&mut line, si),
            None => line += &info.value,
        }
        line.push('\n');
        line
    };
    let mut lines: Vec<String> = setup.keys.iter().filter(is_value).map(line).collect();
    lines.sort_unstable();
    if let Transmission::Cvt(cvt) = setup.transmission() {
        lines.push(format!("formulation = {}\n", cvt.belt.formulation.name()));
        if let Some(map) = &cvt.ratio.shift_map {
            lines.push(format!("shift map = {:?}\n", map.points()));
        }
        if let Some(table) = &cvt.pressure_table {
            let (axes, values) = (table.grid().axes(), table.grid().values());
            lines.push(format!("pressure table = {axes:?} {values:?}\n"));
        }
    }
    for (component, map) in setup.transmission().maps() {
        let (axes, values) = (map.grid().axes(), map.grid().values());
        lines.push(format!("map {} = {axes:?} {values:?}\n", component.name()));
    }
    if let FuelModel::Map(map) = &setup.engine().fuel {
        let (speeds, loads, fuel) = (&map.speed_rad_s, &map.bmep_pa, &map.fuel_pa);
        lines.push(format!("map fuel = {speeds:?} {loads:?} {fuel:?}\n"));
    }
    lines.concat()
}

/// Builds the record of a car. `name` is its name within the run, `word` the user's name for it.
///
/// # Errors
/// Problems of files; cannot occur if the car has just been loaded from them.
pub fn car_record(
    name: &str,
    word: &str,
    options: &Options,
    setup: &Setup,
) -> Result<CarRecord, Problems> {
    let (file, text, _) = text_of(word, Kind::Vehicle, options.named_by)?;
    let file_record = |file: String, text: &str| FileRecord {
        file,
        sha256: hash(text.as_bytes()),
    };
    let fluid = |word: &str| {
        let (file, text, _) = text_of(word, Kind::Lubricant, options.named_by)?;
        Ok::<_, Problems>(file_record(file, &text))
    };
    let [oil, engine_oil] = &setup.origin.fluids;
    let parents = setup.origin.parents.iter();
    let inherited = parents.map(|(file, text)| file_record(file.clone(), text));
    let reference = reference(setup, word, options)?;
    Ok(CarRecord {
        name: name.to_owned(),
        vehicle: file_record(file, &text),
        inherited: inherited.collect(),
        lubricant: fluid(oil)?,
        engine_oil: fluid(engine_oil)?,
        resolved_sha256: car_sha256(setup),
        reference_values: (reference.same, reference.setup.keys.len()),
        changes: changes(&reference.setup.keys, &setup.keys),
        reference: reference.setup.name,
        values: setup.keys.iter().map(value).collect(),
        fuel_map: fuel_map_record(setup),
        speed_lines: speed_lines(setup),
    })
}

/// Most similar shipped vehicle.
struct Reference {
    setup: Setup,
    same: usize,
}

/// Finds the reference: a shipped vehicle is its own, a user's file or a twin has the shipped one with which it shares the largest number of
/// values.
fn reference(setup: &Setup, word: &str, options: &Options) -> Result<Reference, Problems> {
    let plain = Options {
        formulation: options.formulation,
        ..Options::default()
    };
    if setup.origin.is_shipped {
        return Ok(Reference {
            same: setup.keys.len(),
            setup: setup.clone(),
        });
    }
    let names = embedded_vehicles().iter().map(|(name, _)| *name);
    let names = names.filter(|name| is_path(word) || is_twin(word) || *name == word);
    let mut best: Option<Reference> = None;
    for name in names {
        let shipped = load(name, &plain)?;
        let is_same = |info: &&KeyInfo| {
            shipped
                .keys
                .iter()
                .any(|other| other.key == info.key && equal(other, info))
        };
        let same = setup.keys.iter().filter(is_same).count();
        if best.as_ref().is_none_or(|best| same > best.same) {
            best = Some(Reference {
                setup: shipped,
                same,
            });
        }
    }
    best.ok_or_else(Problems::new)
}

fn equal(a: &KeyInfo, b: &KeyInfo) -> bool {
    match (a.si, b.si) {
        (Some(a), Some(b)) => a.to_bits() == b.to_bits(),
        _ => a.value == b.value,
    }
}

/// Lists values that differ, or that only one of both has; values set by the user come first.
fn changes(shipped: &[KeyInfo], here: &[KeyInfo]) -> Vec<Change> {
    let find = |list: &'_ [KeyInfo], key: &str| list.iter().find(|info| info.key == key).cloned();
    let mut list: Vec<(bool, Change)> = Vec::new();
    for info in here {
        let other = find(shipped, &info.key);
        let same = other
            .as_ref()
            .map_or(info.value.is_empty(), |other| equal(other, info));
        if !same {
            list.push((info.status == "set", change(other.as_ref(), Some(info))));
        }
    }
    let is_gone = |info: &&KeyInfo| !info.value.is_empty() && find(here, &info.key).is_none();
    let gone = shipped.iter().filter(is_gone);
    list.extend(gone.map(|info| (false, change(Some(info), None))));
    list.sort_by_key(|(set, _)| !set);
    list.into_iter().map(|(_, change)| change).collect()
}

fn change(shipped: Option<&KeyInfo>, here: Option<&KeyInfo>) -> Change {
    let text = |info: Option<&KeyInfo>| info.map_or(String::new(), |info| info.value.clone());
    let key = here.or(shipped).map_or("", |info| &info.key);
    Change {
        key: key.to_owned(),
        unit: unit_of(key).to_owned(),
        shipped: text(shipped),
        here: text(here),
    }
}

fn value(info: &KeyInfo) -> ValueRecord {
    let meaning = info.meaning();
    let info = info.clone();
    ValueRecord {
        key: info.key,
        value: info.value,
        unit: info.unit,
        status: info.status,
        source: info.source,
        doc: meaning,
    }
}

fn fuel_map_record(setup: &Setup) -> FuelMapRecord {
    /// kg/J to g/kWh.
    const G_KWH: f64 = 3.6e9;
    let bsfc_g_kwh = |row: &Vec<f64>| row.iter().map(|b| finite(b * G_KWH)).collect();
    let map = fuel_map(setup);
    FuelMapRecord {
        speed_rpm: map.speed_rad_s.iter().map(|w| w * RAD_S).collect(),
        torque_nm: map.torque_nm,
        bsfc_g_kwh: map.bsfc_kg_j.iter().map(bsfc_g_kwh).collect(),
        full_load_nm: map.full_load_nm,
    }
}

/// Engine speed over road speed, for rigid wheels and no belt slip: gears, or limits and targets of a ratio control.
fn speed_lines(setup: &Setup) -> Vec<SpeedLine> {
    let radius_m = setup.road_load.base.wheel_radius_m;
    let highest_rpm = setup.engine().highest_rad_s * RAD_S;
    // rpm per km/h in a whole ratio from engine to wheel.
    let slope = |overall: f64| overall / 3.6 / radius_m * RAD_S;
    let straight = |name: String, overall: f64| {
        let fastest = (highest_rpm / slope(overall)).min(FASTEST_KMH);
        SpeedLine {
            name,
            points: vec![(0.0, 0.0), (fastest, fastest * slope(overall))],
        }
    };
    match setup.transmission() {
        Transmission::Manual(manual) => {
            let gears = manual.overall.iter().enumerate();
            gears
                .map(|(k, r)| straight(format!("gear {}", k + 1), *r))
                .collect()
        }
        Transmission::Cvt(cvt) => {
            let [low, high] =
                [cvt.lowest_ratio(), cvt.ratio.high].map(|r| cvt.final_drive.ratio * r);
            let limits = [("lowest ratio", low), ("highest ratio", high)];
            let limits = limits.map(|(name, ratio)| straight(name.to_owned(), ratio));
            let target = |(share, name): &(f64, &str)| {
                let rpm = target_rad_s(cvt, setup.engine().rated_w, *share) * RAD_S;
                let (from, to) = (rpm / slope(low), (rpm / slope(high)).min(FASTEST_KMH));
                SpeedLine {
                    name: (*name).to_owned(),
                    points: vec![(from, rpm), (to, rpm)],
                }
            };
            let targets = TARGETS.iter().map(target);
            limits.into_iter().chain(targets).collect()
        }
    }
}

/// Speed at which the control settles for a steady share of rated power at the wheels, rad/s.
fn target_rad_s(cvt: &Cvt, rated_w: f64, share: f64) -> f64 {
    cvt.ratio.target_rad_s(&RatioDemand {
        begins: None,
        secondary_rad_s: 0.0,
        primary_rad_s: 0.0,
        speed_m_s: 0.0,
        power_w: share * rated_w,
        share,
        full_load_rad_s: cvt
            .full_load_route
            .at(share * rated_w / cvt.ratio.route_efficiency),
        mapped_rad_s: None,
        cold_rad_s: 0.0,
        ratio_before: 1.0,
        flow_down_per_s: f64::INFINITY,
        flow_up_per_s: f64::INFINITY,
        coupled: true,
        locks_at: 0.0,
        last_direction: 0,
        free_up_to_rad_s: 0.0,
        dt_s: 1.0,
    })
}
