//! The C functions of FMI 2.0 and 3.0 for co-simulation, over `cvtcycle-fmu`. One library has both: a master calls those of the version that
//! it reads in modelDescription.xml.
//!
//! | module | contents |
//! |---|---|
//! | `slave` | an instance as C sees it: a pointer; no panic passes it, every refusal has a status and a message for the master's logger |
//! | `fmi2`, `fmi3` | the functions |
//! | `both` | macros: functions of one shape in both versions |

mod both;
#[allow(non_snake_case, reason = "names of the standard")]
mod fmi2;
#[allow(non_snake_case, reason = "names of the standard")]
mod fmi3;
mod slave;
