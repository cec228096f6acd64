//! Checks that can see a wrong torque, which an energy balance cannot: what a row says, held against forces, speeds and temperatures that are
//! worked out here once more and in another way.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PX-1 | T_p - T_s/I = (1 - 1/I)(d F_1 + t sum F_i) + wedge + penetration, F_i = -s (k_i mu_b (1-u_i)(1 - (i-1)/n) beta Tm + V_i), V_i the film's force, k_1 that of the shoulders | derived: moments about the centres of both pulleys; slip is not in them |
//! | PX-2 | one F_1 and Tm = A + \|C_x\|/2, C_x = T_s/R_s - F_1, on both pulleys: what bands and film lose over their levers, step and mean tension | derived: a belt of two strands has one step of tension |
//! | PX-9 | a chain, for PX-1: T_p = T_1 (R_p + e) - T_2 (R_p - e) + M_p, T_s = T_1 (R_s - e) - T_2 (R_s + e) - M_s, M the moments of its pin ends as work, joint by joint; for PX-2: the strands by the loss of its joints are those of the free body of the secondary's wrap | derived: moments about the centres of both pulleys |
//! | PX-3 | burnt fuel <= charge eta_v rho_0 V w/(4 pi) LHV/14.6, eta_v 1.05 or what the full-load line needs | derived: the air in the cylinders; 14.6 stoichiometric, 1.05 ASSUMED of an engine without charger |
//! | PX-4 | rotating energy, the sum of its changes, = J w2/2 at the end of every step; less only where the engine gives full load, or the brakes all that they have (SI-5), and more is wanted | derived |
//! | PX-5 | losses >= 0, T_p w_p >= T_s w_s, no belt loss at rest | derived: second law |
//! | PX-7 | losses + heat of the engine = heat to the air + sum C_i (T_i - T_i,before)/dt | derived: first law, by the temperatures of two rows |
//! | PX-8 | T_p w_p - T_s w_s = losses of the belt, w_s by the road speed, w_p by slip | derived: power is torque times speed |
//!
//! Radii come from a bisection of the belt's length, compression, tension and the heating of the film from iteration. Taken over from the
//! model: boundary friction, film share and shear stress of the fluid, the thrust ratio table, and the torques of wedging and penetration.
//! PX-1 and PX-2 are those of the driving form without factors on its losses (CV-7); the printed forms break both by design. PX-6, the same data sheet gives the same fuel, is a test.

use super::{Car, EnergyTerms, Recorder, Row, State, Vehicle, simulate};
use crate::cycle::Cycle;
use crate::flags::Flags;
use crate::lubricant::{BandFriction, VALID_K};
use crate::math::{larger, ln, pair, smaller};
use crate::prime_mover::PrimeMover;
use crate::thermal::{BELT, COOLANT, ENGINE_OIL, Heat};
use crate::transmission::Transmission;
use crate::transmission::component::Component;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::variator::{Belt, BeltAtRatio, BeltLoad, Chain, belt_state};
use std::f64::consts::PI;

/// A law that is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// PX-1.
    Statics,
    /// PX-2.
    OneForce,
    /// PX-3.
    Air,
    /// PX-4.
    Rotation,
    /// PX-5.
    SecondLaw,
    /// PX-7.
    Heat,
    /// PX-8.
    ShaftPower,
}

impl Law {
    /// All laws, in the order of their labels.
    pub const ALL: [Law; 7] = [
        Law::Statics,
        Law::OneForce,
        Law::Air,
        Law::Rotation,
        Law::SecondLaw,
        Law::Heat,
        Law::ShaftPower,
    ];

    const fn words(self) -> [&'static str; 3] {
        match self {
            Law::Statics => [
                "PX-1",
                "Nm",
                "moments about both pulleys against the torque at the primary",
            ],
            Law::OneForce => [
                "PX-2",
                "N",
                "one step of band tension on both pulleys and in the bands' loss",
            ],
            Law::Air => [
                "PX-3",
                "bar",
                "fuel burnt against what the air in the cylinders burns (mean effective pressure)",
            ],
            Law::Rotation => ["PX-4", "J", "rotating energy against J w2/2"],
            Law::SecondLaw => [
                "PX-5",
                "W",
                "power that a loss gives back, or that a belt at rest loses",
            ],
            Law::Heat => [
                "PX-7",
                "W",
                "losses and engine heat against the rise of the temperatures",
            ],
            Law::ShaftPower => [
                "PX-8",
                "W",
                "torque times speed of both pulleys against the belt's losses",
            ],
        }
    }

