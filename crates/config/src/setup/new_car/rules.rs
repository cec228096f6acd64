//! From catalogue numbers to values of keys (NC-1 to NC-10).

use std::f64::consts::PI;

use super::coast_down::{DRAG, SOURCE};
use super::full_load::Curve;
use super::tyre::tyre;
use super::{Answers, NUMBERS, meaning};
use crate::document::units::{
    FORCE, FORCE_PER_SPEED, FORCE_PER_SPEED2, LENGTH, MASS, OIL, PER_TURN, POWER, RATIO, SPEED,
    TORQUE, Units, VOLUME,
};
use crate::setup::Setup;
use crate::setup::twin::shifts_kmh;
use crate::{Problem, Problems, decimal};
use cvtcycle_model::keys::{RAD_S, RPM};
use cvtcycle_model::math::{asin, exp, ln};
use cvtcycle_model::transmission::Transmission;

/// A value of the file.
pub(super) struct Line {
    pub key: &'static str,
    /// As TOML.
    pub value: String,
    /// `derived`, `assumed`, or nothing for what the user has given.
    pub status: &'static str,
    pub source: String,
    /// The option whose number it is.
    pub option: Option<&'static str>,
}

impl Line {
    pub fn table(&self) -> &'static str {
        self.key.rsplit_once('.').map_or("", |(table, _)| table)
    }

    /// As a line of its table.
    pub fn text(&self) -> String {
        let name = self.key.rsplit('.').next().unwrap_or_default();
        let status = match self.status {
            "" => String::new(),
            status => format!(", status = \"{status}\""),
        };
        let source = toml::Value::String(self.source.clone());
        format!(
            "{name} = {{ value = {}{status}, source = {source} }}\n",
            self.value
        )
    }
}

/// Numbers that are values of a key as they are: option, key, units.
pub(super) const PLAIN: [(&str, &str, Units); 9] = [
    ("mass", "road_load.mass_kg", MASS),
    ("f0", "road_load.form.coefficients.f0_n", FORCE),
    (
        "f1",
        "road_load.form.coefficients.f1_n_per_kmh",
        FORCE_PER_SPEED,
    ),
    (
        "f2",
        "road_load.form.coefficients.f2_n_per_kmh2",
        FORCE_PER_SPEED2,
    ),
    ("displacement", "engine.displacement_cc", VOLUME),
    ("idle", "engine.idle.hot_rpm", SPEED),
    ("highest", "engine.highest_rpm", SPEED),
    (
        "pump",
        "transmission.cvt.pump.displacement_cc_rev",
        PER_TURN,
    ),
    ("oil", "thermal.transmission.oil_l", OIL),
];
/// Numbers of a CVT only, and of a manual box only.
const OF_CVT: [&str; 5] = ["ratio-low", "ratio-high", "span", "centre-distance", "pump"];
const OF_MANUAL: [&str; 1] = ["gears"];

const LOW: &str = "transmission.cvt.ratio.low";
const CENTRE: &str = "transmission.cvt.variator.centre_distance_mm";

/// Least running radius of a belt, m (NC-4).
const LEAST_RADIUS_M: f64 = 0.030;
/// Mass of a belt, kg/m (NC-4).
const BELT_KG_M: f64 = 1.6;
/// Below the low ratio, where the primary reaches its stop.
const STOP: f64 = 0.12;
/// Speed of rated power where none is given, rpm, and highest speed above it.
const RATED_RPM: f64 = 6200.0;
const BEYOND_RATED_RPM: f64 = 400.0;
/// Engine speed of a CVT in overrun over that from which all fuel is cut, rpm (NC-10).
const OVER_CUT_RPM: f64 = 100.0;
/// Highest torque over that at rated power, and its speed over that of rated power, where none are given.
const USUAL_TORQUE: (f64, f64) = (1.09, 0.68);

/// Power has its unit: data sheets have kW, hp or PS, and a number of one is a likely power in the others, so that no doubt finds it.
const POWER_HINT: &str = "write its unit: 104kW@6400, 140hp@6400 or 142PS@6400";

/// The numbers that are given.
struct Given<'a> {
    answers: &'a Answers,
    base: &'a Setup,
    problems: Problems,
    lines: Vec<Line>,
}

