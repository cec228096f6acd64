//! Rows of horizontal bars with a label at the outer end of each: losses of the transmission by component, with a panel for each car, and
//! by phase of the cycle, stacked.

use super::{MARGIN, TEXT, TOP, finite, percent};
use crate::charts::engine::{
    Axis, Chart, Entry, Fill, Label, Panel, Point, Style, WIDTH, at, cell, group_line, row_middle,
    rows_left, rows_panel, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, capital_first, grouped, list_of, words};
use cvtcycle_output::Component;
use cvtcycle_output::table::distinct;

/// Right edge of the bars, pixels.
const RIGHT: f64 = WIDTH - 18.0;
/// Height of a row, pixels.
const PITCH: f64 = 21.0;

/// An axis over values for bars that begin at `left`, with room for the longest outer label, up to a limit.
pub(super) fn axis_with_room(
    title: &str,
    left: f64,
    values: impl Iterator<Item = f64>,
    labels: impl Iterator<Item = String>,
) -> Axis {
    let widths = labels.map(|label| text_width(&label, TEXT));
    let label = (widths.fold(0.0, f64::max) + 12.0).clamp(60.0, 270.0);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for value in values.filter(|x| x.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
    }
    // A value next to zero needs room for its label as well.
    let sides = if low < 0.0 { 2.0 } else { 1.0 };
    let span = (high - low) / (1.0 - sides * label / (RIGHT - left));
    let room = span * label / (RIGHT - left);
    let low = if low < 0.0 { low - room } else { 0.0 };
    Axis::exact(title, low, if span > 0.0 { high + room } else { 1.0 }, 7)
}

/// A panel of `count` rows with its upper left corner at a point.
pub(super) fn bars_panel(corner: Point, count: usize, x: Axis) -> Panel {
    rows_panel(corner, RIGHT, count, PITCH, x)
}

/// Heights above a panel and between two panels, pixels.
pub(super) type Gaps = (f64, f64);

/// Adds panels of bars below each other, with one horizontal axis; `draw` gets the number and the upper left corner of each.
pub(super) fn stacked(
    chart: Chart,
    (left, top): Point,
    (heading, gap): Gaps,
    count: usize,
    mut draw: impl FnMut(usize, Point) -> Panel,
) -> Chart {
    let mut top = top + heading;
    let panels = (0..count).map(|k| {
        let panel = draw(k, (left, top)).x_labels(k + 1 == count);
        top = panel.rect.bottom + gap + heading;
        panel
    });
    let panels: Vec<Panel> = panels.collect();
    chart.panels(panels)
}

/// Writes the name of a row.
pub(super) fn name(panel: &mut Panel, row: usize, text: &str, bold: bool) {
    panel.row_name(row, Label::new(at(0.0, 0.0), text).size(TEXT).bold(bold));
}

/// Adds a bar between two values, unless they are equal.
pub(super) fn bar(panel: &mut Panel, row: usize, (from, to): Point, style: Style) {
    if from < to || to < from {
        panel.bar(row, (from, to), (-7.0, 7.0), style);
    }
}

/// Writes a label at the outer end of a bar: right of a value, or left of a negative one.
pub(super) fn at_end(panel: &mut Panel, row: usize, value: f64, bold: bool, text: String) {
    let side = if value < 0.0 { -6.0 } else { 6.0 };
    let place = at(value, row_middle(row)).shift(side, 4.0);
    let label = Label::new(place, text).size(TEXT).bold(bold);
    panel.label(if value < 0.0 { label.end() } else { label });
}

/// Losses of one car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarLosses {
    /// Name of the car.
    pub name: String,
    /// Energy lost by each component over the cycle, kJ, in the order of the power flow.
    pub losses_kj: Vec<(Component, f64)>,
    /// Distance, km.
    pub distance_km: f64,
}

impl CarLosses {
    /// Total loss, kJ.
    pub fn total_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| finite(*kj)).sum()
    }
}