    /// Label of its equation.
    pub const fn label(self) -> &'static str {
        self.words()[0]
    }

    /// Unit of its residual.
    pub const fn unit(self) -> &'static str {
        self.words()[1]
    }

    /// Compared quantities, one phrase.
    pub const fn doc(self) -> &'static str {
        self.words()[2]
    }
}

/// Worst row of a law: the one nearest to its bound, or farthest beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The law.
    pub law: Law,
    /// Rows to which it applies.
    pub rows: u64,
    /// Residual of that row, in the unit of the law.
    pub residual: f64,
    /// Largest residual that rounding and the tolerance of the solve explain there.
    pub bound: f64,
    /// End of that row, s.
    pub at_s: f64,
}

impl Finding {
    /// True where no row breaks the law; false for a residual that is no number.
    pub fn holds(&self) -> bool {
        self.residual <= self.bound
    }

    fn take(&mut self, at_s: f64, residual: f64, bound: f64) {
        let (share, worst) = (residual / bound, self.residual / self.bound);
        self.rows += 1;
        if self.rows == 1 || share > worst || (share.is_nan() && !worst.is_nan()) {
            (self.residual, self.bound, self.at_s) = (residual, bound, at_s);
        }
    }
}

/// Parts of the loss between the shafts of both pulleys.
const BELT_PARTS: [Component; 8] = [
    Component::BeltBand,
    Component::BeltFilm,
    Component::ChainJoint,
    Component::ChainPin,
    Component::BeltSlip,
    Component::BeltWedge,
    Component::BeltPenetration,
    Component::BeltMap,
];
/// Relative residual that the tolerance of the implicit solve, 1e-7 in slip, leaves in forces.
const SOLVED: f64 = 1e-6;
/// Relative residual of rounding.
const ROUNDING: f64 = 1e-9;
/// Air to fuel by mass at stoichiometry.
const STOICHIOMETRIC: f64 = 14.6;
/// Density of air at 25 degC and sea level, kg/m3.
const AIR_KG_M3: f64 = 101_325.0 / (287.05 * 298.15);
/// Volumetric efficiency that no engine without charger exceeds.
const VOLUMETRIC: f64 = 1.05;
/// Passes of bisection and iteration: enough for the last bit.
const PASSES: u32 = 400;

/// Checks every row that it records.
///
/// ```
/// use cvtcycle_config::{cycle::embedded, setup::{Options, load}};
/// use cvtcycle_model::drive::{PhysicsCheck, State, simulate};
///
/// let car = load("rover_216_cvt", &Options::default()).expect("a shipped car").car(263.15);
/// let cycle = embedded("ece15").expect("a shipped cycle");
/// let start = State::at(263.15);
/// let mut check = PhysicsCheck::new(&car, &start);
/// simulate(&car, cycle.trace_for(true), 1.0, start, &mut check);
/// assert!(check.findings().iter().all(|finding| finding.rows > 0 && finding.holds()));
/// ```
#[derive(Clone, Debug)]
pub struct PhysicsCheck<'a> {
    car: &'a Car,
    /// Temperatures before the row.
    before: Heat,
    /// Rotating energy that the car has by the changes of all rows, J; none before the first.
    rotating_j: Option<f64>,
    /// Time since the engine was started, s.
    running_s: f64,
    /// Fuel mean effective pressure that the air burns, Pa.
    air_pa: f64,
    findings: [Finding; Law::ALL.len()],
}

