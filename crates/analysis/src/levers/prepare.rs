//! Levers, cars and ambient temperatures to the columns of a study.
//!
//! Each car at each ambient temperature has a reference, the car as it is, and a column for each lever and each combination. Columns
//! of one point have the same draw. A lever that gives a key a value leaves the factor of that key out of its own draw and out of that of
//! its reference, so that the doubt about a value which the lever replaces is no doubt about the lever; levers that leave the same factors
//! out share a reference.

use super::cars::{LeverCar, cars};
use super::combine::{Combination, Nominal, check, combinations};
use super::request::{ColumnNote, LeverNotes, LeverRequest};
use super::{Lever, options};
use crate::draws::{Given, OtherCar, OtherKind, with_knowledge};
use cvtcycle_config::setup::load;
use cvtcycle_config::{Problem, Problems};
use cvtcycle_study::execute::outputs::FUEL;
use cvtcycle_study::execute::{Column, Columns, Study, idle, relative};
use cvtcycle_study::plan::{Base, Design, Factor, Plan, RUN_OPTIONS};

/// A column's car with its changes.
struct Change<'r> {
    name: String,
    title: String,
    kind: &'static str,
    levers: Vec<&'r Lever>,
}

/// The study of some levers.
///
/// # Errors
/// All problems of plan, cars, levers and combinations.
///
/// ```
/// use cvtcycle_config::setup::Options;
/// use cvtcycle_analysis::levers::{Combine, LeverFile, LeverRequest, prepare};
/// let text = "[[lever]]\nname = \"lighter\"\nset = [\"road_load.mass_kg*=0.9\"]\n";
/// let study = prepare(&LeverRequest {
///     levers: LeverFile::read("own.toml", text)?.levers,
///     vehicles: vec!["rover_216_cvt".to_owned()],
///     ambients_degc: vec![-10.0, 25.0],
///     cycle: "ece15".to_owned(),
///     start: "soak".to_owned(),
///     dt_s: 1.0,
///     base: Options::default(),
///     set_all: Vec::new(),
///     others: Vec::new(),
///     draws: None,
///     combine: Combine::None,
///     heard_rpm: 1300.0,
/// })?;
/// assert_eq!(study.cars.len(), 4, "the car as it is and the lighter one, at both temperatures");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn prepare(request: &LeverRequest) -> Result<Study, Problems> {
    let mut problems = Problems::new();
    let plan = problems.take(plan_of(request));
    let (cars, mut notes) = cars(request, &mut problems);
    check(request, &cars, &mut problems);
    let Some((mut plan, of_cvt)) = plan else {
        return Err(problems);
    };
    problems.finish()?;
    let plain = options(&request.base, std::iter::empty());
    let own = cars.iter().map(|car| load(&car.word, &plain));
    let others = request.others.iter();
    let others = others.filter(|other| other.kind == OtherKind::Baseline);
    let others = others.map(|other| load(&other.word, &other.options));
    let setups = own.chain(others).collect::<Result<Vec<_>, _>>()?;
    let given = Given {
        set_all: &request.set_all,
        set: &request.base.set,
        is_like_subject: cars.first().is_some_and(|car| car.is_cvt == of_cvt),
    };
    if request.draws.is_some() {
        let setups: Vec<_> = setups.iter().collect();
        plan = with_knowledge(plan, of_cvt, &setups, &given);
    }
    let mut columns = Builder {
        request,
        plan: &plan,
        of_cvt,
        list: Vec::new(),
        notes: Vec::new(),
    };
    for car in &cars {
        let found = nominal(request, &plan, car)?;
        let (combinations, left) = combinations(request, car, &found);
        notes.extend(left);
        columns.add(car, &combinations);
    }
    let Builder {
        list,
        notes: columns,
        ..
    } = columns;
    let about = |notes: &[String], columns: &[ColumnNote]| {
        let about = LeverNotes {
            plan: request.draws.as_ref().map(|(plan, ..)| plan.file.clone()),
            heard_rpm: request.heard_rpm,
            columns: columns.to_vec(),
            notes: notes.to_vec(),
        };
        serde_json::to_value(about).unwrap_or_default()
    };
    let mut study = Study::of_columns(
        plan,
        Columns {
            list,
            heard_rpm: request.heard_rpm,
            about: about(&[], &[]),
        },
    )?;
    notes.extend(skipped(&study, &columns));
    study.levers = Some(about(&notes, &columns));
    Ok(study)
}

