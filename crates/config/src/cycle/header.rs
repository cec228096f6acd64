//! The line of column names, looked at before any value is.

use std::mem::discriminant;

use super::problems::{Collector, Complaint, Line};
use super::text::Field;

/// Unit of the speed column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SpeedUnit {
    KmH,
    MS,
    Mph,
}

impl SpeedUnit {
    // the international mile, exact by definition
    const KM_PER_MILE: f64 = 1.609_344;

    pub(super) fn kmh(self, value: f64) -> f64 {
        match self {
            Self::KmH => value,
            Self::MS => value * 3.6,
            Self::Mph => value * Self::KM_PER_MILE,
        }
    }

    pub(super) fn m_s(self, value: f64) -> f64 {
        match self {
            Self::KmH => value / 3.6,
            Self::MS => value,
            Self::Mph => value * Self::KM_PER_MILE / 3.6,
        }
    }
}

/// What a column says. Two names of the same variant are two ways of giving the same thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Column {
    Time,
    Speed(SpeedUnit),
    Phase,
    Gear,
    Gear5,
    Gear6,
    GearNote,
    Operation,
    /// With the number by which the column is divided to give rise over run.
    Grade(f64),
    EngineOff,
}

impl Column {
    /// Highest gear that a gear column can name.
    pub(super) fn highest_gear(self) -> Option<u8> {
        match self {
            Self::Gear => Some(10),
            Self::Gear5 => Some(5),
            Self::Gear6 => Some(6),
            _ => None,
        }
    }
}

const COLUMNS: [(&str, Column); 14] = [
    ("time_s", Column::Time),
    ("speed_kmh", Column::Speed(SpeedUnit::KmH)),
    ("speed_km_h", Column::Speed(SpeedUnit::KmH)),
    ("speed_m_s", Column::Speed(SpeedUnit::MS)),
    ("speed_mph", Column::Speed(SpeedUnit::Mph)),
    ("phase", Column::Phase),
    ("gear", Column::Gear),
    ("gear_5mt", Column::Gear5),
    ("gear_6mt", Column::Gear6),
    ("gear_note", Column::GearNote),
    ("operation", Column::Operation),
    ("grade_percent", Column::Grade(100.0)),
    ("grade", Column::Grade(1.0)),
    ("engine_off", Column::EngineOff),
];

const SPEEDS: &str = "speed_kmh, speed_km_h, speed_m_s or speed_mph";

/// The columns of a file, in its order; `None` for one that is not read.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) columns: Vec<Option<(Column, &'static str)>>,
}

impl Header {
    pub(super) fn has(&self, column: Column) -> bool {
        self.columns
            .iter()
            .flatten()
            .any(|known| discriminant(&known.0) == discriminant(&column))
    }

    fn has_gear(&self) -> bool {
        self.columns
            .iter()
            .flatten()
            .any(|known| known.0.highest_gear().is_some())
    }

    /// Highest gear that every gear column of the file can name.
    pub(super) fn highest_gear(&self) -> u8 {
        self.columns
            .iter()
            .flatten()
            .filter_map(|known| known.0.highest_gear())
            .min()
            .unwrap_or(10)
    }

    /// Reads the column names. `None` where the rest of the file cannot be understood without them.
    pub(super) fn read(line: Line<'_>, problems: &mut Collector<'_>) -> Option<Self> {
        let fields = problems.names(line)?;
        if fields.iter().all(|field| field.text.parse::<f64>().is_ok()) {
            let hint = "put the names above the numbers, for example time_s,speed_kmh";
            problems.line(line, "", || {
                Complaint::new("the first line has numbers and no column names", "", hint)
            });
            return None;
        }
        let mut header = Self {
            columns: Vec::with_capacity(fields.len()),
        };
        for field in fields {
            let known = header.column(line, field, problems);
            header.columns.push(known);
        }
        header.require(line, problems);
        Some(header)
    }

    fn column(
        &self,
        line: Line<'_>,
        field: Field<'_>,
        problems: &mut Collector<'_>,
    ) -> Option<(Column, &'static str)> {
        let Some(&(name, column)) = COLUMNS.iter().find(|known| known.0 == field.text) else {
            problems.value(line, field, field.text, || unknown(field.text));
            return None;
        };
        let first = self
            .columns
            .iter()
            .flatten()
            .find(|known| discriminant(&known.0) == discriminant(&column));
        let Some(&(_, first)) = first else {
            return Some((column, name));
        };
        problems.value(line, field, name, || {
            if first == name {
                return Complaint::new(
                    "this column stands here twice",
                    "each column once",
                    "remove one of them",
                );
            }
            Complaint::new(
                format!("{name} and {first} say the same thing"),
                "one of them",
                "remove one of them",
            )
        });
        None
    }

