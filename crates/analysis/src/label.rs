//! Figures of a car's fuel label, from its own simulated tests. Not for certification.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LB-1 | G = 0.55 G_city + 0.45 G_highway, G gallons a mile; unadjusted: of FTP75 and HWFET | source: 40 CFR 600.206 |
//! | LB-2 | G_city = 0.003259 + 1.1805 G_FTP, G_highway = 0.001376 + 1.3466 G_HWFET | source: 40 CFR 600.210-08, the formulas of 2008; coefficients as public programs have them |
//! | LB-3 | S = 0.76 S_24 + 0.24 S_-7, S_T = 3.6 (G_1 - G_3): fuel of a start, of bags 1 and 3 of FTP75 at 24 and -6.7 degC | source: 40 CFR 600.114, coefficients as public programs have them |
//! | LB-4 | G_city = (0.33 S/4.1 + 0.82 (0.48 G_2 + 0.41 G_3 + 0.11 G_US06city) + 0.18 (0.5 G_2,cold + 0.5 G_3,cold) + 0.133 1.083 A)/0.905; G_highway = (0.33 S/60 + 1.007 (0.79 G_US06highway + 0.21 G_HWFET) + 0.133 0.377 A)/0.905; A = G_SC03 - 0.61 G_3 - 0.39 G_2 | source: as LB-3, the five cycles |
//! | LB-5 | WLTP: CO2 at 14 over CO2 at 23 degC, both from a soak | source: UN GTR 15 Annex 6a, in words |
//!
//! The tests are those of `cycles/tests` (`cvtcycle_config::procedure`): FTP75 from a soak at 24 degC and, with 10 % more road load, at -6.7 degC; HWFET and
//! US06 at 24 degC and SC03 at 35 degC, each directly after the same cycle, all stated for the fuel of 1975 (TE-3). SC03 begins after ten minutes of rest in the test, which is left out. What air conditioning and heating draw is the caller's.

use cvtcycle_config::Problems;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::procedure::Procedure;
use cvtcycle_model::cycle::Weighting;
use cvtcycle_model::drive::{Outcome, Vehicle, co2_g_per_km, drive, litres_per_100km};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_output::summary::has_failed_trace;
use serde::Serialize;

/// Litres for 100 km of a mile a US gallon.
const MPG_US: f64 = 235.214_583;
/// Share of the city in the combined figure (LB-1).
const CITY: f64 = 0.55;
/// Share of the cold test in the fuel of starts (LB-3).
const COLD_STARTS: f64 = 0.24;
/// Share of a mile's air conditioning (LB-4).
const AIR_CONDITIONED: f64 = 0.133;
/// Factor for effects absent from the five cycles: wind, tyres, fuel and roads (LB-4).
const NOT_TESTED: f64 = 0.905;
/// Road load of the cold test over that of the others.
pub const COLD_LOAD_FACTOR: f64 = 1.1;

/// The car as its tests have it.
#[derive(Clone, Copy, Debug)]
pub struct Cars<'a> {
    /// At 24 degC.
    pub mild: &'a Vehicle,
    /// At -6.7 degC: with its road load and heating.
    pub cold: &'a Vehicle,
    /// At 35 degC, with air conditioning.
    pub hot: &'a Vehicle,
}

/// Cycles of the tests.
#[derive(Clone, Copy, Debug)]
pub struct Cycles<'a> {
    /// FTP75.
    pub ftp75: &'a Cycle,
    /// HWFET.
    pub hwfet: &'a Cycle,
    /// US06.
    pub us06: &'a Cycle,
    /// SC03.
    pub sc03: &'a Cycle,
    /// WLTC of the car's class.
    pub wltc: &'a Cycle,
}

/// Fuel of the tests, L/100 km.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tests {
    /// Weighted FTP75 at 24 degC.
    pub ftp75: f64,
    /// Results of the bags.
    pub bags: [f64; 3],
    /// Bags of FTP75 at -6.7 degC.
    pub cold_bags: [f64; 3],
    /// HWFET.
    pub hwfet: f64,
    /// City and highway part of US06.
    pub us06: [f64; 2],
    /// SC03.
    pub sc03: f64,
}

/// A label, miles a US gallon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Label {
    /// City.
    pub city_mpg: f64,
    /// Highway.
    pub highway_mpg: f64,
    /// Both (LB-1).
    pub combined_mpg: f64,
}

/// The WLTC at one temperature.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wltp {
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// Fuel, L/100 km.
    pub fuel_l_per_100km: f64,
    /// Carbon dioxide, g/km.
    pub co2_g_per_km: f64,
}

/// All figures of a car.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Fuel burnt in the tests.
    pub tests: Tests,
    /// Without adjustment (LB-1).
    pub unadjusted: Label,
    /// By the formulas of 2008 (LB-2).
    pub derived: Label,
    /// By the five cycles (LB-4).
    pub five_cycle: Label,
    /// Name of the WLTC.
    pub wltc: String,
    /// The WLTC at 23 and 14 degC.
    pub wltp: [Wltp; 2],
    /// CO2 at 14 over CO2 at 23 degC (LB-5).
    pub co2_14_over_23: f64,
    /// Tests whose trace was missed by more than their tolerance (TR-3), each with the seconds that miss.
    pub missed_s: Vec<(String, f64)>,
}

