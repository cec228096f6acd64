//! Quantities of a log's channels, their names in other programs, and their units.

use super::bare;

/// Quantity of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Time stamp.
    Time,
    /// Speed of the car.
    Speed,
    /// Slope of the road, rise over run.
    Grade,
    /// Height above any level.
    Altitude,
    /// 1 where the engine runs.
    EngineOn,
    /// 1 where the engine rests.
    EngineOff,
    /// Name of a part of the drive.
    Phase,
    /// Speed of the engine.
    EngineSpeed,
    /// Flow of fuel.
    Fuel,
    /// Temperature of the coolant.
    Coolant,
    /// Temperature of the engine's oil.
    EngineOil,
    /// Temperature of the transmission's oil.
    Sump,
    /// Temperature of the air outside.
    Ambient,
}

/// A unit: its name, and value in SI = factor * (number + offset) / divisor; of an angle the tangent, see [`Unit::si`]. A divisor of its own gives the same
/// bits as the tables of cycles have them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Name.
    pub name: &'static str,
    factor: f64,
    divisor: f64,
    offset: f64,
    is_angle: bool,
}

impl Unit {
    /// Number in SI.
    #[must_use]
    pub fn si(&self, number: f64) -> f64 {
        let scaled = self.factor * (number + self.offset) / self.divisor;
        match self.is_angle {
            true => scaled.tan(),
            false => scaled,
        }
    }
}

macro_rules! units {
    ($($list:ident: $($name:literal $factor:expr, $divisor:expr, $offset:expr, $angle:literal, [$($written:literal)*];)*)*) => {
        $(static $list: &[(Unit, &[&str])] = &[$((
            Unit { name: $name, factor: $factor, divisor: $divisor, offset: $offset, is_angle: $angle },
            &[$($written),*],
        )),*];)*
    };
}

/// The international mile, exact by definition.
const MILE_M: f64 = 1609.344;
const FOOT_M: f64 = 0.3048;
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Density of petrol at 15 degC, kg/L: the middle of EN 228 (0.720 to 0.775). It turns litres of a log into mass.
const PETROL_KG_L: f64 = 0.7475;

