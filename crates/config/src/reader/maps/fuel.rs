//! Columns of a map of fuel: speed, load and fuel in the units in which people have them.

use super::row::Row;
use super::script::Script;
use crate::csv::{Column, Foreign, Line};
use cvtcycle_model::keys::{Bound, Quantity};
use cvtcycle_model::maps::{Fuel, Load};

/// Quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Gives {
    Speed,
    Load(Load),
    Fuel(Fuel),
}

/// A column with its range in its own unit; true if it is one of the program's own names, which messages list.
type Own = (&'static str, f64, f64, Gives, bool);

const SPEED: Gives = Gives::Speed;
const BMEP: Gives = Gives::Load(Load::Bmep);
const TORQUE: Gives = Gives::Load(Load::Torque);
const POWER: Gives = Gives::Load(Load::Power);
const FLOW: Gives = Gives::Fuel(Fuel::Flow);
const PER_WORK: Gives = Gives::Fuel(Fuel::PerWork);
const PER_STROKE: Gives = Gives::Fuel(Fuel::PerStroke);
const SHARE: Gives = Gives::Fuel(Fuel::Efficiency);

/// All columns; `consumption` is a word for a flow as for that of work, which the unit decides.
const COLUMNS: [Own; 28] = [
    ("speed_rpm", 0.0, 20_000.0, SPEED, true),
    ("speed_rad_s", 0.0, 2100.0, SPEED, false),
    ("bmep_bar", -10.0, 40.0, BMEP, true),
    ("bmep_psi", -150.0, 600.0, BMEP, false),
    ("bmep_kpa", -1000.0, 4000.0, BMEP, false),
    ("bmep_mpa", -1.0, 4.0, BMEP, false),
    ("bmep_pa", -1e6, 4e6, BMEP, false),
    ("torque_nm", -2000.0, 5000.0, TORQUE, true),
    ("torque_lbft", -1500.0, 3700.0, TORQUE, false),
    ("power_kw", -500.0, 2000.0, POWER, false),
    ("power_hp", -700.0, 2700.0, POWER, false),
    ("power_w", -5e5, 2e6, POWER, false),
    ("fuel_g_s", 0.0, 100.0, FLOW, true),
    ("fuel_g_h", 0.0, 360_000.0, FLOW, false),
    ("fuel_kg_h", 0.0, 360.0, FLOW, false),
    ("fuel_kg_s", 0.0, 0.1, FLOW, false),
    ("fuel_mg_s", 0.0, 1e5, FLOW, false),
    ("fuel_lb_h", 0.0, 800.0, FLOW, false),
    ("fuel_mg_stroke", 0.0, 1000.0, PER_STROKE, false),
    ("fuel_g_kwh", 100.0, 3000.0, PER_WORK, false),
    ("fuel_lb_hph", 0.16, 4.9, PER_WORK, false),
    ("bsfc_kg_kwh", 0.1, 3.0, PER_WORK, false),
    ("bsfc_g_hph", 75.0, 2240.0, PER_WORK, false),
    ("bsfc_lb_hph", 0.16, 4.9, PER_WORK, false),
    ("bsfc_ug_j", 28.0, 830.0, PER_WORK, false),
    ("efficiency", 0.0, 1.0, SHARE, false),
    ("efficiency_percent", 0.0, 100.0, SHARE, false),
    ("bsfc_g_kwh", 100.0, 3000.0, PER_WORK, true),
];

/// Names that are only a unit, as in `rpm,Nm,g/kWh`.
const HEADINGS: &[(&str, &str)] = &[
    ("rpm", "speed_rpm"),
    ("RPM", "speed_rpm"),
    ("1/min", "speed_rpm"),
    ("min-1", "speed_rpm"),
    ("min^-1", "speed_rpm"),
    ("rad/s", "speed_rad_s"),
    ("Nm", "torque_nm"),
    ("N m", "torque_nm"),
    ("N·m", "torque_nm"),
    ("N*m", "torque_nm"),
    ("lb-ft", "torque_lbft"),
    ("lbft", "torque_lbft"),
    ("ft-lb", "torque_lbft"),
    ("ft-lbf", "torque_lbft"),
    ("lbf-ft", "torque_lbft"),
    ("bar", "bmep_bar"),
    ("psi", "bmep_psi"),
    ("kPa", "bmep_kpa"),
    ("kW", "power_kw"),
    ("hp", "power_hp"),
    ("g/kWh", "bsfc_g_kwh"),
    ("g/kW-h", "bsfc_g_kwh"),
    ("g/kW-hr", "bsfc_g_kwh"),
    ("lb/hp-h", "bsfc_lb_hph"),
    ("lb/hp-hr", "bsfc_lb_hph"),
    ("g/s", "fuel_g_s"),
    ("g/h", "fuel_g_h"),
    ("kg/h", "fuel_kg_h"),
    ("mg/stroke", "fuel_mg_stroke"),
];

/// Words of others, and the name of a column without its unit.
const WORDS: &[(&str, &str)] = &[
    ("n", "speed"),
    ("w", "speed"),
    ("omega", "speed"),
    ("spd", "speed"),
    ("rpm", "speed"),
    ("engine_speed", "speed"),
    ("engine_rpm", "speed"),
    ("eng_speed", "speed"),
    ("rotational_speed", "speed"),
    ("angular_speed", "speed"),
    ("angular_velocity", "speed"),
    ("crankshaft_speed", "speed"),
    ("t", "torque"),
    ("m", "torque"),
    ("md", "torque"),
    ("drehmoment", "torque"),
    ("motordrehmoment", "torque"),
    ("drehzahl", "speed"),
    ("motordrehzahl", "speed"),
    ("kraftstoffverbrauch", "fuel"),
    ("couple", "torque"),
    ("regime", "speed"),
    ("trq", "torque"),
    ("tq", "torque"),
    ("engine_torque", "torque"),
    ("eng_torque", "torque"),
    ("brake_torque", "torque"),
    ("shaft_torque", "torque"),
    ("load", "torque"),
    ("mep", "bmep"),
    ("pme", "bmep"),
    ("brake_mean_effective_pressure", "bmep"),
    ("mean_effective_pressure", "bmep"),
    ("p", "power"),
    ("engine_power", "power"),
    ("brake_power", "power"),
    ("be", "bsfc"),
    ("sfc", "bsfc"),
    ("brake_specific_fuel_consumption", "bsfc"),
    ("specific_fuel_consumption", "bsfc"),
    ("bte", "efficiency"),
    ("eta", "efficiency"),
    ("eff", "efficiency"),
    ("brake_thermal_efficiency", "efficiency"),
    ("thermal_efficiency", "efficiency"),
    ("engine_efficiency", "efficiency"),
    ("brake_efficiency", "efficiency"),
    ("fc", "fuel"),
    ("fuel_flow", "fuel"),
    ("fuel_rate", "fuel"),
    ("fuel_flow_rate", "fuel"),
    ("fuel_mass_flow", "fuel"),
    ("fuel_mass_flow_rate", "fuel"),
    ("fuel_consumption", "fuel"),
    ("fuel_consumption_rate", "fuel"),
    ("fuel_use", "fuel"),
    ("fuel_mass", "fuel"),
    ("fuel_quantity", "fuel"),
    ("injected_fuel", "fuel"),
    ("injection_quantity", "fuel"),
    ("mass_flow", "fuel"),
    ("consumption", "fuel"),
    ("mdot_fuel", "fuel"),
];

/// The names of other programs.
pub(super) const FOREIGN: Foreign = Foreign {
    headings: HEADINGS,
    lines: &[],
    words: WORDS,
};

/// The columns of the schema, the last one a fuel.
pub(super) fn columns() -> Vec<Column> {
    let column = |(name, low, high, gives, is_listed): &Own| {
        let group = match gives {
            Gives::Speed => "speed",
            Gives::Load(_) => "load",
            Gives::Fuel(_) => "fuel",
        };
        let column = Column::number(*name, Bound::closed(*low, *high))
            .group(group)
            .required();
        let column = match is_listed {
            true => column,
            false => column.alias(),
        };
        match gives {
            Gives::Fuel(_) => column.or_empty(),
            Gives::Load(Load::Bmep) => column.spare(),
            _ => column,
        }
    };
    COLUMNS.iter().map(column).collect()
}

/// Quantity of a column of the schema.
pub(super) fn gives(column: usize) -> Gives {
    COLUMNS[column].3
}

/// A value of a column in SI units.
pub(super) fn to_si(column: usize, x: f64) -> f64 {
    match COLUMNS[column].0 {
        // These two as before, to the last bit.
        "fuel_g_s" => x / 1e3,
        "bsfc_g_kwh" => x / 3.6e9,
        name => Quantity::from_key(name).to_si(x),
    }
}

fn place(name: &str) -> usize {
    let at = COLUMNS.iter().position(|own| own.0 == name);
    at.unwrap_or_default()
}

/// Heating value for the choice between units, J/kg: that of petrol and diesel within 2 %.
const USUAL_J_KG: f64 = 43e6;
/// Best efficiencies of engines, for that choice. ASSUMED: wider than any engine of a car would let two units be possible.
const BEST: std::ops::RangeInclusive<f64> = 0.22..=0.48;
/// Swept volumes of engines of cars, m3, where the load is a pressure.
const SWEPT_M3: [f64; 2] = [0.6e-3, 7e-3];
/// Columns in whose unit cells without one may be.
const CHOICE: [&str; 7] = [
    "bsfc_g_kwh",
    "bsfc_kg_kwh",
    "bsfc_lb_hph",
    "fuel_g_s",
    "fuel_g_h",
    "efficiency",
    "efficiency_percent",
];

/// The columns that cells without a unit may be, by the efficiency that they would give the engine: rows are speed, load and cell in the units of the
/// first two columns.
pub(super) fn likely(axes: [usize; 2], rows: &[[f64; 3]]) -> Vec<&'static str> {
    let fits = |name: &&&str| {
        let column = place(name);
        let (_, low, high, gives, _) = COLUMNS[column];
        let Gives::Fuel(fuel) = gives else {
            return false;
        };
        let best_with = |swept_m3: f64| {
            let efficiency = |row: &[f64; 3]| {
                let [speed, load, cell] = *row;
                let (speed, load) = (to_si(axes[0], speed), to_si(axes[1], load));
                let cell = to_si(column, cell);
                let power_w = match COLUMNS[axes[1]].3 {
                    BMEP => load * swept_m3 * speed / (4.0 * std::f64::consts::PI),
                    POWER => load,
                    _ => load * speed,
                };
                match fuel {
                    Fuel::Efficiency => cell,
                    Fuel::PerWork => 1.0 / (cell * USUAL_J_KG),
                    _ => power_w / (cell * USUAL_J_KG),
                }
            };
            let of = rows.iter().filter(|row| row[1] > 0.0 && row[2] > 0.0);
            of.map(efficiency).fold(0.0, f64::max)
        };
        let all = rows.iter().filter(|row| row[1] > 0.0 && row[2].is_finite());
        let is_in = all.clone().all(|row| (low..=high).contains(&row[2]));
        let [small, large] = SWEPT_M3.map(best_with);
        is_in && small.max(large) >= *BEST.start() && small.min(large) <= *BEST.end()
    };
    CHOICE.iter().filter(fits).copied().collect()
}

