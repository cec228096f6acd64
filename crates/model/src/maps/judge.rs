//! Judgement of the points of a fuel map by physics: which of them no engine has, and which are likely slips. Points above full load are not judged: makers
//! of maps fill their grids there with any number.

use super::{BsfcMap, NoMap, Point};
use crate::math::rpm;

/// Best brake efficiencies of engines of cars. The measured maps of `classes` have 0.36 to 0.42; the widest here has room for a diesel engine and for
/// one that is worn. g/kWh that are g/hp-h make 0.45 to 0.56 of these. ASSUMED.
const BEST: std::ops::RangeInclusive<f64> = 0.24..=0.45;
/// Below this speed no engine is loaded, and measured rows there are extrapolated by those who make a map: they are doubted, and refuse nothing, rad/s (600 rpm).
const LOADED_RAD_S: f64 = 63.0;
/// Load over full load up to which a point is judged: rounding of the units.
const UP_TO: f64 = 1.0 + 1e-6;

/// Findings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Why there can be no such engine.
    pub refusal: Option<NoMap>,
    /// Likely slips, a sentence each.
    pub doubts: Vec<String>,
}

impl BsfcMap {
    /// Judges the points below full load, whose mean effective pressure is given over speed, rad/s to Pa. A map that is from no file has no points.
    #[must_use]
    pub fn judge(&self, full_load_pa: impl Fn(f64) -> f64) -> Verdict {
        let Some(origin) = self.origin.as_deref() else {
            return Verdict::default();
        };
        let below = |point: &&Point| point.bmep_pa <= UP_TO * full_load_pa(point.speed_rad_s);
        let judged: Vec<&Point> = origin.points.iter().filter(below).collect();
        let loaded = || judged.iter().filter(|point| point.bmep_pa > 0.0);
        if let Some(point) = loaded().find(|point| point.fuel_pa < point.bmep_pa) {
            return Verdict {
                refusal: Some(self.work_of_nothing(point)),
                doubts: Vec::new(),
            };
        }
        let mut doubts = Vec::new();
        let mut falls = Vec::new();
        let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-8 * b.abs();
        for line in judged.chunk_by(|a, b| is_near(a.speed_rad_s, b.speed_rad_s)) {
            let burns: Vec<&&Point> = line.iter().filter(|point| point.fuel_pa > 0.0).collect();
            let pairs = burns.windows(2);
            let before = falls.len();
            falls.extend(
                pairs
                    .filter(|two| two[1].fuel_pa <= two[0].fuel_pa)
                    .map(|two| [*two[0], *two[1]]),
            );
            if falls.len() > before
                && let [first, .., last] = burns.as_slice()
                && last.fuel_pa < first.fuel_pa
                && last.speed_rad_s > LOADED_RAD_S
            {
                return Verdict {
                    refusal: Some(self.falling(first, last)),
                    doubts: Vec::new(),
                };
            }
        }
        if let Some([first, second]) = falls.first() {
            let more = match falls.len() - 1 {
                0 => String::new(),
                n => format!("; {n} more rows are like that"),
            };
            doubts.push(format!(
                "{}, line {}: at {:.0} rpm the engine burns no more at {} than at {} (line {}){more}: the map is used as it is",
                origin.file,
                second.line,
                rpm(second.speed_rad_s),
                self.load(second),
                self.load(first),
                first.line
            ));
        }
        let efficiency = |point: &Point| point.bmep_pa / point.fuel_pa;
        let best = loaded().max_by(|a, b| efficiency(a).total_cmp(&efficiency(b)));
        match best {
            Some(best) if !BEST.contains(&efficiency(best)) => doubts.push(format!(
                "the best efficiency of {} is {:.0} %, at {:.0} rpm and {} (line {}), that of car engines 25 to 45 %: check the units of the map, and the swept volume and the fuel of the engine that was measured (measured_cc, measured_mj_kg)",
                origin.file,
                100.0 * efficiency(best),
                rpm(best.speed_rad_s),
                self.load(best),
                best.line
            )),
            Some(_) => {}
            None => doubts.push(format!(
                "no point of {} has a load between zero and the full load of the engine: check the unit of its loads, and measured_cc",
                origin.file
            )),
        }
        Verdict {
            refusal: None,
            doubts,
        }
    }

    /// Load of a point in words.
    fn load(&self, point: &Point) -> String {
        let torque_nm = self.torque_nm(point.bmep_pa).unwrap_or_default();
        format!("{torque_nm:.1} N m")
    }

    fn place(&self, point: &Point) -> String {
        let file = self.origin.as_ref().map_or("", |origin| &origin.file);
        format!(
            "{file}, line {}: at {:.0} rpm and {}",
            point.line,
            rpm(point.speed_rad_s),
            self.load(point)
        )
    }

    fn work_of_nothing(&self, point: &Point) -> NoMap {
        NoMap::new(
            "an efficiency below 100 %",
            format!(
                "{} the efficiency is {:.0} %",
                self.place(point),
                100.0 * point.bmep_pa / point.fuel_pa
            ),
            "correct the row, the unit of a column, or measured_cc and measured_mj_kg",
        )
    }

    fn falling(&self, first: &Point, last: &Point) -> NoMap {
        NoMap::new(
            "more fuel at full load than at part load",
            format!(
                "{} fuel is {:.0} % of that at {} (line {}): it must rise with load at every speed",
                self.place(last),
                100.0 * last.fuel_pa / first.fuel_pa,
                self.load(first),
                first.line
            ),
            "correct the rows; are two columns exchanged, or is the unit of the fuel another one?",
        )
    }
}
