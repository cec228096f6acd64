//! Values of the model's keys, read from a table of a file.
use crate::document::Value;
use crate::problem::Problem;
use crate::reader::maps;
use crate::reader::recorded::Typed;
use crate::reader::section::Section;
use crate::reader::value::{Lookup, default_option, options};
use cvtcycle_model::keys::file_table::{FileRows, FileTable};
use cvtcycle_model::keys::{Key, Kind, Presence, Values};
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::maps::{Basis, BsfcMap};

impl<'r> Values for Section<'r> {
    fn table(&self, name: &str) -> Self {
        Section::table(self, name)
    }

    fn exists(&self) -> bool {
        let exists = Section::exists(self);
        self.reader
            .record(|log| log.values.exists(&self.path, exists));
        exists
    }

    fn has(&self, key: &Key<'static>) -> bool {
        let has = Section::has(self, key.name);
        self.reader
            .record(|log| log.values.given(&self.path, key.name, has));
        has
    }

    fn number(&self, key: &Key<'static>) -> f64 {
        match key.presence {
            Presence::Number(default) => Values::number_or(self, key, default),
            _ => {
                let number = self.read_number(key, key.range());
                let number = number.unwrap_or_else(|absent| {
                    if absent {
                        self.report_missing(key);
                    }
                    f64::NAN
                });
                self.keep_number(key, number)
            }
        }
    }

    fn number_or(&self, key: &Key<'static>, default: f64) -> f64 {
        debug_assert!(key.range().contains(default), "default of {}", key.name);
        let number = self.read_number(key, key.range());
        let number = number.unwrap_or_else(|absent| {
            if !absent {
                return f64::NAN;
            }
            let si = key.quantity.to_si(default);
            self.defaulted(key.name, default, Some(si));
            si
        });
        self.keep_number(key, number)
    }

    fn optional(&self, key: &Key<'static>) -> Option<f64> {
        let number = self.read_number(key, key.range());
        self.keep_number(key, number.unwrap_or(f64::NAN));
        match number {
            Ok(si) => Some(si),
            Err(absent) => (!absent).then_some(f64::NAN),
        }
    }

    fn integer(&self, key: &Key<'static>) -> i64 {
        let integer = self.read_integer(key);
        self.keep_number(key, integer as f64);
        integer
    }

    fn flag(&self, key: &Key<'static>) -> bool {
        self.keep(key, self.read_flag(key), Typed::Flag)
    }

    fn text(&self, key: &Key<'static>) -> String {
        let default = match key.presence {
            Presence::Required | Presence::RequiredIf(_) => None,
            Presence::Word(default) => Some(default),
            _ => Some(""),
        };
        let text = match self.read_text(key) {
            Ok(text) => text,
            Err(false) => String::new(),
            Err(true) => {
                match default {
                    Some(default) => self.defaulted(key.name, default, None),
                    None => self.report_missing(key),
                }
                default.unwrap_or_default().to_owned()
            }
        };
        self.keep(key, text, Typed::Text)
    }

    fn text_or(&self, key: &Key<'static>, default: &str) -> String {
        let text = self.read_text(key).unwrap_or_else(|absent| {
            if !absent {
                return String::new();
            }
            self.defaulted(key.name, default, None);
            default.to_string()
        });
        self.keep(key, text, Typed::Text)
    }

    fn texts(&self, key: &Key<'static>) -> Vec<String> {
        self.keep(key, self.read_texts(key), Typed::Texts)
    }

