//! A vehicle's belt with the values of a row in place of its own.

use cvtcycle_config::Problem;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::keys::rad_s;
use cvtcycle_model::lubricant::{BandFriction, Friction, Lubricant, ZERO_DEGC_K};
use cvtcycle_model::math::{cos, tan};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::variator::point::{PointFlags, PointLimits};
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltPoint, Formulation, Geometry, belt_point, film_area_m2,
};

use super::rows::{
    BAND_COUNT, BAND_FRICTION, BAND_OFFSET, BELT_TEMP, Given, NUMBERS, ON_STOP, PRESSURE,
    PULLEY_ANGLE, RATIO, SEGMENT_FRICTION, SPEED, TORQUE, WEDGE_ANGLE,
};

/// Belt temperature to which the friction of a fluid refers, degC.
const REFERENCE_DEGC: f64 = 85.0;
/// Boundary friction of the bands in the printed forms.
const PRINTED_BAND_FRICTION: f64 = 0.13;
/// Largest mu beta/2 for which tension and compression have a solution worth the name (TE-5 needs less than 1).
const LARGEST_GRIP: f64 = 0.98;

/// Hint where a printed form has no value.
const DEFINED: &str = "the formulation smooth is defined there";

/// A computed point with the values that it was computed from.
#[derive(Clone, Copy, Debug)]
pub struct Solved {
    /// Answer of the belt model.
    pub point: BeltPoint,
    /// Marks of departures from the model's range.
    pub flags: PointFlags,
    /// The reading in force.
    pub formulation: Formulation,
    /// In the order of [`NUMBERS`]; NaN where none is in force.
    pub numbers: [f64; NUMBERS.len()],
}

/// The belt of a vehicle in each formulation; a row's values are written into it, every one anew for each row.
#[derive(Clone, Debug)]
pub struct Model {
    cvt: Cvt,
    oil: Lubricant,
    limits: PointLimits,
    pulley_angle_deg: f64,
    band_speed_share: Option<f64>,
    belts: [Belt; Formulation::NAMES.len()],
    ratios: [f64; 2],
}

impl Model {
    /// None for a car without a belt. Travel is that of the given band speed, or of the one that the formulation has (BT-1, BT-7).
    pub fn new(setup: &Setup, band_speed_share: Option<f64>) -> Option<Self> {
        let Transmission::Cvt(cvt) = setup.transmission() else {
            return None;
        };
        let belt = &cvt.belt;
        let car = setup.car(ZERO_DEGC_K + 20.0);
        Some(Model {
            oil: setup.oils().0.clone(),
            limits: PointLimits {
                ratio: [cvt.ratio.high, cvt.ratio.low],
                pressure_pa: [cvt.floors.control_pa, cvt.cap_pa],
                highest_rad_s: car.engine.highest_rad_s,
            },
            // The belt keeps the tangent; what is shown is rid of the rounding of the way back.
            pulley_angle_deg: (belt.tan_wedge.atan().to_degrees() * 1e12).round() / 1e12,
            band_speed_share,
            belts: Formulation::NAMES.map(|(_, formulation)| Belt {
                formulation,
                ..belt.clone()
            }),
            ratios: solvable(belt),
            cvt: (**cvt).clone(),
        })
    }

    /// Every reason not to compute a row, with the number concerned; also of a row that lacks some values.
    pub fn check(&self, given: &Given, fallback: Formulation) -> Vec<(usize, Problem)> {
        let formulation = given.formulation.unwrap_or(fallback);
        let mut found = Vec::new();
        let undefined = |place: &str, allowed: &str| {
            let message = format!("{} is not defined at {place}", formulation.name());
            Problem::out_of_range(message)
                .allowed(allowed)
                .hint(DEFINED)
        };
        let is_printed = formulation != Formulation::Smooth;
        if is_printed && self.cvt.belt.chain.is_some() {
            let problem = Problem::invalid("the printed belt model has no chain");
            let problem = problem.allowed(Formulation::Smooth.name());
            found.push((RATIO, problem.hint("take the belt model `smooth`")));
        }
        if let Some(ratio) = given.numbers[RATIO] {
            if !runs(&self.cvt.belt, ratio) {
                found.push((RATIO, no_geometry(self.ratios)));
            } else if is_printed && (ratio - 1.0).abs() <= 0.0 {
                let problem = undefined("ratio 1 (PR-1)", "a ratio other than exactly 1");
                found.push((RATIO, problem));
            }
        }
        if is_printed && given.numbers[SPEED].is_some_and(|rpm| rpm <= 0.0) {
            found.push((SPEED, undefined("rest", "above 0 rpm")));
        }
        found
    }

