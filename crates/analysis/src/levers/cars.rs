//! The cars of a lever study: which levers each can have, and what is wrong with the others.

use rayon::prelude::*;

use super::{Lever, LeverRequest, options};
use cvtcycle_config::setup::{self, Setup, name_of};
use cvtcycle_config::{Input, Problem, Problems};

/// A car with the levers that it can have.
pub(super) struct LeverCar {
    /// Name or path of its file.
    pub word: String,
    /// Name, unique within the study.
    pub name: String,
    /// True if the car has a CVT.
    pub is_cvt: bool,
    /// Indices of its levers.
    pub levers: Vec<usize>,
}

/// Why a car cannot have a lever.
enum Useless {
    /// It is for the other box.
    OtherBox,
    /// The car has it already.
    NothingChanges,
    /// No car can be built with it.
    Bad(Problems),
}

/// The cars, with a sentence on each lever that one of them cannot have. It is a problem where no car can have a lever that the user has
/// named, or a car none at all.
pub(super) fn cars(
    request: &LeverRequest,
    problems: &mut Problems,
) -> (Vec<LeverCar>, Vec<String>) {
    let mut cars: Vec<LeverCar> = Vec::new();
    let mut useless: Vec<Vec<(String, Useless)>> = Vec::new();
    useless.resize_with(request.levers.len(), Vec::new);
    for word in &request.vehicles {
        let plain = options(&request.base, std::iter::empty());
        let Some(base) = problems.take(setup::load(word, &plain)) else {
            continue;
        };
        let name = unique(word, &cars);
        let of_car = request.levers.par_iter();
        let found: Vec<_> = of_car
            .map(|lever| try_lever(request, word, &base, lever))
            .collect();
        let mut levers = Vec::new();
        for (k, found) in found.into_iter().enumerate() {
            match found {
                Ok(()) => levers.push(k),
                // A lever that the user has named gets its row, of no change.
                Err(Useless::NothingChanges) if request.levers[k].is_named => {
                    levers.push(k);
                    useless[k].push((name.clone(), Useless::NothingChanges));
                }
                Err(why) => useless[k].push((name.clone(), why)),
            }
        }
        cars.push(LeverCar {
            word: word.clone(),
            name,
            is_cvt: base.transmission().is_cvt(),
            levers,
        });
    }
    let mut notes = Vec::new();
    for (k, (lever, useless)) in request.levers.iter().zip(useless).enumerate() {
        let is_used = cars.iter().any(|car| car.levers.contains(&k));
        if lever.is_named && !is_used && !cars.is_empty() {
            let of = useless.into_iter().flat_map(|(_, why)| refused(lever, why));
            of.for_each(|problem| problems.add(problem));
            continue;
        }
        // That shipped levers of the other box do not fit goes without saying.
        let is_said = |why: &Useless| lever.is_named || !matches!(why, Useless::OtherBox);
        let said = useless.iter().filter(|(_, why)| is_said(why));
        notes.extend(said.map(|(car, why)| noted(lever, car, why)));
    }
    if problems.is_empty() && !request.levers.is_empty() {
        problems.extend(
            cars.iter()
                .filter(|car| car.levers.is_empty())
                .map(none_left),
        );
    }
    (cars, notes)
}

/// Checks that a car can have a lever, and that the lever changes it.
fn try_lever(
    request: &LeverRequest,
    word: &str,
    base: &Setup,
    lever: &Lever,
) -> Result<(), Useless> {
    let is_cvt = base.transmission().is_cvt();
    if lever.of_cvt.is_some_and(|cvt| cvt != is_cvt) {
        return Err(Useless::OtherBox);
    }
    let with = options(&request.base, std::iter::once(lever));
    let changed = setup::load(word, &with).map_err(Useless::Bad)?;
    let values = |setup: &Setup| -> Vec<(String, String)> {
        let keys = setup.keys.iter();
        keys.map(|info| (info.key.clone(), info.value.clone()))
            .collect()
    };
    match values(base) == values(&changed) {
        true => Err(Useless::NothingChanges),
        false => Ok(()),
    }
}

/// The problems of a lever that no car can have.
fn refused(lever: &Lever, why: Useless) -> Problems {
    let name = &lever.name;
    match why {
        Useless::OtherBox => {
            let [own, other] = boxes(lever);
            Problem::wrong_transmission(format!("lever {name} is for cars with a {own}"))
                .at(lever.place.clone())
                .key("lever.name")
                .value(name.as_str())
                .hint(format!("name a vehicle without a {other}, or other levers"))
                .into()
        }
        Useless::NothingChanges => Problems::new(),
        Useless::Bad(problems) => problems.map(|problem| in_lever(lever, problem)),
    }
}

/// A problem of a lever's change, with its place in the lever's file.
pub(super) fn in_lever(lever: &Lever, problem: Problem) -> Problem {
    let place = match &problem.place.input {
        Input::File(_) => return problem,
        Input::Argument(_) => lever.place.clone(),
        Input::Override(text) => lever.set_place.clone().of_item(text),
    };
    let of = format!("lever {}: ", lever.name);
    problem.at(place).with_context(&of)
}

fn noted(lever: &Lever, car: &str, why: &Useless) -> String {
    let name = &lever.name;
    match why {
        Useless::OtherBox => {
            let [own, _] = boxes(lever);
            format!("{car}: without {name}, which is for cars with a {own}")
        }
        Useless::NothingChanges => {
            format!("{car}: {name} changes nothing in it, the car has these values")
        }
        Useless::Bad(problems) => {
            let first = problems
                .first()
                .map_or("", |problem| problem.message.as_str());
            format!("{car}: without {name}: {first}")
        }
    }
}

/// The box that a lever is for, and the other one.
fn boxes(lever: &Lever) -> [&'static str; 2] {
    match lever.of_cvt {
        Some(true) => ["CVT", "manual gearbox"],
        _ => ["manual gearbox", "CVT"],
    }
}

fn none_left(car: &LeverCar) -> Problem {
    Problem::conflict(format!("`{}` can have none of the levers", car.name))
        .at(cvtcycle_config::Argument::Vehicle)
        .value(car.word.as_str())
        .hint("name a lever file for such a car: `cvtcycle list levers`")
}

/// A name that no other car has.
fn unique(word: &str, cars: &[LeverCar]) -> String {
    let name = name_of(word);
    let is_free = |name: &String| cars.iter().all(|car| !car.name.eq_ignore_ascii_case(name));
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut all = std::iter::once(name.clone()).chain(numbered);
    all.find(is_free).unwrap_or_default()
}
