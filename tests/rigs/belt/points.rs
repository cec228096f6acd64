//! A row gives the same result anywhere in the table.

use cvtcycle::model::transmission::cvt::variator::Geometry;

use super::table::close;
use super::{EDGES, NAMES, POINTS, belt, made, one, refused, text};

#[test]
fn a_row_gives_the_same_at_any_place() {
    let lines: Vec<&str> = POINTS.lines().chain(EDGES.lines().skip(1)).collect();
    let plain = text(&belt((lines.join("\n") + "\n").as_bytes(), &["--quiet"]).stdout);
    let plain: Vec<&str> = plain.lines().collect();
    // 7 is coprime with the number of rows: every row once, in another order.
    let count = lines.len() - 1;
    let order: Vec<usize> = (0..count).map(|k| 1 + (k * 7 + 3) % count).collect();
    let shuffled = order
        .iter()
        .map(|k| lines[*k])
        .collect::<Vec<_>>()
        .join("\n");
    let got = text(
        &belt(
            format!("{}\n{shuffled}\n", lines[0]).as_bytes(),
            &["--quiet"],
        )
        .stdout,
    );
    let got: Vec<&str> = got.lines().collect();
    assert_eq!((got.len(), plain.len()), (count + 1, count + 1));
    for (line, k) in got.iter().skip(1).zip(order) {
        assert_eq!(*line, plain[k]);
    }
}

/// A row that overrides everything does not affect the next one.
#[test]
fn a_row_does_not_affect_the_next_one() {
    let names = format!(
        "{NAMES},formulation,pulley_half_angle_deg,wedge_half_angle_deg,band_offset_mm,band_friction,segment_friction,band_count,\
        primary_on_stop,belt_temp_degc"
    );
    let overriding = "0.5,2000,12,10,F,9,8,1,0.05,0.2,6,1,20";
    let plain = "0.5,2000,12,10,F,,,,,,,,";
    for formulation in ["smooth", "appendix_c", "chapter_8"] {
        let rows = format!("{names}\n{plain}\n{overriding}\n{plain}\n").replace('F', formulation);
        let output = text(&belt(rows.as_bytes(), &[]).stdout);
        let lines: Vec<&str> = output.lines().collect();
        assert_eq!(lines[1], lines[3], "{formulation}");
        assert_ne!(lines[1], lines[2], "{formulation}");
    }
}

/// Numbers are written with all digits: the radii equal the library's bit by bit.
#[test]
fn numbers_read_back_to_the_same() {
    for ratio in [0.4137, 0.77, 1.0, 1.9, 2.4169] {
        let got = one(&format!("{ratio},3000,20,1e-7"), &[], &[]);
        let want = Geometry::new(ratio, 0.155, 0.6486);
        for (name, want) in [
            ("primary_radius_m", want.primary_radius_m),
            ("secondary_wrap_rad", want.secondary_wrap_rad),
            ("strut_length_m", want.strut_m),
        ] {
            assert_eq!(got.number(0, name).to_bits(), want.to_bits(), "{name}");
        }
        assert_eq!(
            got.number(0, "output_torque_nm").to_bits(),
            1e-7f64.to_bits()
        );
    }
}

/// Output read as input gives the same output: numbers round-trip, and the values in force are written.
#[test]
fn the_output_is_an_input_with_the_same_output() {
    let input = format!(
        "{NAMES},formulation,belt_temp_degc,primary_on_stop\n2.35,2000,30,60,,,\n0.45,4000,11.3,10.1,smooth,-7.3,\n\
        1.7,3000,0.1,-3,chapter_8,,1\n0.9999,1e-3,17,1e-7,appendix_c,40,0\n1,0,20,5,smooth,,\n"
    );
    let first = text(&belt(input.as_bytes(), &["--quiet"]).stdout);
    let again = text(&belt(first.as_bytes(), &["--quiet"]).stdout);
    assert_eq!(first.lines().count(), 6);
    assert_eq!(first, again);
    assert!(first.starts_with("formulation,ratio,"), "{first}");
    assert!(
        first
            .lines()
            .next()
            .unwrap()
            .ends_with(",belt_loss_nm,status,flags")
    );
}

