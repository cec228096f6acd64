//! Price of each loss of the CVT, warm and cold: picture and table.

use cvtcycle::analysis::attribute::{Attribution, Depth, Pairs, attribute};
use cvtcycle::config::cycle::embedded;
use cvtcycle::config::render;
use cvtcycle::config::setup::{Options, load};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::summary::{Driven, RunSummary, Settings, run_summary};
use cvtcycle::report::charts::price_dots;
use std::fmt::Write as _;

const CAR: &str = "rover_216_cvt";
/// Ambient temperatures, degC; the first one is that of the picture.
const AT: [f64; 2] = [25.0, -10.0];

fn priced(ambient_degc: f64) -> Result<RunSummary, String> {
    let setup = &load(CAR, &Options::default()).map_err(|found| render(&found, false))?;
    let cycle = &embedded("ece15_eudc").ok_or("no such cycle")?;
    let conditions = Conditions {
        ambient_k: ambient_degc + ZERO_DEGC_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let settings = &Settings::default();
    let outcome = &drive(setup, cycle, &conditions);
    let name = CAR;
    let driven = Driven {
        name,
        setup,
        outcome,
    };
    let mut run = run_summary(cycle, "subject", settings, &driven);
    let depth = Depth {
        alone: true,
        pairs: Pairs::Large,
        shapley: false,
    };
    let attribution = Attribution {
        setup,
        cycle,
        conditions,
        settings,
        factor: 0.0,
        depth,
    };
    run.price = Some(attribute(&attribution, &run));
    Ok(run)
}

/// Picture at the first temperature, and table of all.
/// # Errors
/// A sentence, if the car cannot be read.
pub fn picture_and_table() -> Result<(String, String), String> {
    let runs = AT.map(priced);
    let mut text =
        "<!-- Written by `tools/docs` from ECE15+EUDC after a soak. -->\n\n| loss |".to_owned();
    for degc in AT {
        let _ = write!(
            text,
            " energy, % of the fuel's, {degc} degC | price, % of the fuel | alone, % |"
        );
    }
    text += "\n|---|";
    text += &"---|".repeat(3 * AT.len());
    let runs: Vec<RunSummary> = runs.into_iter().collect::<Result<_, _>>()?;
    let prices = || runs.iter().filter_map(|run| run.price.as_ref());
    let names = prices()
        .next()
        .map(|price| price.losses.keys())
        .into_iter()
        .flatten();
    for name in names {
        let _ = write!(text, "\n| {} |", name.replace('_', " "));
        for price in prices() {
            let loss = price.losses.get(name);
            let alone = loss.and_then(|loss| loss.alone.as_ref()?.percent);
            let cells = [
                loss.and_then(|l| l.energy_percent),
                loss.and_then(|l| l.saved.percent),
                alone,
            ];
            text += &cells.map(|x| format!(" {} |", fixed(x, 2))).concat();
        }
    }
    text += "\n| together |";
    for price in prices() {
        let _ = write!(text, " | {} | |", fixed(price.together.percent, 2));
    }
    text += "\n| interaction |";
    for price in prices() {
        let _ = write!(text, " | {} | |", signed(price.interaction.percent, 2));
    }
    let subject = format!("{CAR}, {} \u{b0}C", AT[0]);
    Ok((price_dots(&runs[0], &subject).svg, text + "\n"))
}