/// Losses over the cycle by component, in the order of the power flow, over the distance and as their share of the car's transmission loss.
pub fn loss_by_component(cars: &[CarLosses], conditions: &str) -> Picture {
    let mut table = PictureTable::new(&[
        ("car", ""),
        ("component", ""),
        ("loss", "kJ/km"),
        ("share of the transmission's loss", "%"),
    ]);
    let all = || {
        cars.iter()
            .flat_map(|car| car.losses_kj.iter().map(move |data| (car, data)))
    };
    let names: Vec<String> = all().map(|(_, (c, _))| capital(c.name())).collect();
    let left = rows_left(names.iter().map(String::as_str), TEXT);
    let values = all().map(|(car, (_, kj))| finite(kj / car.distance_km));
    let labels = all().map(|(car, (_, kj))| loss_label(*kj, car));
    let x = axis_with_room("Loss over the distance [kJ/km]", left, values, labels);
    let subject = match cars {
        [car] => format!("{}, {conditions}", car.name),
        _ => format!("{conditions}; one scale; components in the order of the power flow"),
    };
    let panel = |k: usize, corner: Point| match cars.get(k) {
        Some(car) => car_bars(car, corner, &x, &mut table),
        None => bars_panel(corner, 1, x.clone()).no_data(true),
    };
    let chart = Chart::new(largest(cars), subject, MARGIN);
    stacked(chart, (left, TOP), (24.0, 16.0), cars.len().max(1), panel).picture(table)
}

/// Title: the three largest losses of the first car, and their share.
fn largest(cars: &[CarLosses]) -> String {
    let plain = || "Transmission losses by component".to_owned();
    let Some(car) = cars.first().filter(|car| car.total_kj() > 0.0) else {
        return plain();
    };
    let mut order: Vec<(Component, f64)> = car.losses_kj.clone();
    order.retain(|(_, kj)| *kj > 0.0);
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    order.truncate(3);
    let share = 100.0 * order.iter().map(|(_, kj)| kj).sum::<f64>() / car.total_kj();
    let names: Vec<String> = order.iter().map(|(c, _)| words(c.name())).collect();
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!(
        "{} {verb} {} % of what the transmission of {} loses",
        capital_first(&list_of(&names)),
        grouped(share, 0),
        car.name
    )
}

fn car_bars(car: &CarLosses, corner: Point, x: &Axis, table: &mut PictureTable) -> Panel {
    let total = car.total_kj();
    let mut panel = bars_panel(corner, car.losses_kj.len(), x.clone())
        .heading(format!("{}: {} in all", car.name, per_km(total, car)))
        .no_data(car.losses_kj.is_empty());
    for (row, (component, kj)) in car.losses_kj.iter().enumerate() {
        let words = capital(component.name());
        let numbers = [kj / car.distance_km, 100.0 * kj / total].map(|x| cell(x, 0.01));
        let names = [car.name.clone(), words.clone()];
        let at_row = table.push(names.into_iter().chain(numbers));
        let style = Style::edged(Fill::component(*component), 0.5).row(at_row);
        name(&mut panel, row, &words, false);
        let value = finite(kj / car.distance_km);
        bar(&mut panel, row, (0.0, value), style);
        at_end(&mut panel, row, value, false, loss_label(*kj, car));
    }
    panel
}

fn loss_label(kj: f64, car: &CarLosses) -> String {
    match percent(kj, car.total_kj()).as_str() {
        "" => per_km(kj, car),
        share => format!("{}, {share}", per_km(kj, car)),
    }
}

fn per_km(kj: f64, car: &CarLosses) -> String {
    format!("{} kJ/km", grouped(kj / car.distance_km, 1))
}

/// Losses of one car by component, in the order of the power flow.
pub type CarParts = Vec<(Component, f64)>;

/// Losses by phase group and car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseLosses {
    /// The cycle and its conditions.
    pub subject: String,
    /// Names of the cars.
    pub cars: Vec<String>,
    /// For each phase group its name and, for each car, the loss of each component over the group's distance, kJ/km.
    pub groups: Vec<(String, Vec<CarParts>)>,
}