/// The lines of a car that inherits from `base`.
///
/// # Errors
/// All numbers that are none, or do not fit each other or the box.
pub(super) fn lines(answers: &Answers, base: &Setup) -> Result<Vec<Line>, Problems> {
    let mut given = Given {
        answers,
        base,
        problems: Problems::new(),
        lines: Vec::new(),
    };
    given.refuse_other_box();
    for (option, key, units) in &PLAIN {
        if let Some(value) = given.number(option, units) {
            given.is_given(option, key, digits(value));
        }
    }
    for (option, key) in [
        ("fluid", "vehicle.transmission_oil"),
        ("engine-oil", "vehicle.engine_oil"),
    ] {
        if let Some(word) = answers.numbers.get(option) {
            given.is_given(option, key, toml::Value::String(word.clone()).to_string());
        }
    }
    given.road_load();
    given.wheel();
    given.size();
    given.power();
    match base.transmission().is_cvt() {
        true => given.belt(),
        false => given.gears(),
    }
    given.problems.finish()?;
    // The head of the file has its table already.
    given
        .lines
        .sort_by_key(|line| !line.key.starts_with("vehicle."));
    Ok(given.lines)
}

/// A number without the digits of its rounding.
fn digits(value: f64) -> String {
    let text = decimal((value * 1e6).round() / 1e6).to_string();
    if text.contains('.') {
        text
    } else {
        text + ".0"
    }
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|x| format!("{x:.3}")).collect();
    format!("[{}]", values.join(", "))
}

