//! The tests of the transmission rig as one JSON object.

use cvtcycle::model::bench::transmission::{Branch, Loop, Moment, Piece};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::output::rig::{steady_columns, strip_columns, transient_columns, two_box_columns};
use cvtcycle::output::table::json_rows;
use serde_json::{Map, Value, json};

use super::tables::{MEETING_NM, Range, ranges};
use super::{RigPlan, RigResults};

/// All results; transients every 5 K, while the CSV file has every second.
pub fn summary(plan: &RigPlan, found: &RigResults, failed: &[String]) -> Value {
    let mut all = Map::new();
    all.insert("command".into(), json!("rig transmission"));
    all.insert("vehicle".into(), json!(plan.setup.name));
    all.insert("lubricant".into(), json!(plan.setup.oils().0.name));
    all.insert("formulation".into(), json!(plan.formulation));
    all.insert("set".into(), json!(plan.set));
    let range = |r: &Range| json!({ "from": number(r.low), "to": number(r.high) });
    if !found.steady.is_empty() {
        let of = |ratio: &f64| {
            let r = ranges(&found.steady, *ratio);
            json!({ "ratio": ratio, "torque_loss_nm": range(&r.0), "secondary_pressure_bar": range(&r.1) })
        };
        let ranges: Vec<Value> = plan.points.ratios.iter().map(of).collect();
        all.insert(
            "steady".into(),
            json!({ "ranges": ranges, "points": json_rows(&steady_columns(), &found.steady) }),
        );
    }
    if !found.loaded.is_empty() {
        all.insert(
            "loaded".into(),
            json!({ "points": json_rows(&steady_columns(), &found.loaded) }),
        );
    }
    if !found.strip_down.is_empty() {
        let all_pieces = found
            .strip_down
            .iter()
            .flat_map(|s| Piece::ALL.map(|p| s.piece(p).remainder_nm().abs()));
        let largest = all_pieces.fold(0.0, |a, b| if b > a { b } else { a });
        let points = json_rows(&strip_columns(), &found.strip_down);
        all.insert(
            "strip_down".into(),
            json!({ "largest_remainder_nm": number(largest), "points": points }),
        );
    }
    if !found.loops.is_empty() {
        all.insert(
            "transient".into(),
            found.loops.iter().map(transient).collect(),
        );
    }
    if !found.second_box.is_empty() {
        let differences = || {
            found
                .second_box
                .iter()
                .map(cvtcycle::model::bench::transmission::TwoBoxes::difference_nm)
        };
        let mean = differences().sum::<f64>() / found.second_box.len() as f64;
        let points = json_rows(&two_box_columns(), &found.second_box);
        all.insert(
            "second_box".into(),
            json!({ "mean_difference_nm": number(mean), "points": points }),
        );
    }
    all.insert("failed_checks".into(), json!(failed));
    Value::Object(all)
}

fn number(x: f64) -> Value {
    serde_json::Number::from_f64(x).map_or(Value::Null, Value::Number)
}

fn transient(l: &Loop) -> Value {
    let mut rows: Vec<(f64, Moment)> = Vec::new();
    for branch in [Branch::Warming, Branch::Cooling] {
        let mut due: Option<i64> = None;
        for m in l.moments.iter().filter(|m| m.branch == branch) {
            let step = ((m.sump_k - ZERO_DEGC_K) / 5.0).floor() as i64;
            if due != Some(step) {
                rows.push((l.ratio, *m));
                due = Some(step);
            }
        }
    }
    let widest = l.widest();
    json!({
        "ratio": l.ratio,
        "complete": l.complete,
        "widest_gap_nm": widest.map(|(gap, _)| gap),
        "widest_gap_degc": widest.map(|(_, k)| k - ZERO_DEGC_K),
        "meeting_degc": l.meeting_k(MEETING_NM).map(|k| k - ZERO_DEGC_K),
        "energy_kj": {
            "shaft": l.energy.shaft_j / 1e3, "stored": l.energy.stored_j / 1e3,
            "to_air": l.energy.to_air_j / 1e3, "to_cooler": l.energy.to_cooler_j / 1e3,
        },
        "energy_error": number(l.energy.error()),
        "points": json_rows(&transient_columns(), &rows),
    })
}
