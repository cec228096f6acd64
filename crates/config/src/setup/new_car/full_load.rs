//! The full-load line through highest torque and rated power (NC-2).

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
    /// Why there is no such line.
    pub fn mistake(&self) -> Option<String> {
        let [from, to] = self.plateau;
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
            self.nm * (1.0 - 0.31 * ((from - rpm) / (from - self.idle_rpm)).powf(1.5))
        } else if rpm <= to {
            self.nm
        } else {
            let share = (rpm - to) / (self.rated_rpm - to);
            self.nm - (self.nm - self.rated_nm) * share * share
        }
    }

    pub fn rows(&self) -> String {
        let highest_rpm = self.highest_rpm;
        let steps = (1..40).map(|k| 500.0 * f64::from(k));
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
