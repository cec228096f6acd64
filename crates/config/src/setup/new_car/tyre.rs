//! Tyre codes.

/// Width mm, height over width in per cent, and rim in inches of a tyre code such as 215/55 R16; what is before and behind it on a tyre, as in
/// P215/55 ZR16 91V, is passed over.
pub(super) fn tyre(code: &str) -> Option<[f64; 3]> {
    let (width, rest) = code.trim().split_once('/')?;
    let width = width.strip_prefix(['P', 'p']).unwrap_or(width);
    let (height, rim) = rest.split_once(['R', 'r'])?;
    let rim = rim.trim_start();
    let end = rim.find(|c: char| !(c.is_ascii_digit() || c == '.'));
    let (rim, behind) = rim.split_at(end.unwrap_or(rim.len()));
    let is_known = |c: char| c.is_ascii_alphanumeric() || c == ' ';
    if !behind.chars().all(is_known) {
        return None;
    }
    let height = height.trim_end_matches(|c: char| c.is_ascii_alphabetic() || c == ' ');
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let found = [number(width)?, number(height)?, number(rim)?];
    let ranges = [125.0..=355.0, 20.0..=90.0, 10.0..=24.0];
    let fits = found.iter().zip(ranges).all(|(x, range)| range.contains(x));
    fits.then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tyre_codes_are_read() {
        for good in [
            "215/55 R16",
            "215/55R16",
            "215/55 r16",
            "215/55 ZR16",
            "215/55 ZR16 93W",
            "P215/55R16 91V XL",
            "215/55R16C",
        ] {
            assert_eq!(tyre(good), Some([215.0, 55.0, 16.0]), "{good}");
        }
        for bad in [
            "215/55",
            "55/215 R16",
            "215-55-16",
            "R16",
            "215/55 R",
            "215/55 R160",
            "215/55 R16/91",
        ] {
            assert_eq!(tyre(bad), None, "{bad}");
        }
    }
}
