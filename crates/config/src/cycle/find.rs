//! A cycle by its name, a constant speed (as the older fuel figures at 90 and 120 km/h, 80/1268/EEC, have it), or a file of the user.

use super::{Cycle, Interval, Trace, Weighting, embedded, names, read_columns};
use crate::channel::Repairs;
use crate::csv::Columns;
use crate::files::bounded::{self, Limit};
use crate::files::embedded::is_path;
use crate::{Argument, Problem, Problems, near, suggestion};
use cvtcycle_model::drive::Vehicle;

/// Other names of the cycles, without capitals and the signs between words: what people call them, and what it is here.
pub const ALIASES: [(&str, &str); 21] = [
    ("nedc", "ece15_eudc"),
    ("mvegb", "ece15_eudc"),
    ("mvega", "mvega_idle40"),
    ("wltc", "wltc_class3b"),
    ("wltp", "wltc_class3b"),
    ("wltc3", "wltc_class3b"),
    ("wltc3b", "wltc_class3b"),
    ("wltc3a", "wltc_class3a"),
    ("wltc2", "wltc_class2"),
    ("wltc1", "wltc_class1"),
    ("ftp", "ftp75"),
    ("epa75", "ftp75"),
    ("la4", "udds"),
    ("fuds", "udds"),
    ("hwy", "hwfet"),
    ("hwfe", "hwfet"),
    ("hfet", "hwfet"),
    ("1015", "jp_10_15_mode"),
    ("1015mode", "jp_10_15_mode"),
    ("cadcurban", "artemis_urban"),
    ("cadcroad", "artemis_road"),
];

/// The name of a cycle that a word means: itself, in other capitals and signs, or one of [`ALIASES`].
#[must_use]
pub fn name_of(word: &str) -> Option<&'static str> {
    let wanted = bare(word);
    let alias = ALIASES.iter().find(|(alias, _)| *alias == wanted);
    let names = || names().iter().copied();
    alias
        .map(|(_, name)| *name)
        .or_else(|| names().find(|name| bare(name) == wanted))
}

/// A cycle by name (`ece15_eudc`, `nedc`, `constant_90`), or from the CSV file at a path.
///
/// # Errors
/// An unknown name with those like it, an unreadable file, or all problems of the file.
///
/// ```
/// use cvtcycle_config::cycle::find;
/// assert_eq!(find("ece15")?.trace_for(true).duration_s(), 195.0);
/// assert_eq!(find("NEDC")?.name, "ece15_eudc");
/// assert_eq!(find("ece15_euc").unwrap_err()[0].suggested[0], "ece15_eudc");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn find(word: &str) -> Result<Cycle, Problems> {
    open(word, &Columns::default())
}

/// As [`find`], with the columns of the file that are meant; if there are any, all others are passed over.
///
/// # Errors
/// As there; columns with a cycle that is no file.
pub fn open(word: &str, columns: &Columns) -> Result<Cycle, Problems> {
    let named = find_named(word)?;
    let is_given = !columns.is_empty() || columns.repairs() != Repairs::default();
    if named.is_some() && is_given {
        let problem =
            Problem::conflict(format!("`{word}` is no file whose columns could be named"));
        let problem = problem
            .at(Argument::Columns)
            .allowed("columns of a CSV file");
        return Err(problem.hint("leave them out").into());
    }
    match named {
        Some(cycle) => Ok(cycle),
        None => read_columns(word, &bytes(Argument::Cycle, word, bounded::LOG)?, columns),
    }
}

/// The cycle of a word for a car: `wltc` and `wltp` are the WLTC of the car's class (CY-2), and the title says why; any other cycle is as
/// it is.
#[must_use]
pub fn for_car(word: &str, cycle: Cycle, car: &Vehicle) -> Cycle {
    if !["wltc", "wltp"].contains(&bare(word).as_str()) {
        return cycle;
    }
    let class = car.wltc();
    let Some(own) = embedded(class.cycle) else {
        return cycle;
    };
    let reaches = match (class.cycle, class.reaches_120_kmh) {
        ("wltc_class1" | "wltc_class2", _) => "",
        (_, true) => " and reaches 120 km/h",
        (_, false) => " and does not reach 120 km/h",
    };
    let title = format!(
        "{}: the car has {:.1} W/kg{reaches}",
        own.title, class.w_per_kg
    );
    Cycle { title, ..own }
}

/// A word without capitals and the signs between words.
fn bare(word: &str) -> String {
    let letters = word.chars().filter(|c| !" -_.".contains(*c));
    letters.collect::<String>().to_lowercase()
}

