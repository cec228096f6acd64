//! Logs of cars, of instruments and of other programs to drive cycles.
//!
//! A log is not a cycle: it has channels in units of its own, stamps that are doubled or missing, gaps, several drives, and a speed whose resolution
//! does not fit its rate. It is read in steps, each in a file:
//!
//! | file | content |
//! |---|---|
//! | `text` | bytes to text, in the encoding that they are in |
//! | `sheet` | the sign between columns; what is above the rows and below them |
//! | `stamp` | time stamps: clocks, dates |
//! | `choose` | the channels that are meant, by their names or by the user |
//! | `fill` | cells to numbers |
//! | `repair` | faults that have one remedy: each has a name and is counted |
//! | `smooth` | resolution of a speed over its rate, smoothing (LO-1 to LO-4) |
//! | `doubts` | motions that no car has |
//! | `propose` | the columns that mend a refusal |

mod choose;
mod doubts;
mod fill;
mod propose;
mod repair;
mod sheet;
mod smooth;
mod stamp;
mod text;

pub(crate) use doubts::{Likeness, motions};
pub(crate) use repair::{Samples, Treated, treat};
pub use smooth::Resolution;
pub(crate) use smooth::median;

use crate::channel::Quantity;
use crate::csv::Columns;
use crate::{Place, Problem, Problems, readable};
use choose::{Chosen, Reading, Source};
use cvtcycle_model::cycle::Repair;
use fill::{Filled, telling};
use repair::{made, number_of, slopes};
use sheet::Sheet;

/// Stamps above are no seconds of a drive, but milliseconds or less since 1970.
const MAX_STAMP_S: f64 = 1e11;
/// Steps of a recording from here on leave no drive, s.
const MAX_STEP_S: f64 = 60.0;
/// Two channels of speed that differ by less on average are of one car, m/s.
const SAME_M_S: f64 = 1.5;
/// A longer log becomes one of a row a second.
const MAX_ROWS: usize = 2_000_000;
/// Longest drive, s.
const MAX_DURATION_S: f64 = 1e6;

/// A channel that is read.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Quantity.
    pub quantity: Quantity,
    /// Name in the file.
    pub name: String,
    /// Unit or form in the file.
    pub unit: &'static str,
    /// Values in SI, degC for temperatures; NaN where there is none.
    pub values: Vec<f64>,
}

/// A log, read and repaired.
#[derive(Debug)]
pub struct Log {
    /// How its text was understood.
    pub read_as: Vec<String>,
    /// Channels that are read: time and speed first. Speeds are as they were recorded.
    pub channels: Vec<Channel>,
    /// Columns that are passed over.
    pub passed_over: Vec<String>,
    /// Words of the channel of phases.
    pub words: Vec<String>,
    /// Times and speeds after the repairs.
    pub(crate) treated: Treated,
    /// Slopes, rise over run.
    pub(crate) grade: Option<Vec<f64>>,
    /// True where the engine rests.
    pub(crate) engine_off: Option<Vec<bool>>,
    /// Index into `words`.
    pub(crate) phase: Option<Vec<u16>>,
}

/// A log that is not read.
#[derive(Debug)]
pub(crate) struct Refused {
    pub problems: Problems,
    /// True where the reader knows the file and what is wrong with it.
    pub is_known: bool,
}

impl Refused {
    fn unknown(problem: Problem) -> Refused {
        Refused {
            problems: problem.into(),
            is_known: false,
        }
    }

    fn known(problem: Problem) -> Refused {
        Refused {
            problems: problem.into(),
            is_known: true,
        }
    }
}

/// Reader of one file.
struct Reader<'s, 't> {
    file: &'s str,
    sheet: &'s Sheet<'t>,
    columns: &'s Columns,
    likeness: Known,
}

/// Likeness of a recording, with its resolution in m/s, to known drives.
pub(crate) type Known = fn(&Samples, f64) -> Likeness;

