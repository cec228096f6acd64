//! What the data alone do not identify, in words.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-16 | columns scaled to relative changes: x dr/dx; where start or x is 0, by the range | ASSUMED |
//! | CA-17 | W = U s V'; a direction v is unknown where s is at most 1e-6 of the largest, or where its standard deviation 1 / s changes a parameter by more than its value (if scaled by it) or its range | ASSUMED |
//! | CA-18 | P = sum of v v' over unknown directions; parameters with P_kk > 0.05^2 that P_kl links (above 0.01) belong together; c of them with rank c - 1 of P leave one known combination w, the eigenvector of P of least eigenvalue: the product of x_k^w_k | derived: W w is the only change that the data see |
//!
//! | CA-20 | in a group that trades against each other, a pair whose columns of W have a cosine of 0.995 or more in size acts alike: w = their lengths, with the sign of the cosine | derived: seen by the data is only \|a\| dx_a/x_a +- \|b\| dx_b/x_b |
//!
//! A single unknown direction v = (1, -1) leaves w = (1, 1), a product; (1, 1) leaves (1, -1), a ratio. All is local: said of the solution, in the
//! linear approximation there.

use nalgebra::DMatrix;

use super::uncertainty::{NOISE, dead, scaled, singular};
use super::{Fit, Parameter};

/// Least weight of a parameter in what is unknown (CA-18).
const LEAST_WEIGHT: f64 = 0.05;
/// Least link between two (CA-18).
const LEAST_LINK: f64 = 0.01;
/// Least cosine of two that act alike (CA-20).
const ALIKE: f64 = 0.995;
/// Exponents this near to a whole one count as one.
const WHOLE: f64 = 0.03;

/// Scale of each parameter's changes, and whether it is the value (CA-16).
pub(super) fn relative_scales(fit: &Fit, parameters: &[Parameter]) -> (Vec<f64>, Vec<bool>) {
    let is_nothing = |x: f64| x.abs() <= f64::MIN_POSITIVE;
    let scale = |(p, x): (&Parameter, &f64)| {
        if is_nothing(p.start) || is_nothing(*x) {
            (p.range(), false)
        } else {
            (*x, true)
        }
    }; // CA-16
    parameters.iter().zip(&fit.values).map(scale).unzip()
}

/// Directions of which nothing is known (CA-17).
struct Unknown {
    /// Projector on them (CA-18), by the parameters looked at.
    projector: DMatrix<f64>,
    /// Standard deviation of each parameter in them, in its scale; infinite where a direction is null.
    deviation: Vec<f64>,
}

/// What the data alone, without priors, do not identify: sentences in the order of the parameters. None where they identify all.
#[must_use]
pub fn words(fit: &Fit, parameters: &[Parameter]) -> Vec<String> {
    let dead = dead(fit, parameters);
    let (scales, relative) = relative_scales(fit, parameters);
    let mut said: Vec<(usize, String)> = Vec::new();
    let mut looked_at = Vec::new();
    for (k, column) in fit.jacobian.column_iter().enumerate() {
        let name = &parameters[k].name;
        if column.iter().any(|slope| !slope.is_finite()) {
            said.push((
                k,
                format!(
                    "{name}: no derivative at the solution, so the data say nothing of it there"
                ),
            ));
        } else if dead.contains(&k) {
            said.push((
                k,
                format!(
                    "{name} is not identified by these data: it moves no residual at the solution"
                ),
            ));
        } else {
            looked_at.push(k);
        }
    }
    let unknown = unknown(fit, parameters, &looked_at, (&scales, &relative));
    for group in together(&unknown.projector) {
        let sentence = if let [one] = group[..] {
            let k = looked_at[one];
            alone(
                &parameters[k],
                unknown.deviation[one],
                scales[k],
                relative[k],
            )
        } else {
            let names: Vec<&str> = group
                .iter()
                .map(|&i| parameters[looked_at[i]].name.as_str())
                .collect();
            combined(
                &names,
                &block(&unknown.projector, &group),
                group.iter().all(|&i| relative[looked_at[i]]),
            )
        };
        let trades = sentence.contains("trade against");
        said.push((looked_at[group[0]], sentence));
        if group.len() > 2 && trades {
            let members: Vec<usize> = group
                .iter()
                .map(|&i| looked_at[i])
                .filter(|&k| relative[k])
                .collect();
            said.extend(
                alike(fit, parameters, &members, &scales)
                    .into_iter()
                    .map(|sentence| (looked_at[group[0]], sentence)),
            );
        }
    }
    said.sort_by_key(|(k, _)| *k);
    said.into_iter().map(|(_, sentence)| sentence).collect()
}

