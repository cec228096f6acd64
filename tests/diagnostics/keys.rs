//! Every key of every shipped vehicle, lubricant and rig, and of every option that they do not choose, with a bad value of every sort.
//!
//! The readers register the keys with range and kind, so nothing is listed by hand. A file is written with one key per line, one
//! line is made bad, and there must be one problem, at that line and column, with the key, the value as written and the registered range.
//! Keys of plans, rows and covers are not registered that way; their rules have bad files.

use std::collections::{BTreeMap, BTreeSet};

use cvtcycle::config::setup::{Kind, Options, catalogue, load, load_lubricant};
use cvtcycle::config::{Document, KeyInfo, Override, Problem, Problems, Reader};

use super::kinds::written;

/// Sorts of mistake.
const SORTS: [&str; 8] = [
    "low", "high", "nan", "type", "word", "missing", "misspelt", "twice",
];

/// File with one key per line.
#[derive(Clone)]
struct Plain {
    kind: Kind,
    /// Keys with values, by table.
    tables: BTreeMap<String, Vec<(String, String)>>,
}

/// Text, and the place of a key's line in it.
struct Text {
    text: String,
    line: usize,
    /// Line of the header of the key's table; 0 for the top of the file.
    header: usize,
}

impl Plain {
    fn new(kind: Kind, keys: &[KeyInfo]) -> Self {
        let mut plain = Plain {
            kind,
            tables: BTreeMap::new(),
        };
        let chosen = |info: &KeyInfo| {
            keys.iter().any(|other| {
                other
                    .key
                    .starts_with(&format!("{}.{}.", info.key, info.value))
            })
        };
        for info in keys
            .iter()
            .filter(|info| !info.value.is_empty() && !chosen(info))
        {
            plain.set(&info.key, written(info));
        }
        plain
    }

    fn set(&mut self, key: &str, value: String) {
        let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
        let entries = self.tables.entry(table.to_owned()).or_default();
        entries.retain(|(other, _)| other != name);
        entries.push((name.to_owned(), value));
    }

    /// Removes a key and everything below it.
    fn clear(&mut self, key: &str) {
        let under = format!("{key}.");
        self.tables
            .retain(|table, _| table != key && !table.starts_with(&under));
        let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
        self.tables
            .entry(table.to_owned())
            .or_default()
            .retain(|(other, _)| other != name);
    }

    /// Text with `lines` in place of the key's own.
    fn text(&self, key: &str, lines: &[String]) -> Text {
        let (of, name) = key.rsplit_once('.').unwrap_or(("", key));
        let mut tables = self.tables.clone();
        tables.entry(of.to_owned()).or_default();
        let mut out: Vec<String> = Vec::new();
        let (mut line, mut header) = (0, 0);
        for (table, entries) in &tables {
            if !table.is_empty() {
                out.push(format!("[{table}]"));
            }
            if table == of {
                header = if table.is_empty() { 0 } else { out.len() };
                line = out.len() + 1;
                out.extend(lines.iter().cloned());
            }
            out.extend(
                entries
                    .iter()
                    .filter(|(other, _)| table != of || other != name)
                    .map(|(key, value)| format!("{key} = {value}")),
            );
        }
        Text {
            text: out.join("\n") + "\n",
            line,
            header,
        }
    }

    fn problems(&self, text: &str, path: &str) -> Problems {
        std::fs::write(path, text).unwrap();
        match self.kind {
            Kind::Vehicle => load(path, &Options::default()).err(),
            Kind::Lubricant => load_lubricant(path).err(),
            Kind::Rig => match Document::parse(path, text) {
                Ok(document) => {
                    let reader = Reader::new(&document);
                    let _ = cvtcycle::config::rig::read(&reader.root());
                    reader.finish().err()
                }
                Err(problems) => Some(problems),
            },
            Kind::Class | Kind::Plan | Kind::Levers | Kind::Calibration | Kind::Test => None,
        }
        .unwrap_or_default()
    }