/// Drives a car through a cycle after a soak and checks every step.
pub fn check_physics(
    vehicle: &Vehicle,
    cycle: &Cycle,
    ambient_k: f64,
    max_dt_s: f64,
) -> Vec<Finding> {
    let car = &vehicle.car(ambient_k);
    let start = State::at(ambient_k);
    let mut check = PhysicsCheck::new(car, &start);
    let trace = vehicle.trace(cycle).trace;
    simulate(car, &trace, max_dt_s, start, &mut check);
    check.findings().to_vec()
}

impl Recorder for PhysicsCheck<'_> {
    fn record(&mut self, row: &Row, _: &EnergyTerms) {
        if let Transmission::Cvt(cvt) = &self.car.transmission {
            self.belt(cvt, row);
        }
        self.engine(row);
        self.second_law(row);
        self.heat(row);
    }
}

impl<'a> PhysicsCheck<'a> {
    /// Checks a car from a state on.
    pub fn new(car: &'a Car, start: &State) -> Self {
        PhysicsCheck {
            car,
            before: start.heat,
            rotating_j: None,
            running_s: 0.0,
            air_pa: air_pa(car),
            findings: Law::ALL.map(|law| Finding {
                law,
                rows: 0,
                residual: 0.0,
                bound: 0.0,
                at_s: 0.0,
            }),
        }
    }

    /// Worst rows so far, in the order of [`Law::ALL`].
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    fn see(&mut self, law: Law, row: &Row, residual: f64, bound: f64) {
        self.findings[law as usize].take(row.time_s, residual, bound);
    }

    /// PX-8, and PX-1 and PX-2 of a belt that is modelled.
    fn belt(&mut self, cvt: &Cvt, row: &Row) {
        let secondary_rad_s = secondary_rad_s(self.car, cvt, row);
        if secondary_rad_s <= 0.0 || row.primary_nm.is_nan() {
            return;
        }
        let primary_rad_s = row.belt_ratio * secondary_rad_s / (1.0 - row.slip);
        let shafts_w = [
            row.primary_nm * primary_rad_s,
            row.secondary_nm * secondary_rad_s,
        ];
        let lost_w: f64 = BELT_PARTS.iter().map(|part| row.loss_w[*part]).sum();
        self.see(
            Law::ShaftPower,
            row,
            (shafts_w[0] - shafts_w[1] - lost_w).abs(),
            ROUNDING * (shafts_w[0].abs() + shafts_w[1].abs() + 1.0),
        );
        let factor = cvt.loss_factors();
        let as_modelled = BELT_PARTS
            .iter()
            .all(|part| (factor[*part] - 1.0).abs() <= 0.0);
        let is_map = cvt.has_map(Component::BeltMap) || cvt.has_map(Component::BoxMap);
        let modelled = cvt.belt.formulation.by_statics() && !is_map && as_modelled;
        // Outside the fluid's range friction is extrapolated: where friction times wrap exceeds 2, PX-2 has no solution.
        let valid = VALID_K.contains(&self.before.node_k[BELT]);
        if modelled && valid && !row.flags.contains(Flags::NOT_CONVERGED) {
            let load = BeltLoad {
                output_torque_nm: row.secondary_nm,
                secondary_clamp_n: row.secondary_pressure_pa * cvt.secondary_piston_m2
                    + cvt.spring_n
                    + cvt.centrifugal_n_s2 * secondary_rad_s * secondary_rad_s,
                primary_speed_rad_s: primary_rad_s,
                ..BeltLoad::turning(
                    &cvt.belt,
                    &self.car.oil,
                    self.before.node_k[BELT],
                    row.belt_ratio,
                    row.belt_ratio * secondary_rad_s,
                )
            };
            self.statics(&cvt.belt, row, &load);
        }
    }

