//! Tables that vehicle files name: BSFC and loss maps.

mod grid;
mod wide;

use self::grid::Rules;
use std::borrow::Cow;
use std::io::ErrorKind;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::csv::{Column, Columns, Foreign, Schema};
use crate::files::bounded::ReadError;
use crate::files::embedded;
use crate::files::{Files, Made};
use crate::problem::place::Argument;
use crate::problem::{Problem, Setting};
use crate::reader::section::Section;
use cvtcycle_model::keys::file_table::{FileColumn, FileRows, FileTable};
use cvtcycle_model::keys::{Bound, Quantity};
use cvtcycle_model::maps::{BsfcMap, LossMap};
use cvtcycle_model::math::{GRID_AXES, Grid};

/// A CSV of numbers with a header, read whole, and the map that was made of it.
#[derive(Debug)]
pub(crate) struct MapTable {
    /// Indices of the columns in the schema.
    columns: Vec<usize>,
    rows: Vec<Vec<f64>>,
    loss: OnceLock<LossMap>,
    /// With the bits of heating value and displacement, which are parts of its numbers.
    bsfc: Mutex<Option<([u64; 2], BsfcMap)>>,
}

impl MapTable {
    /// Index of a column of the schema in each row.
    fn index(&self, column: usize) -> Option<usize> {
        self.columns.iter().position(|k| *k == column)
    }
}

/// A file that a key names, with the columns that are meant, as the user says.
pub(crate) struct Named<'s> {
    file: String,
    columns: &'s str,
}

impl<'s> From<(String, &'s str)> for Named<'s> {
    fn from((file, columns): (String, &'s str)) -> Self {
        Named { file, columns }
    }
}

/// Rows that fill a grid.
const GRID_RULES: Rules = Rules {
    rises_with: None,
    is_grid: true,
};

/// Requirements on a table.
struct Wanted {
    kind: &'static str,
    columns: Vec<Column>,
    rules: Rules,
    foreign: Foreign,
}

fn read(s: &Section, key: &str, named: &Named, wanted: Wanted) -> Option<Arc<MapTable>> {
    let file = named.file.as_str();
    if file.trim().is_empty() {
        let problem = Problem::missing("the name of the map is empty").allowed("a CSV file");
        s.report_at(key, problem.hint("name its file, or remove the key"));
        return None;
    }
    let columns = match named.columns.is_empty() {
        true => Ok(Columns::default()),
        false => Columns::parse(named.columns),
    };
    let columns = columns.map_err(|problem| s.report_at(key, problem)).ok()?;
    let schema = Schema {
        columns: wanted.columns,
        max_rows: grid::MAX_ROWS,
        rows: "a row for every point of the grid",
        foreign: wanted.foreign,
        named: Some(columns),
        ..Schema::default()
    };
    let own = embedded::text(embedded::maps(), file);
    let path = match own {
        Some(_) => file.to_owned(),
        None => s.path_of_file(key, file),
    };
    let file = path.as_str();
    let unreadable = |why: ReadError| {
        let problem = Problem::unreadable(format!("cannot read `{file}`: {why}"))
            .allowed(why.allowed("a readable CSV file"))
            .hint(why.hint("the path is relative to the vehicle file"));
        s.report_at(key, problem);
    };
    let mut make = || {
        let bytes = match own {
            Some(text) => Cow::Borrowed(text.as_bytes()),
            None => Cow::Owned(bytes_of(s.reader.files, file).map_err(unreadable).ok()?),
        };
        match grid::read(file, &bytes, &schema, wanted.rules) {
            Ok((columns, rows)) => Some(Arc::new(MapTable {
                columns,
                rows,
                loss: OnceLock::new(),
                bsfc: Mutex::default(),
            }) as Made),
            Err(problems) => {
                let report = |problem| report(s, key, problem);
                problems.into_iter().for_each(report);
                None
            }
        }
    };
    let made = match s.reader.files {
        Some(files) => files.made(
            wanted.kind,
            &format!("{file}\n{}", named.columns),
            &mut make,
        ),
        None => make(),
    };
    made?.downcast().ok()
}

