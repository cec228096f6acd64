//! Knowledge of a fluid's friction, contact by contact: what was measured with this fluid, and what is that of the reference fluid.

use crate::KeyInfo;
use cvtcycle_model::keys::ZERO_DEGC_K;
use cvtcycle_model::lubricant::{Bench, Contact, Lubricant};

/// The fluid whose friction others borrow: that of the car that the model was fitted to.
pub const REFERENCE: &str = "cvtf_ezl799_class";

/// Origin of the friction of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A table that a bench measured with this fluid.
    Table,
    /// A value with a source, or fitted to tests with this fluid.
    Value,
    /// Not measured with this fluid: a value that was assumed, or the program's.
    Borrowed,
    /// Nothing is known, and nothing depends on it.
    Unknown,
}

impl Origin {
    /// One word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Origin::Table => "measured",
            Origin::Value => "known",
            Origin::Borrowed => "borrowed",
            Origin::Unknown => "unknown",
        }
    }
}

/// Knowledge of one contact.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownContact {
    /// The contact.
    pub contact: Contact,
    /// Origin of its friction.
    pub origin: Origin,
    /// In words: range of the table, source of the value.
    pub words: String,
}

/// Knowledge of all contacts of a fluid from the keys of its file, which begin with `prefix`.
#[must_use]
pub fn contacts(fluid: &Lubricant, keys: &[KeyInfo], prefix: &str) -> Vec<KnownContact> {
    let of = |contact: Contact| {
        let bench = fluid.benches.iter().find(|bench| bench.contact == contact);
        let (origin, words) = match bench {
            Some(bench) => (Origin::Table, of_table(bench)),
            None => of_value(fluid, contact, keys, prefix),
        };
        KnownContact {
            contact,
            origin,
            words,
        }
    };
    Contact::ALL.into_iter().map(of).collect()
}

fn of_table(bench: &Bench) -> String {
    let [low, high] = bench.sliding_m_s;
    let [cold, hot] = bench.temp_k.map(|k| k - ZERO_DEGC_K);
    let pressure = bench.pressure_pa.map_or_else(
        || "pressure not said".to_owned(),
        |[low, high]| match high > low {
            true => format!("{:.0} to {:.0} MPa", 1e-6 * low, 1e-6 * high),
            false => format!("{:.0} MPa", 1e-6 * low),
        },
    );
    let film = match bench.curve.half_n_m.is_finite() {
        true => format!(
            ", {:.3} where the film carries all (half at {:.2e} N/m)",
            bench.curve.film, bench.curve.half_n_m
        ),
        false => String::new(),
    };
    format!(
        "{}, {} rows: {low} to {high} m/s, {cold:.0} to {hot:.0} degC, {pressure}; boundary friction {:.3} at 85 degC, {:+.2} % per K{film}; known within {:.0} %",
        bench.test,
        bench.rows,
        bench.curve.boundary,
        100.0 * bench.curve.rise_per_k,
        100.0 * bench.spread
    )
}

fn of_value(
    fluid: &Lubricant,
    contact: Contact,
    keys: &[KeyInfo],
    prefix: &str,
) -> (Origin, String) {
    let Some(key) = contact.number_key() else {
        return (Origin::Unknown, "no loss depends on it".to_owned());
    };
    let find = |key: &str| {
        let mut own = keys.iter();
        own.find(|info| info.key.strip_prefix(prefix) == Some(key))
    };
    let spread = find(&format!("friction.{}.spread", contact.name()));
    let spread: f64 = spread.map_or(0.0, |info| info.value.parse().unwrap_or(0.0));
    let within = match spread > 0.0 {
        true => format!("; taken to be within {:.0} % of it", 100.0 * spread),
        false => String::new(),
    };
    let info = find(key);
    let value = info.map_or("", |info| info.value.as_str());
    match info.map_or("default", |info| info.status.as_str()) {
        "assumed" | "default" if fluid.name == REFERENCE => {
            (Origin::Borrowed, format!("{value}: assumed{within}"))
        }
        "assumed" | "default" => (
            Origin::Borrowed,
            format!("{value}: as {REFERENCE}, or assumed{within}"),
        ),
        status => {
            let source = match info.map_or("", |info| info.source.as_str()) {
                "" => String::new(),
                source => format!(", {source}"),
            };
            (Origin::Value, format!("{value}: {status}{source}{within}"))
        }
    }
}

/// A sentence on the contacts that are not measured with a fluid; none where all are.
#[must_use]
pub fn not_measured(fluid: &Lubricant, known: &[KnownContact]) -> Option<String> {
    let names = known
        .iter()
        .filter(|known| [Origin::Borrowed, Origin::Unknown].contains(&known.origin))
        .map(|known| known.contact.words());
    let names: Vec<&str> = names.collect();
    let instead = match fluid.name == REFERENCE {
        true => "assumed there".to_owned(),
        false => format!("there it has the friction of the reference fluid {REFERENCE}"),
    };
    (!names.is_empty()).then(|| format!("{NOT_MEASURED} {}; {instead}", names.join(", ")))
}

/// Start of the sentence on contacts that are not measured.
pub const NOT_MEASURED: &str = "friction not measured with this fluid:";

/// Doubts about the tables of the transmission oil, a sentence each.
pub(super) fn doubts<'f>(
    fluid: &'f Lubricant,
    keys: &'f [KeyInfo],
) -> impl Iterator<Item = String> + 'f {
    let prefix = crate::Target::Lubricant.prefix();
    let of = move |bench: &'f std::sync::Arc<Bench>| {
        let key = bench.contact.number_key().unwrap_or_default();
        let given = keys
            .iter()
            .find(|info| info.key.strip_prefix(prefix) == Some(key) && info.status != "default");
        let scaled = given.map(|info| {
            format!(
                "{}: both a table and {key} = {} are given: the curve of the table is scaled to that",
                bench.contact.words(),
                info.value
            )
        });
        bench.doubts.iter().cloned().chain(scaled)
    };
    let all = fluid.benches.iter().flat_map(of);
    all.map(|doubt| format!("friction of {}, {doubt}", fluid.name))
}
