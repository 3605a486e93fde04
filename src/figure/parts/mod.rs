//! What several kinds of figures share: densities as they are shown, panels along a parameter, marks, words, tables.

pub(super) mod along;
pub(super) mod bifurcations;
pub(super) mod branches;
pub(super) mod caption;
pub(super) mod crossed;
pub(super) mod curve_line;
pub(super) mod field_border;
pub(super) mod field_map;
pub(super) mod inset;
pub(super) mod joint_map;
pub(super) mod joint_sheet;
pub(super) mod level_lines;
pub(super) mod measure_names;
pub(super) mod meeting;
pub(super) mod names;
pub(super) mod pages;
pub(super) mod region_room;
pub(super) mod stability;
pub(super) mod table;
pub(super) mod track;
pub(super) mod view;