/// Left edge of the legend, pixels.
const LEGEND: f64 = 40.0;

/// Loss per distance of each phase group, stacked by group of components in the order of the power flow. Groups without a finite loss, such as a
/// soak without distance, are omitted.
pub fn loss_by_phase(data: &PhaseLosses) -> Picture {
    let some = |cars: &[CarParts]| cars.iter().flatten().any(|(_, x)| x.is_finite());
    let (groups, left_out): (Vec<_>, Vec<_>) = data.groups.iter().partition(|(_, cars)| some(cars));
    let columns = [("phase", ""), ("car", ""), ("parts", ""), ("loss", "kJ/km")];
    let mut table = PictureTable::new(&columns);
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.iter().map(|(name, _)| name.as_str()).collect();
        let names = names.join(", ");
        table.note = format!("Left out, for there is no loss per distance: {names}.");
    }
    let left = rows_left(data.cars.iter().map(String::as_str), TEXT);
    let all = || groups.iter().flat_map(|(_, cars)| cars);
    let sum = |parts: &CarParts| parts.iter().map(|(_, loss)| finite(*loss).max(0.0)).sum();
    let labels = all().map(|parts| grouped(sum(parts), 1));
    let title = "Loss of the transmission [kJ/km]";
    let x = axis_with_room(title, left, all().map(sum), labels);
    let panel = |k: usize, corner: Point| match groups.get(k) {
        Some((group, cars)) => {
            phase_bars(group, data.cars.iter().zip(cars), corner, &x, &mut table)
        }
        None => bars_panel(corner, data.cars.len(), x.clone()).no_data(true),
    };
    let used = distinct(all().flatten().map(|(component, _)| component.group()));
    let entries = used
        .into_iter()
        .map(|group| Entry::fill(Fill::plain(group_line(group)), capital(group.name())));
    let chart = Chart::new(phase_title(data, &groups), &data.subject, MARGIN);
    stacked(chart, (left, TOP), (23.0, 12.0), groups.len().max(1), panel)
        .legend((LEGEND, WIDTH - LEGEND - 20.0), entries)
        .picture(table)
}

/// Title: losses of the first car in each phase.
fn phase_title(data: &PhaseLosses, groups: &[&(String, Vec<CarParts>)]) -> String {
    let sum = |parts: &CarParts| {
        parts
            .iter()
            .map(|(_, loss)| finite(*loss).max(0.0))
            .sum::<f64>()
    };
    let part = |(name, cars): &&(String, Vec<CarParts>)| {
        Some(format!(
            "{} kJ/km in {name}",
            grouped(sum(cars.first()?), 1)
        ))
    };
    let parts: Vec<String> = groups.iter().filter_map(part).collect();
    match (data.cars.first(), parts.is_empty()) {
        (Some(car), false) => format!("{car} loses {}", list_of(&parts)),
        _ => "Transmission losses by phase, per distance".to_owned(),
    }
}

/// The bars of a group, a row for each car.
fn phase_bars<'a>(
    group: &str,
    cars: impl ExactSizeIterator<Item = (&'a String, &'a CarParts)>,
    corner: Point,
    x: &Axis,
    table: &mut PictureTable,
) -> Panel {
    let mut panel = bars_panel(corner, cars.len(), x.clone()).heading(group);
    for (row, (car, parts)) in cars.enumerate() {
        name(&mut panel, row, car, false);
        let mut base = 0.0;
        for part in distinct(parts.iter().map(|(component, _)| component.group())) {
            let own = parts
                .iter()
                .filter(|(component, _)| component.group() == part);
            let loss: f64 = own.map(|(_, loss)| *loss).sum();
            let words = capital(part.name());
            let at = table.push([group.to_owned(), car.clone(), words, cell(loss, 0.01)]);
            let next = base + finite(loss).max(0.0);
            let style = Style::edged(Fill::plain(group_line(part)), 0.5).row(at);
            bar(&mut panel, row, (base, next), style);
            base = next;
        }
        at_end(&mut panel, row, base, false, grouped(base, 1));
    }
    panel
}