impl Label {
    /// A label from gallons a mile in city and on the highway.
    fn from_consumption(city: f64, highway: f64) -> Self {
        Label {
            city_mpg: 1.0 / city,
            highway_mpg: 1.0 / highway,
            combined_mpg: 1.0 / (CITY * city + (1.0 - CITY) * highway), // LB-1
        }
    }
}

impl Tests {
    /// City and highway without adjustment (LB-1).
    pub fn unadjusted(&self) -> Label {
        Label::from_consumption(self.ftp75 / MPG_US, self.hwfet / MPG_US)
    }

    /// The label by the formulas of 2008 (LB-2).
    pub fn derived(&self) -> Label {
        let [city, highway] = [self.ftp75, self.hwfet].map(|fuel| fuel / MPG_US);
        Label::from_consumption(0.003_259 + 1.1805 * city, 0.001_376 + 1.3466 * highway) // LB-2
    }

    /// The label by the five cycles (LB-4).
    pub fn five_cycle(&self) -> Label {
        let [one, two, three] = self.bags.map(|fuel| fuel / MPG_US);
        let [cold_one, cold_two, cold_three] = self.cold_bags.map(|fuel| fuel / MPG_US);
        let [us06_city, us06_highway] = self.us06.map(|fuel| fuel / MPG_US);
        let start = |first: f64, hot: f64| 3.6 * (first - hot);
        let starts =
            (1.0 - COLD_STARTS) * start(one, three) + COLD_STARTS * start(cold_one, cold_three); // LB-3
        let cooling = self.sc03 / MPG_US - 0.61 * three - 0.39 * two;
        let city = 0.33 * starts / 4.1
            + 0.82 * (0.48 * two + 0.41 * three + 0.11 * us06_city)
            + 0.18 * (0.5 * cold_two + 0.5 * cold_three)
            + AIR_CONDITIONED * 1.083 * cooling; // LB-4
        let highway = 0.33 * starts / 60.0
            + 1.007 * (0.79 * us06_highway + 0.21 * self.hwfet / MPG_US)
            + AIR_CONDITIONED * 0.377 * cooling; // LB-4
        Label::from_consumption(city / NOT_TESTED, highway / NOT_TESTED)
    }
}

/// A driven test.
struct Driven<'a> {
    car: &'a Vehicle,
    cycle: &'a Cycle,
    ambient_degc: f64,
    /// Stated over burnt fuel (TE-3).
    stated: f64,
    outcome: Outcome,
}

impl<'a> Driven<'a> {
    fn new(
        (car, cycle): (&'a Vehicle, &'a Cycle),
        test: &str,
        max_dt_s: f64,
    ) -> Result<Self, Problems> {
        let test = Procedure::open(test)?;
        let conditions = test.conditions(max_dt_s);
        Ok(Driven {
            car,
            cycle,
            ambient_degc: conditions.ambient_k - ZERO_DEGC_K,
            stated: test.stated_share(car),
            outcome: drive(car, cycle, &conditions),
        })
    }

    /// Fuel of phases by name, L/100 km; of the whole cycle without names.
    fn fuel(&self, names: &[&str]) -> f64 {
        let named = |name: &String| names.is_empty() || names.contains(&name.as_str());
        let phases = (0_u16..)
            .zip(&self.cycle.phases)
            .filter(|(_, name)| named(name));
        let phases: Vec<u16> = phases.map(|(phase, _)| phase).collect();
        let part = if phases.is_empty() {
            self.outcome.totals.total()
        } else {
            self.outcome.totals.over(&phases)
        };
        let density = self.car.engine().fuel_density_kg_m3;
        self.stated * litres_per_100km(part.fuel_kg, density, part.distance_m)
    }

    /// The three bags of FTP75.
    fn bags(&self) -> [f64; 3] {
        ["cold_transient", "stabilised", "hot_transient"].map(|bag| self.fuel(&[bag]))
    }

    fn wltp(&self) -> Wltp {
        let total = self.outcome.totals.total();
        let co2_kg_kg = self.car.engine().co2_kg_kg;
        Wltp {
            ambient_degc: self.ambient_degc,
            fuel_l_per_100km: self.fuel(&[]),
            co2_g_per_km: co2_g_per_km(total.fuel_kg, co2_kg_kg, total.distance_m),
        }
    }

    /// Name and seconds of a test whose trace was missed by more than its tolerance (TR-3).
    fn missed(&self) -> Option<(String, f64)> {
        let totals = &self.outcome.totals;
        has_failed_trace(totals)
            .then(|| (self.cycle.name.clone(), totals.seconds(Flags::MISSED_TRACE)))
    }
}