/// Reads a log.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    columns: &Columns,
    likeness: Known,
) -> Result<Log, Refused> {
    let in_file = |problem: Problem| problem.in_file(file);
    let text = text::decode(bytes).map_err(|problem| Refused {
        problems: in_file(problem).into(),
        is_known: true,
    })?;
    let sheet = Sheet::find(&text.text).ok_or_else(|| {
        let problem = Problem::syntax(
            "no table was found in the file: no sign parts its lines into as many columns",
        );
        Refused::unknown(in_file(problem))
    })?;
    let mut log = Reader {
        file,
        sheet: &sheet,
        columns,
        likeness,
    }
    .read()?;
    if let Some(encoding) = text.encoding {
        log.read_as.insert(0, encoding.to_owned());
    }
    Ok(log)
}

impl Reader<'_, '_> {
    fn problem(&self, line: u32, problem: Problem) -> Problem {
        Problem {
            place: Place {
                line: line as usize,
                ..Place::file(self.file)
            },
            ..problem
        }
    }

    fn read(&self) -> Result<Log, Refused> {
        let chosen = self.chosen()?;
        let filled = Filled::of(self.sheet, &chosen);
        self.rows(&filled)?;
        let mut read_as = self.sheet.read_as.clone();
        for (count, place) in [
            (filled.repeated, "with the names again"),
            (filled.footer, "below the rows"),
        ] {
            if count > 0 {
                read_as.push(format!("{} {place}", number_of(count, "line")));
            }
        }
        let (time, speed) = self.leading(&chosen, &filled, &mut read_as)?;
        let (time_source, speed_source) = (&chosen.times[time], &chosen.speeds[speed]);
        self.one_car(&chosen, &filled, (time_source, speed_source))?;
        let mut repairs: Vec<Repair> = Vec::new();
        let (mut samples, mut others) = self.samples(
            &filled,
            (time, chosen.times.len() + speed),
            chosen.times.len() + chosen.speeds.len(),
            &mut repairs,
        )?;
        if filled.midnights() > 0 {
            read_as.push("over midnight".to_owned());
        }
        self.order(
            &mut samples,
            &mut others,
            &chosen,
            (time_source, speed_source),
            &mut repairs,
        )?;
        if samples.time_s.len() > MAX_ROWS {
            let count = samples.mean_each_second(&mut others);
            read_as.push(format!("{count} rows as their means over a second"));
        }
        self.steps(&samples, &chosen, (time_source, speed_source))?;
        let raw = samples.clone();
        let resolution =
            Resolution::of(&samples.time_s, &samples.speed_m_s).map_or(0.0, |own| own.speed_m_s);
        let likeness = (self.likeness)(&samples, resolution);
        let place = |line: u32| self.problem(line, Problem::default());
        let is_exact = likeness.is_exact && resolution < 0.15;
        let wanted = self.columns.repairs();
        let mut treated = treat(samples, wanted, is_exact, &place).map_err(|found| {
            let problems = found.into_iter().map(|problem| Problem {
                key: speed_source.quantity.name().to_owned(),
                ..problem
            });
            Refused {
                problems: problems.collect(),
                is_known: true,
            }
        })?;
        treated.doubts.extend(likeness.doubt);
        treated.doubts.extend(motions(&treated.samples));
        repairs.append(&mut treated.repairs);
        let values = |quantity: Quantity| {
            let mut sources = chosen.others.iter();
            let at = sources.position(|source| source.quantity == quantity);
            at.map(|at| &others[at])
        };
        let heights = values(Quantity::Altitude);
        let grade = self.grade(
            values(Quantity::Grade),
            heights,
            &treated.samples,
            &mut repairs,
        )?;
        let off = values(Quantity::EngineOff)
            .map(|own| held(own).iter().map(|flag| *flag > 0.5).collect());
        let engine_off: Option<Vec<bool>> = off.or_else(|| {
            values(Quantity::EngineOn).map(|own| held(own).iter().map(|flag| *flag < 0.5).collect())
        });
        let phase = values(Quantity::Phase)
            .map(|own| held(own).iter().map(|index| *index as u16).collect());
        treated.repairs = repairs;
        let (channels, passed_over) =
            self.channels(&chosen, (time_source, speed_source), &raw, &others);
        read_as.extend(channels.iter().take(2).map(|own| {
            let name = crate::one_line(&own.name);
            format!("\"{name}\" as {} in {}", own.quantity.name(), own.unit)
        }));
        Ok(Log {
            read_as,
            channels,
            passed_over,
            words: filled.words,
            treated,
            grade,
            engine_off,
            phase,
        })
    }

