//! Good and bad tables through standard input and output.

use serde_json::Value;

use super::table::{Table, close};
use super::{EDGES, NAMES, belt, made, program, refused, text};

#[test]
fn cases_pass_through() {
    let input = format!(
        "case,{NAMES}\n\"a, \"\"b\"\"\",0.5,2000,12,10\n 7 é ,0.5,2000,12,10\n,0.5,2000,12,10\n"
    );
    let output = text(&belt(input.as_bytes(), &[]).stdout);
    let starts: Vec<&str> = output
        .lines()
        .map(|line| line.split("smooth,").next().unwrap())
        .collect();
    assert_eq!(starts[1..], ["\"a, \"\"b\"\"\",", "7 é,", ","]);
    let json: Value = serde_json::from_slice(&belt(input.as_bytes(), &["--json"]).stdout).unwrap();
    assert_eq!(
        [&json["rows"][0]["case"], &json["rows"][1]["case"]],
        ["a, \"b\"", "7 é"]
    );
}

#[test]
fn json_is_one_object_with_counts_and_rows() {
    let output = belt(EDGES.as_bytes(), &["--json", "--quiet"]);
    assert_eq!(
        (output.status.code(), text(&output.stderr)),
        (Some(0), String::new())
    );
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], 1);
    assert_eq!(
        json["program"],
        concat!("cvtcycle ", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(json["points"], 70);
    assert_eq!(
        [
            &json["status"]["ok"],
            &json["status"]["gross_slip"],
            &json["status"]["no_active_arc"]
        ],
        [55, 11, 4]
    );
    assert_eq!(json["flags"]["gross_slip"], 11);
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 70);
    let table = made(EDGES, &[]);
    for (row, object) in rows.iter().enumerate() {
        assert_eq!(
            object
                .as_object()
                .unwrap()
                .keys()
                .cloned()
                .collect::<Vec<_>>(),
            table.names()
        );
        let number = table.number(row, "belt_loss_nm");
        // The test's JSON reader may differ in the last digit.
        match object["belt_loss_nm"].as_f64() {
            Some(loss) => assert!(close(loss, number, 1e-15), "{loss} {number}"),
            None => assert!(number.is_nan() && object["belt_loss_nm"].is_null()),
        }
        assert_eq!(object["belt_temp_degc"], Value::Null);
        let flags = object["flags"]
            .as_array()
            .unwrap()
            .iter()
            .map(|flag| flag.as_str().unwrap())
            .collect::<Vec<_>>();
        assert_eq!(flags.join(";"), table.cell(row, "flags"));
    }
}

#[test]
fn computed_columns_of_the_input_are_ignored_with_a_note() {
    let input = format!("{NAMES},belt_loss_nm,flags\n0.5,2000,12,10,999,x\n");
    let output = belt(input.as_bytes(), &[]);
    assert!(
        text(&output.stderr).contains("belt_loss_nm, flags"),
        "{}",
        text(&output.stderr)
    );
    assert!(Table::new(&text(&output.stdout)).number(0, "belt_loss_nm") < 10.0);
    assert_eq!(text(&belt(input.as_bytes(), &["--quiet"]).stderr), "");
}

#[test]
fn windows_files_and_blank_lines_are_read() {
    let plain = text(
        &belt(
            format!("{NAMES}\n0.5,2000,12,10\n2,2000,12,10\n").as_bytes(),
            &[],
        )
        .stdout,
    );
    let semicolons = format!(
        "# of a logger\n{}\n-;rpm;bar;N m\n0,5;2000;12;10\n2,0;2e3;12;10\n",
        NAMES.replace(',', ";")
    );
    assert_eq!(text(&belt(semicolons.as_bytes(), &[]).stdout), plain);
    let other = format!("\u{feff}{NAMES}\r\n\r\n0.5 ,2000,\"12\",10\r\n   \r\n2.0,2e3,12,10");
    assert_eq!(text(&belt(other.as_bytes(), &[]).stdout), plain);
}