    /// PX-9.
    fn chain_statics(&mut self, belt: &Belt, chain: &Chain, row: &Row, load: &BeltLoad) {
        let (ratio, w) = (row.belt_ratio, load.primary_speed_rad_s);
        let radii = Radii::new(belt, ratio);
        let ([r_p, r_s], wraps) = (radii.radius_m, radii.wrap_rad);
        let thrust = match &belt.thrust_ratio {
            Some(_) => BeltAtRatio::new(belt, ratio).thrust_ratio,
            None => wraps[0] / wraps[1],
        };
        let clamp_n = [load.secondary_clamp_n * thrust, load.secondary_clamp_n];
        let output_nm = load.output_torque_nm;
        // The secondary changes the tension over the last part of its wrap, with all the friction there is.
        let grip_n =
            2.0 * load.capacity_friction * smaller(clamp_n[0], clamp_n[1]) / belt.cos_wedge;
        let pull_n = output_nm / r_s;
        let slides = smaller(pull_n.abs() / grip_n, 1.0);
        let (v, pressed_n) = (w * r_p, 2.0 * clamp_n[1] * belt.tan_wedge / wraps[1]);
        let in_n = pressed_n + belt.mass_kg_m * v * v - 0.5 * slides * pull_n;
        let strands_n = 2.0 * in_n + pull_n;
        // Work of the pin ends a second: joints that pass, twice a turn against two faces.
        let pitch_m = belt.segment_thickness_m;
        let pin_w = |pulley: usize| {
            let turn = pitch_m / radii.radius_m[pulley];
            let face_n = clamp_n[pulley] / belt.cos_wedge * turn / wraps[pulley];
            2.0 * (v / pitch_m) * turn * (2.0 * load.flank_friction * face_n * chain.pin_m)
        };
        let pins_nm = [pin_w(0) / w, pin_w(1) * ratio / w];
        // The tight strand is longer by what joints and pins of the secondary take.
        let e = chain.joint_m;
        let tight_n = (output_nm + e * strands_n + pins_nm[1]) / r_s;
        let by_moments_nm = tight_n * r_p + e * strands_n + pins_nm[0];
        let rest_nm =
            (row.loss_w[Component::BeltWedge] + row.loss_w[Component::BeltPenetration]) / w;
        let size_nm =
            output_nm.abs() / ratio + row.primary_nm.abs() + by_moments_nm.abs() + rest_nm;
        self.see(
            Law::Statics,
            row,
            (row.primary_nm - by_moments_nm - rest_nm).abs(),
            SOLVED * (size_nm + 1.0),
        );
        let lever_m = e * (1.0 + 1.0 / ratio);
        if lever_m > 1e-9 {
            let apart_n = (row.loss_w[Component::ChainJoint] / w / lever_m - strands_n).abs();
            self.see(
                Law::OneForce,
                row,
                apart_n,
                10.0 * SOLVED * (strands_n + 1.0),
            );
        }
    }

    fn statics(&mut self, belt: &Belt, row: &Row, load: &BeltLoad) {
        if let Some(chain) = &belt.chain {
            return self.chain_statics(belt, chain, row, load);
        }
        let (ratio, w) = (row.belt_ratio, load.primary_speed_rad_s);
        let at = BeltAtRatio::new(belt, ratio);
        let radii = Radii::new(belt, ratio);
        let shear_n = film_n(
            belt,
            &radii,
            &load.band,
            self.car.oil.friction.film_heating_w,
            (1.0 / ratio - 1.0).abs() * w * (1.0 - row.slip), // the film is that of the speed without slip
        );
        let forces = Forces::new(belt, &at, &radii, load, shear_n[0]);
        let turns = (1.0 - 1.0 / ratio) * -forces.direction;
        let [inner_m, outer_m] = [belt.band_offset_m, others_m(belt)];
        let [inner, outer] = load.band.film_share.map(|share| 1.0 - share);
        let boundary_n = load.band.mu * forces.least_rad * forces.mean_n;
        let inner = belt.shoulder_friction * inner;
        let band_nm = turns * boundary_n * (inner * inner_m + outer * outer_m);
        let others = belt.band_thickness_m * (belt.band_count - 1.0);
        let film_nm = turns * (shear_n[0] * inner_m + shear_n[1] * others);
        let rest_nm =
            (row.loss_w[Component::BeltWedge] + row.loss_w[Component::BeltPenetration]) / w;
        let through_nm = load.output_torque_nm / ratio;
        let size_nm = through_nm.abs() + row.primary_nm.abs() + band_nm + film_nm + rest_nm;
        self.see(
            Law::Statics,
            row,
            (row.primary_nm - (through_nm + band_nm + film_nm + rest_nm)).abs(),
            SOLVED * (size_nm + 1.0),
        );
        let state = belt_state(belt, &at, load).tension;
        let mut apart_n: f64 = [
            state.primary_shoulder_n / radii.wrap_rad[0] - forces.mean_n,
            state.secondary_shoulder_n / radii.wrap_rad[1] - forces.mean_n,
            state.step_n - forces.step_n,
            state.compression_n + forces.step_n - load.output_torque_nm / radii.radius_m[1],
        ]
        .iter()
        .map(|n| n.abs())
        .sum();
        // Losses of bands and film, before slip against the torque relieves them (SL-11), over the levers of their forces.
        let lost_nm = [Component::BeltBand, Component::BeltFilm].map(|part| row.loss_w[part] / w);
        let left_nm = lost_nm[0] + lost_nm[1];
        let before_nm = left_nm - smaller(row.slip * through_nm, 0.0);
        let lever_m = turns * (inner_m + outer_m);
        if lever_m.abs() > 1e-6 && left_nm > 1e-2 * before_nm {
            let own_nm = lost_nm.map(|nm| nm * (before_nm / left_nm));
            apart_n += ((own_nm[0] - band_nm) / lever_m).abs();
            apart_n += ((own_nm[1] - film_nm) / lever_m).abs();
        }
        let size_n = forces.mean_n + forces.compression_n.abs();
        self.see(Law::OneForce, row, apart_n, 10.0 * SOLVED * (size_n + 1.0));
    }

