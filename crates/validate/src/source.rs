//! Sources of computed values, read from `[sources.NAME]`.

use std::borrow::Cow;
use std::path::Path;

use super::keys::{BeltKeys, BenchKeys, FluidKeys, RunKeys, StripDownKeys, TransientKeys};
use super::keys::{KINDS, RUN, SOURCE};
use cvtcycle_config::bounded::{SOURCE_ROWS, long_enough_s};
use cvtcycle_config::cycle::{CONSTANT, Cycle, constant_speed, names, read_csv, shared};
use cvtcycle_config::setup::is_path;
use cvtcycle_config::{Override, Place, Problem, Section, did_you_mean, unit_of};
use cvtcycle_model::keys::{Key, Presence, Values};
use cvtcycle_model::rig::transmission::MAX_DURATION_S;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Computation of a source.
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
    /// All, in the order of their words.
    const ALL: [Kind; 7] = [
        Kind::Bench,
        Kind::Belt,
        Kind::Run,
        Kind::Fluid,
        Kind::Transient,
        Kind::StripDown,
        Kind::Vehicle,
    ];

    /// Axes of a source of this kind; of the last the values run fastest.
    #[must_use]
    pub const fn axes(self) -> &'static [&'static Key<'static>] {
        match self {
            Kind::Bench => BenchKeys::TABLE.keys,
            Kind::Belt => BeltKeys::TABLE.keys,
            Kind::Run => RunKeys::TABLE.keys,
            Kind::Fluid => FluidKeys::TABLE.keys,
            Kind::Transient => TransientKeys::TABLE.keys,
            Kind::StripDown => StripDownKeys::TABLE.keys,
            Kind::Vehicle => &[],
        }
    }
}

/// One source, checked.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in the expressions.
    pub name: String,
    /// Place of its overrides, or of its kind.
    pub place: Place,
    /// Computation that it makes.
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
    /// Times and speeds of a run in place of a cycle, s and m/s.
    pub points: Vec<Vec<f64>>,
    /// Start of a run: `soak` or `warm`.
    pub start: &'static str,
    /// Group of phases of a run; empty for all.
    pub phase: String,
}

/// Parts that can be taken out of the box.
const PARTS: [&str; 4] = ["final_drive", "belt", "reverse_clutch", "pump"];

/// Reads all sources of a file; `common` are those of the common file, which a source may continue with `like`.
pub fn read(sources: &Section, common: &[Source]) -> Vec<Source> {
    let mut done: Vec<Source> = Vec::new();
    // A source may continue another one of the same file, in any order.
    let mut waiting = sources.names();
    while !waiting.is_empty() {
        let before = waiting.len();
        waiting.retain(|name| {
            let s = sources.table(name);
            let like = s.optional_text(&SOURCE.like).unwrap_or_default();
            let base = done.iter().chain(common).find(|base| base.name == like);
            let waits = base.is_none() && !like.is_empty();
            if !waits {
                done.push(one(&s, name, base.cloned()));
            }
            waits
        });
        if waiting.len() < before {
            continue;
        }
        for name in std::mem::take(&mut waiting) {
            let known = done.iter().chain(common).map(|source| &*source.name);
            let hint = format!("known sources: {}", known.collect::<Vec<_>>().join(", "));
            let allowed = "the name of another source, not in a circle";
            let message = "there is no such source to continue";
            let s = sources.table(name);
            s.unknown_name("like", allowed, message, &hint);
            s.pass_over();
            done.push(Source::new(name, Kind::Vehicle));
        }
    }
    done
}

/// Checks that the sources of a file do not have more rows together than are kept; what is computed once stays until the command ends.
///
/// # Errors
/// A problem at the source with which they pass the limit.
pub fn within_budget(sources: &[Source]) -> Result<(), Problem> {
    let mut sum = 0_usize;
    for source in sources {
        let rows = source.rows();
        sum = sum.saturating_add(rows);
        if sum <= SOURCE_ROWS {
            continue;
        }
        let alone = (source.kind == Kind::Run && rows > SOURCE_ROWS)
            .then(|| long_enough_s(rows, source.dt_s(), SOURCE_ROWS));
        let hint = match alone.flatten() {
            Some(step_s) => format!("take a dt_s of {step_s} or more"),
            None => "take a larger dt_s, wider steps, or fewer ratios".to_owned(),
        };
        let message = format!("the sources have {sum} rows together with this one");
        let problem = Problem::too_large(message)
            .allowed(format!("up to {SOURCE_ROWS} rows of all sources of a file"))
            .hint(hint);
        return Err(problem.at(source.place.clone()));
    }
    Ok(())
}

