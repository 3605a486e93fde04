//! Figures of a sweep as a journal prints them: SVG, and PNG made from the same SVG.
//!
//! Drawing gives [`Figure`]s as values, all or one by name; writing them to files is another step:
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let result: pbif::continuation::SweepResult = unimplemented!();
//! use pbif::figure::{Figures, Format, write_figures};
//!
//! let figures = Figures::of_sweep(&result, "Coulomb friction", &[-0.02, 0.01]);
//! if let Some(diagram) = figures.draw("diagram_x")? {
//!     println!("{}", diagram.svg());
//! }
//! write_figures(&figures.draw_all()?, &Format::ALL, "figures".as_ref())?;
//! # Ok(())
//! # }
//! ```
//!
//! `canvas` is what draws. A new kind of figure is one file like `diagram`, which lists what it can draw of a sweep or a
//! comparison, and one line in `drawn`.

mod bifurcations;
mod branches;
mod canvas;
mod compared_joint;
mod compared_marginals;
mod diagram;
mod drawn;
mod error;
mod files;
mod joint;
mod marginals;
mod names;
mod select;
mod sketch;
mod time_to_accuracy;

pub use canvas::DrawError;
pub use drawn::{Figure, Figures};
pub use error::FigureError;
pub use files::{Format, write_figures};
