//! Prices as sentences, for the terminal and for reports.

use cvtcycle_output::Component;
use cvtcycle_output::number::{fixed, plain};
use cvtcycle_output::summary::{PriceSummary, RunSummary};

/// Losses that a sentence names.
const NAMED: usize = 5;
/// Interaction that a sentence takes for none, points.
const SMALL: f64 = 0.05;

/// Describes the cost of a car's losses in a sentence; `None` without a price.
pub fn answer(run: &RunSummary) -> Option<String> {
    let price = run.price.as_ref()?;
    let whole = price.together.percent?;
    let priced = |c: Component| {
        let own = price.losses.get(c.name())?;
        Some((run.loss_words(c.name()), own.saved.percent?, own.range))
    };
    let mut losses: Vec<(String, f64, Option<[f64; 2]>)> =
        Component::ALL.into_iter().filter_map(priced).collect();
    losses.sort_by(|a, b| b.1.total_cmp(&a.1));
    let rest: f64 = losses
        .iter()
        .skip(NAMED)
        .map(|(_, percent, _)| percent)
        .sum();
    let count = losses.len().saturating_sub(NAMED);
    let named = losses.iter().take(NAMED);
    let mut parts: Vec<String> = named
        .map(|(name, x, range)| match range {
            Some([low, high]) => format!(
                "{name} {} ({} to {})",
                fixed(*x, 1),
                fixed(*low, 1),
                fixed(*high, 1)
            ),
            None => format!("{name} {}", fixed(*x, 1)),
        })
        .collect();
    if count > 0 {
        parts.push(format!("{count} others {}", fixed(rest, 1)));
    }
    let (whole, parts) = (fixed(whole, 1), parts.join(", "));
    let tail = of_interaction(run, price);
    Some(match price.factor {
        factor if factor > 0.0 => {
            let factor = plain(factor);
            format!(
                "With {factor} times each transmission loss it burns {whole} % less: {parts}; {tail}."
            )
        }
        _ => format!(
            "Without its transmission losses it would burn {whole} % less: {parts}; {tail}."
        ),
    })
}

/// The interaction with its cause, as a clause.
fn of_interaction(run: &RunSummary, price: &PriceSummary) -> String {
    let points = price.interaction.percent.unwrap_or(0.0);
    let size = fixed(points.abs(), 1);
    if points.abs() < SMALL {
        return "removed together as much as one by one".to_owned();
    }
    let (word, cause) = match (points > 0.0, run.transmission.as_str()) {
        (true, _) => ("more", "without one loss the others grow in colder oil"),
        (false, "cvt") => ("less", "less load lowers the clamping pressure"),
        (false, _) => ("less", "less load makes the others smaller"),
    };
    format!("removed together {size} points {word} than one by one, since {cause}")
}
