//! Round trips of rows through Parquet and CSV.

use std::io::{ErrorKind, Write};

use cvtcycle::output::trace::columns_for;
use cvtcycle::output::trace::write_trace;
use cvtcycle::study::store::{Head, Kind, Rows, Values};
use cvtcycle::study::store::{
    ParquetFile, ParquetTable, RowWriter, sha256, write_csv, write_parquet, write_trace_parquet,
};
use proptest::prelude::*;

use super::{SmallDisk, head, heads, rows};

#[allow(dead_code, reason = "shared with other tests")]
use crate::fixtures;

/// Table as Parquet bytes.
fn bytes(columns: &[Head], rows: &Rows) -> Vec<u8> {
    let mut out = Vec::new();
    write_parquet(&mut out, columns, rows, &[("cvtcycle.seed", "7")]).unwrap();
    out
}

/// Opens a file with these bytes.
fn opened(bytes: &[u8]) -> ParquetFile {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    ParquetFile::open(file.path(), &sha256(bytes)).unwrap()
}

/// Reads all columns of a table.
fn read_back(bytes: &[u8]) -> Rows {
    let file = opened(bytes);
    let names: Vec<&str> = file
        .columns()
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    file.read(&names).unwrap()
}

/// Bits of the numbers of a table, without the sign of zero, and with a single NaN for all of them.
fn said(rows: &Rows) -> Vec<Vec<String>> {
    let number = |x: &f64| {
        if x.is_finite() {
            format!("{:x}", (x + 0.0).to_bits())
        } else {
            String::new()
        }
    };
    let cells = |values: &Values| match values {
        Values::Number(numbers) => numbers.iter().map(number).collect(),
        Values::Count(counts) => counts.iter().map(i64::to_string).collect(),
        Values::Text(words) => words.iter().map(|word| word.to_string()).collect(),
    };
    rows.values.iter().map(cells).collect()
}

/// The same from its CSV.
fn csv_said(columns: &[Head], rows: &Rows) -> Vec<Vec<String>> {
    let mut out = Vec::new();
    write_csv(&mut out, columns, rows).unwrap();
    let mut reader = csv::Reader::from_reader(&out[..]);
    assert_eq!(
        reader.headers().unwrap(),
        &columns
            .iter()
            .map(|column| column.name.as_str())
            .collect::<Vec<_>>()
    );
    let mut cells = vec![Vec::new(); columns.len()];
    for record in reader.records() {
        for ((cell, column), into) in record.unwrap().iter().zip(columns).zip(&mut cells) {
            let number = column.kind == Kind::Number && !cell.is_empty();
            into.push(if number {
                format!("{:x}", cell.parse::<f64>().unwrap().to_bits())
            } else {
                cell.to_owned()
            });
        }
    }
    cells
}

fn numbers() -> impl Strategy<Value = f64> {
    let special = [
        0.0,
        -0.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MIN_POSITIVE,
        5e-324,
        -1e-310,
        f64::MAX,
        1e-5,
        1e16,
    ];
    prop_oneof![
        any::<f64>(),
        prop::sample::select(special.to_vec()),
        any::<u64>().prop_map(f64::from_bits),
        Just(2.4)
    ]
}

fn words() -> impl Strategy<Value = std::sync::Arc<str>> {
    prop_oneof![
        Just(String::new()),
        "\\PC{0,6}",
        "[a-c,\";\n\r\t äß°€]{0,5}"
    ]
    .prop_map(std::sync::Arc::from)
}

