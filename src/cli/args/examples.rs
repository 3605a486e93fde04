//! What stands behind the help of the commands: examples to paste, where results go, exit status.

pub(super) const EXAMPLES: &str = "\
Examples:
  pbif new mine.toml --like vanderpol  a sweep file to start from; `pbif new` lists them
  pbif systems                       list the models
  pbif systems coulomb               show one: equations, parameters, source
  pbif check sweeps/coulomb_fc.toml  what would be run, and what it costs
  pbif sweep sweeps/coulomb_fc.toml  run it; results go to output/coulomb_fc/
  pbif sweep sweeps/coulomb_fc.toml --resume   go on with it after an interrupt, a kill or a full disk
  pbif sweep sweeps/coulomb_fc.toml --shard 1/4   one of four shards, on a machine of its own; `pbif merge output/coulomb_fc` joins them
  pbif sweep sweeps/coulomb_fc.toml --set sweep.points=11 --set cells.x.count=30 --out trial
  pbif sweep sweeps/cusp.toml        a map: regimes over two parameters, where the file has [map]
  pbif compare sweeps/coulomb_fc.toml                          the methods side by side
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02   PB1 in a plane of two parameters
  pbif detect output/coulomb_fc --set detect.confidence=0.99   detect again, without solving
  pbif plot output/coulomb_fc        draw again
  pbif explore output/coulomb_fc     one page that slides through the densities of the run
  pbif explore sweeps/coulomb_fc.toml --open                   the same page, solving live

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady state,
or densities are too negative for their shape; 2 bad usage or input, or a folder that cannot be
written to; 70 a fault of pbif itself; 130 interrupted.

Results are never overwritten: an earlier run in the same folder is kept in its folder previous/1,
previous/2, and so on.";

pub(super) const SYSTEMS_EXAMPLES: &str = "\
Examples:
  pbif systems
  pbif systems dahl
  pbif systems lugre --plot
  pbif systems lugre --plot --set f_s=2 --set v_s=0.2 --format pdf,csv,txt --style single,serif --out figures

A parameter that has no default and is not set takes a value about 1 that shows the shape of the law.";

pub(super) const DETECT_EXAMPLES: &str = "\
Examples:
  pbif detect output/coulomb_fc --set detect.confidence=0.99
  pbif detect output/coulomb_fc --set detect.floor=0.01 --out stricter

Tables, figures and run.json are written anew, the densities stay. Without --out they take the
place of those of the run, whose earlier version is kept below its folder previous/; with --out the
run is left as it is.

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady
state, or densities are too negative for their shape, or the run had been interrupted;
2 bad usage or input, nothing written.";

pub(super) const CURVE_EXAMPLES: &str = "\
Examples:
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02 --first-from -0.05 --first-to 0.05
  pbif curve sweeps/bistable.toml --second sigma2 --from 0.2 --to 1
  pbif curve output/mine                        the curves of the section [curve] of its sweep file
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02 --resume   go on after an interrupt or a kill

From the located row on, the zero of its indicator is followed in both directions until it leaves the box, closes, or its
feature is lost; then the curves that start from its cusps and degenerate splits. curves.csv, codimension_two.csv, curve.json and a figure of the plane go to RUN/curves/ROW-SECOND/ (of a sweep file, which is swept
first, to output/NAME-ROW-SECOND/) or --out; an earlier curve is kept below its folder previous/.
What the columns mean, and how far to trust them: docs/curves.md

Exit status: 0 done; 1 finished, but some point is not located; 2 bad usage or input, nothing written; 130 interrupted.";

pub(super) const COMPARE_EXAMPLES: &str = "\
Examples:
  pbif compare sweeps/coulomb_fc.toml
  pbif compare sweeps/coulomb_fc.toml --set 'figures.at=[-0.02, 0.0]' --set method.error=0.004 --out trial
  pbif compare sweeps/coulomb_fc.toml --resume   go on with it after an interrupt or a kill

Methods are compared at the values of figures.at: the generator with the settings of the file; SGCM as the
paper has it (50 x 50 cells of equal width, method.samples samples a cell, map step 1, densities flat in the
cells); the same samples with slope correction; and Monte Carlo to the relative error method.error. Tables
and figures go to output/NAME-compare/ or --out; earlier comparisons are kept below its folder previous/.

Exit status: 0 done; 1 finished, but generator and Monte Carlo disagree beyond their uncertainties, or a
method did not converge or has no steady state; 2 bad usage or input, nothing written; 130 interrupted.
The keys of a sweep file: pbif sweep --help";

pub(super) const PLOT_EXAMPLES: &str = "\
Examples:
  pbif plot output/coulomb_fc
  pbif plot output/coulomb_fc --only diagram_x,joint --at -0.01,0 --style single --format pdf --out paper
  pbif plot output/coulomb_fc --style slide,dark,cividis --out talk
  pbif plot output/coulomb_fc --set 'figures.at=[0.0, 0.005]' --out more_figures
  pbif plot output/coulomb_plane --with output/coulomb_fc   mark what a sweep located in the plane of a map or of curves

--style takes, in any order, a width (single, one-and-a-half, double, slide, own, or a number of millimetres),
a typeface (sans, serif), colours (viridis, cividis, magma, grey), logarithmic ones (log), a ground (light, dark), and
no-title, no-letters.
The figures themselves, and every key of their style: docs/figures.md";

pub(super) const EXPLORE_EXAMPLES: &str = "\
Examples:
  pbif explore output/coulomb_fc
  pbif explore output/coulomb_fc --html coulomb.html
  pbif explore sweeps/coulomb_fc.toml --open
  pbif explore sweeps/dahl_alpha.toml --set cells.x.count=30 --set cells.y.count=30

Of a run, the page is one file that needs no network and nothing installed but a browser: open it, send it, put it beside a
paper. Of a sweep file, densities are solved while the sliders of the page move; the address that is printed works on this machine
alone, until Ctrl-C.";
