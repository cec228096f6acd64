//! The answer of a lever study as a table for other programs.

use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, csv_bytes};

use super::{LeverAnswer, LeverBlock, LeverRow};
use cvtcycle_study::statistics::Quantile;

/// `levers.csv`: a row for each lever of each car at each ambient temperature. A missing number is an empty cell; none without a row.
pub fn csv(answer: &LeverAnswer) -> Option<Vec<u8>> {
    let of_block = |block: &'_ LeverBlock| -> Vec<(LeverBlock, LeverRow)> {
        block
            .rows
            .iter()
            .map(|row| (block.clone(), row.clone()))
            .collect()
    };
    let rows: Vec<(LeverBlock, LeverRow)> = answer.blocks.iter().flat_map(of_block).collect();
    csv_bytes(&lever_columns(), &rows)
}

fn lever_columns() -> Vec<Column<(LeverBlock, LeverRow)>> {
    let mut list = columns! { (LeverBlock, LeverRow);
        text "vehicle", "", "name of the car", (b, _) => b.vehicle.clone();
        number "ambient_degc", "degC", "ambient temperature", (b, _) => b.ambient_degc;
        text "lever", "", "name of the lever", (_, r) => r.of.name.clone();
        text "kind", "", "lever or combination", (_, r) => r.of.kind.clone();
        text "title", "", "name for people", (_, r) => r.of.title.clone();
        text "group", "", "its group", (_, r) => r.of.group.clone();
        text "changes", "", "what it changes", (_, r) => r.of.set.join(" ");
        text "left_out", "", "factors that it leaves out of the draw", (_, r) => r.of.left_out.join("|");
        count "n", "", "draws with both runs", (_, r) => r.n as u64;
        count "failed", "", "draws in which its own run fails", (_, r) => r.failed as u64;
    };
    for (name, of) in [
        ("fuel", (|r| r.fuel_percent) as fn(&LeverRow) -> Quantile),
        ("fuel_5", |r| r.low_percent),
        ("fuel_95", |r| r.high_percent),
    ] {
        let value = move |(_, r): &(LeverBlock, LeverRow)| Some(of(r).value);
        list.push(Column::optional(
            format!("{name}_percent"),
            "%",
            "change of the fuel",
            value,
        ));
        for (end, k) in [("low", 0), ("high", 1)] {
            let at = move |(_, r): &(LeverBlock, LeverRow)| of(r).interval[k];
            let name = format!("{name}_{end}_percent");
            list.push(Column::optional(
                name,
                "%",
                "end of its interval of 95 %",
                at,
            ));
        }
    }
    list.extend(columns! { (LeverBlock, LeverRow);
        count "saves", "", "draws in which it saves fuel", (_, r) => r.saves.k as u64;
        number "saves_least_share", "-", "least share of all cases in which it saves", (_, r) => r.saves.interval.map_or(f64::NAN, |[low, _]| low);
        number "fuel_l_per_100km", "L/100 km", "median change of the fuel", (_, r) => r.fuel_l_per_100km;
        number "co2_g_per_km", "g/km", "median change of carbon dioxide", (_, r) => r.co2_g_per_km;
        optional "sum_percent", "%", "sum of the medians of its levers", (_, r) => r.sum_percent;
        text "set_by", "", "uncertain value that sets the size of the change; empty where none is seen to", (_, r) => r.set_by.as_ref().map_or_else(String::new, |of| of.key.clone());
        optional "set_by_share", "-", "share of the variance of the change that goes with it", (_, r) => Some(r.set_by.as_ref()?.share);
    });
    list
}