fn tables() -> impl Strategy<Value = Rows> {
    prop_oneof![Just(0_usize), Just(1), 2..60_usize].prop_flat_map(|n| {
        let column = (
            prop::collection::vec(any::<i64>(), n),
            prop::collection::vec(words(), n),
            prop::collection::vec(numbers(), n),
        );
        (
            column,
            prop::collection::vec(numbers(), n),
            prop::collection::vec(words(), n),
        )
            .prop_map(|((a, b, c), d, e)| Rows {
                values: vec![
                    Values::Count(a),
                    Values::Text(b),
                    Values::Number(c),
                    Values::Number(d),
                    Values::Text(e),
                ],
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_table_reads_back(rows in tables()) {
        let bytes = bytes(&heads(), &rows);
        let back = read_back(&bytes);
        prop_assert_eq!(back.len(), rows.len());
        prop_assert_eq!(said(&back), said(&rows));
        prop_assert_eq!(csv_said(&heads(), &rows), said(&rows));
        // The sign of zero is dropped in the file, not only in the comparison.
        let signed = |x: &f64| x.to_bits() == (-0.0_f64).to_bits();
        prop_assert!(back.values.iter().all(|values| !matches!(values, Values::Number(x) if x.iter().any(signed))));
    }
}

#[test]
fn heads_and_pairs_read_back_and_the_bytes_are_the_same_every_time() {
    let rows = rows(4);
    let once = bytes(&heads(), &rows);
    assert_eq!(once, bytes(&heads(), &rows));
    let file = opened(&once);
    assert_eq!(file.columns(), heads());
    assert_eq!(file.rows(), 7);
    let pairs = file.metadata();
    assert_eq!(pairs[0], ("cvtcycle.seed".to_owned(), "7".to_owned()));
    assert_eq!(pairs[1].0, "cvtcycle.columns");
    let created_by = concat!("cvtcycle ", env!("CARGO_PKG_VERSION"));
    assert!(
        once.windows(created_by.len())
            .any(|found| found == created_by.as_bytes())
    );
}

#[test]
fn some_columns_are_read_in_the_order_of_the_names() {
    let rows = rows(3);
    let file = opened(&bytes(&heads(), &rows));
    let back = file.read(&["reason", "run"]).unwrap();
    assert_eq!(
        back.values,
        [rows.values[4].clone(), rows.values[0].clone()]
    );
    assert_eq!(file.read(&[]).unwrap(), Rows::default());
    let problem = file.read(&["run", "walk"]).unwrap_err();
    assert!(
        problem.message.contains("no column `walk`"),
        "{}",
        problem.message
    );
}

#[test]
fn groups_of_rows_and_long_columns_read_back_whole() {
    let columns = [head("x", "m", Kind::Number), head("word", "", Kind::Text)];
    let piece = |n: usize, seed: u32| Rows {
        values: vec![
            Values::Number(
                (0..n)
                    .map(|k| {
                        if k % 7 == 0 {
                            f64::NAN
                        } else {
                            (k as f64 + f64::from(seed)).sqrt()
                        }
                    })
                    .collect(),
            ),
            Values::Text(
                (0..n)
                    .map(|k| std::sync::Arc::from(format!("w{}", k % 11)))
                    .collect(),
            ),
        ],
    };
    let pieces = [piece(30_000, 1), piece(0, 2), piece(1, 3), piece(20_000, 4)];
    let mut out = Vec::new();
    let mut table = Box::new(ParquetTable::new(&mut out, &columns, &[], &pieces[0]).unwrap());
    pieces.iter().for_each(|piece| table.write(piece).unwrap());
    table.finish().unwrap();
    let back = said(&read_back(&out));
    for (column, back) in back.iter().enumerate() {
        let all: Vec<String> = pieces
            .iter()
            .flat_map(|piece| said(piece)[column].clone())
            .collect();
        assert!(all == *back, "column {column}");
    }
}

#[test]
fn rows_of_another_table_are_refused() {
    let refused = |columns: &[Head], rows: &Rows| {
        let errors = [
            write_parquet(Vec::new(), columns, rows, &[]),
            write_csv(Vec::new(), columns, rows),
        ];
        errors
            .into_iter()
            .all(|error| error.is_err_and(|error| error.kind() == ErrorKind::InvalidInput))
    };
    assert!(refused(&heads()[..2], &rows(0)));
    let mut other = heads();
    other[0].kind = Kind::Number;
    assert!(refused(&other, &rows(0)));
    let mut short = rows(0);
    short.values[4] = Values::Text(Vec::new());
    assert!(refused(&heads(), &short));
    let mut twice = heads();
    twice[3].name = "fuel_l_per_100km".to_owned();
    assert!(write_parquet(Vec::new(), &twice, &rows(0), &[]).is_err());
    assert!(write_parquet(Vec::new(), &[], &Rows::default(), &[]).is_err());
}

#[test]
fn a_full_disk_is_an_error_wherever_it_is_full() {
    let (columns, rows) = (heads(), rows(6));
    let (parquet, mut csv) = (bytes(&columns, &rows).len(), Vec::new());
    write_csv(&mut csv, &columns, &rows).unwrap();
    // Exceeds the buffers of the writers.
    let long = super::rows(2000);
    let full = [
        write_csv(SmallDisk { room: 9000 }, &columns, &long),
        write_parquet(SmallDisk { room: 9000 }, &columns, &long, &[]),
    ];
    assert!(
        full.into_iter()
            .all(|result| result.is_err_and(|error| error.kind() == ErrorKind::StorageFull))
    );
    for room in 0..parquet.max(csv.len()) + 2 {
        let written = [
            (
                parquet,
                write_parquet(
                    SmallDisk { room },
                    &columns,
                    &rows,
                    &[("cvtcycle.seed", "7")],
                ),
            ),
            (csv.len(), write_csv(SmallDisk { room }, &columns, &rows)),
        ];
        for (needed, result) in written {
            let full = result.err().map(|error| error.kind());
            assert_eq!(
                full,
                (room < needed).then_some(ErrorKind::StorageFull),
                "{room} of {needed}"
            );
        }
    }
}

#[test]
fn a_trace_is_the_same_in_parquet_and_csv() {
    for (cvt, components) in [(true, &fixtures::CVT[..]), (false, &fixtures::MANUAL[..])] {
        let rows = fixtures::rows(400, 0.5, cvt);
        let columns = columns_for(cvt, components);
        let (mut parquet, mut text) = (Vec::new(), Vec::new());
        write_trace_parquet(&mut parquet, &columns, &rows, &fixtures::phases(), "run7").unwrap();
        write_trace(&mut text, &columns, &rows, &fixtures::phases()).unwrap();
        let file = opened(&parquet);
        let run = ("cvtcycle.run".to_owned(), "run7".to_owned());
        assert!(file.metadata().contains(&run));
        let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
        assert_eq!(
            file.columns()
                .iter()
                .map(|column| column.name.as_str())
                .collect::<Vec<_>>(),
            names
        );
        assert!(
            file.columns()
                .iter()
                .zip(&columns)
                .all(|(head, column)| head.unit == column.unit && head.doc == column.doc)
        );
        let back = file.read(&names).unwrap();
        let mut again = Vec::new();
        write_csv(&mut again, file.columns(), &back).unwrap();
        assert!(again == text, "the Parquet has other cells than the CSV");
        assert!(
            said(&back)
                .iter()
                .any(|cells| cells.iter().any(String::is_empty)),
            "no cell is empty"
        );
    }
    assert_eq!(
        write_trace_parquet(Vec::new(), &columns_for(true, &[]), &[], &[], "")
            .map_err(|error| error.kind()),
        Ok(())
    );
}
