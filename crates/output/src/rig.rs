//! Tables of the transmission rig's tests.

use cvtcycle_model::keys::RAD_S;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::rig::transmission::{
    self as rig, Branch, Conditions, Loop, Moment, Piece, Plan, Stage, SteadyPoint, StripDown,
    TwoBoxes,
};
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint};
use serde_json::{Map, Value, json};

use crate::number::fixed;
use crate::table::{Cell, Column, csv_bytes, json_rows};
use crate::trace::bar;
use crate::{Component, Flags, columns};

/// Distance below which branches count as met, Nm: well within the error of the torque transducer.
pub const MEETING_NM: f64 = 0.1;
/// Maximum relative error of the energy balance of a transient.
const MAX_ENERGY_ERROR: f64 = 1e-9;

/// Rounds off the error of converting a user's number to SI and back.
pub fn given(x: f64) -> f64 {
    (x * 1e9).round() / 1e9 + 0.0
}

/// Input speed, rpm.
pub fn rpm(set: &BenchPoint) -> f64 {
    given(set.input_rad_s * RAD_S)
}

/// Bulk oil, degC.
pub fn oil_degc(set: &BenchPoint) -> f64 {
    given(set.sump_k - ZERO_DEGC_K)
}

/// Minimum and maximum of some numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Smallest.
    pub low: f64,
    /// Largest.
    pub high: f64,
}

impl Range {
    /// Range of the finite values; inverted with infinite ends if there are none.
    pub fn over(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|x| x.is_finite());
        let empty = Range {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        finite.fold(empty, |r, x| Range {
            low: r.low.min(x),
            high: r.high.max(x),
        })
    }

    /// Formats both ends with fixed decimals.
    pub fn text(self, decimals: usize) -> String {
        if self.low > self.high {
            return crate::number::NONE.to_owned();
        }
        let [low, high] = [self.low, self.high].map(|x| fixed(x, decimals));
        format!("{low} to {high}")
    }

    fn json(self) -> Value {
        json!({ "from": self.low, "to": self.high })
    }
}

/// True if two ratios or test points are the same.
pub fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Ranges of torque loss, Nm, and pressure, bar, at a ratio.
pub fn ranges(points: &[SteadyPoint], ratio: f64) -> (Range, Range) {
    let on = || points.iter().filter(|p| is_near(p.set.ratio, ratio));
    let losses = on().map(|p| p.answer.total_nm());
    let pressures = on().map(|p| bar(p.answer.secondary_pa));
    (Range::over(losses), Range::over(pressures))
}

/// A test of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RigTest {
    /// Torque loss without load.
    Steady,
    /// Torque loss under load.
    Loaded,
    /// Components removed one after the other.
    StripDown,
    /// Warmed and cooled.
    Transient,
    /// A second transmission at a lower pressure.
    SecondBox,
}

impl RigTest {
    /// Names in the order in which the tests run.
    pub const NAMES: [(&'static str, RigTest); 5] = [
        ("steady", RigTest::Steady),
        ("loaded", RigTest::Loaded),
        ("strip_down", RigTest::StripDown),
        ("transient", RigTest::Transient),
        ("second_box", RigTest::SecondBox),
    ];
}

/// Results of the tests; empty for tests that did not run.
#[derive(Debug, Default)]
pub struct RigResults {
    /// Without load.
    pub steady: Vec<SteadyPoint>,
    /// Under load.
    pub loaded: Vec<SteadyPoint>,
    /// Strip-down.
    pub strip_down: Vec<StripDown>,
    /// Transients by ratio.
    pub loops: Vec<Loop>,
    /// Two transmissions.
    pub second_box: Vec<TwoBoxes>,
}

impl RigResults {
    /// Runs one test, or all of them.
    pub fn run(bench: &Bench, c: &Conditions, points: &Plan, test: Option<RigTest>) -> Self {
        let mut found = RigResults::default();
        for (_, own) in RigTest::NAMES {
            match own {
                own if test.is_some_and(|test| test != own) => {}
                RigTest::Steady => found.steady = rig::steady(bench, c, points),
                RigTest::Loaded => found.loaded = rig::loaded(bench, c, points),
                RigTest::StripDown => found.strip_down = rig::strip_down(bench, c, points),
                RigTest::Transient => {
                    let ratios = points.ratios.iter();
                    found.loops = ratios
                        .map(|ratio| rig::transient(bench, c, *ratio))
                        .collect();
                }
                RigTest::SecondBox => found.second_box = rig::second_box(bench, c, points),
            }
        }
        found
    }