    /// The channels that are meant.
    fn chosen(&self) -> Result<Chosen, Refused> {
        let chosen = match self.columns.is_empty() {
            true => self.sheet.by_names(),
            false => {
                let found = self.sheet.by_columns(self.columns);
                found.map_err(Refused::known)?
            }
        };
        if chosen.times.is_empty() || chosen.speeds.is_empty() {
            return Err(self.missing(&chosen));
        }
        let is_road = |(quantity, _): &&(Quantity, usize)| {
            matches!(quantity, Quantity::Grade | Quantity::Altitude)
        };
        match chosen.no_unit.iter().find(is_road) {
            Some((quantity, column)) => Err(self.no_unit(&chosen, *quantity, *column)),
            None => Ok(chosen),
        }
    }

    /// Slopes: those of the log, or of its heights.
    fn grade(
        &self,
        slopes_of_log: Option<&Vec<f64>>,
        heights: Option<&Vec<f64>>,
        samples: &Samples,
        repairs: &mut Vec<Repair>,
    ) -> Result<Option<Vec<f64>>, Refused> {
        let Some(grade) = slopes_of_log.map(|own| held(own)) else {
            let known = heights.filter(|own| own.iter().any(|height| height.is_finite()));
            return Ok(known.map(|heights| {
                let (own, steep) = slopes(samples, heights);
                let cut = match steep {
                    0 => String::new(),
                    n => format!(", {} cut to 35 %", number_of(n, "row")),
                };
                let what =
                    format!("slopes from heights over 100 m of road on either side (LO-5){cut}");
                repairs.push(made("altitude", own.len(), what));
                own
            }));
        };
        let Some(steep) = grade.iter().position(|slope| slope.abs() > 0.35) else {
            return Ok(Some(grade));
        };
        let slope = readable(100.0 * grade[steep], 1);
        let problem = Problem::out_of_range(format!("the slope is {slope} %"))
            .allowed("-35 to 35 %")
            .hint("is the grade in another unit?");
        let problem = self.problem(samples.lines[steep], problem);
        Err(Refused::known(problem.key("grade")))
    }

    /// Channels that are read, time and speed first, and the columns that are passed over.
    fn channels(
        &self,
        chosen: &Chosen,
        (time, speed): (&Source, &Source),
        raw: &Samples,
        others: &[Vec<f64>],
    ) -> (Vec<Channel>, Vec<String>) {
        let channel = |source: &Source, values: &[f64]| Channel {
            quantity: source.quantity,
            name: self.sheet.label(source.column),
            unit: match source.reading {
                Reading::Number(unit) => unit.name,
                Reading::Stamp(form) => form.name(),
                Reading::Word => "word",
            },
            values: values.to_vec(),
        };
        let leading = [channel(time, &raw.time_s), channel(speed, &raw.speed_m_s)];
        let rest = chosen.others.iter().zip(others);
        let rest = rest.map(|(source, values)| channel(source, values));
        let lists = [&chosen.times, &chosen.speeds, &chosen.others];
        let is_used = |column: &usize| {
            let mut used = lists.into_iter().flatten();
            used.any(|source| source.column == *column)
        };
        let passed_over = (0..self.sheet.names.len()).filter(|column| !is_used(column));
        let passed_over = passed_over.map(|column| self.sheet.label(column));
        (
            leading.into_iter().chain(rest).collect(),
            passed_over.collect(),
        )
    }

