//! Inputs of a run: command, files with their hashes, every value with its status, and the sensitivity to each.
//!
//! Written as `inputs.json` next to the summary, so that a report needs only the directory.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::files::{Sums, hex, sha256};
use crate::{BUILD, PROGRAM};

/// Version of the object; a new number when a name goes or changes its meaning.
pub const SCHEMA: u32 = 1;
/// Name of the file.
pub const FILE: &str = "inputs.json";

/// Origin of a result: the first entries of every JSON file of results.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the file's form; a new number when a name goes or changes its meaning.
    pub schema: u32,
    /// Kind of the file's directory, where the file records it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// Name and version of the program.
    pub program: String,
    /// Build of the program: [`BUILD`]. Empty in files of versions without builds.
    #[serde(default)]
    pub build: String,
    /// Run that the file belongs to: equal inputs and numbers have one [`run_word`]. Empty in files of versions without it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub run: String,
}

impl Manifest {
    /// Creates the manifest of this program for this version of a file's form.
    pub fn new(schema: u32) -> Self {
        Manifest {
            schema,
            kind: None,
            program: PROGRAM.to_owned(),
            build: BUILD.to_owned(),
            run: String::new(),
        }
    }

    /// Names the run by a hash of `inputs`, which must hold everything besides the manifest that identifies it.
    #[must_use]
    pub fn for_run(self, inputs: &impl Serialize) -> Self {
        let run = run_word(&(&self, inputs));
        Manifest { run, ..self }
    }

    /// Builds one JSON object: these entries, then those of `rest`.
    pub fn with(&self, rest: &impl Serialize) -> Value {
        #[derive(Serialize)]
        struct Whole<'a, T> {
            #[serde(flatten)]
            manifest: &'a Manifest,
            #[serde(flatten)]
            rest: &'a T,
        }
        serde_json::to_value(Whole {
            manifest: self,
            rest,
        })
        .unwrap_or_default()
    }
}

/// Length of the word that names a run.
const RUN_DIGITS: usize = 16;

/// Name of a run in all its files: a hash of its inputs or results.
pub fn run_word(inputs: &impl Serialize) -> String {
    let text = serde_json::to_vec(inputs).unwrap_or_default();
    let mut word = hex(&sha256(&text));
    word.truncate(RUN_DIGITS);
    word
}

/// All inputs of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version [`SCHEMA`] of this object, and the program.
    #[serde(flatten)]
    pub manifest: Manifest,
    /// The command line, quoted for a shell.
    pub command: String,
    /// The cycle.
    pub cycle: CycleRecord,
    /// The cars, the subject first.
    pub cars: Vec<CarRecord>,
    /// Sensitivity to each value; `None` unless requested.
    pub sensitivity: Option<Sensitivity>,
    /// SHA-256 of the other files that were written with it, by their names.
    #[serde(default, skip_serializing_if = "Sums::is_empty")]
    pub files: Sums,
}

impl Record {
    /// Tests that a file of that name belongs to this run. Records of early versions list no files and accept any name.
    pub fn has_file(&self, name: &str) -> bool {
        self.files.is_empty() || self.files.contains_key(name)
    }
}

/// A cycle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CycleRecord {
    /// Name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// SHA-256 of the traces as they were read.
    pub sha256: String,
    /// Path of its file, where nothing else says how it was read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// A file: its name and SHA-256.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Path, or `embedded:NAME.toml`.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

/// One car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarRecord {
    /// Name, unique within the run.
    pub name: String,
    /// Vehicle file.
    pub vehicle: FileRecord,
    /// Files that it inherits from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inherited: Vec<FileRecord>,
    /// Transmission oil.
    pub lubricant: FileRecord,
    /// Engine oil.
    pub engine_oil: FileRecord,
    /// SHA-256 of the whole checked car, with what its files name in turn.
    pub resolved_sha256: String,
    /// Shipped vehicle for comparison.
    pub reference: String,
    /// Number of values of that vehicle, and of those equal here.
    pub reference_values: (usize, usize),
    /// Differences from it.
    pub changes: Vec<Change>,
    /// Every value.
    pub values: Vec<ValueRecord>,
    /// The engine's fuel map, hot.
    pub fuel_map: FuelMapRecord,
    /// Engine speed against road speed: gears of a manual box, or limits and targets of a ratio control.
    pub speed_lines: Vec<SpeedLine>,
}

/// A value that differs from the shipped vehicle's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Dotted key.
    pub key: String,
    /// Unit, `-` for none.
    pub unit: String,
    /// Value there; empty where the key is not read.
    pub shipped: String,
    /// Value here; empty where the key is not read.
    pub here: String,
}

/// One value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValueRecord {
    /// Dotted key; `lubricant.` and `engine_oil.` for the fluids.
    pub key: String,
    /// Value in its unit.
    pub value: String,
    /// Unit, `-` for none.
    pub unit: String,
    /// `source`, `derived`, `fitted`, `assumed`, `user`, `set`, `default`, `choice`, `class` or `like`.
    pub status: String,
    /// Reference; may be empty.
    pub source: String,
    /// Meaning.
    pub doc: String,
}

/// An engine's fuel map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FuelMapRecord {
    /// Engine speeds.
    pub speed_rpm: Vec<f64>,
    /// Torques at the flywheel.
    pub torque_nm: Vec<f64>,
    /// Brake specific fuel consumption by speed and torque; null above full load.
    pub bsfc_g_kwh: Vec<Vec<Option<f64>>>,
    /// Full-load torque at each speed.
    pub full_load_nm: Vec<f64>,
}

/// Engine speed over road speed at some state of the transmission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLine {
    /// Name of the state.
    pub name: String,
    /// Road speed in km/h and engine speed in rpm.
    pub points: Vec<(f64, f64)>,
}

/// Sensitivity of the fuel to single values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Change of each value, up and down, per cent of it.
    pub step_percent: f64,
    /// By car, value by value.
    pub effects: Vec<Effect>,
}

/// Effect of a change of one value of one car on that car's fuel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Car.
    pub car: String,
    /// Dotted key.
    pub key: String,
    /// Change of the fuel with the value lowered, per cent; null where the lowered value is invalid.
    pub lowered_percent: Option<f64>,
    /// Change of the fuel with the value raised, per cent.
    pub raised_percent: Option<f64>,
}

impl Effect {
    /// Larger magnitude of both changes, per cent; NaN if both are missing.
    pub fn size_percent(&self) -> f64 {
        let both = [self.lowered_percent, self.raised_percent];
        let sizes = both.into_iter().flatten().map(f64::abs);
        sizes.fold(f64::NAN, |a, b| if a > b { a } else { b })
    }
}
