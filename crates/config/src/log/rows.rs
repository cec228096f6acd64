//! Rows of a log in the order of their times, each stamp once.

use super::choose::{Chosen, Reading, Source};
use super::fill::{Filled, telling};
use super::repair::{made, number_of};
use super::samples::Samples;
use super::{Reader, Refused, propose, smooth};
use crate::channel::Quantity;
use crate::{Problem, Setting, readable};
use cvtcycle_model::cycle::Repair;

/// Stamps above are no seconds of a drive, but milliseconds or less since 1970.
const MAX_STAMP_S: f64 = 1e11;
/// Steps of a recording from here on leave no drive, s.
const MAX_STEP_S: f64 = 60.0;
/// Stamps of several rows that are farther apart have no seconds, s.
const COARSE_STAMP_S: f64 = 2.5;
/// Longest drive, s.
const MAX_DURATION_S: f64 = 1e6;

impl Reader<'_, '_> {
    /// Rows with a time and a speed, and the values of the other channels.
    pub(super) fn samples(
        &self,
        filled: &Filled,
        (time, speed): (usize, usize),
        others: usize,
        repairs: &mut Vec<Repair>,
    ) -> Result<(Samples, Vec<Vec<f64>>), Refused> {
        let (times, speeds) = (&filled.values[time], &filled.values[speed]);
        let rows: Vec<usize> = (0..times.len())
            .filter(|k| times[*k].is_finite() && speeds[*k].is_finite())
            .collect();
        let empty = filled.empty + times.len() - rows.len();
        let all = empty + rows.len();
        if empty > 0 {
            let text = format!("{empty} of {all} rows without a time or a speed");
            if !self.columns.repairs().empty {
                let problem = Problem::missing(text)
                    .in_file(self.file)
                    .key("speed")
                    .hint("let the repair `empty` leave them out");
                return Err(Refused::known(problem));
            }
            repairs.push(made("empty", empty, format!("{text} left out")));
        }
        if rows.len() < 2 {
            let problem = Problem::missing("fewer than two rows have a time and a speed")
                .in_file(self.file)
                .allowed("at least two rows");
            return Err(Refused::known(problem));
        }
        let pick = |values: &Vec<f64>| rows.iter().map(|k| values[*k]).collect::<Vec<f64>>();
        let mut time_s = pick(times);
        if self.sheet.is_trace() {
            // Means are the values of the middles of their steps, of which those at a gear change are short. The first step begins at 0.
            let mut begin_s = 0.0;
            for time in &mut time_s {
                let end_s = *time;
                *time = 0.5 * (begin_s + end_s);
                begin_s = end_s;
            }
        }
        let samples = Samples {
            time_s,
            speed_m_s: pick(speeds),
            lines: rows.iter().map(|k| filled.lines[*k]).collect(),
            first_m_s: Vec::new(),
        };
        Ok((samples, filled.values[others..].iter().map(pick).collect()))
    }

    /// Puts the rows in order, or says why they cannot be.
    pub(super) fn order(
        &self,
        samples: &mut Samples,
        others: &mut [Vec<f64>],
        chosen: &Chosen,
        leading: (&Source, &Source),
        repairs: &mut Vec<Repair>,
    ) -> Result<(), Refused> {
        let wanted = self.columns.repairs();
        let falls: Vec<usize> = (1..samples.time_s.len())
            .filter(|k| samples.time_s[*k] < samples.time_s[k - 1])
            .collect();
        if let Some(trip) = chosen.trip {
            let ends: Vec<usize> = [0]
                .into_iter()
                .chain(falls.iter().copied())
                .chain([samples.time_s.len()])
                .collect();
            let Some(range) = ends
                .windows(2)
                .nth(trip - 1)
                .map(|ends| ends[0]..ends[1])
                .filter(|range| range.len() > 1)
            else {
                let problem =
                    Problem::out_of_range(format!("there is no trip {trip} with two rows"))
                        .in_file(self.file);
                return Err(Refused::known(
                    problem.allowed(format!("1 to {}", ends.len() - 1)),
                ));
            };
            samples.time_s = samples.time_s[range.clone()].to_vec();
            samples.speed_m_s = samples.speed_m_s[range.clone()].to_vec();
            samples.lines = samples.lines[range.clone()].to_vec();
            others
                .iter_mut()
                .for_each(|other| *other = other[range.clone()].to_vec());
        } else if let Some(first) = falls.first() {
            let is_set = samples.is_clock_set(&falls);
            if wanted.cut && is_set {
                let back_s = samples.run_on(&falls);
                let text = format!(
                    "the clock was set back {} by {} s in all: it runs on",
                    times(falls.len()),
                    readable(back_s, 1)
                );
                repairs.push(made("cut", falls.len(), text));
            } else if wanted.sort {
                let moved = samples.sort(others);
                repairs.push(made(
                    "sort",
                    moved,
                    format!(
                        "{} put in the order of their times",
                        number_of(moved, "row")
                    ),
                ));
            } else {
                return Err(self.falls(samples, &falls, *first, chosen, leading));
            }
        }
        self.merge(samples, others, chosen, leading, repairs)
    }

