//! Keys of `[thermal]`, and a thermal network from their values.

use super::{Cooler, Network};
use crate::keys::{Values, keys};
use crate::lubricant::{Lubricant, ZERO_DEGC_K};

keys! {
    /// Keys of `[thermal]` and its tables.
    THERMAL: ThermalKeys = "thermal" [EngineKeys::TABLE, RadiatorKeys::TABLE, GearboxKeys::TABLE, CoolerKeys::TABLE] {
        under_bonnet_rise: or(0.0, number(0.0, 0.8)), "under-bonnet air: share of coolant over ambient", ["TH-4"];
    }

    /// Keys of `[thermal.engine]`.
    ENGINE: EngineKeys = "engine" [] {
        block_kj_k: number(0.1, 1000.0), "heat capacity of coolant, block and head", ["TH-1"];
        oil_kj_k: number(0.1, 1000.0), "heat capacity of engine oil, pan and crank train", ["TH-1"];
        coolant_oil_w_k: number(0.0, 5000.0), "coolant to engine oil", ["TH-1"];
        block_air_w_k: number(0.0, 5000.0), "block to air at standstill", ["TH-1"];
        block_air_w_k_per_m_s: number(0.0, 5000.0), "block to air over road speed", ["TH-1"];
        pan_air_w_k: number(0.0, 5000.0), "oil pan to air at standstill", ["TH-1"];
        pan_air_w_k_per_m_s: number(0.0, 5000.0), "oil pan to air over road speed", ["TH-1"];
    }

    /// Keys of `[thermal.radiator]`.
    RADIATOR: RadiatorKeys = "radiator" [] {
        fan_w_k: number(0.0, 5000.0), "radiator fully open at standstill, fan", ["TH-2"];
        ram_w_k_per_m_s: number(0.0, 5000.0), "radiator over road speed", ["TH-2"];
        thermostat_from_degc: number(40.0, 120.0), "thermostat begins to open", ["TH-2"];
        thermostat_to_degc: number(41.0, 130.0), "thermostat fully open", ["TH-2"];
    }

    /// Keys of `[thermal.transmission]`.
    GEARBOX: GearboxKeys = "transmission" [] {
        oil_l: number(0.2, 30.0), "oil in the sump", ["CH-1", "TH-1"];
        metal_kj_k: number(0.1, 1000.0), "heat capacity of case, gears, shafts and sheaves", ["TH-1"];
        belt_kj_k: required_if("with a CVT", number(0.1, 1000.0)), "heat capacity of belt and the skin of the sheaves", ["TH-1"];
        oil_metal_w_k: number(0.0, 5000.0), "oil to metal", ["TH-1"];
        case_air_w_k: number(0.0, 5000.0), "case to air at standstill", ["TH-1"];
        case_air_v07_w_k: number(0.0, 5000.0), "case to air, times v^0.7 in m/s", ["TH-1"];
        bell_housing_w_k: number(0.0, 5000.0), "block to case through the bell housing", ["TH-1"];
        spray_w_k: required_if("with a CVT", number(0.0, 5000.0)), "belt and pulleys to the sump by spray, pump at 2500 rpm", ["TH-8"];
        exchanger_w_k: or(0.0, number(0.0, 5000.0)), "coolant to transmission oil heat exchanger", ["TH-1"];
        exchanger_opens_degc: or(70.0, number(-60.0, 120.0)), "coolant temperature from which the exchanger's valve opens", ["TH-7"];
    }

    /// Keys of `[thermal.cooler]`.
    COOLER: CoolerKeys = "cooler" [] {
        fitted: flag(false), "whether there is an oil-to-air cooler", ["TH-3"];
        still_w_k: or(3.0, number(0.0, 2000.0)), "U A at standstill", ["TH-3"];
        ram_w_k_per_m_s: or(2.0, number(0.0, 2000.0)), "U A over road speed", ["TH-3"];
        flow_share: or(0.5, number(0.0, 1.0)), "share of the pump's flow through the cooler", ["TH-3"];
        highest_l_min: or(20.0, number(0.1, 100.0)), "largest flow through the cooler", ["TH-3"];
        bypass_below_degc: or(-60.0, number(-60.0, 200.0)), "sump temperature below which the cooler is bypassed", ["TH-3"];
        bypassed: flag(false), "cooler always bypassed";
    }
}

