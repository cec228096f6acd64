//! Rules from size, power and torque of an engine.

use std::f64::consts::PI;

use super::{BEYOND_RATED_RPM, Given, digits};
use crate::document::units::{POWER, SPEED, TORQUE, Units, VOLUME};
use crate::setup::new_car::full_load::Curve;
use cvtcycle_model::keys::RPM;
use cvtcycle_model::math::{exp, ln};

/// Speed of rated power where none is given, rpm, and highest speed above it.
const RATED_RPM: f64 = 6200.0;
/// Highest torque over that at rated power, and its speed over that of rated power, where none are given.
const USUAL_TORQUE: (f64, f64) = (1.09, 0.68);
/// Power has its unit: data sheets have kW, hp or PS, and a number of one is a likely power in the others, so that no doubt finds it.
const POWER_HINT: &str = "write its unit: 104kW@6400, 140hp@6400 or 142PS@6400";

/// Cylinders of an engine of that size, cm3 (NC-9).
fn cylinders(cc: f64) -> f64 {
    let more = [1050.0, 2700.0, 4200.0].into_iter();
    let found = more.zip([3.0, 4.0, 6.0]).find(|(up_to, _)| cc <= *up_to);
    found.map_or(8.0, |(_, count)| count)
}

impl Given<'_> {
    /// A number and the numbers after its @, such as 172@3800-4400.
    pub(super) fn at_speed(&mut self, option: &str, units: &Units) -> Option<(f64, Vec<f64>)> {
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

    /// Values from the size of the engine.
    pub(super) fn size(&mut self) {
        let Some(cc) = self.number("displacement", &VOLUME).filter(|cc| *cc > 0.0) else {
            return;
        };
        let litres = cc / 1e3;
        let (stroke_mm, of_stroke) = match self.answers.engine_like {
            None => {
                let of_cylinder_mm3 = cc * 1e3 / cylinders(cc);
                (exp(ln(of_cylinder_mm3 * 4.0 / PI) / 3.0), "NC-9, ASSUMED") // pi/4 s^3
            }
            Some(_) => {
                let named = cc / self.inherited("engine.displacement_cc");
                let stroke_mm = self.inherited("engine.stroke_mm") * exp(ln(named) / 3.0);
                (stroke_mm, "NC-19, of the named engine")
            }
        };
        for (key, value, rule) in [
            ("engine.stroke_mm", format!("{stroke_mm:.1}"), of_stroke),
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

    /// Values from power and torque of the engine.
    pub(super) fn power(&mut self) {
        let torque = self.at_speed("torque", &TORQUE);
        let Some((kw, speeds)) = self.at_speed("power", &POWER) else {
            return;
        };
        self.is_given("power", "engine.rated_kw", digits(kw));
        for (key, kj_k) in [
            ("thermal.engine.block_kj_k", 0.525),
            ("thermal.engine.oil_kj_k", 0.28),
        ] {
            self.follows(key, format!("{:.1}", kj_k * kw), "NC-6".to_owned());
        }
        if torque.is_none() && self.answers.engine_like.is_some() {
            return self.named_line(kw, speeds.first().copied());
        }
        let rated_rpm = speeds.first().copied().unwrap_or(RATED_RPM);
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

    /// The line of a named engine, scaled to a rated power and its speed (NC-19).
    fn named_line(&mut self, kw: f64, rated_rpm: Option<f64>) {
        let line = &self.base.engine().full_load;
        let points: Vec<(f64, f64)> = line.points().map(|(w, nm)| (w / RPM, nm)).collect();
        let kw_at = |(rpm, nm): &(f64, f64)| rpm * nm * RPM / 1e3;
        let Some(rated) = points.iter().max_by(|a, b| kw_at(a).total_cmp(&kw_at(b))) else {
            return;
        };
        let faster = rated_rpm.map_or(1.0, |rpm| rpm / rated.0);
        let stronger = kw / (kw_at(rated) * faster);
        let row = |(rpm, nm): &(f64, f64)| format!("[{:.0}, {:.1}]", rpm * faster, nm * stronger);
        let rows: Vec<String> = points.iter().map(row).collect();
        let words = format!(
            "NC-19: line of the named engine, speeds times {faster:.3}, torques times {stronger:.3}"
        );
        self.follows(
            "engine.full_load",
            format!("[{}]", rows.join(", ")),
            words.clone(),
        );
        if self.number("highest", &SPEED).is_none() {
            let highest_rpm = (self.inherited("engine.highest_rpm") * faster).round();
            self.follows("engine.highest_rpm", digits(highest_rpm), words);
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
}