// Texts are as `bare` has them: lower case, words joined by `_`.
units! {
    TIME:
        "s" 1.0, 1.0, 0.0, false, ["s" "sec" "secs" "second" "seconds" "sek"];
        "ms" 1.0, 1e3, 0.0, false, ["ms" "msec" "msecs" "millis" "millisec" "millisecs" "millisecond" "milliseconds"];
        "us" 1.0, 1e6, 0.0, false, ["us" "µs" "μs" "usec" "microsecond" "microseconds"];
        "ns" 1.0, 1e9, 0.0, false, ["ns" "nsec" "nanosecond" "nanoseconds"];
        "min" 60.0, 1.0, 0.0, false, ["min" "mins" "minute" "minutes"];
        "h" 3600.0, 1.0, 0.0, false, ["h" "hr" "hrs" "hour" "hours"];
        "d" 86_400.0, 1.0, 0.0, false, ["d" "day" "days"];
    SPEED:
        "km/h" 1.0, 3.6, 0.0, false, ["km_h" "kmh" "km_hr" "kph" "kmph" "kilometers_per_hour" "kilometres_per_hour"];
        "m/s" 1.0, 1.0, 0.0, false, ["m_s" "mps" "m_sec" "meters_per_second" "metres_per_second" "meters_second" "metres_second" "m_s_1" "m_s1"];
        "mph" 1.609_344, 3.6, 0.0, false, ["mph" "mi_h" "mi_hr" "miles_per_hour" "miles_hour"];
        "kn" 1.852, 3.6, 0.0, false, ["kn" "kt" "kts" "knot" "knots"];
        "cm/s" 0.01, 1.0, 0.0, false, ["cm_s"];
        "ft/s" FOOT_M, 1.0, 0.0, false, ["ft_s" "fps"];
    GRADE:
        "-" 1.0, 1.0, 0.0, false, ["-" "1" "m_m" "ratio" "share" "rise_over_run"];
        "%" 1.0, 100.0, 0.0, false, ["%" "percent" "pct" "per_cent"];
        "per mille" 1.0, 1000.0, 0.0, false, ["‰" "per_mille" "permille" "permil" "per_mil"];
        "deg" DEGREE, 1.0, 0.0, true, ["deg" "degree" "degrees" "°"];
        "rad" 1.0, 1.0, 0.0, true, ["rad" "radian" "radians"];
    LENGTH:
        "m" 1.0, 1.0, 0.0, false, ["m" "meter" "meters" "metre" "metres"];
        "km" 1000.0, 1.0, 0.0, false, ["km" "kilometers" "kilometres"];
        "ft" FOOT_M, 1.0, 0.0, false, ["ft" "feet" "foot"];
        "mi" MILE_M, 1.0, 0.0, false, ["mi" "mile" "miles"];
    FLAG:
        "-" 1.0, 1.0, 0.0, false, ["-" "1" "0_1" "bool" "boolean" "flag" "on_off"];
    TURNS:
        "rpm" std::f64::consts::PI, 30.0, 0.0, false, ["rpm" "1_min" "min_1" "u_min" "r_min" "rev_min" "revolutions_per_minute"];
        "rad/s" 1.0, 1.0, 0.0, false, ["rad_s"];
        "1/s" 2.0 * std::f64::consts::PI, 1.0, 0.0, false, ["hz" "1_s" "rps"];
    FUEL:
        "g/s" 1e-3, 1.0, 0.0, false, ["g_s" "g_sec" "gps"];
        "g/h" 1e-3, 3600.0, 0.0, false, ["g_h"];
        "kg/h" 1.0, 3600.0, 0.0, false, ["kg_h" "kg_hr"];
        "L/h" PETROL_KG_L, 3600.0, 0.0, false, ["l_h" "lph" "l_hr" "liter_h" "litre_h" "liters_per_hour" "litres_per_hour"];
        "gal/h" PETROL_KG_L * 3.785_411_784, 3600.0, 0.0, false, ["gal_h" "gph" "gal_hr" "gallons_per_hour"];
        "mL/min" PETROL_KG_L * 1e-3, 60.0, 0.0, false, ["ml_min" "cc_min"];
    TEMPERATURE:
        "degC" 1.0, 1.0, 0.0, false, ["°c" "degc" "deg_c" "c" "celsius" "℃"];
        "degF" 1.0, 1.8, -32.0, false, ["°f" "degf" "deg_f" "f" "fahrenheit"];
        "K" 1.0, 1.0, -273.15, false, ["k" "kelvin"];
}

/// A word of a name in camel case or with digits, in its parts.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        let begins = c.is_uppercase() && before.is_lowercase();
        match c.is_alphabetic() || c == '°' {
            true if begins || !before.is_alphabetic() => words.push(c.to_lowercase().collect()),
            true => words
                .last_mut()
                .map(|word| word.extend(c.to_lowercase()))
                .unwrap_or_default(),
            false => {}
        }
        before = c;
    }
    words
}

const TIMES: [&str; 32] = [
    "datum",
    "uhrzeit",
    "fecha",
    "hora",
    "heure",
    "ts",
    "unix",
    "utc",
    "time",
    "times",
    "t",
    "timestamp",
    "timestamps",
    "stamp",
    "elapsed",
    "clock",
    "offset",
    "datetime",
    "date",
    "zeit",
    "temps",
    "tiempo",
    "sec",
    "secs",
    "second",
    "seconds",
    "ms",
    "millis",
    "milliseconds",
    "cycsecs",
    "epoch",
    "uptime",
];
const SPEEDS: [&str; 18] = [
    "speed",
    "spd",
    "velocity",
    "velocities",
    "vel",
    "v",
    "vehspd",
    "vspd",
    "geschwindigkeit",
    "vitesse",
    "velocidad",
    "kph",
    "kmh",
    "mph",
    "mps",
    "vss",
    "sog",
    "vehspeed",
];
/// Words of another thing that turns, blows or is meant.
const NOT_SPEED: [&str; 31] = [
    "engine",
    "motor",
    "rpm",
    "wind",
    "fan",
    "turbine",
    "turbo",
    "idle",
    "input",
    "output",
    "shaft",
    "pump",
    "limit",
    "set",
    "desired",
    "wheel",
    "primary",
    "secondary",
    "pulley",
    "gear",
    "compressor",
    "crank",
    "blower",
    "eng",
    "accuracy",
    "air",
    "max",
    "diff",
    "crankshaft",
    "mass",
    "volt",
];
/// Words of what does not rise while the clock goes, or is counted anew.
const NOT_TIME: [&str; 9] = [
    "zone",
    "idle",
    "gps_fix",
    "stop",
    "response",
    "injection",
    "delay",
    "ignition",
    "advance",
];