/// Reports a problem of a table; that of a column that the user names is one of the key.
fn report(s: &Section, key: &str, problem: Problem) {
    let hint = match problem.settings.contains(&Setting::Columns) {
        true => format!("{}: {COLUMNS_HINT}", problem.hint),
        false => problem.hint.clone(),
    };
    let problem = Problem {
        settings: &[],
        hint,
        ..problem
    };
    match problem.place.is_argument(Argument::Columns) {
        true => s.report_at(key, problem),
        false => s.report_problem(problem),
    }
}

/// How columns of a map are named.
const COLUMNS_HINT: &str = "KEY = { value = \"FILE\", columns = \"QUANTITY=NAME:UNIT,...\" }";

fn bytes_of(files: Option<&dyn Files>, file: &str) -> Result<Vec<u8>, ReadError> {
    let none = || ReadError::Unreadable(ErrorKind::NotFound.into());
    files.ok_or_else(none)?.read(file)
}

/// The rows of a table that a key names, in SI units; none after a problem.
pub(crate) fn file_table(
    s: &Section,
    key: &str,
    file: Named,
    table: &'static FileTable,
) -> Option<FileRows> {
    let column = |own: &FileColumn| {
        let column = Column::number(own.name, own.range).group(own.group);
        match own.required {
            true => column.required(),
            false => column,
        }
    };
    let wanted = Wanted {
        kind: table.kind,
        columns: table.columns.iter().map(column).collect(),
        rules: Rules {
            rises_with: table.rises_with,
            is_grid: table.is_grid,
        },
        foreign: Foreign {
            words: table.words,
            ..Foreign::default()
        },
    };
    let found = read(s, key, &file, wanted)?;
    let columns: Vec<&'static str> = found
        .columns
        .iter()
        .map(|k| table.columns[*k].name)
        .collect();
    let units: Vec<Quantity> = columns
        .iter()
        .map(|name| Quantity::from_key(name))
        .collect();
    let si = |row: &Vec<f64>| {
        units
            .iter()
            .zip(row)
            .map(|(unit, x)| unit.to_si(*x))
            .collect()
    };
    let rows = found.rows.iter().map(si).collect();
    Some(FileRows { columns, rows })
}

/// Hint for a BSFC map that is inconsistent.
const GRID: &str = "give at least two speeds and two loads; more torque needs more fuel, loads of zero and below need fuel_g_s";

/// The table of a BSFC map from CSV; none after a problem.
pub(crate) fn bsfc_table(s: &Section, key: &str, file: Named) -> Option<Arc<MapTable>> {
    let column = |name, low, high| Column::number(name, Bound::closed(low, high)).required();
    let columns = vec![
        column("speed_rpm", 100.0, 20_000.0),
        column("bmep_bar", -10.0, 40.0).group("load"),
        column("torque_nm", -2000.0, 5000.0).group("load"),
        column("fuel_g_s", 0.0, 100.0).group("fuel"),
        column("bsfc_g_kwh", 100.0, 3000.0).group("fuel"),
    ];
    let wanted = Wanted {
        kind: "bsfc",
        columns,
        rules: GRID_RULES,
        foreign: Foreign::default(),
    };
    read(s, key, &file, wanted)
}

/// The problem of a BSFC map that does not hang together.
pub(crate) fn no_bsfc_map(why: String) -> Problem {
    let problem = Problem::conflict(why).allowed("a map of fuel over speed and load");
    problem.hint(GRID)
}

