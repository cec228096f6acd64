//! Keys of belt and pulleys, and a belt from their values.

use super::{Belt, Chain, ChainKeys, Formulation};
use crate::keys::{Bound, Choice, Key, Values, curve, keys};
use crate::math::{cos, ln, tan};

/// Condition of the keys of bands and segments.
const OF_BELT: &str = "with a pushing belt";

keys! {
    /// Keys of `[transmission.cvt.belt]`.
    BELT: BeltKeys = "belt" [] {
        kind: or_word("push_belt", options(&[
            Choice::word("push_belt", "segments between bands, in compression"),
            Choice::new("chain", "plates with rocker joints, in tension: keys of bands and segments are not read", ChainKeys::TABLE),
        ])), "what runs between the pulleys", ["KC-3"];
        length_m: number(0.2, 2.0), "length of the belt";
        thrust_ratio: optional(rows(&[("ratio", Bound::closed(0.2, 5.0)), ("thrust_ratio", Bound::closed(0.2, 5.0))])), "rows [belt ratio, F_p/F_s]; replaces the wrap ratio", ["TE-1"];
        segment_thickness_mm: required_if(OF_BELT, number(0.5, 5.0)), "thickness of a segment", ["SL-4"];
        band_count: integer(1, 40, 12), "bands in a pack", ["BT-2"];
        band_thickness_mm: required_if(OF_BELT, number(0.05, 1.0)), "thickness of a band", ["BT-1"];
        band_width_mm: required_if(OF_BELT, number(1.0, 100.0)), "width of both band packs", ["SL-1", "FI-1"];
        band_offset_mm: required_if(OF_BELT, number(0.0, 20.0)), "offset of band 1 above the rocking edge", ["BT-1"];
        shoulder_friction_factor: or(1.0, number(0.05, 2.0)), "friction between shoulders and innermost band over that between bands: a coating", ["BT-8"];
        mass_kg: number(0.1, 10.0), "mass of the belt", ["TE-2"];
        bands_carry_themselves: flag(true), "whether the bands carry their own mass, so that the segments alone press on them", ["TE-8"];
        youngs_gpa: required_if(OF_BELT, number(50.0, 500.0)), "Young's modulus of bands and segments", ["SL-1"];
        strut_area_mm2: required_if(OF_BELT, number(0.5, 200.0)), "contact area of segments in the free strut", ["SL-2"];
        initial_gap_mm: or(0.0, number(0.0, 100.0)), "sum of the gaps at no load", ["SL-5"];
        unity_width: or(0.015, number(1e-4, 0.2)), "smoothing of the tension step at I = 1, in ln I", ["TE-6"];
        blend_n: or(120.0, number(1.0, 2000.0)), "blend between loading branches at C_x = 0", ["SL-8"];
        // Both pulleys together must leave the belt some grip: at 100 % the engine's speed would have no bound.
        slip_bound_percent: or(10.0, number(1.0, 40.0)), "bound of each pulley's slip", ["SL-9"];
    }

    /// Keys of `[transmission.cvt.variator]`.
    VARIATOR: VariatorKeys = "variator" [] {
        half_wedge_deg: number(4.0, 25.0), "half wedge angle of the pulleys";
        centre_distance_mm: number(60.0, 400.0), "centre distance of the pulleys", ["GE-2"];
        primary_stiffness_n: number(1e5, 1e12), "primary: deflection = R F over this", ["WE-1"];
        secondary_stiffness_n: number(1e5, 1e12), "secondary: deflection = R F over this", ["WE-1"];
        stop_from_ratio: number(0.3, 5.0), "ratio from which the primary leans on its end stop", ["WE-4"];
        stop_to_ratio: number(0.3, 5.0), "ratio at which it rests on it", ["WE-4"];
        secondary_piston_cm2: number(5.0, 1000.0), "secondary piston area", ["VA-3"];
        primary_piston_cm2: number(5.0, 2000.0), "primary piston area; sets primary pressure and up-shift flow only";
        spring_n: number(0.0, 10_000.0), "spring force on the secondary", ["VA-3"];
        compensated: flag(true), "centrifugal oil head balanced", ["VA-3"];
        piston_outer_mm: or(63.0, number(0.0, 300.0)), "outer radius of the secondary's oil chamber", ["VA-3"];
        piston_inner_mm: or(30.0, number(0.0, 300.0)), "inner radius of the secondary's oil chamber", ["VA-3"];
    }
}

/// Density of steel.
const STEEL_KG_M3: f64 = 7800.0;

