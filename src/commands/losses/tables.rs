//! Losses as tables.

use cvtcycle::output::losses::{Axis, LossRow, bench_components};
use cvtcycle::output::{Component, Flags};

use super::plan::LossesPlan;
use crate::print::colour::Paint;
use crate::print::table::{TextColumns, TextTable};
use cvtcycle::output::number::{NONE, fixed, percent, plain};

/// Largest number of rows of a table; CSV and JSON have all.
const MAX_ROWS: usize = 100;

/// One point in detail, or one row for each point.
pub fn table(plan: &LossesPlan, mut rows: impl Iterator<Item = LossRow>, paint: Paint) -> String {
    let heading = paint.heading(&plan.setup.name);
    let body = match plan.grid.len() {
        1 => rows.next().map_or_else(String::new, |row| one(plan, &row)),
        _ => several(plan, rows),
    };
    format!("{heading}  {}\n{body}", plan.setup.title)
}

/// Fixed values of a point in words.
pub fn held(plan: &LossesPlan, asked: &[f64; Axis::COUNT], axes: &[Axis]) -> String {
    let cvt = plan.is_cvt();
    let word = |axis: &Axis| {
        let x = axis_text(*axis, asked[*axis as usize]);
        match axis {
            Axis::Ratio if cvt => format!("ratio {x}"),
            Axis::Ratio => format!("gear {x}"),
            Axis::Sump => format!("sump {x} \u{b0}C"),
            Axis::Belt => format!("belt {x} \u{b0}C"),
            Axis::Throttle => format!("throttle {x}"),
            Axis::Pressure => format!("{x} bar"),
            Axis::Torque => format!("{x} Nm at the output"),
            Axis::Speed => format!("{x} rpm"),
        }
    };
    let given =
        |axis: &&Axis| !asked[**axis as usize].is_nan() && (cvt || **axis != Axis::Throttle);
    axes.iter()
        .filter(given)
        .map(word)
        .collect::<Vec<_>>()
        .join(", ")
}

fn flag_text(flags: Flags) -> String {
    flags.names().collect::<Vec<_>>().join("|")
}

fn one(plan: &LossesPlan, row: &LossRow) -> String {
    let (w, total) = (row.point.input_rad_s, row.answer.total_nm());
    let components = bench_components(plan.setup.transmission()).into_iter();
    let parts = components.map(|part| (part.title().to_owned(), row.answer.part_nm(part)));
    let parts: Vec<(String, f64)> = parts.chain([("All losses".to_owned(), total)]).collect();
    let losses = TextColumns::new()
        .left("", |part: &(String, f64)| part.0.clone())
        .right("Nm at input", |(_, nm)| fixed(*nm, 3))
        .right("W", |(_, nm)| fixed(nm * w, 1))
        .right("% of loss", |(_, nm)| percent(*nm, total, 1));
    let held = held(plan, &row.asked, &Axis::ALL);
    format!(
        "{held}\n\n{}\n{}",
        losses.table(&parts).indented().text(),
        state(plan, row)
    )
}

fn state(plan: &LossesPlan, row: &LossRow) -> String {
    let a = &row.answer;
    let mut lines = vec![
        ("Input torque", fixed(a.input_nm, 3), "Nm"),
        ("Input power", fixed(row.input_w(), 1), "W"),
        ("Output power", fixed(row.output_w(), 1), "W"),
        ("Efficiency", percent(row.efficiency(), 1.0, 2), "%"),
    ];
    if plan.is_cvt() {
        let by_law = row.asked[Axis::Pressure as usize].is_nan();
        let steady = row.asked[Axis::Belt as usize].is_nan();
        let pressure = if by_law {
            "bar, from the clamping law"
        } else {
            "bar, as given"
        };
        let belt = if steady {
            "\u{b0}C, in steady state"
        } else {
            "\u{b0}C, as given"
        };
        lines.extend([
            (
                "Secondary pressure",
                fixed(a.secondary_pa / 1e5, 2),
                pressure,
            ),
            ("Belt and spray", fixed(a.belt_k - 273.15, 1), belt),
            ("Belt slip", percent(row.slip(), 1.0, 3), "%"),
            ("Clamp safety", fixed(row.clamp_safety(), 2), ""),
        ]);
    }
    let flags = flag_text(a.flags);
    let flags = if flags.is_empty() {
        NONE.to_owned()
    } else {
        flags
    };
    lines.push(("Flags", flags, ""));
    let mut table = TextTable::new("lrl").indented();
    lines
        .iter()
        .for_each(|(name, value, unit)| table.row([name, value.as_str(), unit]));
    table.text()
}

/// Loss columns of the table: heading and components.
pub fn groups(plan: &LossesPlan) -> Vec<(String, Vec<Component>)> {
    let mut list: Vec<(String, Vec<Component>)> = Vec::new();
    for component in bench_components(plan.setup.transmission()) {
        if !component.is_belt() {
            list.push((component.title().to_owned(), vec![component]));
        } else if let Some((_, parts)) = list.iter_mut().find(|(name, _)| name == "Belt") {
            parts.push(component);
        } else {
            list.push(("Belt".to_owned(), vec![component]));
        }
    }
    list
}

fn several(plan: &LossesPlan, rows: impl Iterator<Item = LossRow>) -> String {
    let (cvt, varied) = (plan.is_cvt(), plan.grid.varied());
    let mut columns: TextColumns<LossRow> = TextColumns::new();
    for axis in &varied {
        columns = columns.right(short(*axis, cvt), move |row| {
            axis_text(*axis, row.asked[*axis as usize])
        });
    }
    if cvt && !varied.contains(&Axis::Pressure) {
        columns = columns.right("bar", |row| fixed(row.answer.secondary_pa / 1e5, 1));
    }
    for (name, parts) in groups(plan) {
        // The last word of a name is short and unique.
        let head = name.rsplit(' ').next().unwrap_or(&name).to_lowercase();
        let sum = move |row: &LossRow| {
            parts
                .iter()
                .map(|part| row.answer.part_nm(*part))
                .sum::<f64>()
        };
        columns = columns.right(head, move |row| fixed(sum(row), 2));
    }
    let columns = columns
        .right("all", |row| fixed(row.answer.total_nm(), 2))
        .right("eff %", |row| percent(row.efficiency(), 1.0, 1))
        .left("flags", |row| flag_text(row.answer.flags));
    let mut rows = rows;
    let shown: Vec<LossRow> = rows.by_ref().take(MAX_ROWS).collect();
    // The rest is solved as well, because its flags are counted.
    let more = rows.count();
    let fixed_axes: Vec<Axis> = Axis::ALL
        .into_iter()
        .filter(|axis| !varied.contains(axis))
        .collect();
    let held = held(plan, &plan.grid.at(0), &fixed_axes);
    let table = columns.table(&shown).indented().text();
    let mut text = format!("{held}; losses in Nm at the input shaft\n\n{table}");
    if more > 0 {
        text += &format!("\n{more} more points; --format csv or --json prints all\n");
    }
    text
}

fn axis_text(axis: Axis, x: f64) -> String {
    match axis {
        Axis::Ratio => fixed(x, 3)
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        _ => plain(x),
    }
}

fn short(axis: Axis, cvt: bool) -> &'static str {
    match axis {
        Axis::Ratio if cvt => "ratio",
        Axis::Ratio => "gear",
        Axis::Sump => "sump \u{b0}C",
        Axis::Belt => "belt \u{b0}C",
        Axis::Throttle => "throttle",
        Axis::Pressure => "bar",
        Axis::Torque => "Nm out",
        Axis::Speed => "rpm",
    }
}
