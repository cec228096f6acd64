//! The answer of one sample. Truth: properties of a paired sample, and the same cars drawn in another question.

use cvtcycle::analysis::answer::{Answer, HEARD_RPM, Question, drive, prepare};
use cvtcycle::analysis::draws::{self, compare};
use cvtcycle::analysis::levers::LeverFile;
use cvtcycle::config::Override;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::progress::NoProgress;
use cvtcycle::output::summary::DrawnDifference;
use cvtcycle::study::plan::Base;

const DRAWS: u64 = 24;

fn base(set: &[&str]) -> Base {
    Base {
        vehicle: "rover_216_cvt".to_owned(),
        baselines: Some(vec!["rover_216_5mt".to_owned()]),
        cycle: "ece15".to_owned(),
        ambient_degc: -10.0,
        start: "soak".to_owned(),
        lubricant: None,
        engine_oil: None,
        set: set
            .iter()
            .map(|text| text.parse::<Override>().unwrap())
            .collect(),
        set_all: Vec::new(),
        dt_s: 1.0,
        formulation: Formulation::default(),
    }
}

fn answer(question: &Question) -> Answer {
    drive(&prepare(question).unwrap(), &NoProgress)
        .unwrap()
        .unwrap()
}

/// True if all quantiles are 0 to the last bit.
fn is_zero(quantiles: [f64; 3]) -> bool {
    quantiles.iter().all(|x| x.abs() == 0.0)
}

/// A question without levers and prices.
fn plain(base: Base, draws: u64) -> Question {
    Question {
        base,
        levers: Vec::new(),
        prices: false,
        draws,
        heard_rpm: HEARD_RPM,
    }
}

fn differences(set: &[&str]) -> Vec<(String, DrawnDifference)> {
    let study = draws::prepare(&base(set), DRAWS).unwrap();
    draws::drive(&study, &NoProgress).unwrap().unwrap()
}

/// Levers and prices add columns to the sample; what they are next to keeps its bits, though levers are driven one by one and other cars side by
/// side.
#[test]
fn a_document_has_one_sample() {
    let text =
        "[[lever]]\nname = \"offset\"\nset = [\"transmission.cvt.belt.band_offset_mm*=0.6\"]\n";
    let whole = answer(&Question {
        levers: LeverFile::read("own.toml", text).unwrap().levers,
        prices: true,
        ..plain(base(&[]), DRAWS)
    });
    assert_eq!(whole.differences, differences(&[]));
    assert_eq!(whole.differences[0].0, "rover_216_5mt");
    assert_eq!(whole.differences[0].1.fuel_l_per_100km, whole.fuel());
    assert_eq!(whole.levers.as_ref().unwrap().blocks[0].rows.len(), 1);
    let pump = whole
        .prices
        .iter()
        .find(|(name, _)| name == "pump")
        .unwrap()
        .1;
    assert!(
        0.0 < pump[0] && pump[0] < pump[1] && pump[1] < pump[2],
        "{pump:?}"
    );
}

/// A value that is set to what it is changes nothing in any draw; the car before it comes first, then the baselines.
#[test]
fn no_change_is_none_in_every_draw() {
    let same = differences(&["transmission.cvt.belt.band_offset_mm=3"]);
    let names: Vec<&str> = same.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["unchanged", "rover_216_5mt"]);
    assert!(is_zero(same[0].1.percent));
    let less = differences(&["transmission.cvt.belt.band_offset_mm=2"]);
    let [low, median, high] = less[0].1.percent;
    assert!(
        low < median && median < high && high < 0.0,
        "{low} {median} {high}"
    );
}

/// A loss that the car does not have costs nothing.
#[test]
fn a_loss_that_is_absent_has_no_price() {
    let found = answer(&Question {
        prices: true,
        ..plain(base(&["transmission.cvt.loss_factor.pump=0"]), DRAWS)
    });
    let price = |name: &str| found.prices.iter().find(|(own, _)| own == name).unwrap().1;
    assert!(is_zero(price("pump")));
    assert!(price("final_drive")[0] > 0.0);
}

/// A pump that is too small slips in nearly all draws: no range is claimed and the cause is named.
#[test]
fn failing_draws_claim_no_range() {
    let small = differences(&["transmission.cvt.pump.displacement_cc_rev=2"]);
    let own = &small[0].1;
    assert!(own.failed_share() > 0.5 && own.ends().is_none(), "{own:?}");
    let words = own.failures_in_words().unwrap();
    assert!(words.contains("fail: gross_slip in "), "{words}");
    let good = &differences(&[])[0].1;
    assert_eq!((good.left_out, good.failures_in_words()), (0, None));
}

/// Two runs against each other are what each is against the car that both change: the ratio of their fuels, draw by draw.
#[test]
fn runs_are_compared_over_one_sample() {
    let set = ["transmission.cvt.belt.band_offset_mm=2"];
    let found = compare(&base(&[]), &[base(&set), base(&[])], DRAWS).unwrap();
    assert_eq!(found.len(), 2);
    assert!(is_zero(found[1].percent));
    let [low, _, high] = found[0].percent;
    let direct = &differences(&set)[0].1;
    assert!(low < high && high < 0.0);
    for (a, b) in found[0].percent.iter().zip(direct.percent) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

/// A range that a file gives its value is drawn in place of that of the plan. Truth: with a range of next to nothing the value is certain, so that the
/// draws of the fuel are narrower; with the whole range they are not.
#[test]
fn ranges_of_a_file_are_drawn() {
    let dir = tempfile::tempdir().unwrap();
    let spread = |name: &str, range: &str| {
        let file = dir.path().join(format!("{name}.toml"));
        let text = format!(
            "[vehicle]\nlike = \"rover_216_cvt\"\n[road_load.form.coefficients]\nf2_n_per_kmh2 = {{ value = 0.0433, range = {range}, status = \"assumed\" }}\n"
        );
        std::fs::write(&file, text).unwrap();
        let mut base = base(&[]);
        base.vehicle = file.to_string_lossy().into_owned();
        base.baselines = Some(Vec::new());
        "constant_120".clone_into(&mut base.cycle);
        base.ambient_degc = 25.0;
        let [low, _, high] = answer(&plain(base, 64)).fuel_l_per_100km;
        high - low
    };
    let (narrow, wide) = (
        spread("narrow", "[0.0432, 0.0434]"),
        spread("wide", "[0.02, 0.08]"),
    );
    assert!(wide > 2.0 * narrow, "{narrow} {wide}");
}
