//! Keys of a lever file, one row each: reading, `explain`, the documentation and the schema come from them.

use cvtcycle_model::keys;
use cvtcycle_model::keys::{Choice, Kind, Repeat, Table};
use cvtcycle_study::plan::{STATUSES, lubricants};

/// A lever file: its head and its levers.
pub const LEVER_FILE: Table =
    Table::from_tables(&[LeversKeys::TABLE, LeverKeys::TABLE.repeated(Repeat::List)]);

/// Boxes that a file is for.
const BOXES: &[Choice] = &[
    Choice::word("any", "any"),
    Choice::word("cvt", "a CVT"),
    Choice::word("manual", "a manual gearbox"),
];

keys! {
    /// Keys of `[levers]`.
    LEVERS: LeversKeys = "levers" [] {
        title: computed("name of the file", text()), "name for people";
        transmission: words(BOXES, "any"), "transmission of the cars that it is for";
    }

    /// Keys of `[[lever]]`.
    LEVER: LeverKeys = "lever" [] {
        name: text(), "unique name of a-z, 0-9 and _";
        title: computed("the name", text()), "name for tables";
        set: optional(list_of(&Kind::Text, "a list of texts KEY=VALUE, KEY*=FACTOR or KEY+=DIFFERENCE")), "what is changed";
        lubricant: optional(name(lubricants)), "another transmission oil";
        engine_oil: optional(name(lubricants)), "another engine oil";
        group: optional(text()), "of a group a combination has one lever, the best";
        combine: flag(true), "whether the automatic combination may have it";
        needs: optional(text()), "what the change takes, in words";
        status: words(STATUSES, "assumed"), "how its size is known";
        source: optional(text()), "reason or reference for its size";
    }
}
