//! A workbook with one large table and a sheet with the meaning of its columns, built in memory.

use std::io::{self, Write};

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, Worksheet, XlsxError};

use super::RowWriter;
use super::csv::Header;
use super::table::{Head, Rows, Values};
use cvtcycle_output::number::finite;

/// Limit of the rows of a sheet below its header.
pub const MAX_ROWS: u64 = (1 << 20) - 1;
/// Limit of the columns of a sheet.
pub const MAX_COLUMNS: u64 = 1 << 14;
/// Limit of the cells: a number takes some 120 bytes of memory, a text of its own twice as many.
pub const MAX_CELLS: u64 = 5_000_000;
/// Whole numbers up to here are numbers in a cell; Excel would round larger ones, so they are text.
const MAX_EXACT: u64 = 1 << 53;

/// A workbook: the table with a frozen header, and the meaning of its columns.
pub struct XlsxTable<W: Write> {
    out: W,
    book: Workbook,
    row: u32,
}

impl<W: Write> XlsxTable<W> {
    /// A workbook without rows. The name of the sheet is that of the table, up to the 31 letters of Excel.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for a name or a cell that a workbook cannot hold.
    pub fn new(out: W, name: &str, columns: &[Head]) -> io::Result<Self> {
        let mut book = Workbook::new();
        // The same table gives the same bytes at any time.
        let date = ExcelDateTime::from_ymd(1980, 1, 1).map_err(refused)?;
        book.set_properties(&DocProperties::new().set_creation_datetime(&date));
        let names: Vec<String> = columns.iter().map(|head| Header::Units.of(head)).collect();
        let name: String = name.chars().take(31).collect();
        begin(book.add_worksheet(), &name, &names)?;
        let meanings = book.add_worksheet();
        let header = ["column", "unit", "meaning"].map(str::to_owned);
        begin(meanings, "meaning of columns", &header)?;
        for (row, head) in (1..).zip(columns) {
            for (column, text) in (0..).zip([&head.name, &head.unit, &head.doc]) {
                write_text(meanings, row, column, text)?;
            }
        }
        Ok(Self { out, book, row: 0 })
    }
}

impl<W: Write> RowWriter for XlsxTable<W> {
    fn write(&mut self, rows: &Rows) -> io::Result<()> {
        let sheet = self.book.worksheet_from_index(0).map_err(refused)?;
        for at in 0..rows.len() {
            self.row += 1;
            for (column, values) in (0..).zip(&rows.values) {
                match values {
                    Values::Number(numbers) => {
                        if let Some(number) = finite(numbers[at]) {
                            sheet
                                .write_number(self.row, column, number)
                                .map_err(refused)?;
                        }
                    }
                    Values::Count(counts) if counts[at].unsigned_abs() <= MAX_EXACT => {
                        sheet
                            .write_number(self.row, column, counts[at] as f64)
                            .map_err(refused)?;
                    }
                    Values::Count(counts) => {
                        write_text(sheet, self.row, column, &counts[at].to_string())?;
                    }
                    Values::Text(texts) => write_text(sheet, self.row, column, &texts[at])?,
                }
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        let bytes = self.book.save_to_buffer().map_err(refused)?;
        self.out.write_all(&bytes)?;
        self.out.flush()
    }
}

/// Names the sheet and writes its header.
fn begin(sheet: &mut Worksheet, name: &str, header: &[String]) -> io::Result<()> {
    let bold = Format::new().set_bold();
    sheet.set_name(name).map_err(refused)?;
    sheet.set_freeze_panes(1, 0).map_err(refused)?;
    for (column, name) in (0..).zip(header) {
        sheet.set_column_width(column, 24).map_err(refused)?;
        sheet
            .write_string_with_format(0, column, name, &bold)
            .map_err(refused)?;
    }
    Ok(())
}

/// A cell with text, which Excel never evaluates as a formula.
fn write_text(sheet: &mut Worksheet, row: u32, column: u16, text: &str) -> io::Result<()> {
    match sheet.write_string(row, column, text) {
        Ok(_) => Ok(()),
        Err(XlsxError::MaxStringLengthExceeded) => {
            let message = format!(
                "a cell of Excel holds at most 32767 letters, one of row {} has more",
                row + 1
            );
            Err(io::Error::new(io::ErrorKind::InvalidInput, message))
        }
        Err(error) => Err(refused(error)),
    }
}

fn refused(error: XlsxError) -> io::Error {
    match error {
        XlsxError::IoError(error) => error,
        error => io::Error::new(io::ErrorKind::InvalidInput, error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Kind;
    use std::io::ErrorKind;

    fn write(mut out: impl Write, text: &str) -> io::Result<()> {
        let head = |name: &str, kind| Head {
            name: name.to_owned(),
            unit: "mm".to_owned(),
            doc: "a < b & c".to_owned(),
            kind,
        };
        let heads = [
            head("count", Kind::Count),
            head("number", Kind::Number),
            head("text", Kind::Text),
        ];
        let rows = Rows {
            values: vec![
                Values::Count(vec![i64::MAX; 20]),
                Values::Number((0..20).map(|k| f64::from(k).sqrt()).collect()),
                Values::Text(vec![text.into(); 20]),
            ],
        };
        let mut table = Box::new(XlsxTable::new(&mut out, "runs", &heads)?);
        table.write(&rows)?;
        table.finish()
    }

    /// Takes so many bytes.
    struct Small(usize);

    impl Write for Small {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 == 0 {
                return Err(ErrorKind::StorageFull.into());
            }
            let written = bytes.len().min(self.0);
            self.0 -= written;
            Ok(written)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_an_error_wherever_it_is_full() {
        let mut whole = Vec::new();
        write(&mut whole, "a").expect("room enough");
        for room in (0..whole.len()).step_by(97) {
            let error = write(Small(room), "a").expect_err("full");
            assert_eq!(
                error.kind(),
                ErrorKind::StorageFull,
                "{room} of {}",
                whole.len()
            );
        }
        assert!(write(Small(whole.len()), "a").is_ok());
    }

    #[test]
    fn text_that_is_too_long_is_refused() {
        assert!(write(Vec::new(), &"ä".repeat(32_767)).is_ok());
        let error = write(Vec::new(), &"ä".repeat(32_768)).expect_err("too long");
        assert_eq!(error.kind(), ErrorKind::InvalidInput);
        assert!(error.to_string().contains("of row 2"), "{error}");
    }
}
