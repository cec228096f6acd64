//! Reads the `[transmission.cvt]` table of a vehicle file.

use super::{film_heating, launch};
use crate::setup::{Files, tables};
use crate::{Bound, Section};
use cvtcycle_model::engine::Engine;
use cvtcycle_model::fluid::Lubricant;
use cvtcycle_model::transmission::cvt::controller::{ClampLaw, MapLaw, RatioControl};
use cvtcycle_model::transmission::cvt::pump::{Pump, PumpKind};
use cvtcycle_model::transmission::cvt::spin::Spin;
use cvtcycle_model::transmission::cvt::variator::{Belt, Formulation, Geometry};
use cvtcycle_model::transmission::cvt::{Cvt, CvtMaps};

/// Reads a checked CVT; problems go to the reader.
#[must_use]
pub fn load(
    s: &Section,
    files: &dyn Files,
    engine: &Engine,
    oil: &Lubricant,
    formulation: Formulation,
) -> Cvt {
    let v = s.table("variator");
    let full_load_route = engine.speed_for_power();
    // The route ends at the greatest power.
    let fastest_rad_s = full_load_route
        .points()
        .last()
        .map_or(engine.highest_rad_s, |p| p.1);
    let ratio = ratio_control(&s.table("ratio"), fastest_rad_s);
    let belt = belt(&s.table("belt"), &v, formulation);
    let low = Geometry::new(ratio.low, belt.centre_distance_m, belt.length_m);
    check_reach(s, &ratio, &belt, &low);
    let clamp_table = s.table("pressure");
    let clamp = clamp_law(s);
    let bar = Bound::closed(0.0, 200.0);
    let radius_exponent = s.table("pressure").number_or(
        "radius_exponent",
        Bound::closed(0.0, 4.0),
        1.43,
        "exponent of primary radius in the clamp map (PC-1)",
    );
    let cap_pa = clamp_table.number(
        "cap_bar",
        Bound::closed(1.0, 200.0),
        "largest secondary pressure",
    );
    let floor_pa = clamp_table.number("floor_bar", bar, "smallest secondary pressure");
    if floor_pa > cap_pa {
        clamp_table.complain(
            "floor_bar",
            "at most cap_bar",
            "the smallest pressure is above the largest",
            "lower floor_bar or raise cap_bar",
        );
    }
    Cvt {
        final_drive: s.number(
            "final_drive_ratio",
            Bound::closed(1.0, 20.0),
            "secondary speed over wheel speed (CV-1)",
        ),
        secondary_piston_m2: v.number(
            "secondary_piston_cm2",
            Bound::closed(5.0, 1000.0),
            "secondary piston area (VA-3)",
        ),
        primary_piston_m2: v.number(
            "primary_piston_cm2",
            Bound::closed(5.0, 2000.0),
            "primary piston area; sets primary pressure and up-shift flow only",
        ),
        spring_n: v.number(
            "spring_n",
            Bound::closed(0.0, 10_000.0),
            "spring force on the secondary (VA-3)",
        ),
        centrifugal_n_s2: centrifugal(&v, oil),
        pump: pump(s),
        spin: spin(s),
        ratio,
        clamp,
        radius_exponent,
        floor_pa,
        cap_pa,
        low_radius_m: low.primary_radius_m,
        launch: launch::load(s, 5.0),
        full_load_route,
        maps: maps(&s.table("maps"), files),
        belt_heat_share: s.number_or(
            "belt_heat_share",
            Bound::closed(0.0, 1.0),
            0.7,
            "share of belt loss that heats belt and pulleys (SI-3)",
        ),
        belt,
    }
}

