//! Price of each loss: the car driven again with less of it, or without it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | AT-1 | c_i = B - B(f_i = phi): price of loss i, the fuel saved where it is phi times itself; phi = 0 is without it | derived: definition |
//! | AT-2 | C = B - B(all f = phi): price of all losses | derived: definition |
//! | AT-3 | J = C - sum c_i: interaction, what the parts do not add up to | derived: definition |
//! | AT-4 | J_ij = B(f_i) + B(f_j) - B - B(f_i, f_j); price of i where j is gone = c_i + J_ij | derived: definition |
//! | AT-5 | a_i = B(all phi but i) - B(all phi): price of loss i alone | derived: definition |
//! | AT-6 | phi_G = sum over S without G of \|S\|! (g-\|S\|-1)!/g! [v(S+G) - v(S)], v(S) = B - B(S phi): share of group G; all shares add up to C | source: Shapley 1953 |
//!
//! B is the headline fuel of the car, L/100 km, or that of a group of phases. f_i multiplies loss i (CV-7, MB-6, LC-6); temperatures, pressures,
//! ratios and the other losses follow from the drive. A share of energy e becomes a price of about 2 e, since the engine makes the last kilojoule
//! better than the mean one. A loss warms the oil, so that its removal makes the others larger: J > 0 in the cold. Less load lowers the clamping
//! pressure of a law by throttle: J < 0 of pump and belt.

mod runs;
mod words;

pub use words::answer;

use std::collections::BTreeSet;

use runs::{Burnt, Runs, minus};

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::Conditions;
use cvtcycle_model::transmission::component::LossGroup;
use cvtcycle_model::transmission::loss_factor::LossFactors;
use cvtcycle_output::Component;
use cvtcycle_output::number::fixed;
use cvtcycle_output::summary::{PairPrice, PriceSummary, RunSummary, Settings};

/// A component that loses less over the whole cycle has no price, kJ.
const MIN_KJ: f64 = 1e-3;
/// Interaction of a pair that is large, per cent of the fuel, ...
const LARGE_PERCENT: f64 = 0.1;
/// ... or as a share of the smaller of both prices, ...
const LARGE_SHARE: f64 = 0.1;
/// ... if it is at least this, per cent of the fuel.
const SEEN_PERCENT: f64 = 0.02;
/// Energy at the wheels that a changed car may have more or less where the trace is missed, kJ.
const SAME_WORK_KJ: f64 = 1.0;

/// A car that has been driven, and how its losses are changed.
#[derive(Clone, Copy, Debug)]
pub struct Attribution<'a> {
    /// Input of the car.
    pub setup: &'a Setup,
    /// The cycle.
    pub cycle: &'a Cycle,
    /// How it was driven.
    pub conditions: Conditions,
    /// Settings of the drives.
    pub settings: &'a Settings,
    /// Factor phi on a loss: 0 is without it.
    pub factor: f64,
    /// Results in addition to single losses.
    pub depth: Depth,
}

/// Results in addition to the price of each loss and of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Depth {
    /// Price of each loss alone (AT-5).
    pub alone: bool,
    /// Pairs (AT-4).
    pub pairs: Pairs,
    /// Shares of groups (AT-6).
    pub shapley: bool,
}

/// Pairs of losses that are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pairs {
    /// None; none is driven.
    #[default]
    None,
    /// Those whose interaction is large.
    Large,
    /// All.
    All,
}

/// Fuel of a drive: the headline, then that of each group of phases, L/100 km; NaN without distance.
type Fuel = Vec<f64>;

