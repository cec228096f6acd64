//! Numbers for people: the one place where they become text. Files and JSON carry them unrounded.

/// What stands where there is no number.
pub const NONE: &str = "-";

/// A number with fixed decimals; a dash where there is none.
pub fn fixed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    match x.into().filter(|x| x.is_finite()) {
        Some(x) => {
            let text = format!("{x:.decimals$}");
            // A rounded-off negative number is no negative zero.
            if text.trim_start_matches(['-', '0', '.']).is_empty() {
                text.trim_start_matches('-').to_owned()
            } else {
                text
            }
        }
        None => NONE.to_owned(),
    }
}

/// A number with its sign.
pub fn signed(x: impl Into<Option<f64>>, decimals: usize) -> String {
    let x = x.into();
    let text = fixed(x, decimals);
    if x.is_some_and(|x| x > 0.0) && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        format!("+{text}")
    } else {
        text
    }
}

/// A part as per cent of a whole.
pub fn percent(part: impl Into<Option<f64>>, whole: f64, decimals: usize) -> String {
    fixed(part.into().map(|part| part / whole * 100.0), decimals)
}

/// The shortest text of a number that the user gave.
pub fn plain(x: f64) -> String {
    if x.abs() > 0.0 {
        format!("{x}")
    } else {
        "0".to_owned()
    }
}

/// A small error such as 3e-15.
pub fn tiny(x: Option<f64>) -> String {
    match x {
        Some(x) if x.abs() > 0.0 => format!("{x:.0e}"),
        Some(_) => "0".to_owned(),
        None => NONE.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(fixed(-10.04, 1), "-10.0");
        assert_eq!(fixed(f64::NAN, 1), "-");
        assert_eq!(fixed(None, 1), "-");
        assert_eq!(signed(5.26, 1), "+5.3");
        assert_eq!(signed(0.01, 1), "0.0");
        assert_eq!(signed(-14.0, 1), "-14.0");
        assert_eq!(percent(1.0, 4.0, 0), "25");
        assert_eq!(tiny(Some(3.2e-15)), "3e-15");
        assert_eq!(plain(-0.0), "0");
        assert_eq!(plain(0.25), "0.25");
    }
}
