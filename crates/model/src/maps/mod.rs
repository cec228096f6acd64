//! Measured maps that replace models.

mod bsfc;
mod loss;

pub use bsfc::BsfcMap;
pub use loss::{LossMap, MapPoint, Scatter};
