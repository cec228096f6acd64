//! Sources of computed values, read from `[sources.NAME]`.

use std::path::Path;

use cvtcycle_config::cycle::{Cycle, constant_speed, embedded, names, read_csv};
use cvtcycle_config::setup::{AMBIENT, is_path};
use cvtcycle_config::{Bound, Override, Place, Section, did_you_mean, unit_of};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// What a source computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A transmission on the bench.
    Bench,
    /// The belt alone.
    Belt,
    /// A car through a cycle.
    Run,
    /// A fluid over temperature.
    Fluid,
    /// Warm-up and cooling on the transmission rig.
    Transient,
    /// The box taken apart on the transmission rig.
    StripDown,
    /// A vehicle's values only.
    Vehicle,
}

impl Kind {
    /// Words for `source`.
    const NAMES: [(&'static str, Kind); 7] = [
        ("bench", Kind::Bench),
        ("belt", Kind::Belt),
        ("run", Kind::Run),
        ("fluid", Kind::Fluid),
        ("transient", Kind::Transient),
        ("strip_down", Kind::StripDown),
        ("vehicle", Kind::Vehicle),
    ];
}

/// One source, checked.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in the expressions.
    pub name: String,
    /// Place of its overrides, or of its kind.
    pub place: Place,
    /// What it computes.
    pub kind: Kind,
    /// Vehicle; none for the candidate vehicle.
    pub vehicle: Option<String>,
    /// Transmission oil in place of the vehicle's.
    pub lubricant: Option<String>,
    /// Overrides.
    pub set: Vec<Override>,
    /// Reading of the belt model.
    pub formulation: Formulation,
    /// Axes of a grid in SI units, the last one running fastest; no list where the key is absent.
    pub axes: Vec<(&'static str, Option<Vec<f64>>)>,
    /// Parts that are not in the box on the bench.
    pub without: Vec<String>,
    /// Cycle of a run.
    pub cycle: String,
    /// Times and speeds of a run in place of a cycle, s and km/h.
    pub points: Vec<Vec<f64>>,
    /// Start of a run: `soak` or `warm`.
    pub start: String,
    /// Group of phases of a run; empty for all.
    pub phase: String,
}

/// Axes of each kind: key, range, whether it must be given, meaning.
pub type Axis = (&'static str, Bound, bool, &'static str);

const SPEED: Bound = Bound::closed(0.0, 20_000.0);
const TEMP: Bound = Bound::closed(-40.0, 160.0);
const TORQUE: Bound = Bound::closed(-5_000.0, 5_000.0);
const PRESSURE: Bound = Bound::closed(0.0, 100.0);
const FRICTION: Bound = Bound::closed(0.0, 0.5);

/// Settings of the bench.
pub const BENCH: [Axis; 9] = [
    (
        "ratio",
        Bound::closed(0.2, 20.0),
        true,
        "belt ratio I = R_sec / R_pri, or the number of a gear",
    ),
    (
        "speed_rpm",
        Bound::closed(1.0, 20_000.0),
        true,
        "speed of the input shaft",
    ),
    ("temp_degc", TEMP, true, "oil in the sump"),
    (
        "torque_nm",
        TORQUE,
        false,
        "torque at the output shaft; 0 if absent",
    ),
    (
        "throttle",
        Bound::closed(0.0, 1.0),
        false,
        "throttle that the clamp law sees; 0 if absent",
    ),
    (
        "pressure_bar",
        PRESSURE,
        false,
        "secondary pressure; the clamp law's if absent",
    ),
    (
        "pressure_factor",
        Bound::closed(0.1, 3.0),
        false,
        "factor on the clamp law's pressure; 1 if absent",
    ),
    (
        "belt_degc",
        TEMP,
        false,
        "belt and spray; in steady state over the sump if absent",
    ),
    (
        "belt_above_sump_k",
        Bound::closed(-100.0, 100.0),
        false,
        "belt and spray above the sump, in place of belt_degc",
    ),
];

const BELT: [Axis; 9] = [
    (
        "ratio",
        Bound::closed(0.2, 5.0),
        true,
        "belt ratio I = R_sec / R_pri",
    ),
    ("speed_rpm", SPEED, true, "speed of the primary"),
    ("pressure_bar", PRESSURE, true, "secondary pressure"),
    (
        "belt_degc",
        TEMP,
        false,
        "belt; 85 degC without lift-off if absent",
    ),
    (
        "band_friction",
        FRICTION,
        false,
        "band friction at 85 degC; the fluid's, 0.13 in the printed forms, if absent",
    ),
    (
        "segment_friction",
        FRICTION,
        false,
        "segment friction; the fluid's, 0.125 or 0.13 in the printed forms, if absent",
    ),
    (
        "on_stop",
        Bound::closed(0.0, 1.0),
        false,
        "1: the primary leans on its end stop, 0: it deflects; the vehicle's ramp if absent",
    ),
    (
        "band_speed_share",
        Bound::closed(-0.5, 0.5),
        false,
        "adopted band speed from the mean, over the range of required speeds",
    ),
    ("torque_nm", TORQUE, true, "torque at the secondary pulley"),
];

const RUN: [Axis; 3] = [
    ("ambient_degc", AMBIENT, false, "ambient; 25 degC if absent"),
    (
        "start_degc",
        Bound::closed(-40.0, 150.0),
        false,
        "all temperatures at the start, in place of `start`",
    ),
    (
        "dt_s",
        Bound::closed(0.01, 10.0),
        false,
        "longest step; 1 s if absent",
    ),
];

const TRANSIENT: [Axis; 1] = [(
    "ratio",
    Bound::closed(0.2, 5.0),
    true,
    "belt ratio I = R_sec / R_pri",
)];

const STRIP_DOWN: [Axis; 3] = [
    (
        "ratio",
        Bound::closed(0.2, 5.0),
        false,
        "belt ratio; the rig's own two if absent",
    ),
    (
        "speed_rpm",
        Bound::closed(1.0, 20_000.0),
        false,
        "input speed; the rig's own if absent",
    ),
    (
        "temp_degc",
        TEMP,
        false,
        "oil in the sump; the rig's own if absent",
    ),
];

const FLUID: [Axis; 1] = [("temp_degc", TEMP, true, "temperature of the fluid")];

/// Most points of a source.
const MAX_POINTS: usize = 200_000;

fn axes(kind: Kind) -> &'static [Axis] {
    match kind {
        Kind::Bench => &BENCH,
        Kind::Belt => &BELT,
        Kind::Run => &RUN,
        Kind::Fluid => &FLUID,
        Kind::Transient => &TRANSIENT,
        Kind::StripDown => &STRIP_DOWN,
        Kind::Vehicle => &[],
    }
}

