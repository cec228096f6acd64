//! The prescribed gear and clutch commands.
//!
//! A table gives a gear number (0: none engaged) and a note: `PM` neutral with the clutch engaged, `K1`, `K2`, `K5` that gear
//! with the clutch disengaged, `GC` gear change (UN R83 Annex 4a, tables 1 and 2).

use std::fmt;

/// Action of the driver of a manual car over one interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GearCommand {
    /// No gear engaged, clutch engaged.
    Neutral,
    /// This gear engaged (counted from 1), clutch disengaged.
    Declutched(u8),
    /// This gear engaged (counted from 1), clutch engaged.
    InGear(u8),
    /// Gear change under way into this gear (counted from 1); the engine is uncoupled.
    Change(u8),
}

impl GearCommand {
    /// The gear, 0 for none.
    pub fn gear(self) -> u8 {
        match self {
            Self::Neutral => 0,
            Self::Declutched(gear) | Self::InGear(gear) | Self::Change(gear) => gear,
        }
    }
}

/// The gear number with the note of a table, as in `2 GC`.
impl fmt::Display for GearCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Neutral => f.write_str("0 PM"),
            Self::Declutched(gear) => write!(f, "{gear} K{gear}"),
            Self::InGear(gear) => write!(f, "{gear}"),
            Self::Change(gear) => write!(f, "{gear} GC"),
        }
    }
}

/// The note with a gear number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Note {
    /// No note: the gear number says all.
    #[default]
    Blank,
    /// A number, by which a table repeats its gear; the gear number counts.
    Gear(u8),
    /// PM.
    Neutral,
    /// K with a gear number.
    Declutched(u8),
    /// GC.
    Change,
}

impl Note {
    /// The note of a table's text, `None` if it is none of the known ones.
    pub fn parse(text: &str) -> Option<Self> {
        if text.is_empty() {
            return Some(Self::Blank);
        }
        if text.eq_ignore_ascii_case("pm") {
            return Some(Self::Neutral);
        }
        if text.eq_ignore_ascii_case("gc") {
            return Some(Self::Change);
        }
        let declutched = text.strip_prefix(['K', 'k']);
        let digits = declutched.unwrap_or(text);
        // u8::from_str would take K+1
        if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let gear = digits.parse::<u8>().ok()?;
        match declutched {
            Some(_) => (1..=10).contains(&gear).then_some(Self::Declutched(gear)),
            None => (0..=10).contains(&gear).then_some(Self::Gear(gear)),
        }
    }
}

/// Commands of a table's rows (gear number and note). A change goes into the row's own gear or, where the row has none,
/// into the next one engaged; a change after which no gear ever comes is a change to neutral.
pub fn commands<I>(rows: I) -> Vec<GearCommand>
where
    I: DoubleEndedIterator<Item = (u8, Note)>,
{
    let mut next = 0;
    let mut list: Vec<GearCommand> = rows
        .rev()
        .map(|(gear, note)| {
            let command = match note {
                Note::Neutral => GearCommand::Neutral,
                Note::Declutched(gear) => GearCommand::Declutched(gear),
                Note::Change if gear.max(next) == 0 => GearCommand::Neutral,
                Note::Change if gear > 0 => GearCommand::Change(gear),
                Note::Change => GearCommand::Change(next),
                Note::Blank | Note::Gear(_) if gear > 0 => GearCommand::InGear(gear),
                Note::Blank | Note::Gear(_) => GearCommand::Neutral,
            };
            if command.gear() > 0 {
                next = command.gear();
            }
            command
        })
        .collect();
    list.reverse();
    list
}

/// The gear columns of a trace, one command an interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GearColumns {
    /// `gear_5mt`: for five gears only.
    five: Option<Vec<GearCommand>>,
    /// `gear_6mt`: for six gears only.
    pub six: Option<Vec<GearCommand>>,
    /// `gear`: for every gearbox that has these gears.
    plain: Option<Vec<GearCommand>>,
    plain_highest: u8,
}

impl GearColumns {
    /// Commands for five gears, for six, and for any number of gears.
    pub fn new(
        five: Option<Vec<GearCommand>>,
        six: Option<Vec<GearCommand>>,
        plain: Option<Vec<GearCommand>>,
    ) -> Self {
        let plain_highest = plain
            .iter()
            .flatten()
            .map(|command| command.gear())
            .max()
            .unwrap_or(0);
        Self {
            five,
            six,
            plain,
            plain_highest,
        }
    }

    /// The columns there are, with their names in a table.
    pub fn columns(&self) -> impl Iterator<Item = (&'static str, &[GearCommand])> {
        let all = [
            ("gear_5mt", &self.five),
            ("gear_6mt", &self.six),
            ("gear", &self.plain),
        ];
        all.into_iter()
            .filter_map(|(name, column)| Some((name, column.as_deref()?)))
    }

    /// The columns with one command for each of some intervals, by their numbers.
    #[must_use]
    pub fn at_intervals(&self, intervals: &[usize]) -> Self {
        let of = |column: &Option<Vec<GearCommand>>| {
            let column = column.as_ref()?;
            Some(intervals.iter().map(|i| column[*i]).collect())
        };
        Self {
            five: of(&self.five),
            six: of(&self.six),
            plain: of(&self.plain),
            plain_highest: self.plain_highest,
        }
    }

    /// True without any column.
    pub fn is_empty(&self) -> bool {
        self.five.is_none() && self.six.is_none() && self.plain.is_none()
    }

    /// A column made for just this number of gears goes before the general one.
    pub fn for_count(&self, gear_count: usize) -> Option<&[GearCommand]> {
        let exact = match gear_count {
            5 => self.five.as_deref(),
            6 => self.six.as_deref(),
            _ => None,
        };
        let fits = usize::from(self.plain_highest) <= gear_count;
        exact.or_else(|| self.plain.as_deref().filter(|_| fits))
    }
}
