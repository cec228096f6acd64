//! Plans of studies: every rule with a bad plan, the examples of the documentation, the shipped plans.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

use crate::announced::{differences, expectations};
use cvtcycle::config::setup::{self, Options};
use cvtcycle::config::{Argument, Override, Problems, render};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::study::Study;
use cvtcycle::study::plan::{
    Acts, Cars, Design, Distribution, FactorValue, FactorValues, Keep, PLAN, Plan, embedded_plans,
};
use proptest::prelude::*;

fn good(text: &str) -> Plan {
    Plan::read("p.toml", text).unwrap_or_else(|problems| panic!("{}", render(&problems, false)))
}

fn bad(text: &str) -> Problems {
    Plan::read("p.toml", text)
        .map(|plan| panic!("accepted: {}\n{plan:?}", plan.text))
        .unwrap_or_else(|problems| problems)
}

fn numbers(values: &FactorValues) -> Vec<f64> {
    let FactorValues::List(list) = values else {
        panic!("{values:?}")
    };
    let number = |value: &FactorValue| match value {
        FactorValue::Number(x) => *x,
        FactorValue::Word(word) => panic!("{word}"),
    };
    list.iter().map(number).collect()
}

fn words(values: &FactorValues) -> Vec<String> {
    let FactorValues::List(list) = values else {
        panic!("{values:?}")
    };
    assert!(
        list.iter()
            .all(|value| matches!(value, FactorValue::Word(_))),
        "{list:?}"
    );
    list.iter().map(ToString::to_string).collect()
}