/// Axes of a matrix in the order in which they are written, or the other one: an engine turns at 600 to 20 000 rpm at its fastest.
pub(super) fn speed_is_first(axes: [usize; 2], [down, across]: [&[f64]; 2]) -> Option<bool> {
    let is_speed = |column: usize, values: &[f64]| {
        let fastest = values.iter().copied().fold(0.0, f64::max);
        (60.0..=2100.0).contains(&to_si(column, fastest))
    };
    let speed = axes
        .iter()
        .position(|column| gives(*column) == Gives::Speed)?;
    match [is_speed(axes[speed], down), is_speed(axes[speed], across)] {
        [true, false] => Some(true),
        [false, true] => Some(false),
        _ => None,
    }
}

/// Names of a script's tables, with the columns that they are: speed, load, fuel, and true where a row is a speed.
const SCRIPTS: [([&str; 3], [&str; 3], bool); 6] = [
    (
        ["fc_map_spd", "fc_map_trq", "fc_fuel_map"],
        ["speed_rad_s", "torque_nm", "fuel_g_s"],
        true,
    ),
    (
        ["fc_map_spd", "fc_map_trq", "fc_fuel_map_gpkWh"],
        ["speed_rad_s", "torque_nm", "bsfc_g_kwh"],
        true,
    ),
    (
        [
            "*fuel_map_speed_radps",
            "*fuel_map_torque_Nm",
            "*fuel_map_gps",
        ],
        ["speed_rad_s", "torque_nm", "fuel_g_s"],
        false,
    ),
    (
        ["eng_consum_spd", "eng_consum_trq", "eng_consum_fuel"],
        ["speed_rad_s", "torque_nm", "fuel_g_s"],
        true,
    ),
    (
        ["eng_consum_spd", "eng_consum_trq", "eng_bsfc_gpkWh"],
        ["speed_rad_s", "torque_nm", "bsfc_g_kwh"],
        true,
    ),
    (
        ["eng_map_spd", "eng_map_trq", "eng_fuel_map"],
        ["speed_rad_s", "torque_nm", "fuel_g_s"],
        true,
    ),
];

