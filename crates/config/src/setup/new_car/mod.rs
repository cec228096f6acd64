//! A vehicle file from catalogue numbers; what is not given is inherited from classes or from another car.
//!
//! | label | statement | status |
//! |---|---|---|
//! | NC-1 | r = 3.05 D/(2 pi), D = rim + 2 width height | source: CO2MPAS |
//! | NC-2 | full load below n_T: T_max (1 - 0.31 ((n_T - n)/(n_T - n_idle))^1.5); above: T_max - (T_max - T_P)((n - n_T)/(n_P - n_T))^2, T_P = P/w_P, up to n_P with no more power than P, nor than on the line from n_T to n_P where the plateau has more; above n_P at most P | fitted to the CO2MPAS shape of the Rover; held power of charged engines derived from P |
//! | NC-3 | inertia 0.05 + 0.1 V kg m2, accessories 0.175 V + 0.2021 Nm, V in litres | source: CO2MPAS |
//! | NC-4 | belt length by GE-3 from centre distance, low ratio and a least running radius of 30 mm; its mass 1.6 kg/m, of a chain that of its class | derived; radius ASSUMED 25 to 35 mm |
//! | NC-6 | heat capacity of the engine by rated power: block 0.525, oil 0.28 kJ/K per kW | derived from ADVISOR |
//! | NC-7 | units by their definitions | source |
//! | NC-9 | stroke of cylinders of equal bore and stroke: three up to 1.05 l, four up to 2.7 l, six up to 4.2 l, eight above | ASSUMED; within 12 % of six sold engines of 0.66 to 5.3 l |
//! | NC-11 | pump of a CVT of a class: 0.062 cc/rev for a newton metre of T, the highest torque of the full-load line, and at least 6 cc/rev | ASSUMED, 0.06 to 0.095, least 5 to 7 (the Justy, 90 Nm, has 6.1; the flow of lubrication does not fall with the torque: 3 l/min and 0.1 l/min a bar take 4.5 cc/rev at an idle of 700 rpm): one car of 1995 has 8 cc/rev for 130 Nm, a box for 200 Nm 19 (SAE 2004-40CVT-49); the lower end, as larger pumps have a second port that is relieved (Toyota K313) and the pump of the classes has not |
//! | NC-12 | its launch device holds full load at rest at 2400 rpm with a converter, at 2500 rpm with a clutch: capacity T(2400)/2.4^2, gain T(2500)/(2500 - n_engage)^2 | ASSUMED, 2050 to 2900 and 2350 to 2650 rpm: service data of CVT cars, Honda Fit 2020 2000 to 2400, Nissan MR18DE 2600 to 3150, Subaru Legacy 2.5 1900 to 2700, CR-Z 1900 to 2200, SX4 2300 to 2500, with no fall over 120 to 240 Nm. EPA's ALPHA has 3030/sqrt(T) rpm/sqrt(Nm), 2900 rpm of 0.93 T: above four of the five |
//! | NC-13 | its pistons: the largest pressure of the class grips S T in low, S safety of the clamp law; the primary over the secondary as the class has it | derived from PC-3; the torque that a converter adds at rest is not in it: the engine is held there, ASSUMED. With it (1.9 times 0.9 T) pistons are a third larger and HWFET takes 1.9 % more, as the least pressure presses on them too |
//! | NC-14 | its pushing belt above 200 Nm: 1.25 times the mass and the width of the bands | ASSUMED: belts of 24 and 30 mm; 180 to 250 Nm |
//! | NC-15 | its metal: (40 + 0.18 T) kg in place of 60 kg | ASSUMED, 10 kg more or less. No rule for its oil: 5.7 l at 145 Nm, 8.3 l at 174 Nm |
//! | NC-16 | N/V in rpm per km/h: i_top = N/V 3.6 r 2 pi/60, final drive i_top/I_high, or gears times i_top/i_last; a final drive without gears multiplies all overall ratios of a manual box | derived |
//! | NC-17 | line of gentle driving of a CVT of a class with a N/V: 0.8 times the speed of its highest ratio at 80 km/h, 1000 to 1300 rpm; above 64 km/h or so the highest ratio is the line | ASSUMED, 0.7 to 0.9: cars of 2010 to 2019 turn 1044 to 1675 rpm at 80 km/h (US lists, 129), the median 1390 gives the 1100 of the classes |
//! | NC-10 | a CVT of a class keeps an engine that has its fuel cut later than the class expects 100 rpm above that speed in overrun | ASSUMED: controllers of CVTs hold the cut, 50 to 200 rpm |
//!
//! | NC-19 | full load of a car with a named engine: its line, speeds times n_P/n_P,named where n_P is given, torques so that the greatest power is P; stroke of the named engine times (V/V_named)^(1/3) | derived: the same engine in another size |
//!
//! `engines` finds the class of an engine, `units` reads numbers with their units, `tyre` tyre codes, `rules` makes the values, `full_load` the line of full load, `neutral` the drag of the box in a coast-down, this module the file; `options` puts what is wrong with it under their options, `answers`
//! reads the numbers from a file, `questions` says what may be asked for.