#[test]
fn columns_override_the_vehicle_row_by_row() {
    let plain = |name: &str| one("0.5,4000,11,10", &[], &[]).number(0, name);
    let with = |column: &str, value: &str, name: &str| {
        one("0.5,4000,11,10", &[(column, value)], &[]).number(0, name)
    };
    // Band offset 1 of 3 mm: (1 + 11/2 0.217)/(3 + 11/2 0.217) of the band loss, exactly (BT-3).
    let share = (1.0 + 5.5 * 0.217) / (3.0 + 5.5 * 0.217);
    assert!(close(
        with("band_offset_mm", "1", "band_loss_primary_nm"),
        share * plain("band_loss_primary_nm"),
        1e-12
    ));
    let step = "band_tension_step_n";
    assert!(close(with("band_friction", "0", step), 0.0, 1e-12) && plain(step).abs() > 100.0);
    assert!(with("segment_friction", "0.25", "active_segments") < 0.7 * plain("active_segments"));
    assert!(with("band_count", "6", "gap_slip_m_s") > 1.3 * plain("gap_slip_m_s"));
    // The wedge's angle changes the wedge terms only; the pulley's changes the forces too.
    let wedge = (9f64.to_radians().tan() / 11f64.to_radians().tan()).recip();
    let ratio =
        with("wedge_half_angle_deg", "9", "wedge_loss_primary_nm") / plain("wedge_loss_primary_nm");
    assert!(
        (ratio / wedge - 1.0).abs() < 0.05 && (ratio - 1.0).abs() > 0.1,
        "{ratio}"
    );
    let same = [
        "penetration_loss_primary_nm",
        "primary_shoulder_force_n",
        "slip_percent",
    ];
    assert!(same.iter().all(|name| close(
        with("wedge_half_angle_deg", "9", name),
        plain(name),
        1e-12
    )));
    assert!(
        with("pulley_half_angle_deg", "9", "primary_shoulder_force_n")
            < plain("primary_shoulder_force_n") - 100.0
    );
    // An empty cell counts as missing.
    for column in [
        "band_offset_mm",
        "band_friction",
        "primary_on_stop",
        "formulation",
        "belt_temp_degc",
    ] {
        assert!(
            close(
                with(column, "", "belt_loss_nm"),
                plain("belt_loss_nm"),
                1e-15
            ),
            "{column}"
        );
    }
}

#[test]
fn the_literal_wedge_angle_belongs_to_appendix_c() {
    let angle = |formulation: &str| {
        let row = one(
            "0.5,4000,11,10",
            &[("pulley_half_angle_deg", "9"), ("formulation", formulation)],
            &[],
        );
        row.cell(0, "wedge_half_angle_deg").to_owned()
    };
    assert_eq!(
        ["appendix_c", "chapter_8", "smooth"].map(angle),
        ["11", "9", "9"]
    );
}

#[test]
fn the_end_stop_is_the_vehicles_unless_a_row_says() {
    let wedge = |formulation: &str, stop: &str| {
        let row = one(
            "2.36,2000,30,60",
            &[("formulation", formulation), ("primary_on_stop", stop)],
            &[],
        );
        row.number(0, "wedge_loss_primary_nm")
    };
    for formulation in ["smooth", "appendix_c", "chapter_8"] {
        assert!(close(wedge(formulation, "1"), 0.0, 1e-15), "{formulation}");
        assert!(wedge(formulation, "0") > 0.1, "{formulation}");
    }
    assert!(close(
        wedge("appendix_c", ""),
        wedge("appendix_c", "0"),
        1e-15
    ));
    for formulation in ["smooth", "chapter_8"] {
        // Halfway on the ramp of I from 2.30 to 2.417.
        let share = wedge(formulation, "") / wedge(formulation, "0");
        assert!(0.1 < share && share < 0.5, "{formulation} {share}");
    }
}

#[test]
fn temperature_moves_friction_only_where_it_is_given() {
    let loss = |temp: &str, formulation: &str| {
        // At high ratio all sliding is on the secondary (BT-7); the printed forms share it.
        let column = match formulation {
            "smooth" => "band_loss_secondary_nm",
            _ => "belt_loss_nm",
        };
        one(
            "0.45,4000,12,10",
            &[("belt_temp_degc", temp), ("formulation", formulation)],
            &[],
        )
        .number(0, column)
    };
    // At low temperature and high speed the film lifts the bands in smooth; the printed forms have the boundary part only.
    let (none, hot, cold) = (
        loss("", "smooth"),
        loss("85", "smooth"),
        loss("25", "smooth"),
    );
    assert!(cold < 0.9 * none && hot <= none, "{none} {hot} {cold}");
    let printed = [
        loss("", "appendix_c"),
        loss("85", "appendix_c"),
        loss("25", "appendix_c"),
    ];
    assert!(
        close(printed[0], printed[1], 1e-15) && printed[2] < printed[0] && printed[2] > cold,
        "{printed:?} {cold}"
    );
}

