//! The tables of vehicle and lubricant files, each read into the part of the model that it describes.

pub mod cvt;
pub mod engine;
pub mod film_heating;
pub mod launch;
pub mod lubricant;
pub mod manual;
pub mod road;
pub mod thermal;