/// The belt runs at both ends of the ratio, and the pulleys do not run into each other.
fn check_reach(s: &Section, ratio: &RatioControl, belt: &Belt, low: &Geometry) {
    let read = [ratio.low, ratio.high, belt.centre_distance_m, belt.length_m]
        .iter()
        .all(|x| x.is_finite());
    let high = Geometry::new(ratio.high, belt.centre_distance_m, belt.length_m);
    let fits = |g: &Geometry| {
        let (primary, secondary) = (g.primary_radius_m, g.secondary_radius_m);
        primary > 0.005
            && secondary > 0.005
            && primary + secondary <= belt.centre_distance_m
            && g.strut_m > 0.0
    };
    let ends = [("low", fits(low)), ("high", fits(&high))];
    if let Some((end, _)) = ends.iter().find(|(_, fits)| read && !fits) {
        s.table("ratio").complain(
            end,
            "",
            "the belt cannot reach this ratio",
            "check belt length and centre distance against the ratio limits",
        );
    }
}

fn centrifugal(v: &Section, oil: &Lubricant) -> f64 {
    let compensated = v.boolean_or("compensated", true, "centrifugal oil head balanced (VA-3)");
    let length = Bound::closed(0.0, 300.0);
    let outer = v.number_or(
        "piston_outer_mm",
        length,
        63.0,
        "outer radius of the secondary's oil chamber (VA-3)",
    );
    let inner = v.number_or(
        "piston_inner_mm",
        length,
        30.0,
        "inner radius of the secondary's oil chamber (VA-3)",
    );
    if compensated {
        return 0.0;
    }
    if outer < inner {
        v.complain(
            "piston_inner_mm",
            "at most piston_outer_mm",
            "the oil chamber's inner radius is above its outer one",
            "give both as radii, the smaller one here",
        );
    }
    std::f64::consts::PI * oil.density_kg_m3(353.15) * (outer.powi(4) - inner.powi(4)) / 4.0 // VA-3
}

fn ratio_control(s: &Section, highest_rad_s: f64) -> RatioControl {
    let ratio = Bound::closed(0.3, 3.3);
    let rpm = Bound::closed(500.0, 10_000.0);
    let rate = Bound::open_low(0.0, 20.0);
    let control = RatioControl {
        low: s.number("low", ratio, "belt ratio of the lowest gear"),
        high: s.number("high", ratio, "belt ratio of the highest gear"),
        gentle_rad_s: s.number("gentle_rpm", rpm, "engine speed in gentle driving (RC-1)"),
        gentle_share: s.number(
            "gentle_power_share",
            Bound::closed(0.0, 1.0),
            "share of rated power up to which driving is gentle (RC-1)",
        ),
        rise_rad_s: s.number(
            "rise_rpm",
            Bound::closed(0.0, 20_000.0),
            "rise of engine speed over the share of rated power above it (RC-1)",
        ),
        overrun_rad_s: s.number("overrun_rpm", rpm, "engine speed in overrun (RC-2)"),
        highest_rad_s,
        route_efficiency: s.number_or(
            "route_efficiency",
            Bound::closed(0.3, 1.0),
            0.85,
            "wheel power over engine power on the full-load route (RC-3)",
        ),
        up_per_s: s.number("up_per_s", rate, "rate of ln I towards high (RC-4)"),
        down_per_s: s.number("down_per_s", rate, "rate of ln I towards low (RC-4)"),
        rate_speed_rad_s: s.number(
            "rate_speed_rpm",
            rpm,
            "primary speed from which the full rates hold (RC-4)",
        ),
    };
    if control.low <= control.high {
        s.complain(
            "low",
            "above `high`",
            "low must be the larger belt ratio",
            "I = R_sec / R_pri: above 1 is low, below 1 is high",
        );
    }
    control
}

