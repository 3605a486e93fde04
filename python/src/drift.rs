//! Systems whose drift is a Python function of batches of states: slow, and anything can be tried.

use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pbif::system::{
    AxisDescription, LANES, Lanes, Model, Noise, ParameterDescription, System, TypedModel,
    contract, registry,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyModule};

/// What a function in Python has raised while a library's thread called it.
#[derive(Default)]
pub(crate) struct Failure(Mutex<Option<PyErr>>);

impl Failure {
    fn slot(&self) -> std::sync::MutexGuard<'_, Option<PyErr>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Raises it, once.
    pub(crate) fn raised(&self) -> PyResult<()> {
        self.slot().take().map_or(Ok(()), Err)
    }

    /// Keeps the first.
    fn keep(&self, error: PyErr) {
        self.slot().get_or_insert(error);
    }
}

/// A function of a batch of states, `states[lane, axis]`, and the parameters by name.
struct Function {
    function: Py<PyAny>,
    parameters: Py<PyDict>,
    /// What its answer is of: the drift, or the noise of an axis.
    of: String,
    /// Values that it gives for a state.
    wanted: usize,
    failure: Arc<Failure>,
}

impl Function {
    /// Calls the function; writes NaN where it raises or gives no such numbers, which is kept.
    fn write(&self, states: &[Lanes], answers: &mut [Lanes]) {
        let called = Python::attach(|py| {
            self.call(py, states, answers)
                .inspect_err(|error| self.place(py, error, states))
        });
        if let Err(error) = called {
            self.failure.keep(error);
            answers
                .iter_mut()
                .for_each(|lanes| *lanes = [f64::NAN; LANES]);
        }
    }

    fn call(&self, py: Python<'_>, states: &[Lanes], answers: &mut [Lanes]) -> PyResult<()> {
        let axes = states.len();
        let rows = (0..LANES).flat_map(|lane| states.iter().map(move |lanes| lanes[lane]));
        let rows: Vec<f64> = rows.collect();
        let batch = numpy::PyArray1::from_vec(py, rows).reshape([LANES, axes])?;
        // A function that writes into what it is given must not change what the next call is given.
        let parameters = self.parameters.bind(py).copy()?;
        let answer = self.function.bind(py).call1((batch, parameters))?;
        let answer = as_floats(&answer)?;
        let shape = answer.shape().to_vec();
        let values = answer.as_array();
        let one = self.wanted == 1;
        let fits = shape == [LANES, self.wanted] || one && (shape == [LANES] || shape.is_empty());
        if !fits {
            let what = if one {
                format!("({LANES},)")
            } else {
                format!("({LANES}, {})", self.wanted)
            };
            let words = format!(
                "the {} has the shape {shape:?}, and for {LANES} states of {axes} axes it must be {what}",
                self.of
            );
            return Err(PyValueError::new_err(words));
        }
        let single = shape
            .is_empty()
            .then(|| values.iter().next().copied().unwrap_or(f64::NAN));
        let mut values = values.iter();
        for lane in 0..LANES {
            for lanes in answers.iter_mut() {
                lanes[lane] = single
                    .or_else(|| values.next().copied())
                    .unwrap_or(f64::NAN);
            }
        }
        Ok(())
    }

    /// Notes where it was raised: parameters, and the first state of the batch.
    fn place(&self, py: Python<'_>, error: &PyErr, states: &[Lanes]) {
        let first: Vec<f64> = states.iter().map(|lanes| lanes[0]).collect();
        let words = format!(
            "in the {} of a pbif.System at {} and {LANES} states, the first of which is {first:?}",
            self.of,
            self.parameters.bind(py)
        );
        // Without notes (before Python 3.11) the traceback is the place.
        let _ = error.value(py).call_method1("add_note", (words,));
    }
}

/// Numbers as an array of 64-bit floats.
fn as_floats<'py>(answer: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = PyModule::import(answer.py(), "numpy")?;
    let array = numpy.call_method1("asarray", (answer, "float64"))?;
    // `ascontiguousarray` would make a number an array of one.
    let array = match array.getattr("ndim")?.extract::<usize>()? {
        0 => array,
        _ => numpy.call_method1("ascontiguousarray", (array,))?,
    };
    array.extract::<PyReadonlyArrayDyn<'py, f64>>()
}

/// A system with a drift in Python.
struct PythonSystem {
    drift: Function,
    noises: Vec<Noise>,
    axes: usize,
}

impl System for PythonSystem {
    fn dimension(&self) -> usize {
        self.axes
    }

    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        self.drift.write(states, drift);
    }

    fn noises(&self) -> &[Noise] {
        &self.noises
    }
}

/// A noise: the number of its axis, and its amplitude as a formula or a function.
type Given = (usize, Option<String>, Option<Py<PyAny>>);

/// What a system is made of.
struct Parts {
    axes: Vec<String>,
    parameters: Vec<String>,
    drift: Py<PyAny>,
    functions: Vec<(usize, Py<PyAny>)>,
    /// The noises that are formulas, of a system that has nothing else.
    formulas: Arc<Model>,
    failure: Arc<Failure>,
}

