//! What draws: pages and panels in figure pixels, axes, curves, maps, contours, legends, and the way to SVG and pixels.
//! It knows nothing of sweeps and densities.
//!
//! plotters lays the data out on a canvas of its own making (`backend`), with sub-pixel places, real subscripts,
//! and heat maps as one embedded picture. Lettering is DejaVu Sans or Serif, which comes with the program; no font of
//! the machine is used, and equal drawings give equal bytes.

mod backend;
pub(super) mod colour_bar;
pub(super) mod contour;
mod error;
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
mod stock;
pub(super) mod style;
pub(super) mod symbols;
mod ticks;

pub use error::DrawError;