impl Quantity {
    /// All, with the name that `--columns` takes.
    pub const ALL: [(Quantity, &'static str); 13] = [
        (Quantity::Time, "time"),
        (Quantity::Speed, "speed"),
        (Quantity::Grade, "grade"),
        (Quantity::Altitude, "altitude"),
        (Quantity::EngineOn, "engine_on"),
        (Quantity::EngineOff, "engine_off"),
        (Quantity::Phase, "phase"),
        (Quantity::EngineSpeed, "engine_speed"),
        (Quantity::Fuel, "fuel"),
        (Quantity::Coolant, "coolant"),
        (Quantity::EngineOil, "engine_oil"),
        (Quantity::Sump, "sump"),
        (Quantity::Ambient, "ambient"),
    ];

    /// Name that `--columns` takes.
    #[must_use]
    pub fn name(self) -> &'static str {
        let own = Quantity::ALL.iter().find(|(quantity, _)| *quantity == self);
        own.map_or("", |(_, name)| name)
    }

    fn table(self) -> &'static [(Unit, &'static [&'static str])] {
        match self {
            Quantity::Time => TIME,
            Quantity::Speed => SPEED,
            Quantity::Grade => GRADE,
            Quantity::Altitude => LENGTH,
            Quantity::EngineOn | Quantity::EngineOff => FLAG,
            Quantity::Phase => &[],
            Quantity::EngineSpeed => TURNS,
            Quantity::Fuel => FUEL,
            Quantity::Coolant | Quantity::EngineOil | Quantity::Sump | Quantity::Ambient => {
                TEMPERATURE
            }
        }
    }

