//! Committed corpus: `corpus.txt` has one input per line after the name of its target, with each byte outside printable ASCII (and the backslash)
//! escaped as in Rust.

/// Inputs of a target in the corpus.
/// # Errors
/// The number of the first line with an invalid escape, or with bytes that need one.
pub fn inputs(corpus: &str, target: &str) -> Result<Vec<Vec<u8>>, usize> {
    let own = |line: (usize, &'_ str)| -> Option<Result<Vec<u8>, usize>> {
        let (name, input) = line.1.split_once(' ').unwrap_or((line.1, ""));
        (name == target).then(|| unescape(input.as_bytes()).ok_or(line.0 + 1))
    };
    corpus.lines().enumerate().filter_map(own).collect()
}

/// Lines of a target in the corpus: its inputs in order, without repetitions.
#[must_use]
pub fn lines(target: &str, mut inputs: Vec<Vec<u8>>) -> String {
    inputs.sort();
    inputs.dedup();
    let line = |input: &Vec<u8>| format!("{target} {}\n", input.escape_ascii());
    inputs.iter().map(line).collect()
}

/// Unescapes a line. None for an invalid escape, or for a byte that needs one.
#[must_use]
pub fn unescape(line: &[u8]) -> Option<Vec<u8>> {
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
    use super::{inputs, lines};

    #[test]
    fn every_byte_survives() {
        let all: Vec<u8> = (0..=255).collect();
        let own = vec![Vec::new(), all.clone(), all.repeat(2), b"\\x41\n".to_vec()];
        let text = lines("a", own.clone()) + &lines("b", vec![b"a b".to_vec()]);
        assert!(text.is_ascii() && text.lines().count() == 5);
        assert_eq!(inputs(&text, "a"), Ok(own));
        assert_eq!(inputs(&text, "b"), Ok(vec![b"a b".to_vec()]));
    }

    #[test]
    fn wrong_escapes_are_refused_with_their_line() {
        for wrong in ["\\", "\\q", "\\x4", "\\xg0", "a\tb", "\u{e9}"] {
            assert_eq!(
                inputs(&format!("a good\na {wrong}\n"), "a"),
                Err(2),
                "{wrong}"
            );
        }
    }
}