/// Drives all tests of a label with steps of at most some time, s.
///
/// ```
/// use cvtcycle_config::cycle::find;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_analysis::label::{Cars, Cycles, figures};
/// let car = load("civic_20_cvt", &Options::default())?;
/// let [ftp75, hwfet, us06] = [find("ftp75")?, find("hwfet")?, find("us06")?];
/// let [sc03, wltc] = [find("sc03")?, find("wltc_class3b")?];
/// let cycles = Cycles { ftp75: &ftp75, hwfet: &hwfet, us06: &us06, sc03: &sc03, wltc: &wltc };
/// let figures = figures(&Cars { mild: &car, cold: &car, hot: &car }, &cycles, 1.0)?;
/// assert!(figures.tests.bags[0] > figures.tests.bags[2], "the cold bag");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
///
/// # Errors
/// A test that cannot be read.
pub fn figures(cars: &Cars, cycles: &Cycles, max_dt_s: f64) -> Result<Figures, Problems> {
    let run = |car, cycle, test: &str| Driven::new((car, cycle), test, max_dt_s);
    let city = run(cars.mild, cycles.ftp75, "ftp75")?;
    let cold = run(cars.cold, cycles.ftp75, "cold_ftp")?;
    let highway = run(cars.mild, cycles.hwfet, "hwfet")?;
    let fast = run(cars.mild, cycles.us06, "us06")?;
    let hot = run(cars.hot, cycles.sc03, "sc03")?;
    let wltc = [
        run(cars.mild, cycles.wltc, "wltp")?,
        run(cars.mild, cycles.wltc, "wltp_14")?,
    ];
    let weighted = |start: &str| city.fuel(&[start, "stabilised"]);
    let tests = Tests {
        ftp75: Weighting::FTP75_COLD * weighted("cold_transient")
            + Weighting::FTP75_HOT * weighted("hot_transient"),
        bags: city.bags(),
        cold_bags: cold.bags(),
        hwfet: highway.fuel(&[]),
        us06: ["city", "highway"].map(|part| fast.fuel(&[part])),
        sc03: hot.fuel(&[]),
    };
    let us = [&city, &cold, &highway, &fast, &hot];
    let all = us.into_iter().chain(&wltc);
    let missed_s = all.filter_map(Driven::missed).collect();
    let wltp = wltc.each_ref().map(Driven::wltp);
    Ok(Figures {
        unadjusted: tests.unadjusted(),
        derived: tests.derived(),
        five_cycle: tests.five_cycle(),
        tests,
        wltc: cycles.wltc.name.clone(),
        wltp,
        co2_14_over_23: wltp[1].co2_g_per_km / wltp[0].co2_g_per_km, // LB-5
        missed_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 and 40 mpg by hand; equal fuel in all tests is left as it is but for what no test has: 0.82 + 0.18 in the city, 1.007 on the highway, over
    /// 0.905.
    #[test]
    fn val_labels_by_hand() {
        let same = Tests {
            ftp75: 6.9,
            bags: [7.0; 3],
            cold_bags: [7.0; 3],
            hwfet: 7.0,
            us06: [7.0; 2],
            sc03: 7.0,
        };
        let five = same.five_cycle();
        let mpg = MPG_US / 7.0;
        assert!((five.city_mpg / (0.905 * mpg) - 1.0).abs() < 1e-12);
        assert!((five.highway_mpg / (0.905 / 1.007 * mpg) - 1.0).abs() < 1e-12);
        let plain = Tests {
            ftp75: MPG_US / 30.0,
            hwfet: MPG_US / 40.0,
            ..same
        };
        let label = plain.unadjusted();
        assert!((label.city_mpg - 30.0).abs() < 1e-9 && (label.highway_mpg - 40.0).abs() < 1e-9);
        assert!((label.combined_mpg - 33.8028).abs() < 1e-4);
        let label = plain.derived();
        assert!(
            (label.city_mpg - 23.4692).abs() < 1e-4,
            "{}",
            label.city_mpg
        );
        assert!(
            (label.highway_mpg - 28.5380).abs() < 1e-4,
            "{}",
            label.highway_mpg
        );
    }

    /// A start that takes more fuel costs the city by LB-3: 3.6 miles of it on 4.1, a third of the trips, and hardly anything on the highway.
    #[test]
    fn starts_cost_the_city() {
        let warm = Tests {
            ftp75: 7.0,
            bags: [7.0; 3],
            cold_bags: [7.0; 3],
            hwfet: 6.0,
            us06: [9.0, 7.0],
            sc03: 9.0,
        };
        let cold = Tests {
            bags: [8.0, 7.0, 7.0],
            cold_bags: [10.0, 7.0, 7.0],
            ..warm
        };
        let more = |of: fn(&Label) -> f64| {
            MPG_US * (1.0 / of(&cold.five_cycle()) - 1.0 / of(&warm.five_cycle()))
        };
        let starts = 3.6 * (0.76 * 1.0 + 0.24 * 3.0);
        assert!((more(|l| l.city_mpg) - 0.33 * starts / 4.1 / 0.905).abs() < 1e-9);
        assert!((more(|l| l.highway_mpg) - 0.33 * starts / 60.0 / 0.905).abs() < 1e-9);
    }
}