    /// Iterates over all solved operating points.
    pub fn answers(&self) -> impl Iterator<Item = &BenchAnswer> {
        let steady = self.steady.iter().chain(&self.loaded).map(|p| &p.answer);
        let boxes = self.second_box.iter();
        let boxes = boxes.flat_map(|t| [&t.first.answer, &t.second.answer]);
        let stages = self.strip_down.iter().flat_map(|s| &s.stages);
        let moments = self.loops.iter().flat_map(|l| &l.moments);
        steady
            .chain(boxes)
            .chain(stages)
            .chain(moments.map(|m| &m.answer))
    }

    /// Number of points with a flag.
    pub fn flagged(&self, flag: Flags) -> usize {
        self.answers().filter(|a| a.flags.contains(flag)).count()
    }

    /// Largest remainder of the strip-down after true loss and interaction, Nm.
    pub fn largest_remainder_nm(&self) -> f64 {
        let remainders = |s: &StripDown| Piece::ALL.map(|p| s.piece(p).remainder_nm().abs());
        let pieces = self.strip_down.iter().flat_map(remainders);
        pieces.fold(0.0, |a, b| if b > a { b } else { a })
    }

    /// One line for each failed check.
    pub fn failures(&self, conditions: &Conditions) -> Vec<String> {
        let mut failed = Vec::new();
        let unsolved = self.flagged(Flags::NOT_CONVERGED);
        if unsolved > 0 {
            failed.push(format!(
                "check failed: {unsolved} operating points without a solution"
            ));
        }
        let [start, end] =
            [conditions.transient.start_k, conditions.transient.end_k].map(|k| k - ZERO_DEGC_K);
        for l in &self.loops {
            let (name, error) = (conditions.ratio_name(l.ratio), l.energy.error());
            if !l.complete {
                failed.push(format!(
                    "check failed: the transient at {name} stops on its way from {start:.0} to {end:.0} degC and back"
                ));
            }
            let balanced = error.abs() <= MAX_ENERGY_ERROR;
            if !balanced {
                failed.push(format!(
                    "check failed: heat of the transient at {name} does not balance: relative error {error:.0e}"
                ));
            }
        }
        failed
    }

    /// Name and CSV of the table of each test that ran.
    pub fn tables(&self) -> Vec<(&'static str, Vec<u8>)> {
        let moments = |l: &Loop| l.moments.iter().map(|m| (l.ratio, *m)).collect::<Vec<_>>();
        let moments: Vec<(f64, Moment)> = self.loops.iter().flat_map(moments).collect();
        let strip_down = csv_bytes(&strip_columns(), &self.strip_down);
        let second_box = csv_bytes(&two_box_columns(), &self.second_box);
        let tables = [
            ("steady.csv", csv_bytes(&steady_columns(), &self.steady)),
            ("loaded.csv", csv_bytes(&steady_columns(), &self.loaded)),
            ("strip_down.csv", strip_down),
            ("transient.csv", csv_bytes(&transient_columns(), &moments)),
            ("second_box.csv", second_box),
        ];
        let with_rows = tables.into_iter();
        with_rows
            .filter_map(|(name, bytes)| Some((name, bytes?)))
            .collect()
    }

