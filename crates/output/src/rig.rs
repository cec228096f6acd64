//! The tables of the transmission rig's tests.

use cvtcycle_model::bench::transmission::{Moment, Piece, Stage, SteadyPoint, StripDown, TwoBoxes};
use cvtcycle_model::bench::{BenchAnswer, BenchPoint};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_model::transmission::component::Component;

use crate::table::{Cell, Column};
use crate::trace::bar;
use crate::{Flags, columns};

/// rpm in one rad/s.
const RPM: f64 = 30.0 / std::f64::consts::PI;

/// A number that was set, without what converting it there and back has added.
#[must_use]
pub fn clean(x: f64) -> f64 {
    (x * 1e9).round() / 1e9 + 0.0
}

/// Input speed, rpm.
#[must_use]
pub fn rpm(set: &BenchPoint) -> f64 {
    clean(set.input_rad_s * RPM)
}

/// Bulk oil, degC.
#[must_use]
pub fn oil_degc(set: &BenchPoint) -> f64 {
    clean(set.sump_k - ZERO_DEGC_K)
}

/// What applies to any of some answers.
pub fn union<'a>(answers: impl IntoIterator<Item = &'a BenchAnswer>) -> Flags {
    answers.into_iter().fold(Flags::default(), |all, answer| {
        Flags(all.0 | answer.flags.0)
    })
}

fn set_columns<T: 'static>(set: fn(&T) -> &BenchPoint) -> Vec<Column<T>> {
    columns! { T;
        number "ratio", "-", "belt ratio, held", row => set(row).ratio;
        number "input_speed_rpm", "rpm", "input speed, held", row => rpm(set(row));
        number "oil_degc", "degC", "bulk oil, held", row => oil_degc(set(row));
    }
}

fn part_columns<T: 'static>(answer: fn(&T) -> &BenchAnswer) -> Vec<Column<T>> {
    let name = |part: &str| format!("{part}_nm");
    let pieces = Piece::ALL.map(|piece| {
        Column::number(name(piece.name()), "Nm", "loss", move |row| {
            piece.loss_nm(answer(row))
        })
    });
    let belt = Component::ALL.into_iter().filter(|c| c.is_belt());
    let parts = belt.map(|part| {
        Column::number(part.columns().nm, "Nm", part.doc(), move |row| {
            answer(row).part_nm(part)
        })
    });
    let mut columns: Vec<Column<T>> = pieces.into_iter().chain(parts).collect();
    columns.extend(columns! { T;
        number "belt_degc", "degC", "belt and pulleys", row => answer(row).belt_k - ZERO_DEGC_K;
        words "flags", "", "states and departures from validity", row => Cell::Flags(answer(row).flags);
    });
    columns
}

/// Columns of the steady tests, with and without load.
#[must_use]
pub fn steady_columns() -> Vec<Column<SteadyPoint>> {
    let mut columns = set_columns(|p: &SteadyPoint| &p.set);
    columns.extend(columns! { SteadyPoint;
        number "output_torque_nm", "Nm", "torque at the output shaft, held", p => p.set.output_nm;
        number "secondary_pressure_bar", "bar", "secondary pressure", p => bar(p.answer.secondary_pa);
        number "torque_loss_nm", "Nm", "all losses", p => p.answer.total_nm();
        number "input_torque_nm", "Nm", "torque at the input shaft", p => p.answer.input_nm;
        number "output_speed_rpm", "rpm", "speed of the output shaft", p => p.answer.output_rad_s * RPM;
        number "efficiency_percent", "%", "output over input power", p => efficiency_percent(p);
        number "slip_percent", "%", "belt slip", p => 100.0 * p.answer.belt.map_or(f64::NAN, |b| b.slip_total);
    });
    columns.extend(part_columns(|p: &SteadyPoint| &p.answer));
    columns
}

