//! As in the model: the equations at the heads of the modules.

include!("../model/build.rs");
