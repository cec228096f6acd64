//! Losses as tables.

use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::losses::{Axis, LossRow, LossTable};
use cvtcycle::output::number::{NONE, fixed, percent};
use cvtcycle::output::table::{TextColumns, TextTable, wrapped};

use crate::print::colour::Paint;

/// Maximum number of rows of a table; CSV and JSON have all.
const MAX_ROWS: usize = 100;

/// Details of a single point, or one row for each point.
pub fn table(losses: &LossTable, mut rows: impl Iterator<Item = LossRow>, paint: Paint) -> String {
    let heading = paint.heading(&losses.setup.name);
    let body = match losses.grid.len() {
        1 => rows
            .next()
            .map_or_else(String::new, |row| one(losses, &row)),
        _ => several(losses, rows),
    };
    format!("{heading}  {}\n{body}", losses.setup.title)
}

fn one(losses: &LossTable, row: &LossRow) -> String {
    let (w, total) = (row.point.input_rad_s, row.answer.total_nm());
    let components = losses.components().into_iter();
    let parts = components.map(|part| (part.title(), row.answer.part_nm(part)));
    let parts: Vec<(&str, f64)> = parts.chain([("All losses", total)]).collect();
    let columns = TextColumns::new()
        .left("", |part: &(&str, f64)| part.0)
        .number("Nm at input", 3, |(_, nm)| *nm)
        .number("W", 1, |(_, nm)| nm * w)
        .right("% of loss", |(_, nm)| percent(*nm, total, 1));
    let held = losses.values_in_words(&row.requested, &Axis::ALL);
    let (held, table) = (wrapped(&held, ""), columns.text(&parts));
    format!("{held}\n{table}\n{}", state(losses, row))
}

fn state(losses: &LossTable, row: &LossRow) -> String {
    let a = &row.answer;
    let mut table = TextTable::new("lrl").indented();
    table.row(["Input torque", &fixed(a.input_nm, 3), "Nm"]);
    table.row(["Input power", &fixed(row.input_w(), 1), "W"]);
    table.row(["Output power", &fixed(row.output_w(), 1), "W"]);
    table.row(["Efficiency", &percent(row.efficiency(), 1.0, 2), "%"]);
    if losses.is_cvt() {
        let given =
            |axis: Axis, otherwise: &'static str| match row.requested[axis as usize].is_nan() {
                true => otherwise,
                false => "as given",
            };
        let pressure = fixed(a.secondary_pa / 1e5, 2);
        let belt = fixed(a.belt_k - ZERO_DEGC_K, 1);
        let law = format!("bar, {}", given(Axis::Pressure, "from the clamping law"));
        let steady = format!("\u{b0}C, {}", given(Axis::Belt, "in steady state"));
        table.row(["Secondary pressure", &pressure, &law]);
        table.row(["Belt and spray", &belt, &steady]);
        table.row(["Belt slip", &percent(row.slip(), 1.0, 3), "%"]);
        table.row(["Clamp safety", &fixed(row.clamp_safety(), 2), ""]);
    }
    let flags = flags(row);
    let flags = if flags.is_empty() { NONE } else { &flags };
    table.row(["Flags", flags, ""]);
    table.text()
}

fn flags(row: &LossRow) -> String {
    row.answer.flags.names().collect::<Vec<_>>().join("|")
}

fn several(losses: &LossTable, mut rows: impl Iterator<Item = LossRow>) -> String {
    let (cvt, varied) = (losses.is_cvt(), losses.grid.varied());
    let mut columns: TextColumns<LossRow> = TextColumns::new();
    for &axis in &varied {
        columns = columns.right(axis.short(cvt), move |row| {
            axis.text(row.requested[axis as usize])
        });
    }
    if cvt && !varied.contains(&Axis::Pressure) {
        columns = columns.number("bar", 1, |row| row.answer.secondary_pa / 1e5);
    }
    for (name, parts) in losses.groups() {
        // The last word of a name is short and unique.
        let head = name.rsplit(' ').next().unwrap_or(&name).to_lowercase();
        columns = columns.number(head, 2, move |row| {
            parts
                .iter()
                .map(|part| row.answer.part_nm(*part))
                .sum::<f64>()
        });
    }
    let columns = columns
        .number("all", 2, |row| row.answer.total_nm())
        .right("eff %", |row| percent(row.efficiency(), 1.0, 1))
        .left("flags", flags);
    let shown: Vec<LossRow> = rows.by_ref().take(MAX_ROWS).collect();
    // Solves the remaining rows too, so that their flags are counted.
    let more = rows.count();
    let fixed = Axis::ALL.into_iter().filter(|axis| !varied.contains(axis));
    let fixed: Vec<Axis> = fixed.collect();
    let held = losses.values_in_words(&losses.grid.at(0), &fixed);
    let table = columns.text(&shown);
    let head = wrapped(&format!("{held}; losses in Nm at the input shaft"), "");
    let mut text = format!("{head}\n{table}");
    if more > 0 {
        text += &format!("\n{more} more points; --format csv or --json prints all\n");
    }
    text
}