    /// PX-3 and PX-4.
    fn engine(&mut self, row: &Row) {
        let e = &self.car.engine;
        let w = row.engine_speed_rad_s;
        let oil = &self.car.engine_oil;
        let at = e.at(
            self.before.node_k[COOLANT],
            self.before.node_k[ENGINE_OIL],
            oil,
            self.car.charge,
        );
        self.running_s = if row.flags.contains(Flags::ENGINE_OFF) {
            0.0
        } else {
            self.running_s + row.dt_s
        };
        let mut held = false;
        if w > 0.0 {
            // The fuel of a start is a mass and not a pressure; it is over when the start is.
            let started = self.running_s > e.start_s + row.dt_s;
            let on_line = [Flags::OUTSIDE_VALIDITY, Flags::OVERSPEED];
            if started && !on_line.iter().any(|flag| row.flags.contains(*flag)) {
                let burnt_w = row.fuel_power_w / at.enrichment;
                let burnt_pa = burnt_w / w * 4.0 * PI / e.displacement_m3;
                self.see(Law::Air, row, 1e-5 * burnt_pa, 1e-5 * self.air_pa);
            }
            let crank_nm = row.engine_torque_nm + (row.accessories_w + row.kinetic_w) / w;
            held = crank_nm >= at.full_load_nm(w) * (1.0 - SOLVED);
            // In overrun nothing is burnt for it: the brakes give what they have (SI-5).
            held |= row.engine_torque_nm < 0.0 && row.brake_w <= ROUNDING * row.wheel_power_w.abs();
        }
        let end = row.engine_end_rad_s;
        let wanted_j = 0.5 * e.inertia_kg_m2 * end * end;
        let Some(before_j) = self.rotating_j else {
            self.rotating_j = (!held).then_some(wanted_j); // what it was before the first row is not in it
            return;
        };
        let now_j = before_j + row.kinetic_w * row.dt_s;
        let lags = held && now_j < wanted_j;
        if !lags {
            let bound_j = ROUNDING * (wanted_j + before_j.abs() + 1.0);
            self.see(Law::Rotation, row, (now_j - wanted_j).abs(), bound_j);
        }
        self.rotating_j = Some(now_j);
    }