    /// Time or speed was not found.
    fn missing(&self, chosen: &Chosen) -> Refused {
        let known =
            !chosen.times.is_empty() || !chosen.speeds.is_empty() || !chosen.no_unit.is_empty();
        let mut problems = Problems::new();
        for (quantity, sources) in [
            (Quantity::Time, &chosen.times),
            (Quantity::Speed, &chosen.speeds),
        ] {
            if !sources.is_empty() {
                continue;
            }
            let unit = chosen.no_unit.iter().find(|(own, _)| *own == quantity);
            let problem = match unit {
                Some((_, column)) => Problem::missing(format!(
                    "the unit of `{}` is not stated",
                    self.sheet.label(*column)
                ))
                .allowed(quantity.units().join(", ")),
                None if self.sheet.names.is_empty() => Problem::missing(format!(
                    "the file has no names of columns, so that none is known as {}",
                    quantity.name()
                ))
                .allowed(format!("{} columns", self.sheet.width)),
                None => Problem::missing(format!("no column is known as {}", quantity.name()))
                    .allowed(self.sheet.names.join(", ")),
            };
            problems.add(problem.in_file(self.file).key(quantity.name()));
        }
        let filled = Filled::of(
            self.sheet,
            &Chosen {
                filters: chosen.filters.clone(),
                ..Chosen::default()
            },
        );
        let mut filters = self.filters(chosen);
        if let Some((column, values)) = filled.identities.first().filter(|_| chosen.trip.is_none())
        {
            problems.add(self.several_values(*column, values));
            let value = values.first().map(|(value, _)| value.clone());
            filters.push((self.sheet.label(*column), value.unwrap_or_default()));
        }
        let guess = propose::guess(self.sheet, chosen, &filters);
        let columns = guess.as_ref().map_or("", |guess| &guess.columns);
        let is_known = known || !columns.is_empty();
        let problems = problems.map(|problem| {
            let is_speed = problem.key == Quantity::Speed.name();
            let hint = guess
                .as_ref()
                .filter(|_| is_speed)
                .map_or("", |guess| &guess.hint);
            let problem = problem.columns(columns);
            if hint.is_empty() {
                problem
            } else {
                problem.hint(hint)
            }
        });
        Refused { problems, is_known }
    }

    /// Rows that the user has chosen.
    fn filters(&self, chosen: &Chosen) -> Vec<(String, String)> {
        let filters = chosen.filters.iter();
        filters
            .map(|(column, value)| (self.sheet.label(*column), value.clone()))
            .collect()
    }

    fn no_unit(&self, chosen: &Chosen, quantity: Quantity, column: usize) -> Refused {
        let name = self.sheet.label(column);
        let problem = Problem::missing(format!("the unit of `{name}` is not stated"))
            .in_file(self.file)
            .key(quantity.name())
            .allowed(quantity.units().join(", "))
            .hint("a slope of 0.2 may be a share, per cent, degrees or per mille");
        let unit = match quantity {
            Quantity::Grade => "%",
            _ => "m",
        };
        let more = [(quantity, column, unit)];
        Refused::known(problem.columns(propose::columns(
            self.sheet,
            (&chosen.times[0], &chosen.speeds[0]),
            &more,
            &[],
        )))
    }

