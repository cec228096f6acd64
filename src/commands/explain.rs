//! `explain`: the meaning of a key, a column, a flag, an equation or a term of the field.

use clap::Args;
use cvtcycle::config::{KeyInfo, Override, Problems};
use cvtcycle::equations::{Equation, of_labels};
use cvtcycle::explain::{Meanings, plan_keys};
use cvtcycle::model::keys::Presence;
use cvtcycle::output::table::TextTable;

use super::Execute;
use super::show::value_row;
use crate::args::JsonArgs;
use crate::print::colour::Paint;
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Maximum length in the column of values.
const MAX_VALUE_LEN: usize = 24;
/// Arguments of `explain`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle explain transmission.cvt.belt.band_offset_mm
  cvtcycle explain displacement_cc_rev
  cvtcycle explain transmission.cvt.pump
  cvtcycle explain clamp_safety
  cvtcycle explain torque capacity
  cvtcycle explain SL-8
  cvtcycle explain calibration.starts

The end of a key is enough (band_offset_mm); for a table all of its keys are explained. A term of the field finds the keys, columns \
and flags that belong to it; other words find those whose meanings contain all of them.")]
pub struct ExplainArgs {
    /// Key, table, column of a trace or summary, flag, label of an equation, or words such as road load
    #[arg(value_name = "KEY", required = true)]
    key: Vec<String>,
    #[command(flatten)]
    output: JsonArgs,
}

impl Execute for ExplainArgs {
    type Plan = (String, Meanings);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        let word = self.key.join(" ").trim().to_owned();
        let found = Meanings::find(&word);
        let found = found.map_err(|problem| problem.in_file("explain").key("explain"));
        Some((word, problems.take(found)?))
    }

    fn run(&self, (word, meanings): Self::Plan, terminal: Terminal) -> CommandResult {
        if self.output.json {
            return CommandOutput::json(&meanings.json(&word));
        }
        Ok(CommandOutput::text(text(&meanings, terminal.stdout)))
    }
}

fn text(meanings: &Meanings, paint: Paint) -> String {
    let keys = meanings
        .keys
        .iter()
        .map(|(known, values)| key_text(known, values, paint));
    let columns = meanings.columns.iter().map(|(table, c)| {
        let what = format!("column of the {table}");
        let unit = or_none(&c.unit);
        let facts = [("what", &*what), ("meaning", &c.doc), ("unit", unit)];
        paragraph(&c.name, &facts, paint)
    });
    let flags = meanings.flags.iter().map(|(name, meaning)| {
        let what =
            "flag of a time step, in the column `flags`; seconds in `flags_s` of the summary";
        paragraph(name, &[("what", what), ("meaning", meaning)], paint)
    });
    let equation = meanings.equation.iter().map(|e| {
        let facts = [
            ("what", "equation of the model"),
            ("statement", &*e.statement.replace("\\|", "|")),
            ("status", e.status),
            ("module", e.module),
        ];
        paragraph(e.label, &facts, paint)
    });
    let all = keys.chain(columns).chain(flags).chain(equation);
    all.collect::<Vec<_>>().join("\n")
}

fn key_text(known: &KeyInfo, values: &[(&str, KeyInfo)], paint: Paint) -> String {
    let (meaning, unit) = (known.meaning(), or_none(&known.unit));
    let mut facts = vec![
        ("meaning", &*meaning),
        ("unit", unit),
        ("allowed", &*known.allowed),
    ];
    let equation = |e: &Equation| {
        let statement = e.statement.replace("\\|", "|");
        format!("{}: {statement} ({})", e.label, e.status)
    };
    let equations: Vec<String> = of_labels(known.labels).map(|e| equation(&e)).collect();
    let names = ["equation"].into_iter().chain(std::iter::repeat(""));
    facts.extend(names.zip(equations.iter().map(String::as_str)));
    if plan_keys().iter().any(|key| std::ptr::eq(key, known)) {
        facts.insert(0, ("what", "key of the plan of a study"));
        return paragraph(&known.key, &facts, paint);
    }
    let text = paragraph(&known.key, &facts, paint);
    if values.is_empty() {
        let default = default_text(known).map(|value| format!("; {value} by default"));
        let default = default.unwrap_or_default();
        return text + &format!("  not set in any built-in file{default}\n");
    }
    let mut table = TextTable::new("llll").indented();
    for (file, info) in values {
        table.row(value_row(file, info, MAX_VALUE_LEN, ""));
    }
    text + &table.text()
}

/// Default of a key with its unit.
fn default_text(known: &KeyInfo) -> Option<String> {
    let value = match Override::number(&known.key, 0.0).row()?.presence {
        Presence::Number(x) => x.to_string(),
        Presence::Integer(n) => n.to_string(),
        Presence::Flag(on) => on.to_string(),
        Presence::Word(word) => word.to_owned(),
        _ => return None,
    };
    Some(match or_none(&known.unit) {
        "none" => value,
        unit => format!("{value} {unit}"),
    })
}

fn or_none(unit: &str) -> &str {
    if matches!(unit, "" | "-") {
        "none"
    } else {
        unit
    }
}

fn paragraph(name: &str, facts: &[(&str, &str)], paint: Paint) -> String {
    let mut table = TextTable::new("ll").indented().min_widths(&[9]);
    for &(name, text) in facts {
        table.row([name, text]);
    }
    format!("{}\n{}", paint.heading(name), table.text())
}