    /// All keys read by the reader.
    fn keys(&self, path: &str) -> Vec<KeyInfo> {
        let text = self.text("", &[]).text;
        assert!(
            self.problems(&text, path).is_empty(),
            "{:#?}\n{text}",
            self.problems(&text, path)
        );
        match self.kind {
            Kind::Vehicle => {
                let keys = load(path, &Options::default()).unwrap().keys;
                keys.into_iter()
                    .filter(|info| {
                        !info.key.starts_with(catalogue::OIL)
                            && !info.key.starts_with(catalogue::ENGINE_OIL)
                    })
                    .collect()
            }
            Kind::Lubricant => load_lubricant(path).unwrap().1,
            Kind::Rig => {
                let document = Document::parse(path, &text).unwrap();
                let reader = Reader::new(&document);
                let _ = cvtcycle::config::rig::read(&reader.root());
                reader.finish().unwrap()
            }
            Kind::Class | Kind::Plan | Kind::Levers | Kind::Calibration | Kind::Test => Vec::new(),
        }
    }

    /// Chooses another option and fills in its required keys from their ranges. None if that gives no valid file.
    fn with_option(&self, key: &str, option: &str, path: &str) -> Option<Plain> {
        let mut plain = self.clone();
        plain.clear(key);
        // Writes the option as a table, or as a word if it has no keys.
        plain.tables.insert(format!("{key}.{option}"), Vec::new());
        if plain
            .problems(&plain.text("", &[]).text, path)
            .iter()
            .any(|problem| problem.message.contains("is a table without `value`"))
        {
            plain.clear(key);
            plain.set(key, format!("{option:?}"));
        }
        let missing = plain.problems(&plain.text("", &[]).text, path);
        if missing.is_empty() {
            return Some(plain);
        }
        for problem in missing {
            // Belongs to the other option only.
            if problem.message.starts_with("unknown key")
                || problem.message.contains("is of a pushing belt")
            {
                plain.clear(&problem.key);
            } else {
                plain.set(&problem.key, sample(&problem)?);
            }
        }
        plain
            .problems(&plain.text("", &[]).text, path)
            .is_empty()
            .then_some(plain)
    }
}

/// Valid value of a missing key.
fn sample(missing: &Problem) -> Option<String> {
    if missing.key == "engine.model.bsfc_map.file" {
        return Some("\"si_1900_bsfc\"".to_owned());
    }
    if missing.key == "transmission.cvt.clamp.table.file" {
        return Some("\"pressure.csv\"".to_owned());
    }
    // Ratios that exclude each other.
    let ratios = [
        ("ranges.two.low_ratio", 1.82),
        ("ranges.two.up_belt_ratio", 0.6),
        ("ranges.two.down_belt_ratio", 1.8),
        ("ranges.launch_gear.gear_ratio", 4.0),
        ("ranges.launch_gear.up_ratio", 3.5),
        ("ranges.launch_gear.down_ratio", 4.5),
    ];
    if let Some((_, ratio)) = ratios.iter().find(|(key, _)| missing.key.ends_with(key)) {
        return Some(format!("{ratio:?}"));
    }
    let (low, high) = numbers(&missing.allowed)?;
    Some(format!(
        "{:?}",
        if high.is_finite() {
            0.5 * (low + high)
        } else {
            low + 1.0
        }
    ))
}

/// Lowest and highest number in the text of a range.
fn numbers(allowed: &str) -> Option<(f64, f64)> {
    let range = allowed
        .rsplit("each ")
        .next()?
        .trim_start_matches("integer ")
        .trim_start_matches("from ");
    let found: Vec<f64> = range
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    match (range, found.as_slice()) {
        (_, [low, high, ..]) => Some((*low, *high)),
        (range, [low]) if range.starts_with("above") || range.starts_with("at least") => {
            Some((*low, f64::INFINITY))
        }
        (range, [high]) if range.starts_with("at most") => Some((f64::NEG_INFINITY, *high)),
        _ => None,
    }
}