impl Belt {
    /// A belt from the values of `[belt]` and `[variator]`.
    pub fn from_values<V: Values>(belt: &V, variator: &V, formulation: Formulation) -> Self {
        let wedge = variator.number(&VARIATOR.half_wedge_deg);
        let length_m = belt.number(&BELT.length_m);
        let thrust = belt.rows(&BELT.thrust_ratio).unwrap_or_default();
        let logs: Vec<Vec<f64>> = thrust.iter().map(|r| vec![ln(r[0]), r[1]]).collect();
        let mass_kg = belt.number(&BELT.mass_kg);
        let (kind, option) = belt.choose(&BELT.kind);
        let (chain, pitch_m) = match kind {
            "chain" => Some(Chain::from_values(&option)).unzip(),
            _ => (None, None),
        };
        // Values of bands and segments; in a chain they act on nothing.
        let or_none = |key: &Key<'static>, none: f64| match chain {
            Some(_) => none,
            None => belt.number(key),
        };
        let made = Belt {
            centre_distance_m: variator.number(&VARIATOR.centre_distance_mm),
            length_m,
            segment_thickness_m: pitch_m.unwrap_or_else(|| belt.number(&BELT.segment_thickness_mm)),
            cos_wedge: cos(wedge),
            tan_wedge: tan(wedge),
            band_count: match chain {
                Some(_) => 0.0,
                None => belt.integer(&BELT.band_count) as f64,
            },
            band_thickness_m: or_none(&BELT.band_thickness_mm, 0.0),
            band_width_m: or_none(&BELT.band_width_mm, 0.0),
            band_offset_m: or_none(&BELT.band_offset_mm, 0.0),
            shoulder_friction: match chain {
                Some(_) => 1.0,
                None => belt.number(&BELT.shoulder_friction_factor),
            },
            mass_kg_m: mass_kg / length_m,
            band_mass_kg_m: 0.0,
            youngs_pa: or_none(&BELT.youngs_gpa, 1.0),
            strut_area_m2: or_none(&BELT.strut_area_mm2, 1.0),
            initial_gap_m: or_none(&BELT.initial_gap_mm, 0.0),
            primary_compliance_per_n: 1.0 / variator.number(&VARIATOR.primary_stiffness_n),
            secondary_compliance_per_n: 1.0 / variator.number(&VARIATOR.secondary_stiffness_n),
            stop_from_ratio: variator.number(&VARIATOR.stop_from_ratio),
            stop_to_ratio: variator.number(&VARIATOR.stop_to_ratio),
            unity_width: or_none(&BELT.unity_width, 1.0),
            blend_n: or_none(&BELT.blend_n, 1.0),
            slip_bound: belt.number(&BELT.slip_bound_percent),
            thrust_ratio: (!logs.is_empty()).then(|| curve(belt, &BELT.thrust_ratio, &logs)),
            chain,
            formulation,
        };
        if made.stop_from_ratio > made.stop_to_ratio {
            variator.complain(
                "stop_to_ratio",
                "below `stop_from_ratio`",
                "the primary rests on its stop at the larger ratio",
                "low lies above ratio 1; equal ratios make the stop a step",
            );
        }
        if chain.is_some() && !formulation.by_statics() {
            belt.complain(
                "kind",
                "push_belt",
                "the printed belt model has no chain",
                "take the belt model `smooth`",
            );
        }
        let is_coated = (made.shoulder_friction - 1.0).abs() > 0.0;
        if is_coated && !formulation.by_statics() {
            belt.complain(
                "shoulder_friction_factor",
                "1",
                "the printed belt model has one friction for all bands",
                "leave it out, or take the belt model `smooth`",
            );
        }
        made.with_band_mass(belt, mass_kg)
    }

    /// The belt with the mass of its bands, which are of steel, where they carry themselves.
    fn with_band_mass<V: Values>(self, belt: &V, mass_kg: f64) -> Self {
        if self.chain.is_some() || !belt.flag(&BELT.bands_carry_themselves) {
            return self;
        }
        let steel_kg = STEEL_KG_M3 * self.band_area_m2() * self.length_m;
        if steel_kg >= mass_kg {
            belt.complain(
                "mass_kg",
                &format!("above {steel_kg:.3}, the mass of the bands"),
                "the bands alone are heavier than the belt",
                "check number, width and thickness of the bands",
            );
        }
        Belt {
            band_mass_kg_m: steel_kg / self.length_m,
            ..self
        }
    }
}
