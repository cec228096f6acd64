//! Statistics over the rows of a table.

use std::cell::OnceCell;

/// Makes the numbers of a column.
type Make = Box<dyn Fn(usize) -> Vec<f64>>;

/// A table of numbers: one list for each column, made when it is first looked at, since expressions look at few.
pub struct Table {
    /// Columns in the order of their names.
    columns: Vec<OnceCell<Vec<f64>>>,
    make: Make,
    /// Weight of each row in means, sums and shares (seconds in a run, 1 elsewhere).
    pub weight: Vec<f64>,
    /// Rows at gross slip of the belt, which no reduction uses; empty if there are none.
    pub gross: Vec<bool>,
    /// Rows outside the validity of a model, which count and are reported; empty if that is not known.
    pub outside: Vec<bool>,
}

impl Table {
    /// A table of so many columns, each made by `make` from its place; with a weight for each row, and its marks.
    pub fn new(
        columns: usize,
        make: Make,
        weight: Vec<f64>,
        [gross, outside]: [Vec<bool>; 2],
    ) -> Self {
        Table {
            columns: (0..columns).map(|_| OnceCell::new()).collect(),
            make,
            weight,
            gross,
            outside,
        }
    }

    /// The numbers of a column.
    pub fn column(&self, place: usize) -> &[f64] {
        self.columns[place].get_or_init(|| (self.make)(place))
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.weight.len()
    }
}

/// One row that counts.
pub struct Point {
    pub value: f64,
    pub over: f64,
    pub weight: f64,
    pub group: Vec<f64>,
}

/// The rows that count, and the place or level of `at` (NaN without one).
pub struct Points(pub Vec<Point>, pub f64);

/// A step against the direction of rising or falling that is no more than rounding, as a share of the values' size.
const STILL: f64 = 1e-9;

impl Points {
    pub fn min(&self) -> f64 {
        self.0.iter().map(|p| p.value).fold(f64::INFINITY, least)
    }

    pub fn max(&self) -> f64 {
        self.0.iter().map(|p| p.value).fold(f64::NEG_INFINITY, most)
    }

    pub fn weight(&self) -> f64 {
        self.0.iter().map(|p| p.weight).sum()
    }

    pub fn weighted_sum(&self) -> f64 {
        self.0.iter().map(|p| p.value * p.weight).sum()
    }

    /// Rows that meet the condition.
    pub fn met(&self) -> impl Iterator<Item = &Point> {
        self.0.iter().filter(|p| p.value > 0.5)
    }

    pub fn only(self) -> Result<f64, String> {
        match self.0.as_slice() {
            [one] => Ok(one.value),
            rows => Err(format!("{} rows where one was expected", rows.len())),
        }
    }

    /// Slope and squared correlation of the regression line.
    pub fn regression(self) -> Result<(f64, f64), String> {
        let (points, n) = (&self.0, self.0.len() as f64);
        let mx = points.iter().map(|p| p.over).sum::<f64>() / n;
        let my = points.iter().map(|p| p.value).sum::<f64>() / n;
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

    /// Sorted by group, then by the other column.
    fn sorted(mut self) -> Vec<Point> {
        self.0.sort_by(|a, b| {
            let pairs = a.group.iter().chain([&a.over]);
            let mut orders = pairs.zip(b.group.iter().chain([&b.over]));
            let order = orders.find_map(|(x, y)| Some(x.total_cmp(y)).filter(|o| o.is_ne()));
            order.unwrap_or(std::cmp::Ordering::Equal)
        });
        self.0
    }

    /// True if the value goes one way with `over` in every group: no step back, and somewhere a step.
    pub fn monotone(self, sign: f64) -> Result<bool, String> {
        let points = self.sorted();
        let same = |a: &Point, b: &Point| {
            let mut pairs = a.group.iter().zip(&b.group);
            pairs.all(|(x, y)| (x - y).abs() <= 1e-9 * most(x.abs(), y.abs()))
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

    pub fn interp(self) -> Result<f64, String> {
        let (at, points) = (self.1, self.sorted());
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
        match points.as_slice() {
            [only] if (only.over - at).abs() <= 1e-9 * at.abs() => Ok(only.value),
            _ => Err(format!("{} lies outside of the rows", short(at))),
        }
    }

    /// Place where the value first passes the level.
    pub fn cross(self) -> Result<f64, String> {
        let (level, points) = (self.1, self.sorted());
        for pair in points.windows(2) {
            let (a, b) = (pair[0].value - level, pair[1].value - level);
            if (a <= 0.0) != (b <= 0.0) {
                return Ok(pair[0].over + (pair[1].over - pair[0].over) * a / (a - b));
            }
        }
        let level = short(level);
        Err(format!("the value does not pass {level} in these rows"))
    }
}

/// The smaller number; NaN if one is NaN.
pub fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// The larger number; NaN if one is NaN.
pub fn most(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// A number with four significant figures. Below 1e-9 it is rounding in every unit of the rows and shown as 0.
#[must_use]
pub fn short(x: f64) -> String {
    let size = x.abs();
    if !x.is_finite() {
        return "-".to_owned();
    }
    if size < 1e-9 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{x:.3e}");
    }
    let whole = if size >= 1.0 {
        size.log10().floor() as i32 + 1
    } else {
        0
    };
    let decimals = usize::try_from((4 - whole).clamp(0, 4)).unwrap_or(0);
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