/// Bad values of a key: sort of mistake, and the value as written.
fn bad_values(info: &KeyInfo) -> Vec<(&'static str, String)> {
    let mut list = Vec::new();
    let allowed = info.allowed.as_str();
    let within = |value: &str| {
        // Puts one bad number into a valid list, so that nothing else is wrong.
        let items: Vec<&str> = info.value.trim_matches(['[', ']']).split(", ").collect();
        let rest: Vec<&str> = items.iter().skip(1).copied().collect();
        format!("[{}]", [&[value], rest.as_slice()].concat().join(", "))
    };
    let is_list = allowed.contains("each ");
    if let Some((low, high)) = numbers(allowed)
        .filter(|_| !allowed.starts_with("rows of ") && !allowed.starts_with("one of "))
    {
        let mut add =
            |sort, value: String| list.push((sort, if is_list { within(&value) } else { value }));
        let integer = allowed.starts_with("integer");
        let number = |x: f64| {
            if integer {
                format!("{x}")
            } else {
                format!("{x:?}")
            }
        };
        if low.is_finite() {
            add("low", number(low - 1.0));
        }
        if high.is_finite() {
            add("high", number(high + 1.0));
        }
        if !integer {
            add("nan", "nan".to_owned());
        }
    }
    let of_another_type = if allowed.starts_with("text")
        || allowed.starts_with("the name of a CSV")
        || allowed.starts_with("one of ")
    {
        "12"
    } else {
        "\"many\""
    };
    list.push(("type", of_another_type.to_owned()));
    if allowed.starts_with("one of ") {
        list.push(("word", "\"zebra\"".to_owned()));
    }
    list
}

/// Keys that require a measured map, which no shipped car has.
const MAP_KEYS: [&str; 3] = [
    "transmission.cvt.loss_factor.box_map",
    "transmission.cvt.loss_factor.belt_map",
    "transmission.manual.loss_factor.box_map",
];

/// Keys whose mistakes cause several problems, with the reason.
const MULTIPLE_PROBLEMS: [(&str, &str); 2] = [
    (
        "transmission",
        "whether there is a belt is then not known: the thermal keys of one are missing",
    ),
    (
        "transmission.manual.overall_ratios",
        "how many gears there are is then not known: the shift speeds seem too many",
    ),
];

struct Tried<'p> {
    path: &'p str,
    counts: BTreeMap<&'static str, usize>,
    wrong: Vec<String>,
    /// Keys of [`MULTIPLE_PROBLEMS`] encountered.
    several: BTreeSet<String>,
}

