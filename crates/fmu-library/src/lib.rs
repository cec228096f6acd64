//! C functions of FMI 2.0 and 3.0 for co-simulation, over `cvtcycle-fmu`. One library has both versions, and a master calls those of
//! the version in modelDescription.xml.
//!
//! | module | contents |
//! |---|---|
//! | `slave` | an instance behind a C pointer; panics end here, and every error has a status and a message for the master's logger |
//! | `fmi2`, `fmi3` | the functions |
//! | `both` | macros for functions with the same signature in both versions |

mod both;
#[allow(non_snake_case, reason = "names of the standard")]
mod fmi2;
#[allow(non_snake_case, reason = "names of the standard")]
mod fmi3;
mod slave;
