//! Edits of a shipped text, to reach code behind the parser.

use super::Bytes;

/// Replacements for a number, a text or a list of a file.
const VALUES: [&str; 40] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-300",
    "5e-324",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fffffffffffffff",
    "true",
    "false",
    "\"\"",
    "\"x\"",
    "\"ece15_eudc\"",
    "\"rover_216_cvt\"",
    "\"1 +\"",
    "\"((((((((\"",
    "\"a.b.c\"",
    "''''''",
    "2026-11-21",
    "12:00:00",
    "[]",
    "[[]]",
    "[0, 0]",
    "[[0, 0]]",
    "[[2, 1], [1, 2]]",
    "[nan]",
    "[\"a\", 1]",
    "{}",
    "{ value = 1 }",
    "{ value = 1, status = \"fitted\", source = \"x\" }",
];

/// Maximum number of edits of a text.
const MAX_EDITS: usize = 24;

/// Returns the remaining bytes unchanged, or a shipped text with edits.
pub fn text(data: &[u8], shipped: &[&str]) -> Vec<u8> {
    let mut bytes = Bytes(data);
    let which = usize::from(bytes.byte()) % (shipped.len() + 1);
    if which == 0 {
        return bytes.rest().to_vec();
    }
    let mut lines: Vec<String> = shipped[which - 1].lines().map(str::to_owned).collect();
    for _ in 0..MAX_EDITS {
        if bytes.is_empty() || lines.is_empty() {
            break;
        }
        edit(&mut lines, &mut bytes);
    }
    lines.join("\n").into_bytes()
}

fn edit(lines: &mut Vec<String>, bytes: &mut Bytes) {
    let way = bytes.byte();
    let at = usize::from(bytes.short()) % lines.len();
    let other = |bytes: &mut Bytes, lines: &[String]| usize::from(bytes.short()) % lines.len();
    match way % 10 {
        0 | 1 => {
            let value = bytes.pick(&VALUES);
            set_value(&mut lines[at], value);
        }
        2 => {
            let number = bytes.number();
            set_value(&mut lines[at], &format!("{number:?}"));
        }
        3 => drop(lines.remove(at)),
        4 => {
            let line = lines[other(bytes, lines)].clone();
            lines.insert(at, line);
        }
        5 => {
            let with = other(bytes, lines);
            lines.swap(at, with);
        }
        6 => {
            let key = lines[other(bytes, lines)]
                .split('=')
                .next()
                .unwrap_or_default()
                .to_owned();
            let rest = lines[at]
                .split_once('=')
                .map_or(String::new(), |(_, rest)| format!("={rest}"));
            lines[at] = key + &rest;
        }
        7 => {
            let end = floor(&lines[at], usize::from(bytes.byte()));
            lines[at].truncate(end);
        }
        8 => {
            let place = floor(&lines[at], usize::from(bytes.byte()));
            let count = usize::from(bytes.byte() % 16);
            let junk: Vec<u8> = (0..count).map(|_| bytes.byte()).collect();
            lines[at].insert_str(place, &String::from_utf8_lossy(&junk));
        }
        _ => {
            // Deep nesting or long text from a few bytes.
            let unit = bytes.pick(&[
                "[", "{a=", "a.", "(", "1,", "\"", "[[a]]\n", "-", "a=1\n", "{",
            ]);
            let count = usize::from(bytes.short()) % 3000;
            set_value(&mut lines[at], &unit.repeat(count));
        }
    }
}

/// Nearest character boundary at or before a byte.
fn floor(line: &str, at: usize) -> usize {
    (0..=at.min(line.len()))
        .rev()
        .find(|at| line.is_char_boundary(*at))
        .unwrap_or(0)
}

fn set_value(line: &mut String, value: &str) {
    let end = line.find('=').map_or(line.len(), |equals| equals + 1);
    line.truncate(end);
    line.push(' ');
    line.push_str(value);
}
