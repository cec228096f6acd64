//! The map of a box in a script: efficiency over input speed and torque, a matrix for each ratio, as ADVISOR has it.

use super::fuel::{self, Unread};
use super::row::Row;
use super::script::{Matrix, Script};
use crate::csv::{Line, Schema};
use crate::{Bound, readable};

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
/// Ratios of a belt or a chain: larger ones have a final drive in them.
const BELT: Bound = Bound::closed(0.2, 4.0);

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

/// A reason for which a script is not read, with a hint.
pub(super) type Refused = (Unread, &'static str);

/// Hints: what is to be written in the script, and which ratios are meant.
const WRITE: &str = "correct the script: numbers, ranges, sums and products are read";
const RATIO: &str = "say which ratios are meant: KEY = { value = \"FILE\", columns = \"ratio=gb_ratio/FINAL_DRIVE\" }";

fn refused(line: usize, why: String, allowed: &'static str, hint: &'static str) -> Refused {
    (Unread { line, why, allowed }, hint)
}

/// The map of a script; `ratio` is an expression in place of `gb_ratio`. None where the script has no such map.
pub(super) fn from_script<'t>(
    places: [usize; 4],
    script: &Script,
    lines: &[Line<'t>],
    ratio: Option<&str>,
) -> Option<Result<Found<'t>, Refused>> {
    let (_, speeds) = script.find("gb_map_spd")?;
    let (_, torques) = script.find("gb_map_trq")?;
    let first = matrix(script, 1)?.1.lines.first().copied().unwrap_or(1);
    let name = ratio.unwrap_or("gb_ratio");
    let Some(ratios) = script.value(name) else {
        let line = script.unread("gb_ratio").unwrap_or(first);
        let why = format!("`{name}` is computed in a way that is not read");
        return Some(Err(refused(line, why, NAMES, RATIO)));
    };
    let line = ratios.lines.first().copied().unwrap_or(first);
    Some(
        whole(
            (name, &ratios, line),
            [speeds, torques],
            places,
            script,
            lines,
        )
        .map(|(rows, marks)| {
            let count = ratios.values.len();
            let read_as =
                format!("gb_map_spd, gb_map_trq, {name} and {count} maps of a script{marks}");
            (places.to_vec(), rows, Some(read_as))
        }),
    )
}

/// The rows of all ratios, and how many cells are marked as measured, in words.
fn whole<'t>(
    (name, ratios, line): (&str, &Matrix, usize),
    axes: [&Matrix; 2],
    places: [usize; 4],
    script: &Script,
    lines: &[Line<'t>],
) -> Result<(Vec<Row<'t>>, String), Refused> {
    let low = ratios.values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ratios.values.iter().copied().fold(0.0, f64::max);
    if !ratios.values.iter().all(|own| BELT.contains(*own)) {
        let [low, high] = [low, high].map(|own| readable(own, 3));
        let why = format!(
            "the ratios of `{name}` are {low} to {high}, which no belt has: is a final drive in them?"
        );
        return Err(refused(line, why, "0.2 to 4", RATIO));
    }
    let mut rows: Vec<Row<'t>> = Vec::new();
    let (mut measured, mut marked) = (0, 0);
    for (k, ratio) in ratios.values.iter().enumerate() {
        let Some((name, map)) = matrix(script, k + 1) else {
            let ratio = readable(*ratio, 3);
            let why = format!(
                "there is no map gb_map{}_eff_raw for the ratio {ratio}",
                k + 1
            );
            return Err(refused(line, why, "a map for each ratio", WRITE));
        };
        let at = map.lines.first().copied().unwrap_or(line);
        let columns = [places[1], places[2], places[3]];
        let table = fuel::table([axes[0], axes[1], map], columns, true, lines);
        let (_, table) = table.map_err(|why| {
            let allowed = "two vectors and a matrix over them";
            refused(at, format!("{name} {why}"), allowed, WRITE)
        })?;
        let is_share = |own: &&f64| !(0.0..=1.0).contains(*own) && own.is_finite();
        if let Some(wrong) = map.values.iter().find(is_share) {
            let why = format!("{name} has an efficiency of {}", readable(*wrong, 3));
            return Err(refused(at, why, "0 to 1", WRITE));
        }
        let flags = script.find(&format!("gb_map{}_data_raw", k + 1));
        if let Some((_, flags)) = flags.filter(|(_, own)| own.values.len() == map.values.len()) {
            marked += flags.values.len();
            measured += flags.values.iter().filter(|own| **own > 0.0).count();
        }
        let finite = table
            .into_iter()
            .filter(|row| row.values.iter().all(|x| x.is_finite()));
        rows.extend(finite.map(|row| Row {
            values: std::iter::once(*ratio).chain(row.values).collect(),
            ..row
        }));
    }
    let marks = match marked {
        0 => String::new(),
        all => format!(", {measured} of {all} cells marked as measured"),
    };
    Ok((rows, marks))
}

/// The efficiency at the ratio of a number.
fn matrix(script: &Script, number: usize) -> Option<(&str, &Matrix)> {
    let raw = script.find(&format!("gb_map{number}_eff_raw"));
    raw.or_else(|| script.find(&format!("gb_map{number}_eff")))
}