    /// Makes one row of those with the same stamp, or says why that cannot be.
    fn merge(
        &self,
        samples: &mut Samples,
        others: &mut [Vec<f64>],
        chosen: &Chosen,
        leading: (&Source, &Source),
        repairs: &mut Vec<Repair>,
    ) -> Result<(), Refused> {
        let doubled = samples
            .time_s
            .windows(2)
            .filter(|pair| pair[1] <= pair[0])
            .count();
        if doubled == 0 {
            return Ok(());
        }
        if !self.columns.repairs().stamps {
            let problem = Problem::conflict(format!(
                "{} with the stamp of the row above",
                number_of(doubled, "row")
            ))
            .in_file(self.file)
            .key("time");
            return Err(Refused::known(
                problem.hint("let the repair `stamps` make one row of them"),
            ));
        }
        // Words by which each stamp is there once are those of several cars, also where they drive alike.
        let cars =
            telling(self.sheet, leading.0, true).filter(|_| 5 * doubled > samples.time_s.len());
        let are_words = |(_, values): &(usize, Vec<(String, usize)>)| {
            values
                .iter()
                .all(|(value, _)| value.parse::<f64>().is_err())
        };
        if let Some((column, values)) = cars.as_ref().filter(|cars| are_words(cars)) {
            return Err(self.several(*column, values, chosen, leading));
        }
        let before = samples.clone();
        let distinct = samples
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0);
        if let Some(step) = smooth::median(distinct.collect())
            .filter(|step| *step > COARSE_STAMP_S && 2 * doubled > before.time_s.len())
        {
            let message = format!(
                "{} with the stamp of the row above, and the stamps are {} s apart",
                number_of(doubled, "row"),
                readable(step, 1)
            );
            let problem = Problem::conflict(message)
                .key("time")
                .allowed("stamps with seconds");
            let problem =
                problem.hint("write the stamps with seconds, or take another column as the time");
            return Err(Refused::known(self.problem(before.lines[1], problem)));
        }
        match samples.merge(others) {
            Ok(_) if samples.time_s.len() < 2 => {
                let problem = Problem::missing("all rows have the same stamp")
                    .in_file(self.file)
                    .key("time")
                    .allowed("at least two stamps");
                Err(Refused::known(problem))
            }
            Ok(gone) => {
                // The first of the rows above it with its stamp.
                let is_first = |k: &usize| {
                    before.time_s[*k] <= before.time_s[k - 1]
                        && (*k == 1 || before.time_s[k - 1] > before.time_s[k - 2])
                };
                let means = (1..before.time_s.len()).filter(is_first).count();
                let have = if means == 1 { "has" } else { "have" };
                repairs.push(made(
                    "stamps",
                    gone,
                    format!(
                        "{} of a stamp that is there already, {} {have} the mean of theirs",
                        number_of(gone, "row"),
                        number_of(means, "stamp")
                    ),
                ));
                Ok(())
            }
            Err(_) if cars.is_some() => {
                let (column, values) = cars.unwrap_or_default();
                Err(self.several(column, &values, chosen, leading))
            }
            Err(at) => {
                let [a, b] = [at - 1, at].map(|k| readable(3.6 * before.speed_m_s[k], 1));
                let message = format!(
                    "{} with the stamp of the row above, here with {a} and {b} km/h",
                    number_of(doubled, "row")
                );
                let problem = Problem::conflict(message)
                    .key("time")
                    .allowed("speeds at one stamp that may be one");
                let problem = problem
                    .hint("are these the rows of two cars? choose one with where=COLUMN:VALUE");
                Err(Refused::known(self.problem(before.lines[at], problem)))
            }
        }
    }

    fn falls(
        &self,
        samples: &Samples,
        falls: &[usize],
        first: usize,
        chosen: &Chosen,
        leading: (&Source, &Source),
    ) -> Refused {
        if let Some((column, values)) = telling(self.sheet, leading.0, false) {
            return self.several(column, &values, chosen, leading);
        }
        let line = samples.lines[first];
        let ends = falls.iter().copied().chain([samples.time_s.len()]);
        let starts = [0].into_iter().chain(falls.iter().copied());
        let lengths: Vec<usize> = starts.zip(ends).map(|(start, end)| end - start).collect();
        let problem = match lengths.iter().all(|rows| *rows > 5) && samples.falls_far(falls) {
            true if samples.is_clock_set(falls) => {
                let message = format!(
                    "the time falls {} while the car drives on",
                    times(falls.len())
                );
                Problem::conflict(message)
                    .allowed("more than in the row above")
                    .hint("a clock that was set: let the repair `cut` let it run on")
                    .settings(&[Setting::Repair])
                    .repair("cut")
            }
            true => {
                let longest = lengths
                    .iter()
                    .enumerate()
                    .max_by_key(|(k, rows)| (**rows, std::cmp::Reverse(*k)))
                    .map_or(0, |(k, _)| k);
                let shown: Vec<String> = lengths.iter().take(5).map(usize::to_string).collect();
                let message = format!(
                    "the time starts again {}: {} drives of {} rows",
                    times(falls.len()),
                    lengths.len(),
                    shown.join(", ")
                );
                let filters = [("trip".to_owned(), (longest + 1).to_string())];
                Problem::conflict(message)
                    .allowed("one drive")
                    .columns(propose::columns(self.sheet, chosen, leading, &[], &filters))
            }
            false => {
                let message = format!("the time falls {}", times(falls.len()));
                let problem = Problem::conflict(message)
                    .allowed("more than in the row above")
                    .hint("sort the rows, or let the repair `sort` do it")
                    .settings(&[Setting::Repair]);
                // A column that falls and comes back to its values is no time.
                let mut sorted = samples.time_s.clone();
                sorted.sort_by(f64::total_cmp);
                let doubled = sorted.windows(2).filter(|pair| pair[1] <= pair[0]).count();
                match 5 * doubled < sorted.len() {
                    true => problem.repair("sort"),
                    false => problem,
                }
            }
        };
        Refused::known(self.problem(line, problem.key("time")))
    }

    /// Steps that no recording of a drive has: the stamps are in another unit.
    pub(super) fn steps(
        &self,
        samples: &Samples,
        chosen: &Chosen,
        leading: (&Source, &Source),
    ) -> Result<(), Refused> {
        let name = self.sheet.label(leading.0.column);
        let Some(problem) = strange_steps(samples, &name, leading.0.reading) else {
            return Ok(());
        };
        let problem = problem.in_file(self.file).key("time");
        let filters = self.filters(chosen);
        let unit = leading.0.quantity.unit(propose::time_unit(&propose::raw(
            self.sheet,
            leading.0.column,
        )));
        Err(Refused::known(
            match unit.filter(|own| leading.0.reading != Reading::Number(*own)) {
                Some(own) => {
                    let forced = Source {
                        reading: Reading::Number(own),
                        ..leading.0.clone()
                    };
                    let columns =
                        propose::columns(self.sheet, chosen, (&forced, leading.1), &[], &filters);
                    problem
                        .hint(format!("are the stamps in {}?", own.name))
                        .columns(columns)
                }
                None => problem.hint("thin it out, or cut it into drives"),
            },
        ))
    }
}

