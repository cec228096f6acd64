//! Losses as tables for people.

use cvtcycle::model::bench::BELT_PARTS;
use cvtcycle::output::losses::{Axis, LossRow, bench_components};
use cvtcycle::output::{Component, Flags};

use super::plan::Plan;
use crate::print::colour::Paint;
use crate::print::grid::Grid;
use cvtcycle::output::number::{NONE, fixed, percent, plain};

/// Most rows of a table; CSV and JSON carry all.
const MOST_ROWS: usize = 100;

/// One point in detail, or a row a point.
pub fn table(plan: &Plan, mut rows: impl Iterator<Item = LossRow>, paint: Paint) -> String {
    let head = format!(
        "{}  {}\n",
        paint.heading(&plan.setup.name),
        plan.setup.title
    );
    if plan.grid.len() == 1 {
        return head + &rows.next().map_or_else(String::new, |row| one(plan, &row));
    }
    head + &several(plan, rows)
}

/// What is held, in words.
pub fn held(plan: &Plan, asked: &[f64; Axis::COUNT], axes: &[Axis]) -> String {
    let cvt = plan.is_cvt();
    let word = |axis: &Axis| {
        let x = plain(asked[*axis as usize]);
        match axis {
            Axis::Ratio if cvt => format!(
                "ratio {}",
                fixed(asked[*axis as usize], 3)
                    .trim_end_matches('0')
                    .trim_end_matches('.')
            ),
            Axis::Ratio => format!("gear {x}"),
            Axis::Sump => format!("sump {x} \u{b0}C"),
            Axis::Belt => format!("belt {x} \u{b0}C"),
            Axis::Throttle => format!("throttle {x}"),
            Axis::Pressure => format!("{x} bar"),
            Axis::Torque => format!("{x} Nm at the output"),
            Axis::Speed => format!("{x} rpm"),
        }
    };
    let given = axes.iter().filter(|axis| {
        !asked[**axis as usize].is_nan() && (cvt || !matches!(axis, Axis::Throttle))
    });
    given.map(word).collect::<Vec<_>>().join(", ")
}

/// A component's name for people.
pub fn component_name(component: Component) -> String {
    let words = component.name().replace('_', " ");
    let mut letters = words.chars();
    letters
        .next()
        .map(|c| c.to_ascii_uppercase())
        .into_iter()
        .chain(letters)
        .collect()
}

fn flag_text(flags: Flags) -> String {
    flags.names().collect::<Vec<_>>().join("|")
}

fn one(plan: &Plan, row: &LossRow) -> String {
    let a = &row.answer;
    let (w, total) = (row.point.input_rad_s, a.total_nm());
    let mut grid = Grid::new("lrrr").indented();
    grid.row(["", "Nm at input", "W", "% of loss"]);
    for component in bench_components(plan.setup.transmission()) {
        let nm = a.part_nm(component);
        grid.row([
            component_name(component),
            fixed(nm, 3),
            fixed(nm * w, 1),
            percent(nm, total, 1),
        ]);
    }
    grid.row([
        "All losses".to_owned(),
        fixed(total, 3),
        fixed(total * w, 1),
        percent(total, total, 1),
    ]);
    let mut state = Grid::new("lrl").indented();
    state.row([
        "Input torque".to_owned(),
        fixed(a.input_nm, 3),
        "Nm".to_owned(),
    ]);
    state.row([
        "Input power".to_owned(),
        fixed(row.input_w(), 1),
        "W".to_owned(),
    ]);
    state.row([
        "Output power".to_owned(),
        fixed(row.output_w(), 1),
        "W".to_owned(),
    ]);
    state.row([
        "Efficiency".to_owned(),
        percent(row.efficiency(), 1.0, 2),
        "%".to_owned(),
    ]);
    if plan.is_cvt() {
        let law = if row.asked[Axis::Pressure as usize].is_nan() {
            "bar, from the clamp law"
        } else {
            "bar, as given"
        };
        let belt = if row.asked[Axis::Belt as usize].is_nan() {
            "\u{b0}C, in steady state"
        } else {
            "\u{b0}C, as given"
        };
        state.row([
            "Secondary pressure".to_owned(),
            fixed(a.secondary_pa / 1e5, 2),
            law.to_owned(),
        ]);
        state.row([
            "Belt and spray".to_owned(),
            fixed(a.belt_k - 273.15, 1),
            belt.to_owned(),
        ]);
        state.row([
            "Belt slip".to_owned(),
            percent(row.slip(), 1.0, 3),
            "%".to_owned(),
        ]);
        state.row([
            "Clamp safety".to_owned(),
            fixed(row.clamp_safety(), 2),
            String::new(),
        ]);
    }
    let flags = flag_text(a.flags);
    state.row(["Flags", if flags.is_empty() { NONE } else { &flags }, ""]);
    format!(
        "{}\n\n{}\n{}",
        held(plan, &row.asked, &Axis::ALL),
        grid.text(),
        state.text()
    )
}

