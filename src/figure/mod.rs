//! Figures of a sweep as a journal prints them: SVG, PDF and PNG of the same drawing.
//!
//! Drawing gives [`Figure`]s as values, all or one by name; writing them to files is another step:
//!
//! ```no_run
//! # fn draw(result: &pbif::continuation::SweepResult) -> Result<(), Box<dyn std::error::Error>> {
//! use pbif::figure::{FigureStyle, FigureWidth, Figures, Format, write_figures};
//!
//! let column = FigureStyle { width: FigureWidth::Single, ..FigureStyle::default() };
//! let figures = Figures::of_sweep(result, "Coulomb friction", &[-0.02, 0.01]).with_style(&column);
//! for diagram in figures.draw("diagram_x")? {
//!     println!("{}", diagram.svg());
//! }
//! write_figures(&figures.draw_all(), &Format::ALL, "figures".as_ref())?;
//! # Ok(())
//! # }
//! ```
//!
//! A kind of figure is one file of `kinds`: what it draws, its caption, its table, its names; `kinds/mod.rs` lists
//! them.
//! `parts` is what several share, and `canvas` what draws. `settings` and `style`, which sweep files hold, need
//! neither.
//!
//! # Decisions
//!
//! **What is drawn is what is judged.** `topology::between` carries the values at faces that indicators read, one-sided
//! at kinks, into cells by parabolas with the cells' averages. Figures ask it for values anywhere, and draw cells where
//! it refuses (noise). So a picture has the masses of the store, and no peak of its own.
//!
//! **A style is laid out, not scaled.** Lengths of a figure are in pixels of its lettering: a style says how many
//! points such a pixel has, and so how many of them the page is wide. Panels, ticks and legends take what is left, text
//! keeps its size.
//!
//! **A drawing is written three times, and laid out once.** What is on a page is a list of elements in whole units
//! (`canvas::drawing`). SVG, PDF and PNG are three small writers of that list, and lettering is laid out from the
//! font's own advances and pairs (`canvas::letters`), as browsers do. Rendering our SVG through a library of SVG
//! brought whole shapers and font writers, several versions of each, for the few elements that it has.

mod settings;
mod style;

#[cfg(feature = "figures")]
mod canvas;
#[cfg(feature = "figures")]
mod error;
#[cfg(feature = "figures")]
mod figures;
#[cfg(feature = "figures")]
mod files;
#[cfg(feature = "figures")]
mod kinds;
#[cfg(feature = "figures")]
mod parts;
#[cfg(feature = "figures")]
mod print;

#[cfg(feature = "figures")]
pub use error::FigureError;
#[cfg(feature = "figures")]
pub use figures::Figures;
#[cfg(feature = "figures")]
pub use files::write_figures;
#[cfg(feature = "figures")]
pub use print::Figure;
pub use settings::{FigureSettings, Format};
pub use style::{ColourMap, ColourScale, FigureStyle, FigureWidth, Ground, Typeface};
