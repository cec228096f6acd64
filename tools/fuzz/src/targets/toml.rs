//! TOML files and overrides.

use std::sync::OnceLock;

use cvtcycle::analysis::levers::LeverFile;
use cvtcycle::calibrate::{embedded_calibrations, plan as calibration};
use cvtcycle::config::setup::new_car::{self, Answers};
use cvtcycle::config::setup::{self, Disk, Options, embedded_lubricants, embedded_vehicles};
use cvtcycle::config::{Override, Problems, decode, render};
use cvtcycle::report::cover::Cover;
use cvtcycle::study::plan::{Plan, embedded_plans};
use cvtcycle::validate::{self, COMMON, embedded_rows};

use super::{edits, within_memory};

/// Texts up to this length are edited eight times as often as longer ones, which take longer to read in proportion.
const SHORT: usize = 4000;

/// Cover with all keys.
const COVER: &str = "title = \"Band offset\"\nsubtitle = \"Review 7\"\nauthor = \"A. Engineer\"\norganisation = \"Example\"\n\
    date = \"2026-11-21\"\nlogo = \"no/such.svg\"\nlogo_words = \"Example\"\n[remarks]\nanswer = \"First.\\nSecond.\"\nlosses = \"...\"\n";

/// Two levers with all keys.
const LEVERS: &str = "[levers]\ntitle = \"Own\"\ntransmission = \"cvt\"\n[[lever]]\nname = \"lighter\"\ntitle = \"Less mass\"\n\
    set = [\"road_load.mass_kg*=0.9\", \"engine.idle.hot_rpm+=50\"]\ngroup = \"mass\"\ncombine = false\nneeds = \"new body\"\n\
    status = \"assumed\"\nsource = \"none\"\n[[lever]]\nname = \"oil\"\nlubricant = \"dexron_iii\"\nengine_oil = \"engine_10w40\"\n";

/// Answers to all questions about a new car; its class supplies most of them too.
const ANSWERS: &str = "title = \"Own\"\nclass = \"compact_2020\"\nbox = \"box_cvt_clutch\"\nmass = \"3000lb\"\nf0 = 105\nf1 = \"0.4\"\n\
    f2 = \"0.0189lbf/mph2\"\ntyre = \"215/55 R16\"\ndisplacement = \"1.8l\"\npower = \"104@6400\"\ntorque = \"172@3800-4400\"\nidle = 700\n\
    highest = 6600\nfinal-drive = 5.36\nratio-low = \"2.48\"\nspan = 6.3\ncentre-distance = 168\npump = \"10\"\noil = 7\nfluid = \"dexron_iii\"\n\
    engine-oil = \"engine_10w40\"\n";

type Texts = OnceLock<Vec<&'static str>>;

fn texts(
    cell: &'static Texts,
    shipped: &'static [(&'static str, &'static str)],
) -> &'static [&'static str] {
    let times = |text: &str| if text.len() <= SHORT { 8 } else { 1 };
    cell.get_or_init(|| {
        shipped
            .iter()
            .flat_map(|(_, text)| std::iter::repeat_n(*text, times(text)))
            .collect()
    })
}

/// Reads bytes as text and renders every refusal.
fn read<T>(bytes: &[u8], reader: impl Fn(&str) -> Result<T, Problems>) {
    within_memory(bytes.len(), || {
        let refused = match decode("fuzz.toml", bytes) {
            Ok(text) => reader(&text).err(),
            Err(problems) => Some(problems),
        };
        checked(refused);
    });
}

/// Asserts that a refusal has at least one problem, and renders it.
fn checked(refused: Option<Problems>) {
    if let Some(problems) = refused {
        assert!(!problems.is_empty(), "refused without a word");
        assert!(!render(&problems, false).is_empty());
    }
}

pub fn vehicle(data: &[u8]) {
    static SHIPPED: Texts = OnceLock::new();
    let text = edits::text(data, texts(&SHIPPED, embedded_vehicles()));
    read(&text, |text| {
        setup::read(
            "fuzz.toml",
            text,
            Box::new(Disk::default()),
            &Options::default(),
        )
    });
}

pub fn lubricant(data: &[u8]) {
    static SHIPPED: Texts = OnceLock::new();
    let text = edits::text(data, texts(&SHIPPED, embedded_lubricants()));
    read(&text, |text| {
        setup::read_lubricant("fuzz.toml", text, &Disk::default())
    });
}

pub fn study_plan(data: &[u8]) {
    static SHIPPED: Texts = OnceLock::new();
    let text = edits::text(data, texts(&SHIPPED, embedded_plans()));
    read(&text, |text| Plan::read("fuzz.toml", text));
}

pub fn calibration_plan(data: &[u8]) {
    static SHIPPED: Texts = OnceLock::new();
    let text = edits::text(data, texts(&SHIPPED, embedded_calibrations()));
    read(&text, |text| calibration::read("fuzz.toml", text));
}

pub fn rows(data: &[u8]) {
    static SHIPPED: Texts = OnceLock::new();
    let text = edits::text(data, texts(&SHIPPED, embedded_rows()));
    read(&text, |text| {
        validate::read(COMMON, &[("fuzz.toml".to_owned(), text.to_owned())])
    });
}

pub fn cover(data: &[u8]) {
    static SHIPPED: [&str; 1] = [COVER];
    let text = edits::text(data, &SHIPPED);
    read(&text, |text| Cover::parse("fuzz.toml", text));
}

pub fn levers(data: &[u8]) {
    let text = edits::text(data, &[LEVERS]);
    read(&text, |text| LeverFile::read("fuzz.toml", text));
}

/// File of answers, and the resulting car.
pub fn answers(data: &[u8]) {
    let text = edits::text(data, &[ANSWERS]);
    read(&text, |text| {
        let mut answers = Answers::default();
        answers.add_file("fuzz.toml", text)?;
        new_car::write(&answers)
    });
}

/// Overrides of a shipped car, which the first byte selects.
pub fn overrides(data: &[u8]) {
    let Some((which, rest)) = data.split_first() else {
        return;
    };
    let vehicles = embedded_vehicles();
    let (name, _) = vehicles[usize::from(*which) % vehicles.len()];
    let Ok(text) = std::str::from_utf8(rest) else {
        return;
    };
    let load = |set| {
        let options = Options {
            set,
            ..Options::default()
        };
        setup::load(name, &options)
    };
    let lines: Vec<&str> = text.lines().collect();
    within_memory(rest.len(), || {
        checked(Override::parse_all(&lines).and_then(load).err());
    });
}
