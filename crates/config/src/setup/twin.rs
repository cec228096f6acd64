//! The manual twin of a car with a CVT: the same car with a manual box, so that a comparison is like for like by construction.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TW-1 | overall_1 = r f, with f the engine speed over road speed in first, rad/s per m/s; overall_n = overall_1/span | source: validation vehicles of UN GTR 15, petrol: 17 with six gears have f 126 rpm per km/h (sd 21) and a span of 5.39 (sd 0.93), 11 with five gears 161 (51) and 4.98 (0.54) |
//! | TW-2 | ln(overall_1/overall_k) = s_k ln span; six gears: s = 0, 0.309, 0.542, 0.721, 0.863, 1; five: 0, 0.377, 0.640, 0.847, 1 | source: means of the same vehicles, sd of a share up to 0.042 |
//! | TW-3 | shift up from gear k at 0.47 - 0.03 (k - 1) of the speed of rated power, down at 0.72 of that road speed | ASSUMED, 0.42 to 0.50; meets the second bag of the FTP75 of a car of the 2010s within 1 % |
//! | TW-4 | road load, tyres, engine, its oil and its heat paths are the car's own; transmission, gear oil and their heat paths are those of `twin.box` | construction |
//!
//! Symbols: r radius of the wheel, m. Against two known gear sets the rule is off by 4 to 10 % of a ratio; fuel with fixed shift speeds moves by 1 to 2 %.

use std::path::Path;

use super::like::{Resolver, join};
use crate::document::{Document, Table};
use crate::files::Files;
use crate::problem::place::Input;
use crate::problem::source::Source;
use crate::{Problem, Problems, Reader, Section};
use cvtcycle_model::engine::ENGINE;
use cvtcycle_model::files::{HEAD, TWIN, TwinKeys};
use cvtcycle_model::keys::{Key, Values};
use cvtcycle_model::math::{exp, ln};
use cvtcycle_model::road::ROAD_LOAD;

/// Marks the name of a twin: that of its car follows.
pub(super) const MARK: &str = "twin:";

/// A gear set of the rule (TW-1, TW-2).
struct GearSet {
    gears: i64,
    first_rpm_per_kmh: f64,
    span: f64,
    shares: &'static [f64],
}

const SETS: [GearSet; 2] = [
    GearSet {
        gears: 5,
        first_rpm_per_kmh: 161.0,
        span: 4.98,
        shares: &[0.0, 0.377, 0.640, 0.847, 1.0],
    },
    GearSet {
        gears: 6,
        first_rpm_per_kmh: 126.0,
        span: 5.39,
        shares: &[0.0, 0.309, 0.542, 0.721, 0.863, 1.0],
    },
];
/// Share of the speed of rated power at which first gear is left, and its fall from gear to gear (TW-3).
const UP: (f64, f64) = (0.47, 0.03);
/// Down-shift speed over up-shift speed (TW-3).
const DOWN: f64 = 0.72;

/// Values of `[twin]`.
pub(super) struct TwinTable {
    set: &'static GearSet,
    first_per_m: f64,
    span: f64,
    overall: Vec<f64>,
    shift_m_s: Vec<f64>,
    parts: String,
}

impl TwinTable {
    pub fn from_values<V: Values>(s: &V) -> Self {
        let gears = s.integer(&TWIN.gears);
        let set = SETS.iter().find(|set| set.gears == gears);
        let set = set.unwrap_or(&SETS[1]);
        let overall = s.numbers(&TWIN.overall_ratios);
        if overall.windows(2).any(|pair| pair[0] <= pair[1]) {
            s.complain(
                TWIN.overall_ratios.name,
                "falling from gear to gear",
                "ratios must fall from first to top gear",
                "order them from first gear; reverse does not belong here",
            );
        }
        let shift_m_s = s.numbers(&TWIN.shift_kmh);
        let gears = if overall.is_empty() {
            set.shares.len()
        } else {
            overall.len()
        };
        let is_read = shift_m_s.iter().all(|speed| speed.is_finite());
        if is_read && !shift_m_s.is_empty() && shift_m_s.len() + 1 != gears {
            s.complain(
                TWIN.shift_kmh.name,
                &format!("{} speeds", gears - 1),
                &format!(
                    "{} speeds are not those between {gears} gears",
                    shift_m_s.len()
                ),
                "give one speed between each two gears",
            );
        }
        let usual = if gears < 6 {
            "class:box_manual_5"
        } else {
            "class:box_manual_6"
        };
        TwinTable {
            first_per_m: s.number_or(&TWIN.first_rpm_per_kmh, set.first_rpm_per_kmh),
            span: s.number_or(&TWIN.span, set.span),
            parts: s.text_or(&TWIN.r#box, usual),
            set,
            overall,
            shift_m_s,
        }
    }

    /// Overall ratios, and where they come from, for a wheel radius.
    fn ratios(&self, radius_m: f64) -> (Vec<f64>, Origin) {
        if !self.overall.is_empty() {
            return (self.overall.clone(), Origin::given(&TWIN.overall_ratios));
        }
        let (f, span) = (
            TWIN.first_rpm_per_kmh.quantity.from_si(self.first_per_m),
            self.span,
        );
        let first = self.first_per_m * radius_m; // TW-1
        let shares = self.set.shares.iter();
        let ratios = shares.map(|share| first * exp(-share * ln(span))); // TW-2
        let words = format!("TW-1, TW-2: {f:.1} rpm per km/h in first, span {span}");
        (ratios.collect(), Origin::new("derived", words))
    }

    /// Road speeds at which the gears change up and down, km/h, and where they come from.
    fn shifts(&self, overall: &[f64], radius_m: f64, rated_rad_s: f64) -> ([Vec<f64>; 2], Origin) {
        if self.shift_m_s.is_empty() {
            let origin = Origin::new("assumed", "TW-3".to_owned());
            return (shifts_kmh(overall, radius_m, rated_rad_s), origin);
        }
        let up: Vec<f64> = self.shift_m_s.iter().map(|v| 3.6 * v).collect();
        (with_down(up), Origin::given(&TWIN.shift_kmh))
    }
}

/// Road speeds at which the gears change up and down (TW-3), km/h.
pub(super) fn shifts_kmh(overall: &[f64], radius_m: f64, rated_rad_s: f64) -> [Vec<f64>; 2] {
    let changes = overall.iter().take(overall.len().saturating_sub(1));
    let speed = |(k, ratio): (usize, &f64)| {
        let share = UP.0 - UP.1 * k as f64;
        3.6 * share * rated_rad_s * radius_m / ratio
    };
    with_down(changes.enumerate().map(speed).collect())
}

fn with_down(up: Vec<f64>) -> [Vec<f64>; 2] {
    let down = up.iter().map(|kmh| DOWN * kmh).collect();
    [up, down]
}

/// Status and source of a value of the twin.
struct Origin(String);

impl Origin {
    fn new(status: &str, source: String) -> Self {
        Origin(format!("status = \"{status}\", source = \"{source}\""))
    }

