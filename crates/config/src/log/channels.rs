//! Channels of a log: the leading ones, slopes, and those that are shown.

use super::choose::{Chosen, Reading, Source};
use super::fill::Filled;
use super::repair::{made, number_of};
use super::samples::Samples;
use super::slopes::slopes;
use super::{Channel, Reader, Refused, propose};
use crate::{Problem, readable};
use cvtcycle_model::cycle::Repair;

/// Two channels of speed that differ by less on average are of one car, m/s.
const SAME_M_S: f64 = 1.5;

impl Reader<'_, '_> {
    /// The channels of time and speed: the finest of several that agree.
    pub(super) fn leading(
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
                    chosen,
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

    /// Slopes: those of the log, or of its heights.
    pub(super) fn grade(
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
                    format!("slopes from heights over 100 m of road on either side (LG-5){cut}");
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
    pub(super) fn channels(
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
}

/// Values that hold until the next one; the first holds before it too.
pub(super) fn held(values: &[f64]) -> Vec<f64> {
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
