//! Keys of a calibration plan. Reading, messages, `cvtcycle schema` and the page on calibrations come from these rows.

use cvtcycle_model::keys::{Bound, Choice, Kind, Presence, Repeat, Table, keys};
use cvtcycle_validate::keys::SOURCES;

/// A calibration plan.
pub const CALIBRATION: Table = Table::from_tables(&[
    HeadKeys::TABLE,
    SOURCES,
    ParameterKeys::TABLE.repeated(Repeat::List),
    DataKeys::TABLE.repeated(Repeat::List),
]);

keys! {
    /// Keys of `[calibration]`.
    HEAD: HeadKeys = "calibration" [] {
        title: computed("the name of the file", text()), "name for people";
        vehicle: or_word("rover_216_cvt", text()), "vehicle whose values are fitted";
        lubricant: optional(text()), "transmission oil in place of the vehicle's";
        engine_oil: optional(text()), "engine oil in place of the vehicle's";
        set: texts(), "overrides KEY=VALUE, held during the fit";
        starts: integer(1, 1000, 4), "number of starts; the first one is at the values of the files";
        seed: integer(0, i64::MAX, 1), "seed of the other starts";
        most_evaluations: integer(1, 1_000_000, 5000), "most evaluations of a start";
        tolerance: or(1e-8, number(1e-14, 1e-2)), "relative change at which a start ends";
        leave_out: flag(true), "whether each fold is predicted by a fit to the others";
    }
}

keys! {
    /// Keys of `[[parameter]]`.
    PARAMETER: ParameterKeys = "parameter" [PriorKeys::TABLE.repeated(Repeat::Optional)] {
        key: text(), "dotted key of the vehicle or of its fluids";
        low: within(Bound::any()), "least value, in the unit of the key";
        high: within(Bound::any()), "largest value";
        start: optional(within(Bound::any())), "first value; that of the file if absent";
        vehicles: texts(), "vehicles that have this number in common; that of [calibration] if absent";
        also: texts(), "other keys that the number sets, in each of the vehicles that has them";
        status: words(&STATUSES, "assumed"), "how the prior is known; needed with one";
        source: optional(text()), "reason or reference for bounds and prior";
    }
}

keys! {
    /// Keys of the `prior` of a parameter.
    PRIOR: PriorKeys = "prior" [] {
        mean: within(Bound::any()), "most likely value without the data";
        sd: within(Bound::any()), "standard deviation of it";
    }
}

/// How a prior may be known.
pub(super) static STATUSES: [Choice; 4] = [
    Choice::word("source", "printed in the source given"),
    Choice::word("derived", "follows from printed values"),
    Choice::word("fitted", "fitted to other data"),
    Choice::word("assumed", "neither"),
];

keys! {
    /// Keys of `[[data]]`.
    DATA: DataKeys = "data" [] {
        rows: texts(), "identifiers of validation rows";
        compute: optional(text()), "expression over the sources; docs/validation_format.md";
        points: optional(text()), "CSV file of points on a bench, relative to the plan";
        trace: optional(text()), "CSV file of a trace over time, relative to the plan";
        scalars: optional(text()), "CSV file of totals of a run, relative to the plan";
        name: computed("the form of the data", text()), "name of the group";
        from: text(), "where the data come from";
        sd: optional(within(Bound::positive())), "standard deviation, in the unit of the data";
        sd_share: optional(within(Bound::positive())), "standard deviation as a share of the measured number";
        sd_by_column: (Kind::Other("a table of numbers above 0"), Presence::Optional), "standard deviations of single columns, in their units";
        common_sd: optional(within(Bound::positive())), "standard deviation of an error that all have in common";
        fold: computed("the name of the group", text()), "name of the fold: groups of one fold are left out together";
        fold_by: optional(text()), "column whose values divide the points into folds";
        independent_every_s: or(30.0, number(0.0, 1e5)), "time after which two values of a trace are independent";
        source: required_if("with `trace` and `scalars`", text()), "source of the plan that was measured";
        vehicle: optional(text()), "vehicle on the bench, in place of that of [calibration]";
        set: texts(), "overrides KEY=VALUE of the car on the bench";
        without: texts(), "parts that are not in the box on the bench";
        lubricant: optional(text()), "transmission oil in place of the vehicle's";
        unit: or_word("-", text()), "unit of measured and computed numbers";
        what: optional(text()), "what is measured";
        value: optional(within(Bound::any())), "measured number";
        low: optional(within(Bound::any())), "smallest measured number";
        high: optional(within(Bound::any())), "largest measured number";
    }
}
