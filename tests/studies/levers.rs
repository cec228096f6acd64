//! Design changes compared with the unchanged car. Truth: single cars loaded and driven with the values of a draw, the plan itself, and
//! the same study composed in another way.

use std::collections::{BTreeMap, BTreeSet};

use cvtcycle::analysis::levers::{
    Combine, Lever, LeverAnswer, LeverFile, LeverRequest, LeverRow, csv, lever_answer, prepare,
};
use cvtcycle::config::setup::{self, Kind, Options};
use cvtcycle::config::{Override, Problem, Problems};
use cvtcycle::model::drive::{Start, drive, litres_per_100km};
use cvtcycle::output::progress::NoProgress;
use cvtcycle::output::table::Head;
use cvtcycle::study::execute::relative;
use cvtcycle::study::plan::{Factor, Level, Plan};
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::store::{Rows, Values};
use cvtcycle::study::{Study, StudyManifest, StudyTable, TableSource};

use crate::common::{at, cycle};
use crate::parts::MemorySink;

const CVT: &str = "rover_216_cvt";
const FUEL: &str = "headline_fuel_l_per_100km";

/// In-memory table of a study.
struct Table {
    columns: Vec<Head>,
    parts: BTreeMap<u64, Rows>,
}

impl TableSource for Table {
    fn parts(&self) -> Vec<u64> {
        self.parts.keys().copied().collect()
    }

    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        let column = |name: &&str| self.columns.iter().position(|head| head.name == *name);
        let found = names.iter().map(|name| column(name).unwrap());
        Ok(found.map(|k| self.parts[&part].values[k].clone()).collect())
    }

    fn traces(&self, _: u64, _: &[&str]) -> Result<Vec<Values>, Problem> {
        Ok(Vec::new())
    }
}

/// Finished study with table and answer.
struct FinishedStudy {
    study: Study,
    table: Table,
    answer: LeverAnswer,
}

impl FinishedStudy {
    /// Column of the table, by car and point.
    fn column(&self, name: &str) -> Vec<Vec<f64>> {
        let manifest = StudyManifest::new(&self.study);
        let frame = StudyTable::new(&manifest, &self.table).unwrap();
        frame.by_car(&[name]).unwrap().remove(0)
    }

    /// Index of a car by the end of its name.
    fn car(&self, end: &str) -> usize {
        let mut cars = self.study.cars.iter();
        cars.position(|car| car.name.ends_with(end)).unwrap()
    }

    fn row(&self, name: &str) -> &LeverRow {
        let mut rows = self.answer.blocks.iter().flat_map(|block| &block.rows);
        rows.find(|row| row.of.name == name).unwrap()
    }
}

