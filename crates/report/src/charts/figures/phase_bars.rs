//! Losses of the transmission by phase of the cycle: a stacked bar for each car, per distance.

use super::bar_rows::{at_end, axis_with_room, bar, bar_chart, bars_panel, name, stacked};
use super::{TEXT, TOP, finite};
use crate::charts::engine::{Axis, Entry, Fill, Panel, Point, Style, WIDTH, cell, rows_left};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, grouped};
use cvtcycle_output::Component;

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

/// Loss per distance of each phase group, stacked by component in the order of the power flow. A group without any finite loss, such as a
/// soak, in which no distance is driven, is left out.
#[must_use]
pub fn loss_by_phase(of: &PhaseLosses) -> Picture {
    let some = |cars: &[CarParts]| cars.iter().flatten().any(|(_, x)| x.is_finite());
    let (groups, left_out): (Vec<_>, Vec<_>) = of.groups.iter().partition(|(_, cars)| some(cars));
    let columns = [
        ("phase", ""),
        ("car", ""),
        ("component", ""),
        ("loss", "kJ/km"),
    ];
    let mut table = PictureTable::new(&columns);
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.iter().map(|(name, _)| name.as_str()).collect();
        let names = names.join(", ");
        table.note = format!("Left out, for there is no loss per distance: {names}.");
    }
    let left = rows_left(of.cars.iter().map(String::as_str), TEXT);
    let all = || groups.iter().flat_map(|(_, cars)| cars);
    let sum = |parts: &CarParts| parts.iter().map(|(_, loss)| finite(*loss).max(0.0)).sum();
    let labels = all().map(|parts| grouped(sum(parts), 1));
    let title = "Loss of the transmission [kJ/km]";
    let x = axis_with_room(title, left, all().map(sum), labels);
    let draw = |k: usize, corner: Point| match groups.get(k) {
        Some((group, cars)) => draw(group, of.cars.iter().zip(cars), corner, &x, &mut table),
        None => bars_panel(corner, of.cars.len(), x.clone()).no_data(true),
    };
    let used = |c: &Component| all().flatten().any(|(own, _)| own == c);
    let used: Vec<Component> = Component::ALL.into_iter().filter(used).collect();
    let entries = used
        .into_iter()
        .map(|c| Entry::fill(Fill::component(c), capital(c.name())));
    let chart = bar_chart(
        "Transmission losses by phase, per distance",
        of.subject.clone(),
    );
    stacked(chart, (left, TOP), (23.0, 12.0), groups.len().max(1), draw)
        .legend((LEGEND, WIDTH - LEGEND - 20.0), entries)
        .picture(table)
}

/// The bars of a group, a row for each car.
fn draw<'a>(
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
        for (component, loss) in parts {
            let words = capital(component.name());
            let at = table.push([group.to_owned(), car.clone(), words, cell(*loss, 0.01)]);
            let next = base + finite(*loss).max(0.0);
            let style = Style::edged(Fill::component(*component), 0.5).row(at);
            bar(&mut panel, row, (base, next), style);
            base = next;
        }
        at_end(&mut panel, row, base, false, grouped(base, 1));
    }
    panel
}
