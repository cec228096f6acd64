//! Golden tables of an independent program.

use super::table::{Table, close};
use super::{EDGES, NAMES, POINTS, made, one};

/// Compares every column of the golden table in both formulations. At gross slip it compares segments and status only.
fn compare(golden: &str, rows: usize) {
    let (want, got) = (Table::new(golden), made(golden, &[]));
    assert_eq!((want.len(), got.len()), (rows, rows));
    let mut numbers = 0;
    for row in 0..rows {
        let place = format!(
            "case {} {}",
            want.cell(row, "case"),
            want.cell(row, "formulation")
        );
        for name in ["case", "formulation", "status"] {
            assert_eq!(got.cell(row, name), want.cell(row, name), "{place}: {name}");
        }
        assert!(
            (got.number(row, "active_segments") - want.number(row, "active_segments")).abs() <= 0.0,
            "{place}: active_segments"
        );
        if want.cell(row, "status") == "gross_slip" {
            continue;
        }
        for name in want
            .names()
            .iter()
            .filter(|name| !["case", "formulation", "status"].contains(&name.as_str()))
        {
            let (a, b) = (got.number(row, name), want.number(row, name));
            assert!(
                close(a, b, 1e-9) || a.is_nan() && b.is_nan(),
                "{place}: {name} is {a} instead of {b}"
            );
            numbers += 1;
        }
    }
    assert!(numbers > 40 * (rows - rows / 5), "{numbers}");
}

#[test]
fn val_golden_points() {
    compare(POINTS, 1224);
}

#[test]
fn val_golden_edge_points() {
    compare(EDGES, 70);
}

#[test]
fn golden_rows_without_active_arc_are_nan() {
    let got = made(EDGES, &[]);
    let rows: Vec<usize> = (0..got.len())
        .filter(|row| got.cell(*row, "status") == "no_active_arc")
        .collect();
    assert_eq!(rows.len(), 4);
    for row in rows {
        for name in [
            "gap_slip_m_s",
            "idle_slip_m_s",
            "primary_slip_m_s",
            "secondary_slip_m_s",
            "slip_percent",
            "belt_loss_nm",
        ] {
            assert_eq!(got.cell(row, name), "NaN", "{name}");
        }
        assert!(got.number(row, "wedge_loss_primary_nm") > 0.0);
        assert!(got.cell(row, "flags").contains("no_active_arc"));
    }
}

/// Without columns and options, the printed forms use the printed frictions and angle, independent of vehicle and fluid.
#[test]
fn val_printed_defaults_need_no_columns() {
    let want = Table::new(POINTS);
    let row = (0..want.len())
        .find(|row| want.cell(*row, "primary_on_stop") == "0" && want.number(*row, "ratio") < 2.0)
        .unwrap();
    let values = NAMES
        .split(',')
        .map(|name| want.cell(row, name))
        .collect::<Vec<_>>()
        .join(",");
    let more = [
        "--set",
        "lubricant.friction.band=0.2",
        "--set",
        "lubricant.friction.segment=0.19",
        "--set",
        "lubricant.friction.flank=0.3",
    ];
    for (row, formulation) in [(row, "appendix_c"), (row + 1, "chapter_8")] {
        assert_eq!(want.cell(row, "formulation"), formulation);
        let got = one(
            &values,
            &[],
            &[&more[..], &["--formulation", formulation]].concat(),
        );
        for name in [
            "belt_loss_nm",
            "slip_percent",
            "segment_compression_n",
            "band_friction",
            "segment_friction",
            "wedge_half_angle_deg",
        ] {
            assert!(
                close(got.number(0, name), want.number(row, name), 1e-9),
                "{formulation} {name}"
            );
        }
    }
}