#[test]
fn every_problem_of_a_bad_plan_is_reported_at_its_place() {
    let all = include_str!("../plans/bad.txt");
    let plans: Vec<&str> = all.split("====\n").skip(1).collect();
    assert!(plans.len() > 20);
    let mut wrong = String::new();
    for text in plans {
        // Announcements are comments, so that line numbers are unchanged.
        let problems = bad(text);
        let shown = render(&problems, false);
        assert!(
            problems
                .iter()
                .all(|p| p.place.file_name() == Some("p.toml")
                    && p.place.column > 0
                    && !p.place.line_text.is_empty()),
            "{shown}"
        );
        assert!(
            problems
                .windows(2)
                .all(|pair| pair[0].place.line <= pair[1].place.line),
            "{shown}"
        );
        assert!(
            !shown.contains("--set") && !shown.contains("top of the file"),
            "{shown}"
        );
        wrong += &differences(&expectations(text), &problems);
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

/// Plan with a number of factors of `values` entries each.
fn many(design: &str, factors: usize, values: usize) -> String {
    let list: Vec<String> = (0..values).map(|k| k.to_string()).collect();
    let factor = |k: usize| {
        format!(
            "[[factor]]\nkey = \"a.b{k}\"\nvalues = [{}]\n",
            list.join(", ")
        )
    };
    format!(
        "[study.design.{design}]\n{}",
        (0..factors).map(factor).collect::<String>()
    )
}

#[test]
fn limits_of_the_designs() {
    for (design, most) in [
        ("sobol]\nsamples = 4\n[study.x", 256),
        ("saltelli]\nsamples = 4\n[study.x", 128),
    ] {
        let text = |factors| many(design, factors, 2).replace("[study.x]\n", "");
        assert_eq!(
            good(&text(most)).design.points(&good(&text(most)).factors),
            Some(if most == 256 { 4 } else { 4 * 130 })
        );
        let problems = bad(&text(most + 1));
        assert!(
            problems.len() == 1 && problems[0].allowed == format!("up to {most} factors"),
            "{problems:?}"
        );
        assert_eq!(problems[0].place.line, 1);
    }
    let most = |design: Design| {
        design
            .sample_range()
            .map(|range| (*range.start(), *range.end()))
    };
    assert_eq!(
        most(Design::Sobol {
            samples: 4,
            seed: 1
        }),
        Some((2, 65_536))
    );
    assert_eq!(
        most(Design::MonteCarlo {
            samples: 4,
            seed: 1
        }),
        Some((2, 1_000_000_000))
    );
    assert_eq!(most(Design::Grid), None);
    // 2^64 points
    let problems = bad(&many("grid", 32, 4));
    assert!(
        problems.len() == 1
            && problems[0]
                .message
                .contains("more points than can be counted"),
        "{problems:?}"
    );
    let plan = good(&many("grid", 31, 4));
    assert_eq!(plan.design.points(&plan.factors), Some(1 << 62));
    let plan = good("[study]\ndesign = \"grid\"\n");
    assert_eq!(plan.design.points(&plan.factors), Some(1));
}

/// A thread keeps the traces of a point in memory, so their size is computed before the start, with the shortest step of the factors.
#[test]
fn the_traces_of_a_point_are_counted_before_anything_runs() {
    let cars = ["\"rover_216_5mt\""; 9].join(", ");
    let plan = |head: &str, factor: &str| {
        let design = if factor.contains("distribution") {
            "design.monte_carlo.samples = 70"
        } else {
            "design = \"grid\""
        };
        let text = format!(
            "[study]\ntitle = \"t\"\nvehicle = \"rover_216_5mt\"\nbaselines = [{cars}]\ncycle = \"wltc_class3b\"\n{head}\n\
             {design}\n[[factor]]\n{factor}\n"
        );
        Study::prepare(good(&text))
    };
    let refused = |head: &str, factor: &str| match plan(head, factor) {
        Err(problems) if problems.len() == 1 => problems[0].clone(),
        Err(problems) => panic!("{problems:?}"),
        Ok(_) => panic!("{head}: accepted"),
    };
    let ambient = "key = \"ambient_degc\"\nvalues = [0, 10]";
    let dt = |values: &str| format!("key = \"dt_s\"\n{values}");
    // Ten cars through 1800 s: 1 800 000 steps of 0.01 s, each with some 50 columns.
    let few = plan("keep = [\"time_s\"]\ndt_s = 0.01", ambient).unwrap();
    assert_eq!(few.points_per_part(), 1);
    let coarse = plan("keep = [\"time_s\"]", &dt("values = [1, 2]")).unwrap();
    let fine = plan("keep = [\"time_s\"]", &dt("values = [1, 0.1]")).unwrap();
    assert!(coarse.points_per_part() >= fine.points_per_part());
    let everything = "keep = \"everything\"";
    assert!(plan("dt_s = 0.01", ambient).is_ok() && plan(everything, ambient).is_ok());
    let cells = refused(&format!("{everything}\ndt_s = 0.01"), ambient);
    assert!(
        cells.message.starts_with("one point keeps ")
            && cells.key == "keep"
            && cells.place.line == 6,
        "{cells:?}"
    );
    let spread = "status = \"assumed\"\ndistribution.uniform = { low = 0.01, high = 1 }";
    for factor in [dt("values = [1, 0.01]"), dt(spread)] {
        let problem = refused(everything, &factor);
        assert!(
            problem.message.starts_with("one point keeps "),
            "{problem:?}"
        );
    }
}

#[test]
fn plans_without_toml_or_study_table_are_refused() {
    assert_eq!(bad("[study\n")[0].place.line, 1);
    let problems = bad("");
    assert!(
        problems.len() == 1 && problems[0].key == "study.design",
        "{problems:?}"
    );
    let problems = bad("study = 3\n");
    assert!(
        problems.len() == 1 && problems[0].message.contains("expected a table"),
        "{problems:?}"
    );
}

#[test]
fn defaults_are_those_of_run() {
    let plan = good("[study]\ndesign = \"grid\"\n");
    let base = &plan.base;
    assert_eq!(
        (plan.title.as_str(), plan.question.as_str(), plan.most_runs),
        ("p", "", 100_000)
    );
    assert_eq!(
        (
            base.vehicle.as_str(),
            &base.baselines,
            base.cycle.as_str(),
            base.start.as_str()
        ),
        ("rover_216_cvt", &None, "ece15_eudc", "soak")
    );
    assert_eq!(
        (base.ambient_degc, base.dt_s, base.formulation),
        (25.0, 1.0, Formulation::Smooth)
    );
    assert_eq!(
        (
            &base.lubricant,
            &base.engine_oil,
            base.set.len(),
            base.set_all.len()
        ),
        (&None, &None, 0, 0)
    );
    assert_eq!((&plan.keep, plan.analyse.len()), (&Keep::Summary, 0));
    let help = assert_cmd::Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(["run", "--help"])
        .output()
        .unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    for default in ["rover_216_cvt", "ece15_eudc", "25", "auto", "1", "smooth"] {
        assert!(
            help.contains(&format!("[default: {default}]")),
            "{default}: {help}"
        );
    }
}

#[test]
fn the_head_is_taken_as_written() {
    let plan = good(
        "[study]\ntitle = \"T\"\nquestion = \"Q?\"\nvehicle = \"my/car.toml\"\nbaselines = []\ncycle = \"constant_88.5\"\nambient_degc = -7.3\n\
         start = 40.5\nlubricant = \"oil.toml\"\nengine_oil = \"engine_5w30\"\nset = [\"a.b=c\", \"d.e=[1, 2]\"]\nset_all = [\"f.g=1\"]\n\
         dt_s = 0.5\nformulation = \"chapter_8\"\nkeep = [\"time_s\", \"speed_kmh\"]\nanalyse = [\"fuel_l_per_100km\"]\nmost_runs = 7\n\
         [study.design.latin_hypercube]\nsamples = 10\nseed = 9223372036854775807\n[[factor]]\nkey = \"dt_s\"\nvalues = [1]\n",
    );
    let base = &plan.base;
    assert_eq!(
        (base.vehicle.as_str(), base.baselines.as_deref()),
        ("my/car.toml", Some(&[] as &[String]))
    );
    assert_eq!(
        (base.cycle.as_str(), base.ambient_degc, base.start.as_str()),
        ("constant_88.5", -7.3, "40.5")
    );
    assert_eq!(
        (base.lubricant.as_deref(), base.engine_oil.as_deref()),
        (Some("oil.toml"), Some("engine_5w30"))
    );
    assert_eq!(
        (format!("{:?}", base.set), format!("{:?}", base.set_all)),
        (
            r#"["a.b=c", "d.e=[1, 2]"]"#.to_owned(),
            r#"["f.g=1"]"#.to_owned()
        )
    );
    assert_eq!(
        (base.dt_s, base.formulation, plan.most_runs),
        (0.5, Formulation::Chapter8, 7)
    );
    assert_eq!(
        plan.keep,
        Keep::Columns(vec!["time_s".into(), "speed_kmh".into()])
    );
    assert_eq!(plan.analyse, ["fuel_l_per_100km"]);
    assert_eq!(
        plan.design,
        Design::LatinHypercube {
            samples: 10,
            seed: i64::MAX as u64
        }
    );
    let line = |key: &str| plan.places.place(key).line;
    assert_eq!(
        [
            line("vehicle"),
            line("set"),
            line("design"),
            line("design.samples"),
            line("not given")
        ],
        [4, 11, 18, 19, 1]
    );
    assert_eq!(
        (
            plan.places.nth("set", 1).line,
            plan.places.nth("set", 1).column
        ),
        (11, 17)
    );
    assert_eq!(
        good("[study]\nkeep = \"everything\"\ndesign = \"grid\"\n").keep,
        Keep::Everything
    );
}

#[test]
fn factors_are_taken_as_written() {
    let plan = good(
        "[study.design.one_at_a_time]\n[[factor]]\nkey = \"start\"\nvalues = [\"soak\", 60, 20.5]\n[[factor]]\nkey = \"transmission.cvt.pump\"\n\
         values = [\"fixed\", [1, 2], true]\n[[factor]]\nkey = \"a.oil_degc\"\nacts = \"offset\"\ncars = \"all\"\nvalues = [-1, 1]\nstatus = \"fitted\"\n\
         source = \"S\"\n[[factor]]\nkey = \"a.line_bar\"\nname = \"line\"\nacts = \"scale\"\ncars = \"baselines\"\nrange = { from = 0.8, to = 1.2, count = 5 }\n\
         [[factor]]\nkey = \"a.line_bar\"\nrange = { from = 0, to = 0.35, step = 0.1 }\n[[factor]]\nkey = \"ambient_degc\"\nvalues = [1]\n",
    );
    let f = &plan.factors;
    assert_eq!(
        (words(&f[0].values).join(" "), f[0].unit.as_str(), f[0].cars),
        ("soak 60 20.5".to_owned(), "", Cars::All)
    );
    assert_eq!(
        (words(&f[1].values).join(" "), f[1].unit.as_str(), f[1].cars),
        ("fixed [1, 2] true".to_owned(), "", Cars::Subject)
    );
    assert_eq!(
        (f[2].unit.as_str(), f[2].acts, f[2].cars, f[2].name.as_str()),
        ("K", Acts::Offset, Cars::All, "a.oil_degc")
    );
    assert_eq!(
        (f[2].status.as_str(), f[2].source.as_str()),
        ("fitted", "S")
    );
    assert_eq!(
        (f[3].unit.as_str(), numbers(&f[3].values)),
        ("-", vec![0.8, 0.9, 1.0, 1.1, 1.2])
    );
    assert_eq!(
        (f[4].unit.as_str(), numbers(&f[4].values)),
        ("bar", vec![0.0, 0.1, 0.2, 0.3, 0.35])
    );
    assert_eq!((f[5].unit.as_str(), f[5].cars), ("°C", Cars::All));
    assert_eq!(
        (
            f[0].place.line,
            f[0].places.nth("values", 1).line,
            f[0].places.nth("values", 1).column
        ),
        (3, 4, 19)
    );
    assert_eq!(
        (
            f[3].places.nth("values", 2).line,
            f[3].places.place("range").line
        ),
        (20, 20)
    );
    assert_eq!(
        (plan.span(4), plan.span(0), plan.span(9)),
        (Some((0.0, 0.35)), None, None)
    );
}

#[test]
fn the_same_key_for_subject_and_baselines_has_two_names() {
    let plan = good(
        "[study]\ndesign = \"grid\"\n[[factor]]\nkey = \"a.b\"\nvalues = [1]\n[[factor]]\nkey = \"a.b\"\ncars = \"baselines\"\nvalues = [1]\n",
    );
    assert_eq!(
        [plan.factors[0].name.as_str(), plan.factors[1].name.as_str()],
        ["a.b", "a.b (baselines)"]
    );
}

/// The examples of docs/plan_format.md are valid plans, and the complete one is read as it appears.
#[test]
fn examples_of_the_documentation() {
    let page = include_str!("../../docs/plan_format.md");
    let blocks: Vec<&str> = page
        .split("```toml\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap())
        .collect();
    assert_eq!(blocks.len(), 2);
    let plans: Vec<Plan> = blocks.into_iter().map(good).collect();
    let plan = &plans[0];
    assert_eq!(
        plan.design,
        Design::Saltelli {
            samples: 256,
            seed: 1
        }
    );
    assert_eq!(plan.design.points(&plan.factors), Some(256 * 5));
    assert_eq!(numbers(&plan.factors[0].values), [7.0, 7.5, 8.0, 8.5, 9.0]);
    assert_eq!(plan.factors[0].unit, "cm³/rev");
    let triangular = Distribution::Triangular {
        low: 0.5,
        mode: 1.0,
        high: 1.5,
    };
    assert_eq!(
        plan.factors[1].values,
        FactorValues::Distribution(triangular)
    );
    assert_eq!(
        (
            plan.factors[1].places.place("distribution").line,
            plan.factors[1].places.place("distribution.high").line
        ),
        (27, 30)
    );
    assert_eq!(
        plan.factors[2].values,
        FactorValues::Distribution(Distribution::Lognormal {
            median: 1.0,
            geometric_sd: 1.1
        })
    );
    plans.iter().for_each(in_the_cars);
    assert_eq!(words(&plans[1].factors[0].values), ["soak", "warm", "60"]);
    for key in [
        "vehicle",
        "baselines",
        "cycle",
        "ambient_degc",
        "start",
        "lubricant",
        "engine_oil",
        "set",
        "dt_s",
        "formulation",
        "keep",
        "analyse",
        "most_runs",
        "title",
        "question",
        "key",
        "name",
        "cars",
        "acts",
        "values",
        "range",
        "status",
        "source",
        "grid",
        "one_at_a_time",
        "latin_hypercube",
        "sobol",
        "monte_carlo",
        "saltelli",
        "normal",
        "truncated_normal",
        "uniform",
        "triangular",
        "lognormal",
    ] {
        assert!(
            page.contains(&format!("`{key}`")),
            "{key} is not in the documentation"
        );
    }
}

/// Checks that the cars accept the ends of every factor that is one of their keys.
fn in_the_cars(plan: &Plan) {
    let baselines = plan.base.baselines.clone().unwrap_or_default();
    for (k, factor) in plan
        .factors
        .iter()
        .enumerate()
        .filter(|(_, factor)| factor.key.contains('.'))
    {
        let cars = match factor.cars {
            Cars::Subject => vec![plan.base.vehicle.clone()],
            Cars::Baselines => baselines.clone(),
            Cars::All => [plan.base.vehicle.clone()]
                .into_iter()
                .chain(baselines.clone())
                .collect(),
        };
        let Some((low, high)) = plan.span(k) else {
            continue;
        };
        for (car, end) in cars.iter().flat_map(|car| [(car, low), (car, high)]) {
            let own = setup::load(car, &Options::default()).unwrap();
            let own = own
                .keys
                .iter()
                .find(|info| info.key == factor.key)
                .unwrap_or_else(|| panic!("{car} has no {}", factor.key));
            let own: f64 = own.value.parse().unwrap();
            let value = match factor.acts {
                Acts::Value => end,
                Acts::Scale => own * end,
                Acts::Offset => own + end,
            };
            let options = Options {
                set: vec![Override::number(&factor.key, value)],
                ..Options::default()
            };
            setup::load(car, &options)
                .unwrap_or_else(|problems| panic!("{}", render(&problems, false)));
        }
    }
}

#[test]
fn shipped_plans_are_valid() {
    for (name, text) in embedded_plans() {
        let plan =
            Plan::open(name).unwrap_or_else(|problems| panic!("{}", render(&problems, false)));
        assert_eq!(
            (plan.file.as_str(), plan.text.as_str()),
            (format!("embedded:{name}.toml").as_str(), *text)
        );
        assert!(!plan.question.is_empty() && !["ambient", "show", "export"].contains(name));
        assert!(std::path::Path::new(&format!("plans/{name}.toml")).exists());
        in_the_cars(&plan);
    }
    let points = |name: &str| {
        Plan::open(name)
            .map(|plan| plan.design.points(&plan.factors))
            .unwrap()
    };
    assert_eq!(
        (points("pump_and_offset"), points("oil_at_minus_10")),
        (Some(35), Some(6))
    );
    let oils = words(&Plan::open("oil_at_minus_10").unwrap().factors[0].values);
    assert_eq!(oils, ["dexron_ii", "dexron_iii", "cvtf_ezl799_class"]);
}

#[test]
fn unknown_plans_are_reported() {
    let problems = Plan::open("pump_and_ofset").unwrap_err();
    assert!(
        problems[0].place.is_argument(Argument::Plan)
            && problems[0].hint.contains("did you mean `pump_and_offset`?"),
        "{problems:?}"
    );
    let problems = Plan::open("no/such.toml").unwrap_err();
    assert!(
        problems[0].message.contains("cannot read `no/such.toml`"),
        "{problems:?}"
    );
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("own.toml");
    std::fs::write(&path, "[study]\ndesign = \"grid\"\nstart = \"x\"\n").unwrap();
    let path = path.to_string_lossy().into_owned();
    assert_eq!(
        Plan::open(&path).unwrap_err()[0].place.file_name(),
        Some(&*path)
    );
    std::fs::write(&path, [0xff, 0x00]).unwrap();
    assert!(Plan::open(&path).unwrap_err()[0].message.contains("binary"));
}

proptest! {
    /// Any deletion from or insertion into a plan gives a plan or problems with places within the text.
    #[test]
    fn no_text_makes_it_panic(from in 0_usize..900, length in 0_usize..40, put in "[a-z0-9=\\[\\]\"\n .{}-]{0,12}") {
        let page = include_str!("../../docs/plan_format.md");
        let text = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let (from, to) = (from.min(text.len()), (from + length).min(text.len()));
        let text = format!("{}{put}{}", &text[..from], &text[to..]);
        if let Err(problems) = Plan::read("p.toml", &text) {
            prop_assert!(!problems.is_empty());
            prop_assert!(problems.iter().all(|p| p.place.line <= text.lines().count() && !p.message.is_empty()));
        }
    }
}

/// Property: the page on plans names every key of their rows.
#[test]
fn the_page_on_plans_names_every_key() {
    let page = include_str!("../../docs/plan_format.md");
    for info in setup::catalogue::keys_of(&PLAN) {
        let name = info.key.rsplit('.').next().unwrap_or_default();
        assert!(page.contains(name), "{}", info.key);
        assert!(
            !info.doc.is_empty() && !info.allowed.is_empty(),
            "{}",
            info.key
        );
    }
}