/// Names that tables of fuel have in scripts, for people.
pub(super) const SCRIPT_NAMES: &str = "fc_map_spd, fc_map_trq and fc_fuel_map or fc_fuel_map_gpkWh, or fuel_map_speed_radps, fuel_map_torque_Nm and fuel_map_gps";

/// The rows of a script, with their columns and how they were found.
pub(super) struct FromScript<'t> {
    pub columns: Vec<usize>,
    pub rows: Vec<Row<'t>>,
    pub read_as: String,
}

/// A table of fuel in a script that is there and cannot be read.
pub(super) struct Unread {
    pub line: usize,
    pub why: String,
    pub allowed: &'static str,
}

/// The table of fuel in a script.
pub(super) fn from_script<'t>(
    script: &Script,
    lines: &[Line<'t>],
) -> Option<Result<FromScript<'t>, Unread>> {
    let mut missing = None;
    for (names, columns, speed_down) in SCRIPTS {
        match names.map(|name| script.find(name)) {
            [
                Some((spd_name, spd)),
                Some((trq_name, trq)),
                Some((name, map)),
            ] => {
                let mut read_as = format!("{spd_name}, {trq_name} and {name} of a script");
                let all = [spd_name, trq_name, name];
                if let Some((name, line)) = all
                    .iter()
                    .find_map(|name| Some((name, script.in_block(name)?)))
                {
                    read_as +=
                        &format!(" (what line {line} does to {name} in a block is passed over)");
                }
                let of = table([spd, trq, map], columns.map(place), speed_down, lines);
                return Some(
                    of.map_err(|why| Unread {
                        line: map.lines.first().copied().unwrap_or(1),
                        why: format!("{name} {why}"),
                        allowed: "two vectors and a matrix over them",
                    })
                    .map(|(columns, rows)| FromScript {
                        columns,
                        rows,
                        read_as,
                    }),
                );
            }
            found => {
                for (name, found) in names.iter().zip(found) {
                    if let (None, Some(line)) = (found, script.unread(name)) {
                        missing = missing.or(Some(Unread {
                            line,
                            why: format!("{name} is computed in a way that is not read"),
                            allowed: "numbers, matrices, ranges, and sums and products of them",
                        }));
                    }
                }
            }
        }
    }
    missing.map(Err)
}

