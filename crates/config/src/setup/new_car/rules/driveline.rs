//! Rules from the numbers of a box: the belt that reaches its ratios, or the gear set and its shift speeds.

use std::f64::consts::PI;

use super::{BEYOND_RATED_RPM, Given, Line, digits, list};
use crate::document::units::{LENGTH, POWER, RATIO, SPEED_PER_SPEED};
use crate::setup::twin::shifts_kmh;
use cvtcycle_model::keys::{RAD_S, RPM};
use cvtcycle_model::math::asin;
use cvtcycle_model::transmission::Transmission;

/// Numbers of a CVT only, and of a manual box only.
const OF_CVT: [&str; 5] = ["ratio-low", "ratio-high", "span", "centre-distance", "pump"];
const OF_MANUAL: [&str; 1] = ["gears"];
const FINAL_DRIVE: &str = "transmission.cvt.final_drive_ratio";
const HIGH: &str = "transmission.cvt.ratio.high";
const OVERALL: &str = "transmission.manual.overall_ratios";
const LAST: &str = "transmission.manual.final_ratio";
/// Speed of the line of gentle driving over that of the highest ratio at 80 km/h, and its limits, rpm (NC-17).
const GENTLE: (f64, [f64; 2]) = (0.8, [1000.0, 1300.0]);
const LOW: &str = "transmission.cvt.ratio.low";
const CENTRE: &str = "transmission.cvt.variator.centre_distance_mm";
/// Least running radius of a belt, m (NC-4).
const LEAST_RADIUS_M: f64 = 0.030;
/// Mass of a belt, kg/m (NC-4).
const BELT_KG_M: f64 = 1.6;
/// Below the low ratio, where the primary reaches its stop.
const STOP: f64 = 0.12;
/// Engine speed of a CVT in overrun over that from which all fuel is cut, rpm (NC-10).
const OVER_CUT_RPM: f64 = 100.0;

