//! A load that a map of fuel says twice: a torque or a power, and a mean effective pressure next to it. Their quotient is the swept volume of the engine
//! that was measured, and one in all rows.

use std::f64::consts::PI;

use super::fuel::{self, Gives};
use crate::Problem;
use crate::csv::{Collector, Field, Line, Row, Schema, Table};
use cvtcycle_model::maps::{Load, Swept};

/// Share by which a torque may differ from its pressure times the volume, besides half of the last digit of both numbers. ASSUMED: means of two signals,
/// factors of units with three figures. The seven maps of engines that EPA measured need none of it.
const SHARE: f64 = 0.02;

/// A load and a mean effective pressure next to it, as the file names them.
struct Names {
    both: [String; 2],
    /// Text to type that names only the first, and only the second.
    choices: [String; 2],
}

/// Both loads of a row, each with half of its last digit.
struct Pair<'t> {
    line: Line<'t>,
    texts: [&'t str; 2],
    field: Field,
    torque_nm: [f64; 2],
    pressure_pa: [f64; 2],
}

/// The names of the columns that a table has twice, for each spare column.
#[derive(Default)]
pub(super) struct Doubled(Vec<Names>);

/// The loads that rows say twice, for each spare column.
#[derive(Default)]
pub(super) struct Loads<'t>(Vec<Vec<Pair<'t>>>);

impl Doubled {
    /// Collects the names while the line of names is the last one read, since a table keeps the fields of that line alone.
    pub fn new(table: &Table<'_>, schema: &Schema, line: Line<'_>) -> Self {
        let names = |spare: usize| {
            let own = table.group_column(schema.columns[spare].group)?;
            let others = table
                .columns()
                .flatten()
                .filter(|column| !column.is_same(&schema.columns[own]));
            let others: Vec<usize> = others
                .filter_map(|column| schema.columns.iter().position(|k| k.name == column.name))
                .collect();
            let choice = |load: usize| {
                let mut all = others.clone();
                all.insert(all.len().min(1), load);
                let entries = all.iter().map(|column| {
                    let written = table.written(line, *column).unwrap_or_default();
                    let entry = format!("{}={written}", schema.columns[*column].name);
                    match entry.contains(',') {
                        true => format!("\"{entry}\""),
                        false => entry,
                    }
                });
                let entries = entries.collect::<Vec<_>>().join(",");
                match entries.contains('"') {
                    true => format!("columns = '{entries}'"),
                    false => format!("columns = \"{entries}\""),
                }
            };
            let both = [own, spare];
            Some(Names {
                both: both.map(|k| table.written(line, k).unwrap_or_default().to_owned()),
                choices: both.map(choice),
            })
        };
        Doubled(table.spares().filter_map(names).collect())
    }
}

impl<'t> Loads<'t> {
    /// Takes the loads of a row; one without a number in both says nothing.
    pub fn take(&mut self, row: &Row<'_, 't>, schema: &Schema) {
        for (place, spare) in row.table().spares().enumerate() {
            if self.0.len() <= place {
                self.0.push(Vec::new());
            }
            self.0[place].extend(pair(row, schema, (place, spare)));
        }
    }

    /// The swept volumes that the loads give, one for each spare column; rows that contradict the others are one problem.
    pub fn swept(self, names: Doubled, problems: &mut Collector<'_>) -> Vec<Swept> {
        let both = self.0.into_iter().zip(names.0);
        let volumes = both.filter_map(|(pairs, names)| volume(&pairs, names, problems));
        volumes.collect()
    }
}

/// Both loads of a row.
fn pair<'t>(
    row: &Row<'_, 't>,
    schema: &Schema,
    (place, spare): (usize, usize),
) -> Option<Pair<'t>> {
    let own = row.table().group_column(schema.columns[spare].group)?;
    let ([pressure, half_pressure], field) = row.spare(place)?;
    let [load, half_load] = row.rounded(own)?.map(|x| fuel::to_si(own, x));
    let torque_nm = match fuel::gives(own) {
        Gives::Load(Load::Torque) => [load, half_load],
        Gives::Load(Load::Power) => {
            let of = row.table().group_column("speed")?;
            let [speed, half_speed] = row.rounded(of)?.map(|x| fuel::to_si(of, x));
            let torque = load / speed;
            let half = half_load / speed + torque.abs() * half_speed / speed;
            [torque, half]
        }
        _ => return None,
    };
    let is_number = torque_nm.iter().all(|x| x.is_finite());
    is_number.then(|| Pair {
        line: row.line,
        texts: [
            row.cell(own)
                .map_or("", |cell| row.line.text_of(cell.field)),
            row.line.text_of(field),
        ],
        field,
        torque_nm,
        pressure_pa: [pressure, half_pressure].map(|x| fuel::to_si(spare, x)),
    })
}

