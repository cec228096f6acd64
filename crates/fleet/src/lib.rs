//! Many cars from a table, a row each, driven on tests, and compared with measured fuel.
//!
//! | module | content |
//! |---|---|
//! | `map` | which columns of a table give which numbers of a car |
//! | `sheet` | a table of text with its refused rows |
//! | `car` | a row to a car, by the rules of `cvtcycle new`, in memory |
//! | `driven` | cars on tests, side by side |
//! | `setting` | values of keys: for all cars, or from the columns of a row |
//! | `fit` | values fitted to measured fuel, and what they are worth for groups left out |
//! | `errors` | computed against measured fuel: all cars, by the words of a column, pairs of cars |
//! | `baselines` | regressions on the same measurements, each group predicted from the others |
//! | `spread` | what the errors say of a car that is not in the table |
//! | `tables` | results as CSV |
//! | `weights` | which of the numbers of a car matter most for its fuel |

pub mod baselines;
mod car;
mod driven;
pub mod errors;
pub mod fit;
mod map;
mod setting;
mod sheet;
pub mod spread;
pub mod tables;
pub mod weights;

pub use car::{CarFacts, CarSets, FleetCar};
pub use driven::{DrivenCar, TestFigures};
pub use map::ColumnMap;
pub use setting::Setting;
pub use sheet::{Refused, Sheet};

use cvtcycle_config::Problems;
use cvtcycle_config::procedure::Procedure;
use cvtcycle_output::progress::Progress;

/// Cars of a table, and the rows that are none.
#[derive(Clone, Debug)]
pub struct Fleet {
    /// Cars in the order of their rows.
    pub cars: Vec<FleetCar>,
    /// Rows that cannot be driven, each with its reason.
    pub refused: Vec<Refused>,
    /// Columns that nothing reads, each with the near names.
    pub unknown: Vec<(String, String)>,
    /// Columns by which errors are grouped.
    pub groups: Vec<String>,
}

impl Fleet {
    /// Makes the cars of a table. `set` is taken by every car, before the columns of the row that are keys.
    ///
    /// ```
    /// use cvtcycle_config::procedure::Procedure;
    /// use cvtcycle_fleet::{ColumnMap, Fleet, Sheet};
    /// let text = "carid,mass,displacement,power\none,1300,1.8l,100kW\ntwo,1300,1.8l,100\n";
    /// let sheet = Sheet::read("cars.csv", text.as_bytes())?;
    /// let tests = [Procedure::open("hwfet")?];
    /// let fleet = Fleet::from_sheet(&sheet, &ColumnMap::own(), &tests, &[])?;
    /// assert_eq!((fleet.cars.len(), fleet.refused.len()), (1, 1));
    /// assert!(fleet.refused[0].reason.contains("unit"));
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// A table without the columns that the map needs, or with columns of one name.
    pub fn from_sheet(
        sheet: &Sheet,
        map: &ColumnMap,
        tests: &[Procedure],
        set: &[Setting],
    ) -> Result<Fleet, Problems> {
        car::fleet(sheet, map, tests, set, |_| ()).map(|(fleet, _)| fleet)
    }

    /// Makes the cars of a table and drives each on every test, with steps of at most some time, s. `progress` counts the cars.
    /// The values of a car go as soon as it is driven, so that memory holds for tables of any length.
    ///
    /// # Errors
    /// As of [`Fleet::from_sheet`].
    pub fn driven(
        sheet: &Sheet,
        map: &ColumnMap,
        tests: &[Procedure],
        set: &[Setting],
        max_dt_s: f64,
        progress: &impl Progress,
    ) -> Result<(Fleet, Vec<DrivenCar>), Problems> {
        car::fleet(sheet, map, tests, set, |car| {
            let sets = car.sets.take();
            let driven = sets.map(|sets| driven::drive(&sets, tests, max_dt_s));
            let driven = driven.unwrap_or_default();
            car.doubts.extend(driven.doubts(&car.measured));
            progress.advance(1);
            driven
        })
    }
}