    /// PX-5.
    fn second_law(&mut self, row: &Row) {
        let mut worst_w = row.loss_w.iter().fold(0.0, |worst, w| larger(-w, worst));
        let mut size_w = 1.0 + (row.engine_torque_nm * row.engine_speed_rad_s).abs();
        if let Transmission::Cvt(cvt) = &self.car.transmission {
            let secondary_rad_s = secondary_rad_s(self.car, cvt, row);
            let lost_w: f64 = BELT_PARTS.iter().map(|part| row.loss_w[*part].abs()).sum();
            if secondary_rad_s <= 0.0 {
                worst_w = larger(lost_w, worst_w);
            } else if !row.primary_nm.is_nan() {
                let primary_rad_s = row.belt_ratio * secondary_rad_s / (1.0 - row.slip);
                let (from_w, to_w) = (
                    row.primary_nm * primary_rad_s,
                    row.secondary_nm * secondary_rad_s,
                );
                size_w += from_w.abs() + to_w.abs();
                worst_w = larger(to_w - from_w, worst_w);
            }
        }
        self.see(Law::SecondLaw, row, worst_w, ROUNDING * size_w);
    }

    /// PX-7.
    fn heat(&mut self, row: &Row) {
        let belt_k = if row.belt_spray_k.is_nan() {
            self.before.node_k[BELT]
        } else {
            row.belt_spray_k
        };
        let after = [
            row.coolant_k,
            row.engine_oil_k,
            row.sump_k,
            row.metal_k,
            belt_k,
        ];
        let capacity = &self.car.network.capacity_j_k;
        let (mut stored_w, mut heat_j) = (0.0, 0.0);
        for (node, after_k) in after.into_iter().enumerate() {
            stored_w += capacity[node] * (after_k - self.before.node_k[node]) / row.dt_s;
            heat_j += capacity[node] * after_k;
        }
        let lost_w: f64 = row.loss_w.iter().sum();
        let size_w = lost_w + row.engine_heat_w.abs() + row.to_air_w.abs() + stored_w.abs();
        self.see(
            Law::Heat,
            row,
            (lost_w + row.engine_heat_w - row.to_air_w - stored_w).abs(),
            ROUNDING * (size_w + 1.0) + 1e-14 * heat_j / row.dt_s,
        );
        self.before.node_k = after;
    }
}

/// Speed of the secondary by that of the road, rad/s; with a clutch behind it by that of the engine.
fn secondary_rad_s(car: &Car, cvt: &Cvt, row: &Row) -> f64 {
    if cvt.launch_behind {
        return row.engine_speed_rad_s * (1.0 - row.slip) / row.belt_ratio;
    }
    row.range_ratio * cvt.final_drive.ratio * row.speed_m_s / car.road_load.wheel_radius_m
}

/// Fuel mean effective pressure that the air in the cylinders burns, Pa (PX-3). An engine whose warm full-load line burns more is charged: its own
/// line says what it takes in, its indicated torque in proportion to the charge.
fn air_pa(car: &Car) -> f64 {
    let e = &car.engine;
    let plain_pa = VOLUMETRIC * AIR_KG_M3 * e.heating_value_j_kg / STOICHIOMETRIC;
    let warm = e.at(e.hot_k, e.hot_k, &car.engine_oil, 1.0);
    let line_pa = |charge: f64| {
        let speeds = (1..=100).map(|i| e.highest_rad_s * f64::from(i) / 100.0);
        speeds
            .filter(|w| *w >= e.idle_hot_rad_s)
            .map(|w| {
                let friction_nm = e.torque_nm(warm.friction_pa(w));
                let crank_nm = charge * (warm.full_load_nm(w) + friction_nm) - friction_nm;
                warm.burn(w, crank_nm).fuel_w / w * 4.0 * PI / e.displacement_m3
            })
            .fold(0.0, larger)
    };
    // Cold air is warmed on its way in: what is drawn in lies between the charge of EN-5 and the density of the air.
    let charge = larger(car.charge, car.charge * (298.15 / car.ambient_k).sqrt());
    larger(charge * plain_pa, VOLUMETRIC * line_pa(charge))
}

/// Radii and wraps of both pulleys, primary first.
struct Radii {
    radius_m: [f64; 2],
    wrap_rad: [f64; 2],
}