    /// All results as entries of a JSON object; transients every 5 K, while the CSV file has every second.
    pub fn json(&self, points: &Plan) -> Map<String, Value> {
        let ranges_json = |ratio: &f64| {
            let (loss, pressure) = ranges(&self.steady, *ratio);
            json!({ "ratio": ratio, "torque_loss_nm": loss.json(), "secondary_pressure_bar": pressure.json() })
        };
        let ranges: Vec<Value> = points.ratios.iter().map(ranges_json).collect();
        let sum: f64 = self.second_box.iter().map(TwoBoxes::difference_nm).sum();
        let mean = sum / self.second_box.len() as f64;
        let steady = json_rows(&steady_columns(), &self.steady);
        let loaded = json_rows(&steady_columns(), &self.loaded);
        let strip_down = json_rows(&strip_columns(), &self.strip_down);
        let second_box = json_rows(&two_box_columns(), &self.second_box);
        let remainder = self.largest_remainder_nm();
        let mut all = Map::new();
        let mut add = |name: &str, is_empty: bool, entry: Value| {
            if !is_empty {
                all.insert(name.to_owned(), entry);
            }
        };
        let ranged = json!({ "ranges": ranges, "points": steady });
        add("steady", self.steady.is_empty(), ranged);
        let loaded = json!({ "points": loaded });
        add("loaded", self.loaded.is_empty(), loaded);
        let stripped = json!({ "largest_remainder_nm": remainder, "points": strip_down });
        add("strip_down", self.strip_down.is_empty(), stripped);
        let loops = self.loops.iter().map(loop_json).collect();
        add("transient", self.loops.is_empty(), loops);
        let compared = json!({ "mean_difference_nm": mean, "points": second_box });
        add("second_box", self.second_box.is_empty(), compared);
        all
    }
}

fn loop_json(l: &Loop) -> Value {
    let mut rows: Vec<(f64, Moment)> = Vec::new();
    for branch in [Branch::Warming, Branch::Cooling] {
        let step = |m: &&Moment| ((m.sump_k - ZERO_DEGC_K) / 5.0).floor() as i64;
        let on: Vec<&Moment> = l.moments.iter().filter(|m| m.branch == branch).collect();
        let steps = on.chunk_by(|a, b| step(a) == step(b));
        rows.extend(steps.map(|same| (l.ratio, *same[0])));
    }
    let (widest, energy) = (l.widest(), &l.energy);
    json!({
        "ratio": l.ratio,
        "complete": l.complete,
        "widest_gap_nm": widest.map(|(gap, _)| gap),
        "widest_gap_degc": widest.map(|(_, k)| k - ZERO_DEGC_K),
        "meeting_degc": l.meeting_k(MEETING_NM).map(|k| k - ZERO_DEGC_K),
        "energy_kj": {
            "shaft": energy.shaft_j / 1e3, "stored": energy.stored_j / 1e3,
            "to_air": energy.to_air_j / 1e3, "to_cooler": energy.to_cooler_j / 1e3,
        },
        "energy_error": energy.error(),
        "points": json_rows(&transient_columns(), &rows),
    })
}

/// Combines the flags of some answers.
fn union<'a>(answers: impl IntoIterator<Item = &'a BenchAnswer>) -> Flags {
    let flags = answers.into_iter().map(|answer| answer.flags.0);
    Flags(flags.fold(0, |all, flags| all | flags))
}

fn set_columns<T: 'static>(set: fn(&T) -> &BenchPoint) -> Vec<Column<T>> {
    columns! { T;
        number "ratio", "-", "belt ratio, held", row => set(row).ratio;
        number "input_speed_rpm", "rpm", "input speed, held", row => rpm(set(row));
        number "oil_degc", "degC", "bulk oil, held", row => oil_degc(set(row));
    }
}

fn part_columns<T: 'static>(answer: fn(&T) -> &BenchAnswer) -> Vec<Column<T>> {
    let name = |part: &str| format!("{part}_nm");
    let pieces = Piece::ALL.map(|piece| {
        Column::number(name(piece.name()), "Nm", "loss", move |row| {
            piece.loss_nm(answer(row))
        })
    });
    let belt = Component::ALL.into_iter().filter(|c| c.is_belt());
    let parts = belt.map(|part| {
        Column::number(part.columns().nm, "Nm", part.doc(), move |row| {
            answer(row).part_nm(part)
        })
    });
    let mut columns: Vec<Column<T>> = pieces.into_iter().chain(parts).collect();
    columns.extend(columns! { T;
        number "belt_degc", "degC", "belt and pulleys", row => answer(row).belt_k - ZERO_DEGC_K;
        words "flags", "", "states and departures from validity", row => Cell::Flags(answer(row).flags);
    });
    columns
}

/// Columns of the steady tests, with and without load.
fn steady_columns() -> Vec<Column<SteadyPoint>> {
    let mut columns = set_columns(|p: &SteadyPoint| &p.set);
    columns.extend(columns! { SteadyPoint;
        number "output_torque_nm", "Nm", "torque at the output shaft, held", p => p.set.output_nm;
        number "secondary_pressure_bar", "bar", "secondary pressure", p => bar(p.answer.secondary_pa);
        number "torque_loss_nm", "Nm", "all losses", p => p.answer.total_nm();
        number "input_torque_nm", "Nm", "torque at the input shaft", p => p.answer.input_nm;
        number "output_speed_rpm", "rpm", "speed of the output shaft", p => p.answer.output_rad_s * RAD_S;
        number "efficiency_percent", "%", "output over input power", p => efficiency_percent(p);
        number "slip_percent", "%", "belt slip", p => 100.0 * p.answer.belt.map_or(f64::NAN, |b| b.losses.slip_total);
    });
    columns.extend(part_columns(|p: &SteadyPoint| &p.answer));
    columns
}