    /// Computes a whole row that passed [`Model::check`], or returns the reason why not and the number concerned.
    pub fn solve(
        &mut self,
        given: &Given,
        fallback: Formulation,
    ) -> Result<Solved, Box<(usize, Problem)>> {
        let formulation = given.formulation.unwrap_or(fallback);
        let ratio = given.required(RATIO);
        let vehicle = &self.cvt.belt;
        let speed_rad_s = rad_s(given.required(SPEED));
        let pressure_pa = given.required(PRESSURE) * 1e5;
        let clamp_n = self.cvt.secondary_clamp_n(pressure_pa, speed_rad_s / ratio);
        let mut numbers = given.numbers.map(|number| number.unwrap_or(f64::NAN));
        let own = |place: usize, value: f64| given.numbers[place].unwrap_or(value);
        let is_it = |belt: &Belt| belt.formulation == formulation;
        let index = self.belts.iter().position(is_it);
        let belt = &mut self.belts[index.unwrap_or_default()];
        numbers[PULLEY_ANGLE] = own(PULLEY_ANGLE, self.pulley_angle_deg);
        (belt.cos_wedge, belt.tan_wedge) = match given.numbers[PULLEY_ANGLE].map(f64::to_radians) {
            Some(angle) => (cos(angle), tan(angle)),
            None => (vehicle.cos_wedge, vehicle.tan_wedge),
        };
        numbers[BAND_OFFSET] = own(BAND_OFFSET, vehicle.band_offset_m * 1e3);
        belt.band_offset_m =
            given.numbers[BAND_OFFSET].map_or(vehicle.band_offset_m, |mm| mm * 1e-3);
        numbers[BAND_COUNT] = own(BAND_COUNT, vehicle.band_count);
        belt.band_count = numbers[BAND_COUNT];
        let mut at = BeltAtRatio::new(belt, ratio);
        if let Some(angle) = given.numbers[WEDGE_ANGLE] {
            at.fixed.wedge_half_cot = 0.5 / tan(angle.to_radians());
        }
        let wedge_deg = match formulation {
            Formulation::AppendixC => 11.0,
            _ => numbers[PULLEY_ANGLE],
        };
        numbers[WEDGE_ANGLE] = own(WEDGE_ANGLE, wedge_deg);
        if let Some(on_stop) = given.numbers[ON_STOP] {
            at.prepared.stop = if on_stop > 0.5 { 0.0 } else { 1.0 };
        }
        let [band, segment] = frictions(formulation, &self.oil);
        numbers[BAND_FRICTION] = own(BAND_FRICTION, band);
        numbers[SEGMENT_FRICTION] = own(SEGMENT_FRICTION, segment);
        let friction = GivenFriction {
            band: numbers[BAND_FRICTION],
            segment: numbers[SEGMENT_FRICTION],
            belt_k: numbers[BELT_TEMP] + ZERO_DEGC_K,
        };
        let load = BeltLoad {
            output_torque_nm: given.required(TORQUE),
            secondary_clamp_n: clamp_n,
            ..belt_load(&self.oil, belt, ratio, speed_rad_s, &friction)
        };
        let wrap = at.geometry.primary_wrap_rad;
        if load.band.mu * wrap / 2.0 > LARGEST_GRIP {
            let most = 2.0 * LARGEST_GRIP / wrap;
            let allowed = format!("up to {most:.3} at this ratio and temperature");
            let problem = Problem::out_of_range("the bands would block themselves (TE-5)");
            return Err(Box::new((BAND_FRICTION, problem.allowed(allowed))));
        }
        let point = belt_point(belt, &at, &load);
        let point = match self.band_speed_share {
            Some(share) => point.with_band_speed(belt, share),
            None => point,
        };
        let belt_k = belt_k(friction.belt_k);
        let flags = PointFlags::new(&point, &load, pressure_pa, belt_k, &self.limits);
        Ok(Solved {
            point,
            flags,
            formulation,
            numbers,
        })
    }
}

