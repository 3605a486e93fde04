//! What draws: pages and panels in figure pixels, axes, curves, maps, contours, legends, and the ways to SVG, PDF and
//! PNG. It knows nothing of sweeps and densities.
//!
//! Coordinates are those of plotters on a canvas of our own (`backend`), with sub-pixel places, real subscripts, and
//! heat maps as one embedded picture. The canvas takes down a `drawing`; `svg`, `pdf` and `raster` write it, and
//! `agreement` holds them against each other. Lettering is DejaVu Sans or Serif, which comes with the program; no font
//! of the machine is used, and equal drawings give equal bytes.

#[cfg(test)]
mod agreement;
mod backend;
pub(super) mod colour_bar;
pub(super) mod contour;
pub(super) mod drawing;
mod facets;
pub(super) mod frame;
pub(super) mod hatch;
pub(super) mod heat;
pub(super) mod legend;
pub(super) mod letters;
pub(super) mod look;
pub(super) mod page;
pub(super) mod pdf;
mod png;
pub(super) mod raster;
mod scale;
pub(super) mod space;
pub(super) mod streamline;
pub(super) mod style;
pub(super) mod svg;
pub(super) mod symbols;
mod ticks;
