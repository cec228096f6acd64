//! Parameters and combinations that the data alone do not identify, as sentences.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-17 | W = U s V'; a direction v is unknown where s is at most 1e-6 of the largest, or where its standard deviation 1 / s changes a parameter by more than its value (if scaled by it) or its range | ASSUMED |
//! | CA-18 | P = sum of v v' over unknown directions; parameters with P_kk > 0.05^2 that P_kl links (above 0.01) belong together; c of them with rank c - 1 of P leave one known combination w, the eigenvector of P of least eigenvalue: the product of x_k^w_k | derived: W w is the only change that the data see |
//! | CA-20 | in a group that trades against each other, a pair whose columns of W have a cosine of 0.995 or more in size acts alike: w = their lengths, with the sign of the cosine | derived: seen by the data is only \|a\| dx_a/x_a +- \|b\| dx_b/x_b |
//!
//! A single unknown direction v = (1, -1) leaves w = (1, 1), a product; (1, 1) leaves (1, -1), a ratio. All is local: it holds at the solution,
//! in the linear approximation there.

use nalgebra::DMatrix;

use super::types::{Fit, Parameter};
use super::uncertainty::{NOISE, dead, relative_scales, scaled, singular};

/// Least weight of a parameter in unknown directions (CA-18).
const MIN_WEIGHT: f64 = 0.05;
/// Least link between two (CA-18).
const MIN_LINK: f64 = 0.01;
/// Least cosine of two that act alike (CA-20).
const ALIKE: f64 = 0.995;
/// Exponents this near to a whole one count as one.
const WHOLE: f64 = 0.03;

/// What the data alone, without priors, do not identify: sentences in the order of the parameters. Empty if they identify all.
#[must_use]
pub fn not_identified(fit: &Fit, parameters: &[Parameter]) -> Vec<String> {
    let dead = dead(fit, parameters);
    let mut sentences: Vec<(usize, String)> = Vec::new();
    let mut members = Vec::new();
    for (k, column) in fit.jacobian.column_iter().enumerate() {
        let name = &parameters[k].name;
        if column.iter().any(|slope| !slope.is_finite()) {
            let why = "no derivative at the solution, so the data say nothing of it there";
            sentences.push((k, format!("{name}: {why}")));
        } else if dead.contains(&k) {
            let why = "is not identified by these data: it moves no residual at the solution";
            sentences.push((k, format!("{name} {why}")));
        } else {
            members.push(k);
        }
    }
    let analysis = Analysis::new(fit, parameters, members);
    for group in together(&analysis.projector) {
        let first = analysis.members[group[0]];
        let all = analysis.sentences(&group);
        sentences.extend(all.into_iter().map(|sentence| (first, sentence)));
    }
    sentences.sort_by_key(|(k, _)| *k);
    sentences
        .into_iter()
        .map(|(_, sentence)| sentence)
        .collect()
}

/// The unknown directions of the parameters that have an effect.
struct Analysis<'a> {
    fit: &'a Fit,
    parameters: &'a [Parameter],
    /// Scale of each parameter, and whether it is the value (CA-16).
    scales: Vec<f64>,
    relative: Vec<bool>,
    /// The parameters that have an effect.
    members: Vec<usize>,
    /// Projector on the unknown directions (CA-18), by the members.
    projector: DMatrix<f64>,
    /// Standard deviation of each member in them, in its scale; infinite where a direction is null.
    deviation: Vec<f64>,
}