/// The plan whose factors are drawn, under the conditions of the request, and whether its subject has a CVT.
fn plan_of(request: &LeverRequest) -> Result<(Plan, bool), Problems> {
    let (plan, of_cvt) = match &request.draws {
        None => (nominal_plan()?, true),
        Some((plan, samples, seed)) => {
            let varies = |factor: &&Factor| RUN_OPTIONS.contains(&factor.key.as_str());
            let of_option = |factor: &Factor| {
                Problem::conflict(format!("the plan varies `{}`", factor.key))
                    .at(factor.place.clone())
                    .key("key")
                    .value(factor.key.as_str())
                    .hint("levers are driven under conditions of their own: take a plan of keys of cars")
            };
            let problems: Problems = plan.factors.iter().filter(varies).map(of_option).collect();
            problems.finish()?;
            let (plan, of_cvt) = relative(plan.clone())?;
            let design = Design::LatinHypercube {
                samples: *samples,
                seed: *seed,
            };
            (Plan { design, ..plan }, of_cvt)
        }
    };
    let base = Base {
        vehicle: request.vehicles.join(", "),
        baselines: Some(Vec::new()),
        cycle: request.cycle.clone(),
        ambient_degc: request.ambients_degc.first().copied().unwrap_or(f64::NAN),
        start: request.start.clone(),
        lubricant: request.base.lubricant.clone(),
        engine_oil: request.base.engine_oil.clone(),
        set: request.base.set.clone(),
        formulation: request.base.formulation,
        dt_s: request.dt_s,
        ..Base::default()
    };
    // The cycle is the request's: its path does not begin at the plan's folder.
    let file = "levers".to_owned();
    let title = format!("Levers of {}", base.vehicle);
    let (question, analyse) = (String::new(), Vec::new());
    Ok((
        Plan {
            base,
            file,
            title,
            question,
            analyse,
            ..plan
        },
        of_cvt,
    ))
}

/// The plan of cars as their files have them.
fn nominal_plan() -> Result<Plan, Problems> {
    Plan::read(
        "levers",
        "[study]\ntitle = \"as built\"\ndesign = \"grid\"\n",
    )
}

/// Each lever of a car by itself, without draws.
fn nominal(request: &LeverRequest, plan: &Plan, car: &LeverCar) -> Result<Vec<Nominal>, Problems> {
    let own = LeverRequest {
        others: Vec::new(),
        ..request.clone()
    };
    if car.levers.is_empty() {
        return Ok(Vec::new());
    }
    let without = Plan {
        factors: Vec::new(),
        design: Design::Grid,
        ..plan.clone()
    };
    let mut builder = Builder {
        request: &own,
        plan: &without,
        of_cvt: true,
        list: Vec::new(),
        notes: Vec::new(),
    };
    builder.add(car, &[]);
    let Builder { list, notes, .. } = builder;
    let columns = Columns {
        list,
        heard_rpm: request.heard_rpm,
        about: serde_json::Value::Null,
    };
    let runs = Study::of_columns(without.clone(), columns)?.first_point(FUEL);
    let of_lever = |lever: &usize| {
        let name = &request.levers[*lever].name;
        let own = notes
            .iter()
            .enumerate()
            .filter(|(_, note)| note.kind == "lever" && note.name == *name);
        let change = |(k, note): (usize, &ColumnNote)| {
            let (fuel, is_good) = runs[k];
            (100.0 * (fuel / runs[note.reference].0 - 1.0), is_good)
        };
        let all: Vec<(f64, bool)> = own.map(change).collect();
        Nominal {
            lever: *lever,
            percent: all.iter().map(|(x, _)| x).sum::<f64>() / all.len() as f64,
            is_good: all.iter().all(|(_, good)| *good),
        }
    };
    Ok(car.levers.iter().map(of_lever).collect())
}

/// Gathers columns.
struct Builder<'r> {
    request: &'r LeverRequest,
    plan: &'r Plan,
    /// True if the subject of the plan has a CVT: cars without one are varied as its baselines.
    of_cvt: bool,
    list: Vec<Column>,
    notes: Vec<ColumnNote>,
}

impl<'r> Builder<'r> {
    /// All columns of a car.
    fn add(&mut self, car: &LeverCar, combinations: &[Combination]) {
        let request = self.request;
        let single = car.levers.iter().map(|k| {
            let lever = &request.levers[*k];
            Change {
                name: lever.name.clone(),
                title: lever.title.clone(),
                kind: "lever",
                levers: vec![lever],
            }
        });
        let together = combinations.iter().map(|of| Change {
            name: of.name.clone(),
            title: of.name.clone(),
            kind: "combination",
            levers: of.members.iter().map(|k| &request.levers[*k]).collect(),
        });
        let changes: Vec<Change> = single.chain(together).collect();
        for ambient_degc in &request.ambients_degc {
            // Left out factors with the column of their reference.
            let plain = self.reference(car, *ambient_degc, 0, &[]);
            let is_first = request.vehicles.first() == Some(&car.word);
            for other in request.others.iter().filter(|_| is_first) {
                self.other(car, *ambient_degc, (other, plain));
            }
            let mut references = vec![(Vec::new(), plain)];
            for change in &changes {
                let left_out = self.left_out(change);
                let known = references.iter().find(|(of, _)| *of == left_out);
                let reference = match known {
                    Some((_, reference)) => *reference,
                    None => {
                        let reference =
                            self.reference(car, *ambient_degc, references.len(), &left_out);
                        references.push((left_out.clone(), reference));
                        reference
                    }
                };
                self.push(car, *ambient_degc, change, (reference, left_out));
            }
        }
    }

