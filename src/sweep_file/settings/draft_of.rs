//! Settings back into what a file says of them.

use super::passages::DENSITY;
use super::{AxisSettings, Grade, Settings};
use crate::density::Observable;
use crate::sweep_file::draft::{
    Auto, AxisDraft, BinsDraft, CurveDraft, Draft, EndKind, EquationsDraft, ExponentKind, MapDraft,
    PassageDraft, SurvivalDraft,
};
use crate::system::{FieldKind, Model, NoiseKind, PassageStart, Region};

impl Settings {
    /// What a complete file says.
    pub(in crate::sweep_file) fn draft(&self) -> Draft {
        let model = self.family.model();
        let parameter = self.family.parameter();
        let (from, to) = self.family.ends();
        let is_typed = model.typed().is_some();
        // The swept parameter of a file's own equations keeps the value that it may have beside the sweep.
        let parameters = model.parameters.iter().filter_map(|one| {
            let mut fixed = self.family.fixed();
            let value = fixed
                .find(|(name, _)| *name == one.name)
                .map(|(_, value)| value);
            let value = value.or(one.default.filter(|_| is_typed))?;
            Some((one.name.clone(), value))
        });
        let axes = model.axes.iter().zip(&self.axes);
        Draft {
            title: Some(self.title.clone()),
            model: (!is_typed).then(|| model.clone()),
            noise_kind: (model.noise_kind() != NoiseKind::White).then(|| model.noise_kind()),
            equations: self.equations_draft(),
            parameters: parameters.collect(),
            parameter: Some(parameter.to_owned()),
            from: Some(from),
            to: Some(to),
            points: Some(self.points),
            map: self.map_draft(),
            curve: self.curve_draft(),
            axes: axes
                .map(|(known, axis)| axis_draft(&known.name, axis))
                .collect(),
            accuracy: Some(self.accuracy),
            method: self.method.clone(),
            marginals: Some(self.marginals()),
            joint: Some(self.joint()),
            measures: self.measures.clone(),
            bins: self.bins_draft(),
            averaged: self.averaged(),
            regions: self.regions_draft(),
            visits: self.visits_draft(),
            levels: self.levels_draft(),
            passages: self.passages_draft(),
            exponent: match self.family.questions.fixed_point {
                Some(_) => Some(ExponentKind::FixedPoint),
                None => {
                    let asked = self.family.questions.largest_exponent;
                    asked.map(|_| ExponentKind::Largest)
                }
            },
            exponent_method: self.family.questions.largest_exponent,
            exponent_steps: Some(self.family.questions.exponent_steps).filter(|&steps| steps > 0.0),
            fixed_point: self.fixed_point_draft(),
            slow_modes: Some(self.family.questions.slow_modes).filter(|&wanted| wanted > 0),
            spectrum: super::spectrum::draft(&self.family),
            detect: self.detect.clone(),
            locate: self.locate.clone(),
            figures_at: Some(self.figures.at.clone()),
            figures: self.figures.clone(),
        }
    }

    /// The equations of the model, where it is made of some, with what happens at the ends of cells.
    fn equations_draft(&self) -> EquationsDraft {
        let end = |wall: f64| match wall.is_finite() {
            true => EndKind::Reflecting,
            false => EndKind::Open,
        };
        let walls = self.family.walls().iter();
        let ends = walls.map(|(&axis, &(from, to))| {
            let name = self.family.axis(axis).to_owned();
            (name, [end(from), end(to)])
        });
        EquationsDraft {
            ends: ends.collect(),
            ..equations_draft(self.family.model())
        }
    }

    fn map_draft(&self) -> MapDraft {
        let Some(map) = &self.map else {
            return MapDraft::default();
        };
        MapDraft {
            parameter: Some(map.parameter.clone()),
            from: Some(map.from),
            to: Some(map.to),
            points: Some(map.points),
            depth: Some(map.depth),
            curves: Some(map.curves),
        }
    }

    fn curve_draft(&self) -> CurveDraft {
        let Some(curve) = &self.curve else {
            return CurveDraft::default();
        };
        CurveDraft {
            parameter: Some(curve.parameter.clone()),
            from: Some(curve.from),
            to: Some(curve.to),
            first_from: Some(curve.first.0),
            first_to: Some(curve.first.1),
            rows: curve.rows.clone(),
            step: Some(curve.step),
            branches: Some(curve.branches),
        }
    }

    fn bins_draft(&self) -> Vec<BinsDraft> {
        let all = self.family.quantities().iter().zip(&self.bins);
        let all = all.filter(|(quantity, _)| quantity.phase().is_none());
        let draft = all.map(|(quantity, bins)| BinsDraft {
            name: quantity.name().to_owned(),
            from: bins.range.map(|range| range.0),
            to: bins.range.map(|range| range.1),
            count: Some(bins.count),
        });
        draft.collect()
    }

    fn averaged(&self) -> Vec<(String, String)> {
        let all = self.family.questions.averaged.iter();
        let texts = all.map(|one| (one.name(), one.formula().unwrap_or(one.name())));
        texts
            .map(|(name, text)| (name.to_owned(), text.to_owned()))
            .collect()
    }

    fn levels_draft(&self) -> Vec<(String, f64)> {
        let levels = self.family.questions.levels.iter();
        levels.map(|one| (one.measure.clone(), one.level)).collect()
    }

    fn fixed_point_draft(&self) -> Vec<(String, f64)> {
        let state = self
            .family
            .questions
            .fixed_point
            .as_deref()
            .unwrap_or_default();
        let axes = self.family.model().axes.iter().zip(state);
        axes.map(|(axis, &x)| (axis.name.clone(), x)).collect()
    }

