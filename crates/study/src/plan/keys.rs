//! Keys of a plan, one row each: reading, `explain`, the documentation and the schema come from them.

use cvtcycle_config::cycle;
use cvtcycle_config::setup::{AMBIENT, Kind as File};
use cvtcycle_model::keys;
use cvtcycle_model::keys::{Bound, Choice, Key, Kind, Presence, Quantity, Repeat, Table};
use cvtcycle_model::transmission::cvt::variator::Formulation;

use super::{FactorValue, RUN_OPTIONS};

/// Most values of a range.
pub(super) const MAX_IN_RANGE: i64 = 10_000;
/// Most samples of a design without a limit of its own.
pub const MAX_SAMPLES: u64 = 1_000_000_000;

/// A plan: its head and its factors.
pub const PLAN: Table = Table::from_tables(&[
    StudyKeys::TABLE,
    FormKeys::TABLE.repeated(Repeat::List),
    FactorKeys::TABLE.repeated(Repeat::List),
]);

keys! {
    /// Keys of `[study]`.
    STUDY: StudyKeys = "study" [] {
        title: computed("name of the file", text()), "name for people";
        question: optional(text()), "what the study is to answer";
        vehicle: or_word("rover_216_cvt", name(vehicles)), "the car in question";
        baselines: computed("those of the vehicle", list_of(&Kind::Text, "a list of vehicles")), "cars to compare with; [] for none";
        cycle: or_word("ece15_eudc", name(cycles)), "cycle of all runs";
        ambient_degc: or(25.0, within(AMBIENT)), "ambient temperature";
        start: or_word("soak", either(START)), "temperatures at the start", "_degc";
        lubricant: computed("that of the vehicle", name(lubricants)), "transmission oil of the car in question";
        engine_oil: computed("that of each vehicle", name(lubricants)), "engine oil of all cars";
        set: optional(list_of(&Kind::Text, "a list of texts KEY=VALUE")), "overrides KEY=VALUE of the car in question";
        set_all: optional(list_of(&Kind::Text, "a list of texts KEY=VALUE")), "overrides KEY=VALUE of all cars";
        dt_s: or(1.0, number(0.01, 10.0)), "longest time step";
        formulation: words(Formulation::CHOICES, "smooth"), "reading of the belt model";
        keep: or_word("summary", either(KEEP)), "what is kept of each run";
        analyse: computed("the fuel columns", list_of(&Kind::Text, "a list of columns of the results")), "columns that are analysed";
        most_runs: integer(1, 10_000_000, 100_000), "number of runs above which a study has to be confirmed";
        missing: words(MISSING, "refuse"), "what a factor does whose key a car does not have";
        bounds: words(BOUNDS, "refuse"), "what becomes of a number outside the range of its key";
        design: options(DESIGNS), "which combinations are driven";
    }
}

const START: &[Kind] = &[
    Kind::Words(&[
        Choice::word("soak", "everything at ambient temperature"),
        Choice::word("warm", "everything at working temperature"),
    ]),
    Kind::Number(Bound::closed(-40.0, 130.0)),
];

const KEEP: &[Kind] = &[
    Kind::Words(&[
        Choice::word("summary", "the row of the run"),
        Choice::word("everything", "all columns of the trace as well"),
    ]),
    Kind::List(&Kind::Text, "a list of columns of the trace"),
];

const MISSING: &[Choice] = &[
    Choice::word("refuse", "the study does not begin"),
    Choice::word("skip", "it does not act on that car"),
];

const BOUNDS: &[Choice] = &[
    Choice::word("refuse", "the study does not begin"),
    Choice::word("clip", "it is held at the end of the range"),
];

