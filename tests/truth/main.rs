//! Located values and densities against exact answers.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod angles;
mod angular_fluctuations;
mod circulation;
mod coarse_cells;
mod coloured_noise;
mod contacts;
mod exchanged_peaks;
mod forced;
mod forced_fluctuations;
mod friction_laws;
mod gallery;
mod hard_cases;
mod internal_states;
mod line_fields;
mod located;
mod location;
mod long_passages;
mod means_of_formulas;
mod mergers;
mod modal_passages;
mod moving_jump;
mod natural_ends;
mod near_borders;
mod one_axis;
mod passage_fields;
mod passage_starts;
mod passages;
mod position_planes;
mod power_tails;
mod random_systems;
mod range_ends;
mod sampled_passages;
mod sampled_time_steps;
mod sampled_transitions;
mod sgcm_passages;
mod slow_modes;
mod spectra;
mod transitions;
mod tutorials;
mod visits;
mod walls;
