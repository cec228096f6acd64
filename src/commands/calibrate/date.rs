//! The day that fitted values bear.

use std::time::{SystemTime, UNIX_EPOCH};

const DAY_S: u64 = 86_400;

/// Today as YYYY-MM-DD, in universal time; the day of `SOURCE_DATE_EPOCH` where that is set, so that files can be made again byte for byte.
pub fn today() -> String {
    let given = std::env::var("SOURCE_DATE_EPOCH").ok();
    let given = given.and_then(|text| text.trim().parse::<u64>().ok());
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.map_or(0, |since| since.as_secs());
    date(given.unwrap_or(now) / DAY_S)
}

/// The date so many days after 1 January 1970 in the Gregorian calendar, up to the year 9999.
fn date(days: u64) -> String {
    // Counted from 1 March of the year 0, so that a leap day is the last of its year and months have a fixed pattern of lengths.
    let days = days.min(2_932_896) + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year_of_era = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn val_known_days() {
        // As `date -u -d @SECONDS +%F` has them.
        assert_eq!(
            [0, 58, 59].map(date),
            ["1970-01-01", "1970-02-28", "1970-03-01"]
        );
        assert_eq!(
            [11_016, 11_017, 19_782].map(date),
            ["2000-02-29", "2000-03-01", "2024-02-29"]
        );
        assert_eq!([20_819, u64::MAX].map(date), ["2027-01-01", "9999-12-31"]);
    }
}