/// Columns and rows of a matrix over speed and load.
type Rows<'t> = (Vec<usize>, Vec<Row<'t>>);

/// The rows of a matrix over two vectors. Where the sizes leave both ways open, `speed_down` decides.
pub(super) fn table<'t>(
    [spd, trq, map]: [&super::script::Matrix; 3],
    columns: [usize; 3],
    speed_down: bool,
    lines: &[Line<'t>],
) -> Result<Rows<'t>, String> {
    let (Some(speeds), Some(loads)) = (spd.vector(), trq.vector()) else {
        return Err("has an axis that is no vector".to_owned());
    };
    let (n, m) = (speeds.len(), loads.len());
    let size = (map.rows, map.columns);
    let speed_down = match (size == (n, m), size == (m, n)) {
        (true, true) => speed_down,
        (true, false) => true,
        (false, true) => false,
        _ => {
            return Err(format!(
                "has {} rows and {} columns for {n} speeds and {m} loads",
                map.rows, map.columns
            ));
        }
    };
    let mut order = [0, 1, 2];
    order.sort_by_key(|k| columns[*k]);
    let mut rows = Vec::with_capacity(n * m);
    for (i, speed) in speeds.iter().enumerate() {
        for (k, load) in loads.iter().enumerate() {
            let (row, column) = if speed_down { (i, k) } else { (k, i) };
            let number = map.lines.get(row).copied().unwrap_or(1);
            let line = lines.get(number.saturating_sub(1)).copied();
            let own = [*speed, *load, map.at(row, column)];
            rows.push(Row {
                line: line.unwrap_or(Line { number, text: "" }),
                values: order.map(|k| own[k]).to_vec(),
            });
        }
    }
    Ok((order.map(|k| columns[k]).to_vec(), rows))
}