/// Prices of the losses of a car; `base` are its numbers as it is. The runs are driven on all threads, and summed in one order.
///
/// ```
/// use cvtcycle_config::cycle;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::{Conditions, Start, drive};
/// use cvtcycle_output::summary::{Driven, Settings, run_summary};
/// use cvtcycle_analysis::attribute::{Attribution, Depth, attribute};
/// let setup = load("rover_216_cvt", &Options::default())?;
/// let cycle = cycle::find("constant_50")?;
/// let conditions = Conditions { ambient_k: 263.15, start: Start::Soak, max_dt_s: 1.0, keep_rows: false };
/// let outcome = drive(&setup, &cycle, &conditions);
/// let driven = Driven { name: "rover", setup: &setup, outcome: &outcome };
/// let settings = Settings::default();
/// let base = run_summary(&cycle, "subject", &settings, &driven);
/// // Half of each loss in turn.
/// let of = Attribution { setup: &setup, cycle: &cycle, conditions, settings: &settings, factor: 0.5, depth: Depth::default() };
/// let price = attribute(&of, &base);
/// let parts: f64 = price.losses.values().filter_map(|loss| loss.saved.percent).sum();
/// let rest = price.interaction.percent.expect("a number");
/// assert!((parts + rest - price.together.percent.expect("a number")).abs() < 1e-9);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn attribute(of: &Attribution, base: &RunSummary) -> PriceSummary {
    let runs = Runs::new(of, base);
    let design = Design::new(of, base);
    let [all, single, without, paired, sets] = runs.drive(design.changes(of));
    let prices: Vec<Fuel> = single.iter().map(|run| runs.saved(run)).collect();
    let together = runs.saved(&all[0]);
    let parts = prices.iter();
    let interaction = parts.fold(together.clone(), |left, price| minus(&left, price)); // AT-3
    let loss = |(k, own): (usize, &Component)| {
        let alone = without.get(k);
        let alone = alone.map(|run| runs.saving(&minus(&run.fuel, &all[0].fuel))); // AT-5
        (own.name().to_owned(), runs.loss(*own, &prices[k], alone))
    };
    let components = &design.components;
    let pairs = design.pairs.iter().zip(&paired);
    let pairs = pairs.map(|(pair, run)| runs.pair(pair.map(|k| (components[k], &*prices[k])), run));
    let shown = |pair: &PairPrice| of.depth.pairs == Pairs::All || is_large(pair);
    PriceSummary {
        factor: of.factor,
        losses: components.iter().enumerate().map(loss).collect(),
        together: runs.saving(&together),
        interaction: runs.saving(&interaction),
        pairs: pairs.filter(shown).collect(),
        groups: runs.shares(&design.groups, &sets).into_iter().collect(),
        notes: of.notes(base, components, &runs, &single),
        failures: runs.new_failures(components, &single, &all),
    }
}

/// Losses that are changed, by drive.
struct Design {
    /// The components that lose something, in the order of the power flow.
    components: Vec<Component>,
    /// Pairs of them, by their places.
    pairs: Vec<[usize; 2]>,
    groups: Vec<LossGroup>,
}

impl Design {
    fn new(of: &Attribution, base: &RunSummary) -> Self {
        let own = of.setup.transmission().components().into_iter();
        let loses = |c: &Component| base.loss_kj.get(c.name()).is_some_and(|kj| kj >= MIN_KJ);
        let components: Vec<Component> = own.filter(loses).collect();
        let count = components.len();
        let first = (0..count).filter(|_| of.depth.pairs != Pairs::None);
        let groups = components.iter().filter(|_| of.depth.shapley);
        let groups: BTreeSet<LossGroup> = groups.map(|c| c.group()).collect();
        Design {
            pairs: first
                .flat_map(|a| (a + 1..count).map(move |b| [a, b]))
                .collect(),
            groups: groups.into_iter().collect(),
            components,
        }
    }

    /// Factors of the drives: all losses changed, each by itself, all but each, each pair, each set of groups.
    fn changes(&self, of: &Attribution) -> [Vec<LossFactors>; 5] {
        let own = &self.components;
        let on = |changed: &dyn Fn(Component) -> bool| {
            LossFactors::from_fn(|c| match own.contains(&c) && changed(c) {
                true => of.factor,
                false => 1.0,
            })
        };
        let sets = match self.groups.len() {
            0 => 0,
            count => 1_usize << count,
        };
        let in_set = |set: usize, c: Component| {
            let place = self.groups.iter().position(|group| *group == c.group());
            place.is_some_and(|k| set >> k & 1 == 1)
        };
        let alone = own.iter().filter(|_| of.depth.alone);
        let pair = |[a, b]: &[usize; 2]| on(&|c| c == own[*a] || c == own[*b]);
        [
            vec![on(&|_| true)],
            own.iter().map(|single| on(&|c| c == *single)).collect(),
            alone.map(|left| on(&|c| c != *left)).collect(),
            self.pairs.iter().map(pair).collect(),
            (0..sets).map(|set| on(&|c| in_set(set, c))).collect(),
        ]
    }
}

