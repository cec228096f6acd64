//! Points of a design: from an index to a value of each factor.

/// Where a factor stands at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Not varied: the value of the car's file.
    Base,
    /// An entry of its list.
    Entry(usize),
    /// A probability, within 0 and 1, at which its distribution (or list, equally likely) is read.
    Share(f64),
}
