//! A workbook with one big table, row by row into the file: Office Open XML (ECMA-376), the few parts that it needs.
//!
//! Own, since the crates tried keep all cells in memory, or write through a temporary file and panic when the disk is full.

use std::cell::RefCell;
use std::io::{self, Write};
use std::rc::Rc;

use zip::write::{SimpleFileOptions, StreamWriter, ZipWriter};

use super::xml::{column_letters, escaped, frame, sheet_head};
use crate::store::Header;
use crate::table::{Head, Rows, Values};
use cvtcycle_output::number::exact;

/// Most rows of a sheet below its header.
pub const MOST_ROWS: u64 = (1 << 20) - 1;
/// Most columns of a sheet.
pub const MOST_COLUMNS: usize = 1 << 14;
/// Most UTF-16 units of a cell.
const MOST_LETTERS: usize = 32_767;
/// Most bytes of a sheet's XML: archives with larger ones are not read everywhere.
const MOST_BYTES: usize = u32::MAX as usize;
/// Whole numbers up to here are cells with a number; larger ones, which a number of Excel would change, are words.
const EXACT: u64 = 1 << 53;
/// A workbook that is written row by row: the table, with its header frozen, and a sheet with the meaning of its columns.
pub struct XlsxTable<W: Write> {
    zip: ZipWriter<StreamWriter<FirstError<W>>>,
    error: Rc<RefCell<Option<io::Error>>>,
    columns: Vec<Head>,
    letters: Vec<String>,
    row: u64,
    text: String,
    bytes: usize,
}

impl<W: Write> XlsxTable<W> {
    /// Writes all but the rows. The name of the sheet is that of the table, up to Excel's 31 letters.
    ///
    /// # Errors
    /// Whatever `out` reports.
    pub fn new(out: W, name: &str, columns: &[Head]) -> io::Result<Self> {
        let error = Rc::new(RefCell::new(None));
        let zip = ZipWriter::new_stream(FirstError {
            out,
            error: error.clone(),
        });
        let letters = (0..columns.len()).map(column_letters).collect();
        let mut table = XlsxTable {
            zip,
            error,
            columns: columns.to_vec(),
            letters,
            row: 0,
            text: String::new(),
            bytes: 0,
        };
        let name: String = name.chars().take(31).collect();
        for (file, text) in frame(&name) {
            table.entry(file, &text)?;
        }
        table.meanings()?;
        table.entry("xl/worksheets/sheet1.xml", &sheet_head(columns.len(), true))?;
        let header: Vec<String> = columns
            .iter()
            .map(|column| Header::Units.of(column))
            .collect();
        table.header(&header)?;
        Ok(table)
    }

    /// Writes some rows.
    ///
    /// # Errors
    /// Whatever the file reports; [`io::ErrorKind::InvalidInput`] for a word that is too long for a cell.
    pub fn write(&mut self, rows: &Rows) -> io::Result<()> {
        for row in 0..rows.len() {
            self.begin_row();
            for (k, values) in rows.values.iter().enumerate() {
                match values {
                    Values::Number(numbers) => self.number(k, numbers[row]),
                    Values::Count(counts) if counts[row].unsigned_abs() <= EXACT => {
                        self.raw(k, &counts[row].to_string())
                    }
                    Values::Count(counts) => self.word(k, &counts[row].to_string(), 0)?,
                    Values::Text(words) => self.word(k, &words[row], 0)?,
                }
            }
            self.end_row()?;
        }
        Ok(())
    }

    /// Writes the end of the workbook.
    ///
    /// # Errors
    /// Whatever the file reports.
    pub fn finish(mut self) -> io::Result<()> {
        self.put("</sheetData></worksheet>")?;
        let XlsxTable { zip, error, .. } = self;
        let done = zip.finish();
        if let Some(error) = error.take() {
            return Err(error);
        }
        done?.into_inner().flush()?;
        error.take().map_or(Ok(()), Err)
    }

    /// The sheet with the meanings.
    fn meanings(&mut self) -> io::Result<()> {
        self.entry("xl/worksheets/sheet2.xml", &sheet_head(3, false))?;
        self.header(&["column", "unit", "meaning"].map(str::to_owned))?;
        for column in self.columns.clone() {
            self.begin_row();
            for (k, text) in [&column.name, &column.unit, &column.doc]
                .into_iter()
                .enumerate()
            {
                self.word(k, text, 0)?;
            }
            self.end_row()?;
        }
        self.row = 0;
        self.put("</sheetData></worksheet>")
    }

    fn header(&mut self, names: &[String]) -> io::Result<()> {
        self.begin_row();
        for (k, name) in names.iter().enumerate() {
            self.word(k, name, 1)?;
        }
        self.end_row()
    }