impl Tried<'_> {
    /// Tests one bad text; `expected` is line and column.
    fn one(
        &mut self,
        sort: &'static str,
        plain: &Plain,
        info: &KeyInfo,
        lines: &[String],
        check: impl Fn(&Problem, &Text) -> Vec<&'static str>,
    ) {
        *self.counts.entry(sort).or_default() += 1;
        let text = plain.text(&info.key, lines);
        let problems = plain.problems(&text.text, self.path);
        if problems.len() > 1 && MULTIPLE_PROBLEMS.iter().any(|(key, _)| *key == info.key) {
            self.several.insert(info.key.clone());
            return;
        }
        let [problem] = &problems[..] else {
            let shown: Vec<String> = problems
                .iter()
                .map(|p| format!("    {}: {}", p.place.line, p.message))
                .collect();
            self.wrong.push(format!(
                "{} {sort} {lines:?}: {} problems\n{}",
                info.key,
                problems.len(),
                shown.join("\n")
            ));
            return;
        };
        let lacks = check(problem, &text);
        if !lacks.is_empty() {
            self.wrong.push(format!(
                "{} {sort} {lines:?}: {}: {problem:?}",
                info.key,
                lacks.join(", ")
            ));
        }
    }

    fn key(&mut self, plain: &Plain, info: &KeyInfo) {
        let name = info.key.rsplit('.').next().unwrap();
        let is_choice = plain
            .tables
            .keys()
            .any(|table| table.starts_with(&format!("{}.", info.key)));
        // An option chosen by its table may be named by a word instead.
        let mut bare = plain.clone();
        if is_choice {
            bare.clear(&info.key);
        }
        for (sort, value) in bad_values(info) {
            let line = format!("{name} = {value}");
            let item = value
                .trim_start_matches('[')
                .split([',', ']'])
                .next()
                .unwrap()
                .to_owned();
            let column = line.chars().count()
                - line
                    .split_once("= ")
                    .unwrap()
                    .1
                    .trim_start_matches('[')
                    .chars()
                    .count()
                + 1;
            self.one(
                sort,
                &bare,
                info,
                std::slice::from_ref(&line),
                |problem, text| {
                    let place = (problem.place.line, problem.place.column) == (text.line, column)
                        && *problem.place.line_text == *line;
                    let shown = problem.message.contains(&info.key)
                        || problem.place.line_text.starts_with(name);
                    // A message about a type contains the wanted type, and no range if that is all.
                    let range = problem.allowed == info.allowed
                        || info.allowed.contains(&problem.allowed) && !problem.allowed.is_empty();
                    let said = sort == "type"
                        && problem
                            .message
                            .contains(&format!("expected {}", info.allowed));
                    let all = [
                        (place, "place"),
                        (problem.key == info.key && shown, "key"),
                        (problem.value == item, "value"),
                        (range || said, "range"),
                        (sort != "word" || !problem.hint.is_empty(), "hint"),
                    ];
                    all.iter()
                        .filter(|(good, _)| !good)
                        .map(|(_, what)| *what)
                        .collect()
                },
            );
        }
        if !plain.has(&info.key) {
            return;
        }
        let own = format!("{name} = {}", plain.value(&info.key));
        let twice = [own.clone(), own.clone()];
        self.one("twice", plain, info, &twice, |problem, text| {
            let all = [
                (problem.place.line == text.line + 1, "place"),
                (problem.hint.contains("remove one"), "hint"),
            ];
            all.iter()
                .filter(|(good, _)| !good)
                .map(|(_, what)| *what)
                .collect()
        });
        if info.status == "choice" {
            return;
        }
        let required = plain.problems(&plain.text(&info.key, &[]).text, self.path);
        if !required.is_empty() {
            self.one("missing", plain, info, &[], |problem, text| {
                let all = [
                    (problem.place.line == text.header, "place"),
                    (
                        problem.key == info.key
                            && problem.message == format!("missing key `{}`", info.key),
                        "key",
                    ),
                    (!problem.allowed.is_empty(), "range"),
                    (problem.hint.starts_with(&format!("add `{name} = ")), "hint"),
                ];
                all.iter()
                    .filter(|(good, _)| !good)
                    .map(|(_, what)| *what)
                    .collect()
            });
        }
        let misspelt = format!("{name}x");
        self.one(
            "misspelt",
            plain,
            info,
            &[own.replacen(name, &misspelt, 1)],
            |problem, text| {
                let all = [
                    (
                        (problem.place.line, problem.place.column) == (text.line, 1),
                        "place",
                    ),
                    (problem.key == format!("{}x", info.key), "key"),
                    (problem.hint.contains(name), "hint"),
                ];
                all.iter()
                    .filter(|(good, _)| !good)
                    .map(|(_, what)| *what)
                    .collect()
            },
        );
    }
}

impl Plain {
    fn value(&self, key: &str) -> &str {
        let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
        self.tables
            .get(table)
            .and_then(|entries| entries.iter().find(|(other, _)| other == name))
            .map_or("", |(_, value)| value)
    }

    fn has(&self, key: &str) -> bool {
        !self.value(key).is_empty()
    }
}