    /// Lines that are no rows, and none that is one.
    fn rows(&self, filled: &Filled) -> Result<(), Refused> {
        if let Some((line, text)) = filled.other.first() {
            let places: Vec<String> = filled
                .other
                .iter()
                .map(|(line, _)| line.to_string())
                .collect();
            let more = if filled.others > places.len() {
                " and others"
            } else {
                ""
            };
            let message = format!(
                "{} without the values of a row between the rows: line {}{more}",
                number_of(filled.others, "line"),
                places.join(", ")
            );
            let problem = Problem::syntax(message)
                .value(crate::one_line(text))
                .allowed(format!("{} values in each row", self.sheet.width));
            let problem = problem.hint(
                "is a cell of time or speed a word? a value without a number is empty, - or NaN",
            );
            let place = self.problem(u32::try_from(*line).unwrap_or(u32::MAX), problem);
            // The program's own reader says more about a cell.
            return Err(Refused {
                problems: place.into(),
                is_known: !self.columns.is_empty(),
            });
        }
        if filled.lines.len() < 2 {
            let problem = Problem::missing("fewer than two rows have a time and a speed")
                .in_file(self.file)
                .allowed("at least two rows");
            let problem = problem.hint("a row holds until the next one");
            return Err(Refused {
                problems: problem.into(),
                is_known: filled.empty > 0,
            });
        }
        Ok(())
    }

    /// The channels of time and speed: the finest of several that agree.
    fn leading(
        &self,
        chosen: &Chosen,
        filled: &Filled,
        read_as: &mut Vec<String>,
    ) -> Result<(usize, usize), Refused> {
        let times = &filled.values[..chosen.times.len()];
        let speeds = &filled.values[chosen.times.len()..chosen.times.len() + chosen.speeds.len()];
        let changes = |values: &[f64]| {
            values
                .windows(2)
                .filter(|pair| (pair[1] - pair[0]).abs() > 0.0)
                .count()
        };
        let finest = |list: &[Vec<f64>]| {
            let rated = list
                .iter()
                .enumerate()
                .map(|(k, values)| (changes(values), std::cmp::Reverse(k)));
            rated.max().map_or(0, |(_, std::cmp::Reverse(k))| k)
        };
        let time = finest(times);
        let mut speed = 0;
        if speeds.len() > 1 {
            let unlike = speeds.iter().skip(1).position(|other| {
                let pairs = speeds[0]
                    .iter()
                    .zip(other)
                    .filter(|(a, b)| a.is_finite() && b.is_finite());
                let (count, sum) = pairs.fold((0.0, 0.0), |(count, sum), (a, b)| {
                    (count + 1.0, sum + (a - b).abs())
                });
                sum > SAME_M_S * count
            });
            if let Some(other) = unlike {
                let names: Vec<String> = [0, other + 1]
                    .iter()
                    .map(|k| self.sheet.label(chosen.speeds[*k].column))
                    .collect();
                let message = format!(
                    "`{}` and `{}` are both a speed, and they differ",
                    names[0], names[1]
                );
                let problem = Problem::conflict(message)
                    .in_file(self.file)
                    .key("speed")
                    .allowed("one of them");
                let columns = propose::columns(
                    self.sheet,
                    (&chosen.times[time], &chosen.speeds[0]),
                    &[],
                    &[],
                );
                return Err(Refused::known(problem.columns(columns)));
            }
            speed = finest(speeds);
        }
        for (list, own) in [(&chosen.times, time), (&chosen.speeds, speed)] {
            let coarser: Vec<String> = (0..list.len())
                .filter(|k| *k != own)
                .map(|k| format!("\"{}\"", self.sheet.label(list[k].column)))
                .collect();
            if !coarser.is_empty() {
                read_as.push(format!(
                    "{} passed over for one as fine or finer",
                    coarser.join(", ")
                ));
            }
        }
        Ok((time, speed))
    }

    /// Refuses rows of several cars or drives.
    fn one_car(
        &self,
        chosen: &Chosen,
        filled: &Filled,
        leading: (&Source, &Source),
    ) -> Result<(), Refused> {
        let Some((column, values)) = filled.identities.first().filter(|_| chosen.trip.is_none())
        else {
            return Ok(());
        };
        Err(self.several(*column, values, chosen, leading))
    }