mod answers;
mod engines;
mod full_load;
mod neutral;
mod options;
mod questions;
mod rules;
mod tyre;
mod units;

use std::collections::BTreeMap;
use std::path::Path;

use super::{Disk, Kind, NamedBy, Options, ParamSet, Setup};
use crate::problem::near::suggest;
use crate::{Override, Place, Problem, Problems};
pub use engines::{engine_mistake, named_engines, technologies, years};
pub use questions::{Question, mistake, questions, road_load_default};
use rules::Line;

/// Catalogue numbers by the names of their options, as texts.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Name or path of the file, which problems of its values cite.
    pub file: String,
    /// Name for people.
    pub title: String,
    /// Car from which the rest comes.
    pub like: Option<String>,
    /// Class of the body and the engine.
    pub class: Option<String>,
    /// Class of the transmission.
    pub gearbox: Option<String>,
    /// Technology of the engine, such as `di` ([`technologies`]).
    pub engine: Option<String>,
    /// Year of the engine.
    pub engine_year: Option<String>,
    /// A measured engine by the name of its class without `engine_`.
    pub engine_like: Option<String>,
    /// The numbers.
    pub numbers: BTreeMap<&'static str, String>,
    /// Places of those that come from a file ([`Answers::add_file`]).
    pub places: BTreeMap<&'static str, Place>,
}

/// A vehicle file.
#[derive(Clone, Debug)]
pub struct NewCar {
    /// The file.
    pub text: String,
    /// The car that it is.
    pub setup: Setup,
    /// Notes on what was chosen for it, a sentence each.
    pub notes: Vec<String>,
}

/// Part of a car that a class describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassOf {
    /// Body, with an engine.
    Body,
    /// Transmission.
    Box,
    /// Engine.
    Engine,
}

impl ClassOf {
    /// Finds the part from the name of a class.
    #[must_use]
    pub fn of_name(name: &str) -> Self {
        match (name.starts_with("box_"), name.starts_with(ENGINE)) {
            (true, _) => ClassOf::Box,
            (_, true) => ClassOf::Engine,
            _ => ClassOf::Body,
        }
    }

    /// The classes of it.
    #[must_use]
    pub fn names(self) -> Vec<&'static str> {
        let names = Kind::Class.names().into_iter();
        names.filter(|name| Self::of_name(name) == self).collect()
    }
}

/// Begin of the names of classes of engines.
const ENGINE: &str = "engine_";