const DESIGNS: &[Choice] = &[
    Choice::word(
        "grid",
        "every value of each factor with every value of the others",
    ),
    Choice::new(
        "one_at_a_time",
        "the base, then each factor by itself",
        OneAtATimeKeys::TABLE,
    ),
    Choice::new(
        "latin_hypercube",
        "each of equal strata of every factor once",
        SampleKeys::TABLE,
    ),
    Choice::new(
        "sobol",
        "Owen-scrambled Sobol sequence, up to 65536 samples",
        SampleKeys::TABLE,
    ),
    Choice::new("monte_carlo", "independent draws", SampleKeys::TABLE),
    Choice::new(
        "saltelli",
        "blocks for Sobol indices, up to 65536 samples",
        SampleKeys::TABLE,
    ),
];

keys! {
    /// Keys of the design `one_at_a_time`.
    ONE_AT_A_TIME: OneAtATimeKeys = "" [] {
        quantile: or(0.05, number(1e-6, 0.49)), "lower quantile of distributions; the upper one is 1 - it";
    }
}

keys! {
    /// Keys of the designs that draw samples.
    SAMPLE: SampleKeys = "" [] {
        samples: number(2.0, MAX_SAMPLES as f64), "number of samples";
        seed: integer(0, i64::MAX, 1), "seed";
    }
}

keys! {
    /// Keys of `[[form]]`.
    FORM: FormKeys = "form" [] {
        name: text(), "short name, by which factors belong to it";
        title: computed("the name", text()), "name for people";
        weight: or(1.0, number(0.0, 1e6)), "its weight against the other forms; 0 leaves it out";
        source: optional(text()), "data that it was fitted to, and how well";
    }
}

keys! {
    /// Keys of `[[factor]]`.
    FACTOR: FactorKeys = "factor" [RangeKeys::TABLE.repeated(Repeat::Optional)] {
        key: text(), "run option or dotted key that is varied";
        name: computed("the key", text()), "short name for tables and plots";
        cars: computed("subject; all for run options", words(CARS, "subject")), "whose value it is";
        form: optional(text()), "name of the form in whose draws alone it acts";
        acts: words(ACTS, "value"), "what a number does with the value of the car's file";
        values: optional(list_of(&Kind::Other(""), "a list of numbers or words")), "values, each for itself";
        distribution: optional(options(DISTRIBUTIONS)), "how the values are distributed";
        status: (Kind::Words(STATUSES), Presence::RequiredIf("with a distribution")), "how the values are known";
        source: optional(text()), "reason or reference for the values";
        test: optional(text()), "the test that would tell the value, for people: what to measure next";
    }
}

const CARS: &[Choice] = &[
    Choice::word("subject", "of the car in question"),
    Choice::word("baselines", "of the baselines"),
    Choice::word("all", "of all cars, with the same draw"),
];

const ACTS: &[Choice] = &[
    Choice::word("value", "it is the value"),
    Choice::word("scale", "it multiplies the value"),
    Choice::word("offset", "it is added to the value"),
];

/// Words of the status of a value in a plan.
pub const STATUSES: &[Choice] = &[
    Choice::word("source", "a reference states them"),
    Choice::word("derived", "computed from known values"),
    Choice::word("fitted", "fitted to measurements"),
    Choice::word("assumed", "an assumption"),
];

keys! {
    /// Keys of `[factor.range]`.
    RANGE: RangeKeys = "range" [] {
        from: within(Bound::any()), "first value";
        to: within(Bound::any()), "last value";
        step: optional(within(Bound::positive())), "distance of the values; the last one may be nearer";
        count: optional(integer(2, MAX_IN_RANGE, 2)), "number of values, with both ends";
    }
}

const DISTRIBUTIONS: &[Choice] = &[
    Choice::new("normal", "normal", NormalKeys::TABLE),
    Choice::new(
        "truncated_normal",
        "normal, cut off at both ends",
        TruncatedKeys::TABLE,
    ),
    Choice::new("uniform", "uniform", UniformKeys::TABLE),
    Choice::new("triangular", "triangular", TriangularKeys::TABLE),
    Choice::new("lognormal", "lognormal", LognormalKeys::TABLE),
];

