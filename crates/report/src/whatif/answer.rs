//! Answers a state of the levers: drives all cars, and formats the sentences of a run and figures of the subject against another car.

use std::collections::BTreeMap;
use std::sync::Arc;

use cvtcycle_analysis::draws::{Draws, prepare};
use cvtcycle_analysis::words::run::{
    assess_fleet, contradicted, contradictions, maps_left, sentences,
};
use cvtcycle_config::cycle::{self, Cycle};
use cvtcycle_config::setup::{
    NamedBy, Options, Setup, TWIN, is_same_vehicle, is_twin, load, name_of,
};
use cvtcycle_config::{Override, Problem, Problems, carried};
use cvtcycle_model::drive::{Conditions, Outcome, drive};
use cvtcycle_output::History;
use cvtcycle_output::history::known;
use cvtcycle_output::summary::{
    Contradiction, DrawnDifference, Driven, Settings, StartWord, Summary, UNCHANGED,
    find_maps_left, summarise,
};
use cvtcycle_study::plan::Base;

use super::controls::car_controls;
use super::scene::{DRAWS, Scene};
use super::{command, words};
use crate::charts::decision::waterfall;
use crate::charts::figures::{CarLosses, Overlay, OverlayPanel, loss_by_component, overlay};
use crate::document::{Block, Section};
use crate::live_section::{Answer, Control, ControlKind, State};
use crate::number::Quantity;
use crate::render;
use crate::run::{Car, brief, conditions_line, per_km, strip};

/// Maximum number of cached cars with their outcomes, from the last states.
const KEPT: usize = 24;
/// Trace columns used by the figures.
const COLUMNS: [&str; 3] = ["time_s", "dt_s", "transmission_sump_degc"];

/// A page with its cached results.
pub struct LivePage {
    scene: Scene,
    controls: Vec<Control>,
    /// Cached cars by word, options and conditions.
    driven: BTreeMap<String, Arc<DrivenCar>>,
    cycle: Option<(String, Cycle)>,
    /// Draws in progress, with their state.
    draws: Option<(State, Draws)>,
}

struct DrivenCar {
    setup: Setup,
    outcome: Outcome,
}

/// The cars of a state, driven.
struct Drives {
    wanted: Vec<CarRequest>,
    cars: Vec<Arc<DrivenCar>>,
    names: Vec<String>,
    cycle: Cycle,
    conditions: Conditions,
    start: StartWord,
    settings: Settings,
}

impl Drives {
    fn driven(&self) -> Vec<Driven<'_>> {
        let cars = self.cars.iter().zip(&self.names);
        let driven = cars.map(|(car, name)| Driven {
            name,
            setup: &car.setup,
            outcome: &car.outcome,
        });
        driven.collect()
    }

    fn summary(&self, state: &State, driven: &[Driven]) -> Summary {
        let (start, settings) = (self.start.clone(), self.settings.clone());
        let mut found = summarise(&self.cycle, state.ambient_degc, start, settings, driven);
        for (run, car) in found.runs.iter_mut().zip(&self.wanted) {
            if car.of_file {
                UNCHANGED.clone_into(&mut run.role);
            }
        }
        find_maps_left(&mut found, &self.cycle, &self.conditions, driven);
        found
    }
}

/// A car to drive: its word, its options, and the word by which a command names it.
struct CarRequest {
    word: String,
    options: Options,
    named: String,
    /// True for the subject as in its file.
    of_file: bool,
}

impl LivePage {
    /// Reads the levers of the subject.
    ///
    /// # Errors
    /// Problems of the subject.
    pub fn new(scene: Scene) -> Result<Self, Problems> {
        let options = scene.subject(&State::default(), &[])?;
        Ok(LivePage {
            controls: car_controls(&scene.vehicle, &options)?,
            scene,
            driven: BTreeMap::new(),
            cycle: None,
            draws: None,
        })
    }

    /// As [`LivePage::new`] within a page, which reads files from the scene.
    ///
    /// # Errors
    /// As of [`LivePage::new`]; a damaged page.
    pub fn open(scene: Scene) -> Result<Self, Problems> {
        carried::carry(scene.files()?);
        LivePage::new(scene)
    }

    /// The levers, in the order of the page.
    pub fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Answers a state, with the intervals of its differences if known.
    pub fn answer(&mut self, state: &State, drawn: Option<Vec<DrawnDifference>>) -> Answer {
        self.driven_answer(state, drawn)
            .unwrap_or_else(|problems| Answer {
                html: render::live(&refused(&problems), self.scene.first_figure),
                failed: true,
                ..Answer::default()
            })
    }

