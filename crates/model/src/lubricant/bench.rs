//! Tables of friction from a bench, and the curve of FR-1 through them.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FR-5 | least sum of ((mu - mu_i)/s_i)2 over the rows, s_i the scatter of a row, or mu_i where a row has none; a film is taken where it lowers Akaike's criterion with its correction for few rows, AICc = n ln(S/n) + 2 k n/(n - k - 1) | source: Levenberg and Marquardt; Hurvich and Tsai, Biometrika 76 (1989) 297 |
//! | FR-8 | w = 2 sqrt(mean (s_i/mu_i)2 + mean ((mu - mu_i)/mu_i)2): half width of what is known, two standard deviations | ASSUMED: scatter of a row moves a whole curve, as another specimen or another day does, and what the form misses is added |
//!
//! k is fitted over at least 5 K, m over pressures that differ by 1.2 times or more, the film over at least three sliding speeds that differ by three
//! times or more. The viscosity at each row is that of the fluid's own file.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::contact::{Contact, ContactCurve};
use crate::keys::Bound;
use crate::keys::ZERO_DEGC_K;
use crate::keys::file_table::{FileColumn, FileRows, FileTable};
use crate::math::{exp, ln};

const PRESSURE: FileColumn =
    FileColumn::new("pressure_mpa", "pressure", Bound::open_low(0.0, 10_000.0)).or_none();

/// A table of friction as a file.
pub static FRICTION_TABLE: FileTable = FileTable {
    kind: "friction_table",
    columns: &[
        FileColumn::new("sliding_m_s", "sliding", Bound::closed(0.0, 20.0)),
        PRESSURE,
        PRESSURE.in_unit("pressure_gpa", Bound::open_low(0.0, 10.0)),
        FileColumn::new("temp_degc", "temperature", Bound::closed(-60.0, 200.0)),
        FileColumn::new("sd", "scatter", Bound::closed(0.0, 0.5))
            .or_none()
            .extra(),
        FileColumn::new("friction", "friction", Bound::open_low(0.0, 1.0)),
    ],
    rises_with: None,
    is_grid: false,
    has_holes: false,
    words: &[
        ("sliding_speed", "sliding"),
        ("sliding_velocity", "sliding"),
        ("contact_pressure", "pressure"),
        ("mean_pressure", "pressure"),
        ("temperature", "temp"),
        ("oil_temp", "temp"),
        ("mu", "friction"),
        ("friction_coefficient", "friction"),
        ("coefficient_of_friction", "friction"),
        ("traction_coefficient", "friction"),
        ("std", "sd"),
        ("standard_deviation", "sd"),
        ("friction_sd", "sd"),
    ],
};

/// Least number of rows of a table.
pub const MIN_ROWS: usize = 3;
/// Temperatures, K, within which there is one only.
const ONE_TEMPERATURE_K: f64 = 5.0;
/// Pressures over each other, up to which there is one only.
const ONE_PRESSURE: f64 = 1.2;
/// Sliding speeds over each other from which a film shows.
const FILM_SPEEDS: f64 = 3.0;
/// Scatter below this share of the friction weighs no more.
const LEAST_SCATTER: f64 = 0.002;
/// Root of the mean square of what the form misses, over friction, from which it is doubted. ASSUMED.
const MISSES: f64 = 0.1;
/// Fall of friction over the sliding speeds of a series, over friction, from which stick-slip is doubted where a row has no scatter. ASSUMED.
const FALLS: f64 = 0.03;

/// A row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchRow {
    /// Sliding speed, m/s.
    pub sliding_m_s: f64,
    /// Mean pressure, Pa; NaN where the table has none.
    pub pressure_pa: f64,
    /// Temperature, K.
    pub temp_k: f64,
    /// Friction.
    pub friction: f64,
    /// Scatter of the friction, one standard deviation; 0 where the table has none.
    pub sd: f64,
}

/// The rows of a file.
#[must_use]
pub fn bench_rows(table: &FileRows) -> Vec<BenchRow> {
    let names = ["sliding_m_s", "pressure_mpa", "temp_degc", "friction", "sd"];
    let [sliding, pressure, temp, friction, sd] = names.map(|name| table.position(name));
    let at = |row: &[f64], column: Option<usize>, none: f64| column.map_or(none, |k| row[k]);
    let row = |row: &Vec<f64>| BenchRow {
        sliding_m_s: at(row, sliding, 0.0),
        pressure_pa: at(row, pressure, f64::NAN),
        temp_k: at(row, temp, f64::NAN),
        friction: at(row, friction, f64::NAN),
        sd: at(row, sd, 0.0),
    };
    table.rows.iter().map(row).collect()
}