fn unknown(
    fit: &Fit,
    parameters: &[Parameter],
    looked_at: &[usize],
    (scales, relative): (&[f64], &[bool]),
) -> Unknown {
    let n = looked_at.len();
    let (values, v_t) = singular(&scaled(&fit.jacobian, looked_at, scales));
    let largest = values.iter().copied().fold(0.0, f64::max);
    // A unit step in the scale of a parameter, as a share of its range, and of its value if that is its scale.
    let reach = |i: usize| {
        (scales[looked_at[i]].abs() / parameters[looked_at[i]].range())
            .max(if relative[looked_at[i]] { 1.0 } else { 0.0 })
    };
    let (mut projector, mut variance) = (DMatrix::zeros(n, n), vec![0.0; n]);
    for (s, v) in values.iter().zip(v_t.row_iter()) {
        let null = *s <= NOISE * largest;
        let weak = (0..n).any(|i| v[i].abs() * reach(i) > *s); // CA-17
        if !(null || weak) {
            continue;
        }
        projector += v.transpose() * v; // CA-18
        for (variance, v) in variance.iter_mut().zip(v.iter()) {
            *variance += if null { f64::INFINITY } else { (v / s).powi(2) };
        }
    }
    Unknown {
        projector,
        deviation: variance.into_iter().map(f64::sqrt).collect(),
    }
}

/// Parameters that belong together (CA-18), each group and the groups in ascending order.
fn together(projector: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let members: Vec<usize> = (0..projector.nrows())
        .filter(|&k| projector[(k, k)] > LEAST_WEIGHT * LEAST_WEIGHT)
        .collect();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in members {
        let (linked, mut others): (Vec<_>, Vec<_>) = groups
            .into_iter()
            .partition(|group| group.iter().any(|&l| projector[(k, l)].abs() > LEAST_LINK));
        let mut group: Vec<usize> = linked.into_iter().flatten().chain([k]).collect();
        group.sort_unstable();
        others.push(group);
        groups = others;
    }
    groups.sort();
    groups
}

fn block(matrix: &DMatrix<f64>, rows: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows.len(), |i, j| matrix[(rows[i], rows[j])])
}

fn alone(parameter: &Parameter, deviation: f64, scale: f64, relative: bool) -> String {
    let name = &parameter.name;
    if !deviation.is_finite() {
        return format!("{name} is not identified by these data");
    }
    let of_range = deviation * scale.abs() / parameter.range();
    let of_value = if relative {
        format!("{deviation:.2} of its value, ")
    } else {
        String::new()
    };
    format!(
        "{name} is not identified by these data: its standard deviation is {of_value}{of_range:.2} of its range"
    )
}

/// Pairs of a large group that act alike (CA-20).
fn alike(fit: &Fit, parameters: &[Parameter], members: &[usize], scales: &[f64]) -> Vec<String> {
    let columns = scaled(&fit.jacobian, members, scales);
    let mut said = Vec::new();
    for i in 0..members.len() {
        for j in i + 1..members.len() {
            let (a, b) = (columns.column(i), columns.column(j));
            let cosine = a.dot(&b) / (a.norm() * b.norm());
            if cosine.abs() >= ALIKE {
                let names = [
                    parameters[members[i]].name.as_str(),
                    parameters[members[j]].name.as_str(),
                ];
                let known = power_product(&names, &[a.norm(), b.norm() * cosine.signum()]);
                said.push(format!(
                    "{} and {} act alike: nearly only {known} is known",
                    names[0], names[1]
                ));
            }
        }
    }
    said
}

/// What is known of several (CA-18).
fn combined(names: &[&str], projector: &DMatrix<f64>, relative: bool) -> String {
    let (list, all) = (listed(names), names.len());
    let unknown = projector.trace().round() as usize;
    if unknown >= all {
        return format!("{list} are not identified by these data");
    }
    if unknown + 1 < all || !relative {
        let known = all - unknown;
        let combinations = if known == 1 {
            "combination of them is"
        } else {
            "combinations of them are"
        };
        return format!("{list} trade against each other: only {known} {combinations} known");
    }
    let eigen = projector.clone().symmetric_eigen();
    let w: Vec<f64> = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .iter()
        .copied()
        .collect();
    let known = power_product(names, &w);
    format!("{list}: only {known} is known")
}

/// A product of powers in words, the largest power being 1.
fn power_product(names: &[&str], w: &[f64]) -> String {
    let largest = w.iter().copied().fold(0.0, |a: f64, b| {
        if b.abs() > a.abs() * (1.0 + WHOLE) {
            b
        } else {
            a
        }
    });
    let powers: Vec<f64> = w.iter().map(|w| w / largest).collect();
    let whole = |p: f64, one: f64| (p - one).abs() <= WHOLE;
    match powers[..] {
        [a, b] if whole(a, 1.0) && whole(b, 1.0) => "their product".to_string(),
        [a, b] if whole(a * b, -1.0) => "their ratio".to_string(),
        _ => {
            let power = |(name, p): (&&str, &f64)| {
                if whole(*p, 1.0) {
                    (*name).to_string()
                } else {
                    format!("{name}^{p:.2}")
                }
            };
            names
                .iter()
                .zip(&powers)
                .map(power)
                .collect::<Vec<_>>()
                .join(" x ")
        }
    }
}

fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}
