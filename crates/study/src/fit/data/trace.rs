//! A CSV file of measured traces: `time_s` and columns of the computed trace by their names.

use super::sheet::{self, Measured, Sheet, and_more};
use cvtcycle_config::csv::Column;
use cvtcycle_config::{Bound, Problem, Problems};

/// Name of the column of times.
pub const TIME: &str = "time_s";

/// So many columns are listed one by one.
const FEW: usize = 40;

/// Reads a trace, of which the columns `computed` can be computed, as far as it can be understood, and all problems of the file: also times
/// that do not rise.
pub fn read(file: &str, bytes: &[u8], computed: &[&'static str]) -> (Option<Sheet>, Problems) {
    let measurable = computed.iter().copied().filter(|name| *name != TIME);
    let measurable: Vec<&str> = measurable.collect();
    let with_unit = measurable.iter().copied().filter(|name| name.contains('_'));
    let names = match with_unit.clone().count() {
        0..=FEW => with_unit.collect::<Vec<_>>().join(", "),
        _ => "time_s and columns of the trace: `cvtcycle explain COLUMN`".to_owned(),
    };
    let measured = Measured {
        names: &measurable,
        example: "transmission_sump_degc",
    };
    let time = Column::number(TIME, Bound::closed(0.0, 1e6)).required();
    let (sheet, mut problems) = sheet::read(file, bytes, [time], names, Some(measured));
    if let Some(sheet) = &sheet
        && let Some(time) = sheet.find(TIME)
    {
        let rows = 0..sheet.rows.len();
        let given = rows.filter_map(|row| Some((row, sheet.number(row, Some(time))?)));
        let given: Vec<(usize, f64)> = given.collect();
        let pairs = given.windows(2).filter(|pair| pair[0].1 >= pair[1].1);
        let falls: Vec<&[(usize, f64)]> = pairs.collect();
        if let Some([(_, before), (row, _)]) = falls.first() {
            let message = format!("the time does not rise{}", and_more(falls.len()));
            let complaint = Problem::out_of_range(message)
                .allowed(format!("above {before} s"))
                .hint("sort the rows, remove repeated ones");
            problems.add(sheet.problem(*row, time, complaint));
        }
    }
    (sheet, problems.finish())
}
