//! Keys of validation files, and of the sources that validation files and calibration plans share.
//!
//! Reading, messages, `cvtcycle schema` and the page of the format come from these rows.

use cvtcycle_config::setup::AMBIENT;
use cvtcycle_model::keys::spec::{Spec, required_if};
use cvtcycle_model::keys::{Bound, Choice, Column, Repeat, Table, keys};
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// A validation file.
pub const VALIDATION: Table = FileKeys::TABLE;

keys! {
    /// Keys at the head of a file.
    FILE: FileKeys = "" [
        ToleranceKeys::TABLE.repeated(Repeat::Named),
        SOURCES,
        RowKeys::TABLE.repeated(Repeat::List),
    ] {
        group: words(&GROUPS, "own"), "whose numbers the rows have; each group is counted apart";
    }
}

/// Groups in the order of [`super::Group`].
pub(super) static GROUPS: [Choice; 3] = [
    Choice::word("thesis", "the thesis after which the model was made"),
    Choice::word("outside", "public data of other cars"),
    Choice::word("own", "the user's"),
];

keys! {
    /// Keys of `[tolerances.NAME]`.
    TOLERANCE: ToleranceKeys = "tolerances" [] {
        width: optional(number(0.0, 1e9)), "width on both sides, in the unit of the row";
        share: optional(number(0.0, 10.0)), "width as a share of the printed number";
        unit: or_word("-", text()), "unit of the width";
        from: text(), "where the width comes from";
    }
}

keys! {
    /// Keys of `[[row]]`.
    ROW: RowKeys = "row" [
        CauseKeys::TABLE.repeated(Repeat::Optional),
        AboutKeys::TABLE.repeated(Repeat::Optional),
    ] {
        id: text(), "identifier, unique over all files";
        chapter: text(), "chapter of the thesis, or a word for the user's own rows";
        mechanism: words(&MECHANISM_CHOICES, "user"), "page of the book";
        kind: words(&STATEMENTS, "N"), "kind of statement";
        what: text(), "what is compared";
        condition: optional(text()), "at which condition";
        printed: text(), "the printed text";
        unit: or_word("-", text()), "unit of printed and computed numbers";
        value: optional(within(Bound::any())), "printed number";
        low: optional(within(Bound::any())), "smallest printed number";
        high: optional(within(Bound::any())), "largest printed number";
        expect: flag(true), "whether the order or sign is printed as holding";
        tolerance: required_if("with numbers", text()), "name of a tolerance at the head of the file";
        mean: optional(within(Bound::any())), "mean of a fleet";
        sd: optional(above(0.0, 1e9)), "standard deviation of one car of the fleet";
        n: optional(number(2.0, 1e9)), "number of cars of the fleet";
        z: or(1.0, number(0.1, 10.0)), "distance from the mean up to which a car agrees, in standard deviations of one more car";
        data: optional(text()), "file and lines that mean, sd and n come from";
        fitted_to: texts(), "parameters that were fitted to this number";
        compute: optional(text()), "how it is computed";
        verdict: optional(words(&VERDICTS, "")), "recorded verdict";
        reason: optional(text()), "why it differs or cannot be compared; needed then";
        remark: optional(text()), "what else a reader should know";
    }
}

keys! {
    /// Keys of the `cause` of a row that differs.
    CAUSE: CauseKeys = "cause" [] {
        what: text(), "what the number is";
        unit: or_word("-", text()), "its unit";
        compute: text(), "how it is computed";
    }
}

keys! {
    /// Keys of the `about` of a row: the run whose headline it is.
    ABOUT: AboutKeys = "about" [] {
        subject: text(), "vehicle of the run";
        baseline: optional(text()), "vehicle that its fuel is compared with; without it the row is the fuel itself";
        cycle: text(), "cycle of the run";
        ambient_degc: within(AMBIENT), "ambient temperature of the run";
        start: words(&STARTS, "soak"), "temperatures at its start";
        phase: optional(text()), "group of phases; the whole cycle if absent";
    }
}

