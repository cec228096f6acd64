//! Names of columns as other programs write them: words with a unit in brackets, behind a comma or at the end, or in a row below.

use std::borrow::Cow;

use crate::channel::bare;

/// Units as people write them, `bare`, and the unit that is meant.
pub const UNITS: [(&str, &str); 113] = [
    ("s", "s"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("km_h", "km/h"),
    ("kmh", "km/h"),
    ("km_hr", "km/h"),
    ("kph", "km/h"),
    ("m_s", "m/s"),
    ("mps", "m/s"),
    ("meters_per_second", "m/s"),
    ("metres_per_second", "m/s"),
    ("mph", "mph"),
    ("mi_h", "mph"),
    ("miles_per_hour", "mph"),
    ("m", "m"),
    ("meters", "m"),
    ("metres", "m"),
    ("%", "%"),
    ("percent", "%"),
    ("pct", "%"),
    ("rpm", "rpm"),
    ("1_min", "rpm"),
    ("min_1", "rpm"),
    ("nm", "N m"),
    ("n_m", "N m"),
    ("bar", "bar"),
    ("w", "W"),
    ("kw", "kW"),
    ("°c", "°C"),
    ("degc", "°C"),
    ("deg_c", "°C"),
    ("mm2_s", "mm²/s"),
    ("mm²_s", "mm²/s"),
    ("cst", "mm²/s"),
    ("rev_min", "rpm"),
    ("r_min", "rpm"),
    ("u_min", "rpm"),
    ("rad_s", "rad/s"),
    ("rad_sec", "rad/s"),
    ("radps", "rad/s"),
    ("rad_per_s", "rad/s"),
    ("newton_meter", "N m"),
    ("newton_meters", "N m"),
    ("lb_ft", "lb-ft"),
    ("lbft", "lb-ft"),
    ("lbf_ft", "lb-ft"),
    ("lbs_ft", "lb-ft"),
    ("ft_lb", "lb-ft"),
    ("ft_lbs", "lb-ft"),
    ("ftlb", "lb-ft"),
    ("ft_lbf", "lb-ft"),
    ("lb_ft_", "lb-ft"),
    ("pa", "Pa"),
    ("kpa", "kPa"),
    ("mpa", "MPa"),
    ("psi", "psi"),
    ("psig", "psi"),
    ("lb_in2", "psi"),
    ("lbf_in2", "psi"),
    ("hp", "hp"),
    ("bhp", "hp"),
    ("g_s", "g/s"),
    ("g_sec", "g/s"),
    ("gps", "g/s"),
    ("grams_per_second", "g/s"),
    ("kg_s", "kg/s"),
    ("mg_s", "mg/s"),
    ("g_h", "g/h"),
    ("g_hr", "g/h"),
    ("gph", "g/h"),
    ("kg_h", "kg/h"),
    ("kg_hr", "kg/h"),
    ("lb_h", "lb/h"),
    ("lb_hr", "lb/h"),
    ("lbs_h", "lb/h"),
    ("lbs_hr", "lb/h"),
    ("lbm_hr", "lb/h"),
    ("g_kwh", "g/kWh"),
    ("g_kw_h", "g/kWh"),
    ("g_kw_hr", "g/kWh"),
    ("g_kwhr", "g/kWh"),
    ("gpkwh", "g/kWh"),
    ("kg_kwh", "kg/kWh"),
    ("kg_kw_h", "kg/kWh"),
    ("g_hph", "g/hp-h"),
    ("g_hp_h", "g/hp-h"),
    ("g_hp_hr", "g/hp-h"),
    ("g_bhp_h", "g/hp-h"),
    ("g_bhp_hr", "g/hp-h"),
    ("lb_hph", "lb/hp-h"),
    ("lb_hp_h", "lb/hp-h"),
    ("lb_hp_hr", "lb/hp-h"),
    ("lb_hphr", "lb/hp-h"),
    ("lbs_hp_h", "lb/hp-h"),
    ("lbs_hp_hr", "lb/hp-h"),
    ("lbm_hp_h", "lb/hp-h"),
    ("lbm_hp_hr", "lb/hp-h"),
    ("lb_bhp_h", "lb/hp-h"),
    ("lb_bhp_hr", "lb/hp-h"),
    ("ug_j", "µg/J"),
    ("µg_j", "µg/J"),
    ("ug_ws", "µg/J"),
    ("mg_stroke", "mg/stroke"),
    ("mg_str", "mg/stroke"),
    ("mg_stk", "mg/stroke"),
    ("mg_hub", "mg/stroke"),
    ("mg_cyc", "mg/stroke"),
    ("mg_cycle", "mg/stroke"),
    ("mg_inj", "mg/stroke"),
    ("-", "-"),
    ("1", "-"),
];

/// The unit that a text means, with brackets or without.
pub(super) fn unit_named(text: &str) -> Option<&'static str> {
    let inner = text.trim();
    let inner = inner.strip_prefix(['[', '(']).unwrap_or(inner);
    let inner = bare(inner.strip_suffix([']', ')']).unwrap_or(inner));
    let found = UNITS.iter().find(|(written, _)| *written == inner);
    found.map(|(_, unit)| *unit)
}

/// Column names of tables of other programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Foreign {
    /// Whole names, or beginnings before a `*`, and the column of the schema; an empty one where the column is passed over.
    pub headings: &'static [(&'static str, &'static str)],
    /// Whole lines of names that nothing separates, and their columns in the order of the rows below, as [`super::Columns::parse`] has them.
    pub lines: &'static [(&'static str, &'static str)],
    /// Words, `bare`, and the name of a column without its unit.
    pub words: &'static [(&'static str, &'static str)],
}

impl Foreign {
    /// A word as the names of the schema's columns have it.
    pub(super) fn own_word(&self, word: String) -> String {
        let mut words = self.words.iter();
        let own = words.find(|(other, _)| *other == word);
        own.map_or(word, |(_, own)| (*own).to_owned())
    }
}

/// Word and unit of a name; the unit is `None` where the name has none.
pub(super) fn readings(text: &str) -> Vec<(String, Option<Cow<'_, str>>)> {
    let in_brackets = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (word, unit) = text.strip_suffix(close)?.rsplit_once(open)?;
            Some((word, unit))
        });
    if let Some((word, unit)) = in_brackets.or_else(|| text.rsplit_once(',')) {
        return vec![(bare(word), Some(Cow::Borrowed(unit)))];
    }
    let whole = bare(text);
    let at_end = whole.match_indices('_').filter_map(|(at, _)| {
        let (word, unit) = (&whole[..at], &whole[at + 1..]);
        unit_named(unit)?;
        Some((word.to_owned(), Some(Cow::Owned(unit.to_owned()))))
    });
    at_end.chain([(whole.clone(), None)]).collect()
}

/// The unit that a name of a column has in it.
pub(super) fn unit_in(name: &str) -> Option<String> {
    let mut readings = readings(name).into_iter();
    readings.find_map(|(_, unit)| unit.map(Cow::into_owned))
}
