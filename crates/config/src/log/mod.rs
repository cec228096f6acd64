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
//! | `rows` | rows in the order of their times, each stamp once |
//! | `channels` | the leading channels, slopes, and what is shown |
//! | `samples` | the speed: order, one row a stamp, lost samples |
//! | `repair` | faults that have one remedy: each has a name and is counted |
//! | `slopes` | slopes from heights |
//! | `smooth` | resolution of a speed over its rate, smoothing (LG-1 to LG-4) |
//! | `doubts` | motions that no car has |
//! | `refuse` | what is missing, lines that are no rows, several cars |
//! | `propose` | the columns that mend a refusal |

mod channels;
mod choose;
mod doubts;
mod fill;
mod propose;
mod refuse;
mod repair;
mod rows;
mod samples;
mod sheet;
mod slopes;
mod smooth;
mod stamp;
mod text;

pub(crate) use doubts::{Likeness, motions, steep};
pub(crate) use repair::{Treated, treat};
pub(crate) use rows::are_strange;
pub(crate) use samples::Samples;
pub use smooth::Resolution;
pub(crate) use smooth::median;

use std::borrow::Cow;

use crate::channel::Quantity;
use crate::csv::Columns;
use crate::{Place, Problem, Problems};
use channels::held;
use choose::Chosen;
use cvtcycle_model::cycle::Repair;
use fill::Filled;
use repair::number_of;
use sheet::Sheet;

/// A longer log becomes one of a row a second.
const MAX_ROWS: usize = 2_000_000;

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

/// Text of a table in the encoding that it is in: UTF-8, UTF-16 or Windows-1252. `frame` is the call that takes a frame of a file that is no text.
///
/// # Errors
/// No text, a line that is too long, an empty file.
pub fn table_text<'b>(file: &str, bytes: &'b [u8], frame: &str) -> Result<Cow<'b, str>, Problem> {
    let text = text::decode(bytes, frame).map_err(|problem| problem.in_file(file))?;
    Ok(text.text)
}

/// Reads a log.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    columns: &Columns,
    likeness: Known,
) -> Result<Log, Refused> {
    let in_file = |problem: Problem| problem.in_file(file);
    let text =
        text::decode(bytes, "cvtcycle.Cycle.from_frame(frame)").map_err(|problem| Refused {
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
        if self.sheet.is_trace() {
            read_as.push("means over steps, at the middles of these".to_owned());
        }
        if filled.begins_again() {
            read_as.push("over midnight or the full hour".to_owned());
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
        let doubt = grade.as_ref().and_then(|own| steep(own.iter().copied()));
        treated.doubts.extend(doubt);
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
