//! Likeness of a recording to a shipped cycle: the same speeds, those in another unit, or a few others.

use super::{Cycle, is_standstill, names, of_seconds};
use crate::log::{Likeness, Samples, median};
use crate::readable;

/// Share of samples that make it the same cycle.
const SAME: f64 = 0.9;
/// Difference of two samples that are the same, m/s and share.
const ALIKE: (f64, f64) = (0.03, 0.004);
/// A sample that differs by less may be of the same cycle with noise, m/s.
const OTHER_M_S: f64 = 0.3;
/// A factor nearer to 1 is none.
const FACTOR: f64 = 0.004;
/// Factors of units that are taken for each other.
const FACTORS: [(f64, &str); 6] = [
    (0.621_371, "are the numbers mph?"),
    (1.609_344, "are the numbers km/h in place of mph?"),
    (3.6, "are the numbers km/h in place of m/s?"),
    (1.0 / 3.6, "are the numbers m/s in place of km/h?"),
    (2.236_936, "are the numbers mph in place of m/s?"),
    (0.447_04, "are the numbers m/s in place of mph?"),
];
/// Speeds at whole seconds from the first.
fn seconds(samples: &Samples, count: usize) -> Vec<f64> {
    let mut at = 0;
    let last = samples.time_s.len() - 1;
    let first_s = samples.time_s[0];
    let speed = |second: usize| {
        let time = first_s + second as f64;
        while at + 1 < last && samples.time_s[at + 1] <= time {
            at += 1;
        }
        let step = samples.time_s[at + 1] - samples.time_s[at];
        let share = ((time - samples.time_s[at]) / step).clamp(0.0, 1.0);
        samples.speed_m_s[at] + share * (samples.speed_m_s[at + 1] - samples.speed_m_s[at])
    };
    (0..count).map(speed).collect()
}

/// Compares a recording with the shipped cycles of its duration, and of its number of rows.
pub(crate) fn likeness(samples: &Samples, resolution_m_s: f64) -> Likeness {
    let of_time = in_time(samples, resolution_m_s);
    match of_time.doubt.is_none() && !of_time.is_exact {
        true => in_rows(samples, resolution_m_s).unwrap_or(of_time),
        false => of_time,
    }
}

/// The rows of a shipped cycle, a second apart there, with other stamps.
fn in_rows(samples: &Samples, resolution_m_s: f64) -> Option<Likeness> {
    let step = samples.raster().filter(|step| (step - 1.0).abs() > 0.01)?;
    let rows = Samples {
        time_s: (0..samples.time_s.len()).map(|k| k as f64).collect(),
        ..samples.clone()
    };
    let found = in_time(&rows, resolution_m_s);
    let is_like = found.is_exact || found.doubt.is_some();
    let of = found.cycle.filter(|_| is_like)?;
    let doubt = format!(
        "this is {of} with its rows {} s apart in place of 1 s",
        readable(step, 3)
    );
    Some(Likeness {
        doubt: Some(doubt),
        is_exact: false,
        cycle: Some(of),
    })
}

fn in_time(samples: &Samples, resolution_m_s: f64) -> Likeness {
    let Some((first, last)) = samples
        .time_s
        .first()
        .zip(samples.time_s.last())
        .filter(|(first, last)| last > first)
    else {
        return Likeness::default();
    };
    let duration = (last - first).round();
    if duration > 4000.0 || samples.time_s.len() < 20 {
        return Likeness::default();
    }
    let own = seconds(samples, duration as usize + 1);
    let of_name = |name: &&'static str| of_seconds(name, duration as usize);
    let mut like: Option<Likeness> = None;
    for cycle in names().iter().filter_map(of_name) {
        for trace in [Some(&cycle.manual), cycle.automatic.as_ref()]
            .into_iter()
            .flatten()
        {
            let starts = trace
                .intervals
                .iter()
                .map(|interval| (interval.start_s, interval.start_speed_m_s));
            let end = trace
                .intervals
                .last()
                .map(|interval| (interval.end_s, interval.end_speed_m_s));
            let (time_s, speed_m_s): (Vec<f64>, Vec<f64>) = starts.chain(end).unzip();
            let theirs = Samples {
                lines: vec![0; time_s.len()],
                time_s,
                speed_m_s,
                first_m_s: Vec::new(),
            };
            if theirs.time_s.len() < 2 {
                continue;
            }
            let other = seconds(&theirs, own.len().min(trace.duration_s() as usize + 1));
            // Of two cycles of one family the one that it is goes first.
            match compared(cycle, &own, &other, resolution_m_s) {
                Some(found) if found.is_exact && found.doubt.is_none() => return found,
                Some(found) => like = like.or(Some(found)),
                None => {}
            }
        }
    }
    like.unwrap_or_default()
}

fn compared(cycle: &Cycle, own: &[f64], other: &[f64], resolution_m_s: f64) -> Option<Likeness> {
    let pairs = || own.iter().zip(other);
    let ratios = pairs()
        .filter(|(_, other)| **other > 2.0)
        .map(|(own, other)| own / other);
    let factor = median(ratios.collect())?;
    if factor.is_nan() || factor <= 0.05 {
        return None;
    }
    let is_same = |(own, other): &(&f64, &f64)| {
        let expected = factor * **other;
        (**own - expected).abs() <= ALIKE.0 + 0.6 * resolution_m_s + ALIKE.1 * expected
    };
    let moving = pairs().filter(|(own, other)| !(is_standstill(**own) && is_standstill(**other)));
    let (count, same) = moving.fold((0, 0), |(count, same), pair| {
        (count + 1, same + usize::from(is_same(&pair)))
    });
    if (same as f64) < SAME * f64::from(count) {
        return None;
    }
    let mean = own.iter().sum::<f64>() / own.len() as f64;
    if (factor - 1.0).abs() > FACTOR + resolution_m_s / mean.max(1.0) {
        let known = FACTORS
            .iter()
            .find(|(known, _)| (factor / known - 1.0).abs() < FACTOR);
        let question = known.map_or("is the unit of the speed right?", |(_, question)| question);
        let doubt = format!(
            "this is {} times {}: {question}",
            cycle.name,
            readable(factor, 4)
        );
        return Some(Likeness {
            doubt: Some(doubt),
            is_exact: false,
            cycle: Some(cycle.name.clone()),
        });
    }
    let is_other = |(own, other): (&f64, &f64)| {
        (own - other).abs() > OTHER_M_S.max(resolution_m_s) + ALIKE.1 * other
    };
    let other_samples = pairs().enumerate().filter(|(_, pair)| is_other(*pair));
    let other_samples: Vec<usize> = other_samples.map(|(k, _)| k).collect();
    let all_same = pairs().all(|pair| is_same(&pair));
    let doubt = other_samples.first().map(|first| {
        format!(
            "this is {} but for {} of {} samples, the first at {first} s: {} km/h in place of {}",
            cycle.name,
            other_samples.len(),
            own.len(),
            readable(3.6 * own[*first], 1),
            readable(3.6 * other[*first], 1)
        )
    });
    Some(Likeness {
        is_exact: all_same,
        doubt,
        cycle: Some(cycle.name.clone()),
    })
}
