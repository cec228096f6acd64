//! The rows of a table to one number.

use super::eval::{Here, least, most, short};
use super::{Reduce, Reduction, Table};

/// One row that counts.
struct Point {
    value: f64,
    over: f64,
    weight: f64,
    group: Vec<f64>,
}

/// A step against the direction of rising or falling that is no more than rounding, as a share of the values' size.
const STILL: f64 = 1e-9;

/// Reduces a source.
pub fn reduce(here: &mut Here, r: &Reduce) -> Result<f64, String> {
    let table = here.tables.table(r.source, r.kind == Reduction::Total)?;
    let points = points(here, r, &table)?;
    if points.is_empty() {
        if matches!(r.kind, Reduction::Count | Reduction::Any) {
            return Ok(0.0);
        }
        let gross = table.gross.iter().filter(|gross| **gross).count();
        let left = if gross > 0 {
            format!("; {gross} rows of the source are at gross slip and left out")
        } else {
            String::new()
        };
        return Err(format!("no row is left to look at{left}"));
    }
    let conditional = matches!(
        r.kind,
        Reduction::Count | Reduction::Share | Reduction::All | Reduction::Any
    );
    if !conditional && points.iter().any(|p| p.value.is_nan() || p.over.is_nan()) {
        return Err("a row has no number there".to_owned());
    }
    let at = match &r.at {
        Some(at) => here.eval(at)?,
        None => f64::NAN,
    };
    of_points(r.kind, points, at)
}

fn of_points(kind: Reduction, mut points: Vec<Point>, at: f64) -> Result<f64, String> {
    let values = || points.iter().map(|p| p.value);
    let weight: f64 = points.iter().map(|p| p.weight).sum();
    let meets = |p: &&Point| p.value > 0.5;
    Ok(match kind {
        Reduction::Min => values().fold(f64::INFINITY, least),
        Reduction::Max => values().fold(f64::NEG_INFINITY, most),
        Reduction::Range | Reduction::Spread => {
            values().fold(f64::NEG_INFINITY, most) - values().fold(f64::INFINITY, least)
        }
        Reduction::Sum => points.iter().map(|p| p.value * p.weight).sum(),
        Reduction::Mean => points.iter().map(|p| p.value * p.weight).sum::<f64>() / weight,
        Reduction::First => points[0].value,
        Reduction::Last => points[points.len() - 1].value,
        Reduction::One | Reduction::Total if points.len() == 1 => points[0].value,
        Reduction::One | Reduction::Total => {
            return Err(format!("{} rows where one was expected", points.len()));
        }
        Reduction::Count => points.iter().filter(meets).count() as f64,
        Reduction::Share => points.iter().filter(meets).map(|p| p.weight).sum::<f64>() / weight,
        Reduction::All => f64::from(u8::from(points.iter().all(|p| p.value > 0.5))),
        Reduction::Any => f64::from(u8::from(points.iter().any(|p| p.value > 0.5))),
        Reduction::Slope => regression(&points)?.0,
        Reduction::R2 => regression(&points)?.1,
        Reduction::Rising => f64::from(u8::from(monotone(&mut points, 1.0)?)),
        Reduction::Falling => f64::from(u8::from(monotone(&mut points, -1.0)?)),
        Reduction::Interp => interp(&mut points, at)?,
        Reduction::Cross => cross(&mut points, at)?,
    })
}

fn points(here: &mut Here, r: &Reduce, table: &Table) -> Result<Vec<Point>, String> {
    let mut found = Vec::new();
    let (mut left_out, mut outside) = (0, 0);
    let rows = table.columns.first().map_or(0, Vec::len);
    for row in 0..rows {
        let mut inner = Here {
            tables: here.tables,
            row: Some((table, row)),
            variables: here.variables.clone(),
            noting: here.noting,
        };
        if let Some(filter) = &r.filter
            && inner.eval(filter)? <= 0.5
        {
            continue;
        }
        if table.gross.get(row) == Some(&true) {
            left_out += 1;
            continue;
        }
        outside += usize::from(table.outside.get(row) == Some(&true));
        let value = inner.eval(&r.value)?;
        let over = r.over.as_ref().map_or(Ok(0.0), |over| inner.eval(over))?;
        let group: Result<Vec<f64>, String> = r.by.iter().map(|by| inner.eval(by)).collect();
        found.push(Point {
            value,
            over,
            weight: table.weight.get(row).copied().unwrap_or(1.0),
            group: group?,
        });
    }
    if here.noting {
        here.tables.left_out(left_out);
        here.tables.outside(outside);
    }
    Ok(found)
}