/// Pages of the book that a row may belong to.
pub const MECHANISMS: [&str; 28] = [
    "introduction",
    "belt",
    "solve",
    "geometry",
    "tension",
    "bands",
    "film",
    "slip",
    "deflection",
    "formulations",
    "pump",
    "input_shaft",
    "reverse_clutch",
    "final_drive",
    "launch",
    "ratio_control",
    "pressure",
    "manual",
    "lubricant",
    "engine",
    "road_load",
    "thermal",
    "maps",
    "ledgers",
    "rigs",
    "vehicle",
    "hydraulics",
    "user",
];

static MECHANISM_CHOICES: [Choice; MECHANISMS.len()] = {
    let mut choices = [Choice::word("", ""); MECHANISMS.len()];
    let mut k = 0;
    while k < MECHANISMS.len() {
        choices[k] = Choice::word(MECHANISMS[k], "");
        k += 1;
    }
    choices
};

static STATEMENTS: [Choice; 6] = [
    Choice::word("N", "number"),
    Choice::word("O", "order or sign"),
    Choice::word("C", "constant that the program was given"),
    Choice::word("L", "quoted from others"),
    Choice::word("X", "record only"),
    Choice::word("F", "fleet: mean, standard deviation and number of cars"),
];

/// Verdicts in the order of [`super::Verdict`].
pub(super) static VERDICTS: [Choice; 5] = [
    Choice::word("agrees", "computed as printed, within the tolerance"),
    Choice::word("fit", "the same, but a parameter was fitted to it"),
    Choice::word(
        "identity",
        "the same, but no value of the vehicle could make it differ",
    ),
    Choice::word("differs", "computed otherwise"),
    Choice::word("not comparable", "the program has no such quantity"),
];

/// `[sources.NAME]`: the keys of all kinds.
pub const SOURCES: Table = SourceKeys::TABLE.repeated(Repeat::Named);

keys! {
    /// Keys of a source, and the axes of each kind.
    SOURCE: SourceKeys = "sources" [
        BenchKeys::TABLE,
        BeltKeys::TABLE,
        RunKeys::TABLE,
        TransientKeys::TABLE,
        StripDownKeys::TABLE,
        FluidKeys::TABLE,
    ] {
        source: required_if("without `like`", words(&KINDS, "")), "what the source computes";
        like: optional(text()), "source that this one continues";
        vehicle: optional(text()), "vehicle; the one being validated if absent";
        lubricant: optional(text()), "transmission oil in place of the vehicle's";
        set: texts(), "overrides KEY=VALUE of the vehicle and its fluids";
        formulation: words(Formulation::CHOICES, "smooth"), "reading of the belt model";
        without: texts(), "parts that are not in the box on the bench";
        cycle: or_word("ece15_eudc", text()), "cycle of a run: name of an embedded cycle or constant_V";
        points: optional(rows(&POINTS)), "times and speeds of a run in place of a cycle";
        start: words(&STARTS, "soak"), "temperatures at the start of a run";
        phase: optional(text()), "group of phases of a run that counts";
    }
}

/// Words of `source`, in the order of [`Kind::ALL`].
pub(super) static KINDS: [Choice; 7] = [
    Choice::word("bench", "a transmission on the bench"),
    Choice::word("belt", "the belt alone"),
    Choice::word("run", "a car through a cycle"),
    Choice::word("fluid", "a fluid over temperature"),
    Choice::word("transient", "warm-up and cooling on the transmission rig"),
    Choice::word("strip_down", "the box taken apart on the transmission rig"),
    Choice::word("vehicle", "the values of a vehicle only"),
];

const POINTS: [Column; 2] = [
    ("time_s", Bound::closed(0.0, 1e5)),
    ("speed_kmh", Bound::closed(0.0, 300.0)),
];