pub fn check() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.toml").to_str().unwrap().to_owned();
    let pressures = "input_torque_nm,belt_ratio,secondary_pressure_bar\n0,0.5,1\n200,0.5,1\n";
    std::fs::write(folder.path().join("pressure.csv"), pressures).unwrap();
    let mut tried = Tried {
        path: &path,
        counts: BTreeMap::new(),
        wrong: Vec::new(),
        several: BTreeSet::new(),
    };
    let mut seen: BTreeSet<String> = BTreeSet::new();
    let mut options: BTreeSet<String> = BTreeSet::new();
    let mut refused: BTreeSet<String> = BTreeSet::new();
    let mut waiting: Vec<Plain> = catalogue::files()
        .iter()
        .rev()
        // A class is not a complete file.
        .filter(|file| file.kind != Kind::Class)
        .map(|file| Plain::new(file.kind, &file.keys))
        .collect();
    let machine = |key: &str| format!("engine.start_stop.starter_generator.{key}");
    // No shipped car has a table for its twin, or start-stop: this one is tried last, for these keys only.
    let twin = Options {
        set: vec![
            Override::number("twin.gears", 6.0),
            Override::number("engine.start_stop.delay_s", 0.5),
            Override::number(&machine("recuperation_w"), 5e3),
            Override::number(&machine("torque_nm"), 100.0),
        ],
        ..Options::default()
    };
    let twin = load("rover_216_cvt", &twin).unwrap().keys.into_iter();
    let is_fluid =
        |key: &str| key.starts_with(catalogue::OIL) || key.starts_with(catalogue::ENGINE_OIL);
    let twin: Vec<KeyInfo> = twin.filter(|info| !is_fluid(&info.key)).collect();
    waiting.insert(0, Plain::new(Kind::Vehicle, &twin));
    while let Some(plain) = waiting.pop() {
        let prefix = if plain.kind == Kind::Lubricant {
            catalogue::OIL
        } else {
            ""
        };
        for info in plain.keys(&path) {
            let words: Vec<&str> = info
                .allowed
                .strip_prefix("one of ")
                .into_iter()
                .flat_map(|words| words.split(", "))
                .collect();
            for word in words
                .iter()
                .filter(|word| info.key != "transmission" && **word != info.value)
            {
                let option = format!("{prefix}{} {word}", info.key);
                if options.contains(&option) {
                    continue;
                }
                // Options that one car excludes may be possible in another: a car with a converter has no clutch behind the variator.
                match plain.with_option(&info.key, word, &path) {
                    Some(other) => {
                        options.insert(option);
                        waiting.push(other);
                    }
                    None => drop(refused.insert(option)),
                }
            }
            if seen.insert(format!("{prefix}{}", info.key)) {
                tried.key(&plain, &info);
            }
        }
    }
    let never: Vec<&String> = refused.difference(&options).collect();
    assert!(never.is_empty(), "no good file: {never:?}");
    let unseen: Vec<String> = catalogue::known_names()
        .iter()
        .filter(|key| !seen.contains(*key) && !MAP_KEYS.contains(&key.as_str()))
        .cloned()
        .collect();
    let wrong = tried.wrong.join("\n");
    assert!(
        wrong.is_empty(),
        "{} of {:?}\n{wrong}",
        tried.wrong.len(),
        tried.counts
    );
    assert_eq!(
        tried.several.len(),
        MULTIPLE_PROBLEMS.len(),
        "an exception is no longer needed: {:?}",
        tried.several
    );
    assert!(unseen.is_empty(), "keys never tried: {unseen:?}");
    assert!(
        SORTS
            .iter()
            .all(|sort| tried.counts.get(sort).is_some_and(|count| *count >= 5)),
        "{:?}",
        tried.counts
    );
    let mistakes: usize = tried.counts.values().sum();
    assert!(
        seen.len() > 220 && mistakes > 1300,
        "{} keys, {:?}",
        seen.len(),
        tried.counts
    );
}