#[test]
fn bad_tables_are_refused_with_their_place() {
    let row = |cells: &str| {
        format!("{NAMES},formulation,primary_on_stop,band_count\n0.5,2000,12,10,,,\n{cells}\n")
    };
    let four = |cells: &str| format!("{NAMES}\n{cells}\n");
    let cases: Vec<(String, Vec<&str>)> = vec![
        (String::new(), vec!["standard input: the file is empty"]),
        (format!("{NAMES}\n"), vec!["no rows", "at least one row"]),
        (
            "0.5,2000,12,10\n".into(),
            vec!["no column names", "standard input:1"],
        ),
        (
            NAMES.replace(',', ";") + "\n0,5;2000;12.5;10\n",
            vec!["do not write their decimals alike", "standard input:2:10"],
        ),
        (
            format!("{NAMES}\r0.5,2000,12,10\r"),
            vec!["carriage return"],
        ),
        (
            "ratio,input_speed,output_torque_nm\n0.5,2000,10\n".into(),
            vec![
                "this column has no unit",
                "name it input_speed_rpm",
                "secondary_pressure_bar is missing",
            ],
        ),
        (
            format!("{NAMES},ratio\n0.5,2000,12,10,1\n"),
            vec!["duplicate column", "standard input:1:63"],
        ),
        (
            four("0,5,2000,12,10"),
            vec![
                "this row has 5 values",
                "4, as the line",
                "decimal commas",
                "standard input:2",
            ],
        ),
        (four("0.5,2000,12"), vec!["this row has 3 values"]),
        (
            four("0.5,\"2000,12,10"),
            vec!["quote is not closed", "standard input:2:5"],
        ),
        (
            row("0.5,\"2000,5\",12,10,,,"),
            vec!["write a decimal point", "standard input:3:6"],
        ),
        (
            row("0.5,-1,12,10,,,"),
            vec![
                "input_speed_rpm: this value is out of range",
                "0 to 100000 rpm",
                "standard input:3:5",
            ],
        ),
        (
            row("0.5,2000,-12,x,,,"),
            vec![
                "0 to 10000 bar",
                "output_torque_nm: this is not a number",
                "standard input:3:14",
                "2 problems",
            ],
        ),
        (
            row("0.5,2000,NaN,inf,,,"),
            vec!["this is not a number", "this is not a finite number"],
        ),
        (
            row("0.5,2000,,10,,,"),
            vec!["the value is missing", "standard input:3:10"],
        ),
        (
            row("0.5,2000,12,10,apendix_c,,"),
            vec!["formulation is not known", "did you mean `appendix_c"],
        ),
        (
            row("0.5,2000,12,10,,2,"),
            vec!["1 (no deflection), 0 (full deflection)"],
        ),
        (
            row("0.5,2000,12,10,,0.5,"),
            vec!["not a whole number", "1 (no deflection)"],
        ),
        (row("0.5,2000,12,10,,,11.5"), vec!["not a whole number"]),
        (
            row("-1,2000,12,10,,,"),
            vec![
                "cannot run at this ratio",
                "0.0085 to 118",
                "standard input:3:1",
            ],
        ),
        (
            row("0,2000,,10,,,"),
            vec![
                "cannot run at this ratio",
                "the value is missing",
                "2 problems",
            ],
        ),
        (row("500,2000,12,10,,,"), vec!["cannot run at this ratio"]),
    ];
    for (input, parts) in cases {
        let said = refused(input.as_bytes(), &[]);
        for part in parts {
            assert!(said.contains(part), "{input}\n`{part}` is not in\n{said}");
        }
    }
    let said = refused(
        &[NAMES.as_bytes(), b"\n0.5,\xff,12,10\n0.5,2000,12,y\n"].concat(),
        &[],
    );
    assert!(
        said.contains("standard input:2: this line is not UTF-8")
            && said.contains("standard input:3:13"),
        "{said}"
    );
    assert!(refused(b"\xff\xfer\0a\0", &[]).contains("UTF-16"));
    assert!(refused(b"PK\x03\x04\0\0", &[]).contains("zero byte"));
}

#[test]
fn bad_options_and_bad_rows_are_reported_together() {
    let said = refused(
        format!("{NAMES}\n0.5,2000,12,10\n").as_bytes(),
        &["--set", "lubricant.friction.film.enable=false"],
    );
    assert!(
        said.contains("--set lubricant.friction.film.enable=false: unknown key"),
        "{said}"
    );
    let bad = format!("{NAMES}\n0.5,2000,12,x\n");
    let said = refused(
        bad.as_bytes(),
        &[
            "--formulation",
            "smoth",
            "--vehicle",
            "rover_216_ctv",
            "--band-speed",
            "7",
        ],
    );
    for part in [
        "smoth",
        "rover_216_ctv",
        "--band-speed",
        "standard input:2:13",
        "4 problems",
    ] {
        assert!(said.contains(part), "{part} is not in {said}");
    }
    assert!(
        refused(bad.as_bytes(), &["--vehicle", "rover_216_5mt"]).contains("has a manual gearbox")
    );
    let missing = program(&["belt", "--points", "no_such.csv"], b"");
    assert_eq!(missing.status.code(), Some(2));
    assert!(text(&missing.stderr).contains("cannot read `no_such.csv`"));
}