/// Output over input power, %; NaN where nothing is delivered.
fn efficiency_percent(p: &SteadyPoint) -> f64 {
    let out = p.set.output_nm * p.answer.output_rad_s;
    if out > 0.0 {
        100.0 * out / (p.answer.input_nm * p.set.input_rad_s)
    } else {
        f64::NAN
    }
}

/// Columns of the strip-down.
#[must_use]
pub fn strip_columns() -> Vec<Column<StripDown>> {
    let mut columns = set_columns(|s: &StripDown| &s.set);
    for stage in Stage::ALL {
        columns.extend(columns! { StripDown;
            number format!("{}_loss_nm", stage.name()), "Nm", "all losses of this stage", s => s.stage(stage).total_nm();
            number format!("{}_pressure_bar", stage.name()), "bar", "secondary pressure of this stage", s => bar(s.stage(stage).secondary_pa);
        });
    }
    for piece in Piece::ALL {
        let name = |what: &str| format!("{}_{what}_nm", piece.name());
        columns.extend(columns! { StripDown;
            number name("difference"), "Nm", "difference of two stages", s => s.piece(piece).uncorrected_nm;
            number name("corrected"), "Nm", "the same, corrected for pressure and torque", s => s.piece(piece).corrected_nm;
            number name("true"), "Nm", "loss in the whole box", s => s.piece(piece).true_nm;
        });
        if matches!(piece, Piece::Belt | Piece::FinalDrive) {
            columns.extend(columns! { StripDown;
                number name("interaction_pressure"), "Nm", "effect of the pressure", s => s.piece(piece).by_pressure_nm;
                number name("interaction_torque"), "Nm", "effect of the torque", s => s.piece(piece).by_torque_nm;
            });
        }
        columns.extend(columns! { StripDown;
            number name("remainder"), "Nm", "what the corrections leave", s => s.piece(piece).remainder_nm();
        });
    }
    columns.extend(columns! { StripDown;
        words "flags", "", "flags of any stage", s => Cell::Flags(union(&s.stages));
    });
    columns
}

/// Columns of a second of a transient, with the ratio of its loop.
#[must_use]
pub fn transient_columns() -> Vec<Column<(f64, Moment)>> {
    let mut columns = columns! { (f64, Moment);
        number "ratio", "-", "belt ratio, held", (ratio, _) => *ratio;
        text "branch", "", "warming or cooling", (_, m) => m.branch.word();
        number "time_s", "s", "time since the start", (_, m) => m.time_s;
        number "bulk_oil_degc", "degC", "bulk oil", (_, m) => m.sump_k - ZERO_DEGC_K;
        number "metal_degc", "degC", "case and shafts", (_, m) => m.metal_k - ZERO_DEGC_K;
        number "secondary_pressure_bar", "bar", "secondary pressure", (_, m) => bar(m.answer.secondary_pa);
        number "torque_loss_nm", "Nm", "all losses", (_, m) => m.answer.total_nm();
    };
    columns.extend(part_columns(|m: &(f64, Moment)| &m.1.answer));
    columns
}

/// Columns of the two boxes.
#[must_use]
pub fn two_box_columns() -> Vec<Column<TwoBoxes>> {
    let mut columns = set_columns(|t: &TwoBoxes| &t.first.set);
    columns.extend(columns! { TwoBoxes;
        number "first_pressure_bar", "bar", "secondary pressure of the first box", t => bar(t.first.answer.secondary_pa);
        number "second_pressure_bar", "bar", "secondary pressure of the second box", t => bar(t.second.answer.secondary_pa);
        number "first_loss_nm", "Nm", "all losses of the first box", t => t.first.answer.total_nm();
        number "second_loss_nm", "Nm", "all losses of the second box", t => t.second.answer.total_nm();
        number "difference_nm", "Nm", "difference of both", t => t.difference_nm();
        words "flags", "", "flags of either box", t => Cell::Flags(union([&t.first.answer, &t.second.answer]));
    });
    columns
}