fn belt(s: &Section, v: &Section, formulation: Formulation) -> Belt {
    let th = v.number(
        "half_wedge_deg",
        Bound::closed(4.0, 25.0),
        "half wedge angle of the pulleys",
    );
    let length_m = s.number("length_m", Bound::closed(0.2, 2.0), "length of the belt");
    let columns = [
        ("ratio", Bound::closed(0.2, 5.0)),
        ("thrust_ratio", Bound::closed(0.2, 5.0)),
    ];
    let thrust = s.rows(
        "thrust_ratio",
        &columns,
        "rows [belt ratio, F_p/F_s]; replaces the wrap ratio (TE-1)",
    );
    let logs: Vec<Vec<f64>> = thrust.iter().map(|r| vec![r[0].ln(), r[1]]).collect();
    let belt = Belt {
        centre_distance_m: v.number(
            "centre_distance_mm",
            Bound::closed(60.0, 400.0),
            "centre distance of the pulleys (GE-2)",
        ),
        length_m,
        segment_thickness_m: s.number(
            "segment_thickness_mm",
            Bound::closed(0.5, 5.0),
            "thickness of a segment (SL-4)",
        ),
        cos_wedge: th.cos(),
        tan_wedge: th.tan(),
        band_count: s.integer_or("band_count", 1..=40, 12, "bands in a pack (BT-2)") as f64,
        band_thickness_m: s.number(
            "band_thickness_mm",
            Bound::closed(0.05, 1.0),
            "thickness of a band (BT-1)",
        ),
        band_width_m: s.number(
            "band_width_mm",
            Bound::closed(1.0, 100.0),
            "width of both band packs (SL-1, FI-1)",
        ),
        band_offset_m: s.number(
            "band_offset_mm",
            Bound::closed(0.0, 20.0),
            "offset of band 1 above the rocking edge (BT-1)",
        ),
        mass_kg_m: s.number(
            "mass_kg",
            Bound::closed(0.1, 10.0),
            "mass of the belt (TE-2)",
        ) / length_m,
        youngs_pa: s.number(
            "youngs_gpa",
            Bound::closed(50.0, 500.0),
            "Young's modulus of bands and segments (SL-1)",
        ),
        strut_area_m2: s.number(
            "strut_area_mm2",
            Bound::closed(0.5, 200.0),
            "contact area of segments in the free strut (SL-2)",
        ),
        initial_gap_m: s.number_or(
            "initial_gap_mm",
            Bound::closed(0.0, 100.0),
            0.0,
            "sum of the gaps at no load (SL-5)",
        ),
        primary_compliance_per_n: 1.0
            / v.number(
                "primary_stiffness_n",
                Bound::closed(1e5, 1e12),
                "primary: deflection = R F over this (WE-1)",
            ),
        secondary_compliance_per_n: 1.0
            / v.number(
                "secondary_stiffness_n",
                Bound::closed(1e5, 1e12),
                "secondary: deflection = R F over this (WE-1)",
            ),
        stop_from_ratio: v.number(
            "stop_from_ratio",
            Bound::closed(0.3, 5.0),
            "ratio from which the primary leans on its end stop (WE-4)",
        ),
        stop_to_ratio: v.number(
            "stop_to_ratio",
            Bound::closed(0.3, 5.0),
            "ratio at which it rests on it (WE-4)",
        ),
        unity_width: s.number_or(
            "unity_width",
            Bound::closed(1e-4, 0.2),
            0.015,
            "smoothing of the tension step at I = 1, in ln I (TE-6)",
        ),
        blend_n: s.number_or(
            "blend_n",
            Bound::closed(1.0, 2000.0),
            120.0,
            "blend between loading branches at C_x = 0 (SL-8)",
        ),
        // Both pulleys together must leave the belt some grip: at 100 % the engine's speed would have no bound.
        slip_bound: s.number_or(
            "slip_bound_percent",
            Bound::closed(1.0, 40.0),
            10.0,
            "bound of each pulley's slip (SL-9)",
        ),
        thrust_ratio: (!logs.is_empty()).then(|| tables::curve(s, "thrust_ratio", &logs)),
        formulation,
    };
    if belt.stop_from_ratio > belt.stop_to_ratio {
        v.complain(
            "stop_to_ratio",
            "below `stop_from_ratio`",
            "the primary rests on its stop at the larger ratio",
            "low lies above ratio 1; equal ratios make the stop a step",
        );
    }
    belt
}