    fn given(key: &Key<'_>) -> Self {
        Origin(format!(
            "source = \"{}.{}\"",
            TwinKeys::TABLE.name,
            key.name
        ))
    }
}

/// The twin of the car in `document`, which has all that it inherits and is read from `file`.
///
/// # Errors
/// The car has no CVT, or what its twin is made of cannot be read.
pub(super) fn twin(
    document: Document,
    file: &str,
    files: &dyn Files,
) -> Result<Document, Problems> {
    let reader = Reader::new(&document);
    let root = reader.root();
    let refused = |problem: Problem| {
        let place = root.table("vehicle").place(HEAD.baselines.name);
        Problems::from(problem.at(place).key("vehicle.baselines"))
    };
    if root.table("transmission").has("manual") {
        let problem =
            Problem::wrong_transmission(format!("`{file}` has a manual box, and no twin"));
        let problem = problem.allowed("a twin of a car with a CVT");
        return Err(refused(problem.hint("name another baseline")));
    }
    let table = TwinTable::from_values(&root.table(TwinKeys::TABLE.name));
    let known = text(&table, &root).filter(|_| reader.problem_count() == 0);
    let Some(text) = known else {
        let problem = Problem::invalid("the car has mistakes of its own, so that it has no twin");
        return Err(refused(problem.hint("mend the car first")));
    };
    let place = root.table(TwinKeys::TABLE.name).place(TWIN.r#box.name);
    let parts = Resolver::new(file, files).parent(&table.parts, Path::new(""));
    let parts = parts.map_err(|found| {
        found.map(|problem| match problem.place.input {
            Input::Argument(_) => problem.at(place.clone()).key("twin.box"),
            _ => problem,
        })
    })?;
    let source = Source::new(Input::File(format!("{MARK}{file}")), &text);
    let mut twin = Document::from_source(source)?;
    take(&mut twin, parts);
    let mut car = document.clone();
    remove(&mut car.root, &["transmission", "twin"]);
    let inner = |root: &mut Table, name: &str, entries: &[&str]| {
        let table = root.inner_mut(&[name.into()]);
        table.into_iter().for_each(|table| remove(table, entries));
    };
    inner(
        &mut car.root,
        "vehicle",
        &["title", "short", "baselines", "like", "transmission_oil"],
    );
    inner(&mut car.root, "thermal", &["transmission", "cooler"]);
    take(&mut twin, car); // TW-4
    Ok(twin)
}

/// Puts into a document what it lacks and another one has.
fn take(document: &mut Document, other: Document) {
    let offset = document.sources.len();
    document.sources.extend(other.sources);
    let mut root = other.root;
    root.each_span(&|span| span.source += offset);
    join(&mut document.root, root, "");
}

fn remove(table: &mut Table, names: &[&str]) {
    table.entries.retain(|name| !names.contains(&name));
}

/// The twin's own values as a file; `None` if the car lacks the values for it.
fn text(table: &TwinTable, root: &Section<'_>) -> Option<String> {
    let radius_m = root.table("road_load").number(&ROAD_LOAD.wheel_radius_m);
    let line = root.table("engine").rows(&ENGINE.full_load)?;
    let power = |row: &Vec<f64>| row[0] * row[1];
    let rated = line.iter().max_by(|a, b| power(a).total_cmp(&power(b)))?;
    let (overall, of_ratios) = table.ratios(radius_m);
    let ([up, down], of_shifts) = table.shifts(&overall, radius_m, rated[0]);
    let own = match root.table("vehicle").text_or(&HEAD.title, "") {
        title if title.is_empty() => "this car".to_owned(),
        title => title,
    };
    let title = format!("Twin of {own}, {}-speed manual", overall.len());
    let title = toml::Value::String(title);
    let entry = |key: &str, values: &[f64], origin: &Origin| {
        let values: Vec<String> = values.iter().map(|x| format!("{x:.3}")).collect();
        format!(
            "{key} = {{ value = [{}], {} }}\n",
            values.join(", "),
            origin.0
        )
    };
    Some(
        [
            format!("[vehicle]\ntitle = {title}\n\n[transmission.manual]\n"),
            entry("overall_ratios", &overall, &of_ratios),
            entry("upshift_kmh", &up, &of_shifts),
            entry("downshift_kmh", &down, &of_shifts),
        ]
        .concat(),
    )
}