impl Parts {
    fn function(
        &self,
        py: Python<'_>,
        function: &Py<PyAny>,
        of: String,
        values: &[f64],
    ) -> Function {
        let parameters = PyDict::new(py);
        for (name, value) in self.parameters.iter().zip(values) {
            if let Err(error) = parameters.set_item(name, *value) {
                self.failure.keep(error);
            }
        }
        Function {
            function: function.clone_ref(py),
            parameters: parameters.unbind(),
            wanted: if of == "drift" { self.axes.len() } else { 1 },
            of,
            failure: Arc::clone(&self.failure),
        }
    }

    fn bind(&self, values: &[f64]) -> Arc<dyn System> {
        let given: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .map(String::as_str)
            .zip(values.iter().copied())
            .collect();
        let typed = self.formulas.system_with(&given);
        let mut noises: Vec<Noise> = match typed {
            Ok(typed) => typed.noises().to_vec(),
            Err(fault) => {
                self.failure.keep(PyValueError::new_err(fault.to_string()));
                Vec::new()
            }
        };
        Python::attach(|py| {
            for (axis, function) in &self.functions {
                let of = format!("noise of `{}`", self.axes[*axis]);
                let function = self.function(py, function, of, values);
                noises.push(Noise::of_state(*axis, move |_, states, amplitudes| {
                    function.write(states, std::slice::from_mut(amplitudes));
                }));
            }
            Arc::new(PythonSystem {
                drift: self.function(py, &self.drift, "drift".to_owned(), values),
                noises,
                axes: self.axes.len(),
            })
        })
    }
}

/// A model with a drift in Python, which sweep files may name while it is held.
#[pyclass(frozen, module = "pbif._pbif")]
pub(crate) struct Drift {
    model: Arc<Model>,
    pub(crate) failure: Arc<Failure>,
}

#[pymethods]
impl Drift {
    #[new]
    fn new(
        name: String,
        title: String,
        axes: Vec<String>,
        parameters: Vec<(String, Option<f64>)>,
        drift: Py<PyAny>,
        noises: Vec<Given>,
    ) -> PyResult<Self> {
        let names: Vec<String> = parameters.iter().map(|(name, _)| name.clone()).collect();
        let mut typed = TypedModel::new("noise", "Noise", axes.iter().map(String::as_str));
        for axis in &axes {
            typed = typed.with_equation(axis, format!("-{axis}"));
        }
        let mut functions = Vec::new();
        let mut texts: Vec<Vec<String>> = vec![Vec::new(); axes.len()];
        for (axis, formula, function) in noises {
            functions.extend(function.map(|function| (axis, function)));
            texts[axis].extend(formula);
        }
        for (axis, texts) in axes
            .iter()
            .zip(texts)
            .filter(|(_, texts)| !texts.is_empty())
        {
            typed = typed.with_noise(axis, texts);
        }
        let typed = typed
            .with_parameters(names.iter().map(String::as_str))
            .build();
        let formulas = typed.map_err(|fault| PyValueError::new_err(fault.to_string()))?;
        let failure = Arc::new(Failure::default());
        let described = formulas.axes.iter();
        let described: Vec<AxisDescription> = described
            .map(|axis| AxisDescription::new(&axis.name, &axis.symbol, &axis.meaning))
            .collect();
        let shown: Vec<String> = axes
            .iter()
            .map(|axis| format!("d{axis} = … (a function in Python)"))
            .collect();
        let given = parameters.iter().map(|(name, value)| {
            let one = ParameterDescription::new(name, name, "");
            match value {
                Some(value) => one.with_default(*value),
                None => one,
            }
        });
        let given: Vec<ParameterDescription> = given.collect();
        let parts = Parts {
            axes,
            parameters: names,
            drift,
            functions,
            formulas,
            failure: Arc::clone(&failure),
        };
        let model = Model::new(name, title, move |values| parts.bind(values));
        let model = model
            .with_equations(shown)
            .with_axes(described)
            .with_parameters(given);
        let model = Arc::new(model);
        registry::lend(&model);
        Ok(Self { model, failure })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }
}

/// Tries whether a system is one: finite values, the same for a state in a batch and by itself, and at any time.
pub(crate) fn verify(sweep: &pbif::sweep_file::Sweep) -> Result<(), String> {
    let family = sweep.problem.family();
    let axes = sweep.problem.space().axes().iter();
    let ranges: Vec<(f64, f64)> = axes.map(|axis| (axis.from(), axis.to())).collect();
    let (from, to) = family.ends();
    for value in [from, 0.5 * (from + to), to] {
        let at = format!("at {} = {value}", family.parameter());
        let system = family.at(value).map_err(|fault| format!("{at}: {fault}"))?;
        contract::verify(system.as_ref(), &ranges).map_err(|fault| format!("{at}: {fault}"))?;
    }
    Ok(())
}
