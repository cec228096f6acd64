//! Fuel over speed and load from a measured map.
//!
//! | label | statement | status |
//! |---|---|---|
//! | BM-1 | fuel MEP = BSFC x BMEP x LHV, or fuel flow x LHV 4 pi/(V w), between the map's points, linear in speed and BMEP; LHV and V those of the engine that was measured | source: the user's map |
//! | BM-2 | below the map's lowest BMEP (of those above the drag) a line to zero fuel at minus the hot friction l + l2 cm2, or at minus the drag of EN-7 where the engine has one of its own | derived; friction from keys l, l2 |

/// A map of fuel mean effective pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct BsfcMap {
    /// Speeds, rad/s, rising.
    pub speed_rad_s: Vec<f64>,
    /// Brake mean effective pressures, Pa, rising, at least two.
    pub bmep_pa: Vec<f64>,
    /// Fuel MEP, Pa: `fuel_pa[i][k]` at `speed_rad_s[i]` and `bmep_pa[k]`.
    pub fuel_pa: Vec<Vec<f64>>,
    /// Hot friction l, l2 as in the Willans line, bar and bar s2/m2 (BM-2).
    pub friction: (f64, f64),
}

impl BsfcMap {
    /// Fuel MEP at a speed and load, with the drag at which there is none, Pa, and whether the point lies within the map.
    pub(crate) fn at_speed(&self, speed_rad_s: f64, bmep_pa: f64, drag_pa: f64) -> (f64, bool) {
        let n = self.speed_rad_s.len();
        let hi = self
            .speed_rad_s
            .partition_point(|&s| s <= speed_rad_s)
            .clamp(1, n - 1);
        let (s0, s1) = (self.speed_rad_s[hi - 1], self.speed_rad_s[hi]);
        let u = ((speed_rad_s - s0) / (s1 - s0)).clamp(0.0, 1.0);
        let m = self.bmep_pa.len();
        let row = |j: usize| {
            self.fuel_pa[hi - 1][j] + u * (self.fuel_pa[hi][j] - self.fuel_pa[hi - 1][j])
        };
        let inside = s0 <= speed_rad_s && speed_rad_s <= s1 && bmep_pa <= self.bmep_pa[m - 1];
        // Loads at which the drag leaves no fuel have none, whatever the map says.
        let first = self.bmep_pa.partition_point(|&p| p <= -drag_pa).min(m - 1);
        let lowest = self.bmep_pa[first];
        if bmep_pa < lowest {
            let fuel_pa = row(first) * (bmep_pa + drag_pa) / (lowest + drag_pa); // BM-2
            return (fuel_pa.max(0.0), inside);
        }
        let k = self
            .bmep_pa
            .partition_point(|&p| p <= bmep_pa)
            .clamp(1, m - 1);
        let (p0, p1) = (self.bmep_pa[k - 1], self.bmep_pa[k]);
        (
            row(k - 1) + (row(k) - row(k - 1)) * (bmep_pa - p0) / (p1 - p0),
            inside,
        ) // BM-1
    }

    /// A map from rows (speed rad/s, BMEP Pa, BSFC kg/J) and the rubbing friction that belongs to it.
    ///
    /// # Errors
    /// A sentence if the rows do not fill a rectangular grid of at least two speeds and two loads, or have no power.
    pub fn from_rows(
        rows: &[(f64, f64, f64)],
        heating_value_j_kg: f64,
        friction: (f64, f64),
    ) -> Result<Self, String> {
        if let Some((_, load, _)) = rows.iter().find(|(_, load, _)| *load <= 0.0) {
            return Err(format!(
                "specific consumption has no meaning at {:.3} bar, where the engine gives no power",
                load / 1e5
            ));
        }
        let fuel = |&(speed, load, bsfc): &(f64, f64, f64)| {
            (speed, load, bsfc * load * heating_value_j_kg) // BM-1
        };
        let rows: Vec<(f64, f64, f64)> = rows.iter().map(fuel).collect();
        Self::of_fuel(&rows, friction)
    }

    /// As [`BsfcMap::from_rows`] of the fuel's own flow: rows (speed rad/s, BMEP Pa, fuel kg/s) of an engine of a displacement. Loads may be
    /// nothing and below.
    ///
    /// # Errors
    /// As there.
    pub fn from_flow(
        rows: &[(f64, f64, f64)],
        heating_value_j_kg: f64,
        displacement_m3: f64,
        friction: (f64, f64),
    ) -> Result<Self, String> {
        let per_speed = heating_value_j_kg * 4.0 * std::f64::consts::PI / displacement_m3;
        let fuel = |&(speed, load, kg_s): &(f64, f64, f64)| {
            (speed, load, kg_s / speed * per_speed) // BM-1
        };
        let rows: Vec<(f64, f64, f64)> = rows.iter().map(fuel).collect();
        Self::of_fuel(&rows, friction)
    }

    /// A map from rows (speed rad/s, BMEP Pa, fuel MEP Pa).
    fn of_fuel(rows: &[(f64, f64, f64)], friction: (f64, f64)) -> Result<Self, String> {
        let distinct = |f: &dyn Fn(&(f64, f64, f64)) -> f64| {
            let mut v: Vec<f64> = rows.iter().map(f).collect();
            v.sort_by(f64::total_cmp);
            v.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * b.abs());
            v
        };
        let (speeds, loads) = (distinct(&|r| r.0), distinct(&|r| r.1));
        if speeds.len() < 2 || loads.len() < 2 || speeds.len() * loads.len() != rows.len() {
            return Err(format!(
                "{} rows do not fill a grid of {} speeds and {} loads",
                rows.len(),
                speeds.len(),
                loads.len()
            ));
        }
        let mut fuel = vec![vec![f64::NAN; loads.len()]; speeds.len()];
        let place = |values: &[f64], x: f64| {
            let before = values.partition_point(|&own| own < x - 1e-8 * x.abs());
            before.min(values.len() - 1)
        };
        for &(speed, load, fuel_pa) in rows {
            fuel[place(&speeds, speed)][place(&loads, load)] = fuel_pa;
        }
        if fuel.iter().flatten().any(|f| f.is_nan()) {
            return Err(
                "a combination of speed and load is there twice, another is missing".into(),
            );
        }
        if fuel.iter().any(|row| row.windows(2).any(|f| f[0] >= f[1])) {
            return Err(
                "fuel (BSFC times BMEP, or its flow) must rise with load at every speed".into(),
            );
        }
        Ok(BsfcMap {
            speed_rad_s: speeds,
            bmep_pa: loads,
            fuel_pa: fuel,
            friction,
        })
    }
}