/// Temperature at which the oil's heat capacity is taken, K.
const OIL_REFERENCE_K: f64 = 40.0 + ZERO_DEGC_K;

impl Network {
    /// A checked network from the values of `[thermal]`; `cvt` says whether there is a belt node.
    pub fn from_values<V: Values>(s: &V, cvt: bool, oil: &Lubricant) -> Self {
        let (engine, radiator) = (s.table("engine"), s.table("radiator"));
        let gearbox = s.table("transmission");
        let of_belt = |key| if cvt { gearbox.number(key) } else { 0.0 };
        let volume = gearbox.number(&GEARBOX.oil_l);
        let oil_j_k =
            volume * oil.density_kg_m3(OIL_REFERENCE_K) * oil.heat_capacity_j_kgk(OIL_REFERENCE_K);
        let block = engine.number(&ENGINE.block_kj_k);
        let engine_oil = engine.number(&ENGINE.oil_kj_k);
        let metal = gearbox.number(&GEARBOX.metal_kj_k);
        let belt = of_belt(&GEARBOX.belt_kj_k);
        Network {
            capacity_j_k: [block, engine_oil, oil_j_k, metal, belt],
            sump_oil_m3: volume,
            coolant_oil_w_k: engine.number(&ENGINE.coolant_oil_w_k),
            block_air_w_k: engine.number(&ENGINE.block_air_w_k),
            block_air_per_speed: engine.number(&ENGINE.block_air_w_k_per_m_s),
            pan_air_w_k: engine.number(&ENGINE.pan_air_w_k),
            pan_air_per_speed: engine.number(&ENGINE.pan_air_w_k_per_m_s),
            radiator_w_k: radiator.number(&RADIATOR.fan_w_k),
            radiator_per_speed: radiator.number(&RADIATOR.ram_w_k_per_m_s),
            thermostat_from_k: radiator.number(&RADIATOR.thermostat_from_degc),
            thermostat_to_k: thermostat_to(&radiator),
            oil_metal_w_k: gearbox.number(&GEARBOX.oil_metal_w_k),
            case_air_w_k: gearbox.number(&GEARBOX.case_air_w_k),
            case_air_per_speed: gearbox.number(&GEARBOX.case_air_v07_w_k),
            bell_housing_w_k: gearbox.number(&GEARBOX.bell_housing_w_k),
            spray_w_k: of_belt(&GEARBOX.spray_w_k),
            exchanger_w_k: gearbox.number(&GEARBOX.exchanger_w_k),
            exchanger_opens_k: gearbox.number(&GEARBOX.exchanger_opens_degc),
            cooler: Cooler::from_values(&s.table("cooler")),
            under_bonnet: s.number(&THERMAL.under_bonnet_rise),
        }
    }
}

fn thermostat_to<V: Values>(s: &V) -> f64 {
    let to = s.number(&RADIATOR.thermostat_to_degc);
    let from = s.number(&RADIATOR.thermostat_from_degc);
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

impl Cooler {
    /// The cooler, if it is fitted and not bypassed.
    fn from_values<V: Values>(s: &V) -> Option<Self> {
        let fitted = s.flag(&COOLER.fitted);
        let cooler = Cooler {
            still_w_k: s.number(&COOLER.still_w_k),
            per_speed_w_s_k_m: s.number(&COOLER.ram_w_k_per_m_s),
            flow_share: s.number(&COOLER.flow_share),
            highest_m3_s: s.number(&COOLER.highest_l_min),
            bypass_below_k: s.number(&COOLER.bypass_below_degc),
        };
        let bypassed = s.flag(&COOLER.bypassed);
        (fitted && !bypassed).then_some(cooler)
    }
}