impl<'a> Analysis<'a> {
    fn new(fit: &'a Fit, parameters: &'a [Parameter], members: Vec<usize>) -> Self {
        let (scales, relative) = relative_scales(fit, parameters);
        let n = members.len();
        let (values, v_t) = singular(&scaled(&fit.jacobian, &members, &scales));
        let largest = values.iter().copied().fold(0.0, f64::max);
        // A unit step in the scale of a parameter, as a share of its range, and of its value if that is its scale.
        let reach = |i: usize| {
            let k = members[i];
            let of_value = if relative[k] { 1.0 } else { 0.0 };
            (scales[k].abs() / parameters[k].range()).max(of_value)
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
        Analysis {
            fit,
            parameters,
            scales,
            relative,
            members,
            projector,
            deviation: variance.into_iter().map(f64::sqrt).collect(),
        }
    }

    fn name(&self, member: usize) -> &str {
        &self.parameters[self.members[member]].name
    }

    /// What is known of a group.
    fn sentences(&self, group: &[usize]) -> Vec<String> {
        if let [one] = group {
            return vec![self.alone(*one)];
        }
        let names: Vec<&str> = group.iter().map(|&i| self.name(i)).collect();
        let (list, all) = (listed(&names), names.len());
        let block = DMatrix::from_fn(all, all, |i, j| self.projector[(group[i], group[j])]);
        let unknown = block.trace().round() as usize;
        if unknown >= all {
            return vec![format!("{list} are not identified by these data")];
        }
        let relative = group.iter().all(|&i| self.relative[self.members[i]]);
        let known = all - unknown;
        if known == 1 && relative {
            let eigen = block.symmetric_eigen();
            let w = eigen.eigenvectors.column(eigen.eigenvalues.imin());
            let product = power_product(&names, &w.iter().copied().collect::<Vec<f64>>());
            return vec![format!("{list}: only {product} is known")];
        }
        let are = if known == 1 {
            " of them is"
        } else {
            "s of them are"
        };
        let first = format!("{list} trade against each other: only {known} combination{are} known");
        let mut sentences = vec![first];
        if all > 2 {
            sentences.extend(self.alike(group));
        }
        sentences
    }

    fn alone(&self, member: usize) -> String {
        let (k, deviation) = (self.members[member], self.deviation[member]);
        let name = self.name(member);
        if !deviation.is_finite() {
            return format!("{name} is not identified by these data");
        }
        let of_range = deviation * self.scales[k].abs() / self.parameters[k].range();
        let of_value = match self.relative[k] {
            true => format!("{deviation:.2} of its value, "),
            false => String::new(),
        };
        format!(
            "{name} is not identified by these data: its standard deviation is {of_value}{of_range:.2} of its range"
        )
    }

    /// Pairs of a group that act alike (CA-20).
    fn alike(&self, group: &[usize]) -> Vec<String> {
        let members = group.iter().map(|&i| self.members[i]);
        let members: Vec<usize> = members.filter(|&k| self.relative[k]).collect();
        let columns = scaled(&self.fit.jacobian, &members, &self.scales);
        let mut sentences = Vec::new();
        for i in 0..members.len() {
            for j in i + 1..members.len() {
                let (a, b) = (columns.column(i), columns.column(j));
                let cosine = a.dot(&b) / (a.norm() * b.norm());
                if cosine.abs() >= ALIKE {
                    let names = [i, j].map(|i| self.parameters[members[i]].name.as_str());
                    let known = power_product(&names, &[a.norm(), b.norm() * cosine.signum()]);
                    let [a, b] = names;
                    sentences.push(format!(
                        "{a} and {b} act alike: nearly only {known} is known"
                    ));
                }
            }
        }
        sentences
    }
}

/// Members that belong together (CA-18), each group and the groups in ascending order.
fn together(projector: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let members = (0..projector.nrows()).filter(|&k| projector[(k, k)] > MIN_WEIGHT * MIN_WEIGHT);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in members {
        let (linked, mut others): (Vec<_>, Vec<_>) = groups
            .into_iter()
            .partition(|group| group.iter().any(|&l| projector[(k, l)].abs() > MIN_LINK));
        let mut group: Vec<usize> = linked.into_iter().flatten().chain([k]).collect();
        group.sort_unstable();
        others.push(group);
        groups = others;
    }
    groups.sort();
    groups
}

/// A product of powers in words, the largest power being 1.
fn power_product(names: &[&str], w: &[f64]) -> String {
    let larger = |a: f64, b: &f64| {
        if b.abs() > a.abs() * (1.0 + WHOLE) {
            *b
        } else {
            a
        }
    };
    let largest = w.iter().fold(0.0, larger);
    let powers: Vec<f64> = w.iter().map(|w| w / largest).collect();
    let whole = |p: f64, one: f64| (p - one).abs() <= WHOLE;
    match powers[..] {
        [a, b] if whole(a, 1.0) && whole(b, 1.0) => "their product".to_string(),
        [a, b] if whole(a * b, -1.0) => "their ratio".to_string(),
        _ => {
            let power = |(name, p): (&&str, &f64)| match whole(*p, 1.0) {
                true => (*name).to_string(),
                false => format!("{name}^{p:.2}"),
            };
            let powers: Vec<String> = names.iter().zip(&powers).map(power).collect();
            powers.join(" x ")
        }
    }
}

fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}