/// A problem where the steps of a recording are those of no drive.
fn strange_steps(samples: &Samples, name: &str, reading: Reading) -> Option<Problem> {
    let first = samples.time_s[0];
    let duration = samples.time_s[samples.time_s.len() - 1] - first;
    let step = smooth::median(
        samples
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect(),
    )
    .unwrap_or(0.0);
    let moves = samples
        .speed_m_s
        .windows(2)
        .filter(|pair| (pair[1] - pair[0]).abs() > 0.1)
        .count();
    let long =
        step >= MAX_STEP_S && samples.time_s.len() >= 20 && 10 * moves >= samples.time_s.len();
    let late = matches!(reading, Reading::Number(_)) && first.abs() > MAX_STAMP_S;
    let message = match (late, long || duration > MAX_DURATION_S) {
        (true, _) => format!("`{name}` begins at {} s", readable(first, 0)),
        (false, true) => format!(
            "the rows are {} s apart, and the drive takes {} s",
            readable(step, 1),
            readable(duration, 0)
        ),
        (false, false) => return None,
    };
    let allowed =
        format!("steps below {MAX_STEP_S} s while the car drives, up to {MAX_DURATION_S} s in all");
    Some(Problem::out_of_range(message).allowed(allowed))
}

/// True if the steps of a table of a cycle are those of no drive, which the reader of logs then says.
pub(crate) fn are_strange(samples: &Samples) -> bool {
    let unit = Quantity::Time.plain_unit();
    unit.is_some_and(|unit| strange_steps(samples, "", Reading::Number(unit)).is_some())
}

fn times(count: usize) -> String {
    match count {
        1 => "once".to_owned(),
        _ => format!("{count} times"),
    }
}