    fn regions_draft(&self) -> Vec<(String, String)> {
        let regions = self.family.questions.regions.iter();
        regions
            .map(|one| (one.name().to_owned(), one.text().to_owned()))
            .collect()
    }

    fn visits_draft(&self) -> Vec<(String, String)> {
        let visits = self.family.questions.visits.iter();
        visits
            .map(|one| (one.name.clone(), self.named(&one.region)))
            .collect()
    }

    /// A region by its name, where it has one, or by its text.
    fn named(&self, region: &Region) -> String {
        let mut known = self.family.questions.regions.iter();
        match known.any(|one| one.name() == region.name()) {
            true => region.name().to_owned(),
            false => region.text().to_owned(),
        }
    }

    fn passages_draft(&self) -> Vec<PassageDraft> {
        let named = |region: &Region| self.named(region);
        let axes = &self.family.model().axes;
        let passages = self.family.questions.passages.iter();
        let draft = passages.map(|one| PassageDraft {
            name: one.name.clone(),
            from: match &one.start {
                PassageStart::State(_) => None,
                PassageStart::Region(region) => Some(named(region)),
                PassageStart::Density => Some(DENSITY.to_owned()),
            },
            to: None,
            until: one.exits.is_empty().then(|| named(&one.until)),
            exits: (!one.exits.is_empty()).then(|| one.exits.iter().map(named).collect()),
            start: match &one.start {
                PassageStart::State(state) => {
                    let pairs = axes.iter().zip(state);
                    pairs.map(|(axis, &x)| (axis.name.clone(), x)).collect()
                }
                _ => Vec::new(),
            },
            switching: one.switching.then_some(true),
            transitions: one.transitions.is_some().then_some(true),
            fields: {
                let has = |kind: &FieldKind| one.fields.iter().any(|field| field.kind == *kind);
                let asked: Vec<FieldKind> = FieldKind::ALL.into_iter().filter(has).collect();
                (!asked.is_empty()).then_some(asked)
            },
            times: (!one.times.is_empty()).then(|| one.times.clone()),
            survival: SurvivalDraft::default(),
            quantiles: (!one.quantiles.is_empty()).then(|| one.quantiles.clone()),
        });
        draft.collect()
    }

    /// How a file says an axis or a quantity: with the formula, where its name alone does not say it.
    fn coordinate(&self, axis: usize, is_known: bool) -> String {
        let model = self.family.model();
        let own = self.family.quantity(axis);
        if let Some(text) = own.and_then(|one| one.phase_text(model)) {
            return text;
        }
        let quantity = self.family.quantity(axis).filter(|_| !is_known);
        match quantity.and_then(|quantity| Some((quantity.name(), quantity.formula()?))) {
            Some((name, formula)) => format!("{name} = {formula}"),
            None => self.family.axis(axis).to_owned(),
        }
    }

    /// Names of the axes whose marginals are watched.
    fn marginals(&self) -> Vec<String> {
        let observables = self.observables.iter();
        let names = observables.filter_map(|observable| match *observable {
            Observable::Marginal(axis) => Some(self.coordinate(axis, false)),
            Observable::Joint(..) => None,
        });
        names.collect()
    }

    /// Names of the pairs of axes whose joint densities are watched.
    fn joint(&self) -> Vec<[String; 2]> {
        // Marginals have said their quantities before.
        let mut known: Vec<usize> = Vec::new();
        let marginals = self.observables.iter();
        known.extend(marginals.filter_map(|observable| match *observable {
            Observable::Marginal(axis) => Some(axis),
            Observable::Joint(..) => None,
        }));
        let observables = self.observables.iter();
        let names = observables.filter_map(|observable| match *observable {
            Observable::Marginal(_) => None,
            Observable::Joint(one, other) => Some([one, other].map(|axis| {
                let text = self.coordinate(axis, known.contains(&axis));
                known.push(axis);
                text
            })),
        });
        names.collect()
    }
}

/// The equations of a model that is made of some.
fn equations_draft(model: &Model) -> EquationsDraft {
    let Some(typed) = model.typed() else {
        return EquationsDraft::default();
    };
    let source = typed.source();
    let mut noise: Vec<(String, Vec<String>)> = Vec::new();
    for (axis, amplitude) in source.processes().iter().flatten() {
        match noise.iter_mut().find(|(known, _)| known == axis) {
            Some((_, amplitudes)) => amplitudes.push(amplitude.clone()),
            None => noise.push((axis.clone(), vec![amplitude.clone()])),
        }
    }
    let bounds = source.bounds().iter().cloned();
    EquationsDraft {
        title: Some(model.title.clone()),
        drift: source.equations().to_vec(),
        noise,
        interpretation: source.interpretation(),
        define: source.definitions().to_vec(),
        bounds: bounds
            .map(|(axis, lower, upper)| (axis, [lower, upper]))
            .collect(),
        ends: Vec::new(),
        angles: source.angles().to_vec(),
    }
}

fn axis_draft(name: &str, axis: &AxisSettings) -> AxisDraft {
    let toward = match &axis.grade {
        Grade::Toward(grading) => Some(grading),
        Grade::Even | Grade::Auto => None,
    };
    AxisDraft {
        name: name.to_owned(),
        range: (axis.ends == [None; 2]).then_some(Auto),
        from: axis.ends[0],
        to: axis.ends[1],
        count: axis.count,
        modes: axis.modes,
        grade: (axis.grade == Grade::Auto).then_some(Auto),
        grade_at: toward.map(|grading| grading.at.clone()),
        grade_smallest: toward.map(|grading| grading.smallest),
    }
}