    /// Factors whose keys a change gives a value.
    fn left_out(&self, change: &Change) -> Vec<usize> {
        let factors = self.plan.factors.iter().enumerate();
        let is_fixed =
            |(_, factor): &(usize, &Factor)| change.levers.iter().any(|l| l.fixes(factor));
        factors.filter(is_fixed).map(|(f, _)| f).collect()
    }

    fn reference(
        &mut self,
        car: &LeverCar,
        ambient_degc: f64,
        before: usize,
        left_out: &[usize],
    ) -> usize {
        let name = match before {
            0 => "reference".to_owned(),
            n => format!("reference_{}", n + 1),
        };
        let change = Change {
            title: "the car as it is".to_owned(),
            kind: "reference",
            levers: Vec::new(),
            name,
        };
        let own = self.list.len();
        self.push(car, ambient_degc, &change, (own, left_out.to_vec()));
        own
    }

    /// A car that is compared with the reference.
    fn other(&mut self, car: &LeverCar, ambient_degc: f64, (other, reference): (&OtherCar, usize)) {
        let kind = other.kind.name().to_owned();
        let set = other.options.set.iter().map(ToString::to_string).collect();
        self.notes.push(ColumnNote {
            vehicle: car.name.clone(),
            ambient_degc,
            kind: kind.clone(),
            name: other.name.clone(),
            title: other.name.clone(),
            reference,
            members: Vec::new(),
            set,
            left_out: Vec::new(),
            group: String::new(),
            needs: String::new(),
            status: String::new(),
            source: String::new(),
        });
        self.list.push(Column {
            name: format!("{}/{ambient_degc}/{kind}/{}", car.name, other.name),
            role: kind,
            word: other.word.clone(),
            is_subject: other.is_cvt == self.of_cvt,
            ambient_degc,
            options: other.options.clone(),
            left_out: Vec::new(),
            is_watched: false,
        });
    }

    fn push(
        &mut self,
        car: &LeverCar,
        ambient_degc: f64,
        change: &Change,
        (reference, left_out): (usize, Vec<usize>),
    ) {
        let levers = || change.levers.iter().copied();
        let name_of = |f: &usize| self.plan.factors[*f].name.clone();
        let texts = levers().flat_map(|lever| {
            let oils = [
                ("lubricant", &lever.lubricant),
                ("engine_oil", &lever.engine_oil),
            ];
            let oils = oils.into_iter();
            let oils = oils.filter_map(|(key, word)| Some(format!("{key}={}", word.as_ref()?)));
            lever.set.iter().map(ToString::to_string).chain(oils)
        });
        let only = |text: fn(&Lever) -> String| match change.levers.as_slice() {
            [lever] if change.kind == "lever" => text(lever),
            _ => String::new(),
        };
        let members = levers().map(|lever| lever.name.clone());
        let is_together = change.kind == "combination";
        self.notes.push(ColumnNote {
            vehicle: car.name.clone(),
            ambient_degc,
            kind: change.kind.to_owned(),
            name: change.name.clone(),
            title: change.title.clone(),
            reference,
            members: members.filter(|_| is_together).collect(),
            set: texts.collect(),
            left_out: left_out.iter().map(name_of).collect(),
            group: only(|lever| lever.group.clone().unwrap_or_default()),
            needs: only(|lever| lever.needs.clone()),
            status: only(|lever| lever.status.clone()),
            source: only(|lever| lever.source.clone()),
        });
        let name = format!("{}/{ambient_degc}/{}", car.name, change.name);
        self.list.push(Column {
            name,
            role: change.kind.to_owned(),
            word: car.word.clone(),
            is_subject: car.is_cvt == self.of_cvt,
            ambient_degc,
            options: options(&self.request.base, levers()),
            left_out,
            is_watched: !self.request.levers.is_empty(),
        });
    }
}

/// A sentence on the factors that do not act on a car, and on each whose draws are held at the ends of its range.
fn skipped(study: &Study, columns: &[ColumnNote]) -> Vec<String> {
    let factors = &study.plan.factors;
    let mut notes: Vec<String> = Vec::new();
    let first = &columns.first().map(|column| column.ambient_degc);
    for (car, column) in study.cars.iter().zip(columns) {
        if column.name != "reference" || Some(column.ambient_degc) != *first {
            continue;
        }
        let vehicle = &column.vehicle;
        notes.extend(idle(vehicle, car, factors));
        notes.extend(study.held(car).into_iter().map(|(f, draws)| {
            format!(
                "{vehicle}: {draws} draws of {} are held at the end of its range",
                factors[f].name
            )
        }));
    }
    notes
}
