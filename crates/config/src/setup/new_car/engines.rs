//! The class of an engine, by technology and year or by the name of a measured engine.

use super::{Answers, ClassOf, ENGINE};
use crate::Problem;
use crate::problem::near::suggest;

/// Years of engines.
const YEARS: std::ops::RangeInclusive<u16> = 1980..=2030;
/// Years behind the newest set of a technology from which a year has its note: engines of one design are built for some ten years.
const LATER: u16 = 10;

/// A class of an engine, with what there is to say of the choice.
pub(super) struct EngineClass {
    pub class: String,
    pub note: Option<String>,
}

/// Technology and year of a class; none of a measured engine and of what is no engine.
fn parts(class: &str) -> Option<(&str, u16)> {
    let (technology, year) = class.strip_prefix(ENGINE)?.rsplit_once('_')?;
    let year = year.parse().ok().filter(|year| YEARS.contains(year))?;
    Some((technology, year))
}

/// The technologies of which there are classes, such as `pfi`.
#[must_use]
pub fn technologies() -> Vec<&'static str> {
    let mut all: Vec<&str> = Vec::new();
    for (technology, _) in ClassOf::Engine.names().into_iter().filter_map(parts) {
        if !all.contains(&technology) {
            all.push(technology);
        }
    }
    all
}

/// The measured engines, by the names of their classes without `engine_`.
#[must_use]
pub fn named_engines() -> Vec<&'static str> {
    let names = ClassOf::Engine.names().into_iter();
    let named = names.filter(|class| parts(class).is_none());
    named
        .filter_map(|class| class.strip_prefix(ENGINE))
        .collect()
}

/// Years of the sets of a technology, the oldest first.
#[must_use]
pub fn years(technology: &str) -> Vec<u16> {
    let classes = ClassOf::Engine.names().into_iter().filter_map(parts);
    let mut years: Vec<u16> = classes
        .filter(|(of, _)| *of == technology)
        .map(|(_, year)| year)
        .collect();
    years.sort_unstable();
    years
}

/// Problem of technology, year or measured engine of some answers.
#[must_use]
pub fn engine_mistake(answers: &Answers) -> Option<Problem> {
    class(answers).err()
}

/// Class of a technology and year.
///
/// # Errors
/// An engine that is not known, a year that is none, and two engines at once.
pub(super) fn class(answers: &Answers) -> Result<Option<EngineClass>, Problem> {
    if let Some(name) = &answers.engine_like {
        if answers.engine.is_some() || answers.engine_year.is_some() {
            let problem = Problem::conflict("a measured engine and a technology at once");
            return Err(problem.key("engine-like").hint("give one of them"));
        }
        let known = named_engines();
        let own = name.strip_prefix(ENGINE).unwrap_or(name);
        return match known.contains(&own) {
            true => Ok(Some(EngineClass {
                class: format!("{ENGINE}{own}"),
                note: None,
            })),
            false => Err(unknown(name, "engine-like", "measured engine", &known)),
        };
    }
    let Some(technology) = &answers.engine else {
        return match &answers.engine_year {
            None => Ok(None),
            Some(year) => Err(
                Problem::missing("a year of an engine without its technology")
                    .key("engine-year")
                    .value(year)
                    .allowed(technologies().join(", "))
                    .hint("give the technology as well"),
            ),
        };
    };
    let year = answers.engine_year.as_deref().map(year_of).transpose()?;
    let classes = ClassOf::Engine.names().into_iter();
    let mut sets: Vec<(u16, &str)> = classes
        .filter_map(|class| Some((parts(class)?, class)))
        .filter(|((of, _), _)| of == technology)
        .map(|((_, year), class)| (year, class))
        .collect();
    sets.sort_unstable();
    let (Some(oldest), Some(newest)) = (sets.first(), sets.last()) else {
        return Err(unknown(
            technology,
            "engine",
            "technology of an engine",
            &technologies(),
        ));
    };
    let chosen = year.and_then(|year| sets.iter().rfind(|(from, _)| *from <= year));
    let (class, note) = match (year, chosen) {
        (None, _) => {
            let note = format!(
                "engine: {}, the newest of its kind; with a year, that of the year",
                newest.1
            );
            (newest.1, Some(note))
        }
        (Some(year), Some((from, class))) => {
            let is_late = *class == newest.1 && year > from + LATER;
            let note = || {
                format!(
                    "engine: {class} is the newest of its kind, and of engines {} years older than {year}: those of {year} may burn less",
                    year - from
                )
            };
            (*class, is_late.then(note))
        }
        (Some(year), None) => {
            let note = format!(
                "engine: {} is the oldest of its kind, and newer than {year}",
                oldest.1
            );
            (oldest.1, Some(note))
        }
    };
    Ok(Some(EngineClass {
        class: class.to_owned(),
        note,
    }))
}

fn year_of(text: &str) -> Result<u16, Problem> {
    let year = text.trim().parse().ok().filter(|year| YEARS.contains(year));
    year.ok_or_else(|| {
        Problem::wrong_type("this is no year of an engine")
            .key("engine-year")
            .value(text)
            .allowed(format!("{} to {}", YEARS.start(), YEARS.end()))
            .hint("write it as 2018")
    })
}

fn unknown(name: &str, option: &str, what: &str, known: &[&str]) -> Problem {
    Problem::unknown_name(format!("there is no {what} named `{name}`"))
        .key(option)
        .value(name)
        .allowed(known.join(", "))
        .hint(suggest(name, known))
}
