//! What a sweep file says, in the program's types, one field a key. What has a default has it from the start; what is
//! ruled by other keys, or must be given, is `None`.

use std::sync::Arc;

use crate::continuation::LocateOptions;
use crate::figure::FigureSettings;
use crate::method::{
    DerivedMeasure, GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions,
};
use crate::system::{ExponentMethod, FieldKind, Interpretation, Model, NoiseKind, Sides};
use crate::topology::DetectOptions;

/// The chosen method, and the settings of all, so that a file can hold them all and one word switches.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSettings {
    /// The chosen method.
    pub kind: MethodKind,
    /// The generator's settings.
    pub generator: GeneratorMethodOptions,
    /// SGCM's settings.
    pub sgcm: SgcmOptions,
    /// Monte Carlo's settings.
    pub monte_carlo: MonteCarloOptions,
}

impl Default for MethodSettings {
    fn default() -> Self {
        let kind = match MethodOptions::default() {
            MethodOptions::Generator(_) => MethodKind::Generator,
            MethodOptions::Sgcm(_) => MethodKind::Sgcm,
            MethodOptions::MonteCarlo(_) => MethodKind::MonteCarlo,
        };
        Self {
            kind,
            generator: GeneratorMethodOptions::default(),
            sgcm: SgcmOptions::default(),
            monte_carlo: MonteCarloOptions::default(),
        }
    }
}

impl MethodSettings {
    /// The chosen method with its settings.
    pub fn chosen(&self) -> MethodOptions {
        match self.kind {
            MethodKind::Generator => MethodOptions::Generator(self.generator.clone()),
            MethodKind::Sgcm => MethodOptions::Sgcm(self.sgcm.clone()),
            MethodKind::MonteCarlo => MethodOptions::MonteCarlo(self.monte_carlo.clone()),
        }
    }
}

/// A method without its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MethodKind {
    /// The generator, solved directly.
    Generator,
    /// Stochastic generalized cell mapping.
    Sgcm,
    /// Free trajectories.
    MonteCarlo,
}

impl MethodKind {
    /// All methods, in the order of `MethodOptions::KINDS`.
    pub const ALL: [Self; 3] = [Self::Generator, Self::Sgcm, Self::MonteCarlo];

    /// Whether it can carry an axis by modes; all can cut it into cells.
    pub(crate) fn takes_modes(self) -> bool {
        self == Self::Generator
    }

    /// Name used in files.
    pub fn name(self) -> &'static str {
        MethodOptions::KINDS[self as usize]
    }
}

/// Total variation that is far below what a figure shows, and reached in seconds with two axes.
pub(super) const ACCURACY: f64 = 1e-3;

/// The word that leaves a choice to the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Auto;

/// Number of modes of an axis that carries a series in place of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Modes {
    /// As many as what is watched needs, found before the sweep.
    Auto,
    /// So many.
    Number(usize),
}

/// What the file says of one axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct AxisDraft {
    pub(super) name: String,
    pub(super) range: Option<Auto>,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) count: Option<usize>,
    pub(super) modes: Option<Modes>,
    pub(super) grade: Option<Auto>,
    pub(super) grade_at: Option<Vec<f64>>,
    pub(super) grade_smallest: Option<f64>,
}

/// What happens at an end of the cells of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EndKind {
    /// A wall: nothing passes.
    Reflecting,
    /// The process ends. Refused with what to do instead.
    Absorbing,
    /// The range ends, and the process goes on.
    Open,
}

words! { EndKind, pub(super) name: Reflecting: "reflecting", Absorbing: "absorbing", Open: "open" }

/// Equations as the file has them, each list in the order given.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct EquationsDraft {
    pub(super) title: Option<String>,
    /// Axes and right sides.
    pub(super) drift: Vec<(String, String)>,
    /// Axes and the amplitudes of their noises.
    pub(super) noise: Vec<(String, Vec<String>)>,
    pub(super) interpretation: Option<Interpretation>,
    /// Names and formulas.
    pub(super) define: Vec<(String, String)>,
    /// Axes, lower and upper bounds.
    pub(super) bounds: Vec<(String, [String; 2])>,
    /// Axes with what happens at the lower and at the upper end of their cells.
    pub(super) ends: Vec<(String, [EndKind; 2])>,
    /// Axes that are angles, with their periods.
    pub(super) angles: Vec<(String, f64)>,
}

impl EquationsDraft {
    /// The period of an angle.
    pub(super) fn angle(&self, name: &str) -> Option<f64> {
        let mut angles = self.angles.iter();
        let found = angles.find(|(known, _)| known == name)?;
        Some(found.1)
    }

    /// Makes an axis an angle.
    pub(super) fn set_angle(&mut self, name: &str, period: f64) {
        self.angles.retain(|(known, _)| known != name);
        self.angles.push((name.to_owned(), period));
    }
}

/// What the file says of the values over which a quantity is watched.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct BinsDraft {
    pub(super) name: String,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) count: Option<usize>,
}

/// What the file says of a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct MapDraft {
    pub(super) parameter: Option<String>,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) points: Option<usize>,
    pub(super) depth: Option<usize>,
    pub(super) curves: Option<bool>,
}

/// What the file says of curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct CurveDraft {
    pub(super) parameter: Option<String>,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) first_from: Option<f64>,
    pub(super) first_to: Option<f64>,
    pub(super) rows: Option<Vec<String>>,
    pub(super) step: Option<f64>,
    pub(super) branches: Option<bool>,
}

/// Of what a Lyapunov exponent is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ExponentKind {
    /// Of a fixed point that neither drift nor noise moves.
    FixedPoint,
    /// Along the stationary density.
    Largest,
}

