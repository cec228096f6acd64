//! A page that can be driven again: the simulator in the page, levers of the car, and the answer to each of their states.
//!
//! | file | content |
//! |---|---|
//! | `scene` | what a page is about: cars, conditions, and the user's files that they are made of |
//! | `controls` | the levers of a car, each with the range that something is known of |
//! | `answer` | a state of the levers to sentences, figures and the command that gives the same numbers |
//! | `of_run` | the scene of a run in a directory |
//! | `page` | the section of a page: levers, first answer, scene, simulator |
//! | `words` | the sentences, and the command for a shell |
//!
//! The same functions make the picture of a page without scripts, on this machine, and each later one, in the page (`crates/live`).

mod answer;
mod controls;
mod of_run;
mod page;
mod scene;
mod words;

pub use answer::{Answer, DRAWS, LivePage};
pub use controls::{Change, Control, Kind, Slider};
pub use of_run::of_dir;
pub use page::LiveSection;
pub use scene::{Scene, State};