    fn several_values(&self, column: usize, values: &[(String, usize)]) -> Problem {
        let name = self.sheet.label(column);
        let shown = values
            .iter()
            .take(5)
            .map(|(value, rows)| format!("{value} ({rows} rows)"));
        let shown: Vec<String> = shown.collect();
        let more = if values.len() > shown.len() {
            ", ..."
        } else {
            ""
        };
        let message = format!(
            "`{name}` has {} values: the rows are of several cars or drives",
            values.len()
        );
        Problem::conflict(message)
            .in_file(self.file)
            .key(name.as_str())
            .allowed(format!("one of {}{more}", shown.join(", ")))
    }

    fn several(
        &self,
        column: usize,
        values: &[(String, usize)],
        chosen: &Chosen,
        leading: (&Source, &Source),
    ) -> Refused {
        let mut filters = self.filters(chosen);
        let value = values.first().map(|(value, _)| value.clone());
        filters.push((self.sheet.label(column), value.unwrap_or_default()));
        let columns = propose::columns(self.sheet, leading, &[], &filters);
        Refused::known(self.several_values(column, values).columns(columns))
    }

    /// Rows with a time and a speed, and the values of the other channels.
    fn samples(
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
        let samples = Samples {
            time_s: pick(times),
            speed_m_s: pick(speeds),
            lines: rows.iter().map(|k| filled.lines[*k]).collect(),
        };
        Ok((samples, filled.values[others..].iter().map(pick).collect()))
    }

    /// Puts the rows in order, or says why they cannot be.
    fn order(
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
            if wanted.sort {
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
        self.merge(samples, others, repairs)
    }

    /// Makes one row of those with the same stamp, or says why that cannot be.
    fn merge(
        &self,
        samples: &mut Samples,
        others: &mut [Vec<f64>],
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
        let before = samples.clone();
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
        if let Some((column, values)) = telling(self.sheet, leading.0) {
            return self.several(column, &values, chosen, leading);
        }
        let line = samples.lines[first];
        let ends = falls.iter().copied().chain([samples.time_s.len()]);
        let starts = [0].into_iter().chain(falls.iter().copied());
        let lengths: Vec<usize> = starts.zip(ends).map(|(start, end)| end - start).collect();
        let problem = match lengths.iter().all(|rows| *rows > 5) {
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
                    .columns(propose::columns(self.sheet, leading, &[], &filters))
            }
            false => {
                let message = format!("the time falls {}", times(falls.len()));
                Problem::conflict(message)
                    .allowed("more than in the row above")
                    .hint("sort the rows, or let the repair `sort` do it")
            }
        };
        Refused::known(self.problem(line, problem.key("time")))
    }

    /// Steps that no recording of a drive has: the stamps are in another unit.
    fn steps(
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
                    let columns = propose::columns(self.sheet, (&forced, leading.1), &[], &filters);
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

/// Values that hold until the next one; the first holds before it too.
fn held(values: &[f64]) -> Vec<f64> {
    let mut last = values
        .iter()
        .copied()
        .find(|value| value.is_finite())
        .unwrap_or(0.0);
    let hold = |value: &f64| {
        if value.is_finite() {
            last = *value;
        }
        last
    };
    values.iter().map(hold).collect()
}

impl Log {
    /// Rate and resolution of the speed; none of a schedule, or of a car at rest.
    #[must_use]
    pub fn resolution(&self) -> Option<Resolution> {
        self.treated.resolution
    }

    /// Steps from row to row: the smallest, the median and the largest, s.
    #[must_use]
    pub fn steps_s(&self) -> [f64; 3] {
        let times = self.channels.first().map_or(&[][..], |time| &time.values);
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let low = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let high = steps.iter().copied().fold(0.0, f64::max);
        [low, smooth::median(steps).unwrap_or(0.0), high]
    }
}