#[test]
fn columns_add_up_to_the_belt_loss() {
    let input = format!(
        "{NAMES},belt_temp_degc\n0.45,4000,12,10,-10\n2.416,1500,35,100,90\n1,0,20,-30,25\n0.8,2000,15,400,25\n"
    );
    let got = made(&input, &[]);
    for row in 0..got.len() {
        let parts = got
            .names()
            .iter()
            .filter(|name| name.contains("_loss_") && !name.starts_with("belt"));
        let sum: f64 = parts.map(|name| got.number(row, name)).sum();
        assert!(
            close(got.number(row, "belt_loss_nm"), sum, 1e-12) && sum > 0.0,
            "row {row}"
        );
        let slips = got.number(row, "primary_slip_m_s") + got.number(row, "secondary_slip_m_s");
        let speed = got.number(row, "belt_speed_m_s");
        assert!(
            (slips * 100.0 - got.number(row, "slip_percent") * speed).abs() <= 1e-9,
            "row {row}"
        );
    }
    assert_eq!(got.cell(3, "status"), "gross_slip");
}

#[test]
fn flags_name_what_a_point_departs_from_and_clamp_nothing() {
    for (values, others, flags) in [
        ("2.416,2000,30,60", vec![], ""),
        ("0.5,2000,12,0", vec![], ""),
        ("2.6,2000,30,60", vec![], "outside_ratio_range"),
        ("0.38,2000,12,10", vec![], "outside_ratio_range"),
        ("0.5,2000,12,-10", vec![], "overrun"),
        ("2.416,2000,45,60", vec![], "above_pressure_cap"),
        ("2.416,9000,30,60", vec![], "overspeed"),
        (
            "0.5,2000,12,10",
            vec![("belt_temp_degc", "170")],
            "outside_validity",
        ),
        (
            "0.5,2000,12,120",
            vec![],
            "above_capacity;gross_slip;outside_validity",
        ),
        (
            "0.5,2000,12,120",
            vec![("formulation", "appendix_c")],
            "above_capacity;outside_validity",
        ),
        (
            "2.416,2000,15,210",
            vec![("formulation", "appendix_c")],
            "above_capacity;gross_slip",
        ),
    ] {
        let got = one(values, &others, &[]);
        assert_eq!(got.cell(0, "flags"), flags, "{values} {others:?}");
        assert_eq!(got.cell(0, "ratio"), values.split(',').next().unwrap());
    }
    let floor = one(
        "0.5,2000,12,10",
        &[],
        &["--set", "transmission.cvt.pressure.control_bar=20"],
    );
    assert_eq!(floor.cell(0, "flags"), "below_pressure_floor");
}

#[test]
fn smooth_is_defined_at_ratio_1_and_at_rest_and_the_printed_forms_are_not() {
    let got = made(
        &format!("{NAMES}\n1,2000,20,10\n1,0,20,10\n0.5,0,20,10\n"),
        &[],
    );
    for row in 0..3 {
        assert!(
            got.number(row, "belt_loss_nm").is_finite()
                && got.number(row, "slip_percent").is_finite()
        );
    }
    for formulation in ["appendix_c", "chapter_8"] {
        let said = refused(
            format!("{NAMES}\n1,0,20,10\n").as_bytes(),
            &["--formulation", formulation],
        );
        for part in [
            "standard input:2:1",
            "standard input:2:3",
            "ratio 1",
            "at rest",
            "above 0 rpm",
            "smooth",
            "2 problems",
        ] {
            assert!(said.contains(part), "{part} is not in {said}");
        }
    }
}

/// The fluid's own friction has no column in the table, so its problem is reported for the row.
#[test]
fn bad_friction_of_the_fluid_is_reported_at_its_row() {
    let sets = [
        "--set",
        "lubricant.friction.band=0.4",
        "--set",
        "lubricant.friction.band_rise_per_k=0.002",
    ];
    let rows = "0.5,500,20,30,200\n0.05,500,20,30,200\n";
    let said = refused(format!("{NAMES},belt_temp_degc\n{rows}").as_bytes(), &sets);
    for part in [
        "band_friction: the bands would block themselves (TE-5)",
        "standard input:3:1",
        "^^^^^^^^^^^^^^^^^^",
        "1 problem in",
    ] {
        assert!(said.contains(part), "{part} is not in {said}");
    }
}

/// Travel of Table 8-1's belt with the mean speed (closed form), and the band speed required for the printed 16 mm.
#[test]
fn val_band_speed_moves_the_travel_only() {
    let at = |share: &str| {
        one(
            "2.416,2000,35,0",
            &[("formulation", "appendix_c")],
            &["--band-speed", share],
        )
    };
    assert!((at("0").number(0, "band_1_travel_m_per_rev") - 0.0264).abs() < 5e-5);
    assert!((at("-0.277").number(0, "band_1_travel_m_per_rev") - 0.016).abs() < 2e-4);
    assert!(close(
        at("-0.277").number(0, "belt_loss_nm"),
        at("0").number(0, "belt_loss_nm"),
        1e-15
    ));
}