static STARTS: [Choice; 2] = [
    Choice::word("soak", "ambient temperature"),
    Choice::word("warm", "working temperature"),
];

keys! {
    /// Settings of the bench.
    BENCH: BenchKeys = "" [] {
        ratio: needed(grid(0.2, 20.0)), "belt ratio I = R_sec / R_pri, or the number of a gear";
        speed_rpm: needed(grid(1.0, 20_000.0)), "speed of the input shaft";
        temp_degc: needed(grid(-40.0, 160.0)), "oil in the sump, or the fluid";
        torque_nm: or(0.0, grid(-5_000.0, 5_000.0)), "torque at the output shaft, of the belt alone at the secondary pulley";
        throttle: or(0.0, grid(0.0, 1.0)), "throttle that the clamp law sees";
        pressure_bar: optional(grid(0.0, 100.0)), "secondary pressure; the clamp law's if absent";
        pressure_factor: or(1.0, grid(0.1, 3.0)), "factor on the clamp law's pressure";
        belt_degc: optional(grid(-40.0, 160.0)), "belt and spray; if absent in steady state over the sump, of the belt alone 85 degC without lift-off";
        belt_above_sump_k: optional(grid(-100.0, 100.0)), "belt and spray above the sump, in place of belt_degc";
    }
}

keys! {
    /// Settings of the belt alone.
    BELT: BeltKeys = "" [] {
        ratio: needed(grid(0.2, 5.0)), "belt ratio I = R_sec / R_pri";
        speed_rpm: needed(grid(0.0, 20_000.0)), "speed of the primary";
        pressure_bar: needed(grid(0.0, 100.0)), "secondary pressure";
        belt_degc: optional(grid(-40.0, 160.0)), "belt; 85 degC without lift-off if absent";
        band_friction: optional(grid(0.0, 0.5)), "band friction at 85 degC; the fluid's, 0.13 in the printed forms, if absent";
        segment_friction: optional(grid(0.0, 0.5)), "segment friction; the fluid's, 0.125 or 0.13 in the printed forms, if absent";
        on_stop: optional(grid(0.0, 1.0)), "1: the primary leans on its end stop, 0: it deflects; the vehicle's ramp if absent";
        band_speed_share: optional(grid(-0.5, 0.5)), "adopted band speed from the mean, over the range of required speeds; -0.5 in smooth, 0 in the printed forms if absent";
        torque_nm: needed(grid(-5_000.0, 5_000.0)), "torque at the secondary pulley";
    }
}

keys! {
    /// Settings of a run.
    RUN: RunKeys = "" [] {
        ambient_degc: or(25.0, grid(AMBIENT.low(), AMBIENT.high())), "ambient";
        start_degc: optional(grid(-40.0, 150.0)), "all temperatures at the start, in place of `start`";
        dt_s: or(1.0, grid(0.01, 10.0)), "longest step";
    }
}

keys! {
    /// Settings of warm-up and cooling.
    TRANSIENT: TransientKeys = "" [] {
        ratio: needed(grid(0.2, 5.0)), "belt ratio I = R_sec / R_pri";
    }
}

keys! {
    /// Settings of the strip-down.
    STRIP_DOWN: StripDownKeys = "" [] {
        ratio: optional(grid(0.2, 5.0)), "belt ratio; the rig's own two if absent";
        speed_rpm: optional(grid(1.0, 20_000.0)), "input speed; the rig's own if absent";
        temp_degc: optional(grid(-40.0, 160.0)), "oil in the sump; the rig's own if absent";
    }
}

keys! {
    /// Settings of a fluid.
    FLUID: FluidKeys = "" [] {
        temp_degc: needed(grid(-40.0, 160.0)), "temperature of the fluid";
    }
}

/// A key that its kind of source needs.
const fn needed(spec: Spec) -> Spec {
    required_if("by this kind of source", spec)
}
