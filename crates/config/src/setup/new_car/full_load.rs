//! The full-load line through highest torque and rated power (NC-2).

use cvtcycle_model::keys::RPM;

/// Power at the speed of highest torque over rated power: data sheets round both.
const MOST_OF_RATED: f64 = 1.03;

/// Idle, highest torque, rated power and the highest speed of an engine.
pub(super) struct Curve {
    pub nm: f64,
    pub plateau: [f64; 2],
    pub rated_nm: f64,
    pub rated_rpm: f64,
    pub idle_rpm: f64,
    pub highest_rpm: f64,
}

impl Curve {
    /// Why there is no such line. Highest torque is that at rated power at least, and at its own speed no more power than the rated one.
    pub fn mistake(&self) -> Option<String> {
        let [from, to] = self.plateau;
        let kw = |nm: f64, rpm: f64| nm * rpm * RPM / 1e3;
        let (highest_kw, rated_kw) = (kw(self.nm, to), kw(self.rated_nm, self.rated_rpm));
        if highest_kw > MOST_OF_RATED * rated_kw {
            return Some(format!(
                "{:.0} Nm at {to:.0} rpm are {highest_kw:.0} kW, more than the rated power of {rated_kw:.0} kW",
                self.nm
            ));
        }
        if self.nm < self.rated_nm {
            return Some(format!(
                "rated power needs {:.0} Nm at {:.0} rpm, more than the highest torque of {:.0} Nm",
                self.rated_nm, self.rated_rpm, self.nm
            ));
        }
        let speeds = [self.idle_rpm, from, to, self.rated_rpm, self.highest_rpm];
        let ordered = speeds[0] < from && to < self.rated_rpm && self.rated_rpm <= self.highest_rpm;
        let speeds = speeds.map(|rpm| format!("{rpm:.0}")).join(", ");
        (!ordered).then(|| {
            format!("the speeds of idle, highest torque, rated power and the highest one do not rise: {speeds} rpm")
        })
    }

    fn torque_nm(&self, rpm: f64) -> f64 {
        let [from, to] = self.plateau;
        if rpm < from {
            let share = (from - rpm) / (from - self.idle_rpm);
            self.nm * (1.0 - 0.31 * (share * share.sqrt()))
        } else if rpm <= to {
            self.nm
        } else {
            let share = (rpm - to) / (self.rated_rpm - to);
            let fallen_nm = self.nm - (self.nm - self.rated_nm) * share * share;
            // Between them no more power than at the ends: a charged engine is held at its rated power.
            let (at_plateau, at_rated) = (self.nm * to, self.rated_nm * self.rated_rpm);
            let most = at_rated + (at_plateau - at_rated).max(0.0) * (1.0 - share);
            match rpm < self.rated_rpm {
                true => fallen_nm.min(most / rpm), // NC-2
                // Rated power is the greatest one. Rounded down: a rounded-up row would move the speed of the greatest power to it.
                false if rpm > self.rated_rpm => {
                    (10.0 * fallen_nm.min(at_rated / rpm)).floor() / 10.0
                }
                false => fallen_nm,
            }
        }
    }

    /// True if the rated power is what holds the torque at a speed.
    fn is_held(&self, rpm: f64) -> bool {
        let [_, to] = self.plateau;
        let share = (rpm - to) / (self.rated_rpm - to);
        self.torque_nm(rpm) < self.nm - (self.nm - self.rated_nm) * share * share
    }

    pub fn rows(&self) -> String {
        let highest_rpm = self.highest_rpm;
        // Between two rows of a line of constant power there is more of it: rows near each other.
        let [_, to] = self.plateau;
        let is_step = |rpm: &f64| {
            rpm % 500.0 < 1.0 || to < *rpm && *rpm < self.rated_rpm && self.is_held(*rpm)
        };
        let steps = (1..80).map(|k| 250.0 * f64::from(k)).filter(is_step);
        let inner = steps.filter(|rpm| *rpm > self.idle_rpm + 50.0 && *rpm < highest_rpm - 50.0);
        let mut speeds: Vec<f64> = inner
            .chain([self.idle_rpm, highest_rpm, self.rated_rpm])
            .collect();
        speeds.extend(self.plateau);
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|a, b| (*a - *b).abs() < 0.5);
        let row = |rpm: &f64| format!("[{rpm:.0}, {:.1}]", self.torque_nm(*rpm));
        let rows: Vec<String> = speeds.iter().map(row).collect();
        format!("[{}]", rows.join(", "))
    }
}
