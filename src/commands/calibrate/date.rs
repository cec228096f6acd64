//! The day that fitted values bear.

use std::time::{SystemTime, UNIX_EPOCH};

/// Today as YYYY-MM-DD, in universal time; the day of `SOURCE_DATE_EPOCH` where that is set, so that files can be made again byte for byte.
pub fn today() -> String {
    let asked = std::env::var("SOURCE_DATE_EPOCH")
        .ok()
        .and_then(|text| text.trim().parse::<u64>().ok());
    let now_s = asked.unwrap_or_else(|| {
        SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_secs())
    });
    date(now_s / 86_400)
}

/// The date so many days after 1 January 1970 in the Gregorian calendar, up to the year 9999.
fn date(days: u64) -> String {
    let leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let (mut year, mut left) = (1970, days.min(2_932_896));
    while left >= 365 + u64::from(leap(year)) {
        left -= 365 + u64::from(leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [
        31,
        28 + u64::from(leap(year)),
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ] {
        if left < length {
            break;
        }
        left -= length;
        month += 1;
    }
    format!("{year:04}-{month:02}-{:02}", left + 1)
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn val_known_days() {
        // As `date -u -d @SECONDS +%F` has them.
        let known = [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
        ];
        for (days, wanted) in known.into_iter().chain([
            (19_782, "2024-02-29"),
            (20_819, "2027-01-01"),
            (u64::MAX, "9999-12-31"),
        ]) {
            assert_eq!(date(days), wanted);
        }
    }
}
