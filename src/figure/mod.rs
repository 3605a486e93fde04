//! Figures of a sweep as a journal prints them: SVG, and PNG and PDF made from the same SVG.
//!
//! Drawing gives [`Figure`]s as values, all or one by name; writing them to files is another step:
//!
//! ```no_run
//! # fn draw(result: &pbif::continuation::SweepResult) -> Result<(), Box<dyn std::error::Error>> {
//! use pbif::figure::{FigureStyle, FigureWidth, Figures, Format, write_figures};
//!
//! let column = FigureStyle { width: FigureWidth::Single, ..FigureStyle::default() };
//! let figures = Figures::of_sweep(result, "Coulomb friction", &[-0.02, 0.01]).with_style(&column);
//! if let Some(diagram) = figures.draw("diagram_x")? {
//!     println!("{}", diagram.svg());
//! }
//! write_figures(&figures.draw_all()?, &Format::ALL, "figures".as_ref())?;
//! # Ok(())
//! # }
//! ```
//!
//! `canvas` is what draws. A new kind of figure is one file like `diagram`, which lists what it can draw of a sweep or
//! a comparison, and one line in `drawn`.

mod along;
mod bifurcations;
mod branches;
mod canvas;
mod caption;
mod compared_joint;
mod compared_marginals;
mod compared_told;
mod crossed;
mod data;
mod diagram;
mod drawn;
mod error;
mod files;
mod friction;
mod health;
mod homology;
mod indicator;
mod inset;
mod joint;
mod joint_sheet;
mod map;
mod marginals;
mod names;
mod pairs;
mod peaks;
mod plane;
mod region_room;
mod section;
mod select;
mod shown;
mod sketch;
mod style;
mod surface;
mod time_to_accuracy;
mod told;

pub use canvas::DrawError;
pub use drawn::{Figure, Figures, KINDS, USUAL_KINDS, matches_figure, sweep_figures};
pub use error::FigureError;
pub use files::{Format, write_figures};
pub use friction::friction_figure;
pub use map::map_figures;
pub use plane::curve_figure;
pub use style::{ColourMap, FigureStyle, FigureWidth, Ground, Typeface};
