//! The curves from a located row: the same bifurcation in the plane of the swept and a second parameter.

mod refusals;
mod row;

pub(crate) use refusals::check_curves;
pub use refusals::curve_rows;
pub use row::FirstRow;

use super::{Context, Job, JobError, Outcome};
use crate::cancellation::Cancellation;
use crate::continuation::curve::{
    Curve, CurveError, CurveOptions, CurveOrigin, CurveStart, CurveTree, LevelCurve, Plane,
    follow_all, follow_level, stability_curves,
};
use crate::continuation::{DensitySource, SourceError, SweepResult};
use crate::figure::{Figure, Figures};
use crate::run::{JobFolder, JournalledSource, Layout, RunError, curve_files, format_number};
use crate::sweep_file::{CurveSettings, Diagnostic, Report, Sweep};
use refusals::{check_corners, no_indicator, plane, refusal, refused_plane, which_parameter};

/// The curves from one row of a sweep, as `[curve]` of its file asks for them.
pub struct CurveJob<'a> {
    sweep: &'a Sweep,
    curve: &'a CurveSettings,
    row: FirstRow<'a>,
    plane: Plane,
    /// Value of the second parameter of the sweep.
    held: f64,
    /// Where the curve of a P-bifurcation starts.
    start: Option<CurveStart>,
    source: Option<Box<dyn DensitySource>>,
    /// Solves that are stored.
    kept: usize,
}

impl<'a> CurveJob<'a> {
    /// The curves from a row of what a sweep has found; whatever can be refused before anything is solved is.
    ///
    /// # Errors
    /// A report where the sweep file has no `[curve]`, the row no indicator, or the box is not one to follow it in.
    pub fn new(sweep: &'a Sweep, result: &SweepResult, row: FirstRow<'a>) -> Result<Self, Report> {
        let family = sweep.problem.family();
        let curve = sweep.settings.curve.as_ref();
        let (curve, plane) = curve
            .zip(plane(sweep)?)
            .ok_or_else(|| which_parameter(sweep))?;
        let held = family.fixed().find(|(name, _)| *name == curve.parameter);
        let held = held.map_or(f64::NAN, |(_, value)| value);
        let start = match row {
            FirstRow::Shape(row) => CurveStart::from_row(row, held, sweep.problem.subject()),
            FirstRow::Stability(_) | FirstRow::Level(_) => None,
        };
        let is_lost = start.is_none() && matches!(row, FirstRow::Shape(_));
        if is_lost || !row.has_curve() {
            return Err(no_indicator(row, result));
        }
        let job = Self {
            sweep,
            curve,
            row,
            plane,
            held,
            start,
            source: None,
            kept: 0,
        };
        job.check_box()?;
        check_corners(sweep, &job.plane)?;
        Ok(job)
    }

    /// The row that the first curve starts from.
    pub(crate) fn row(&self) -> FirstRow<'a> {
        self.row
    }

    /// The box.
    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    /// How curves are followed.
    pub(crate) fn options(&self) -> CurveOptions {
        CurveOptions {
            largest_step: self.curve.step,
            branches: self.curve.branches,
            ..self.sweep.curve_options(self.plane.sides()[0].length())
        }
    }

    /// No curve besides the D-bifurcations of the box, which every plane has; one of them must pass the start.
    fn stability(&self) -> Result<CurveTree, JobError> {
        let at = self.plane.shares([self.row.value(), self.held]);
        let curves = stability_curves(self.sweep.problem.family(), &self.plane);
        if curves.iter().any(|curve| curve.passes(&self.plane, at)) {
            return Ok(CurveTree::default());
        }
        let reason =
            "no line on which the exponent of the fixed point is zero passes it".to_owned();
        Err(refusal(CurveError::NoStart { reason }).into())
    }

    /// The curves of a shape, or that of a level.
    fn follow(
        &self,
        source: &dyn DensitySource,
        cancellation: &Cancellation,
        observer: &mut dyn FnMut([f64; 2]),
    ) -> Result<CurveTree, CurveError> {
        let (plane, options) = (&self.plane, self.options());
        if let FirstRow::Level(row) = self.row {
            let start = ([row.value, self.held], &row.asked);
            let how = (&options, self.sweep.confidence());
            let level = follow_level(source, plane, start, how, cancellation, observer)?;
            return Ok(CurveTree {
                levels: vec![level],
                ..CurveTree::default()
            });
        }
        let Some(start) = &self.start else {
            return Ok(CurveTree::default());
        };
        let detector = self.sweep.detector();
        follow_all(
            source,
            plane,
            &detector,
            start,
            &options,
            cancellation,
            observer,
        )
    }

    /// Refuses a box that the start is not in.
    fn check_box(&self) -> Result<(), Report> {
        let (side, value) = (&self.plane.sides()[0], self.row.value());
        if (side.from..=side.to).contains(&value) {
            return Ok(());
        }
        let (parameter, from, to) = (&side.parameter, side.from, side.to);
        let value = format_number(value);
        let title = format!(
            "{} is not in the box: {parameter} is {value} there, and the box goes from {from} to {to}",
            self.row.label(),
        );
        let remedy = format!("give `--first-from` and `--first-to` on either side of {value}");
        Err(Diagnostic::new(title).remedy(remedy).into())
    }
}

