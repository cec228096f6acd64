//! A page that can be driven again: the simulator in the page, levers of the car, and the answer to each of their states.
//!
//! | file | content |
//! |---|---|
//! | `scene` | what a page is about: cars, conditions, and the user's files that they are made of |
//! | `controls` | the levers of a car, each with the range that something is known of |
//! | `answer` | a state of the levers to sentences, figures and the command that gives the same numbers |
//! | `of_run` | the scene of a run in a directory |
//! | `page` | the section of a page: levers, first answer, scene, simulator |
//! | `words` | the sentences |
//! | `command` | the command for a shell that prints the same numbers |
//!
//! The same functions make the picture of a page without scripts, on this machine, and each later one, in the page (`crates/whatif`).

mod answer;
mod command;
mod controls;
mod of_run;
mod page;
mod scene;
mod words;

pub use crate::live_section::{Answer, Change, Control, Kind, LiveSection, Slider, State};
pub use answer::LivePage;
pub use of_run::of_dir;
pub use scene::{DRAWS, Scene};