/// Friction and temperature given at a point; NaN where missing.
pub(crate) struct GivenFriction {
    pub band: f64,
    pub segment: f64,
    pub belt_k: f64,
}

/// Temperature of a belt for which none is given, K.
pub(crate) fn belt_k(given_k: f64) -> f64 {
    or(given_k, REFERENCE_DEGC + ZERO_DEGC_K)
}

fn or(x: f64, other: f64) -> f64 {
    if x.is_nan() { other } else { x }
}

/// Boundary friction of bands and segments where none is given.
fn frictions(formulation: Formulation, oil: &Lubricant) -> [f64; 2] {
    let band = match formulation {
        Formulation::Smooth => oil.friction.band,
        _ => PRINTED_BAND_FRICTION,
    };
    [band, formulation.segment_friction(oil.friction.segment)]
}

/// The load of a point without torque and clamping: friction and film as given, else as fluid and formulation have them.
pub(crate) fn belt_load(
    oil: &Lubricant,
    belt: &Belt,
    ratio: f64,
    speed_rad_s: f64,
    given: &GivenFriction,
) -> BeltLoad {
    let fluid = &oil.friction;
    let [band, segment] = frictions(belt.formulation, oil);
    let mu = or(given.band, band);
    let belt_k = belt_k(given.belt_k);
    // The printed forms know no film: without sliding there is no lift-off, the rise with temperature stays (LU-4).
    let sliding = belt.sliding_m_s(ratio, speed_rad_s);
    let geometry = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
    let band = if given.belt_k.is_nan() {
        BandFriction::dry(mu)
    } else {
        Friction { band: mu, ..*fluid }.band(belt_k, oil.dynamic_pa_s(belt_k), sliding)
    };
    BeltLoad {
        primary_speed_rad_s: speed_rad_s,
        segment_friction: or(given.segment, segment),
        ..BeltLoad::unloaded(fluid, band, film_area_m2(belt, &geometry), sliding)
    }
}

fn no_geometry(ratios: [f64; 2]) -> Problem {
    if ratios[0].is_nan() {
        let hint = "check length_m of the belt against centre_distance_mm";
        return Problem::conflict("this belt does not fit round these pulleys at any ratio")
            .hint(hint);
    }
    let message =
        "the belt cannot run at this ratio: no radii on which both pulleys carry a segment";
    let allowed = format!("{:.4} to {:.4}", ratios[0], ratios[1]);
    Problem::out_of_range(message)
        .allowed(allowed)
        .hint("I = R_sec / R_pri")
}

/// True if the belt has radii at this ratio.
fn runs(belt: &Belt, ratio: f64) -> bool {
    let geometry = |ratio| Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
    ratio > 0.0 && geometry(ratio).is_real(belt.length_m, belt.segment_thickness_m)
}

/// Smallest and largest ratio at which the belt runs, NaN if it does not run at 1: there the radii are equal.
fn solvable(belt: &Belt) -> [f64; 2] {
    let end = |log: f64| {
        let (mut inside, mut outside) = (0.0, log);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (inside + outside);
            (inside, outside) = if runs(belt, middle.exp()) {
                (middle, outside)
            } else {
                (inside, middle)
            };
        }
        inside.exp()
    };
    if runs(belt, 1.0) {
        [end(-7.0), end(7.0)]
    } else {
        [f64::NAN; 2]
    }
}