/// A path relative to the file that names it as one relative to the working directory; another word as it is.
pub fn relative_to(file: &str, word: &str) -> String {
    match Path::new(file).parent().filter(|_| is_path(word)) {
        Some(folder) => folder.join(word).to_string_lossy().into_owned(),
        None => word.to_owned(),
    }
}

/// Makes the paths of vehicles and fluids relative to the working directory.
pub fn resolve_paths(sources: &mut [Source], file: &str) {
    for source in sources {
        for word in [&mut source.vehicle, &mut source.lubricant]
            .into_iter()
            .flatten()
        {
            *word = relative_to(file, word);
        }
    }
}

fn one(s: &Section, name: &str, base: Option<Source>) -> Source {
    let Some(kind) = kind(s, base.as_ref()) else {
        // The keys of an unknown kind are skipped.
        s.pass_over();
        return Source::new(name, Kind::Vehicle);
    };
    let old = base.unwrap_or_else(|| Source::new(name, kind));
    let mut source = Source {
        name: name.to_owned(),
        place: s.place(if s.has("set") { "set" } else { "source" }),
        kind,
        vehicle: s.optional_text(&SOURCE.vehicle).or(old.vehicle),
        lubricant: s.optional_text(&SOURCE.lubricant).or(old.lubricant),
        ..old
    };
    source.set.extend(s.overrides(&SOURCE.set));
    if s.has("formulation") {
        let name = Values::word(s, &SOURCE.formulation);
        source.formulation = Formulation::named(name).unwrap_or_default();
    }
    for key in kind.axes() {
        let given = s.grid(key);
        let Some((_, values)) = source.axes.iter_mut().find(|(name, _)| *name == key.name) else {
            continue;
        };
        *values = given.or_else(|| values.take());
        let required = matches!(key.presence, Presence::RequiredIf(_));
        if required && values.as_ref().is_none_or(Vec::is_empty) {
            let message = format!("source `{name}` has no `{}`", key.name);
            let hint = "give a number, a list or a range";
            let allowed = key.range().in_unit(unit_of(key.name));
            s.missing(key.name, &allowed, &message, hint);
        }
    }
    match kind {
        Kind::Bench if s.has("without") => source.without = without(s, &SOURCE.without),
        Kind::Run => run(s, &mut source),
        _ => {}
    }
    source
}

/// Reads the kind of a source; `None`, and a problem, if it is missing.
fn kind(s: &Section, base: Option<&Source>) -> Option<Kind> {
    if s.has("source") {
        let word = Values::word(s, &SOURCE.source);
        let index = KINDS.iter().position(|choice| choice.name == word);
        return index.map(|k| Kind::ALL[k]);
    }
    if base.is_none() && s.exists() {
        let message = "the source does not say what it computes";
        let hint = "add, for example, `source = \"bench\"`";
        let allowed = KINDS.map(|choice| choice.name).join(", ");
        s.missing("source", &allowed, message, hint);
    }
    base.map(|base| base.kind)
}

/// Parts that are taken out of the box.
pub fn without(s: &Section, key: &Key) -> Vec<String> {
    let without = s.texts(key);
    for part in without.iter().filter(|part| !PARTS.contains(&&***part)) {
        let message = format!("there is no part `{part}`");
        s.unknown_name(key.name, &PARTS.join(", "), &message, "");
    }
    without
}

fn run(s: &Section, source: &mut Source) {
    if s.has("cycle") {
        source.cycle = Values::text(s, &SOURCE.cycle);
    }
    if s.has("points") {
        source.points = Values::rows(s, &SOURCE.points).unwrap_or_default();
    }
    if s.has("start") {
        source.start = Values::word(s, &SOURCE.start);
    }
    if s.has("phase") {
        source.phase = Values::text(s, &SOURCE.phase);
    }
    match cycle(source) {
        Err(why) if !source.points.is_empty() => {
            let hint =
                "times rise by up to 3600 s, speeds are 0 to 300 km/h and change by up to 12 m/s2";
            s.out_of_range("points", "rows [time s, speed km/h] of a cycle", &why, hint);
        }
        Err(why) => {
            let hint = did_you_mean(&source.cycle, names().iter().copied())
                .unwrap_or_else(|| "`cvtcycle list cycles` shows all".to_owned());
            let allowed = format!("the name of an embedded cycle, or {CONSTANT}");
            s.unknown_name("cycle", &allowed, &why, &hint);
        }
        Ok(cycle) => {
            let groups = phases(&cycle);
            if !source.phase.is_empty() && !groups.contains(&source.phase) {
                let message = format!("the cycle has no phase `{}`", source.phase);
                s.unknown_name("phase", &groups.join(", "), &message, "");
            }
        }
    }
}