impl Given<'_> {
    pub(super) fn refuse_other_box(&mut self) {
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
    pub(super) fn belt(&mut self) {
        let final_drive = self.number("final-drive", &RATIO);
        if let Some(ratio) = final_drive {
            self.is_given("final-drive", FINAL_DRIVE, digits(ratio));
        }
        self.overrun();
        let limits = self.ratio_limits();
        let centre_mm = self.number("centre-distance", &LENGTH);
        let Some([low, high]) = limits else { return };
        let high_in_force = high.unwrap_or_else(|| self.inherited(HIGH));
        if let Some(top) = self.top_by_speeds() {
            let words = format!("NC-16: over the highest ratio of {}", digits(high_in_force));
            self.follows(FINAL_DRIVE, format!("{:.4}", top / high_in_force), words);
        }
        self.gentle(high_in_force, final_drive);
        for (option, key, value) in [
            ("ratio-low", LOW, low),
            ("ratio-high", HIGH, high),
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

    /// Overall ratio of the highest gear from engine over road speed (NC-16); none without one, or with a final drive.
    fn top_by_speeds(&mut self) -> Option<f64> {
        let rpm_per_kmh = self.number("n-over-v", &SPEED_PER_SPEED)?;
        if self.text("final-drive").is_some() {
            self.complain(
                "n-over-v",
                "engine over road speed and a final drive at once",
                "give one of them: the axle ratio of a data sheet is often not the whole reduction, engine over road speed is",
            );
            return None;
        }
        if rpm_per_kmh.is_nan() || rpm_per_kmh <= 0.0 {
            self.complain(
                "n-over-v",
                "a number above zero is needed",
                "write it as 26.4rpm/mph",
            );
            return None;
        }
        Some(rpm_per_kmh * 3.6 * self.radius_m() * RPM) // NC-16
    }

    /// Radius of the wheels, m.
    fn radius_m(&self) -> f64 {
        let mut radii = (self.lines.iter()).filter(|line| line.key == "road_load.wheel_radius_m");
        let own = radii.next().and_then(|line| line.value.parse().ok());
        own.unwrap_or(self.base.road_load.base.wheel_radius_m)
    }

    /// The line of gentle driving of a car whose reduction is given (NC-17). A car has its own.
    fn gentle(&mut self, high: f64, final_drive: Option<f64>) {
        let by_speeds = (self.lines.iter()).find(|line| line.key == FINAL_DRIVE);
        let ratio = final_drive.or_else(|| by_speeds?.value.parse().ok());
        let (None, Some(ratio)) = (&self.answers.like, ratio) else {
            return;
        };
        let (share, [least, most]) = GENTLE;
        let at_80_rpm = 80.0 / 3.6 / self.radius_m() * ratio * high * RAD_S;
        let rpm = (share * at_80_rpm).clamp(least, most);
        self.lines.push(Line {
            key: "transmission.cvt.ratio.gentle_rpm",
            value: digits(rpm.round()),
            status: "assumed",
            source: format!(
                "NC-17: {at_80_rpm:.0} rpm in the highest ratio at 80 km/h; 1000 to 1300 rpm"
            ),
            option: None,
        });
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
        let (kg_m, source) = match self.base.transmission() {
            Transmission::Cvt(cvt) if cvt.belt.chain.is_some() => {
                let kg_m = cvt.belt.mass_kg_m;
                (kg_m, format!("NC-4: {kg_m:.2} kg/m, those of the chain"))
            }
            _ => (BELT_KG_M, "NC-4: 1.6 kg/m".to_owned()),
        };
        for (key, value, source) in [
            (
                "transmission.cvt.belt.length_m",
                format!("{length_m:.5}"),
                "NC-4: least running radius 30 mm".to_owned(),
            ),
            (
                "transmission.cvt.belt.mass_kg",
                format!("{:.3}", kg_m * length_m),
                source,
            ),
            (
                "transmission.cvt.variator.stop_from_ratio",
                digits(low - STOP),
                "no deflection of the primary in low".to_owned(),
            ),
            (
                "transmission.cvt.variator.stop_to_ratio",
                digits(low),
                "no deflection of the primary in low".to_owned(),
            ),
        ] {
            self.follows(key, value, source);
        }
    }

    /// The gear set, and shift speeds for it.
    pub(super) fn gears(&mut self) {
        let final_drive = self.number("final-drive", &RATIO);
        if let Some(ratio) = final_drive {
            self.is_given("final-drive", LAST, digits(ratio));
        }
        let top = self.top_by_speeds();
        let inherited = self.inherited(LAST);
        let Some((gears, words)) = self.gear_list() else {
            return;
        };
        // Without gears those of the class, behind another final drive.
        let last = match (top, gears.last()) {
            (Some(top), Some(gear)) => top / gear,
            _ => final_drive.unwrap_or(inherited),
        };
        if self.text("gears").is_none() && final_drive.is_none() && top.is_none() {
            return;
        }
        if top.is_some() {
            let words = "NC-16: overall ratio of the highest gear over its own";
            self.follows(LAST, format!("{last:.4}"), words.to_owned());
        }
        let overall: Vec<f64> = gears.iter().map(|gear| gear * last).collect();
        let words = format!("{words} times a final drive of {}", digits(last));
        self.follows(OVERALL, list(&overall), words);
        self.shifts(&overall);
    }

    /// The gears that are given, else those of the class, without the final drive, in words too; none after a problem.
    fn gear_list(&mut self) -> Option<(Vec<f64>, String)> {
        let Some(text) = self.text("gears").map(str::to_owned) else {
            let Transmission::Manual(manual) = self.base.transmission() else {
                return None;
            };
            let last = self.inherited(LAST);
            let gears = manual.overall.iter().map(|overall| overall / last);
            return Some((gears.collect(), "NC-16: the inherited gears".to_owned()));
        };
        let parts: Vec<&str> = text.split(',').collect();
        let gears = parts
            .iter()
            .filter_map(|part| self.read("gears", part, &text, &RATIO));
        let gears: Vec<f64> = gears.collect();
        if gears.len() < parts.len() {
            return None;
        }
        let falls = gears.windows(2).all(|pair| pair[0] > pair[1]);
        if gears.len() < 2 || !falls {
            self.complain(
                "gears",
                "two gears or more are needed, from first to top",
                "leave reverse out",
            );
            return None;
        }
        Some((gears, format!("gears {text}")))
    }

    /// Shift speeds of a gear set.
    fn shifts(&mut self, overall: &[f64]) {
        let rated = self.at_speed("power", &POWER);
        let rated = rated.and_then(|(_, speeds)| speeds.first().copied());
        let usual = self.base.engine().highest_rad_s - BEYOND_RATED_RPM * RPM;
        let rated_rad_s = rated.map_or(usual, |rpm| rpm * RPM);
        let radius_m = self.radius_m();
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
