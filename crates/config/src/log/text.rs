//! Bytes of a file to text, in the encoding that they are in.

use std::borrow::Cow;

use crate::Problem;
use crate::csv::{MAX_LINE_LEN, empty, long_line};

/// First bytes of files that are no text, and what reads them.
const BINARY: [(&[u8], &str); 6] = [
    (b"MDF     ", "an MDF file"),
    (b"PK\x03\x04", "a workbook or another archive"),
    (b"MATLAB 5.0", "a MAT file"),
    (b"\x89HDF", "an HDF5 or MAT 7.3 file"),
    (b"PAR1", "a Parquet file"),
    (b"\xd0\xcf\x11\xe0", "a workbook in the old form"),
];

/// Text of a file.
pub(crate) struct Text<'b> {
    pub text: Cow<'b, str>,
    /// Name of an encoding other than UTF-8.
    pub encoding: Option<&'static str>,
}

/// Decodes UTF-8, UTF-16 with or without byte order mark, and else Windows-1252, which holds Latin-1 and every byte.
///
/// # Errors
/// Files that are no text, with `frame` as the call that takes a frame of them; no text at all.
pub(crate) fn decode<'b>(bytes: &'b [u8], frame: &str) -> Result<Text<'b>, Problem> {
    if let Some((_, what)) = BINARY.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(
            Problem::syntax(format!("this is {what}, and no table in text"))
                .allowed("a table in text, such as CSV")
                .hint(format!("read it with Python and give its frame: {frame}")),
        );
    }
    let (text, encoding) = decoded(bytes);
    // A recorder that lost its power leaves zeros at the end.
    let text = match text.ends_with('\0') {
        true => Cow::Owned(text.trim_end_matches('\0').to_owned()),
        false => text,
    };
    if let Some(at) = text.find('\0') {
        let line = text[..at].matches('\n').count() + 1;
        return Err(Problem::syntax(format!(
            "the file is not text: it has a zero byte in line {line}"
        ))
        .allowed("a table in text, such as CSV")
        .hint("save the table as CSV; a spreadsheet's own format cannot be read"));
    }
    let lines = text.split('\n').enumerate();
    if let Some((before, _)) = lines
        .into_iter()
        .find(|(_, line)| line.len() >= MAX_LINE_LEN)
    {
        return Err(long_line(before + 1));
    }
    if text.trim().is_empty() {
        return Err(empty());
    }
    // Lines of old instruments end with a carriage return alone.
    let text = match text.contains('\r') && !text.contains('\n') {
        true => Cow::Owned(text.replace('\r', "\n")),
        false => text,
    };
    Ok(Text { text, encoding })
}

#[cfg(not(target_family = "wasm"))]
fn decoded(bytes: &[u8]) -> (Cow<'_, str>, Option<&'static str>) {
    use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
    let marked = Encoding::for_bom(bytes).map(|(encoding, _)| encoding);
    let encoding = match (marked, zeros(bytes)) {
        (Some(encoding), _) => encoding,
        (None, Some(true)) => UTF_16LE,
        (None, Some(false)) => UTF_16BE,
        (None, None) if std::str::from_utf8(bytes).is_ok() => UTF_8,
        (None, None) => WINDOWS_1252,
    };
    let (text, _, _) = encoding.decode(bytes);
    (text, (encoding != UTF_8).then(|| encoding.name()))
}

/// A page has its file decoded by the browser.
#[cfg(target_family = "wasm")]
fn decoded(bytes: &[u8]) -> (Cow<'_, str>, Option<&'static str>) {
    (String::from_utf8_lossy(bytes), None)
}

/// UTF-16 without byte order mark: letters of ASCII have a zero as every second byte. True where the second byte of each is it.
#[cfg(not(target_family = "wasm"))]
fn zeros(bytes: &[u8]) -> Option<bool> {
    const SAMPLE: usize = 512;
    let sample = &bytes[..bytes.len().min(SAMPLE) & !1];
    let count = |at: usize| {
        let zeros = sample.iter().skip(at).step_by(2);
        zeros.filter(|byte| **byte == 0).count()
    };
    let most = |zeros: usize| 10 * zeros >= 9 * (sample.len() / 2) && zeros > 4;
    match (count(0), count(1)) {
        (0, odd) if most(odd) => Some(true),
        (even, 0) if most(even) => Some(false),
        _ => None,
    }
}