fn pump(s: &Section) -> Pump {
    let p = s.table("pump");
    let (kind, k) = p.choose(
        "kind",
        &["fixed", "dual_cavity", "variable"],
        Some("fixed"),
        "fixed, dual_cavity or variable displacement (PU-4)",
    );
    let share = Bound::closed(0.05, 1.0);
    let kind = match kind {
        "dual_cavity" => PumpKind::DualCavity {
            share: k.number_or(
                "share",
                share,
                0.5,
                "share of displacement in the cavity that always works (PU-4)",
            ),
        },
        "variable" => PumpKind::Variable {
            least: k.number_or(
                "least_share",
                share,
                0.25,
                "smallest share of the displacement (PU-4)",
            ),
        },
        _ => PumpKind::Fixed,
    };
    let bar = Bound::closed(0.0, 50.0);
    Pump {
        kind,
        displacement_m3_rad: p.number(
            "displacement_cc_rev",
            Bound::closed(0.5, 100.0),
            "displacement (PU-1)",
        ),
        friction: p.number_or(
            "friction_coefficient",
            Bound::closed(0.0, 1.0),
            0.0,
            "Coulomb coefficient C_f (PU-1)",
        ),
        viscous: p.number(
            "viscous_coefficient",
            Bound::closed(0.0, 1e6),
            "viscous coefficient C_v (PU-1)",
        ),
        viscous_exponent: p.number(
            "viscous_exponent",
            Bound::closed(0.0, 1.5),
            "exponent of viscosity (PU-1)",
        ),
        heating: film_heating::load(
            &p,
            "viscous dissipation at which the heat of the gaps halves the viscous torque; absent: no heating (PU-1, FH-1)",
        ),
        inlet_pa_s_m3: p
            .optional_number(
                "inlet_bar_per_l_min",
                Bound::closed(0.0, 1.0),
                "drop in strainer and suction line at 10 mPa s; absent: none (PU-5)",
            )
            .unwrap_or(0.0),
        constant_nm: p.number_or(
            "constant_nm",
            Bound::closed(0.0, 10.0),
            0.0,
            "constant torque T_c (PU-1)",
        ),
        line_drop_pa: p.number_or(
            "line_drop_bar",
            bar,
            0.0,
            "pressure drop between pump and secondary (PU-1)",
        ),
        residual_pa: p.number_or(
            "residual_bar",
            bar,
            1.0,
            "pressure against which idle displacement turns (PU-4)",
        ),
        lubrication_m3_s: p.number_or(
            "lubrication_l_min",
            Bound::closed(0.0, 50.0),
            3.0,
            "lubrication flow (PU-2)",
        ),
        leakage_m3_s_pa: p.number_or(
            "leakage_l_min_per_bar",
            Bound::closed(0.0, 2.0),
            0.1,
            "leakage at 10 mPa s (PU-2)",
        ),
    }
}

fn spin(s: &Section) -> Spin {
    let (shaft, clutch, drive) = (
        s.table("input_shaft"),
        s.table("reverse_clutch"),
        s.table("final_drive"),
    );
    let nm = Bound::closed(0.0, 20.0);
    let exponent = Bound::closed(0.0, 1.5);
    Spin {
        shaft_constant_nm: shaft.number("constant_nm", nm, "torque at rest (IS-1)"),
        shaft_viscous_nm_s: shaft.number(
            "viscous_nm_per_rpm",
            Bound::closed(0.0, 0.01),
            "slope at 11 mm2/s (IS-1)",
        ),
        shaft_exponent: shaft.number("viscous_exponent", exponent, "exponent of viscosity (IS-1)"),
        shaft_heating: film_heating::load(
            &shaft,
            "viscous dissipation at which the heat of the films halves it; absent: no heating (IS-1, FH-1)",
        ),
        clutch_nm: clutch.number("drag_nm", nm, "drag at 11 mm2/s (CD-1)"),
        clutch_exponent: clutch.number(
            "viscous_exponent",
            exponent,
            "exponent of viscosity (CD-1)",
        ),
        clutch_cap_nm: clutch.number("cap_nm", nm, "largest drag (CD-1)"),
        drive_boundary_nm: drive.number(
            "boundary_nm",
            nm,
            "part that falls with speed, at the secondary (FD-1)",
        ),
        drive_scale_rad_s: drive.number(
            "boundary_rpm",
            Bound::closed(10.0, 20_000.0),
            "its speed scale (FD-1)",
        ),
        drive_viscous_nm: drive.number("viscous_nm", nm, "viscous part at 11 mm2/s (FD-1)"),
        drive_exponent: drive.number("viscous_exponent", exponent, "exponent of viscosity (FD-1)"),
        drive_heating: film_heating::load(
            &drive,
            "viscous dissipation at which the heat of the films halves it; absent: no heating (FD-1, FH-1)",
        ),
        mesh_efficiency: drive.number(
            "mesh_efficiency",
            Bound::closed(0.8, 1.0),
            "efficiency of the meshes (FD-2)",
        ),
    }
}