/// Reads all sources of a file; `common` are those of the common file, which a source may continue with `like`.
pub fn read(sources: &Section, common: &[Source]) -> Vec<Source> {
    let names = sources.names();
    // A source may continue another one of the same file, in any order.
    let mut done: Vec<Source> = Vec::new();
    let mut waiting: Vec<&str> = names.clone();
    loop {
        let before = waiting.len();
        waiting.retain(|name| {
            let section = sources.table(name);
            let like = section
                .optional_text("like", "source that this one continues")
                .unwrap_or_default();
            let base = done
                .iter()
                .chain(common)
                .find(|source| source.name == like)
                .cloned();
            if base.is_none() && !like.is_empty() {
                return true;
            }
            done.push(one(&section, name, base));
            false
        });
        if waiting.is_empty() {
            break;
        }
        if waiting.len() == before {
            for name in waiting {
                let known: Vec<&str> = done
                    .iter()
                    .chain(common)
                    .map(|source| source.name.as_str())
                    .collect();
                let hint = format!("known sources: {}", known.join(", "));
                sources.table(name).complain(
                    "like",
                    "the name of another source, not in a circle",
                    "there is no such source to continue",
                    &hint,
                );
                pass_over(&sources.table(name));
                done.push(empty(name, Kind::Vehicle));
            }
            break;
        }
    }
    done
}

