//! `check --physics`: drives each vehicle and checks forces, torques and heat by laws derived independently of the model.

use cvtcycle::config::Problems;
use cvtcycle::config::cycle::{self, Cycle};
use cvtcycle::config::setup::{self, AMBIENT, Options, Setup};
use cvtcycle::model::drive::{Finding, check_physics};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::table::TextColumns;
use serde_json::{Value, json};

use crate::args::problems::cite;
use crate::args::{JsonArgs, number};
use crate::print::{CommandOutput, CommandResult, Ending, Terminal, json_text, sections};

/// Time step of the drive, s.
const STEP_S: f64 = 1.0;

/// Checked input of `check --physics`.
pub struct PhysicsPlan {
    /// Vehicles with their names on the command line.
    vehicles: Vec<(String, Setup)>,
    cycle: Cycle,
    cycle_name: String,
    ambient_degc: f64,
}

/// Reads vehicles and cycle.
pub fn plan(
    words: &[String],
    (cycle_name, ambient): (&str, &str),
    problems: &mut Problems,
) -> Option<PhysicsPlan> {
    let load = |word: &String| {
        let found = setup::load(word, &Options::default()).map_err(|found| cite("FILE", found));
        Some((word.clone(), problems.take(found)?))
    };
    let vehicles = words.iter().filter_map(load).collect();
    let cycle = problems.take(cycle::find(cycle_name));
    let ambient_degc = problems.take(number("--ambient", ambient, AMBIENT, "ambient_degc"));
    Some(PhysicsPlan {
        vehicles,
        cycle: cycle?,
        cycle_name: cycle_name.to_owned(),
        ambient_degc: ambient_degc?,
    })
}

/// Drives the vehicles and prints the result of each law.
pub fn run(plan: &PhysicsPlan, form: JsonArgs, terminal: Terminal) -> CommandResult {
    let ambient_k = plan.ambient_degc + ZERO_DEGC_K;
    let vehicles = plan.vehicles.iter();
    let found = vehicles.map(|(word, setup)| {
        let cycle = cycle::for_car(&plan.cycle_name, plan.cycle.clone(), setup);
        (word, check_physics(setup, &cycle, ambient_k, STEP_S))
    });
    let found: Vec<(&String, Vec<Finding>)> = found.collect();
    let holds = |finding: &Finding| verdict(finding) != FAILS;
    let ending = match found.iter().all(|(_, findings)| findings.iter().all(holds)) {
        true => Ending::Success,
        false => Ending::CheckFailed,
    };
    let stdout = if form.json {
        let vehicles: Vec<Value> = found
            .iter()
            .map(|(word, findings)| {
                let checks: Vec<Value> = findings.iter().map(json_entry).collect();
                json!({ "vehicle": word, "checks": checks })
            })
            .collect();
        let (cycle, ambient_degc) = (&plan.cycle_name, plan.ambient_degc);
        json_text(&json!({ "cycle": cycle, "ambient_degc": ambient_degc, "vehicles": vehicles }))?
    } else {
        let heading =
            |word: &String| format!("{word} on {}, {} degC", plan.cycle_name, plan.ambient_degc);
        let tables = found
            .iter()
            .map(|(word, findings)| (heading(word), table(findings)));
        sections(tables, terminal.stdout)
    };
    Ok(CommandOutput {
        stdout,
        ending,
        ..CommandOutput::default()
    })
}

const FAILS: &str = "fails";

/// `holds`, `fails`, or `no row` if the law applies to none.
fn verdict(finding: &Finding) -> &'static str {
    match finding.rows {
        0 => "no row",
        _ if finding.holds() => "holds",
        _ => FAILS,
    }
}

/// Table with one line for each check.
fn table(findings: &[Finding]) -> String {
    let of_worst = |finding: &Finding, text: String| match finding.rows {
        0 => String::new(),
        _ => text,
    };
    TextColumns::new()
        .left("check", |finding: &Finding| finding.law.label())
        .left("verdict", verdict)
        .right("largest", move |f: &Finding| {
            of_worst(f, format!("{:.1e}", f.residual))
        })
        .right("bound", move |f: &Finding| {
            of_worst(f, format!("{:.1e}", f.bound))
        })
        .left("", |finding: &Finding| finding.law.unit())
        .right("at s", move |f: &Finding| {
            of_worst(f, format!("{}", f.at_s))
        })
        .right("steps", |finding: &Finding| finding.rows.to_string())
        .left("what is compared", |finding: &Finding| finding.law.doc())
        .text(findings)
}

fn json_entry(finding: &Finding) -> Value {
    let applies = finding.rows > 0;
    let number = |x: f64| applies.then_some(x).filter(|x| x.is_finite());
    json!({
        "check": finding.law.label(), "verdict": verdict(finding), "residual": number(finding.residual),
        "bound": number(finding.bound), "unit": finding.law.unit(), "at_s": number(finding.at_s), "steps": finding.rows,
        "compared": finding.law.doc(),
    })
}