fn run(request: &LeverRequest, threads: usize) -> FinishedStudy {
    let study = prepare(request).unwrap_or_else(|problems| panic!("{problems:?}"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let shelf = MemorySink::default();
    let execute = || study.execute(&BTreeSet::new(), &shelf, &NoProgress);
    pool.build().unwrap().install(execute).unwrap();
    let table = Table {
        columns: study.columns.clone(),
        parts: shelf.0.into_inner().unwrap(),
    };
    let manifest = StudyManifest::new(&study);
    let answer = lever_answer(
        &StudyTable::new(&manifest, &table).unwrap(),
        Confidence::default(),
    )
    .unwrap();
    FinishedStudy {
        study,
        table,
        answer,
    }
}

fn levers(text: &str) -> Vec<Lever> {
    let file = LeverFile::read("own.toml", text).unwrap_or_else(|problems| panic!("{problems:?}"));
    let named = |lever| Lever {
        is_named: true,
        ..lever
    };
    file.levers.into_iter().map(named).collect()
}

fn lever(name: &str, set: &[&str]) -> String {
    format!("[[lever]]\nname = \"{name}\"\nset = {set:?}\n")
}

fn uncertainty() -> Plan {
    Plan::open("uncertainty_rover").unwrap()
}

/// Request with a number of draws of the Rover on ECE15.
fn request(text: &str, draws: u64) -> LeverRequest {
    LeverRequest {
        levers: levers(text),
        vehicles: vec![CVT.to_owned()],
        ambients_degc: vec![25.0],
        cycle: "ece15".to_owned(),
        start: "soak".to_owned(),
        dt_s: 1.0,
        base: Options::default(),
        set_all: Vec::new(),
        others: Vec::new(),
        draws: (draws > 0).then(|| (uncertainty(), draws, 1)),
        combine: Combine::None,
        heard_rpm: 1300.0,
    }
}

fn problems(text: &str, change: impl Fn(&mut LeverRequest)) -> Problems {
    let mut request = request(text, 0);
    change(&mut request);
    prepare(&request).map(drop).unwrap_err()
}

/// The Rover's plan becomes relative for any car, without effect for the Rover itself. Truth: the values of the plan.
#[test]
fn the_rovers_draws_are_those_of_its_plan() {
    let plan = uncertainty();
    let (over, of_cvt) = relative(plan.clone()).unwrap();
    assert!(of_cvt && over.skip_missing && over.clip);
    let base = |word: &str| {
        let setup = setup::load(word, &Options::default()).unwrap();
        let keys = setup.keys.into_iter();
        keys.filter_map(|info| Some((info.key, info.value.parse::<f64>().ok()?)))
            .collect::<BTreeMap<String, f64>>()
    };
    let (cvt, manual) = (base(CVT), base("rover_216_5mt"));
    let mut changed = 0;
    for (before, after) in plan.factors.iter().zip(&over.factors) {
        let own = match format!("{:?}", before.cars).as_str() {
            "Baselines" => &manual,
            _ => &cvt,
        };
        let Some(base) = own.get(&before.key) else {
            assert_eq!(before.values, after.values, "{}", before.key);
            continue;
        };
        changed += usize::from(before.acts != after.acts);
        let at = |factor: &Factor, share: f64| {
            let value = factor.value(Level::Share(share)).unwrap();
            factor.acts.resolved(*base, value.number().unwrap())
        };
        for share in [0.01, 0.3, 0.5, 0.77, 0.99] {
            let (want, got) = (at(before, share), at(after, share));
            let error = (want - got).abs();
            assert!(
                error <= 1e-12 * (1.0 + want.abs()),
                "{}: {want} {got}",
                before.key
            );
        }
    }
    assert!(changed > 70, "{changed}");
}

/// Factors without effect are named: for a car of a class, whose engine has no enrichment and whose clamp law differs, and for its twin with six gears, where
/// the plan has lists of five.
#[test]
fn a_study_names_the_factors_that_do_not_act() {
    let (mut plan, _) = relative(uncertainty()).unwrap();
    plan.base.vehicle = "civic_20_cvt".to_owned();
    plan.base.baselines = Some(vec!["twin".to_owned()]);
    let study = Study::prepare(plan).unwrap();
    let [subject, twin, shifts] = study.notes.as_slice() else {
        panic!("{:?}", study.notes)
    };
    for (note, parts) in [
        (
            subject,
            &[
                "civic_20_cvt: ",
                "cold enrichment; ",
                "clamp pressure level",
            ][..],
        ),
        (
            twin,
            &["civic_20_cvt_twin: ", "gear set", "cold enrichment"],
        ),
        (
            shifts,
            &["civic_20_cvt_twin: its shift speeds (TW-3, assumed) are in no factor"],
        ),
    ] {
        assert!(parts.iter().all(|part| note.contains(part)), "{note}");
    }
    // The draws equal those of a car without the factor, and the table has no values for it.
    let gears = study
        .plan
        .factors
        .iter()
        .position(|f| f.name == "gear set")
        .unwrap();
    assert!(study.cars[1].idle.contains(&gears) && !study.cars[0].idle.contains(&gears));
    // The shipped study has no such factors.
    assert!(Study::prepare(uncertainty()).unwrap().notes.is_empty());
}

/// Truth: the car loaded by `setup::load` with the draw's values and the lever's words as overrides, and driven.
#[test]
fn a_draw_is_the_car_with_its_values() {
    let text = lever("pump", &["transmission.cvt.pump.kind=variable"])
        + &lever("line", &["transmission.cvt.ratio.gentle_rpm=1500"]);
    let done = run(&request(&text, 6), 2);
    let fuel = done.column(FUEL);
    for (end, words) in [
        ("/reference", vec![]),
        ("/pump", vec!["transmission.cvt.pump.kind=variable"]),
        ("/line", vec!["transmission.cvt.ratio.gentle_rpm=1500"]),
    ] {
        let car = done.car(end);
        let point = 4;
        let mut set: Vec<Override> = words.iter().map(|text| text.parse().unwrap()).collect();
        for factor in &done.study.plan.factors {
            let value = done.column(&factor.key)[car][point];
            // Words apply to the baselines only.
            let is_number = factor.values.are_numbers();
            if is_number && value.is_finite() {
                set.push(Override::number(&factor.key, value));
            }
        }
        assert!(set.len() > 60, "{}", set.len());
        let options = Options {
            set,
            ..Options::default()
        };
        let setup = setup::load(CVT, &options).unwrap();
        let cycle = cycle("ece15");
        let outcome = drive(&setup, &cycle, &at(25.0, Start::Soak));
        let all = outcome.totals.total();
        let density = setup.engine().fuel_density_kg_m3;
        let by_hand = litres_per_100km(all.fuel_kg, density, all.distance_m);
        assert_eq!(fuel[car][point].to_bits(), by_hand.to_bits(), "{end}");
    }
    let (own, reference) = (done.car("/pump"), done.car("/reference"));
    let mut changes: Vec<f64> = (0..6)
        .map(|k| 100.0 * (fuel[own][k] / fuel[reference][k] - 1.0))
        .collect();
    changes.sort_by(f64::total_cmp);
    let row = done.row("pump");
    let median = 0.5 * (changes[2] + changes[3]);
    assert!((row.fuel_percent.value - median).abs() < 1e-12);
    assert_eq!((row.saves.k, row.saves.n, row.failed), (6, 6, 0));
    assert!(done.answer.enough.median && !done.answer.enough.ends);
}

/// Property: an absolute lever removes its factor, in the reference too, and changes no other factor. A relative one modifies
/// the drawn value.
#[test]
fn a_lever_replaces_its_factor_or_scales_the_draw() {
    let (line, pump) = (
        "transmission.cvt.ratio.gentle_rpm",
        "transmission.cvt.pump.displacement_cc_rev",
    );
    let text = lever("line", &[&format!("{line}=1500")])
        + &lever("smaller", &[&format!("{pump}*=0.82")])
        + &lever("less", &[&format!("{pump}+=-1")]);
    let done = run(&request(&text, 4), 1);
    let (reference, second) = (done.car("/reference"), done.car("/reference_2"));
    let own = done.car("/line");
    let drawn = done.column(line);
    assert!(drawn[reference].iter().all(|x| x.is_finite()));
    assert!(drawn[own].iter().chain(&drawn[second]).all(|x| x.is_nan()));
    let drawn = done.column(pump);
    assert!(drawn[own].iter().eq(&drawn[reference]) && drawn[second].iter().eq(&drawn[own]));
    let of = |end: &str| drawn[done.car(end)].iter();
    let draws = of("/reference").zip(of("/smaller").zip(of("/less")));
    for (x, (smaller, less)) in draws {
        assert_eq!(smaller.to_bits(), (x * 0.82).to_bits());
        assert_eq!(less.to_bits(), (x - 1.0).to_bits());
    }
    let row = done.row("line");
    assert_eq!(row.of.left_out.len(), 1);
    assert_eq!(
        done.study.cars[row.of.reference].name,
        done.study.cars[second].name
    );
}

/// Property: order, other levers and threads do not change the saving of a lever, and a combination of one lever equals it.
#[test]
fn a_lever_does_not_depend_on_others() {
    let pump = lever("pump", &["transmission.cvt.pump.kind=variable"]);
    let offset = lever("offset", &["transmission.cvt.belt.band_offset_mm+=-1"]);
    let bits = |row: &LeverRow| {
        let of = [row.fuel_percent, row.low_percent, row.high_percent];
        of.map(|quantile| quantile.value.to_bits())
    };
    let mut both = request(&(pump.clone() + &offset), 8);
    both.combine = Combine::Lists(vec![
        vec!["pump".to_owned()],
        vec!["offset".to_owned(), "pump".to_owned()],
    ]);
    let [one, four] = [1, 4].map(|threads| run(&both, threads));
    assert_eq!(csv(&one.answer), csv(&four.answer));
    let turned = run(&request(&(offset + &pump), 8), 2);
    let alone = run(&request(&pump, 8), 2);
    let of_pump = bits(alone.row("pump"));
    assert_eq!(bits(one.row("pump")), of_pump);
    assert_eq!(bits(turned.row("pump")), of_pump);
    let single = one.answer.blocks[0]
        .rows
        .iter()
        .filter(|row| row.is_combination());
    let single: Vec<&LeverRow> = single.collect();
    let of_one = single
        .iter()
        .find(|row| row.of.members == ["pump"])
        .unwrap();
    assert_eq!(bits(of_one), of_pump);
    let together = single.iter().find(|row| row.of.members.len() == 2).unwrap();
    let sum = one.row("offset").fuel_percent.value + alone.row("pump").fuel_percent.value;
    assert!((together.sum_percent.unwrap() - sum).abs() < 1e-12);
    assert!((together.fuel_percent.value - sum).abs() < 0.3);
}

/// Every built-in lever changes each applicable car, and has a source for its size.
#[test]
fn built_in_levers_change_something() {
    let mut count = 0;
    for (name, text) in Kind::Levers.embedded() {
        let file = LeverFile::read(name, text).unwrap();
        let car = if *name == "manual" {
            "rover_216_5mt"
        } else {
            CVT
        };
        let request = LeverRequest {
            levers: file
                .levers
                .into_iter()
                .map(|lever| Lever {
                    is_named: true,
                    ..lever
                })
                .collect(),
            vehicles: vec![car.to_owned()],
            combine: Combine::Automatic,
            cycle: "ece15_eudc".to_owned(),
            ..request(&lever("any", &["road_load.mass_kg*=0.9"]), 0)
        };
        assert!(request.levers.iter().all(|lever| !lever.source.is_empty()));
        count += request.levers.len();
        let done = run(&request, 2);
        let still: Vec<&str> = done.answer.blocks[0]
            .rows
            .iter()
            .filter(|row| row.fuel_percent.value.abs() <= 0.0)
            .map(|row| row.of.name.as_str())
            .collect();
        assert!(still.is_empty(), "{still:?}");
        assert!(done.answer.runs.failed + done.answer.runs.not_run == 0);
        let together = done.answer.blocks[0].rows.last().unwrap();
        assert!(together.is_combination());
        // One of each group.
        let group = |name: &String| {
            request
                .levers
                .iter()
                .find(|l| l.name == *name)?
                .group
                .clone()
        };
        let groups: Vec<String> = together.of.members.iter().filter_map(group).collect();
        let distinct: BTreeSet<&String> = groups.iter().collect();
        assert_eq!(groups.len(), distinct.len(), "{groups:?}");
    }
    assert_eq!(count, 30);
}

/// A file applies to any car: levers of a built-in file that the car cannot have are left out and named.
#[test]
fn another_car_gets_the_applicable_levers() {
    let (name, text) = Kind::Levers.embedded()[0];
    let request = LeverRequest {
        levers: LeverFile::read(name, text).unwrap().levers,
        vehicles: vec![CVT.to_owned(), CVT.to_owned()],
        draws: Some((uncertainty(), 2, 1)),
        ambients_degc: vec![-10.0, 25.0],
        ..request(&lever("any", &["road_load.mass_kg*=0.9"]), 0)
    };
    let study = prepare(&request).unwrap();
    assert!(
        study
            .cars
            .iter()
            .any(|car| &*car.name == "rover_216_cvt_2/-10/variable_pump")
    );
    let other = LeverRequest {
        vehicles: vec!["rover_216_5mt".to_owned()],
        ..request
    };
    let refused = prepare(&other).map(drop).unwrap_err();
    assert!(refused[0].message.contains("can have none of the levers"));
}

#[test]
fn bad_lever_files_are_refused() {
    let message = |text: &str| problems(text, |_| {})[0].message.clone();
    // One that changes nothing is no mistake: it has a column, and a note says so.
    let same = prepare(&request(&lever("a", &["road_load.mass_kg=1130"]), 0)).unwrap();
    assert_eq!(same.cars.len(), 2);
    let notes = same.levers.unwrap()["notes"].to_string();
    assert!(notes.contains("a changes nothing in it"), "{notes}");
    let manual = message(&lever("a", &["transmission.manual.final_ratio*=0.9"]));
    assert!(manual.contains("lever a: "), "{manual}");
    let varies = problems(&lever("a", &["road_load.mass_kg*=0.9"]), |request| {
        let text = "study.design = \"grid\"\n[[factor]]\nkey = \"ambient_degc\"\nvalues = [1, 2]\n";
        request.draws = Some((Plan::read("p.toml", text).unwrap(), 4, 1));
    });
    assert_eq!(varies[0].message, "the plan varies `ambient_degc`");
}

#[test]
fn combinations_that_do_not_go_together_are_refused() {
    let clamp = "transmission.cvt.clamp";
    let text = lever("law", &[&format!("{clamp}=torque_following")])
        + &lever("map", &[&format!("{clamp}.map.base_bar*=0.9")])
        + &lever("put", &["road_load.mass_kg=1000"])
        + &lever("cut", &["road_load.mass_kg*=0.9"])
        + &lever("cut_more", &["road_load.mass_kg*=0.8"]);
    let refused = |list: &str| {
        let list = list.split('+').map(str::to_owned).collect();
        problems(&text, |request| {
            request.combine = Combine::Lists(vec![Vec::clone(&list)]);
        })
    };
    for (list, part) in [
        (
            "law+map",
            "one removes `transmission.cvt.clamp.map.base_bar`",
        ),
        ("put+cut", "both change `road_load.mass_kg`"),
        ("law+law", "`law` is named twice"),
        ("law+mpa", "there is no lever named `mpa`"),
    ] {
        let problems = refused(list);
        assert!(
            problems[0].message.contains(part),
            "{list}: {:?}",
            problems[0]
        );
        assert_eq!(problems[0].key, "combine");
    }
    // Two factors on one value combine in any order.
    let mut both = request(&text, 0);
    both.combine = Combine::Lists(vec![vec!["cut".to_owned(), "cut_more".to_owned()]]);
    let done = run(&both, 1);
    let together = done.answer.blocks[0].rows.last().unwrap();
    let single = done.row("cut_more");
    assert!(together.fuel_percent.value < single.fuel_percent.value);
    // The automatic combination takes the better of two incompatible levers.
    let automatic = LeverRequest {
        combine: Combine::Automatic,
        ..both
    };
    let done = run(&automatic, 1);
    assert!(
        done.answer
            .notes
            .iter()
            .any(|note| note.contains("not in the combination"))
    );
}

/// Property: only an explicit option makes a plan skip keys that a car lacks, or clamp a draw to the range of its key.
#[test]
fn missing_keys_and_bounds_of_a_plan() {
    let text = |head: &str, key: &str, low: f64, high: f64| {
        format!(
            "[study]\nbaselines = []\ncycle = \"constant_50\"\n{head}\n[study.design.latin_hypercube]\nsamples = 8\n[[factor]]\nkey = \"{key}\"\n\
             acts = \"scale\"\nstatus = \"assumed\"\ndistribution.uniform = {{ low = {low}, high = {high} }}\n"
        )
    };
    let study = |text: String| Plan::read("p.toml", &text).and_then(Study::prepare);
    let manual = "transmission.manual.final_ratio";
    assert!(study(text("", manual, 0.9, 1.1)).is_err());
    let skipped = study(text("missing = \"skip\"", manual, 0.9, 1.1)).unwrap();
    assert_eq!(skipped.cars[0].idle, [0]);
    let offset = "transmission.cvt.belt.band_offset_mm";
    assert!(study(text("", offset, 0.5, 20.0)).is_err());
    let clipped = study(text("bounds = \"clip\"", offset, 0.5, 20.0)).unwrap();
    let shelf = MemorySink::default();
    clipped
        .execute(&BTreeSet::new(), &shelf, &NoProgress)
        .unwrap();
    let column = clipped
        .columns
        .iter()
        .position(|head| head.name == offset)
        .unwrap();
    let parts = shelf.0.into_inner().unwrap();
    let values = parts.values().flat_map(|rows| match &rows.values[column] {
        Values::Number(cells) => cells.clone(),
        _ => Vec::new(),
    });
    let values: Vec<f64> = values.collect();
    let held = values.iter().filter(|x| (**x - 20.0).abs() <= 0.0).count();
    assert!(held >= 4 && values.iter().all(|x| *x <= 20.0), "{values:?}");
}

#[test]
fn a_factor_does_not_replace_what_a_plan_sets() {
    let text = |set: &str, key: &str, acts: &str| {
        format!(
            "[study]\ndesign = \"grid\"\nset = [\"{set}\"]\n[[factor]]\nkey = \"{key}\"\nacts = \"{acts}\"\nvalues = [1, 1.1]\n"
        )
    };
    let read = |text: String| Plan::read("p.toml", &text).map(drop);
    let (mass, clamp) = ("road_load.mass_kg", "transmission.cvt.clamp");
    let refused = read(text("road_load.mass_kg=1000", mass, "value")).unwrap_err();
    assert!(
        refused[0]
            .message
            .contains("`road_load.mass_kg` is set to 1000")
    );
    let map = format!("{clamp}.map.base_bar");
    assert!(read(text(&format!("{clamp}=torque_following"), &map, "value")).is_err());
    assert!(read(text(&format!("{clamp}=map"), &map, "value")).is_ok());
    assert!(read(text("road_load.mass_kg=1000", mass, "scale")).is_ok());
}

/// The example of the page is a valid lever file for a car.
#[test]
fn the_example_of_the_page_is_a_lever_file() {
    let page = include_str!("../../docs/book/src/levers.md");
    let example = page.split("```toml\n").nth(1).unwrap();
    let text = example.split("```").next().unwrap();
    assert_eq!(levers(text)[0].name, "short_belt");
}

/// A plan of two values of the band friction in two forms, drawn with the weights.
fn two_forms(weights: [f64; 2]) -> Plan {
    let form = |(name, weight, band): (&str, f64, [f64; 2])| {
        let [low, high] = band;
        format!(
            "[[form]]\nname = \"{name}\"\nweight = {weight}\n[[factor]]\nkey = \"lubricant.friction.band\"\nform = \"{name}\"\n\
             status = \"assumed\"\ndistribution.uniform = {{ low = {low}, high = {high} }}\n"
        )
    };
    let forms = [
        ("bands", weights[0], [0.13, 0.130_000_1]),
        ("drag", weights[1], [0.052, 0.052_000_1]),
    ];
    let head = "[study.design.latin_hypercube]\nsamples = 2\nseed = 1\n".to_owned();
    let text = head + &forms.map(form).concat();
    Plan::read("forms.toml", &text).unwrap()
}

/// Truth: the medians of the lever by form are those of drives with that form's band friction set by an override, within the narrow range that the
/// form gives it; the number of draws is that of the weights.
#[test]
fn a_median_by_form_is_that_of_its_values() {
    let text = lever("offset", &["transmission.cvt.belt.band_offset_mm=1"]);
    let mut asked = request(&text, 8);
    if let Some((plan, ..)) = &mut asked.draws {
        *plan = two_forms([3.0, 1.0]);
    }
    // Values that are given are certain: no range of the car's own is drawn.
    let keys = setup::load(CVT, &Options::default()).unwrap().keys;
    let ranged = keys.iter().filter(|info| info.range.is_some());
    let given = ranged.map(|info| format!("{}={}", info.key, info.value).parse().unwrap());
    asked.set_all = given.collect();
    assert!(!asked.set_all.is_empty());
    let row = run(&asked, 2).row("offset").clone();
    let counts: Vec<usize> = row.by_form.iter().map(|of| of.n).collect();
    assert_eq!(counts, [6, 2]);
    for (of, band) in row.by_form.iter().zip(["0.13", "0.052"]) {
        let fuel = |words: &[&str]| {
            let band = format!("lubricant.friction.band={band}");
            let all = words.iter().copied().chain([band.as_str()]);
            let options = Options {
                set: all.map(|text| text.parse().unwrap()).collect(),
                ..Options::default()
            };
            let setup = setup::load(CVT, &options).unwrap();
            let all = drive(&setup, &cycle("ece15"), &at(25.0, Start::Soak))
                .totals
                .total();
            let density = setup.engine().fuel_density_kg_m3;
            litres_per_100km(all.fuel_kg, density, all.distance_m)
        };
        let offset = fuel(&["transmission.cvt.belt.band_offset_mm=1"]);
        let by_hand = 100.0 * (offset / fuel(&[]) - 1.0);
        let median = of.median_percent;
        assert!(
            (median - by_hand).abs() < 1e-4,
            "{}: {median} and {by_hand}",
            of.form
        );
    }
    assert!(row.depends_on_form() && !row.is_open_by_form());
}

/// Property: one form with all of the weight gives the bits of the same plan without forms.
#[test]
fn one_form_is_no_form() {
    let plan = |form: &str, of_form: &str| {
        let text = format!(
            "[study.design.latin_hypercube]\nsamples = 2\nseed = 1\n{form}[[factor]]\nkey = \"lubricant.friction.band\"\n{of_form}\
             status = \"assumed\"\ndistribution.uniform = {{ low = 0.09, high = 0.14 }}\n"
        );
        Plan::read("forms.toml", &text).unwrap()
    };
    let fuel = |plan: Plan| {
        let text = lever("offset", &["transmission.cvt.belt.band_offset_mm=1"]);
        let mut asked = request(&text, 5);
        if let Some((own, ..)) = &mut asked.draws {
            *own = plan;
        }
        let done = run(&asked, 2);
        assert!(done.row("offset").by_form.is_empty());
        let all = done.column(FUEL).into_iter().flatten();
        all.map(f64::to_bits).collect::<Vec<_>>()
    };
    let one = plan("[[form]]\nname = \"bands\"\n", "form = \"bands\"\n");
    assert_eq!(fuel(one), fuel(plan("", "")));
}
