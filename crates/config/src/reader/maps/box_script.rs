//! The map of a box in a script: efficiency over input speed and torque, a matrix for each ratio, as ADVISOR has it.

use super::fuel::{self, Unread};
use super::row::Row;
use super::script::{Matrix, Script};
use crate::csv::{Line, Schema};
use crate::readable;

/// Names that are known, in words.
pub(super) const NAMES: &str =
    "gb_map_spd, gb_map_trq, gb_ratio and gb_map1_eff_raw, gb_map2_eff_raw ... (ADVISOR)";
/// Columns of the schema that such a script fills.
const COLUMNS: [&str; 4] = [
    "ratio",
    "input_speed_rad_s",
    "input_torque_nm",
    "efficiency",
];
/// Largest ratio of a belt or a chain: a larger one has a final drive in it.
const LARGEST: f64 = 4.0;

/// Columns, rows, and how they were read.
type Found<'t> = (Vec<usize>, Vec<Row<'t>>, Option<String>);

/// Places of its columns, where the schema is that of such a map.
pub(super) fn places(schema: &Schema) -> Option<[usize; 4]> {
    let place = |name: &str| schema.columns.iter().position(|own| own.name == name);
    let found = COLUMNS.map(place);
    found
        .iter()
        .all(Option::is_some)
        .then(|| found.map(Option::unwrap_or_default))
}

/// The map of a script; `ratio` is an expression in place of `gb_ratio`. None where the script has no such map.
pub(super) fn from_script<'t>(
    places: [usize; 4],
    script: &Script,
    lines: &[Line<'t>],
    ratio: Option<&str>,
) -> Option<Result<Found<'t>, Unread>> {
    let (_, speeds) = script.find("gb_map_spd")?;
    let (_, torques) = script.find("gb_map_trq")?;
    let first = matrix(script, 1)?.1.lines.first().copied().unwrap_or(1);
    let unread = |line: usize, why: String, allowed: &'static str| Unread { line, why, allowed };
    let name = ratio.unwrap_or("gb_ratio");
    let Some(ratios) = script.value(name) else {
        let why = format!("`{name}` is computed in a way that is not read");
        return Some(Err(unread(first, why, NAMES)));
    };
    let line = ratios.lines.first().copied().unwrap_or(first);
    let [low, high] = ratios
        .values
        .iter()
        .fold([f64::INFINITY, 0.0_f64], |[low, high], own| {
            [low.min(*own), high.max(*own)]
        });
    if !(high <= LARGEST) {
        let [low, high] = [low, high].map(|own| readable(own, 3));
        let why = format!(
            "the ratios of `{name}` are {low} to {high}: a final drive is in them, with which a belt has none so large"
        );
        return Some(Err(unread(line, why, "ratios of the belt alone")));
    }
    let mut rows: Vec<Row<'t>> = Vec::new();
    let (mut measured, mut marked) = (0, 0);
    for (k, ratio) in ratios.values.iter().enumerate() {
        let Some((name, map)) = matrix(script, k + 1) else {
            let why = format!(
                "there is no map gb_map{}_eff_raw for the ratio {}",
                k + 1,
                readable(*ratio, 3)
            );
            return Some(Err(unread(line, why, "a map for each ratio")));
        };
        let columns = [places[1], places[2], places[3]];
        let table = match fuel::table([speeds, torques, map], columns, true, lines) {
            Ok((_, table)) => table,
            Err(why) => {
                let line = map.lines.first().copied().unwrap_or(line);
                return Some(Err(unread(
                    line,
                    format!("{name} {why}"),
                    "two vectors and a matrix over them",
                )));
            }
        };
        let flags = script.find(&format!("gb_map{}_data_raw", k + 1));
        if let Some((_, flags)) = flags.filter(|(_, flags)| flags.values.len() == map.values.len())
        {
            marked += flags.values.len();
            measured += flags.values.iter().filter(|own| **own > 0.0).count();
        }
        let whole = table
            .into_iter()
            .filter(|row| row.values.iter().all(|x| x.is_finite()));
        rows.extend(whole.map(|row| Row {
            values: std::iter::once(*ratio).chain(row.values).collect(),
            ..row
        }));
    }
    let mut read_as = format!(
        "gb_map_spd, gb_map_trq, {name} and {} maps of a script",
        ratios.values.len()
    );
    if marked > 0 {
        read_as += &format!(", {measured} of {marked} cells marked as measured");
    }
    Some(Ok((places.to_vec(), rows, Some(read_as))))
}

/// The efficiency at the ratio of a number.
fn matrix(script: &Script, number: usize) -> Option<(&str, &Matrix)> {
    let raw = script.find(&format!("gb_map{number}_eff_raw"));
    raw.or_else(|| script.find(&format!("gb_map{number}_eff")))
}