    fn word(&self, key: &Key<'static>) -> &'static str {
        let default = default_option(key).unwrap_or_default();
        self.keep(key, self.read_word(key, default), Typed::Word)
    }

    fn choose(&self, key: &Key<'static>) -> (&'static str, Self) {
        let (option, section) = self.choose_option(key);
        (self.keep(key, option, Typed::Word), section)
    }

    fn numbers(&self, key: &Key<'static>) -> Vec<f64> {
        self.keep(key, self.read_numbers(key), Typed::Numbers)
    }

    fn rows(&self, key: &Key<'static>) -> Option<Vec<Vec<f64>>> {
        let before = self.reader.problem_count();
        let rows = self.read_rows(key);
        if self.reader.problem_count() > before {
            return None;
        }
        if matches!(key.presence, Presence::Required) && !Section::has(self, key.name) {
            self.report_missing(key);
            return None;
        }
        Some(self.keep(key, rows, Typed::Rows))
    }

    fn loss_map(&self, key: &Key<'static>, first: &'static str) -> Option<LossMap> {
        let file = self.read_csv_name(key).ok();
        let map = file.and_then(|file| maps::loss_map(self, key.name, file.into(), first));
        self.keep(key, map, Typed::LossMap)
    }

    fn file_table(&self, key: &Key<'static>, table: &'static FileTable) -> Option<FileRows> {
        let rows = match self.read_csv_name(key) {
            Ok(file) => maps::file_table(self, key.name, file.into(), table),
            Err(absent) => {
                if absent && matches!(key.presence, Presence::Required) {
                    self.report_missing(key);
                }
                None
            }
        };
        self.keep(key, rows, Typed::FileRows)
    }

    fn bsfc_map(&self, key: &Key<'static>, basis: &Basis) -> Option<BsfcMap> {
        let file = self.read_csv_name(key);
        if file == Err(true) {
            self.report_missing(key);
        }
        let table = maps::bsfc_table(self, key.name, file.ok()?.into())?;
        let map = table.bsfc_map(basis);
        self.keep(key, table, Typed::BsfcMap);
        map.unwrap_or_else(|why| {
            self.report_at(key.name, maps::no_bsfc_map(why));
            None
        })
    }

    fn complain(&self, key: &str, allowed: &str, message: &str, hint: &str) {
        let problem = Problem::conflict(message).allowed(allowed).hint(hint);
        self.report_at(key, problem);
    }
}

impl Section<'_> {
    /// Records a value, and returns it.
    fn keep<T: Clone>(&self, key: &Key<'static>, value: T, typed: impl FnOnce(T) -> Typed) -> T {
        self.reader
            .record(|log| log.values.other(&self.path, key, typed(value.clone())));
        value
    }

    /// Records a number in SI units, and returns it.
    fn keep_number(&self, key: &Key<'static>, si: f64) -> f64 {
        self.reader
            .record(|log| log.values.number(&self.path, key, si));
        si
    }

    /// An integer; the default also after a problem.
    fn read_integer(&self, key: &Key<'_>) -> i64 {
        let (low, high) = match key.kind {
            Kind::Integer(low, high) => (low, high),
            _ => (i64::MIN, i64::MAX),
        };
        let default = match key.presence {
            Presence::Integer(default) => default,
            _ => low,
        };
        let si = |value: i64| Some(key.quantity.to_si(value as f64));
        let found = match self.open(key) {
            Lookup::Found(found) => found,
            Lookup::Bad => return default,
            Lookup::Absent => {
                self.defaulted(key.name, default, si(default));
                return default;
            }
        };
        match found.node.value {
            Value::Integer(value) if (low..=high).contains(&value) => {
                self.given(key.name, &found, value, si(value));
                value
            }
            Value::Integer(_) => {
                self.report_out_of_range(key.name, found.node, &key.allowed());
                default
            }
            _ => {
                self.wrong_type(key.name, found.node, "an integer");
                default
            }
        }
    }

    /// A truth value; the default also after a problem.
    fn read_flag(&self, key: &Key<'_>) -> bool {
        let default = matches!(key.presence, Presence::Flag(true));
        match self.open(key) {
            Lookup::Found(found) => {
                if let Value::Boolean(value) = found.node.value {
                    self.given(key.name, &found, value, None);
                    return value;
                }
                self.wrong_type(key.name, found.node, "true or false");
            }
            Lookup::Absent => self.defaulted(key.name, default, None),
            Lookup::Bad => {}
        }
        default
    }

    /// One of the key's words; the default also after a problem.
    pub(crate) fn read_word(&self, key: &Key<'_>, default: &'static str) -> &'static str {
        match self.open(key) {
            Lookup::Found(found) => {
                let Value::Text(text) = &found.node.value else {
                    self.wrong_type(key.name, found.node, "text");
                    return default;
                };
                if let Some(word) = options(key).find(|word| word == text) {
                    self.given(key.name, &found, text, None);
                    return word;
                }
                self.unknown_word(key, &found.node.span, text);
            }
            Lookup::Absent => self.defaulted(key.name, default, None),
            Lookup::Bad => {}
        }
        default
    }
}
