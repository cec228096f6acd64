//! The committed corpus: `corpus/TARGET.txt`, one input a line, each byte outside printable ASCII (and the backslash) escaped as in Rust.

/// The inputs of a file of the corpus.
///
/// # Errors
/// The number of the first line that holds a wrong escape, or bytes that need one.
pub fn parse(text: &str) -> Result<Vec<Vec<u8>>, usize> {
    let lines = text.lines().enumerate();
    lines
        .map(|(at, line)| unescape(line.as_bytes()).ok_or(at + 1))
        .collect()
}

/// A file of the corpus: its inputs in order, each once.
#[must_use]
pub fn format(mut inputs: Vec<Vec<u8>>) -> String {
    inputs.sort();
    inputs.dedup();
    let line = |input: &Vec<u8>| input.escape_ascii().to_string() + "\n";
    inputs.iter().map(line).collect()
}

fn unescape(line: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(line.len());
    let mut rest = line.iter().copied();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'\\' => match rest.next()? {
                b't' => b'\t',
                b'r' => b'\r',
                b'n' => b'\n',
                b'x' => {
                    let mut digit = || char::from(rest.next()?).to_digit(16);
                    u8::try_from(digit()? * 16 + digit()?).ok()?
                }
                quoted @ (b'\\' | b'\'' | b'"') => quoted,
                _ => return None,
            },
            b' '..=b'~' => byte,
            _ => return None,
        });
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::{format, parse};

    #[test]
    fn every_byte_survives() {
        let all: Vec<u8> = (0..=255).collect();
        let inputs = vec![Vec::new(), all.clone(), all.repeat(2), b"\\x41\n".to_vec()];
        let text = format(inputs.clone());
        assert!(text.is_ascii() && text.lines().count() == 4);
        assert_eq!(parse(&text), Ok(inputs));
    }

    #[test]
    fn wrong_escapes_are_refused_with_their_line() {
        for wrong in ["\\", "\\q", "\\x4", "\\xg0", "a\tb", "\u{e9}"] {
            assert_eq!(parse(&format!("good\n{wrong}\n")), Err(2), "{wrong}");
        }
    }
}
