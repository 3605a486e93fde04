//! The explorer: one page that slides along a parameter and shows the densities, what was found in them and where it
//! changes.
//!
//! [`StoredPage`] puts a finished sweep into one file that needs no network: its densities are packed (`pack.rs`) and
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
//!
//! # Decisions
//!
//! **The page is one file and trusts nothing.** Its script and style stand in it and are named by their hashes in its
//! content security policy, so nothing else can run; texts from a run enter it as text, never as markup. Densities are
//! predicted along the sweep before they are deflated, in arithmetic that Rust and JavaScript round alike
//! (`explore/pack.rs`, `explore/page/unpack.js`), so the page holds every state of a sweep in about two bits a cell.
//!
//! **The live page asks for one thing at a time.** Requests come in lanes with rising tickets: a newer one makes the
//! older ones of its lane stale (`explore/live/lanes.rs`). A session whose solve was cancelled is dropped, all others
//! stay warm, keyed by what does not move. That a value is refused is an answer (HTTP 200), because browsers write
//! failures into their consoles.

mod compose;
mod frame;
mod html;
mod live;
mod pack;
mod plane;
mod scene;
mod server;
mod stored;

pub use server::LiveServer;
pub use stored::StoredPage;

/// Why a page could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ExploreError {
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