impl Radii {
    /// The secondary radius at which the belt has its length, by bisection: longer with every radius.
    fn new(belt: &Belt, ratio: f64) -> Self {
        let centre = belt.centre_distance_m;
        let run = |secondary: f64| {
            let radius_m = [secondary / ratio, secondary];
            let sin = (radius_m[1] - radius_m[0]) / centre;
            let lean = sin.asin();
            let wrap_rad = [PI - 2.0 * lean, PI + 2.0 * lean];
            let strut_m = centre * (1.0 - sin * sin).sqrt();
            let arcs_m = radius_m[0] * wrap_rad[0] + radius_m[1] * wrap_rad[1];
            (Radii { radius_m, wrap_rad }, arcs_m + 2.0 * strut_m)
        };
        let widest = centre / (1.0 - 1.0 / ratio).abs();
        let (mut low, mut high) = (0.0, smaller(widest, belt.length_m));
        for _ in 0..PASSES {
            let middle = 0.5 * (low + high);
            if run(middle).1 < belt.length_m {
                low = middle;
            } else {
                high = middle;
            }
        }
        run(0.5 * (low + high)).0
    }
}

/// Forces of the belt with one step of tension on both pulleys (PX-2), N.
struct Forces {
    /// Mean tension of the strands.
    mean_n: f64,
    /// Compression of the segments.
    compression_n: f64,
    /// Step of band tension, with its sign.
    step_n: f64,
    /// Direction of the step, -1 in low, +1 in high.
    direction: f64,
    /// Smaller wrap, rad.
    least_rad: f64,
}

impl Forces {
    fn new(belt: &Belt, at: &BeltAtRatio, radii: &Radii, load: &BeltLoad, shear_n: f64) -> Self {
        let v = load.primary_speed_rad_s * radii.radius_m[0];
        let wraps = radii.wrap_rad;
        let thrust = match &belt.thrust_ratio {
            Some(_) => at.thrust_ratio,
            None => wraps[0] / wraps[1],
        };
        let pressed = load.secondary_clamp_n * (thrust / wraps[0] + 1.0 / wraps[1]);
        let bare_n = belt.tan_wedge * pressed + (belt.mass_kg_m - belt.band_mass_kg_m) * v * v;
        let direction = -(ln(at.geometry.ratio) / belt.unity_width).tanh();
        let least_rad = smaller(wraps[0], wraps[1]);
        let shoulder_mu = belt.shoulder_friction * load.band.mu;
        let grip = shoulder_mu * (1.0 - load.band.film_share[0]) * least_rad;
        let net_n = load.output_torque_nm / radii.radius_m[1];
        let mut forces = Forces {
            mean_n: bare_n,
            compression_n: net_n,
            step_n: 0.0,
            direction,
            least_rad,
        };
        for _ in 0..PASSES {
            forces.mean_n = bare_n + 0.5 * forces.compression_n.abs();
            forces.step_n = -direction * (grip * forces.mean_n + shear_n);
            forces.compression_n = net_n - forces.step_n;
        }
        forces
    }
}

/// Thicknesses from the innermost interface to each other one, each times its share of the force of the first, m.
fn others_m(belt: &Belt) -> f64 {
    let count = belt.band_count;
    let shares = (1..count as u32).map(|below| 1.0 - f64::from(below) / count);
    belt.band_thickness_m * shares.sum::<f64>()
}

/// Forces of the films at the innermost interface and at each other one, N, on the pulley of smaller radius, for the difference of the speeds of
/// both shafts: what the heated film bears, F (1 + F dv/P) = F without heating, by bisection.
fn film_n(
    belt: &Belt,
    radii: &Radii,
    band: &BandFriction,
    halving_w: f64,
    apart_rad_s: f64,
) -> [f64; 2] {
    let pulley = usize::from(radii.radius_m[1] < radii.radius_m[0]);
    let area_m2 = belt.band_width_m * radii.radius_m[pulley] * radii.wrap_rad[pulley];
    pair(|i| {
        let cold_n = band.shear_pa[i] * area_m2;
        let dv = apart_rad_s * [belt.band_offset_m, belt.band_thickness_m][i];
        let (mut low, mut high) = (0.0, cold_n);
        for _ in 0..PASSES {
            let middle = 0.5 * (low + high);
            if middle * (1.0 + middle * dv / halving_w) < cold_n {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    })
}