/// Names of the numbers that a car may have, with their meaning.
pub const NUMBERS: [(&str, &str); 23] = [
    ("mass", "test mass, the driver with it: kg, lb or t"),
    ("f0", "constant part of the road load: N or lbf"),
    ("f1", "part linear in speed: N/(km/h) or lbf/mph"),
    ("f2", "part quadratic in speed: N/(km/h)2 or lbf/mph2"),
    (
        "road-load",
        "what f0, f1 and f2 are of: body, or neutral for a coast-down in neutral with the drag of the box in it, as EPA's targets are",
    ),
    ("tyre", "tyre code, such as 215/55 R16"),
    (
        "wheel-radius",
        "dynamic radius of the wheel in place of the tyre: mm",
    ),
    ("displacement", "displacement of the engine: cm3 or l"),
    (
        "power",
        "rated power with its unit, and its speed: 104kW@6400; kW, hp or PS",
    ),
    (
        "torque",
        "highest torque, and its speed or speeds: 172@4000 or 172@3800-4400; Nm or lbft",
    ),
    ("idle", "idle speed of the warm engine: rpm"),
    ("highest", "highest speed of the engine: rpm"),
    (
        "gears",
        "gears of a manual box, first gear first: 3.64,2.08,1.36",
    ),
    ("final-drive", "ratio of the final drive"),
    (
        "n-over-v",
        "engine speed over road speed in the highest gear or ratio, locked: rpm/(km/h) or rpm/mph",
    ),
    ("ratio-low", "largest ratio of the belt"),
    ("ratio-high", "smallest ratio of the belt"),
    (
        "span",
        "largest ratio of the belt over the smallest, in place of one of them",
    ),
    ("centre-distance", "distance of the pulleys: mm"),
    ("pump", "displacement of the pump: cc/rev"),
    ("oil", "oil in the transmission: l"),
    ("fluid", "transmission oil, by name or path"),
    ("engine-oil", "engine oil, by name or path"),
];

/// Classes of body and box that are taken where nothing is said.
pub const USUAL: [&str; 2] = ["compact_2020", "box_cvt_clutch"];
/// Numbers that no class has for a car: only a car that it is like has them.
const REQUIRED: [&str; 2] = ["displacement", "power"];
/// Keys of inherited values that move the fuel most.
const OF_WEIGHT: [&str; 14] = [
    "road_load.mass_kg",
    "road_load.form.coefficients.f0_n",
    "road_load.form.coefficients.f2_n_per_kmh2",
    "road_load.wheel_radius_m",
    "engine.model.willans.l",
    "engine.model.willans.a",
    "engine.idle.hot_rpm",
    "engine.electrical_w",
    "transmission.cvt.final_drive_ratio",
    "transmission.cvt.ratio.gentle_rpm",
    "transmission.cvt.clamp.torque_following.safety_factor",
    "transmission.cvt.pump.displacement_cc_rev",
    "transmission.manual.overall_ratios",
    "transmission.manual.upshift_kmh",
];

/// Writes the file of a car.
///
/// # Errors
/// All numbers that are none or do not fit each other; a problem's key is the name of its option.
pub fn write(answers: &Answers) -> Result<NewCar, Problems> {
    let (mut text, params, notes) = placed(answers, &[])?;
    let setup = params.setup();
    text += &weight_comments(&setup);
    Ok(NewCar { text, setup, notes })
}

/// The car of catalogue numbers, in memory, with other values in place of those that the rules make.
///
/// ```
/// use cvtcycle_config::setup::new_car::{Answers, param_set};
/// let mut answers = Answers::default();
/// answers.add_file("mine", "displacement = \"1.8l\"\npower = \"104kW\"")?;
/// assert_eq!(param_set(&answers, &[])?.vehicle().engine().displacement_m3, 1.8e-3);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
///
/// # Errors
/// As [`write()`], and problems of the overrides.
pub fn param_set(answers: &Answers, set: &[Override]) -> Result<ParamSet, Problems> {
    placed(answers, set).map(|(_, params, _)| params)
}

