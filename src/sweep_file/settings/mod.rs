//! Everything a sweep file says, checked, with every default filled in.

mod along;
mod axes;
mod axis;
mod axis_checks;
mod curve;
mod draft_of;
mod equations;
mod exponent;
#[cfg(feature = "figures")]
mod figure_names;
mod figures;
mod given_regions;
mod levels;
mod map;
mod method;
mod modes_of;
mod moments;
mod passage_fields;
mod passages;
mod quantities;
mod relaxation;
mod spectrum;
mod system;
#[cfg(test)]
mod tests;
mod visits;
mod walls;
mod watched;

use crate::continuation::LocateOptions;
use crate::density::Observable;
use crate::figure::FigureSettings;
use crate::method::DerivedMeasure;
use crate::system::{Family, in_letters};
use crate::topology::DetectOptions;

pub use super::draft::Modes;
pub(super) use axes::{at_cells, cell_space};
pub use axis::{AxisSettings, Grade};
pub use curve::CurveSettings;
pub(super) use equations::value_place as formula_place;
pub use map::MapSettings;
pub use modes_of::ModesOf;
pub use quantities::BinSettings;
pub(super) use quantities::quantity_name;

use super::document::Document;
use super::draft::{ACCURACY, MethodSettings};
use super::reader::Reader;
use super::report::Report;
use super::respell;
use super::text::SweepText;
use super::write;

/// What is swept and how: every number is checked, every default filled in. What takes work is still open: ranges and
/// gradings that are left to the program, see [`Settings::prepare`].
#[derive(Debug, Clone)]
pub struct Settings {
    /// Title of the run.
    pub title: String,
    /// What is swept: model, fixed values, parameter and its two ends, which differ.
    pub family: Family,
    /// Number of values, at least 2.
    pub points: usize,
    /// The second parameter of a map of regimes; `None` for a sweep.
    pub map: Option<MapSettings>,
    /// The curves that are followed from what a sweep has located; `None` for none.
    pub curve: Option<CurveSettings>,
    /// Wanted error of the watched densities, in total variation, where counts are left to the program.
    pub accuracy: f64,
    /// What was chosen for the program's part, in words.
    pub chosen: Vec<String>,
    /// How each axis is cut into cells, in the model's order of axes.
    pub axes: Vec<AxisSettings>,
    /// The method, and the settings of all methods.
    pub method: MethodSettings,
    /// Settings of detection.
    pub detect: DetectOptions,
    /// What is watched, marginals first.
    pub observables: Vec<Observable>,
    /// Derived measures that are asked for; `None` where the file does not say.
    pub measures: Option<Vec<DerivedMeasure>>,
    /// Bins of the family's quantities, in their order.
    pub bins: Vec<BinSettings>,
    /// Settings of location.
    pub locate: LocateOptions,
    /// The figures that are drawn.
    pub figures: FigureSettings,
    /// What a user should know.
    pub warnings: Report,
    /// Where it was read: findings of later stages point there.
    pub(super) document: Document,
}

impl Settings {
    /// Checks a document.
    ///
    /// # Errors
    /// A report of everything that is wrong with it.
    pub(super) fn read(document: &Document) -> Result<Self, Report> {
        if let Some(broken) = document.broken() {
            return Err(broken);
        }
        let document = &respell::respell(document);
        let (mut reader, draft) = Reader::new(document);
        method::check(&mut reader, &draft.method);
        let known = equations::model(&mut reader, &draft);
        let model = known.as_deref();
        let swept = known
            .as_ref()
            .and_then(|model| system::read(&mut reader, &draft, model));
        let mapped = model.and_then(|model| map::read(&mut reader, &draft, model, draft.points));
        let family = swept.as_ref().map(|swept| &swept.family);
        let followed = family.and_then(|family| curve::read(&mut reader, &draft, family));
        let axes = model.and_then(|model| axes::read(&mut reader, &draft, model, family));
        let watched = model.map(|model| watched::read(&mut reader, &draft, model, axes.as_deref()));
        let figures_at = swept
            .as_ref()
            .map(|swept| figures::read_at(&mut reader, &draft, swept));
        figures::check_style(&mut reader, &draft.figures.style);
        let (Some(swept), Some(axes), Some(watched), Some(figures_at), true) =
            (swept, axes, watched, figures_at, reader.is_clean())
        else {
            return Err(reader.into_report());
        };
        let mut family = swept.family.with_quantities(watched.quantities);
        family.questions.averaged = watched.averaged;
        family = walls::read(&mut reader, &draft, family, &axes);
        (family.questions.regions, family.questions.passages) =
            passages::read(&mut reader, &draft, family.model(), &watched.observables);
        family.questions.visits = visits::read(&mut reader, &draft, family.model());
        exponent::read(&mut reader, &draft, &mut family);
        family.questions.slow_modes = relaxation::read(&mut reader, &draft);
        family.questions.spectrum = spectrum::read(&mut reader, &draft, &family);
        family.questions.levels = levels::read(&mut reader, &draft, &family, &watched.observables);
        let bins = quantities::read_bins(&mut reader, &draft, &family);
        #[cfg(feature = "figures")]
        figure_names::check(&mut reader, &draft, &family, &watched.observables);
        if !reader.is_clean() {
            return Err(reader.into_report());
        }
        let (model, parameter) = (family.model(), in_letters(family.symbol()));
        let second = mapped.as_ref().map(|map| {
            let mut known = model.parameters.iter();
            let known = known.find(|one| one.name == map.parameter);
            in_letters(known.map_or(map.parameter.as_str(), |one| one.symbol.as_str()))
        });
        let title = || match (&second, model.title.as_str()) {
            (Some(second), "") => format!("Map of {parameter} and {second}"),
            (None, "") => format!("Sweep of {parameter}"),
            (Some(second), of) => format!("{of}, map of {parameter} and {second}"),
            (None, of) => format!("{of}, sweep of {parameter}"),
        };
        Ok(Self {
            title: draft.title.clone().unwrap_or_else(title),
            points: swept.points,
            map: mapped,
            curve: followed,
            family,
            accuracy: draft.accuracy.unwrap_or(ACCURACY),
            chosen: Vec::new(),
            axes,
            method: draft.method,
            detect: draft.detect,
            observables: watched.observables,
            measures: draft.measures,
            bins,
            locate: draft.locate,
            figures: FigureSettings {
                at: figures_at,
                formats: figures::each_once(&draft.figures.formats),
                ..draft.figures
            },
            warnings: reader.into_warnings(),
            document: document.clone(),
        })
    }

    /// The sweep file as it was typed, word for word, with what was set on top of it.
    pub(crate) fn typed(&self) -> SweepText {
        self.document.typed()
    }

    /// The settings as a complete sweep file: every key that concerns the chosen method. Read again it gives the same
    /// settings.
    pub fn to_toml(&self) -> String {
        write::to_toml(&self.draft())
    }
}
