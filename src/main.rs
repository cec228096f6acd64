//! Command line of cvtcycle.
fn main() {}