    fn require(&self, line: Line<'_>, problems: &mut Collector<'_>) {
        if !self.has(Column::Time) {
            let hint = "name the column of the time in seconds time_s";
            problems.line(line, "time_s", || {
                Complaint::new("the column time_s is missing", "time_s", hint)
            });
        }
        if !self.has(Column::Speed(SpeedUnit::KmH)) {
            let hint = "name the column of the speed after its unit";
            problems.line(line, "speed_kmh", || {
                Complaint::new("a column with the speed is missing", SPEEDS, hint)
            });
        }
        if self.has(Column::GearNote) && !self.has_gear() {
            let hint = "add a column gear, 0 where none is engaged";
            problems.line(line, "gear_note", || {
                Complaint::new(
                    "gear_note needs a column with the gears",
                    "gear, gear_5mt or gear_6mt",
                    hint,
                )
            });
        }
    }
}

fn unknown(name: &str) -> Complaint {
    if name.is_empty() {
        return Complaint::new(
            "this column has no name",
            "",
            "remove the comma or name the column",
        );
    }
    let lower = name.to_lowercase();
    let mut near: Vec<(f64, &str)> = COLUMNS
        .iter()
        .map(|known| (strsim::jaro_winkler(&lower, known.0), known.0))
        .collect();
    near.retain(|candidate| candidate.0 > 0.8);
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    let near: Vec<&str> = near
        .into_iter()
        .take(4)
        .map(|candidate| candidate.1)
        .collect();
    let all = COLUMNS.map(|known| known.0).join(", ");
    let hint = if near.is_empty() {
        "remove it or rename it".to_owned()
    } else {
        format!("near names: {}", near.join(", "))
    };
    Complaint::new("there is no such column", all, hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Problems;

    fn read(text: &str) -> (Option<Header>, Problems) {
        let mut problems = Collector::new("f.csv");
        let header = Header::read(Line { number: 1, text }, &mut problems);
        (header, problems.finish())
    }

    #[test]
    fn all_columns_are_known_in_any_order() {
        let (header, problems) = read(
            "engine_off, phase,\"speed_mph\",time_s,gear_note,gear_6mt,gear_5mt,gear,operation,grade_percent",
        );
        assert!(problems.is_empty());
        let header = header.unwrap();
        assert_eq!(
            header.columns[2],
            Some((Column::Speed(SpeedUnit::Mph), "speed_mph"))
        );
        assert_eq!((header.columns.len(), header.highest_gear()), (10, 5));
    }

    #[test]
    fn unknown_columns_name_the_near_ones() {
        for (wrong, near) in [
            ("time", "time_s"),
            ("Speed_kmh", "speed_kmh"),
            ("speed", "speed_mph"),
            ("grade_pct", "grade_percent"),
            ("engin_off", "engine_off"),
        ] {
            let (_, problems) = read(&format!("time_s,speed_kmh,{wrong}"));
            assert_eq!(
                (problems[0].key.as_str(), problems[0].place.column),
                (wrong, 18)
            );
            assert!(
                problems[0].hint.contains(near),
                "{wrong}: {}",
                problems[0].hint
            );
        }
        assert_eq!(
            read("time_s,speed_kmh,wibble").1[0].hint,
            "remove it or rename it"
        );
        assert_eq!(
            read("time_s,speed_kmh,").1[0].message,
            "this column has no name"
        );
    }

    #[test]
    fn doubles_and_gaps_are_found_together() {
        let (_, problems) = read("time_s,time_s,grade,grade_percent,gear_note");
        let messages: Vec<&str> = problems
            .iter()
            .map(|problem| problem.message.as_str())
            .collect();
        let expected = [
            "this column stands here twice",
            "grade_percent and grade say the same thing",
            "a column with the speed is missing",
            "gear_note needs a column with the gears",
        ];
        assert_eq!(messages, expected);
        assert!(
            read("speed_kmh,speed_m_s").1[1]
                .message
                .contains("time_s is missing")
        );
    }

    #[test]
    fn other_separators_end_the_reading() {
        for (text, message) in [
            ("time_s;speed_kmh", "this file uses ; - save it with commas"),
            (
                "time_s\tspeed_kmh",
                "this file uses tabs - save it with commas",
            ),
            ("0,0.0", "the first line has numbers and no column names"),
            ("time_s,\"speed", "this quote is not closed"),
        ] {
            let (header, problems) = read(text);
            assert!(header.is_none() && problems.len() == 1);
            assert_eq!(problems[0].message, message);
        }
    }
}
