//! Savings of the levers as tables.

use cvtcycle::analysis::levers::{LeverAnswer, LeverBlock, LeverRow, answer_in_words};
use cvtcycle::output::number::{NONE, fixed, plain, signed};
use cvtcycle::output::table::{TextTable, wrapped};
use cvtcycle::study::answer::Ended;
use cvtcycle::study::execute::side_effects::{FLOOR, LUGGING};

use super::super::tables::MAX_REASONS;
use crate::print::colour::Paint;
use crate::print::{bold, sections};

/// Prints all results.
pub fn tables(answer: &LeverAnswer, (present, all): (usize, usize), paint: Paint) -> String {
    let mut text = bold(&answer.title, paint);
    text += &match &answer.plan {
        Some(plan) => {
            let runs = answer.draws;
            let words = format!("{runs} paired runs with the uncertain values of {plan} varied");
            wrapped(&words, "")
        }
        None => "the cars as their files have them; no value is varied\n".to_owned(),
    };
    if present < all {
        let (done, draws) = (answer.draws_done, answer.draws);
        text += &format!("not finished: {done} of {draws} runs\n");
    }
    let block = |block: &LeverBlock| {
        let ambient = plain(block.ambient_degc);
        let title = format!("{} at {ambient} degC", block.vehicle);
        let words = answer_in_words(answer, block);
        let words: String = words.iter().map(|line| wrapped(line, "")).collect();
        (title, format!("{words}\n{}", levers(answer, block)))
    };
    text += &sections(answer.blocks.iter().map(block), paint);
    if let Some(block) = answer.blocks.first() {
        text += &sections([("What they take", needs(block))], paint);
    }
    let (heard, draws) = (plain(answer.heard_rpm), answer.confidence.draws_percent());
    let legend = format!(
        "% fuel: median; {draws} %: of these runs; g/km: carbon dioxide, median. The worst of all runs: safety of the clamp; seconds with a floor of the \
         pressure (floor), with too little flow (flow), and below {heard} rpm above half load with the clutch closed (slow). `!`: runs that fail a \
         check, which are left out."
    );
    text += &format!("\n{}", wrapped(&legend, ""));
    if answer.plan.is_some() {
        let doubts = answer.enough.doubts(answer.confidence);
        text.extend(doubts.iter().map(|doubt| wrapped(doubt, "note: ")));
    }
    text.extend(answer.notes.iter().map(|note| wrapped(note, "note: ")));
    text + &left_out(&answer.runs)
}

/// Runs left out, with their reasons.
fn left_out(runs: &Ended) -> String {
    let bad = runs.failed + runs.not_run;
    if bad == 0 {
        return String::new();
    }
    let reasons = runs.reasons.iter().take(MAX_REASONS);
    let reasons: Vec<String> = reasons
        .map(|(reason, n)| format!("{n} x {reason}"))
        .collect();
    let all = runs.ok + bad;
    let note = format!(
        "{bad} of {all} runs fail a check and are left out: {}",
        reasons.join(", ")
    );
    wrapped(&note, "note: ")
}

fn levers(answer: &LeverAnswer, block: &LeverBlock) -> String {
    let mut table = TextTable::new("lrrrrrrrr");
    let draws = format!("{} %", answer.confidence.draws_percent());
    table.row([
        "lever", "% fuel", &draws, "saves in", "g/km", "safety", "floor", "flow", "slow",
    ]);
    for row in &block.rows {
        let worst = |name: &str, decimals| fixed(row.worst(name), decimals);
        table.row([
            marked(row),
            signed(row.fuel_percent.value, 2),
            range(answer, row),
            saves(answer, row),
            signed(row.co2_g_per_km, 1),
            worst("min_clamp_safety", 2),
            worst(FLOOR, 0),
            worst("flow_limited_s", 0),
            worst(LUGGING, 0),
        ]);
    }
    table.text()
}

/// Name, with the number of failed runs.
fn marked(row: &LeverRow) -> String {
    match row.failed {
        0 => row.of.name.clone(),
        failed => format!("{} !{failed}", row.of.name),
    }
}

fn range(answer: &LeverAnswer, row: &LeverRow) -> String {
    if answer.plan.is_none() || row.n == 0 {
        return NONE.to_owned();
    }
    let [low, high] = [row.low_percent, row.high_percent].map(|end| signed(end.value, 2));
    format!("{low} {high}")
}

fn saves(answer: &LeverAnswer, row: &LeverRow) -> String {
    match answer.plan {
        Some(_) => format!("{} of {}", row.saves.k, row.saves.n),
        None => NONE.to_owned(),
    }
}

/// Requirements of each lever, and the basis of its size.
fn needs(block: &LeverBlock) -> String {
    let single = block.rows.iter().filter(|row| !row.is_combination());
    let line = |row: &LeverRow| {
        let lever = &row.of;
        let needs = match lever.needs.as_str() {
            "" => String::new(),
            needs => format!("; {needs}"),
        };
        let status = &lever.status;
        wrapped(
            &format!("{}: {}{needs} [{status}]", lever.name, lever.title),
            "",
        )
    };
    single.map(line).collect()
}