fn is_large(pair: &PairPrice) -> bool {
    let size = |x: Option<f64>| x.map_or(0.0, f64::abs);
    let percent = size(pair.interaction.percent);
    let smaller = size(pair.a_with_b).min(size(pair.b_with_a));
    percent >= LARGE_PERCENT
        || (percent >= SEEN_PERCENT && size(pair.interaction.l_per_100km) >= LARGE_SHARE * smaller)
}

impl Attribution<'_> {
    fn notes(
        &self,
        base: &RunSummary,
        components: &[Component],
        runs: &Runs,
        single: &[Burnt],
    ) -> Vec<String> {
        let mut notes = Vec::new();
        if base.headline_fuel().is_none() {
            notes.push(
                "the car does not move, or hardly: there is no fuel per distance to save"
                    .to_owned(),
            );
        }
        let maps = components
            .iter()
            .filter(|c| [Component::BeltMap, Component::BoxMap].contains(c));
        notes.extend(maps.map(|c| {
            format!(
                "{} is a measured map: its parts have no prices of their own",
                c.name()
            )
        }));
        if base.trace_missed_s > 0.0 {
            for (component, run) in components.iter().zip(single) {
                let more_kj = run.wheels_kj - runs.base.wheels_kj;
                if more_kj.abs() > SAME_WORK_KJ {
                    notes.push(format!(
                        "{}: the car misses the trace, and without this loss gives the wheels {} kJ more",
                        component.name(),
                        fixed(more_kj, 0)
                    ));
                }
            }
        }
        notes
    }
}

/// Shapley's share of each player in the worth of all sets, by the bits of a set; each worth is a list of numbers (AT-6).
fn shapley(players: usize, worth: &[Fuel]) -> Vec<Fuel> {
    let weight = |size: usize| {
        // |S|! (g - |S| - 1)!/g! is one over g times the number of sets of that size without the player.
        let sets = (0..size).fold(1.0, |sets, k| {
            sets * (players - 1 - k) as f64 / (k + 1) as f64
        });
        1.0 / (players as f64 * sets)
    };
    let share = |player: usize| {
        let bit = 1_usize << player;
        let mut share = vec![0.0; worth.first().map_or(0, Vec::len)];
        for (set, without) in worth.iter().enumerate().filter(|(set, _)| set & bit == 0) {
            let weight = weight(set.count_ones() as usize);
            let more = minus(&worth[set | bit], without);
            for (sum, more) in share.iter_mut().zip(more) {
                *sum += weight * more; // AT-6
            }
        }
        share
    };
    (0..players).map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worths that are no sum of parts, with a second number a set.
    fn worth(players: usize) -> Vec<Fuel> {
        let of = |set: usize| {
            let x = (set as f64 * 1.7).sin() * f64::from(set.count_ones());
            vec![x, 2.0 * x + set as f64]
        };
        (0..1 << players).map(of).collect()
    }

    fn permutations(items: &[usize]) -> Vec<Vec<usize>> {
        if items.is_empty() {
            return vec![Vec::new()];
        }
        let first = |k: usize| {
            let mut rest = items.to_vec();
            let own = rest.remove(k);
            permutations(&rest).into_iter().map(move |mut tail| {
                tail.insert(0, own);
                tail
            })
        };
        (0..items.len()).flat_map(first).collect()
    }

    #[test]
    fn shares_of_five_are_means_over_120_orders_and_add_up() {
        let worth = worth(5);
        let shares = shapley(5, &worth);
        let orders = permutations(&[0, 1, 2, 3, 4]);
        assert_eq!(orders.len(), 120);
        for number in 0..2 {
            for player in 0..5 {
                let gain = |order: &Vec<usize>| {
                    let before = order.iter().take_while(|p| **p != player);
                    let set = before.fold(0, |set, p| set | 1 << p);
                    worth[set | 1 << player][number] - worth[set][number]
                };
                let mean = orders.iter().map(gain).sum::<f64>() / 120.0;
                assert!((shares[player][number] - mean).abs() < 1e-12);
            }
            let sum: f64 = shares.iter().map(|share| share[number]).sum();
            assert!((sum - (worth[31][number] - worth[0][number])).abs() < 1e-12);
        }
    }

    #[test]
    fn shares_of_two_are_their_prices_and_half_of_the_interaction() {
        let worth = [0.0, 3.0, 5.0, 9.0].map(|x| vec![x]);
        let shares = shapley(2, &worth);
        assert_eq!(shares, [vec![3.5], vec![5.5]], "c + J/2 with J = 1");
    }
}