/// Slope and squared correlation of the regression line.
fn regression(points: &[Point]) -> Result<(f64, f64), String> {
    let n = points.len() as f64;
    let (mx, my) = (
        points.iter().map(|p| p.over).sum::<f64>() / n,
        points.iter().map(|p| p.value).sum::<f64>() / n,
    );
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in points {
        let (dx, dy) = (p.over - mx, p.value - my);
        (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    if points.len() < 2 || xx <= 0.0 {
        return Err("a slope needs two different places".to_owned());
    }
    Ok((xy / xx, if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 }))
}

fn sort(points: &mut [Point]) {
    let by_group = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(x, y)| x.total_cmp(y))
            .find(|order| order.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    };
    points.sort_by(|a, b| by_group(&a.group, &b.group).then(a.over.total_cmp(&b.over)));
}

/// Whether the value goes one way with `over` in every group: no step back, and somewhere a step.
fn monotone(points: &mut [Point], sign: f64) -> Result<bool, String> {
    sort(points);
    let same = |a: &Point, b: &Point| {
        a.group
            .iter()
            .zip(&b.group)
            .all(|(x, y)| (x - y).abs() <= 1e-9 * most(x.abs(), y.abs()))
    };
    let size = points.iter().map(|p| p.value.abs()).fold(0.0, most);
    let (mut pairs, mut good, mut moved) = (0, true, false);
    for group in points.chunk_by(same) {
        for pair in group.windows(2) {
            let step = sign * (pair[1].value - pair[0].value);
            (pairs, good) = (pairs + 1, good && step >= -STILL * size);
            moved |= step > STILL * size;
        }
    }
    if pairs == 0 {
        Err("rising and falling need two rows in a group".to_owned())
    } else {
        Ok(good && moved)
    }
}

fn interp(points: &mut [Point], at: f64) -> Result<f64, String> {
    sort(points);
    for pair in points.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        if a.over <= at && at <= b.over {
            let share = if b.over > a.over {
                (at - a.over) / (b.over - a.over)
            } else {
                0.0
            };
            return Ok(a.value + share * (b.value - a.value));
        }
    }
    match points {
        [only] if (only.over - at).abs() <= 1e-9 * at.abs() => Ok(only.value),
        _ => Err(format!("{} lies outside of the rows", short(at))),
    }
}

/// Where the value first passes the level.
fn cross(points: &mut [Point], level: f64) -> Result<f64, String> {
    sort(points);
    for pair in points.windows(2) {
        let (a, b) = (pair[0].value - level, pair[1].value - level);
        if (a <= 0.0) != (b <= 0.0) {
            return Ok(pair[0].over + (pair[1].over - pair[0].over) * a / (a - b));
        }
    }
    Err(format!(
        "the value does not pass {} in these rows",
        short(level)
    ))
}

/// The numbers behind a yes or no over rows.
pub fn behind(here: &mut Here, r: &Reduce) -> String {
    let Ok(table) = here.tables.table(r.source, r.kind == Reduction::Total) else {
        return "-".to_owned();
    };
    let Ok(points) = points(here, r, &table) else {
        return "-".to_owned();
    };
    match r.kind {
        Reduction::All | Reduction::Any => {
            format!(
                "{} of {} rows",
                points.iter().filter(|p| p.value > 0.5).count(),
                points.len()
            )
        }
        Reduction::Rising | Reduction::Falling => {
            let ends = points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                    (least(p.value, l), most(p.value, h))
                });
            format!(
                "{} to {} over {} rows",
                short(ends.0),
                short(ends.1),
                points.len()
            )
        }
        _ => here
            .eval(&super::Expr::Reduce(Box::new(r.clone())))
            .map_or_else(|_| "-".to_owned(), short),
    }
}