impl Given<'_> {
    fn text(&self, option: &str) -> Option<&str> {
        self.answers.numbers.get(option).map(String::as_str)
    }

    /// The number of an option, in the unit of its key; none if it is not given, or no number.
    fn number(&mut self, option: &str, units: &Units) -> Option<f64> {
        let text = self.text(option)?.to_owned();
        self.read(option, &text, &text, units)
    }

    /// A number that is a part of the text of an option.
    fn read(&mut self, option: &str, part: &str, text: &str, units: &Units) -> Option<f64> {
        self.take(option, text, units.number(part))
    }

    fn take(&mut self, option: &str, text: &str, found: Result<f64, Problem>) -> Option<f64> {
        self.problems
            .take(found.map_err(|problem| problem.key(option).value(text)))
    }

    fn complain(&mut self, option: &str, message: &str, hint: &str) {
        let value = self.text(option).unwrap_or_default().to_owned();
        let problem = Problem::conflict(message).key(option).value(value);
        self.problems
            .push(problem.allowed(meaning(option)).hint(hint));
    }

    fn is_given(&mut self, option: &str, key: &'static str, value: String) {
        let source = format!("given: {}", self.text(option).unwrap_or_default());
        self.lines.push(Line {
            key,
            value,
            status: "",
            source,
            option: NUMBERS
                .iter()
                .map(|(own, _)| *own)
                .find(|own| *own == option),
        });
    }

    fn follows(&mut self, key: &'static str, value: String, source: String) {
        self.lines.push(Line {
            key,
            value,
            status: "derived",
            source,
            option: None,
        });
    }

    /// A number of the class or car that the new one inherits from.
    fn inherited(&self, key: &str) -> f64 {
        let found = self.base.keys.iter().find(|info| info.key == key);
        found
            .and_then(|info| info.value.parse().ok())
            .unwrap_or(f64::NAN)
    }

    fn refuse_other_box(&mut self) {
        let (others, has) = match self.base.transmission().is_cvt() {
            true => (&OF_MANUAL[..], "a CVT"),
            false => (&OF_CVT[..], "a manual box"),
        };
        for option in others {
            if self.text(option).is_some() {
                self.complain(
                    option,
                    &format!("the car has {has}"),
                    "choose another class of box",
                );
            }
        }
    }

    /// The drag of the box inside a coast-down in neutral.
    fn road_load(&mut self) {
        match self.text("road-load") {
            None | Some("body") => {}
            Some("neutral") if self.text("f0").is_none() => self.complain(
                "road-load",
                "there is no coast-down to take the drag of the box from",
                "give f0, f1 and f2 as well",
            ),
            Some("neutral") if self.base.transmission().is_cvt() => {
                self.lines.extend(DRAG.into_iter().map(|(key, value)| Line {
                    key,
                    value: value.to_owned(),
                    status: "assumed",
                    source: SOURCE.to_owned(),
                    option: None,
                }));
            }
            Some("neutral") => {}
            Some(_) => self.complain(
                "road-load",
                "this is no kind of road load",
                "write body or neutral",
            ),
        }
    }

    fn wheel(&mut self) {
        let radius_mm = self.number("wheel-radius", &LENGTH);
        if let Some(radius_mm) = radius_mm {
            self.is_given(
                "wheel-radius",
                "road_load.wheel_radius_m",
                digits(radius_mm / 1e3),
            );
        }
        let Some(code) = self.text("tyre").map(str::to_owned) else {
            return;
        };
        match tyre(&code) {
            None => self.complain(
                "tyre",
                "this is no tyre code",
                "write it as it is on the tyre, such as 215/55 R16",
            ),
            Some(_) if radius_mm.is_some() => {
                self.complain(
                    "tyre",
                    "a tyre and a wheel radius at once",
                    "give one of them",
                );
            }
            Some([width, height, rim]) => {
                let diameter_mm = 25.4 * rim + 2.0 * width * height / 100.0;
                let radius_m = 3.05 * diameter_mm / (2.0 * PI) / 1e3; // NC-1
                self.follows(
                    "road_load.wheel_radius_m",
                    format!("{radius_m:.4}"),
                    format!("NC-1: {code}"),
                );
            }
        }
    }

    /// A number and the numbers after its @, such as 172@3800-4400.
    fn at_speed(&mut self, option: &str, units: &Units) -> Option<(f64, Vec<f64>)> {
        let text = self.text(option)?.to_owned();
        let (value, speeds) = match text.split_once('@') {
            Some((value, speeds)) => (value, speeds.trim_end_matches("rpm").split('-').collect()),
            None => (text.as_str(), Vec::new()),
        };
        let value = match option {
            "power" => self.take(option, &text, units.number_with_unit(value, POWER_HINT)),
            _ => self.read(option, value, &text, units),
        }?;
        let count = speeds.len();
        let speeds = speeds
            .into_iter()
            .filter_map(|part| self.read(option, part, &text, &SPEED));
        let speeds: Vec<f64> = speeds.collect();
        let rises = speeds.windows(2).all(|pair| pair[0] < pair[1]);
        if speeds.len() < count {
            return None;
        }
        if !(value > 0.0 && rises && speeds.iter().all(|rpm| *rpm > 0.0) && count <= 2) {
            self.complain(
                option,
                "values above zero and rising speeds are needed",
                "write it as 172@4000",
            );
            return None;
        }
        Some((value, speeds))
    }

    /// What follows from the size of the engine.
    fn size(&mut self) {
        let Some(cc) = self.number("displacement", &VOLUME).filter(|cc| *cc > 0.0) else {
            return;
        };
        let litres = cc / 1e3;
        let stroke_mm = exp(ln(cc * 1e3 / PI) / 3.0); // NC-9: four cylinders of pi/4 s^3
        for (key, value, rule) in [
            (
                "engine.stroke_mm",
                format!("{stroke_mm:.1}"),
                "NC-9, ASSUMED",
            ),
            (
                "engine.inertia_kg_m2",
                format!("{:.3}", 0.05 + 0.1 * litres),
                "NC-3",
            ),
            (
                "engine.accessory_nm",
                format!("{:.3}", 0.175 * litres + 0.2021),
                "NC-3",
            ),
        ] {
            self.follows(key, value, format!("{rule}: {} l", digits(litres)));
        }
    }

    /// What follows from power and torque of the engine.
    fn power(&mut self) {
        let torque = self.at_speed("torque", &TORQUE);
        let Some((kw, speeds)) = self.at_speed("power", &POWER) else {
            return;
        };
        let rated_rpm = speeds.first().copied().unwrap_or(RATED_RPM);
        self.is_given("power", "engine.rated_kw", digits(kw));
        for (key, kj_k) in [
            ("thermal.engine.block_kj_k", 0.525),
            ("thermal.engine.oil_kj_k", 0.28),
        ] {
            self.follows(key, format!("{:.1}", kj_k * kw), "NC-6".to_owned());
        }
        let highest_rpm = self
            .number("highest", &SPEED)
            .unwrap_or(rated_rpm + BEYOND_RATED_RPM);
        if self.text("highest").is_none() {
            let words = "400 rpm above the speed of rated power";
            self.follows("engine.highest_rpm", digits(highest_rpm), words.to_owned());
        }
        let idle_rpm = self.number("idle", &SPEED);
        let rated_nm = kw * 1e3 / (rated_rpm * RPM);
        let usual = (USUAL_TORQUE.0 * rated_nm, Vec::new());
        let (nm, at) = torque.unwrap_or(usual);
        let curve = Curve {
            nm,
            plateau: match at.as_slice() {
                [] => [(USUAL_TORQUE.1 * rated_rpm / 100.0).round() * 100.0; 2],
                all => [all[0], all[all.len() - 1]],
            },
            rated_nm,
            rated_rpm,
            idle_rpm: idle_rpm.unwrap_or_else(|| self.inherited("engine.idle.hot_rpm")),
            highest_rpm,
        };
        match curve.mistake() {
            Some(message) => {
                let hint = self.hint_of_torque(&curve);
                let usual = "check both numbers, their units and the speeds after @";
                self.complain("power", &message, hint.as_deref().unwrap_or(usual));
            }
            None => {
                let words = format!("NC-2 through {nm:.0} Nm and {} kW", digits(kw));
                self.follows("engine.full_load", curve.rows(), words);
            }
        }
    }

    /// The torque in lb ft, where it has no unit and would fit the power in that one.
    fn hint_of_torque(&self, curve: &Curve) -> Option<String> {
        let text = self.text("torque")?;
        let (figure, speeds) = text.split_once('@').unwrap_or((text, ""));
        figure.trim().parse::<f64>().ok()?;
        let other = Curve {
            nm: TORQUE.number(&format!("{}lbft", figure.trim())).ok()?,
            ..*curve
        };
        let at = if speeds.is_empty() { "" } else { "@" };
        let hint = format!(
            "is the torque in lb ft? then write {}lbft{at}{speeds}",
            figure.trim()
        );
        other.mistake().is_none().then_some(hint)
    }

    /// Low and high ratio of the belt, of which a span may give one; none after a problem.
    fn ratio_limits(&mut self) -> Option<[Option<f64>; 2]> {
        let low = self.number("ratio-low", &RATIO);
        let high = self.number("ratio-high", &RATIO);
        let span = self.number("span", &RATIO);
        match (low, high, span) {
            (low, high, None) => Some([low, high]),
            (None, Some(high), Some(span)) => Some([Some(high * span), Some(high)]),
            (Some(low), None, Some(span)) => Some([Some(low), Some(low / span)]),
            (Some(_), Some(_), Some(_)) => {
                self.complain(
                    "span",
                    "a span and both ratios at once",
                    "give two of the three",
                );
                None
            }
            (None, None, Some(_)) => {
                self.complain(
                    "span",
                    "a span without one of its ends",
                    "give the smallest ratio too",
                );
                None
            }
        }
    }

    /// Limits of the belt's ratio, and the belt that reaches them.
    fn belt(&mut self) {
        if let Some(ratio) = self.number("final-drive", &RATIO) {
            self.is_given(
                "final-drive",
                "transmission.cvt.final_drive_ratio",
                digits(ratio),
            );
        }
        self.overrun();
        let limits = self.ratio_limits();
        let centre_mm = self.number("centre-distance", &LENGTH);
        let Some([low, high]) = limits else { return };
        for (option, key, value) in [
            ("ratio-low", LOW, low),
            ("ratio-high", "transmission.cvt.ratio.high", high),
            ("centre-distance", CENTRE, centre_mm),
        ] {
            match (value, self.text(option)) {
                (Some(value), Some(_)) => self.is_given(option, key, digits(value)),
                (Some(value), None) => self.follows(
                    key,
                    digits(value),
                    "the span and the other ratio".to_owned(),
                ),
                (None, _) => {}
            }
        }
        if low.is_none() && centre_mm.is_none() {
            return;
        }
        let low = low.unwrap_or_else(|| self.inherited(LOW));
        let centre_mm = centre_mm.unwrap_or_else(|| self.inherited(CENTRE));
        self.belt_of(low, centre_mm);
    }

    /// Engine speed in overrun where that of the class is too low for the engine to have its fuel cut (NC-10). A car has its own.
    fn overrun(&mut self) {
        let Transmission::Cvt(cvt) = self.base.transmission() else {
            return;
        };
        let cut = self.base.engine().cut_above_rad_s;
        if self.answers.like.is_none() && cvt.ratio.overrun_rad_s < cut {
            self.follows(
                "transmission.cvt.ratio.overrun_rpm",
                digits((cut * RAD_S).round() + OVER_CUT_RPM),
                "NC-10: above the speed from which all fuel is cut".to_owned(),
            );
        }
    }

    /// The belt that runs at the least radius in low.
    fn belt_of(&mut self, low: f64, centre_mm: f64) {
        let length_m = belt_length_m(low, centre_mm / 1e3);
        if length_m.is_nan() {
            let hint = "check the low ratio and the centre distance";
            self.complain(
                "ratio-low",
                "no belt reaches this ratio at this distance of the pulleys",
                hint,
            );
            return;
        }
        for (key, value, source) in [
            (
                "transmission.cvt.belt.length_m",
                format!("{length_m:.5}"),
                "NC-4: least running radius 30 mm",
            ),
            (
                "transmission.cvt.belt.mass_kg",
                format!("{:.3}", BELT_KG_M * length_m),
                "NC-4: 1.6 kg/m",
            ),
            (
                "transmission.cvt.variator.stop_from_ratio",
                digits(low - STOP),
                "no deflection of the primary in low",
            ),
            (
                "transmission.cvt.variator.stop_to_ratio",
                digits(low),
                "no deflection of the primary in low",
            ),
        ] {
            self.follows(key, value, source.to_owned());
        }
    }

    /// The gear set, and shift speeds for it.
    fn gears(&mut self) {
        let final_drive = self.number("final-drive", &RATIO);
        if let Some(ratio) = final_drive {
            self.is_given(
                "final-drive",
                "transmission.manual.final_ratio",
                digits(ratio),
            );
        }
        let Some(text) = self.text("gears").map(str::to_owned) else {
            return;
        };
        let parts: Vec<&str> = text.split(',').collect();
        let gears = parts
            .iter()
            .filter_map(|part| self.read("gears", part, &text, &RATIO));
        let gears: Vec<f64> = gears.collect();
        if gears.len() < parts.len() {
            return;
        }
        let falls = gears.windows(2).all(|pair| pair[0] > pair[1]);
        if gears.len() < 2 || !falls {
            self.complain(
                "gears",
                "two gears or more are needed, from first to top",
                "leave reverse out",
            );
            return;
        }
        let last = final_drive.unwrap_or_else(|| self.inherited("transmission.manual.final_ratio"));
        let overall: Vec<f64> = gears.iter().map(|gear| gear * last).collect();
        let words = format!("gears {text} times a final drive of {}", digits(last));
        self.follows("transmission.manual.overall_ratios", list(&overall), words);
        self.shifts(&overall);
    }

    /// Shift speeds of a gear set.
    fn shifts(&mut self, overall: &[f64]) {
        let rated = self.at_speed("power", &POWER);
        let rated = rated.and_then(|(_, speeds)| speeds.first().copied());
        let usual = self.base.engine().highest_rad_s - BEYOND_RATED_RPM * RPM;
        let rated_rad_s = rated.map_or(usual, |rpm| rpm * RPM);
        let mut radii = self
            .lines
            .iter()
            .filter(|line| line.key == "road_load.wheel_radius_m");
        let radius_m = radii.next().and_then(|line| line.value.parse().ok());
        let radius_m = radius_m.unwrap_or(self.base.road_load.base.wheel_radius_m);
        let speeds = shifts_kmh(overall, radius_m, rated_rad_s);
        let keys = [
            "transmission.manual.upshift_kmh",
            "transmission.manual.downshift_kmh",
        ];
        for (key, speeds) in keys.into_iter().zip(speeds) {
            self.lines.push(Line {
                key,
                value: list(&speeds),
                status: "assumed",
                source: format!("TW-3, rated speed {:.0} rpm", rated_rad_s * RAD_S),
                option: None,
            });
        }
    }
}

/// Length of the belt that runs at the least radius in low (GE-3, NC-4).
fn belt_length_m(low: f64, centre_m: f64) -> f64 {
    let (primary, secondary) = (LEAST_RADIUS_M, low * LEAST_RADIUS_M);
    let difference = secondary - primary;
    let alpha = asin(difference / centre_m);
    let strut = (centre_m * centre_m - difference * difference).sqrt();
    primary * (PI - 2.0 * alpha) + secondary * (PI + 2.0 * alpha) + 2.0 * strut
}
