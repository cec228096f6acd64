//! The models: laws, bounds, printed numbers, and every equation once more.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../../common/mod.rs"]
mod common;

mod accelerate;
mod allocation;
mod belt_properties;
mod cold;
mod box_map;
mod chain_car;
mod change_an_equation;
mod conserve;
mod cvt_part_properties;
mod cycles;
mod dead_inputs;
mod electric_pump;
mod engine_library;
mod equations;
mod fluids;
mod forward;
mod held;
mod gtr15;
mod launch_behind;
mod laws;
mod loss_factor;
mod maps;
mod maps_of_others;
mod metamorphic;
mod outside;
mod parts;
mod rig_transmission;
mod rig_variator;
mod selector;
mod shift_flow;
mod parts_side_by_side;
mod side_by_side;
mod smaller_points;
mod standstill;
mod start_stop;
mod starter_generator;
mod steps;
mod tables;
mod targets;
mod together;
mod totals;
mod torque_converter;
mod two_ranges;