/// A cycle that is no file; none for a path.
fn find_named(word: &str) -> Result<Option<Cycle>, Problems> {
    if let Some(constant) = constant_speed(word).filter(|_| !is_csv(word)) {
        return constant.map(Some).map_err(Problems::from);
    }
    if let Some(found) = name_of(word).and_then(embedded) {
        return Ok(Some(found));
    }
    if is_path(word) {
        return Ok(None);
    }
    let aliases = ALIASES.iter().map(|(alias, _)| *alias);
    let near = near(word, names().iter().copied().chain(aliases));
    let question = suggestion(&near).map_or_else(String::new, |question| question + " ");
    let quoted = match word {
        "" => "an empty value".to_owned(),
        _ => format!("`{word}`"),
    };
    let allowed =
        "a name of `cvtcycle list cycles`, constant_V with V in km/h, or the path of a CSV file";
    let hint = "`cvtcycle list cycles` shows all; a path needs a / or an ending";
    let problem = Problem::unknown_name(format!("there is no cycle named {quoted}"))
        .at(Argument::Cycle)
        .value(word)
        .allowed(allowed)
        .suggest(&near);
    Err(problem.hint(question + hint).into())
}

/// True if a word is surely a file, though it may begin like the name of a constant speed.
#[must_use]
pub fn is_csv(word: &str) -> bool {
    word.contains(['/', '\\']) || word.to_lowercase().ends_with(".csv")
}

/// The bytes of a file that the user named.
///
/// # Errors
/// A problem of the argument: the words of the operating system, or more bytes than the limit.
pub fn bytes(argument: Argument, path: &str, limit: Limit) -> Result<Vec<u8>, Problems> {
    bounded::read(path, limit).map_err(|error| {
        let hint = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "check the path; it is taken from the current directory"
            }
            std::io::ErrorKind::IsADirectory => "name a file in that directory",
            _ => "check the path and its permissions",
        };
        Problem::unreadable(format!("cannot read `{path}`: {error}"))
            .at(argument)
            .value(path)
            .allowed(error.allowed("a readable file"))
            .hint(error.hint(hint))
            .into()
    })
}

const PREFIX: &str = "constant_";
// ASSUMED: long enough for the fluids of a warm car to settle, short enough to wait for
const DURATION_S: f64 = 600.0;
const HIGHEST_KMH: f64 = 250.0;
/// Slower is no speed of a car: a metre in an hour.
const LOWEST_KMH: f64 = 0.1;
/// The constant speeds that there are.
pub const CONSTANT: &str = "constant_V with V in km/h, 0.1 to 250";

/// The cycle `constant_90`, `constant_120` or, in general, `constant_V`: 600 s at V km/h with a flying start.
/// `None` if the name does not begin with `constant_`.
///
/// # Errors
/// V is not a plain decimal number from 0.1 to 250.
#[must_use]
pub fn constant_speed(name: &str) -> Option<Result<Cycle, Problem>> {
    let text = name.strip_prefix(PREFIX)?;
    Some(
        speed_kmh(text)
            .map(|kmh| cycle(name, text, kmh))
            .ok_or_else(|| problem(name, text)),
    )
}

fn speed_kmh(text: &str) -> Option<f64> {
    // f64::from_str would also take signs, exponents, inf and nan
    if !text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.')
    {
        return None;
    }
    let kmh = text.parse::<f64>().ok()?;
    (LOWEST_KMH..=HIGHEST_KMH).contains(&kmh).then_some(kmh)
}

fn cycle(name: &str, text: &str, kmh: f64) -> Cycle {
    let speed_m_s = kmh / 3.6;
    let interval = Interval {
        start_s: 0.0,
        end_s: DURATION_S,
        start_speed_m_s: speed_m_s,
        end_speed_m_s: speed_m_s,
        phase: 0,
        grade: 0.0,
        engine_off: false,
    };
    Cycle {
        name: name.to_owned(),
        title: format!("Constant {text} km/h for {DURATION_S} s, flying start"),
        phases: Vec::new(),
        weighting: Weighting::None,
        manual: Trace::without_gears(vec![interval]),
        automatic: None,
        read_as: None,
        recording: None,
        is_wltc: false,
    }
}

fn problem(name: &str, text: &str) -> Problem {
    let hint = if text.contains(',') {
        "write a decimal point, as in constant_88.5"
    } else {
        "write, for example, constant_90"
    };
    Problem::out_of_range("this is not a constant speed the program can drive")
        .at(Argument::Cycle)
        .value(name)
        .allowed(CONSTANT)
        .hint(hint)
}