    /// As [`LivePage::answer`], for a valid state, with all of its draws.
    ///
    /// # Errors
    /// Problems of the cars and of the cycle.
    pub fn drawn_answer(
        &mut self,
        state: &State,
    ) -> Result<(Answer, Option<Vec<DrawnDifference>>), Problems> {
        let first = self.driven_answer(state, None)?;
        if !first.can_draw {
            return Ok((first, None));
        }
        let drawn = loop {
            if let Some(drawn) = self.draw(state)? {
                break drawn;
            }
        };
        Ok((self.driven_answer(state, Some(drawn.clone()))?, Some(drawn)))
    }

    /// Drives the next part of a state's draws; returns the differences after the last one.
    ///
    /// # Errors
    /// Problems of the cars.
    pub fn draw(&mut self, state: &State) -> Result<Option<Vec<DrawnDifference>>, Problems> {
        let begun = self
            .draws
            .take()
            .filter(|(begun_state, _)| begun_state == state);
        let mut draws = match begun {
            Some((_, draws)) => draws,
            None => Draws::new(self.study(state)?),
        };
        let found = draws.advance()?;
        let found = found.map(|list| -> Vec<DrawnDifference> {
            list.into_iter().map(|(_, drawn)| drawn).collect()
        });
        if found.is_none() {
            self.draws = Some((state.clone(), draws));
        }
        Ok(found)
    }

    /// Published numbers that the initial state contradicts.
    ///
    /// # Errors
    /// Problems of the cars and of the cycle.
    pub fn contradicted(&mut self) -> Result<Vec<Contradiction>, Problems> {
        let state = self.scene.state.clone();
        let moved = self.moved(&state)?;
        let drives = self.drives(&state, &moved)?;
        let driven = drives.driven();
        let StartWord::Word(start) = &drives.start else {
            return Ok(Vec::new());
        };
        let summary = drives.summary(&state, &driven);
        Ok(contradicted(&summary, start, &driven, None))
    }

    /// Drives the cars of a state.
    fn drives(&mut self, state: &State, moved: &[Override]) -> Result<Drives, Problems> {
        let wanted = self.wanted(state, moved)?;
        let (start, word) = self.scene.start()?;
        let conditions = Conditions {
            ambient_k: state.ambient_k()?,
            start,
            max_dt_s: self.scene.dt_s,
            keep_rows: true,
        };
        let own = load(&wanted[0].word, &wanted[0].options)?;
        let cycle = cycle::for_car(&state.cycle, self.cycle(&state.cycle)?, &own);
        let mut own = Some(own);
        let mut cars = Vec::new();
        for car in &wanted {
            cars.push(self.car(car, own.take(), &cycle, &conditions)?);
        }
        Ok(Drives {
            names: names(&wanted),
            settings: Settings {
                dt_s: self.scene.dt_s,
                formulation: self.scene.formulation.clone(),
                ..Settings::default()
            },
            wanted,
            cars,
            cycle,
            conditions,
            start: word,
        })
    }

    fn study(&self, state: &State) -> Result<cvtcycle_study::Study, Problems> {
        let scene = &self.scene;
        let moved = self.moved(state)?;
        let [set_all, own] = scene.overrides()?;
        let baselines = scene.baselines.iter().map(|word| match is_twin(word) {
            true => TWIN.to_owned(),
            false => word.clone(),
        });
        let base = Base {
            vehicle: scene.vehicle.clone(),
            baselines: Some(baselines.collect()),
            cycle: state.cycle.clone(),
            ambient_degc: state.ambient_degc,
            start: scene.start.clone(),
            lubricant: state.lubricant.clone(),
            engine_oil: scene.engine_oil.clone(),
            set: own.into_iter().chain(moved).collect(),
            set_all,
            dt_s: scene.dt_s,
            formulation: scene.formulation(),
        };
        prepare(&base, DRAWS)
    }

    /// Overrides of the moved levers, in the order of the page.
    fn moved(&self, state: &State) -> Result<Vec<Override>, Problem> {
        let mut all = Vec::new();
        for control in &self.controls {
            let Some(value) = state.levers.get(&control.name) else {
                continue;
            };
            match &control.kind {
                ControlKind::Slider(slider) => all.push(Override::new(slider.key, value)?),
                ControlKind::Choice(changes) => {
                    let change = changes.iter().find(|change| change.name == *value);
                    let unknown = || {
                        Problem::unknown_name(format!("there is no change `{value}`"))
                            .key(&*control.name)
                    };
                    all.extend(change.ok_or_else(unknown)?.set.iter().cloned());
                }
            }
        }
        Ok(all)
    }