fn clamp_law(s: &Section) -> ClampLaw {
    let (law, c) = s.choose(
        "clamp",
        &["map", "torque_following", "slip_limited"],
        Some("map"),
        "clamp law: the Rover's map, torque following, or slip limited",
    );
    let safety = Bound::closed(0.5, 10.0);
    let torque = Bound::closed(0.0, 500.0);
    let bar = Bound::closed(0.0, 200.0);
    let rpm = Bound::closed(0.0, 10_000.0);
    match law {
        "torque_following" => ClampLaw::TorqueFollowing {
            safety: c.number_or("safety_factor", safety, 1.3, "capacity over torque (PC-3)"),
            least_torque_nm: c.number_or(
                "least_torque_nm",
                torque,
                20.0,
                "smallest torque clamped for (PC-3)",
            ),
        },
        "slip_limited" => ClampLaw::SlipLimited {
            slip: c.number_or(
                "slip_percent",
                Bound::closed(0.1, 10.0),
                2.0,
                "largest slip (PC-4)",
            ),
            safety: c.number_or(
                "safety_factor",
                safety,
                1.05,
                "smallest capacity over torque (PC-4)",
            ),
            least_torque_nm: c.number_or(
                "least_torque_nm",
                torque,
                20.0,
                "smallest torque clamped for (PC-4)",
            ),
        },
        _ => ClampLaw::Map(MapLaw {
            base_pa: c.number("base_bar", bar, "pressure in low at closed throttle (PC-1)"),
            throttle_pa: c.number("throttle_bar", bar, "rise to full throttle (PC-1)"),
            cold_per_k: c.number(
                "cold_per_k",
                Bound::closed(0.0, 0.02),
                "rise per kelvin below 80 degC (PC-1)",
            ),
            slow_factor: c.number(
                "slow_factor",
                Bound::closed(0.05, 1.5),
                "factor at the slow speed (PC-2)",
            ),
            slow_rad_s: c.number("slow_rpm", rpm, "slow speed (PC-2)"),
            full_rad_s: c.number("full_rpm", rpm, "speed at which the factor is 1 (PC-2)"),
            fall_s: c.number_or(
                "fall_per_1000_rpm",
                Bound::closed(0.0, 0.2),
                0.0,
                "fall of the factor per 1000 rpm above full_rpm (PC-2)",
            ),
        }),
    }
}

fn maps(s: &Section, files: &dyn Files) -> CvtMaps {
    macro_rules! doc {
        ($what:literal) => {
            concat!(
                "CSV of measured torque loss at the primary that replaces the ",
                $what
            )
        };
    }
    let one = |key: &str, doc: &str| tables::loss_map(s, key, doc, files, "ratio");
    CvtMaps {
        belt: one("belt", doc!("belt model")),
        pump: one("pump", doc!("pump model")),
        input_shaft: one("input_shaft", doc!("input shaft model")),
        clutch_drag: one("clutch_drag", doc!("reverse-clutch drag")),
        final_drive: one("final_drive", doc!("final drive model")),
    }
}
