//! Interactive page: the simulator in the page, levers of the car, and the answer to each of their states.
//!
//! | file | content |
//! |---|---|
//! | `scene` | subject of a page: cars, conditions, and the user's files behind them |
//! | `controls` | levers of a car, each with its known range |
//! | `answer` | a state of the levers to sentences, figures and the command that gives the same numbers |
//! | `of_run` | scene of a run in a directory |
//! | `page` | section of a page: levers, first answer, scene, simulator |
//! | `words` | sentences |
//! | `command` | shell command that prints the same numbers |
//!
//! The same functions run natively for the page without scripts, and in the page for each later answer (`crates/whatif`).

mod answer;
mod command;
mod controls;
mod of_run;
mod page;
mod scene;
mod words;

pub use crate::live_section::{
    Answer, Control, ControlChange, ControlKind, LiveSection, Slider, State,
};
pub use answer::LivePage;
pub(crate) use of_run::base_of_run;
pub use of_run::section_of_dir;
pub use scene::{DRAWS, Scene};
