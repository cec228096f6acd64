//! Combinations of levers.

use super::cars::LeverCar;
use super::{Lever, LeverRequest, options};
use cvtcycle_config::{Problem, ProblemKind, Problems, did_you_mean, setup};

/// Key of the problems of combinations, which have no place: they are no part of a file.
pub const COMBINE: &str = "combine";

/// Combinations that are driven besides the single levers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Combine {
    /// The levers that save fuel and go together, the best of each group.
    Automatic,
    /// These, by name.
    Lists(Vec<Vec<String>>),
    /// None.
    None,
}

/// A lever in a car as its file has it.
pub(super) struct Nominal {
    /// Index of the lever.
    pub lever: usize,
    /// Change of the fuel, mean of the ambient temperatures.
    pub percent: f64,
    /// True if no run failed.
    pub is_good: bool,
}

/// A combination of a car.
pub(super) struct Combination {
    /// Name in the table.
    pub name: String,
    /// Indices of its levers.
    pub members: Vec<usize>,
}

/// The combinations of a car, with a sentence on each lever that the automatic one leaves out although it saves fuel.
pub(super) fn combinations(
    request: &LeverRequest,
    car: &LeverCar,
    nominal: &[Nominal],
) -> (Vec<Combination>, Vec<String>) {
    match &request.combine {
        Combine::None => (Vec::new(), Vec::new()),
        Combine::Automatic => automatic(request, car, nominal),
        Combine::Lists(lists) => {
            let of_car = |list: &Vec<String>| {
                let index = |name: &String| request.levers.iter().position(|l| l.name == *name);
                let members: Option<Vec<usize>> = list.iter().map(index).collect();
                let members = members?;
                let has_all = members.iter().all(|k| car.levers.contains(k));
                has_all.then(|| Combination {
                    name: list.join("+"),
                    members,
                })
            };
            (lists.iter().filter_map(of_car).collect(), Vec::new())
        }
    }
}

/// The levers that save fuel by themselves, from the one that saves most on, each if it goes together with those before it.
fn automatic(
    request: &LeverRequest,
    car: &LeverCar,
    nominal: &[Nominal],
) -> (Vec<Combination>, Vec<String>) {
    let saves = |of: &&Nominal| of.is_good && of.percent < 0.0 && request.levers[of.lever].combine;
    let mut candidates: Vec<&Nominal> = nominal.iter().filter(saves).collect();
    candidates.sort_by(|a, b| a.percent.total_cmp(&b.percent));
    let mut members: Vec<usize> = Vec::new();
    let mut notes = Vec::new();
    for candidate in candidates {
        let lever = &request.levers[candidate.lever];
        let taken = || members.iter().map(|k| &request.levers[*k]);
        let same_group = |other: &&Lever| lever.group.is_some() && other.group == lever.group;
        if taken().any(|other| same_group(&other)) {
            continue;
        }
        let clash = taken().find_map(|other| Some((other, lever.clash(other)?)));
        let why = match clash {
            Some((other, why)) => Some(format!("{} with {}: {why}", lever.name, other.name)),
            None => together(request, car, taken().chain([lever]))
                .map(|why| format!("{}: {why}", lever.name)),
        };
        match why {
            Some(why) => notes.push(format!("{}: not in the combination: {why}", car.name)),
            None => members.push(candidate.lever),
        }
    }
    let combination = Combination {
        name: "combination".to_owned(),
        members,
    };
    match combination.members.len() {
        0 | 1 => (Vec::new(), notes),
        _ => (vec![combination], notes),
    }
}

/// Why a car cannot have some levers at once.
fn together<'l>(
    request: &LeverRequest,
    car: &LeverCar,
    levers: impl Iterator<Item = &'l Lever>,
) -> Option<String> {
    let options = options(&request.base, levers);
    let problems = setup::load(&car.word, &options).err()?;
    problems.first().map(|problem| problem.message.clone())
}

/// Checks the combinations that the user names.
pub(super) fn check(request: &LeverRequest, cars: &[LeverCar], problems: &mut Problems) {
    let Combine::Lists(lists) = &request.combine else {
        return;
    };
    for list in lists {
        let text = list.join("+");
        let names = || request.levers.iter().map(|lever| lever.name.as_str());
        let mut refuse = |kind, message: String, hint: String| {
            let problem = Problem::new(kind, message).key(COMBINE);
            problems.add(problem.value(text.as_str()).hint(hint));
        };
        let mut levers: Vec<(usize, &Lever)> = Vec::new();
        for name in list {
            match request
                .levers
                .iter()
                .enumerate()
                .find(|(_, lever)| lever.name == *name)
            {
                Some((k, _)) if levers.iter().any(|(other, _)| *other == k) => {
                    let message = format!("`{name}` is named twice");
                    refuse(ProblemKind::Duplicate, message, "name it once".to_owned());
                }
                Some(found) => levers.push(found),
                None => {
                    let hint = did_you_mean(name, names());
                    let message = format!("there is no lever named `{name}`");
                    let all =
                        || format!("the levers are {}", names().collect::<Vec<_>>().join(", "));
                    refuse(ProblemKind::UnknownName, message, hint.unwrap_or_else(all));
                }
            }
        }
        for (n, (_, lever)) in levers.iter().enumerate() {
            for (_, other) in &levers[..n] {
                if let Some(why) = lever.clash(other) {
                    let message = format!(
                        "{} and {} do not go together: {why}",
                        other.name, lever.name
                    );
                    refuse(ProblemKind::Conflict, message, "leave one out".to_owned());
                }
            }
        }
        let has_all = |car: &&LeverCar| levers.iter().all(|(k, _)| car.levers.contains(k));
        let mut able = cars.iter().filter(has_all).peekable();
        if able.peek().is_none() && !cars.is_empty() {
            let message = "no vehicle can have all of them".to_owned();
            refuse(ProblemKind::Conflict, message, "leave some out".to_owned());
        }
        for car in able {
            if let Some(why) = together(request, car, levers.iter().map(|(_, lever)| *lever)) {
                let message = format!("{}: {why}", car.name);
                refuse(ProblemKind::Conflict, message, "leave one out".to_owned());
            }
        }
    }
}