/// Curve and scatter of a contact by its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Bench {
    /// The contact.
    pub contact: Contact,
    /// Word for the kind of test.
    pub test: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// Least and largest sliding speed, m/s.
    pub sliding_m_s: [f64; 2],
    /// Lowest and highest temperature, K.
    pub temp_k: [f64; 2],
    /// Lowest and highest pressure, Pa; none where the table has none.
    pub pressure_pa: Option<[f64; 2]>,
    /// The curve at the pressure of the contact, before FR-6.
    pub curve: ContactCurve,
    /// Root of the mean square of what the form misses, over friction.
    pub misses: f64,
    /// Half width of what is known, over friction (FR-8).
    pub spread: f64,
    /// Doubts, a sentence each.
    pub doubts: Vec<String>,
}

impl Bench {
    /// True if the film of the curve lowers friction: it can carry the bands (LU-5).
    #[must_use]
    pub fn film_carries(&self) -> bool {
        self.curve.half_n_m.is_finite() && self.curve.film < self.curve.boundary
    }
}

/// Where a contact of the belt is read in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchUse {
    /// The contact.
    pub contact: Contact,
    /// Word for the kind of test.
    pub test: &'static str,
    /// Pressure of the contact, Pa.
    pub pressure_pa: f64,
    /// Sliding over belt speed; 0 where the contact has a speed of its own.
    pub slip: f64,
}

/// Least and largest of some numbers.
fn ends(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

/// The curve through the rows of a table with the viscosity at each, Pa s. The last ones are kept: a study builds a fluid again and again.
///
/// # Errors
/// A sentence: too few rows.
pub fn bench(of: &BenchUse, rows: &[BenchRow], eta_pa_s: &[f64]) -> Result<Arc<Bench>, String> {
    /// Tables that are kept.
    const KEPT: usize = 16;
    type Known = (Vec<u64>, BenchUse, Arc<Bench>);
    static LAST: Mutex<VecDeque<Known>> = Mutex::new(VecDeque::new());
    let bits = |row: &BenchRow| {
        let of_row = [
            row.sliding_m_s,
            row.pressure_pa,
            row.temp_k,
            row.friction,
            row.sd,
        ];
        of_row.map(f64::to_bits)
    };
    let eta = eta_pa_s.iter().map(|eta| eta.to_bits());
    let key: Vec<u64> = rows.iter().flat_map(bits).chain(eta).collect();
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let known = |(own, by, _): &&Known| *own == key && by == of;
    if let Some((_, _, bench)) = last().iter().find(known) {
        return Ok(Arc::clone(bench));
    }
    let new = Arc::new(fitted(of, rows, eta_pa_s)?);
    let mut last = last();
    last.push_front((key, *of, Arc::clone(&new)));
    last.truncate(KEPT);
    Ok(new)
}

fn fitted(of: &BenchUse, rows: &[BenchRow], eta_pa_s: &[f64]) -> Result<Bench, String> {
    if rows.len() < MIN_ROWS {
        return Err(format!(
            "the table has {} rows, and a curve needs {MIN_ROWS}",
            rows.len()
        ));
    }
    let sliding_m_s = ends(rows.iter().map(|row| row.sliding_m_s));
    let temp_k = ends(rows.iter().map(|row| row.temp_k));
    let has_pressure = rows.iter().all(|row| row.pressure_pa.is_finite());
    let pressure_pa = has_pressure.then(|| ends(rows.iter().map(|row| row.pressure_pa)));
    let middle_pa = pressure_pa.map_or(1.0, |[low, high]| (low * high).sqrt());
    let has_sd = rows.iter().any(|row| row.sd > 0.0);
    let x: Vec<f64> = rows
        .iter()
        .zip(eta_pa_s)
        .map(|(row, eta)| eta * row.sliding_m_s)
        .collect();
    let data = Data {
        rows,
        ln_x: x.iter().map(|x| ln(x.max(f64::MIN_POSITIVE))).collect(),
        ln_p: rows
            .iter()
            .map(|row| match has_pressure {
                true => ln(row.pressure_pa / middle_pa),
                false => 0.0,
            })
            .collect(),
        weight: rows
            .iter()
            .map(|row| match has_sd {
                true => 1.0 / row.sd.max(LEAST_SCATTER * row.friction),
                false => 1.0 / row.friction,
            })
            .collect(),
    };
    let several_temps = temp_k[1] - temp_k[0] >= ONE_TEMPERATURE_K;
    let several_pressures = pressure_pa.is_some_and(|[low, high]| high >= ONE_PRESSURE * low);
    let mut speeds: Vec<f64> = rows.iter().map(|row| row.sliding_m_s).collect();
    speeds.retain(|v| *v > 0.0);
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|a, b| *a <= 1.05 * *b);
    let shows_film = speeds.len() >= 3 && speeds[speeds.len() - 1] >= FILM_SPEEDS * speeds[0];
    let best = data.best(several_temps, several_pressures, shows_film);
    let [
        ln_boundary,
        rise_per_k,
        ln_film,
        ln_half,
        ln_exponent,
        power,
    ] = best.numbers;
    let held_pa = pressure_pa.map_or(of.pressure_pa, |[low, high]| {
        of.pressure_pa.max(low).min(high)
    });
    let pressed = match several_pressures {
        true => exp(power * ln(held_pa / middle_pa)), // FR-2
        false => 1.0,
    };
    let curve = ContactCurve {
        boundary: exp(ln_boundary) * pressed,
        rise_per_k,
        film: match best.has_film {
            true => exp(ln_film) * pressed,
            false => exp(ln_boundary) * pressed,
        },
        half_n_m: match best.has_film {
            true => exp(ln_half),
            false => f64::INFINITY,
        },
        exponent: match best.has_film {
            true => exp(ln_exponent),
            false => 1.0,
        },
        from_k: temp_k[0],
        to_k: temp_k[1],
        slip: of.slip,
    };
    let n = rows.len() as f64;
    let mean = |of: &dyn Fn(usize) -> f64| (0..rows.len()).map(of).sum::<f64>() / n;
    let square = |x: f64| x * x;
    let misses =
        mean(&|i| square(data.friction(&best.numbers, best.has_film, i) / rows[i].friction - 1.0));
    let scatter = mean(&|i| square(rows[i].sd / rows[i].friction));
    let mut bench = Bench {
        contact: of.contact,
        test: of.test,
        rows: rows.len(),
        sliding_m_s,
        temp_k,
        pressure_pa,
        curve,
        misses: misses.sqrt(),
        spread: rounded(2.0 * (scatter + misses).sqrt()), // FR-8
        doubts: Vec::new(),
    };
    bench.doubts = doubts(&bench, of, rows, has_sd, several_temps);
    Ok(bench)
}