/// The twin of that car: the same with a manual box, as its file has it as baseline. `None` of a car with a manual box.
///
/// # Errors
/// As [`param_set`].
pub fn twin_set(answers: &Answers, set: &[Override]) -> Result<Option<ParamSet>, Problems> {
    let (text, params, _) = placed(answers, set)?;
    if !params.vehicle().transmission().is_cvt() {
        return Ok(None);
    }
    let is_of_box = |by: &Override| by.key().starts_with("transmission.");
    let set = set.iter().filter(|by| !is_of_box(by)).cloned();
    let options = Options {
        set: set.collect(),
        ..Options::default()
    };
    let options = options.of_twin(NamedBy::File);
    let twin = ParamSet::read_twin(&answers.file, &text, files(answers), &options);
    twin.map(Some)
}

/// Text, car and notes.
type Made = (String, ParamSet, Vec<String>);

/// The car; problems at the places of the numbers.
fn placed(answers: &Answers, set: &[Override]) -> Result<Made, Problems> {
    made(answers, set).map_err(|found| {
        found.map(|problem| match answers.places.get(problem.key.as_str()) {
            Some(place) => problem.at(place.clone()),
            None => problem,
        })
    })
}

fn made(answers: &Answers, set: &[Override]) -> Result<Made, Problems> {
    let mut problems = Problems::new();
    for name in REQUIRED.iter().filter(|name| is_missing(answers, name)) {
        let problem = Problem::missing(format!("the {name} of the engine is missing")).key(*name);
        problems.push(
            problem
                .names_key()
                .allowed(meaning(name))
                .hint("a class has none that is this car's; only a car that it is like has"),
        );
    }
    let Some(base) = problems.take(Base::from_answers(answers)) else {
        return Err(problems);
    };
    let lines = problems.take(rules::lines(answers, &base.car));
    let Some(mut lines) = lines.filter(|_| problems.is_empty()) else {
        return Err(problems);
    };
    let title = toml::Value::String(answers.title.clone()).to_string();
    let own = lines.iter().filter(|line| line.table() == VEHICLE);
    let own: String = own.map(Line::text).collect();
    let title = format!("title = {title}\n{own}");
    let head = head(&title, &base.like, base.car.transmission().is_cvt());
    let made = |lines: &[Line]| {
        let text = format!("{head}{}", tables(lines));
        let params = car(answers, &text, set);
        let params = params.map_err(|found| options::under_options(found, lines, answers))?;
        Ok::<Made, Problems>((text, params, base.notes.clone()))
    };
    let (text, params, mut notes) = made(&lines)?;
    notes.extend(questions::road_load_note(answers));
    if !rules::is_neutral(answers) {
        return Ok((text, params, notes));
    }
    let Some(drag) = neutral::drag_coefficients(&params.setup()) else {
        let problem = Problem::invalid(
            "the box cannot be turned without torque at some speed of a coast-down",
        );
        return Err(problem
            .key("road-load")
            .hint("write body, and take the drag off f0, f1 and f2 yourself")
            .into());
    };
    lines.extend(rules::drag_lines(drag));
    let (text, params, _) = made(&lines)?;
    Ok((text, params, notes))
}

/// True if a number that a class cannot have is missing.
fn is_missing(answers: &Answers, name: &str) -> bool {
    let has = |name: &str| answers.numbers.contains_key(name);
    // A named engine has its own, and in another size needs another power.
    let is_whole = answers.engine_like.is_some() && (name != "power" || !has("displacement"));
    REQUIRED.contains(&name) && answers.like.is_none() && !is_whole && !has(name)
}

/// Names that the car inherits from.
struct Base {
    /// Items of `like`.
    like: String,
    /// The car without a value of its own.
    car: Setup,
    /// Notes on the classes.
    notes: Vec<String>,
}

impl Base {
    fn from_answers(answers: &Answers) -> Result<Base, Problems> {
        let (parents, notes) = parents(answers)?;
        let like = parents.iter().map(|name| format!("{name:?}"));
        let like = like.collect::<Vec<_>>().join(", ");
        let car = car(answers, &head("", &like, false), &[])?.setup();
        Ok(Base { like, car, notes })
    }
}

/// The car of a text that is to be the file.
fn car(answers: &Answers, text: &str, set: &[Override]) -> Result<ParamSet, Problems> {
    let options = Options {
        set: set.to_vec(),
        ..Options::default()
    };
    ParamSet::read(&answers.file, text, files(answers), &options)
}