    fn entry(&mut self, name: &str, text: &str) -> io::Result<()> {
        // No times: the same table gives the same bytes.
        let options = SimpleFileOptions::default()
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(0o644);
        self.zip.start_file(name, options)?;
        self.bytes = 0;
        self.put(text)
    }

    /// Into the file; fails where any byte before could not be written.
    fn put(&mut self, text: &str) -> io::Result<()> {
        self.bytes += text.len();
        if self.bytes > MOST_BYTES {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "the table is too large for a workbook: its sheet would have 4 GiB",
            ));
        }
        self.zip.write_all(text.as_bytes())?;
        self.error.take().map_or(Ok(()), |error| {
            // Kept, so that the end of the archive is not believed either.
            let again = io::Error::new(error.kind(), error.to_string());
            *self.error.borrow_mut() = Some(error);
            Err(again)
        })
    }

    fn begin_row(&mut self) {
        self.row += 1;
        self.text.clear();
        self.text += &format!("<row r=\"{}\">", self.row);
    }

    fn end_row(&mut self) -> io::Result<()> {
        self.text += "</row>";
        let text = std::mem::take(&mut self.text);
        let done = self.put(&text);
        self.text = text;
        done
    }

    /// Where a cell stands, `AB12`.
    fn place(&self, column: usize) -> String {
        let letters = self
            .letters
            .get(column)
            .cloned()
            .unwrap_or_else(|| column_letters(column));
        format!("{letters}{}", self.row)
    }

    fn number(&mut self, column: usize, x: f64) {
        let digits = exact(x);
        if !digits.is_empty() {
            self.raw(column, &digits);
        }
    }

    fn raw(&mut self, column: usize, digits: &str) {
        self.text += &format!("<c r=\"{}\"><v>{digits}</v></c>", self.place(column));
    }

    /// A cell with words, which Excel never takes for a formula, whatever they begin with.
    fn word(&mut self, column: usize, word: &str, style: u8) -> io::Result<()> {
        if word.is_empty() {
            return Ok(());
        }
        if word.encode_utf16().count() > MOST_LETTERS {
            let message = format!(
                "a cell of Excel holds at most {MOST_LETTERS} letters, one of row {} has more",
                self.row
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let place = self.place(column);
        self.text += &format!(
            "<c r=\"{place}\" s=\"{style}\" t=\"inlineStr\"><is><t xml:space=\"preserve\">{}</t></is></c>",
            escaped(word)
        );
        Ok(())
    }
}

/// Keeps the first error of a file and takes everything after it without a word: the archive's own end would complain on standard error.
struct FirstError<W> {
    out: W,
    error: Rc<RefCell<Option<io::Error>>>,
}

impl<W: Write> FirstError<W> {
    fn guard(&mut self, done: usize, f: impl FnOnce(&mut W) -> io::Result<usize>) -> usize {
        if self.error.borrow().is_some() {
            return done;
        }
        f(&mut self.out).unwrap_or_else(|error| {
            *self.error.borrow_mut() = Some(error);
            done
        })
    }
}

impl<W: Write> Write for FirstError<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(self.guard(bytes.len(), |out| {
            out.write_all(bytes).map(|()| bytes.len())
        }))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.guard(0, |out| out.flush().map(|()| 0));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Kind;
    use std::io::ErrorKind;

    fn columns() -> Vec<Head> {
        let head = |name: &str, kind| Head {
            name: name.to_owned(),
            unit: "mm".to_owned(),
            doc: "a < b & c".to_owned(),
            kind,
        };
        vec![
            head("count", Kind::Count),
            head("number", Kind::Number),
            head("word", Kind::Text),
        ]
    }

    fn rows(word: &str) -> Rows {
        let numbers: Vec<f64> = (0..200).map(|k| f64::from(k).sqrt()).collect();
        Rows {
            values: vec![
                Values::Count(vec![i64::MAX; 200]),
                Values::Number(numbers),
                Values::Text(vec![word.into(); 200]),
            ],
        }
    }

    fn write(out: impl Write, word: &str) -> io::Result<()> {
        let mut table = XlsxTable::new(out, "runs", &columns())?;
        table.write(&rows(word))?;
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
        for room in 0..whole.len() {
            assert_eq!(
                write(Small(room), "a").map_err(|error| error.kind()),
                Err(ErrorKind::StorageFull),
                "{room} of {}",
                whole.len()
            );
        }
        assert!(write(Small(whole.len()), "a").is_ok());
    }

    #[test]
    fn words_that_are_too_long_are_refused() {
        assert!(write(Vec::new(), &"ä".repeat(MOST_LETTERS)).is_ok());
        let error = write(Vec::new(), &"ä".repeat(MOST_LETTERS + 1)).expect_err("too long");
        assert_eq!(error.kind(), ErrorKind::InvalidInput);
        assert!(error.to_string().contains("of row 2"), "{error}");
    }
}