fn doubts(
    bench: &Bench,
    of: &BenchUse,
    rows: &[BenchRow],
    has_sd: bool,
    several_temps: bool,
) -> Vec<String> {
    let mut doubts = Vec::new();
    let words = of.contact.words();
    let degc = |k: f64| k - ZERO_DEGC_K;
    if !several_temps {
        doubts.push(format!(
            "{words}: the table has one temperature only, {:.0} degC: no effect of temperature",
            degc(bench.temp_k[0])
        ));
    }
    if !has_sd {
        doubts.push(format!(
            "{words}: the table has no scatter (sd): the range of its friction is what the form misses, {:.1} %",
            100.0 * bench.misses
        ));
    }
    if bench.misses > MISSES {
        doubts.push(format!(
            "{words}: the form misses the rows of the table by {:.0} % (root of the mean square)",
            100.0 * bench.misses
        ));
    }
    let outside = bench
        .pressure_pa
        .filter(|[low, high]| of.pressure_pa < *low || of.pressure_pa > *high);
    if let Some([low, high]) = outside {
        doubts.push(format!(
            "{words}: measured at {:.0} to {:.0} MPa and used at {:.0} MPa: friction is that of the nearest pressure",
            1e-6 * low,
            1e-6 * high,
            1e-6 * of.pressure_pa
        ));
    }
    let sticks = [Contact::MicroSlip, Contact::WetClutch].contains(&of.contact);
    if let Some((fall, row)) = steepest_fall(rows, has_sd).filter(|_| sticks) {
        doubts.push(format!(
            "{words}: friction falls by {:.3} from {} to {} m/s at {:.0} degC: such a contact can stick and slip (shudder, scratch)",
            fall,
            row[0].sliding_m_s,
            row[1].sliding_m_s,
            degc(row[0].temp_k)
        ));
    }
    if of.contact == Contact::Bands && bench.curve.half_n_m.is_finite() && !bench.film_carries() {
        doubts.push(format!(
            "{words}: friction of the table rises with sliding: no film that carries shows, and half_n_per_m and exponent are those of the file"
        ));
    }
    doubts
}