/// Makes the paths of vehicles and fluids, which are relative to the file that names them, relative to the working directory.
pub fn resolve_paths(sources: &mut [Source], file: &str) {
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let named = sources.iter_mut();
    let named = named.flat_map(|source| [&mut source.vehicle, &mut source.lubricant]);
    for path in named.flatten().filter(|path| is_path(path)) {
        *path = folder.join(&*path).to_string_lossy().into_owned();
    }
}

/// Counts all keys of a source as read, where it is not known what they mean.
fn pass_over(s: &Section) {
    for key in s.names() {
        let _ = s.raw(key, "", "");
    }
}

fn one(s: &Section, name: &str, base: Option<Source>) -> Source {
    let Some(kind) = kind(s, base.as_ref()) else {
        pass_over(s);
        return empty(name, Kind::Vehicle);
    };
    let old = base.unwrap_or_else(|| empty(name, kind));
    let formulations: Vec<&'static str> =
        Formulation::NAMES.iter().map(|(name, _)| *name).collect();
    let formulation = if s.has("formulation") {
        let word = s.word_or(
            "formulation",
            &formulations,
            "smooth",
            "reading of the belt model",
        );
        Formulation::NAMES
            .iter()
            .find(|(name, _)| *name == word)
            .map(|(_, f)| *f)
            .unwrap_or_default()
    } else {
        old.formulation
    };
    let mut source = Source {
        name: name.to_owned(),
        place: s.place(if s.has("set") { "set" } else { "source" }),
        kind,
        vehicle: s
            .optional_text("vehicle", "vehicle; the one being validated if absent")
            .or(old.vehicle),
        lubricant: s
            .optional_text("lubricant", "transmission oil in place of the vehicle's")
            .or(old.lubricant),
        set: old
            .set
            .into_iter()
            .chain(s.overrides("set", "overrides KEY=VALUE of the vehicle and its fluids"))
            .collect(),
        formulation,
        ..old
    };
    for (key, bound, needed, doc) in axes(kind) {
        let given = s.grid(key, *bound, doc);
        let Some(slot) = source.axes.iter_mut().find(|(name, _)| name == key) else {
            continue;
        };
        slot.1 = given.or_else(|| slot.1.take());
        if *needed && slot.1.as_ref().is_none_or(Vec::is_empty) {
            s.complain(
                key,
                &bound.in_unit(unit_of(key)),
                &format!("source `{name}` has no `{key}`"),
                "give a number, a list or a range",
            );
        }
    }
    let count = source
        .axes
        .iter()
        .map(|(_, list)| list.as_ref().map_or(1, Vec::len))
        .fold(1_usize, usize::saturating_mul);
    if count > MAX_POINTS {
        s.complain(
            "source",
            &format!("up to {MAX_POINTS} points"),
            &format!("source `{name}` has {count} points"),
            "use wider steps",
        );
    }
    match kind {
        Kind::Bench if s.has("without") => source.without = without(s),
        Kind::Run => run(s, &mut source),
        _ => {}
    }
    source
}

/// What a source computes; none, and reported, if it does not say so.
fn kind(s: &Section, base: Option<&Source>) -> Option<Kind> {
    if !s.has("source") {
        if let Some(base) = base {
            return Some(base.kind);
        }
        if s.exists() {
            let words = Kind::NAMES.map(|(name, _)| name);
            s.complain(
                "source",
                &words.join(", "),
                "the source does not say what it computes",
                "add, for example, `source = \"bench\"`",
            );
        }
        return None;
    }
    let word = s.word_or(
        "source",
        &Kind::NAMES.map(|(name, _)| name),
        "",
        "what the source computes",
    );
    Kind::NAMES
        .iter()
        .find(|(name, _)| *name == word)
        .map(|(_, kind)| *kind)
}

/// A source of a kind with nothing set.
pub fn empty(name: &str, kind: Kind) -> Source {
    Source {
        name: name.to_owned(),
        place: Place::default(),
        kind,
        vehicle: None,
        lubricant: None,
        set: Vec::new(),
        formulation: Formulation::Smooth,
        axes: axes(kind).iter().map(|(key, ..)| (*key, None)).collect(),
        without: Vec::new(),
        cycle: "ece15_eudc".to_owned(),
        points: Vec::new(),
        start: "soak".to_owned(),
        phase: String::new(),
    }
}

