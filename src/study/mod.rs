//! Many runs: plans, designs, execution on all cores, tables in whole parts, and the statistics that answer the question.
//!
//! A *point* of a design fixes the value of every factor. At a point the subject and all baselines drive, with the same draw: one *run*
//! each, one row of the table each. What a point is follows from the plan, the seed and its index alone, so that points can be computed in
//! any order, on any number of threads, and again after an interruption.

pub mod design;
pub mod plan;
pub mod table;
