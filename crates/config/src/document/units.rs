//! Numbers with their units as people write them (NC-7): those of catalogue numbers, and what a number in another unit is in that of a key.

/// Names of a unit, and its size in the first of its kind.
type Unit = (&'static [&'static str], f64);

/// Units of one quantity; the first has the size 1, and what is written without a unit is in it.
#[derive(Debug)]
pub(crate) struct Units(pub &'static [Unit]);

const LB: f64 = 0.453_592_37;
/// N of a pound-force.
const LBF: f64 = 4.448_221_615_260_5;
/// km of a mile.
const MILE: f64 = 1.609_344;

pub(crate) const MASS: Units = Units(&[
    (&["kg"], 1.0),
    (&["lb", "lbs"], LB),
    (&["t"], 1000.0),
    (&["g"], 1e-3),
]);
pub(crate) const FORCE: Units = Units(&[(&["N"], 1.0), (&["lbf"], LBF), (&["kN"], 1000.0)]);
pub(crate) const FORCE_PER_SPEED: Units = Units(&[
    (&["N/(km/h)", "N/kmh"], 1.0),
    (&["lbf/mph", "lbf"], LBF / MILE),
    (&["N/(m/s)"], 1.0 / 3.6),
]);
pub(crate) const FORCE_PER_SPEED2: Units = Units(&[
    (&["N/(km/h)2", "N/kmh2"], 1.0),
    (&["lbf/mph2", "lbf"], LBF / (MILE * MILE)),
    (&["N/(m/s)2"], 1.0 / (3.6 * 3.6)),
]);
pub(crate) const VOLUME: Units = Units(&[(&["cm3", "cc", "ccm"], 1.0), (&["l", "L"], 1000.0)]);
pub(crate) const OIL: Units = Units(&[(&["l", "L"], 1.0), (&["qt"], 0.946_352_946)]);
pub(crate) const POWER: Units = Units(&[
    (&["kW"], 1.0),
    (&["hp", "bhp"], 0.745_699_87),
    (&["PS"], 0.735_498_75),
    (&["W"], 1e-3),
]);
pub(crate) const TORQUE: Units = Units(&[
    (&["Nm"], 1.0),
    (&["lbft", "lb-ft", "ftlb", "ft-lb"], 1.355_817_9),
]);
pub(crate) const SPEED: Units = Units(&[(&["rpm", "1/min"], 1.0)]);
pub(crate) const LENGTH: Units = Units(&[
    (&["mm"], 1.0),
    (&["cm"], 10.0),
    (&["m"], 1000.0),
    (&["in"], 25.4),
    (&["um"], 1e-3),
]);
pub(crate) const PER_TURN: Units = Units(&[(&["cc/rev", "cm3/rev", "cc", "cm3"], 1.0)]);
pub(crate) const SPEED_PER_SPEED: Units = Units(&[
    (&["rpm/(km/h)", "rpm/kmh"], 1.0),
    (&["rpm/mph"], 1.0 / MILE),
]);
pub(crate) const RATIO: Units = Units(&[]);
const ROAD_SPEED: Units = Units(&[
    (&["km/h", "kmh", "kph"], 1.0),
    (&["m/s"], 3.6),
    (&["mph"], MILE),
]);
const PRESSURE: Units = Units(&[
    (&["bar"], 1.0),
    (&["kPa"], 0.01),
    (&["MPa"], 10.0),
    (&["Pa"], 1e-5),
    (&["psi"], 0.068_947_572_93),
]);
const VISCOSITY: Units = Units(&[(&["mm2/s", "cSt"], 1.0)]);
const SHARE: Units = Units(&[(&["-"], 1.0), (&["%"], 0.01)]);

/// Quantities of keys whose values are written in several units.
const OF_KEYS: [&Units; 15] = [
    &MASS,
    &FORCE,
    &FORCE_PER_SPEED,
    &FORCE_PER_SPEED2,
    &VOLUME,
    &OIL,
    &POWER,
    &TORQUE,
    &SPEED,
    &LENGTH,
    &PER_TURN,
    &ROAD_SPEED,
    &PRESSURE,
    &VISCOSITY,
    &SHARE,
];

/// Hint for a number written with its unit, for a key in the unit `of`.
///
/// The figure is only repeated where it is that of the key's own unit, or is converted to it.
pub(crate) fn number_hint(figure: &str, unit: &str, of: &str) -> String {
    let figure = match decimal_comma(figure) {
        // The comma of 3,125 may be a point or part thousands.
        Some((length, point)) if length == figure.len() && !parts_thousands(&point) => point,
        _ => figure.to_owned(),
    };
    if bare(unit) == bare(of) {
        return format!(
            "write {figure} without `{unit}`: the unit is at the end of the key's name"
        );
    }
    match figure.parse::<f64>().ok().zip(factor(unit, of)) {
        // 140 cSt are 140 mm2/s.
        Some((_, factor)) if (factor - 1.0).abs() < 1e-12 => {
            format!("write {figure} without `{unit}`: the unit is at the end of the key's name")
        }
        Some((number, factor)) => {
            let own = significant(number * factor);
            let of = if of == "-" {
                String::new()
            } else {
                format!(" {of}")
            };
            format!("write {own} without a unit: {figure} {unit} are {own}{of}")
        }
        // No unit, or those of several columns.
        None if ["", "-"].contains(&of) || of.contains(',') => {
            "write the number without a unit".to_owned()
        }
        None => format!("write the number without a unit, converted from {unit} to {of}"),
    }
}

/// Size of a unit in another one of its quantity.
fn factor(unit: &str, of: &str) -> Option<f64> {
    let size = |units: &Units, name: &str| Some(units.find(name)?.1);
    OF_KEYS
        .iter()
        .find_map(|units| Some(size(units, unit)? / size(units, of)?))
}

/// Length of a number with a decimal comma at the start of `text`, and the number with a point.
pub(crate) fn decimal_comma(text: &str) -> Option<(usize, String)> {
    let digits =
        |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let sign = usize::from(text.starts_with(['+', '-']));
    let whole = digits(&text[sign..]);
    let fraction = text[sign + whole..].strip_prefix(',').map_or(0, digits);
    let length = sign + whole + 1 + fraction;
    (whole > 0 && fraction > 0).then(|| (length, text[..length].replace(',', ".")))
}

/// True if the comma of a number, here its point, may part thousands.
pub(crate) fn parts_thousands(point: &str) -> bool {
    point
        .split_once('.')
        .is_some_and(|(_, fraction)| fraction.len() == 3)
}

/// Six digits.
fn significant(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// The name of a unit without blanks and signs for powers: "N/(km/h)²" as "N/(km/h)2".
fn bare(unit: &str) -> String {
    let letters = unit.chars().filter(|c| !c.is_whitespace() && *c != '·');
    let plain = letters.map(|c| match c {
        '²' => '2',
        '³' => '3',
        'µ' | 'μ' => 'u',
        c => c,
    });
    plain.collect()
}

impl Units {
    /// The unit of a name, in capitals or not where that is no other one.
    pub fn find(&self, name: &str) -> Option<&Unit> {
        let name = bare(name);
        let all = self.0.iter();
        let mut exact = all.clone().filter(|(names, _)| names.contains(&&*name));
        let like = |own: &&str| own.eq_ignore_ascii_case(&name);
        exact
            .next()
            .or_else(|| all.clone().find(|(names, _)| names.iter().any(like)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definitions of the units: a pound is 0.45359237 kg, a pound-force 4.448222 N, a mile 1.609344 km, a horsepower 745.7 W.
    #[test]
    fn a_hint_never_drops_the_unit_of_another_country() {
        for (figure, unit, of, words) in [
            (
                "3125",
                "lb",
                "kg",
                "write 1417.48 without a unit: 3125 lb are 1417.48 kg",
            ),
            (
                "33.21",
                "lbf",
                "N",
                "write 147.725 without a unit: 33.21 lbf are 147.725 N",
            ),
            ("0.02124", "lbf/mph2", "N/(km/h)²", "are 0.036479 N/(km/h)²"),
            ("140", "hp", "kW", "are 104.398 kW"),
            ("128", "lb-ft", "N m", "are 173.545 N m"),
            ("71", "%", "-", "write 0.71 without a unit: 71 % are 0.71"),
            ("0.3067", "m", "mm", "are 306.7 mm"),
            ("100", "kg", "kg", "write 100 without `kg`"),
            ("172", "Nm", "N m", "write 172 without `Nm`"),
            ("7,3", "cSt", "mm²/s", "write 7.3 without `cSt`"),
            (
                "70",
                "°F",
                "°C",
                "write the number without a unit, converted from °F to °C",
            ),
            (
                "3,125",
                "lb",
                "kg",
                "write the number without a unit, converted from lb to kg",
            ),
            (
                "1200",
                "stone",
                "kg",
                "write the number without a unit, converted from stone to kg",
            ),
            ("3", "kg", "-", "write the number without a unit"),
            ("3", "kg", "mm", "converted from kg to mm"),
        ] {
            let hint = number_hint(figure, unit, of);
            assert!(hint.contains(words), "{figure} {unit}: {hint}");
        }
    }
}
