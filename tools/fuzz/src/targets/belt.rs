//! Belt model.

use std::fmt::Write as _;

use cvtcycle::config::setup::{self, Options};
use cvtcycle::model::lubricant::BandFriction;
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::point::belt_point;
use cvtcycle::model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, Formulation, belt_capacity_nm, belt_losses, belt_state,
};
use cvtcycle::validate::belt::NUMBERS;

use super::csv::table_of_points;
use super::range::range;
use super::{Bytes, within_memory};

pub fn belt(data: &[u8]) {
    let mut bytes = Bytes(data);
    let way = bytes.byte();
    let formulation = Formulation::NAMES[usize::from(way >> 1) % Formulation::NAMES.len()].1;
    if way % 2 == 0 {
        within_memory(data.len(), || {
            any_numbers(Bytes(&data[data.len().min(1)..]), formulation)
        });
    } else {
        numbers_in_range(bytes, formulation);
    }
}

/// Belt and load of the shipped car.
fn shipped() -> (Belt, BeltLoad) {
    let setup = setup::load("rover_216_cvt", &Options::default())
        .unwrap_or_else(|_| panic!("the shipped car"));
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a car with a belt")
    };
    let (oil, _) = setup.oils();
    let load = BeltLoad {
        primary_speed_rad_s: 200.0,
        output_torque_nm: 60.0,
        secondary_clamp_n: 20_000.0,
        band: BandFriction {
            film_share: [0.3, 0.05],
            ..BandFriction::dry(oil.friction.band)
        },
        film_n: [200.0, 5.0],
        segment_friction: oil.friction.segment,
        capacity_friction: oil.friction.capacity,
        flank_friction: oil.friction.flank,
    };
    (cvt.belt.clone(), load)
}

/// Keeps a shipped number, multiplies it by a factor of either sign, or replaces it by any finite number.
fn moved(value: &mut f64, bytes: &mut Bytes) {
    match bytes.byte() % 4 {
        0 => {}
        1 => *value *= (f64::from(bytes.byte()) - 128.0) / 32.0,
        2 => *value *= (f64::from(bytes.byte()) - 128.0).exp2(),
        _ => {
            *value = Some(bytes.number())
                .filter(|x| x.is_finite())
                .unwrap_or(f64::MAX)
        }
    }
}

/// For any numbers the model returns a result.
fn any_numbers(mut bytes: Bytes, formulation: Formulation) {
    thread_local!(static SHIPPED: (Belt, BeltLoad) = shipped());
    let (mut belt, mut load) = SHIPPED.with(Clone::clone);
    belt.formulation = formulation;
    let mut ratio = 1.7;
    let mut inner_share = load.band.film_share[0];
    let [mut inner_n, mut outer_n] = load.film_n;
    let numbers = [
        &mut ratio,
        &mut load.primary_speed_rad_s,
        &mut load.output_torque_nm,
        &mut load.secondary_clamp_n,
        &mut load.band.mu,
        &mut inner_share,
        &mut inner_n,
        &mut outer_n,
        &mut load.segment_friction,
        &mut load.capacity_friction,
        &mut load.flank_friction,
        &mut belt.centre_distance_m,
        &mut belt.length_m,
        &mut belt.segment_thickness_m,
        &mut belt.cos_wedge,
        &mut belt.tan_wedge,
        &mut belt.band_count,
        &mut belt.band_thickness_m,
        &mut belt.band_width_m,
        &mut belt.band_offset_m,
        &mut belt.mass_kg_m,
        &mut belt.youngs_pa,
        &mut belt.strut_area_m2,
        &mut belt.initial_gap_m,
        &mut belt.primary_compliance_per_n,
        &mut belt.secondary_compliance_per_n,
        &mut belt.stop_from_ratio,
        &mut belt.stop_to_ratio,
        &mut belt.unity_width,
        &mut belt.blend_n,
        &mut belt.slip_bound,
    ];
    for number in numbers {
        moved(number, &mut bytes);
    }
    let at = BeltAtRatio::new(&belt, ratio);
    let point = belt_point(&belt, &at, &load);
    let share = bytes.share() * 2.0 - 1.0;
    let answers = (
        point.with_band_speed(&belt, share),
        belt_state(&belt, &at, &load),
        belt_losses(&belt, &at, &load),
    );
    let capacity_nm = belt_capacity_nm(&belt, &at, &load);
    std::hint::black_box((answers, capacity_nm));
}

/// For numbers within the ranges of a table of points, losses are finite and non-negative.
fn numbers_in_range(mut bytes: Bytes, formulation: Formulation) {
    let mut names = String::new();
    let mut row = String::new();
    for (name, _, allowed) in &NUMBERS {
        let Some((low, high)) = range(&allowed.to_string()) else {
            continue;
        };
        let share = bytes.share();
        let value = low + share * (high - low);
        let is_whole = ["band_count", "primary_on_stop"].contains(name);
        let value = if is_whole { value.round() } else { value };
        let comma = if names.is_empty() { "" } else { "," };
        let _ = write!(names, "{comma}{}", name);
        let _ = write!(row, "{comma}");
        // Missing numbers are the vehicle's own.
        if name.starts_with("output_torque") || comma.is_empty() || !bytes.one_in(4) {
            let _ = write!(row, "{value:?}");
        }
    }
    table_of_points(format!("{names}\n{row}\n").as_bytes(), formulation);
}