/// Output over input power, %; NaN without output power.
fn efficiency_percent(p: &SteadyPoint) -> f64 {
    let out = p.set.output_nm * p.answer.output_rad_s;
    if out > 0.0 {
        100.0 * out / (p.answer.input_nm * p.set.input_rad_s)
    } else {
        f64::NAN
    }
}

/// Columns of the strip-down.
fn strip_columns() -> Vec<Column<StripDown>> {
    let mut columns = set_columns(|s: &StripDown| &s.set);
    for stage in Stage::ALL {
        columns.extend(columns! { StripDown;
            number format!("{}_loss_nm", stage.name()), "Nm", "all losses of this stage", s => s.stage(stage).total_nm();
            number format!("{}_pressure_bar", stage.name()), "bar", "secondary pressure of this stage", s => bar(s.stage(stage).secondary_pa);
        });
    }
    for piece in Piece::ALL {
        let name = |what: &str| format!("{}_{what}_nm", piece.name());
        columns.extend(columns! { StripDown;
            number name("difference"), "Nm", "difference of two stages", s => s.piece(piece).uncorrected_nm;
            number name("corrected"), "Nm", "the same, corrected for pressure and torque", s => s.piece(piece).corrected_nm;
            number name("true"), "Nm", "loss in the whole box", s => s.piece(piece).true_nm;
        });
        if matches!(piece, Piece::Belt | Piece::FinalDrive) {
            columns.extend(columns! { StripDown;
                number name("interaction_pressure"), "Nm", "effect of the pressure", s => s.piece(piece).by_pressure_nm;
                number name("interaction_torque"), "Nm", "effect of the torque", s => s.piece(piece).by_torque_nm;
            });
        }
        columns.extend(columns! { StripDown;
            number name("remainder"), "Nm", "what the corrections leave", s => s.piece(piece).remainder_nm();
        });
    }
    columns.extend(columns! { StripDown;
        words "flags", "", "flags of any stage", s => Cell::Flags(union(&s.stages));
    });
    columns
}

/// Columns of a second of a transient, with the ratio of its loop.
fn transient_columns() -> Vec<Column<(f64, Moment)>> {
    let mut columns = columns! { (f64, Moment);
        number "ratio", "-", "belt ratio, held", (ratio, _) => *ratio;
        text "branch", "", "warming or cooling", (_, m) => m.branch.word();
        number "time_s", "s", "time since the start", (_, m) => m.time_s;
        number "bulk_oil_degc", "degC", "bulk oil", (_, m) => m.sump_k - ZERO_DEGC_K;
        number "metal_degc", "degC", "case and shafts", (_, m) => m.metal_k - ZERO_DEGC_K;
        number "secondary_pressure_bar", "bar", "secondary pressure", (_, m) => bar(m.answer.secondary_pa);
        number "torque_loss_nm", "Nm", "all losses", (_, m) => m.answer.total_nm();
    };
    columns.extend(part_columns(|m: &(f64, Moment)| &m.1.answer));
    columns
}

/// Columns of the two boxes.
fn two_box_columns() -> Vec<Column<TwoBoxes>> {
    let mut columns = set_columns(|t: &TwoBoxes| &t.first.set);
    columns.extend(columns! { TwoBoxes;
        number "first_pressure_bar", "bar", "secondary pressure of the first box", t => bar(t.first.answer.secondary_pa);
        number "second_pressure_bar", "bar", "secondary pressure of the second box", t => bar(t.second.answer.secondary_pa);
        number "first_loss_nm", "Nm", "all losses of the first box", t => t.first.answer.total_nm();
        number "second_loss_nm", "Nm", "all losses of the second box", t => t.second.answer.total_nm();
        number "difference_nm", "Nm", "difference of both", t => t.difference_nm();
        words "flags", "", "flags of either box", t => Cell::Flags(union([&t.first.answer, &t.second.answer]));
    });
    columns
}
