//! Questions about a car and its design, answered by runs and studies, and results in sentences.
//!
//! | module | contents |
//! |---|---|
//! | `attribute` | what each loss costs: the car driven again without it |
//! | `optimum` | the least fuel that any controller of ratio and clamp can burn, and the operating line near it |
//! | `draws` | a car and those that it is compared with over the same draws of what is uncertain |
//! | `answer` | every range of a car's answer from one sample of what is uncertain of it |
//! | `levers` | changes of a design, each next to the car as it is, with the same draws |
//! | `accelerate` | full-throttle times: from one speed to another, over a distance, with the limit of grip |
//! | `known` | the intervals that the program carries, drawn again |
//! | `label` | figures of a fuel label, from the car's own tests |
//! | `sensitivity` | every value of a car changed by itself |
//! | `words` | results in sentences, with what is known of how sure they are and which published number they contradict |
//! | `run` | the summary of a run with all that is said of it |
//! | `equations` | the labelled equations of this crate |

pub mod accelerate;
pub mod answer;
pub mod attribute;
pub mod draws;
pub mod known;
pub mod label;
pub mod optimum;
pub mod levers;
pub mod run;
pub mod sensitivity;
pub mod equations;
pub mod words;