words! { ExponentKind, pub(super) name: FixedPoint: "fixed-point", Largest: "largest" }

/// What the file says of fluctuations.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct SpectrumDraft {
    /// Names of observables, or of two with a comma between.
    pub(super) of: Option<Vec<String>>,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) points: Option<usize>,
    pub(super) sides: Option<Sides>,
    pub(super) lag: Option<f64>,
}

/// What the file says of the times at which the curve of a passage is wanted.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct SurvivalDraft {
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) count: Option<usize>,
}

/// What the file says of a passage.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct PassageDraft {
    pub(super) name: String,
    pub(super) from: Option<String>,
    pub(super) to: Option<String>,
    pub(super) until: Option<String>,
    /// Several regions, each of which ends the passage; in place of `until`.
    pub(super) exits: Option<Vec<String>>,
    pub(super) switching: Option<bool>,
    pub(super) transitions: Option<bool>,
    pub(super) fields: Option<Vec<FieldKind>>,
    /// Axes and coordinates.
    pub(super) start: Vec<(String, f64)>,
    pub(super) times: Option<Vec<f64>>,
    pub(super) survival: SurvivalDraft,
    pub(super) quantiles: Option<Vec<f64>>,
}

/// What the file says.
#[derive(Debug, Clone, Default)]
pub(super) struct Draft {
    pub(super) title: Option<String>,
    pub(super) model: Option<Arc<Model>>,
    /// What noise is; white where nothing is said.
    pub(super) noise_kind: Option<NoiseKind>,
    /// Equations in place of a built-in model.
    pub(super) equations: EquationsDraft,
    /// Values of parameters by their names, in the order given.
    pub(super) parameters: Vec<(String, f64)>,
    pub(super) parameter: Option<String>,
    pub(super) from: Option<f64>,
    pub(super) to: Option<f64>,
    pub(super) points: Option<usize>,
    /// The second parameter of a map.
    pub(super) map: MapDraft,
    /// The curves that are followed from what is located.
    pub(super) curve: CurveDraft,
    /// Wanted error of the watched densities where counts are left to the program.
    pub(super) accuracy: Option<f64>,
    /// The axes in the order given.
    pub(super) axes: Vec<AxisDraft>,
    pub(super) method: MethodSettings,
    pub(super) marginals: Option<Vec<String>>,
    pub(super) joint: Option<Vec<[String; 2]>>,
    /// Derived measures that are asked for.
    pub(super) measures: Option<Vec<DerivedMeasure>>,
    /// Values of quantities, in the order given.
    pub(super) bins: Vec<BinsDraft>,
    /// Names and formulas of quantities of which moments are wanted.
    pub(super) averaged: Vec<(String, String)>,
    /// Names and inequalities of regions.
    pub(super) regions: Vec<(String, String)>,
    /// Names of visits, and the regions that are visited.
    pub(super) visits: Vec<(String, String)>,
    /// Names of measures, and levels of which the crossings are wanted.
    pub(super) levels: Vec<(String, f64)>,
    /// Questions of first passage, in the order given.
    pub(super) passages: Vec<PassageDraft>,
    /// Of what the largest Lyapunov exponent is wanted.
    pub(super) exponent: Option<ExponentKind>,
    /// How that along the density is worked out.
    pub(super) exponent_method: Option<ExponentMethod>,
    /// Steps of all trajectories that it is worked out by.
    pub(super) exponent_steps: Option<f64>,
    /// Axes and coordinates of the fixed point.
    pub(super) fixed_point: Vec<(String, f64)>,
    /// How many slow modes are wanted.
    pub(super) slow_modes: Option<usize>,
    /// What is asked of fluctuations.
    pub(super) spectrum: SpectrumDraft,
    pub(super) detect: DetectOptions,
    pub(super) locate: LocateOptions,
    pub(super) figures_at: Option<Vec<f64>>,
    pub(super) figures: FigureSettings,
}

impl Draft {
    /// What is said of an axis.
    pub(super) fn axis(&self, name: &str) -> Option<&AxisDraft> {
        self.axes.iter().find(|axis| axis.name == name)
    }

    /// What is said of an axis, made where nothing was.
    pub(super) fn axis_mut(&mut self, name: &str) -> &mut AxisDraft {
        entry(&mut self.axes, name, |one| &mut one.name)
    }

    /// What is said of a passage, made where nothing was.
    pub(super) fn passage_mut(&mut self, name: &str) -> &mut PassageDraft {
        entry(&mut self.passages, name, |one| &mut one.name)
    }

    /// What is said of a passage.
    pub(super) fn passage(&self, name: &str) -> Option<&PassageDraft> {
        self.passages.iter().find(|one| one.name == name)
    }

    /// What is said of a quantity's values, made where nothing was.
    pub(super) fn bins_mut(&mut self, name: &str) -> &mut BinsDraft {
        entry(&mut self.bins, name, |one| &mut one.name)
    }

    /// What is said of a quantity's values.
    pub(super) fn bins(&self, name: &str) -> Option<&BinsDraft> {
        self.bins.iter().find(|bins| bins.name == name)
    }
}

/// The entry of a name, made where there is none; `name_of` is where an entry has its name.
fn entry<'a, T: Default>(
    entries: &'a mut Vec<T>,
    name: &str,
    name_of: fn(&mut T) -> &mut String,
) -> &'a mut T {
    let known = entries.iter_mut().position(|one| name_of(one) == name);
    let index = known.unwrap_or(entries.len());
    if known.is_none() {
        let mut one = T::default();
        name.clone_into(name_of(&mut one));
        entries.push(one);
    }
    &mut entries[index]
}
