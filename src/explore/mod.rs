//! The explorer: one page that slides along a parameter and shows the densities, what was found in them and where it
//! changes.
//!
//! [`StoredPage`] puts a finished sweep into one file that needs no network: its densities are packed ([`Packed`]) and
//! stand in the page itself. [`LiveServer`] serves the same page to the browsers of this machine and solves while one
//! moves its sliders. The sources of the page are the files in `page/`; they are put together here and run nowhere
//! else.
//!
//! ```
//! use pbif::cancellation::Cancellation;
//! use pbif::explore::StoredPage;
//! use pbif::sweep_file::SweepFile;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut file = SweepFile::parse("bistable.toml", include_str!("../../sweeps/bistable.toml"));
//! file.set("sweep.points", "11").set("cells.x.count", "60");
//! let never = Cancellation::new();
//! let sweep = file.validate()?.prepare(&never)?;
//! let result = sweep.run(&never, &mut ())?;
//! let page = StoredPage::new(&sweep, &result)?;
//! assert!(page.html().starts_with("<!doctype html>"));
//! # Ok(())
//! # }
//! ```

mod compose;
mod frame;
mod html;
mod live;
mod pack;
mod plane;
mod scene;
mod server;
mod stored;

pub use pack::{PackError, Packed, Scale};
pub use server::LiveServer;
pub use stored::StoredPage;

/// Why a page could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ExploreError {
    /// Values cannot be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// What the page is told cannot be written.
    #[error("cannot compose the page: {0}")]
    Compose(#[from] serde_json::Error),
    /// A sweep file without `[map]` in the place of a map's.
    #[error("the sweep file of the map has no section [map]")]
    NoPlane,
    /// The densities of a plane cannot be solved, or it was asked to stop.
    #[error(transparent)]
    Source(#[from] crate::continuation::SourceError),
    /// A port of the loopback address cannot be had.
    #[error("cannot serve on port {port} of this machine: {source}")]
    Port {
        /// The port; 0 was any.
        port: u16,
        /// What the system says.
        source: std::io::Error,
    },
    /// The system gives no random numbers.
    #[error("cannot make a token for the address: {0}")]
    Random(#[from] getrandom::Error),
}
