//! Limits of the search for minimum fuel: their options, and the message for infeasible ones.

use super::OptimumArgs;
use crate::args::problems::bad_value;
use crate::args::{count, number};
use cvtcycle::analysis::optimum::{Infeasible, LimitName, Unheld};
use cvtcycle::config::setup::Setup;
use cvtcycle::config::{Bound, Problems};
use cvtcycle::model::keys::rpm;
use cvtcycle::output::Row;
use cvtcycle::output::number::fixed;
use serde::Serialize;

/// Allowed minimum engine speed, rpm.
pub(super) const MIN_RPM: Bound = Bound::closed(300.0, 8000.0);
/// Allowed torque reserve, per cent of full load.
const RESERVE: Bound = Bound::closed(0.0, 90.0);
/// Allowed minimum safety factor.
const SAFETY: Bound = Bound::closed(1.0, 10.0);
/// Allowed maximum slip, per cent.
const SLIP: Bound = Bound::closed(0.1, 20.0);
/// Allowed numbers of ratios of the grid.
const GRID: std::ops::RangeInclusive<u64> = 49..=769;

/// Parsed limits.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Numbers {
    pub(super) ambient_degc: f64,
    pub(super) dt_s: f64,
    pub(super) least_rpm: f64,
    pub(super) reserve_percent: f64,
    pub(super) safety: f64,
    pub(super) max_slip_percent: f64,
    pub(super) ratios: usize,
}

impl OptimumArgs {
    pub(super) fn numbers(
        &self,
        (dt_s, least): (Option<f64>, Option<f64>),
        problems: &mut Problems,
    ) -> Option<Numbers> {
        let ambient = self.ambient.get(problems);
        let mut take = |option: &str, text: &str, range: Bound, suffix: &str| {
            problems.take(number(option, text, range, suffix))
        };
        let reserve = take("--reserve", &self.reserve, RESERVE, "reserve_percent");
        let safety = take("--safety", &self.safety, SAFETY, "safety");
        let slip = take("--max-slip", &self.max_slip, SLIP, "slip_percent");
        let ratios = problems.take(count("--grid", &self.grid, GRID));
        if ratios.is_some_and(|n| n % 4 != 1) {
            let message = "the grid is compared with one of half and of a quarter of its ratios";
            let allowed = "49, 53, 57 to 769";
            let hint = "four times a number, and one: 49, 97, 193";
            problems.add(bad_value("--grid", &self.grid, allowed, message, hint));
        }
        Some(Numbers {
            ambient_degc: ambient?,
            dt_s: dt_s?,
            least_rpm: least?,
            reserve_percent: reserve?,
            safety: safety?,
            max_slip_percent: slip?,
            ratios: usize::try_from(ratios?).ok()?,
        })
    }

    pub(super) fn check_min_speed(
        &self,
        setup: &Setup,
        least_rpm: Option<f64>,
        problems: &mut Problems,
    ) {
        let engine = setup.engine();
        let [idle, peak] = [engine.idle_hot_rad_s, engine.peak_power_rad_s()].map(rpm);
        if least_rpm.is_some_and(|least_rpm| !(idle..=peak).contains(&least_rpm)) {
            let allowed = format!("{} to {} rpm", fixed(idle, 0), fixed(peak, 0));
            let message = "the least engine speed is outside those in which the engine is driven";
            let hint = "above idle speed, up to that of greatest power";
            problems.add(bad_value(
                "--least-rpm",
                &self.least_rpm,
                &allowed,
                message,
                hint,
            ));
        }
    }
}

/// Reports each infeasible limit with its place and its feasible value.
pub(super) fn infeasible(why: &Infeasible, args: &OptimumArgs) -> Problems {
    if why.unheld.is_empty() {
        let message = format!("no ratio lets the car follow the cycle {}", place(&why.row));
        let hint = "another cycle, or a car that can follow it";
        return bad_value("--cycle", &args.cycle.word, "", &message, hint).into();
    }
    let problem = |limit: &Unheld| {
        let (option, value) = match limit.name {
            LimitName::LeastSpeed => ("--least-rpm", &args.least_rpm),
            LimitName::Reserve => ("--reserve", &args.reserve),
            LimitName::ShiftRate => ("--vehicle", &args.car.vehicle),
        };
        let allowed = match (limit.name, limit.most) {
            (LimitName::LeastSpeed, Some(w)) => format!("at most {} rpm", fixed(rpm(w).floor(), 0)),
            (LimitName::Reserve, Some(share)) => format!("at most {} %", floored(100.0 * share)),
            _ => "faster shifts".to_owned(),
        };
        let instead = why.instead.iter().map(|other| match other {
            LimitName::LeastSpeed => "a lower --least-rpm",
            LimitName::Reserve => "a smaller --reserve",
            LimitName::ShiftRate => "faster shifts (up_per_s, down_per_s)",
        });
        let instead: Vec<&str> = instead.collect();
        let hint = match instead.is_empty() {
            true => String::new(),
            false => format!("{} would do as well", instead.join(" or ")),
        };
        let message = format!("no ratio holds this limit {}", place(&limit.row));
        bad_value(option, value, &allowed, &message, &hint)
    };
    why.unheld.iter().map(problem).collect()
}

/// Formats with one decimal, rounded down, so that the printed limit is feasible.
fn floored(x: f64) -> String {
    fixed((10.0 * x).floor() / 10.0, 1)
}

fn place(row: &Row) -> String {
    format!(
        "at {} s ({} km/h, {} kW at the wheels)",
        fixed(row.time_s, 1),
        fixed(3.6 * row.speed_m_s, 1),
        fixed(row.wheel_power_w / 1e3, 1)
    )
}
