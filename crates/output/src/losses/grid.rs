//! Grid of operating points: axes and their values.

use crate::number::plain;
use cvtcycle_config::Bound;
use cvtcycle_model::rig::solvable_ratios;
use cvtcycle_model::transmission::Transmission;

/// Maximum number of points.
pub const MAX_POINTS: usize = 1_000_000;

/// Axes of a grid, outermost first: the last one varies fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Axis {
    /// Belt ratio, or gear of a manual box.
    Ratio,
    /// Oil in the sump, degC.
    Sump,
    /// Belt and spray, degC; by default in steady state above the sump.
    Belt,
    /// Throttle that the clamp law sees.
    Throttle,
    /// Secondary pressure, bar; by default from the clamp law.
    Pressure,
    /// Torque at the output shaft, Nm; absent if that at the input shaft is given.
    Torque,
    /// Torque at the input shaft, Nm; in a CVT the clamp law takes it over full load as throttle.
    InputTorque,
    /// Speed of the input shaft, rpm.
    Speed,
}

impl Axis {
    /// Number of axes.
    pub const COUNT: usize = 8;
    /// All axes, outermost first.
    pub const ALL: [Axis; Self::COUNT] = [
        Axis::Ratio,
        Axis::Sump,
        Axis::Belt,
        Axis::Throttle,
        Axis::Pressure,
        Axis::Torque,
        Axis::InputTorque,
        Axis::Speed,
    ];

    /// Valid range, and the suffix of a key with its unit; ratios and gears depend on the transmission.
    pub fn range(self) -> (Bound, &'static str) {
        // Validity of the fluid models.
        let temp = Bound::closed(-40.0, 160.0);
        match self {
            Axis::Ratio => (Bound::any(), ""),
            Axis::Sump | Axis::Belt => (temp, "_degc"),
            Axis::Throttle => (Bound::closed(0.0, 1.0), ""),
            Axis::Pressure => (Bound::closed(0.0, 100.0), "_bar"),
            Axis::Torque | Axis::InputTorque => (Bound::closed(-5000.0, 5000.0), "_nm"),
            Axis::Speed => (Bound::open_low(0.0, 10_000.0), "_rpm"),
        }
    }

    /// Valid range for a transmission, as [`Axis::range`]: ratios at which the belt fits around both pulleys, or existing gears.
    pub fn range_in(self, transmission: &Transmission) -> (Bound, &'static str) {
        match (self, transmission) {
            (Axis::Ratio, Transmission::Cvt(cvt)) => {
                let (low, high) = solvable_ratios(&cvt.belt);
                (Bound::closed(low, high), "")
            }
            (Axis::Ratio, Transmission::Manual(manual)) => {
                (Bound::closed(1.0, manual.overall.len() as f64), "")
            }
            _ => self.range(),
        }
    }

    /// Axis title of a plot and heading of a table's column.
    fn names(self, cvt: bool) -> (&'static str, &'static str) {
        match self {
            Axis::Ratio if cvt => ("Belt ratio", "ratio"),
            Axis::Ratio => ("Gear", "gear"),
            Axis::Sump => ("Oil in the sump [\u{b0}C]", "sump \u{b0}C"),
            Axis::Belt => ("Belt and spray [\u{b0}C]", "belt \u{b0}C"),
            Axis::Throttle => ("Throttle", "throttle"),
            Axis::Pressure => ("Secondary pressure [bar]", "bar"),
            Axis::Torque => ("Torque at the output shaft [Nm]", "Nm out"),
            Axis::InputTorque => ("Torque at the input shaft [Nm]", "Nm in"),
            Axis::Speed => ("Input speed [rpm]", "rpm"),
        }
    }

    /// Title of a plot's axis.
    pub fn title(self, cvt: bool) -> &'static str {
        self.names(cvt).0
    }

    /// Heading of a table's column.
    pub fn short(self, cvt: bool) -> &'static str {
        self.names(cvt).1
    }

    /// Formats a value without its unit.
    pub fn text(self, x: f64) -> String {
        match self {
            Axis::Ratio => plain((x * 1e3).round() / 1e3),
            _ => plain(x),
        }
    }

    /// Formats a value in words.
    pub fn words(self, cvt: bool, x: f64) -> String {
        let text = self.text(x);
        match self {
            Axis::Ratio | Axis::Throttle => format!("{} {text}", self.short(cvt)),
            Axis::Sump => format!("sump {text} \u{b0}C"),
            Axis::Belt => format!("belt {text} \u{b0}C"),
            Axis::Pressure | Axis::Speed => format!("{text} {}", self.short(cvt)),
            Axis::Torque => format!("{text} Nm at the output"),
            Axis::InputTorque => format!("{text} Nm at the input"),
        }
    }
}

/// Values of all axes, each in the unit of its column. Only belt temperature, pressure and one of the torques may be empty: not given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LossGrid {
    /// Values by [`Axis`].
    pub values: [Vec<f64>; Axis::COUNT],
}

impl LossGrid {
    /// Values of one axis.
    pub fn axis_values(&self, axis: Axis) -> &[f64] {
        &self.values[axis as usize]
    }

    /// Axes with more than one value, outermost first.
    pub fn varied(&self) -> Vec<Axis> {
        let mut axes = Axis::ALL.to_vec();
        axes.retain(|axis| self.axis_values(*axis).len() > 1);
        axes
    }

    /// Number of points as a float, since it may overflow an integer.
    pub fn size(&self) -> f64 {
        self.values.iter().map(|v| v.len().max(1) as f64).product()
    }

    /// Number of points; valid up to [`MAX_POINTS`].
    pub fn len(&self) -> usize {
        self.values.iter().map(|v| v.len().max(1)).product()
    }

    /// Always false: an axis without values counts as one point.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Indices of the axis values at a point.
    pub fn indices(&self, mut index: usize) -> [usize; Axis::COUNT] {
        let mut out = [0; Axis::COUNT];
        for (place, values) in out.iter_mut().zip(&self.values).rev() {
            let count = values.len().max(1);
            *place = index % count;
            index /= count;
        }
        out
    }

    /// Axis values of a point, NaN where an axis is not given.
    pub fn at(&self, index: usize) -> [f64; Axis::COUNT] {
        let indices = self.indices(index);
        std::array::from_fn(|k| self.values[k].get(indices[k]).copied().unwrap_or(f64::NAN))
    }
}
