//! Statistics of studies against analytic functions, other programs and hand calculations, and their pictures.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "tables of tests; tests print the numbers they found"
)]

mod describe;
mod drawn;
mod effects;
mod functions;
mod pictures;
mod sobol;
