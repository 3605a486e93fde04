//! What draws: pages and panels in figure pixels, axes, curves, maps, contours, legends, and the way to SVG and pixels.
//! It knows nothing of sweeps and densities.
//!
//! Coordinates are those of plotters on a canvas of our own (`backend`), with sub-pixel places, real subscripts, and
//! heat maps as one embedded picture. Lettering is DejaVu Sans or Serif, which comes with the program; no font of
//! the machine is used, and equal drawings give equal bytes.

mod backend;
pub(super) mod colour_bar;
pub(super) mod contour;
mod facets;
pub(super) mod frame;
pub(super) mod hatch;
pub(super) mod heat;
pub(super) mod legend;
pub(super) mod look;
pub(super) mod page;
pub(super) mod pdf;
pub(super) mod render;
mod scale;
pub(super) mod space;
pub(super) mod style;
pub(super) mod symbols;
mod ticks;