    /// Units in which it is read; none of a flag and of words.
    #[must_use]
    pub fn units(self) -> Vec<&'static str> {
        self.table().iter().map(|(unit, _)| unit.name).collect()
    }

    /// True if a number needs a unit.
    pub(crate) fn needs_unit(self) -> bool {
        !matches!(
            self,
            Quantity::EngineOn | Quantity::EngineOff | Quantity::Phase
        )
    }

    /// The unit of this quantity that a text means, with brackets or without.
    pub(crate) fn unit(self, text: &str) -> Option<Unit> {
        let inner = text.trim();
        let inner = inner.strip_prefix(['[', '(', '<']).unwrap_or(inner);
        let inner = inner.strip_suffix([']', ')', '>']).unwrap_or(inner).trim();
        let bare = bare(inner);
        let named = |(unit, written): &&(Unit, &[&str])| {
            unit.name == inner || written.contains(&bare.as_str()) || written.contains(&inner)
        };
        self.table().iter().find(named).map(|(unit, _)| *unit)
    }

    /// First unit: that of a flag, or a degree Celsius.
    pub(crate) fn plain_unit(self) -> Option<Unit> {
        self.table().first().map(|(unit, _)| *unit)
    }

    /// Another word for it, as a user may write it before `=`.
    pub(crate) fn from_word(word: &str) -> Option<Quantity> {
        let bare = bare(word);
        let named = Quantity::ALL.iter().find(|(_, name)| *name == bare);
        match named {
            Some((quantity, _)) => Some(*quantity),
            None => Quantity::of_name(word),
        }
    }

    /// Quantity that the name of a channel means.
    #[must_use]
    pub(crate) fn of_name(name: &str) -> Option<Quantity> {
        let words = words(name);
        let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
        let is_oil = has(&["oil"]);
        let is_box = has(&[
            "transmission",
            "cvt",
            "gearbox",
            "trans",
            "atf",
            "cvtf",
            "sump",
        ]);
        let is_degrees = has(&[
            "temperature",
            "temp",
            "degc",
            "degf",
            "ect",
            "°c",
            "eot",
            "aat",
            "oat",
        ]) || is_oil;
        if has(&["coolant", "ect"]) {
            return Some(Quantity::Coolant);
        }
        if is_degrees && is_box || has(&["sump", "atf", "cvtf"]) {
            return Some(Quantity::Sump);
        }
        if is_oil && !has(&["pressure", "press", "life", "level"]) {
            return Some(Quantity::EngineOil);
        }
        if has(&["oat", "aat"]) || is_degrees && has(&["ambient", "outside", "outdoor"]) {
            return Some(Quantity::Ambient);
        }
        if is_degrees {
            return None;
        }
        let bare = bare(name);
        let begins = |list: &[&str]| list.iter().any(|start| bare.starts_with(start));
        if begins(&["engine_off", "engineoff"]) {
            return Some(Quantity::EngineOff);
        }
        if begins(&[
            "engine_on",
            "engineon",
            "engine_running",
            "engine_state_on",
            "engine_run_flag",
        ]) {
            return Some(Quantity::EngineOn);
        }
        if has(&[
            "grade",
            "gradient",
            "slope",
            "grad",
            "incline",
            "inclination",
            "steigung",
            "pitch",
        ]) {
            return Some(Quantity::Grade);
        }
        if has(&["altitude", "elevation", "alt", "ele", "elev"]) {
            return Some(Quantity::Altitude);
        }
        let is_flow = || {
            bare.strip_prefix("fuel_")
                .is_some_and(|unit| Quantity::Fuel.unit(unit).is_some())
        };
        if has(&["fuel"])
            && (has(&["rate", "flow", "consumption", "h", "lph", "gps", "gph"]) || is_flow())
        {
            return Some(Quantity::Fuel);
        }
        if has(&["rpm", "cranking"]) && !has(SPEED_OF_BOX)
            || has(&["engine", "eng"]) && has(&["speed", "speeds", "spd", "n"])
        {
            return Some(Quantity::EngineSpeed);
        }
        if has(&["phase", "bag"]) {
            return Some(Quantity::Phase);
        }
        if has(&SPEEDS) && !has(&NOT_SPEED) {
            return Some(Quantity::Speed);
        }
        // A name of two words that means a time and a speed means the speed.
        (has(&TIMES) && !has(&NOT_TIME)).then_some(Quantity::Time)
    }
}

/// Words of shafts that are not the engine's.
const SPEED_OF_BOX: &[&str] = &[
    "wheel",
    "primary",
    "secondary",
    "pulley",
    "turbine",
    "input",
    "output",
    "shaft",
    "motor",
    "fan",
    "pump",
    "turbo",
];

/// True if the name of a column says that it numbers or names cars, drives or devices.
pub(crate) fn is_identity(name: &str) -> bool {
    const WORDS: [&str; 6] = ["id", "vehid", "vehicleid", "tripid", "trip", "vin"];
    const NAMES: [&str; 10] = [
        "car", "driver", "session", "journey", "device", "veh", "vehicle", "drive", "route", "run",
    ];
    /// Trip computers count these.
    const COUNTED: [&str; 11] = [
        "distance",
        "fuel",
        "average",
        "avg",
        "time",
        "type",
        "consumption",
        "odometer",
        "speed",
        "meter",
        "economy",
    ];
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_name = NAMES.contains(&bare(name).as_str());
    Quantity::of_name(name).is_none() && (is_name || has(&WORDS)) && !has(&COUNTED)
}
