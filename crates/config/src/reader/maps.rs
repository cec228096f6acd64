//! Tables that vehicle files name: BSFC and loss maps.

mod box_script;
mod fuel;
mod grid;
mod loads;
mod row;
mod script;
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
use cvtcycle_model::maps::{Basis, BsfcMap, FuelRow, FuelTable, LossMap, NoMap, Swept};
use cvtcycle_model::math::{GRID_AXES, Grid};

/// A CSV of numbers with a header, read whole, and the map that was made of it.
#[derive(Debug)]
pub(crate) struct MapTable {
    /// Indices of the columns in the schema.
    columns: Vec<usize>,
    rows: Vec<Vec<f64>>,
    /// Line of each row.
    lines: Vec<usize>,
    /// Name of the file.
    file: String,
    read_as: Option<String>,
    /// Swept volumes that a load gives which the file says twice.
    swept: Vec<Swept>,
    loss: OnceLock<LossMap>,
    /// With the engine that was measured, whose values are parts of its numbers.
    bsfc: Mutex<Option<(Basis, BsfcMap)>>,
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
    /// True of a map of fuel.
    is_fuel: bool,
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
            .hint(why.hint("the path is relative to the file that names it"));
        s.report_at(key, problem);
    };
    let mut make = || {
        let bytes = match own {
            Some(text) => Cow::Borrowed(text.as_bytes()),
            None => Cow::Owned(bytes_of(s.reader.files, file).map_err(unreadable).ok()?),
        };
        let wanted = grid::Wanted {
            schema: &schema,
            rules: wanted.rules,
            is_fuel: wanted.is_fuel,
        };
        match grid::read(file, &bytes, wanted) {
            Ok(read) => Some(Arc::new(MapTable {
                columns: read.columns,
                lines: read.rows.iter().map(|(line, _)| *line).collect(),
                rows: read.rows.into_iter().map(|(_, values)| values).collect(),
                file: named.file.clone(),
                read_as: read.read_as,
                swept: read.swept,
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
        let column = match own.is_like.is_empty() {
            true => column,
            false => column.alias(),
        };
        let column = match own.is_extra {
            true => column.extra(),
            false => column,
        };
        // A cell of a matrix without a value is a hole where there may be some.
        let column = match table.has_holes && own.group == table.value_group() {
            true => column.or_empty(),
            false => column,
        };
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
            is_grid: table.is_grid && !table.has_holes,
        },
        foreign: Foreign {
            words: table.words,
            ..Foreign::default()
        },
        is_fuel: false,
    };
    let found = read(s, key, &file, wanted)?;
    let own = || found.columns.iter().map(|k| &table.columns[*k]);
    let units: Vec<Quantity> = own().map(|own| Quantity::from_key(own.name)).collect();
    let name = |own: &FileColumn| match own.is_like {
        "" => own.name,
        like => like,
    };
    let columns: Vec<&'static str> = own().map(name).collect();
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

/// True of a list of rows that is a full-load line, which a file may give.
pub(crate) fn is_full_load(columns: &[(&str, Bound)]) -> bool {
    matches!(columns, [("speed_rpm", _), ("torque_nm", _)])
}

/// Columns of a full-load line in the tables of others that are passed over: the drag and the time constant of VECTO's `.vfld`.
const NEXT_TO_FULL_LOAD: &[(&str, &str)] = &[
    ("motoring torque*", ""),
    ("Motoring Torque*", ""),
    ("drag torque*", ""),
    ("PT1*", ""),
    ("full load torque [Nm]", "torque_nm"),
    ("rpm", "speed_rpm"),
    ("Nm", "torque_nm"),
];

/// Words of others for a full-load line.
const OF_FULL_LOAD: &[(&str, &str)] = &[
    ("engine_speed", "speed"),
    ("n", "speed"),
    ("full_load_torque", "torque"),
    ("max_torque", "torque"),
    ("maximum_torque", "torque"),
    ("engine_torque", "torque"),
    ("wot_torque", "torque"),
];

/// The rows of a full-load line from a file, speed in rad/s and torque in Nm, rising in speed; points without torque, in which such tables end, are
/// left out.
pub(crate) fn full_load(
    s: &Section,
    key: &str,
    file: Named,
    columns: &[(&str, Bound)],
) -> Option<Vec<Vec<f64>>> {
    let [(_, speeds), (_, torques)] = columns else {
        return None;
    };
    let least = Bound::closed(0.0, torques.high());
    let column =
        |name: &'static str, range, group| Column::number(name, range).required().group(group);
    let wanted = Wanted {
        kind: "full_load",
        columns: vec![
            column("speed_rpm", *speeds, "speed"),
            column("speed_rad_s", Bound::closed(0.0, 1600.0), "speed").alias(),
            column("torque_lbft", Bound::closed(0.0, 1500.0), "torque").alias(),
            column("torque_nm", least, "torque"),
        ],
        rules: Rules {
            rises_with: None,
            is_grid: false,
        },
        foreign: Foreign {
            headings: NEXT_TO_FULL_LOAD,
            words: OF_FULL_LOAD,
            ..Foreign::default()
        },
        is_fuel: false,
    };
    let table = read(s, key, &file, wanted)?;
    let names = ["speed_rpm", "speed_rad_s", "torque_lbft", "torque_nm"];
    let si = |row: &Vec<f64>| -> Vec<f64> {
        let cells = table.columns.iter().zip(row);
        cells
            .map(|(column, x)| Quantity::from_key(names[*column]).to_si(*x))
            .collect()
    };
    let mut rows: Vec<Vec<f64>> = table
        .rows
        .iter()
        .map(si)
        .filter(|row| row[1] > 0.0)
        .collect();
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Some(rows)
}

/// The table of a map of fuel; none after a problem.
pub(crate) fn bsfc_table(s: &Section, key: &str, file: Named) -> Option<Arc<MapTable>> {
    let wanted = Wanted {
        kind: "bsfc",
        columns: fuel::columns(),
        rules: Rules {
            rises_with: None,
            is_grid: false,
        },
        foreign: fuel::FOREIGN,
        is_fuel: true,
    };
    read(s, key, &file, wanted)
}

/// The problem of a map of fuel that does not hang together.
pub(crate) fn no_bsfc_map(why: NoMap) -> Problem {
    let problem = Problem::conflict(why.message).allowed(why.allowed);
    problem.hint(why.hint)
}

impl MapTable {
    /// A map of fuel without friction; none of a table without its columns. The last one is kept: few cars differ in what it depends on.
    ///
    /// # Errors
    /// Why the rows make no map.
    pub fn bsfc_map(&self, basis: &Basis) -> Result<Option<BsfcMap>, NoMap> {
        let mut made = self.bsfc.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, map)) = made.as_ref().filter(|(of, _)| of == basis) {
            return Ok(Some(map.clone()));
        }
        let (mut speed, mut load, mut burnt) = (None, None, None);
        for (at, column) in self.columns.iter().enumerate() {
            match fuel::gives(*column) {
                fuel::Gives::Speed => speed = Some((at, *column)),
                fuel::Gives::Load(of) => load = Some((at, *column, of)),
                fuel::Gives::Fuel(of) => burnt = Some((at, *column, of)),
            }
        }
        let (Some(speed), Some(load), Some(burnt)) = (speed, load, burnt) else {
            return Ok(None);
        };
        let row = |(row, line): (&Vec<f64>, &usize)| FuelRow {
            speed_rad_s: fuel::to_si(speed.1, row[speed.0]),
            load: fuel::to_si(load.1, row[load.0]),
            fuel: fuel::to_si(burnt.1, row[burnt.0]),
            line: *line,
        };
        let table = FuelTable {
            file: self.file.clone(),
            read_as: self.read_as.clone(),
            load: load.2,
            fuel: burnt.2,
            swept: self.swept.clone(),
            rows: self.rows.iter().zip(&self.lines).map(row).collect(),
        };
        let map = BsfcMap::from_table(&table, basis, (0.0, 0.0))?;
        *made = Some((*basis, map.clone()));
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
        is_fuel: false,
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
