//! The validation files that the program carries.

/// The file whose tolerances and sources all files may use.
pub const COMMON: (&str, &str) = ("common", include_str!("../../../../validation/common.toml"));

macro_rules! chapter {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../../../validation/", $name, ".toml")),
        )
    };
}

/// Embedded files with rows: name and TOML text, in the order of the thesis.
#[must_use]
pub fn embedded_rows() -> &'static [(&'static str, &'static str)] {
    &[
        chapter!("chapter_1"),
        chapter!("chapter_2"),
        chapter!("chapter_3"),
        chapter!("chapter_4"),
        chapter!("chapter_5"),
        chapter!("chapter_6"),
        chapter!("chapter_7"),
        chapter!("chapter_8"),
        chapter!("chapter_9"),
        chapter!("appendix_c"),
    ]
}