/// The largest fall of friction from the slowest to the fastest row of a series of one temperature and pressure that is more than its scatter.
fn steepest_fall(rows: &[BenchRow], has_sd: bool) -> Option<(f64, [BenchRow; 2])> {
    let same = |a: &BenchRow, b: &BenchRow| {
        let pressures = [a.pressure_pa, b.pressure_pa];
        let [low, high] = ends(pressures.into_iter());
        let as_pressed = pressures.iter().all(|p| p.is_nan()) || high <= ONE_PRESSURE * low;
        as_pressed && (a.temp_k - b.temp_k).abs() < ONE_TEMPERATURE_K
    };
    let of_series = |first: &BenchRow| {
        let own = rows.iter().filter(|row| same(first, row));
        let by_speed = |a: &&BenchRow, b: &&BenchRow| a.sliding_m_s.total_cmp(&b.sliding_m_s);
        let (slow, fast) = (own.clone().min_by(by_speed)?, own.max_by(by_speed)?);
        let fall = slow.friction - fast.friction;
        let least = match has_sd {
            true => 2.0 * (slow.sd * slow.sd + fast.sd * fast.sd).sqrt(),
            false => FALLS * slow.friction,
        };
        (fall > least && fast.sliding_m_s > slow.sliding_m_s).then_some((fall, [*slow, *fast]))
    };
    let falls = rows.iter().filter_map(of_series);
    falls.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Numbers of FR-1 and FR-2: ln mu_b, k, ln mu_f, ln N, ln q, m.
type Numbers = [f64; 6];

/// Rows of a table for the fit.
struct Data<'r> {
    rows: &'r [BenchRow],
    ln_x: Vec<f64>,
    /// ln (p/p_0).
    ln_p: Vec<f64>,
    weight: Vec<f64>,
}

/// A fit.
#[derive(Clone, Copy)]
struct Best {
    numbers: Numbers,
    has_film: bool,
    sum: f64,
    free: usize,
}