impl Job for CurveJob<'_> {
    type Found = CurveTree;
    const LAYOUT: Layout = Layout::CURVES;

    fn sweep(&self) -> &Sweep {
        self.sweep
    }

    fn made_of(&self) -> String {
        let sides = self.plane.sides().iter();
        let sides = sides.map(|side| format!("[{:?}, {:?}]", side.from, side.to));
        let sides: Vec<String> = sides.collect();
        format!(
            "{}\n[followed]\nrow = \"{}\"\nstart = {:?}\nsecond = \"{}\"\nbox = [{}]\nstep = {:?}\nbranches = {}\n",
            self.sweep.to_toml(),
            self.row.label(),
            [self.row.value(), self.held],
            self.curve.parameter,
            sides.join(", "),
            self.curve.step,
            self.curve.branches,
        )
    }

    fn plan(&mut self, context: &Context<'_>) -> Result<bool, JobError> {
        let (sweep, plane, cancellation) = (self.sweep, &self.plane, context.cancellation);
        let source = match self.row {
            FirstRow::Level(row) => {
                let asked = std::slice::from_ref(&row.asked);
                sweep.source_of_levels(plane, asked, cancellation)
            }
            FirstRow::Shape(_) | FirstRow::Stability(_) => sweep.source_in(plane, cancellation),
        };
        self.source = match source {
            Ok(source) => Some(source),
            Err(SourceError::Interrupted) => return Ok(false),
            Err(SourceError::Method(error)) => return Err(refused_plane(error.as_ref()).into()),
        };
        Ok(true)
    }

    fn solve(
        &mut self,
        folder: &JobFolder,
        goes_on: bool,
        context: &Context<'_>,
    ) -> Result<Option<CurveTree>, JobError> {
        let Some(source) = self.source.take() else {
            return Ok(None);
        };
        let journal = folder.journal(&self.made_of(), goes_on)?;
        self.kept = journal.solves();
        if self.kept > 0 {
            context.say(&format!("going on after {} solves", self.kept));
        }
        if matches!(self.row, FirstRow::Stability(_)) {
            return self.stability().map(Some);
        }
        let [first, second] = self.plane.sides().each_ref().map(|side| &side.parameter);
        let mut met = 0;
        let mut observer = |values: [f64; 2]| {
            met += 1;
            context.say(&format!(
                "{met}: {first} = {:.6e}  {second} = {:.6e}",
                values[0], values[1]
            ));
        };
        let source = JournalledSource::new(source, &journal);
        let found = self.follow(&source, context.cancellation, &mut observer);
        self.kept += met.max(1);
        if let Some(error) = journal.failure() {
            return Err(error.into());
        }
        match found {
            Ok(tree) => Ok(Some(tree)),
            Err(CurveError::Source(SourceError::Interrupted)) => Ok(None),
            Err(error) => Err(refusal(error).into()),
        }
    }

    fn kept(&self) -> usize {
        self.kept
    }

    fn outcome(&self, found: &CurveTree) -> Outcome {
        let locate = &self.sweep.settings.locate;
        let shapes = found.curves.iter().flat_map(|curve| &curve.points);
        let levels = found.levels.iter().flat_map(|curve| &curve.points);
        let mut points = shapes.chain(levels);
        let is_complete =
            found.missed.is_empty() && points.all(|point| locate.is_met_by(point.status()));
        let interrupted = found.curves.iter().any(Curve::is_interrupted)
            || found.levels.iter().any(LevelCurve::is_interrupted);
        Outcome::of(interrupted, is_complete)
    }

    fn files(&self, found: &CurveTree, _: f64) -> Result<Vec<(String, String)>, RunError> {
        let (origin, sweep) = (CurveOrigin::from(self.row), self.sweep.to_toml());
        let family = self.sweep.problem.family();
        curve_files(
            family,
            &self.plane,
            found,
            (&origin, &sweep, &self.made_of()),
        )
    }

    fn figures(&self, found: &CurveTree, _: &Context<'_>) -> Vec<Figure> {
        let (family, settings) = (self.sweep.problem.family(), &self.sweep.settings);
        let origin = CurveOrigin::from(self.row);
        Figures::of_curves(
            (&self.plane, found),
            (&origin, &[]),
            family,
            &settings.title,
        )
        .solved_by(settings.method.kind.name(), self.sweep.problem.watched())
        .carried_by(family, self.sweep.problem.space().axes())
        .with_style(&settings.figures.style)
        .draw_all()
    }
}
