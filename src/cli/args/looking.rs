//! Arguments of the commands that look at what is there: detection and drawing again, checks, pages, friction laws.

use std::path::PathBuf;

use clap::Args;

/// A stored run that is detected again.
#[derive(Debug, Args)]
pub(crate) struct DetectArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// Override a key of the run's sweep under detect, locate or figures, such as detect.confidence=0.99 (repeatable;
    /// the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Folder for the results, a complete run with the same densities [default: RUN itself]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A stored run that is checked.
#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// Solve so many points again, picked at random, and compare with the stored densities
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) recompute: usize,
}

/// A stored run that is drawn again.
#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// Folder of a run or a map, as `pbif sweep` left it, or of curves, as `pbif curve` did
    pub(crate) run: PathBuf,
    /// Figures to draw, by name or kind, such as diagram_x,joint; all for every one
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// Values to draw at; the run must have densities there
    #[arg(
        long,
        value_name = "VALUES",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub(crate) at: Vec<String>,
    /// Of a map or of curves: mark what this run of a sweep over one of both parameters located (repeatable)
    #[arg(long = "with", value_name = "RUN")]
    pub(crate) with: Vec<PathBuf>,
    /// Style: a width, and words such as serif, grey, dark, no-title
    #[arg(long, value_name = "WORDS", value_delimiter = ',')]
    pub(crate) style: Vec<String>,
    /// File formats: svg, png, pdf; csv for the numbers behind a figure, txt for its caption
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub(crate) format: Vec<String>,
    /// Override a key of the run's sweep under figures, such as figures.formats=["svg"] (repeatable; the last one
    /// counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Folder for the figures [default: RUN/figures]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// What is explored: a stored run or a sweep file.
#[derive(Debug, Args)]
pub(crate) struct ExploreArguments {
    /// Folder of a run or a map, as `pbif sweep` left it, or of curves, as `pbif curve` did, or a sweep file (TOML)
    #[arg(value_name = "RUN|FILE")]
    pub(crate) target: PathBuf,
    /// Of a run: file of the page; a page that is there is replaced, nothing else [default: RUN/explorer.html]
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Of a run: replace the file of `--html` even if it is no page
    #[arg(long, conflicts_with = "port")]
    pub(crate) force: bool,
    /// Override a key of a sweep file, such as cells.x.count=60; of a run those under detect and locate (repeatable;
    /// the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Of a sweep file: port on the loopback address [default: one that is free]
    #[arg(long, value_name = "N", conflicts_with = "html")]
    pub(crate) port: Option<u16>,
    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// How a friction law is drawn.
#[derive(Debug, Args)]
pub(crate) struct FrictionPlotArguments {
    /// Draw the friction law of the model: force against velocity, and hysteresis loops
    #[arg(long, requires = "name")]
    pub(crate) plot: bool,
    /// Value of a parameter of the law, such as f_s=1.5, or a key under figures (repeatable; the last one counts)
    #[arg(long = "set", value_name = "NAME=VALUE", requires = "plot")]
    pub(crate) overrides: Vec<String>,
    /// Style: a width, and words such as serif, grey, dark, no-title
    #[arg(long, value_name = "WORDS", value_delimiter = ',', requires = "plot")]
    pub(crate) style: Vec<String>,
    /// File formats: svg, png, pdf; csv for the numbers behind the figure, txt for its caption [default: svg,png]
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', requires = "plot")]
    pub(crate) format: Vec<String>,
    /// Folder for the figure [default: output/systems]
    #[arg(long, value_name = "DIR", requires = "plot")]
    pub(crate) out: Option<PathBuf>,
}
