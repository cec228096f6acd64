//! Columns and maps of `losses` against the bench: powers and efficiency, units, flags, the torque axis of each map.
use crate::common::{RPM, ZERO, car, loaded_point, rover_bench};
use cvtcycle::model::rig::{Bench, BenchPoint, Parts};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::output::Component;
use cvtcycle::output::losses::{Axis, LossRow};

/// Asserts equality up to rounding.
#[track_caller]
fn same(got: f64, want: f64) {
    assert!(
        (got - want).abs() <= 1e-11 * want.abs() + 1e-13,
        "{got} instead of {want}"
    );
}

/// Powers, efficiency, slip and safety of a row: in drive, in overrun, without load, and with power into both shafts.
#[test]
fn val_rows_of_the_bench() {
    let bench = rover_bench();
    let mut seen = [0; 4];
    for output_nm in [-900.0, -300.0, -20.0, -1.0, 0.0, 5.0, 100.0, 900.0] {
        let mut asked = [f64::NAN; Axis::COUNT];
        for (axis, value) in [
            (Axis::Ratio, 0.7),
            (Axis::Speed, 3000.0),
            (Axis::Torque, output_nm),
            (Axis::Throttle, 0.2),
            (Axis::Sump, 70.0),
        ] {
            asked[axis as usize] = value;
        }
        let row = LossRow::new(&bench, asked);
        same(row.point.input_rad_s, 3000.0 * RPM);
        same(row.point.sump_k, 70.0 + ZERO);
        assert!(row.point.pressure_pa.is_none() && row.point.belt_k.is_none());
        let (input, output) = (
            row.answer.input_nm * 3000.0 * RPM,
            output_nm * row.answer.output_rad_s,
        );
        same(row.input_w(), input);
        same(row.output_w(), output);
        let efficiency = row.efficiency();
        if output_nm >= 0.0 {
            same(efficiency, output / input);
            seen[0] += 1;
        } else if input <= 0.0 {
            same(efficiency, input / output);
            seen[1] += 1;
        } else {
            assert!(efficiency.is_nan());
            seen[2] += 1;
        }
        let belt = row.answer.belt.unwrap();
        same(row.slip(), belt.losses.slip_total);
        let secondary =
            (belt.input_torque_nm - belt.losses.sum_nm()) * 0.7 / (1.0 - belt.losses.slip_total);
        near(
            row.clamp_safety(),
            belt.losses.capacity_nm / secondary.abs(),
            1e-9,
        );
        assert_eq!(
            row.belt_status(),
            if belt.losses.gross_slip {
                "gross_slip"
            } else {
                "ok"
            }
        );
        seen[3] += 1;
    }
    assert!(seen.iter().all(|n| *n > 1), "{seen:?}");
}

/// Torque axes: at the pulley for the belt, at the shaft for the shaft, at the input for the whole box.
#[test]
fn val_map_parts_take_their_own_torque() {
    use cvtcycle::output::loss_table::MapPart;
    let bench = rover_bench();
    let cvt = bench.cvt().unwrap();
    let p = BenchPoint {
        output_nm: 40.0,
        ratio: 0.8,
        pressure_pa: Some(15e5),
        ..loaded_point()
    };
    let whole = bench.solve(&BenchPoint {
        output_nm: 40.0 * cvt.final_drive.ratio,
        ..p
    });
    same(
        MapPart::FinalDrive.loss_nm(&bench, &p),
        whole.part_nm(Component::FinalDrive),
    );
    same(
        MapPart::Pump.loss_nm(&bench, &p),
        whole.part_nm(Component::Pump),
    );
    same(
        MapPart::InputShaft.loss_nm(&bench, &p),
        whole.part_nm(Component::InputShaft),
    );
    same(
        MapPart::ClutchDrag.loss_nm(&bench, &p),
        whole.part_nm(Component::ClutchDrag),
    );
    same(
        MapPart::SealRing.loss_nm(&bench, &p),
        bench.solve(&p).part_nm(Component::SealRing),
    );
    let parts = Parts {
        final_drive: false,
        seal_rings: false,
        ..Parts::ALL
    };
    let alone = bench.solve(&BenchPoint {
        output_nm: 40.0 * cvt.final_drive.ratio,
        parts,
        ..p
    });
    same(
        MapPart::Belt.loss_nm(&bench, &p),
        alone.belt_nm() + alone.part_nm(Component::PulleyBearing),
    );
    let manual = Bench::new(&car("rover_216_5mt", &[]));
    for input_nm in [-40.0, 5.0, 90.0] {
        let p = BenchPoint {
            ratio: 3.0,
            output_nm: input_nm,
            ..BenchPoint::default()
        };
        let loss = MapPart::Box.loss_nm(&manual, &p);
        let Transmission::Manual(m) = &manual.car().transmission else {
            panic!("a manual box")
        };
        let back = manual.solve(&BenchPoint {
            output_nm: (input_nm - loss) * m.overall[2],
            ..p
        });
        assert!(
            (back.input_nm - input_nm).abs() < 1e-9 && (back.total_nm() - loss).abs() < 1e-9,
            "{input_nm}"
        );
    }
}

/// Columns in other units than the model's.
#[test]
fn val_columns_of_the_bench() {
    use cvtcycle::output::losses::columns;
    use cvtcycle::output::table::Cell;
    let bench = rover_bench();
    let mut asked = [f64::NAN; Axis::COUNT];
    for (axis, value) in [
        (Axis::Ratio, 0.7),
        (Axis::Speed, 3000.0),
        (Axis::Torque, 90.0),
        (Axis::Throttle, 0.2),
        (Axis::Sump, 170.0),
    ] {
        asked[axis as usize] = value;
    }
    let row = LossRow::new(&bench, asked);
    let column_value = |name: &str| match columns(&bench.car().transmission)
        .iter()
        .find(|c| c.name == name)
        .unwrap()
        .cell(&row)
    {
        Cell::Number(x) => x,
        _ => panic!("{name}"),
    };
    same(
        column_value("secondary_pressure_bar"),
        row.answer.secondary_pa / 1e5,
    );
    same(
        column_value("slip_percent"),
        100.0 * row.answer.belt.unwrap().losses.slip_total,
    );
    same(
        column_value("output_speed_rpm"),
        row.answer.output_rad_s / RPM,
    );
    same(column_value("belt_spray_degc"), row.answer.belt_k - 273.15);
}

/// Asserts equality up to a relative difference `share`.
#[track_caller]
fn near(got: f64, want: f64, share: f64) {
    assert!(
        (got - want).abs() <= share * want.abs(),
        "{got} instead of {want}"
    );
}