    /// Cars of a state: the subject, the car of its file if different, and the baselines.
    fn wanted(&self, state: &State, moved: &[Override]) -> Result<Vec<CarRequest>, Problem> {
        let scene = &self.scene;
        let options = scene.subject(state, moved)?;
        let [set_all, own] = scene.overrides()?;
        let plain = Options {
            lubricant: None,
            set: set_all,
            ..options.clone()
        };
        let of_file = |options| CarRequest {
            word: scene.vehicle.clone(),
            options,
            named: scene.vehicle.clone(),
            of_file: true,
        };
        let is_moved = !(moved.is_empty() && own.is_empty() && state.lubricant.is_none());
        let baseline = |word: &String| CarRequest {
            word: word.clone(),
            // A twin is derived from the subject as driven.
            options: match is_twin(word) {
                true => options.of_twin(NamedBy::File),
                false => plain.clone(),
            },
            named: if is_twin(word) { TWIN } else { word }.to_owned(),
            of_file: false,
        };
        let first = CarRequest {
            of_file: false,
            ..of_file(options.clone())
        };
        let reference = is_moved.then(|| of_file(plain.clone()));
        let is_other = |word: &&String| !is_moved || !is_same_vehicle(word, &scene.vehicle);
        let baselines = scene.baselines.iter().filter(is_other).map(baseline);
        Ok([first]
            .into_iter()
            .chain(reference)
            .chain(baselines)
            .collect())
    }

    /// Returns a car of a state from the cache, or drives it.
    fn car(
        &mut self,
        car: &CarRequest,
        loaded: Option<Setup>,
        cycle: &Cycle,
        conditions: &Conditions,
    ) -> Result<Arc<DrivenCar>, Problems> {
        let (word, options, of_file) = (&car.word, &car.options, car.of_file);
        let key = format!(
            "{word}\n{options:?}\n{of_file}\n{}\n{conditions:?}",
            cycle.name
        );
        if let Some(known) = self.driven.get(&key) {
            return Ok(Arc::clone(known));
        }
        let mut setup = match loaded {
            Some(setup) => setup,
            None => load(&car.word, &car.options)?,
        };
        if of_file {
            setup.short += " as it is";
        }
        let outcome = drive(&setup, cycle, conditions);
        let made = Arc::new(DrivenCar { setup, outcome });
        if self.driven.len() >= KEPT {
            self.driven.clear();
        }
        self.driven.insert(key, Arc::clone(&made));
        Ok(made)
    }

    /// Loads the cycle of a state.
    fn cycle(&mut self, word: &str) -> Result<Cycle, Problems> {
        if let Some((known, cycle)) = &self.cycle
            && known == word
        {
            return Ok(cycle.clone());
        }
        let cycle = cycle::find(word)?;
        self.cycle = Some((word.to_owned(), cycle.clone()));
        Ok(cycle)
    }

    fn driven_answer(
        &mut self,
        state: &State,
        drawn: Option<Vec<DrawnDifference>>,
    ) -> Result<Answer, Problems> {
        let moved = self.moved(state)?;
        let drives = self.drives(state, &moved)?;
        let driven = drives.driven();
        let mut found = drives.summary(state, &driven);
        let Drives { wanted, cycle, .. } = &drives;
        found.take_drawn(drawn.unwrap_or_default());
        if *state == self.scene.state {
            found.contradicted.clone_from(&self.scene.contradicted);
        }
        assess_fleet(&mut found);
        let histories = driven.iter().map(|car| history(car, cycle));
        let histories: Vec<History> = histories.collect();
        let section = self.section(state, &found, &histories, cycle, wanted);
        let [_, own] = self.scene.overrides()?;
        let set = own.iter().chain(&moved).map(Override::to_string);
        // `run` compares a change with the car of the file by itself, unless there is to be no baseline.
        let others = &wanted[1..];
        let is_alone = others.iter().all(|car| car.of_file);
        let named = others.iter().filter(|car| is_alone || !car.of_file);
        let named = named.map(|car| car.named.clone());
        Ok(Answer {
            html: render::live(&section, self.scene.first_figure),
            command: command::command(
                &self.scene,
                state,
                &set.collect::<Vec<_>>(),
                &named.collect::<Vec<_>>(),
            ),
            can_draw: found.runs.len() > 1,
            failed: false,
        })
    }