/// Names of the groups of phases of a cycle.
pub fn phases(cycle: &Cycle) -> Vec<String> {
    cycle
        .phase_groups()
        .into_iter()
        .map(|(name, _)| name)
        .collect()
}

/// The cycle of a run.
///
/// # Errors
/// There is no such cycle.
pub fn cycle(source: &Source) -> Result<Cow<'static, Cycle>, String> {
    if !source.points.is_empty() {
        let row = |row: &Vec<f64>| format!("{},{}\n", row[0], row[1] * 3.6);
        let rows: String = source.points.iter().map(row).collect();
        let text = format!("time_s,speed_kmh\n{rows}");
        let cycle = read_csv("points.csv", text.as_bytes());
        return cycle
            .map(Cow::Owned)
            .map_err(|mut problems| problems.remove(0).message);
    }
    if let Some(constant) = constant_speed(&source.cycle) {
        return constant.map(Cow::Owned).map_err(|problem| problem.message);
    }
    shared(&source.cycle)
        .map(Cow::Borrowed)
        .ok_or_else(|| format!("there is no cycle named `{}`", source.cycle))
}

impl Source {
    /// A source of a kind with nothing set.
    pub fn new(name: &str, kind: Kind) -> Source {
        Source {
            name: name.to_owned(),
            place: Place::default(),
            kind,
            vehicle: None,
            lubricant: None,
            set: Vec::new(),
            formulation: Formulation::Smooth,
            axes: kind.axes().iter().map(|key| (key.name, None)).collect(),
            without: Vec::new(),
            cycle: "ece15_eudc".to_owned(),
            points: Vec::new(),
            start: "soak",
            phase: String::new(),
        }
    }

    /// Values of an axis in SI units: the key's default, or NaN, where none are given.
    #[must_use]
    pub fn axis(&self, key: &Key) -> Vec<f64> {
        self.given(key).unwrap_or_else(|| match key.presence {
            Presence::Number(default) => vec![key.quantity.to_si(default)],
            _ => vec![f64::NAN],
        })
    }

    /// The values of an axis that are given, in SI units.
    #[must_use]
    pub fn given(&self, key: &Key) -> Option<Vec<f64>> {
        let own = self.axes.iter().find(|(name, _)| *name == key.name);
        own.and_then(|(_, list)| list.clone())
    }

    /// The first value of a setting of a run; NaN where there is none.
    fn first(&self, key: &Key) -> f64 {
        self.axis(key).first().copied().unwrap_or(f64::NAN)
    }

    /// Rows of its table, found without computing it; of tests that end by themselves as many as they may have.
    #[must_use]
    pub fn rows(&self) -> usize {
        let lengths = self
            .axes
            .iter()
            .map(|(_, list)| list.as_ref().map_or(1, Vec::len));
        let points = lengths.fold(1_usize, usize::saturating_mul);
        match self.kind {
            Kind::Vehicle => 0,
            Kind::Run => cycle(self).map_or(0, |cycle| {
                let count = |automatic| cycle.trace_for(automatic).step_count(self.dt_s());
                count(false).max(count(true))
            }),
            // Warming and cooling, a row a second.
            Kind::Transient => points.saturating_mul(2 * MAX_DURATION_S as usize),
            Kind::Bench | Kind::Belt | Kind::Fluid | Kind::StripDown => points,
        }
    }

    /// Start temperature in K, where one is given.
    #[must_use]
    pub fn start_k(&self) -> Option<f64> {
        Some(self.first(&RUN.start_degc)).filter(|k| !k.is_nan())
    }

    /// Ambient temperature, K.
    #[must_use]
    pub fn ambient_k(&self) -> f64 {
        self.first(&RUN.ambient_degc)
    }

    /// Longest step, s.
    #[must_use]
    pub fn dt_s(&self) -> f64 {
        self.first(&RUN.dt_s)
    }
}