/// Files next to that of the car.
fn files(answers: &Answers) -> Box<Disk> {
    let folder = Path::new(&answers.file).parent();
    let folder = folder.map(Path::to_path_buf).unwrap_or_default();
    Box::new(Disk { folder })
}

fn meaning(name: &str) -> &'static str {
    let found = NUMBERS.iter().find(|(own, _)| *own == name);
    found.map_or("", |(_, meaning)| meaning)
}

/// Names that the car inherits from, and notes on them.
fn parents(answers: &Answers) -> Result<(Vec<String>, Vec<String>), Problem> {
    let class = |name: &str, option: &str, of: ClassOf| {
        let known = of.names();
        match known.contains(&name) {
            true => Ok(format!("class:{name}")),
            false => Err(
                Problem::unknown_name(format!("there is no class named `{name}`"))
                    .key(option)
                    .value(name)
                    .allowed(known.join(", "))
                    .hint(suggest(name, &known)),
            ),
        }
    };
    let found = engines::class(answers)?;
    let notes = found.iter().filter_map(|engine| engine.note.clone());
    let notes: Vec<String> = notes.collect();
    let engine = found.map(|engine| format!("class:{}", engine.class));
    if let Some(car) = &answers.like {
        if answers.class.is_some() {
            let problem = Problem::conflict("a car and a class at once").key("class");
            return Err(problem.hint("give one of them"));
        }
        let gearbox = answers
            .gearbox
            .as_ref()
            .map(|name| class(name, "box", ClassOf::Box));
        let gearbox = gearbox.transpose()?;
        let all = [car.clone()].into_iter().chain(engine).chain(gearbox);
        return Ok((all.collect(), notes));
    }
    let [body, gearbox] = USUAL;
    let body = answers.class.as_deref().unwrap_or(body);
    let gearbox = answers.gearbox.as_deref().unwrap_or(gearbox);
    let body = class(body, "class", ClassOf::Body)?;
    let gearbox = class(gearbox, "box", ClassOf::Box)?;
    let all = [body].into_iter().chain(engine).chain([gearbox]);
    Ok((all.collect(), notes))
}

/// The begin of the file.
fn head(title: &str, like: &str, has_twin: bool) -> String {
    let baselines = match has_twin {
        true => "# The same car with a manual box.\nbaselines = [\"twin\"]\n",
        false => "",
    };
    format!(
        "#:schema vehicle.schema.json\n\
         # Made by `cvtcycle new`. What is not here comes from what `like` names: `cvtcycle show` prints every value and from where it comes,\n\
         # `cvtcycle schema vehicle > vehicle.schema.json` gives an editor the keys with their ranges.\n\
         [vehicle]\nlike = [{like}]\n{title}{baselines}"
    )
}

/// The table of the head of the file.
const VEHICLE: &str = "vehicle";

/// The lines by their tables, in the order in which these come first.
fn tables(lines: &[Line]) -> String {
    let mut text = String::new();
    let mut done = vec![VEHICLE];
    for table in lines.iter().map(Line::table) {
        if !done.contains(&table) {
            done.push(table);
            let own = lines.iter().filter(|line| line.table() == table);
            text += &format!("\n[{table}]\n{}", own.map(Line::text).collect::<String>());
        }
    }
    text
}

/// Inherited values that are worth a look, as comments.
fn weight_comments(setup: &Setup) -> String {
    let inherited = setup.keys.iter().filter(|info| {
        OF_WEIGHT.contains(&info.key.as_str()) && ["class", "like"].contains(&info.status.as_str())
    });
    let lines = inherited.map(|info| format!("# {} = {}  # {}\n", info.key, info.value, info.from));
    let lines: String = lines.collect();
    match lines.as_str() {
        "" => lines,
        lines => format!(
            "\n# Not given, and of weight for the fuel; written in its table, a value is this car's:\n{lines}"
        ),
    }
}