impl MapTable {
    /// A BSFC map without friction; none of a table without its columns. The last one is kept: few cars differ in what it depends on.
    ///
    /// # Errors
    /// Why the rows make no map.
    pub fn bsfc_map(
        &self,
        heating_value_j_kg: f64,
        displacement_m3: f64,
    ) -> Result<Option<BsfcMap>, String> {
        let scale = [heating_value_j_kg.to_bits(), displacement_m3.to_bits()];
        let mut made = self.bsfc.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, map)) = made.as_ref().filter(|(of, _)| *of == scale) {
            return Ok(Some(map.clone()));
        }
        let flow = self.index(3).map(|i| (i, 1e3));
        let fuel = flow.or_else(|| self.index(4).map(|i| (i, 3.6e9)));
        let load = self.index(1).map(|i| (i, 1e5));
        let per_torque = 4.0 * std::f64::consts::PI / displacement_m3;
        let load = load.or_else(|| self.index(2).map(|i| (i, per_torque)));
        let (Some(speed), Some((fuel, per_si)), Some((load, factor))) = (self.index(0), fuel, load)
        else {
            return Ok(None);
        };
        let rpm = Quantity::from_key("speed_rpm");
        let rows: Vec<(f64, f64, f64)> = self
            .rows
            .iter()
            .map(|r| (rpm.to_si(r[speed]), r[load] * factor, r[fuel] / per_si))
            .collect();
        let map = match flow {
            Some(_) => BsfcMap::from_flow(&rows, heating_value_j_kg, displacement_m3, (0.0, 0.0))?,
            None => BsfcMap::from_rows(&rows, heating_value_j_kg, (0.0, 0.0))?,
        };
        *made = Some((scale, map.clone()));
        Ok(Some(map))
    }
}

/// Columns of a loss map without that of the loss, of a CVT or of a manual box.
#[must_use]
pub const fn loss_map_axes(is_cvt: bool) -> [&'static str; GRID_AXES] {
    let [first, torque] = match is_cvt {
        true => ["ratio", "output_torque_nm"],
        false => ["gear", "input_torque_nm"],
    };
    [
        first,
        "input_speed_rpm",
        torque,
        "secondary_pressure_bar",
        "oil_temp_degc",
    ]
}

/// A measured torque-loss map from CSV; `first` is the name of its first axis, `ratio` or `gear`.
pub(crate) fn loss_map(
    s: &Section,
    key: &str,
    file: Named,
    first: &'static str,
) -> Option<LossMap> {
    let column = |name, (low, high)| Column::number(name, Bound::closed(low, high));
    let ranges = [
        (0.2, 12.0),
        (0.0, 20_000.0),
        (-3000.0, 3000.0),
        (0.0, 200.0),
        (-60.0, 200.0),
    ];
    let axes = loss_map_axes(first != "gear").into_iter().zip(ranges);
    let mut columns: Vec<Column> = axes.map(|(name, range)| column(name, range)).collect();
    columns.push(column("torque_loss_nm", (0.0, 1000.0)).required());
    let quantities: Vec<Quantity> = columns
        .iter()
        .map(|c| Quantity::from_key(&c.name))
        .collect();
    let wanted = Wanted {
        kind: first,
        columns,
        rules: GRID_RULES,
        foreign: Foreign::default(),
    };
    let table = read(s, key, &file, wanted)?;
    if let Some(map) = table.loss.get() {
        return Some(map.clone());
    }
    let loss = table.index(GRID_AXES)?;
    let axes: Vec<(Option<usize>, Quantity)> = quantities
        .into_iter()
        .take(GRID_AXES)
        .enumerate()
        .map(|(k, quantity)| (table.index(k), quantity))
        .collect();
    let rows: Vec<([f64; GRID_AXES], f64)> = table
        .rows
        .iter()
        .map(|r| {
            let mut x = [0.0; GRID_AXES];
            for (x, (axis, quantity)) in x.iter_mut().zip(&axes) {
                *x = axis.map_or(0.0, |i| quantity.to_si(r[i]));
            }
            (x, r[loss])
        })
        .collect();
    let hint = "every combination of the columns' values has one row";
    let grid = Grid::from_rows(&rows)
        .map_err(|wrong| {
            s.report_at(
                key,
                Problem::conflict(wrong).allowed("a full grid").hint(hint),
            );
        })
        .ok()?;
    Some(table.loss.get_or_init(|| LossMap::new(grid)).clone())
}
