//! What the run was made from, for `inputs.json`.

use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::Conditions;
use cvtcycle::output::provenance::{car_record, cycle_record};
use cvtcycle::output::record::{Record, SCHEMA};
use cvtcycle::study::sensitivity::{Named, sensitivity};

use super::cars::Car;

/// Steps of a cycle up to which sensitivities come along unasked: they take some seven hundred drives.
const MOST_STEPS: usize = 20_000;

/// Whether sensitivities are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    Auto,
    Always,
    Never,
}

/// Words of the command line.
pub const WHEN: [(&str, When); 3] = [
    ("auto", When::Auto),
    ("always", When::Always),
    ("never", When::Never),
];

/// Words of the command line, for completions.
pub fn when() -> Vec<&'static str> {
    WHEN.iter().map(|(name, _)| *name).collect()
}

/// What the run was made from.
pub fn record(
    cars: &[Car],
    cycle: &Cycle,
    conditions: &Conditions,
    when: When,
) -> Result<Record, Problems> {
    let records = cars
        .iter()
        .map(|car| car_record(&car.name, &car.word, &car.options, &car.setup));
    let steps = cycle.trace_for(true).step_count(conditions.max_dt_s);
    let wanted = when == When::Always || (when == When::Auto && steps <= MOST_STEPS);
    let named = |car: &Car| Named {
        name: car.name.clone(),
        word: car.word.clone(),
        options: car.options.clone(),
    };
    let named: Vec<Named> = cars.iter().map(named).collect();
    Ok(Record {
        schema: SCHEMA,
        program: cvtcycle::output::PROGRAM.to_owned(),
        command: command(
            std::env::args_os()
                .skip(1)
                .map(|word| word.to_string_lossy().into_owned()),
        ),
        cycle: cycle_record(cycle),
        cars: records.collect::<Result<_, _>>()?,
        sensitivity: wanted
            .then(|| sensitivity(&named, cycle, conditions))
            .transpose()?,
    })
}

/// The command line, quoted for a shell.
fn command(words: impl Iterator<Item = String>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: String| {
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    ["cvtcycle".to_owned()]
        .into_iter()
        .chain(words.map(quoted))
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_spaces_and_quotes_are_quoted() {
        let words = ["run", "--set", "a.b=1", "--out", "it's here", ""];
        assert_eq!(
            command(words.iter().map(|w| (*w).to_owned())),
            "cvtcycle run --set a.b=1 --out 'it'\\''s here' ''"
        );
    }
}
