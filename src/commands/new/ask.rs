//! Interactive questions for catalogue numbers.

use std::io::{self, BufRead, Write};

use cvtcycle::config::setup::new_car::{
    Answers, ClassOf, Question, USUAL, engine_mistake, mistake, named_engines, questions,
    road_load_default, technologies, years,
};
use cvtcycle::config::{Problem, Problems};

use crate::args::problems::{did_you_mean, problem};

/// Prompts for class and box, then for each missing number. An empty line accepts the default in brackets; the end of the
/// input leaves the remaining numbers unset.
/// # Errors
/// Unknown class or car, failing input or output.
pub fn ask(
    answers: &mut Answers,
    in_terminal: bool,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> Result<(), Problems> {
    let failed = |error: io::Error| {
        let message = format!("the questions could not be asked: {error}");
        problem("--ask", &message, "give the numbers as options")
    };
    if answers.like.is_none() {
        for (is_box, usual) in [false, true].into_iter().zip(USUAL) {
            let slot = if is_box {
                &mut answers.gearbox
            } else {
                &mut answers.class
            };
            if slot.is_none() {
                let known = match is_box {
                    true => ClassOf::Box.names(),
                    false => ClassOf::Body.names(),
                };
                let kind = if is_box { "box" } else { "class" };
                let prompt = format!("{kind}: {} [{usual}]", known.join(", "));
                let check = |word: &str| match known.contains(&word) {
                    true => None,
                    false => Some(
                        Problem::unknown_name(format!("there is no {kind} named `{word}`"))
                            .hint(did_you_mean(word, &known)),
                    ),
                };
                *slot = answer(&prompt, true, check, in_terminal, input, output).map_err(failed)?;
            }
        }
    }
    ask_engine(answers, in_terminal, input, output).map_err(failed)?;
    for question in questions(answers)? {
        // Coefficients that are those of a class are of the body.
        let has_load = ["f0", "f1", "f2"]
            .iter()
            .any(|name| answers.numbers.contains_key(name));
        let is_load = question.name == "road-load";
        if is_load && !has_load {
            continue;
        }
        let question = match is_load {
            true => Question {
                usual: Some(road_load_default(answers)),
                ..question
            },
            false => question,
        };
        let usual = question.usual.as_deref().unwrap_or("needed");
        let prompt = format!("{}: {} [{usual}]", question.name, question.meaning);
        let check = |text: &str| mistake(answers, question.name, text);
        let found = answer(
            &prompt,
            question.usual.is_some(),
            check,
            in_terminal,
            input,
            output,
        );
        if let Some(text) = found.map_err(failed)? {
            answers.numbers.insert(question.name, text);
        }
    }
    Ok(())
}

/// Prompts for the technology of the engine, or a measured one, and for its year.
fn ask_engine(
    answers: &mut Answers,
    in_terminal: bool,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> io::Result<()> {
    let usual = match answers.like {
        Some(_) => "that of the car",
        None => "that of the class",
    };
    if answers.engine.is_none() && answers.engine_like.is_none() && answers.engine_year.is_none() {
        let (kinds, named) = (technologies(), named_engines());
        let prompt = format!(
            "engine: technology {}, or measured {} [{usual}]",
            kinds.join(", "),
            named.join(", ")
        );
        let known: Vec<&str> = kinds.iter().chain(&named).copied().collect();
        let check = |word: &str| match known.contains(&word) {
            true => None,
            false => Some(
                Problem::unknown_name(format!("there is no engine named `{word}`"))
                    .hint(did_you_mean(word, &known)),
            ),
        };
        match answer(&prompt, true, check, in_terminal, input, output)? {
            Some(word) if kinds.contains(&word.as_str()) => answers.engine = Some(word),
            word => answers.engine_like = word,
        }
    }
    let Some(technology) = answers.engine.clone() else {
        return Ok(());
    };
    if answers.engine_year.is_none() {
        let years: Vec<String> = years(&technology).iter().map(u16::to_string).collect();
        let newest = years.last().map_or("", String::as_str);
        let prompt = format!(
            "engine-year: year of the engine; there are sets of {} [{newest}]",
            years.join(", ")
        );
        let check = |text: &str| {
            engine_mistake(&Answers {
                engine_year: Some(text.to_owned()),
                ..answers.clone()
            })
        };
        answers.engine_year = answer(&prompt, true, check, in_terminal, input, output)?;
    }
    Ok(())
}

/// Prompts once. None for an empty line, or at the end of the input.
fn answer(
    prompt: &str,
    may_be_empty: bool,
    check: impl Fn(&str) -> Option<Problem>,
    in_terminal: bool,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> io::Result<Option<String>> {
    loop {
        write!(output, "{prompt}: ")?;
        output.flush()?;
        let mut line = String::new();
        // Limits the length, since a longer line cannot be a number.
        let length = io::Read::take(&mut *input, 1000).read_line(&mut line)?;
        // In a terminal the user's Enter ends the prompt's line.
        if length == 0 || !in_terminal {
            writeln!(output)?;
        }
        if length == 0 {
            return Ok(None);
        }
        let text = line.trim();
        if text.is_empty() && may_be_empty {
            return Ok(None);
        }
        match check(text) {
            _ if text.is_empty() => {}
            None => return Ok(Some(text.to_owned())),
            Some(found) => {
                let parts = [found.message, found.allowed, found.hint].into_iter();
                let parts: Vec<String> = parts.filter(|part| !part.is_empty()).collect();
                writeln!(output, "  {}", parts.join("; "))?;
            }
        }
    }
}