impl Pair<'_> {
    /// Torque and pressure with the sign of the torque.
    fn along(&self) -> [f64; 2] {
        let [torque, pressure] = [self.torque_nm[0], self.pressure_pa[0]];
        let is_turned = torque < 0.0 || torque == 0.0 && pressure < 0.0;
        match is_turned {
            true => [-torque, -pressure],
            false => [torque, pressure],
        }
    }

    /// Swept volumes that both numbers leave, m3, from 0 to infinity where both are zero; none of numbers with opposite signs.
    fn volumes(&self) -> Option<[f64; 2]> {
        let [torque, pressure] = self.along();
        let (half_torque, half_pressure) = (self.torque_nm[1], self.pressure_pa[1]);
        let least = torque - half_torque - SHARE * torque;
        let most = torque + half_torque + SHARE * torque;
        let [low, high] = [pressure - half_pressure, pressure + half_pressure];
        let ends = match (low > 0.0, high > 0.0) {
            (true, _) => [least.max(0.0) / high, most / low],
            (false, true) => [least.max(0.0) / high, f64::INFINITY],
            (false, false) if least > 0.0 => return None,
            (false, false) if high == 0.0 => [0.0, f64::INFINITY],
            (false, false) => [0.0, least / high],
        };
        Some(ends.map(|end| 4.0 * PI * end))
    }

    /// Swept volume of the numbers as they are, m3; none of one that is zero or of opposite signs.
    fn volume(&self) -> Option<f64> {
        let [torque, pressure] = self.along();
        (torque > 0.0 && pressure > 0.0).then(|| 4.0 * PI * torque / pressure)
    }
}

/// A volume, m3, that most rows leave.
fn of_most(ranges: &[Option<[f64; 2]>]) -> f64 {
    let ranges = ranges.iter().flatten();
    let mut ends: Vec<(f64, bool)> = ranges
        .flat_map(|[low, high]| [(*low, false), (*high, true)])
        .collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut count, mut most, mut best) = (0_usize, 0, 0.0);
    for (volume, is_end) in ends {
        count = match is_end {
            true => count - 1,
            false => count + 1,
        };
        if count > most {
            (most, best) = (count, volume);
        }
    }
    best
}

/// The one swept volume of all rows; one problem where some of them differ from the others.
fn volume(pairs: &[Pair<'_>], names: Names, problems: &mut Collector<'_>) -> Option<Swept> {
    let ranges: Vec<Option<[f64; 2]>> = pairs.iter().map(Pair::volumes).collect();
    let best = of_most(&ranges);
    let agrees =
        |range: &Option<[f64; 2]>| range.is_some_and(|[low, high]| low <= best && best <= high);
    let (mut torque, mut pressure, mut halves) = (0.0, 0.0, [0.0; 2]);
    for (pair, _) in pairs.iter().zip(&ranges).filter(|(_, range)| agrees(range)) {
        let along = pair.along();
        torque += along[0];
        pressure += along[1];
        halves[0] += pair.torque_nm[1];
        halves[1] += pair.pressure_pa[1];
    }
    let of_rows = 4.0 * PI * torque / pressure;
    let mut others = pairs
        .iter()
        .zip(&ranges)
        .filter(|(_, range)| !agrees(range));
    let count = others.clone().count();
    let Some((first, _)) = others.next() else {
        let rounding = halves[0] / torque + halves[1] / pressure;
        let is_known = torque > 0.0 && pressure > 0.0 && rounding.is_finite();
        return is_known.then(|| Swept {
            volume_m3: of_rows,
            rounding,
            columns: names.both,
            choice: names.choices.into_iter().next().unwrap_or_default(),
        });
    };
    let [own, spare] = &names.both;
    let cc = |m3: f64| format!("a swept volume of {:.0} cc", m3 * 1e6);
    let here = first
        .volume()
        .map_or_else(|| "no swept volume".to_owned(), cc);
    let is_known = torque > 0.0 && pressure > 0.0 && of_rows.is_finite();
    let there = match is_known && count < pairs.len() {
        true => format!(", and the other rows have {:.0} cc", of_rows * 1e6),
        false => String::new(),
    };
    let message = format!(
        "{own} and {spare} contradict each other in {count} of {} rows: {} and {} are {here}{there}",
        pairs.len(),
        first.texts[0],
        first.texts[1]
    );
    let [with_own, with_spare] = &names.choices;
    let hint = format!(
        "correct the rows, or name the column that is right: KEY = {{ value = \"FILE\", {with_own} }} or {{ value = \"FILE\", {with_spare} }}"
    );
    problems.value(first.line, first.field, "", || {
        Problem::conflict(message)
            .allowed(format!("{own} over {spare} as in the other rows"))
            .hint(hint)
    });
    None
}
