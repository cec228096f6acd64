//! Tables of the prices of losses: single losses, pairs and groups.

use std::borrow::Cow;
use std::io::{self, Write};

use crate::columns;
use crate::summary::{LossPrice, PairPrice, RunSummary, Saving};
use crate::table::{Column, write_csv};

/// A car at an ambient temperature.
#[derive(Clone, Copy, Debug)]
pub struct PricedCar<'a> {
    /// Summary with prices.
    pub run: &'a RunSummary,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
}

/// A price in the whole cycle, or in a group of its phases.
struct PriceRow<'a> {
    at: PricedCar<'a>,
    /// Index of the group of phases; `None` for the whole cycle.
    phase: Option<usize>,
    name: &'a str,
    loss: Option<&'a LossPrice>,
    saved: &'a Saving,
}

impl PriceRow<'_> {
    /// Fuel of a saving in the part of the cycle that the row covers, L/100 km.
    fn litres(&self, saving: Option<&Saving>) -> f64 {
        let litres = saving.and_then(|saving| match self.phase {
            None => saving.l_per_100km,
            Some(k) => saving.phases.iter().nth(k).and_then(|(_, litres)| litres),
        });
        litres.unwrap_or(f64::NAN)
    }

    fn percent(&self) -> f64 {
        let fuel = match self.phase {
            None => self.at.run.headline_fuel(),
            Some(k) => self.at.run.phases[k].fuel_l_per_100km,
        };
        100.0 * self.litres(Some(self.saved)) / fuel.unwrap_or(f64::NAN)
    }

    /// Evaluates a number of the loss; NaN in rows of a group of phases.
    fn cycle_number(&self, number: fn(&LossPrice) -> Option<f64>) -> f64 {
        let loss = self.loss.filter(|_| self.phase.is_none());
        loss.and_then(number).unwrap_or(f64::NAN)
    }
}

fn text(text: &str) -> Cow<'static, str> {
    text.to_owned().into()
}

fn price_columns<'a>() -> Vec<Column<PriceRow<'a>>> {
    columns! { PriceRow<'a>;
        text "vehicle", "", "name of the vehicle", r => text(&r.at.run.vehicle);
        number "ambient_degc", "degC", "ambient temperature", r => r.at.ambient_degc;
        text "phase", "", "part of the cycle, or total", r => text(r.phase.map_or("total", |k| &r.at.run.phases[k].name));
        text "component", "", "component, together, or interaction", r => text(r.name);
        text "group", "", "group with which the loss is shared out", r => text(r.loss.map_or("", |loss| &loss.group));
        number "loss_kj", "kJ", "energy of the loss over the whole cycle", r => r.cycle_number(|loss| loss.loss_kj);
        number "energy_percent", "%", "that energy over the fuel's", r => r.cycle_number(|loss| loss.energy_percent);
        number "saved_l_per_100km", "L/100 km", "fuel saved with the factor on this loss", r => r.litres(Some(r.saved));
        number "saved_percent", "%", "that fuel over the fuel of the car", r => r.percent();
        number "alone_l_per_100km", "L/100 km", "fuel that the loss adds to a car with the factor on all", r => r.litres(r.loss.and_then(|loss| loss.alone.as_ref()));
    }
}

type PairRow<'a> = (PricedCar<'a>, &'a PairPrice);

fn pair_columns<'a>() -> Vec<Column<PairRow<'a>>> {
    let or_nan = |x: Option<f64>| x.unwrap_or(f64::NAN);
    columns! { PairRow<'a>;
        text "vehicle", "", "name of the vehicle", (at, _) => text(&at.run.vehicle);
        number "ambient_degc", "degC", "ambient temperature", (at, _) => at.ambient_degc;
        text "a", "", "first loss", (_, p) => text(&p.a);
        text "b", "", "second loss", (_, p) => text(&p.b);
        number "interaction_l_per_100km", "L/100 km", "what both at once save more than each by itself", (_, p) => or_nan(p.interaction.l_per_100km);
        number "a_with_b_l_per_100km", "L/100 km", "price of the first loss in the car as it is", (_, p) => or_nan(p.a_with_b);
        number "a_without_b_l_per_100km", "L/100 km", "price of the first loss with the factor on the second", (_, p) => or_nan(p.a_without_b);
        number "b_with_a_l_per_100km", "L/100 km", "price of the second loss in the car as it is", (_, p) => or_nan(p.b_with_a);
        number "b_without_a_l_per_100km", "L/100 km", "price of the second loss with the factor on the first", (_, p) => or_nan(p.b_without_a);
    }
}

type ShareRow<'a> = (PricedCar<'a>, &'a str, &'a Saving);

fn share_columns<'a>() -> Vec<Column<ShareRow<'a>>> {
    columns! { ShareRow<'a>;
        text "vehicle", "", "name of the vehicle", (at, _, _) => text(&at.run.vehicle);
        number "ambient_degc", "degC", "ambient temperature", (at, _, _) => at.ambient_degc;
        text "group", "", "group of losses", (_, name, _) => text(name);
        number "share_l_per_100km", "L/100 km", "share of the price of all losses", (_, _, s) => s.l_per_100km.unwrap_or(f64::NAN);
        number "share_percent", "%", "that share over the fuel of the car", (_, _, s) => s.percent.unwrap_or(f64::NAN);
    }
}

/// Rows of a car for the whole cycle, or for a group of its phases.
fn rows(at: PricedCar<'_>, phase: Option<usize>) -> Vec<PriceRow<'_>> {
    let Some(price) = &at.run.price else {
        return Vec::new();
    };
    let losses = price.losses.iter();
    let losses = losses.map(|(name, loss)| (name.as_str(), Some(loss), &loss.saved));
    let whole = [
        ("together", None, &price.together),
        ("interaction", None, &price.interaction),
    ];
    let row = |(name, loss, saved)| PriceRow {
        at,
        phase,
        name,
        loss,
        saved,
    };
    losses.chain(whole).map(row).collect()
}

/// Writes the price of each loss, of all together and the interaction; for the whole cycle, then for each group of its phases.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_prices(out: impl Write, cars: &[PricedCar]) -> io::Result<()> {
    let priced = cars.iter().flat_map(|at| {
        // The only group of a cycle is its total.
        let groups = at.run.phases.len();
        let phases = (0..groups).filter(move |_| groups > 1).map(Some);
        let parts = [None].into_iter().chain(phases);
        parts.flat_map(|phase| rows(*at, phase))
    });
    write_csv(out, &price_columns(), priced, &[])
}

/// Writes pairs of losses.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_pairs(out: impl Write, cars: &[PricedCar]) -> io::Result<()> {
    let pairs = cars.iter().flat_map(|at| {
        let pairs = at.run.price.iter().flat_map(|price| &price.pairs);
        pairs.map(|pair| (*at, pair))
    });
    write_csv(out, &pair_columns(), pairs, &[])
}

/// Writes the shares of groups.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_shares(out: impl Write, cars: &[PricedCar]) -> io::Result<()> {
    let shares = cars.iter().flat_map(|at| {
        let groups = at.run.price.iter().flat_map(|price| &price.groups);
        groups.map(|(name, share)| (*at, name.as_str(), share))
    });
    write_csv(out, &share_columns(), shares, &[])
}
