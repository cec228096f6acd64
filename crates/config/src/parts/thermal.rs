//! Reads the `[thermal]` table of a vehicle file.

use crate::{Bound, Section};
use cvtcycle_model::fluid::{Lubricant, ZERO_DEGC_K};
use cvtcycle_model::thermal::{Cooler, Network};

/// Temperature at which the oil's heat capacity is taken, K.
const OIL_REFERENCE_K: f64 = 40.0 + ZERO_DEGC_K;

/// Reads a checked network; `cvt` says whether there is a belt node.
#[must_use]
pub fn load(s: &Section, cvt: bool, oil: &Lubricant) -> Network {
    let kj = Bound::closed(0.1, 1000.0);
    let w_k = Bound::closed(0.0, 5000.0);
    let engine = s.table("engine");
    let radiator = s.table("radiator");
    let gearbox = s.table("transmission");
    let volume = gearbox.number("oil_l", Bound::closed(0.2, 30.0), "oil in the sump");
    let oil_j_k =
        volume * oil.density_kg_m3(OIL_REFERENCE_K) * oil.heat_capacity_j_kgk(OIL_REFERENCE_K);
    let block = engine.number(
        "block_kj_k",
        kj,
        "heat capacity of coolant, block and head (TH-1)",
    );
    let engine_oil = engine.number(
        "oil_kj_k",
        kj,
        "heat capacity of engine oil, pan and crank train (TH-1)",
    );
    let metal = gearbox.number(
        "metal_kj_k",
        kj,
        "heat capacity of case, gears and shafts (TH-1)",
    );
    let belt = if cvt {
        gearbox.number("belt_kj_k", kj, "heat capacity of belt and pulleys (TH-1)")
    } else {
        0.0
    };
    Network {
        capacity_j_k: [block, engine_oil, oil_j_k, metal, belt],
        coolant_oil_w_k: engine.number("coolant_oil_w_k", w_k, "coolant to engine oil (TH-1)"),
        block_air_w_k: engine.number("block_air_w_k", w_k, "block to air at standstill (TH-1)"),
        block_air_per_speed: engine.number(
            "block_air_w_k_per_m_s",
            w_k,
            "block to air over road speed (TH-1)",
        ),
        pan_air_w_k: engine.number("pan_air_w_k", w_k, "oil pan to air at standstill (TH-1)"),
        pan_air_per_speed: engine.number(
            "pan_air_w_k_per_m_s",
            w_k,
            "oil pan to air over road speed (TH-1)",
        ),
        radiator_w_k: radiator.number(
            "fan_w_k",
            w_k,
            "radiator fully open at standstill, fan (TH-2)",
        ),
        radiator_per_speed: radiator.number(
            "ram_w_k_per_m_s",
            w_k,
            "radiator over road speed (TH-2)",
        ),
        thermostat_from_k: radiator.number(
            "thermostat_from_degc",
            Bound::closed(40.0, 120.0),
            "thermostat begins to open (TH-2)",
        ),
        thermostat_to_k: thermostat_to(&radiator),
        oil_metal_w_k: gearbox.number("oil_metal_w_k", w_k, "oil to metal (TH-1)"),
        case_air_w_k: gearbox.number("case_air_w_k", w_k, "case to air at standstill (TH-1)"),
        case_air_per_speed: gearbox.number(
            "case_air_v07_w_k",
            w_k,
            "case to air, times v^0.7 in m/s (TH-1)",
        ),
        bell_housing_w_k: gearbox.number(
            "bell_housing_w_k",
            w_k,
            "block to case through the bell housing (TH-1)",
        ),
        spray_w_k: if cvt {
            gearbox.number(
                "spray_w_k",
                w_k,
                "belt and pulleys to the sump by spray, pump at 2500 rpm (TH-8)",
            )
        } else {
            0.0
        },
        exchanger_w_k: gearbox.number_or(
            "exchanger_w_k",
            w_k,
            0.0,
            "coolant to transmission oil heat exchanger (TH-1)",
        ),
        exchanger_opens_k: gearbox.number_or(
            "exchanger_opens_degc",
            Bound::closed(-60.0, 120.0),
            70.0,
            "coolant temperature from which the exchanger's valve opens (TH-7)",
        ),
        cooler: cooler(&s.table("cooler")),
        under_bonnet: s.number_or(
            "under_bonnet_rise",
            Bound::closed(0.0, 0.8),
            0.0,
            "under-bonnet air: share of coolant over ambient (TH-4)",
        ),
    }
}

fn thermostat_to(s: &Section) -> f64 {
    let to = s.number(
        "thermostat_to_degc",
        Bound::closed(41.0, 130.0),
        "thermostat fully open (TH-2)",
    );
    let from = s.number(
        "thermostat_from_degc",
        Bound::closed(40.0, 120.0),
        "thermostat begins to open (TH-2)",
    );
    if to <= from {
        s.complain(
            "thermostat_to_degc",
            "above thermostat_from_degc",
            "the thermostat closes as it warms",
            "give a temperature above thermostat_from_degc",
        );
    }
    to
}

fn cooler(s: &Section) -> Option<Cooler> {
    let fitted = s.boolean_or(
        "fitted",
        false,
        "whether there is an oil-to-air cooler (TH-3)",
    );
    let w_k = Bound::closed(0.0, 2000.0);
    let cooler = Cooler {
        still_w_k: s.number_or("still_w_k", w_k, 3.0, "U A at standstill (TH-3)"),
        per_speed_w_s_k_m: s.number_or("ram_w_k_per_m_s", w_k, 2.0, "U A over road speed (TH-3)"),
        flow_share: s.number_or(
            "flow_share",
            Bound::closed(0.0, 1.0),
            0.5,
            "share of the pump's flow through the cooler (TH-3)",
        ),
        highest_m3_s: s.number_or(
            "highest_l_min",
            Bound::closed(0.1, 100.0),
            20.0,
            "largest flow through the cooler (TH-3)",
        ),
        bypass_below_k: s.number_or(
            "bypass_below_degc",
            Bound::closed(-60.0, 200.0),
            -60.0,
            "sump temperature below which the cooler is bypassed (TH-3)",
        ),
    };
    let bypassed = s.boolean_or("bypassed", false, "cooler always bypassed");
    (fitted && !bypassed).then_some(cooler)
}