/// Parts of the compact table: heading and components.
pub fn groups(plan: &Plan) -> Vec<(String, Vec<Component>)> {
    let all = bench_components(plan.setup.transmission());
    let mut list: Vec<(String, Vec<Component>)> = Vec::new();
    for component in all {
        if BELT_PARTS.contains(&component) {
            match list.iter_mut().find(|(name, _)| name == "Belt") {
                Some((_, parts)) => parts.push(component),
                None => list.push(("Belt".to_owned(), vec![component])),
            }
        } else {
            list.push((component_name(component), vec![component]));
        }
    }
    list
}

fn several(plan: &Plan, rows: impl Iterator<Item = LossRow>) -> String {
    let varied = plan.grid.varied();
    let fixed_axes: Vec<Axis> = Axis::ALL
        .into_iter()
        .filter(|axis| !varied.contains(axis))
        .collect();
    let groups = groups(plan);
    let heads = varied
        .iter()
        .map(|axis| short(*axis, plan.is_cvt()).to_owned());
    let cvt: &[&str] = if plan.is_cvt() && !varied.contains(&Axis::Pressure) {
        &["bar"]
    } else {
        &[]
    };
    let heads: Vec<String> = heads
        .chain(cvt.iter().map(|s| (*s).to_owned()))
        .chain(groups.iter().map(|(name, _)| head(name)))
        .chain(["all".to_owned(), "eff %".to_owned(), "flags".to_owned()])
        .collect();
    let mut grid = Grid::new(&format!("{}l", "r".repeat(heads.len() - 1))).indented();
    grid.row(&heads);
    let mut count = 0;
    for row in rows {
        count += 1;
        if count > MOST_ROWS {
            continue; // solved all the same: its flags count
        }
        let a = &row.answer;
        let axes = varied
            .iter()
            .map(|axis| axis_text(*axis, row.asked[*axis as usize]));
        let pressure = cvt.iter().map(|_| fixed(a.secondary_pa / 1e5, 1));
        let parts = groups
            .iter()
            .map(|(_, parts)| fixed(parts.iter().map(|c| a.part_nm(*c)).sum::<f64>(), 2));
        let ends = [
            fixed(a.total_nm(), 2),
            percent(row.efficiency(), 1.0, 1),
            flag_text(a.flags),
        ];
        grid.row(axes.chain(pressure).chain(parts).chain(ends));
    }
    let asked = plan.grid.at(0);
    let mut text = format!(
        "{}; losses in Nm at the input shaft\n\n{}",
        held(plan, &asked, &fixed_axes),
        grid.text()
    );
    if count > MOST_ROWS {
        text += &format!(
            "\n{} more points; --format csv or --json carries them all\n",
            count - MOST_ROWS
        );
    }
    text
}

/// The last word of a name, which tells the parts apart and is short.
fn head(name: &str) -> String {
    name.rsplit(' ').next().unwrap_or(name).to_lowercase()
}

fn axis_text(axis: Axis, x: f64) -> String {
    if axis == Axis::Ratio {
        fixed(x, 3)
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned()
    } else {
        plain(x)
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
