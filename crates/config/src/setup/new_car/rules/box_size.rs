//! A CVT of a class that fits its engine: pump, launch device, pistons, belt and heat capacity by the highest torque T of the full-load line.
//!
//! The class's box is that of the one car of 1995 for which the parts are known; each rule scales one part from it. What a user gives stays.

use super::{Given, Line, digits};
use crate::setup::doubts::{WARM_K, gripped_nm};
use cvtcycle_model::keys::RAD_S;
use cvtcycle_model::math::Curve;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;

/// Displacement of a pump for a torque, cm3 a turn and Nm (NC-11).
const PUMP_CC_NM: f64 = 8.0 / 130.0;
/// Least displacement of a pump, cm3 a turn (NC-11).
const LEAST_PUMP_CC: f64 = 6.0;
/// Speeds at which full load holds the engine against a car at rest, rpm: with a converter, with a clutch (NC-12).
const STALL_RPM: [f64; 2] = [2400.0, 2500.0];
/// Safety at the highest torque where the clamp law has none (NC-13).
const SAFETY: f64 = 1.3;
/// Inner radius of the pistons, cm, as the class has it.
const INNER_CM: f64 = 3.0;
/// Torque above which the belt is a wide one, Nm; its mass and the width of its bands over those of a narrow one (NC-14).
const WIDE: (f64, f64) = (200.0, 1.25);
/// Mass of a box, kg: at no torque, and for a newton metre; mass of that whose heat capacity the class has (NC-15).
const BOX_KG: (f64, f64, f64) = (40.0, 0.18, 60.0);