    /// Builds the sentences and figures.
    fn section(
        &self,
        state: &State,
        found: &Summary,
        histories: &[History],
        cycle: &Cycle,
        wanted: &[CarRequest],
    ) -> Section {
        let mut section = Section::new("live", "");
        let labelled = found.labelled();
        let said = sentences(&labelled);
        section
            .blocks
            .extend(said.first().cloned().map(Block::Lead));
        let of_file = found.runs.iter().zip(wanted).skip(1);
        let of_file = of_file.filter(|(_, car)| car.of_file).map(|(run, _)| run);
        let subject = &found.runs[0];
        let alerts = words::flags(subject, of_file.clone().next())
            .into_iter()
            .chain(words::beyond(&self.controls, state))
            .chain(maps_left(&labelled))
            .chain(contradictions(&labelled));
        alerts.for_each(|line| section.alert(line));
        words::needs(&self.controls, state)
            .into_iter()
            .for_each(|line| section.text(line));
        let name = brief(&cycle.title);
        strip(&mut section, found, name);
        let car = |k: usize| {
            Some(Car {
                run: found.runs.get(k)?,
                record: None,
                history: histories.get(k),
            })
        };
        let mut others = wanted.iter().skip(1);
        let other = others.position(|car| car.named == state.against);
        let pair = [car(0), car(other.unwrap_or(0) + 1)];
        let pair: Vec<Car> = pair.into_iter().flatten().collect();
        let conditions = format!("{name}, {}", conditions_line(found));
        figures(&mut section, &pair, &conditions);
        section
    }
}

/// Unique names of the cars, as in a run.
fn names(wanted: &[CarRequest]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for car in wanted {
        let name = name_of(&car.word);
        let numbered = (2..).map(|n| format!("{name}_{n}"));
        let mut all = std::iter::once(name.clone()).chain(numbered);
        let is_free = |name: &String| names.iter().all(|other| !other.eq_ignore_ascii_case(name));
        names.push(all.find(is_free).unwrap_or_default());
    }
    names
}

fn history(car: &Driven, cycle: &Cycle) -> History {
    let phases = match cycle.phases.is_empty() {
        true => std::slice::from_ref(&cycle.name),
        false => &cycle.phases,
    };
    History::from_rows(&car.outcome.rows, &known(COLUMNS.into_iter()), phases)
}

/// Adds the fuel waterfall, losses and sump temperature of the subject, against another car if there is one.
fn figures(section: &mut Section, pair: &[Car], conditions: &str) {
    if let [subject, other] = pair {
        let energies = per_km(subject, other);
        let [own, from] = &energies.names;
        let caption = format!("Energy over distance from the fuel of {from} to that of {own}.");
        section.figure("live_waterfall", caption, waterfall(&energies, conditions));
    }
    let losses = pair.iter().map(|car| CarLosses {
        name: car.run.label().to_owned(),
        losses_kj: car.losses_kj(),
        distance_km: car.run.distance_km,
    });
    let picture = loss_by_component(&losses.collect::<Vec<_>>(), conditions);
    section.figure(
        "live_losses",
        "Losses of the transmission over the whole cycle.",
        picture,
    );
    let sump = |car: &Car| -> Vec<(f64, f64)> {
        let history = car.history;
        history.map_or_else(Vec::new, |history| {
            let degc = history.column(COLUMNS[2]).iter().copied();
            thinned(history.time_s().iter().copied().zip(degc).collect())
        })
    };
    let ends = pair.iter().filter_map(|car| {
        let end = sump(car).last()?.1;
        Some(format!("{} {}", car.run.label(), Quantity::Degc.text(end)))
    });
    let title = format!("Sump at the end: {}", ends.collect::<Vec<_>>().join(", "));
    let mut runs = pair.iter();
    let mut next = || {
        runs.next()
            .map(|car| (car.run.label().to_owned(), sump(car)))
    };
    let (first, second) = (next().unwrap_or_default(), next().unwrap_or_default());
    let picture = overlay(&Overlay {
        title,
        subject: conditions.to_owned(),
        names: [first.0, second.0],
        panels: vec![OverlayPanel {
            title: "Transmission sump".to_owned(),
            unit: "degC",
            runs: [first.1, second.1],
        }],
    });
    section.figure(
        "live_sump",
        "Temperature of the transmission sump over the cycle.",
        picture,
    );
}

/// Maximum number of drawn moments of the sump's temperature: enough for so smooth a curve, since each costs time at every move of a lever.
const MOMENTS: usize = 120;

/// Thins points by a constant factor, keeping the last one.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(MOMENTS).max(1);
    let last = points.len().saturating_sub(1);
    let kept = points.into_iter().enumerate();
    let kept = kept.filter(|(k, _)| k.is_multiple_of(every) || *k == last);
    kept.map(|(_, point)| point).collect()
}

/// Section with the problems of a car that cannot be built.
fn refused(problems: &Problems) -> Section {
    let mut section = Section::new("live", "");
    for problem in problems {
        let allowed = match problem.allowed.as_str() {
            "" => String::new(),
            allowed => format!(" (allowed: {allowed})"),
        };
        let key = if problem.key.is_empty() { "" } else { ": " };
        let (name, message) = (&problem.key, &problem.message);
        section.alert(format!("No such car: {name}{key}{message}{allowed}"));
    }
    section
}
