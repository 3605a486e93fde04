//! Sweep files: from a text to a sweep that is ready to run, and back.
//!
//! 1. [`SweepFile`]: a text as a document whose keys and values know where they stand; values can be set on top.
//! 2. [`Settings`]: everything it says, checked, with every default filled in. Nothing is run for that.
//! 3. [`Sweep`]: ranges and gradings that were left to the program are found, by free trajectories. It can be run, and
//!    written as a complete sweep file.
//!
//! What is wrong comes as a [`Report`] of all that was found, with file, line, column and remedy. Every key is declared
//! once, see [`keys`].
//!
//! ```
//! use pbif::cancellation::Cancellation;
//! use pbif::sweep_file::SweepFile;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut file = SweepFile::parse("bistable.toml", include_str!("../../sweeps/bistable.toml"));
//! file.set("sweep.points", "11").set("cells.x.count", "100");
//! let never = Cancellation::new();
//! let sweep = file.validate()?.prepare(&never)?;
//! let found = sweep.run(&never, &mut ())?;
//! let change = found.bifurcations().next().unwrap();
//! assert!(change.value.abs() < 1e-3);
//!
//! // Written and read again it is the same sweep.
//! let again = SweepFile::parse("again.toml", &sweep.to_toml());
//! assert_eq!(again.validate()?.fixed()?.to_toml(), sweep.to_toml());
//! # Ok(())
//! # }
//! ```
//!
//! # Decisions
//!
//! **A sweep file is read in stages.** Text, a document whose values know their places, checked settings, a sweep: up
//! to the settings nothing is run, so that a file can be checked while it is typed; ranges and gradings that are left
//! to the program, and whether the cells fit into this machine, are found in the stage after (`Settings::prepare`),
//! whose errors still point at the key. A key is declared once (`sweep_file::keys`), with getter and setter on a plain
//! draft; defaults are what the getter gives of untouched options. `run` stands above `sweep_file`, so that a stored
//! run gives its sweep back.

mod bins;
mod counts;
mod diagnostic;
mod document;
mod draft;
mod file;
mod fit;
mod formula_place;
mod gallery;
mod given;
mod keys;
mod memory;
mod names;
mod no_range;
mod one_side;
mod passage_cells;
mod prepare;
mod reader;
mod report;
mod respell;
mod settings;
mod sweep;
mod syntax;
mod text;
mod typed_noise;
mod value;
mod verify;
mod write;

pub use diagnostic::{Diagnostic, Location, Place, Sources};
pub use draft::{MethodKind, MethodSettings};
pub use file::SweepFile;
pub use gallery::{StartingFile, starting_files};
pub use keys::{Key, help, keys};
pub(crate) use memory::{bytes_in_words, has_room, machine_memory};
pub(crate) use names::list;
pub use report::Report;
pub use settings::{
    AxisSettings, BinSettings, CurveSettings, Grade, MapSettings, Modes, ModesOf, Settings,
};
pub use sweep::{SolveError, Sweep, WrapSource};
pub(crate) use text::SweepText;
