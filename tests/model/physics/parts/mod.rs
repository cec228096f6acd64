//! Parts of the model, each against hand calculations, printed numbers and its own properties.

mod belt;
mod cycle;
mod elementary;
mod math;
mod pulley_shafts;
mod transmission;