impl Data<'_> {
    /// Friction of a row (FR-1, FR-2).
    fn friction(&self, numbers: &Numbers, has_film: bool, i: usize) -> f64 {
        let [ln_boundary, rise, ln_film, ln_half, ln_exponent, power] = *numbers;
        let pressed = power * self.ln_p[i];
        let warm = rise * (self.rows[i].temp_k - ZERO_DEGC_K - 85.0);
        let boundary = exp(ln_boundary + warm + pressed);
        if !has_film {
            return boundary;
        }
        let z = exp((exp(ln_exponent) * (self.ln_x[i] - ln_half)).min(600.0));
        let share = z / (1.0 + z);
        (1.0 - share) * boundary + share * exp(ln_film + pressed)
    }

    fn residuals(&self, numbers: &Numbers, has_film: bool) -> Vec<f64> {
        let of = |i: usize| {
            self.weight[i] * (self.friction(numbers, has_film, i) - self.rows[i].friction)
        };
        (0..self.rows.len()).map(of).collect()
    }

    /// The better of the fits with and without a film (FR-5).
    fn best(&self, several_temps: bool, several_pressures: bool, shows_film: bool) -> Best {
        let n = self.rows.len() as f64;
        let mean = self.rows.iter().map(|row| ln(row.friction)).sum::<f64>() / n;
        let mut free = vec![0];
        free.extend(several_temps.then_some(1));
        free.extend(several_pressures.then_some(5));
        free.truncate(self.rows.len());
        let flat = self.fit([mean, 0.0, mean, 0.0, 0.0, 0.0], false, &free);
        let with_film = [free.as_slice(), &[2, 3, 4]].concat();
        // AICc has no value for fewer rows.
        if !shows_film || self.rows.len() < with_film.len() + 2 {
            return flat;
        }
        let [low, high] = ends(self.ln_x.iter().copied().filter(|x| *x > -600.0));
        let mut best = flat;
        for share in [0.2, 0.5, 0.8] {
            let half = low + share * (high - low);
            // Both levels from the rows on either side.
            let of_side = |is: &dyn Fn(f64) -> bool| {
                let own = (0..self.rows.len()).filter(|i| is(self.ln_x[*i]));
                let own: Vec<f64> = own.map(|i| ln(self.rows[i].friction)).collect();
                own.iter().sum::<f64>() / (own.len() as f64).max(1.0)
            };
            let (slow, fast) = (of_side(&|x| x <= half), of_side(&|x| x > half));
            for exponent in [0.7f64, 2.0] {
                let start = [slow, 0.0, fast, half, ln(exponent), 0.0];
                let found = self.fit(start, true, &with_film);
                if self.criterion(&found) < self.criterion(&best) {
                    best = found;
                }
            }
        }
        best
    }

    fn criterion(&self, of: &Best) -> f64 {
        let (n, k) = (self.rows.len() as f64, of.free as f64 + 1.0);
        // An exact fit leaves a sum of rounding size, whose logarithm would decide.
        let mean = (of.sum / n).max(1e-12);
        n * ln(mean) + 2.0 * k * n / (n - k - 1.0).max(0.5) // FR-5
    }

    /// Least squares from a start, by Levenberg and Marquardt.
    fn fit(&self, start: Numbers, has_film: bool, free: &[usize]) -> Best {
        const ITERATIONS: usize = 200;
        let [low, high] = ends(self.ln_x.iter().copied().filter(|x| *x > -600.0));
        let held = |mut numbers: Numbers| {
            numbers[0] = numbers[0].clamp(ln(1e-3), ln(2.0));
            numbers[1] = numbers[1].clamp(-0.05, 0.05);
            numbers[2] = numbers[2].clamp(ln(1e-4), ln(2.0));
            if low < high {
                numbers[3] = numbers[3].clamp(low - ln(30.0), high + ln(30.0));
            }
            numbers[4] = numbers[4].clamp(ln(0.3), ln(8.0));
            numbers[5] = numbers[5].clamp(-2.0, 2.0);
            numbers
        };
        let mut numbers = held(start);
        let mut residuals = self.residuals(&numbers, has_film);
        let sum_of = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let mut sum = sum_of(&residuals);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            let slopes: Vec<Vec<f64>> = free
                .iter()
                .map(|k| {
                    let step = if *k == 1 { 1e-6 } else { 1e-5 };
                    let (mut up, mut down) = (numbers, numbers);
                    up[*k] += step;
                    down[*k] -= step;
                    let (up, down) = (
                        self.residuals(&up, has_film),
                        self.residuals(&down, has_film),
                    );
                    let both = up.iter().zip(&down);
                    both.map(|(up, down)| (up - down) / (2.0 * step)).collect()
                })
                .collect();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let mut fell = false;
            while damping < 1e10 {
                let matrix: Vec<Vec<f64>> = (0..free.len())
                    .map(|i| {
                        let mut row: Vec<f64> = (0..free.len())
                            .map(|k| dot(&slopes[i], &slopes[k]))
                            .collect();
                        row[i] = row[i] * (1.0 + damping) + 1e-12;
                        row.push(-dot(&slopes[i], &residuals));
                        row
                    })
                    .collect();
                let step = solved(matrix);
                let mut next = numbers;
                for (k, step) in free.iter().zip(step) {
                    next[*k] += step;
                }
                let next = held(next);
                let of_next = self.residuals(&next, has_film);
                let new = sum_of(&of_next);
                if new < sum {
                    fell = sum - new > 1e-10 * sum;
                    (numbers, residuals, sum) = (next, of_next, new);
                    damping *= 0.2;
                    break;
                }
                damping *= 5.0;
            }
            if !fell {
                break;
            }
        }
        Best {
            numbers,
            has_film,
            sum,
            free: free.len(),
        }
    }
}

/// A number to four places, as it is shown.
fn rounded(x: f64) -> f64 {
    (1e4 * x).round() / 1e4
}

/// Solves a system of equations, each a row with its right-hand side last, by elimination with pivots; 0 for what has none.
fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()));
        rows.swap(k, pivot.unwrap_or(k));
        let (top, rest) = rows.split_at_mut(k + 1);
        let own = &top[k];
        if own[k].abs() > 0.0 {
            for row in rest {
                let factor = row[k] / own[k];
                for (x, y) in row.iter_mut().zip(own).skip(k) {
                    *x -= factor * y;
                }
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        if rows[k][k].abs() > 0.0 {
            x[k] = (rows[k][n] - known) / rows[k][k];
        }
    }
    x
}