keys! {
    /// Keys of the distribution `normal`.
    NORMAL: NormalKeys = "" [] {
        mean: within(Bound::any()), "mean";
        sd: within(Bound::positive()), "standard deviation";
    }
}

keys! {
    /// Keys of the distribution `truncated_normal`.
    TRUNCATED: TruncatedKeys = "" [] {
        mean: within(Bound::any()), "mean before the cut";
        sd: within(Bound::positive()), "standard deviation before the cut";
        low: within(Bound::any()), "least value";
        high: within(Bound::any()), "largest value";
    }
}

keys! {
    /// Keys of the distribution `uniform`.
    UNIFORM: UniformKeys = "" [] {
        low: within(Bound::any()), "least value";
        high: within(Bound::any()), "largest value";
    }
}

keys! {
    /// Keys of the distribution `triangular`.
    TRIANGULAR: TriangularKeys = "" [] {
        low: within(Bound::any()), "least value";
        mode: within(Bound::any()), "most likely value";
        high: within(Bound::any()), "largest value";
    }
}

keys! {
    /// Keys of the distribution `lognormal`.
    LOGNORMAL: LognormalKeys = "" [] {
        median: within(Bound::positive()), "median";
        geometric_sd: above(1.0, 10.0), "68 % lie between median / g and median g; 1.1 for about 10 %";
    }
}

fn cycles() -> String {
    "a name of `cvtcycle list cycles`, constant_V with V in km/h, or the path of a CSV file"
        .to_owned()
}

fn vehicles() -> String {
    format!(
        "{}, or the path of a TOML file",
        File::Vehicle.names().join(", ")
    )
}

/// Lubricants that a plan or a lever can name, for messages.
pub fn lubricants() -> String {
    format!(
        "{}, or the path of a TOML file",
        File::Lubricant.names().join(", ")
    )
}

/// The row of a run option; none for a key of a file.
pub(super) fn run_option(key: &str) -> Option<&'static Key<'static>> {
    RUN_OPTIONS.contains(&key).then(|| {
        StudyKeys::TABLE
            .keys
            .iter()
            .find(|row| row.name == key)
            .copied()
    })?
}

/// Unit of the numbers of a run option or of a dotted key.
pub(super) fn quantity(key: &str) -> Quantity {
    run_option(key).map_or_else(|| Quantity::from_key(key), |row| row.quantity)
}

/// Range of the numbers of a run option; none where it takes words only, or for a key of a file.
pub(super) fn range(key: &str) -> Option<Bound> {
    numbers(&run_option(key)?.kind)
}

/// Range of the numbers that a kind accepts.
pub(super) fn numbers(kind: &Kind) -> Option<Bound> {
    match kind {
        Kind::Number(range) => Some(*range),
        Kind::Either(kinds) => kinds.iter().find_map(numbers),
        _ => None,
    }
}

/// Words that a row accepts: its options, or the known names of files.
pub(super) fn known_words(row: &Key) -> Vec<&'static str> {
    match (row.kind, row.name) {
        (Kind::Either(kinds), _) => kinds.iter().flat_map(options).collect(),
        (Kind::Name(_), "cycle") => cycle::names().to_vec(),
        (Kind::Name(_), "vehicle") => File::Vehicle.names(),
        (Kind::Name(_), _) => File::Lubricant.names(),
        (kind, _) => options(&kind).collect(),
    }
}

fn options(kind: &Kind) -> impl Iterator<Item = &'static str> {
    let choices: &[Choice] = match kind {
        Kind::Words(choices) => choices,
        _ => &[],
    };
    choices.iter().map(|choice| choice.name)
}

/// Gives the value of a row where the key is absent.
pub(super) fn default(row: &Key) -> Option<FactorValue> {
    match row.presence {
        Presence::Number(x) => Some(FactorValue::Number(x)),
        Presence::Integer(n) => Some(FactorValue::Number(n as f64)),
        Presence::Word(word) => Some(FactorValue::Word(word.into())),
        _ => None,
    }
}
