//! What follows from all expressions of a typed model together: the drift in Itô's sense, the period, and where they
//! are not smooth.

use super::{Noise, Planes, Reader, Reading};
use crate::formula::analysis::KinkPlace;
use crate::formula::graph::{Expression, Symbol};
use crate::formula::tape::{BindError, Program};
use crate::system::typed::{FormulaPlace, Interpretation, TypedModelError, hysteresis, relaxation};

impl Reader<'_> {
    /// What follows from expressions that are all there.
    pub(super) fn join(
        mut self,
        typed_drift: Vec<Expression>,
        (noise, noise_axes, typed_processes): Noise,
        mut bounds: Vec<Option<(Expression, Expression)>>,
    ) -> Result<(Reading, Vec<String>), TypedModelError> {
        let period = self.period(&typed_drift, &noise)?;
        let (turns, forced) = self.turns(&typed_drift, &noise)?;
        let (moving_drift, noise) = match forced {
            Some(forced) => (forced.drift, forced.noise),
            None => (typed_drift.clone(), noise),
        };
        bounds.resize(moving_drift.len(), None);
        let drift_expressions = self.ito_drift(&moving_drift, &noise)?;
        let both = drift_expressions.iter().zip(&moving_drift);
        let corrected = both.map(|(ito, typed)| ito != typed).collect();
        // Where an amplitude bends, so does the density; and an amplitude of coloured noise is a part of the drift.
        let mut rough = drift_expressions.clone();
        rough.extend(noise.iter().flatten());
        let (surfaces, notes) = self.surfaces(&rough)?;
        let is_turn = |axis: usize| turns.of_axes.contains_key(&axis);
        let is_driven = |axis: usize| is_turn(axis) || noise_axes.contains(&axis);
        let free = |axis: usize| bounds[axis].is_none() && !is_driven(axis);
        let relaxation = relaxation::rates(self.scope.graph_mut(), &drift_expressions, &free)?;
        let paths = drift_expressions.iter().enumerate();
        let paths = paths.map(|(axis, &drift)| {
            let path = hysteresis::path_of(self.scope.graph(), drift, axis);
            path.filter(|_| !is_driven(axis))
        });
        let paths = paths.collect();
        let friction = self.friction()?;
        let scope = self.scope;
        let own = noise.iter().zip(&noise_axes);
        let amplitudes = own.map(|(process, &axis)| scope.compile(&process[axis..=axis]));
        let amplitudes: Vec<Program> = amplitudes.collect();
        let drift = scope.compile(&drift_expressions);
        for program in amplitudes.iter().chain([&drift]) {
            // Any values will do: more is worked out beforehand only for special ones.
            let values = vec![std::f64::consts::FRAC_1_SQRT_2; program.parameters()];
            if let Err(BindError::TooWide) = program.bind(&values) {
                return Err(TypedModelError::TooWide);
            }
        }
        let reading = Reading {
            scope,
            typed_drift,
            corrected,
            turns,
            drift_expressions,
            noise,
            typed_processes,
            drift,
            amplitudes,
            noise_axes,
            is_smooth: surfaces.is_empty() && notes.is_empty(),
            surfaces,
            bounds,
            period,
            relaxation,
            paths,
            friction,
            extras: self.model.extras.clone(),
        };
        Ok((reading, notes))
    }

    /// The period that is given, where anything depends on time.
    fn period(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Option<Expression>, TypedModelError> {
        let model = self.model;
        let mut period = None;
        if let Some(text) = &model.period {
            period = self.of_parameters(text, &FormulaPlace::Period);
            if let Some(error) = self.errors.pop() {
                return Err(error);
            }
        }
        let graph = self.scope.graph();
        let mut formulas = drift.iter().chain(noise.iter().flatten());
        let moves = formulas.any(|&one| graph.contains(one, Symbol::Time));
        Ok(period.filter(|_| moves))
    }

    /// The drift of the Itô equation.
    fn ito_drift(
        &mut self,
        typed: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Vec<Expression>, TypedModelError> {
        let read = self.model.interpretation;
        let coloured = self.model.noise_kind.is_coloured();
        // What comes through a filter is smooth: its drift is the one that was typed.
        if coloured && read != Some(Interpretation::Ito) {
            return Ok(typed.to_vec());
        }
        if read == Some(Interpretation::Ito) && !coloured {
            return Ok(typed.to_vec());
        }
        let (drift, jumps) = self.scope.graph_mut().ito_drift(typed, noise)?;
        let mut axes = (0..typed.len()).filter(|&axis| drift[axis] != typed[axis]);
        if coloured {
            return match axes.next() {
                Some(axis) => Err(TypedModelError::ColouredIto {
                    axis: self.model.axes[axis].name.clone(),
                }),
                None => Ok(typed.to_vec()),
            };
        }
        if self.model.interpretation.is_none() {
            let differs = axes.next().or_else(|| {
                // An amplitude that is constant but for jumps.
                let jumping = |axis: &usize| {
                    let symbol = Symbol::State(*axis);
                    let mut own = noise.iter().map(|process| process[*axis]);
                    own.any(|amplitude| self.scope.graph().contains(amplitude, symbol))
                };
                (0..typed.len()).find(|axis| !jumps.is_empty() && jumping(axis))
            });
            if let Some(axis) = differs {
                let axis = self.model.axes[axis].name.clone();
                return Err(TypedModelError::Interpretation { axis });
            }
        }
        if let Some(&jump) = jumps.first() {
            let argument = self.scope.typeset(jump);
            return Err(TypedModelError::JumpingNoise { argument });
        }
        Ok(drift)
    }

    /// Planes where drift or noise may not be smooth, and sentences on places that are no planes of one coordinate.
    fn surfaces(&mut self, rough: &[Expression]) -> Result<(Planes, Vec<String>), TypedModelError> {
        let (mut surfaces, mut notes) = (Vec::new(), Vec::new());
        for &expression in rough {
            for kink in self.scope.graph_mut().kinks(expression)? {
                let why = match kink.place {
                    KinkPlace::Surfaces(planes) => {
                        for plane in planes {
                            let plane = (plane.state, plane.at);
                            if !surfaces.contains(&plane) {
                                surfaces.push(plane);
                            }
                        }
                        continue;
                    }
                    KinkPlace::Oblique => "which contains several coordinates",
                    KinkPlace::Unsolved => "which could not be solved for its coordinate",
                    KinkPlace::Everywhere => "at every whole number",
                    KinkPlace::Moving => "which moves in time",
                };
                let argument = self.scope.typeset(kink.argument);
                let note = format!(
                    "Drift or noise is not smooth where {argument} = 0, {why}: no face of the grid lies there."
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        Ok((surfaces, notes))
    }
}