/// Parts that can be taken out of the box.
const PARTS: [&str; 4] = ["final_drive", "belt", "reverse_clutch", "pump"];

/// Parts that are taken out of the box.
pub fn without(s: &Section) -> Vec<String> {
    let without = s.texts("without", "parts that are not in the box");
    for part in without
        .iter()
        .filter(|part| !PARTS.contains(&part.as_str()))
    {
        let message = format!("there is no part `{part}`");
        s.complain("without", &PARTS.join(", "), &message, "");
    }
    without
}

fn run(s: &Section, source: &mut Source) {
    if s.has("cycle") {
        source.cycle = s.text_or("cycle", "", "name of an embedded cycle or constant_V");
    }
    if s.has("points") {
        let columns = [
            ("time_s", Bound::closed(0.0, 1e5)),
            ("speed_kmh", Bound::closed(0.0, 300.0)),
        ];
        source.points = s.rows("points", &columns, "times and speeds in place of a cycle");
    }
    if s.has("start") {
        source.start = s
            .word_or(
                "start",
                &["soak", "warm"],
                "soak",
                "temperatures at the start",
            )
            .to_owned();
    }
    if s.has("phase") {
        source.phase = s.text_or("phase", "", "group of phases that counts");
    }
    match cycle(source) {
        Err(why) if !source.points.is_empty() => {
            let hint =
                "times rise by up to 3600 s, speeds are 0 to 300 km/h and change by up to 12 m/s2";
            s.complain("points", "rows [time s, speed km/h] of a cycle", &why, hint);
        }
        Err(why) => {
            let hint = did_you_mean(&source.cycle, names().iter().copied())
                .unwrap_or_else(|| "`cvtcycle list cycles` shows all".to_owned());
            s.complain("cycle", "the name of an embedded cycle, or constant_V with V in km/h, above 0 and up to 300", &why, &hint);
        }
        Ok(cycle) => {
            let groups: Vec<String> = cycle
                .phase_groups()
                .into_iter()
                .map(|(name, _)| name)
                .collect();
            if !source.phase.is_empty() && !groups.contains(&source.phase) {
                s.complain(
                    "phase",
                    &groups.join(", "),
                    &format!("the cycle has no phase `{}`", source.phase),
                    "",
                );
            }
        }
    }
}

/// The cycle of a run.
///
/// # Errors
/// There is no such cycle.
pub fn cycle(source: &Source) -> Result<Cycle, String> {
    if !source.points.is_empty() {
        let rows: Vec<String> = source
            .points
            .iter()
            .map(|row| format!("{},{}\n", row[0], row[1] * 3.6))
            .collect();
        let text = format!("time_s,speed_kmh\n{}", rows.concat());
        return read_csv("points.csv", text.as_bytes()).map_err(|problems| {
            problems
                .first()
                .map_or_else(String::new, |problem| problem.message.clone())
        });
    }
    if let Some(constant) = constant_speed(&source.cycle) {
        return constant.map_err(|problem| problem.message);
    }
    embedded(&source.cycle).ok_or_else(|| format!("there is no cycle named `{}`", source.cycle))
}

impl Source {
    /// Values of an axis in SI units, or the one given here.
    #[must_use]
    pub fn axis(&self, key: &str, default: f64) -> Vec<f64> {
        self.axis_or_none(key).unwrap_or_else(|| vec![default])
    }

    /// Values of an axis in SI units.
    #[must_use]
    pub fn axis_or_none(&self, key: &str) -> Option<Vec<f64>> {
        self.axes
            .iter()
            .find(|(name, _)| *name == key)
            .and_then(|(_, list)| list.clone())
    }

    /// Start temperature in K, where one is given.
    #[must_use]
    pub fn start_k(&self) -> Option<f64> {
        self.axis_or_none("start_degc")
            .and_then(|list| list.first().copied())
    }

    /// Ambient temperature, K.
    #[must_use]
    pub fn ambient_k(&self) -> f64 {
        self.axis("ambient_degc", 25.0 + ZERO_DEGC_K)
            .first()
            .copied()
            .unwrap_or(25.0 + ZERO_DEGC_K)
    }
}