impl Given<'_> {
    /// Sizes the parts of a box that comes from a class.
    pub(super) fn fit_box(&mut self) {
        let of_class = self.answers.like.is_none() || self.answers.gearbox.is_some();
        let Transmission::Cvt(cvt) = self.base.transmission() else {
            return;
        };
        let line = self.full_load_line();
        let highest_nm = line.points().map(|(_, nm)| nm).fold(0.0, f64::max);
        if !of_class || highest_nm <= 0.0 {
            return;
        }
        if self.text("pump").is_none() {
            let of_torque = PUMP_CC_NM * highest_nm;
            let source = match of_torque < LEAST_PUMP_CC {
                true => format!(
                    "NC-11: {of_torque:.1} by {highest_nm:.0} Nm, but at least 6, 5 to 7: the smallest box that was measured has 6.1 (Justy); 4.5 at idle go into lubrication and leaks alone"
                ),
                false => format!(
                    "NC-11: {highest_nm:.0} Nm, 0.062 cc/rev a Nm, 0.06 to 0.095: one car of 1995 has 8 for 130 Nm, a box for 200 Nm 19 (SAE 2004-40CVT-49)"
                ),
            };
            self.sized(
                "transmission.cvt.pump.displacement_cc_rev",
                format!("{:.1}", of_torque.max(LEAST_PUMP_CC)),
                source,
            );
        }
        self.launch(cvt, &line);
        self.pistons(cvt, highest_nm);
        if cvt.belt.chain.is_none() {
            self.wide_belt(highest_nm);
        }
        let (least_kg, kg_nm, of_class_kg) = BOX_KG;
        let share = (least_kg + kg_nm * highest_nm) / of_class_kg;
        let metal_kj_k = share * self.inherited("thermal.transmission.metal_kj_k");
        self.sized(
            "thermal.transmission.metal_kj_k",
            format!("{metal_kj_k:.1}"),
            format!(
                "NC-15, ASSUMED: {:.0} kg of box for {highest_nm:.0} Nm, 10 kg more or less",
                share * of_class_kg
            ),
        );
    }

    fn sized(&mut self, key: &'static str, value: String, source: String) {
        self.lines.push(Line {
            key,
            value,
            status: "assumed",
            source,
            option: None,
        });
    }

    /// The line of full load, rpm and Nm: that of the new car, else the inherited one.
    fn full_load_line(&self) -> Curve {
        let mut own = (self.lines.iter()).filter(|line| line.key == "engine.full_load");
        let rows = own.next().and_then(|line| rows(&line.value));
        let rows = rows.unwrap_or_else(|| {
            let points = self.base.engine().full_load.points();
            points.map(|(rad_s, nm)| (rad_s * RAD_S, nm)).collect()
        });
        Curve::new(&rows).unwrap_or_else(|_| Curve::constant(0.0)) // such a line is a problem of the car
    }

    /// The launch device (NC-12).
    fn launch(&mut self, cvt: &Cvt, line: &Curve) {
        let [by_converter, by_clutch] = STALL_RPM;
        if cvt.coupling.by_command() {
            let nm = line.at(by_converter);
            let thousands = by_converter / 1e3;
            self.sized(
                "transmission.cvt.launch.torque_converter.capacity_nm",
                format!("{:.2}", nm / (thousands * thousands)),
                format!(
                    "NC-12: {nm:.0} Nm at a stall speed of 2400 rpm, 2050 to 2900: service data of five CVT cars of 120 to 240 Nm have no fall with torque; EPA's ALPHA sizes 3030 rpm over the root of the highest torque, 2900 rpm"
                ),
            );
            return;
        }
        let nm = line.at(by_clutch);
        let key = "transmission.cvt.launch.friction_clutch";
        let above = by_clutch - self.inherited(&format!("{key}.engage_rpm"));
        if above > 0.0 {
            self.sized(
                "transmission.cvt.launch.friction_clutch.gain_nm_per_rpm2",
                format!("{:.3e}", nm / (above * above)),
                format!(
                    "NC-12: {nm:.0} Nm at 2500 rpm, 2350 to 2650 rpm at full load and rest: Honda Fit and Insight with a starting clutch, 119 and 89 Nm (service data)"
                ),
            );
        }
    }

    /// Pistons with which the largest pressure grips in low (NC-13).
    fn pistons(&mut self, cvt: &Cvt, highest_nm: f64) {
        let safety = match cvt.clamp {
            ClampLaw::TorqueFollowing { safety, .. } | ClampLaw::SlipLimited { safety, .. } => {
                safety
            }
            ClampLaw::Map(_) | ClampLaw::Table => SAFETY,
        };
        let needed_nm = safety * highest_nm;
        let oil = self.base.car(WARM_K).oil;
        let clamp_n = cvt.secondary_clamp_n(cvt.cap_pa, 0.0);
        let gripped_nm = gripped_nm(cvt, &oil, clamp_n);
        let share = needed_nm / gripped_nm;
        let area_cm2 = 1e4 * (share * clamp_n - cvt.spring_n) / cvt.cap_pa;
        if area_cm2.is_nan() || area_cm2 <= 0.0 {
            return;
        }
        let of_primary = cvt.primary_piston_m2 / cvt.secondary_piston_m2;
        let outer_cm = (area_cm2 / std::f64::consts::PI + INNER_CM * INNER_CM).sqrt();
        let words = format!(
            "NC-13: {:.0} bar grip {needed_nm:.0} Nm in low, {safety} times the highest torque",
            cvt.cap_pa / 1e5
        );
        for (key, value) in [
            ("transmission.cvt.variator.secondary_piston_cm2", area_cm2),
            (
                "transmission.cvt.variator.primary_piston_cm2",
                of_primary * area_cm2,
            ),
            ("transmission.cvt.variator.piston_outer_mm", 10.0 * outer_cm),
        ] {
            self.sized(key, format!("{value:.1}"), words.clone());
        }
    }

    /// A wide belt for a large torque (NC-14).
    fn wide_belt(&mut self, highest_nm: f64) {
        let (above_nm, wider) = WIDE;
        if highest_nm <= above_nm {
            return;
        }
        let source = "NC-14, ASSUMED: a belt of 30 mm above 200 Nm, 24 mm below; 180 to 250 Nm";
        let width_mm = wider * self.inherited("transmission.cvt.belt.band_width_mm");
        self.sized(
            "transmission.cvt.belt.band_width_mm",
            digits(width_mm),
            source.to_owned(),
        );
        let key = "transmission.cvt.belt.mass_kg";
        if let Some(line) = self.lines.iter_mut().find(|line| line.key == key) {
            let kg: f64 = line.value.parse().unwrap_or(f64::NAN);
            line.value = format!("{:.3}", wider * kg);
            line.source = format!("{}, {source}", line.source);
            return;
        }
        self.sized(
            key,
            format!("{:.3}", wider * self.inherited(key)),
            source.to_owned(),
        );
    }
}

/// Rows of a line as a file has them.
fn rows(text: &str) -> Option<Vec<(f64, f64)>> {
    let table: toml::Table = toml::from_str(&format!("rows = {text}")).ok()?;
    let number = |value: &toml::Value| {
        let whole = value.as_integer().map(|whole| whole as f64);
        value.as_float().or(whole)
    };
    let pair = |row: &toml::Value| {
        let row = row.as_array()?;
        Some((number(row.first()?)?, number(row.get(1)?)?))
    };
    table.get("rows")?.as_array()?.iter().map(pair).collect()
}
