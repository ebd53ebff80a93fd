//! A log density written in Python, as a target of the samplers.
//!
//! One call for eight states, under the interpreter's lock.

use crate::failure::Failure;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::lanes::{Block, LANES};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Values and gradients of a block.
type Evaluated = ([f64; LANES], Vec<f64>);

/// A function of Python from states (n, dim) to log densities (n,) and gradients (n, dim).
pub(crate) struct PythonDensity<'a> {
    function: &'a Py<PyAny>,
    dim: usize,
    stop: &'a AtomicBool,
    /// What the function raised first; from then on it is not called.
    raised: Mutex<Option<PyErr>>,
}

impl<'a> PythonDensity<'a> {
    pub(crate) fn new(function: &'a Py<PyAny>, dim: usize, stop: &'a AtomicBool) -> Self {
        Self { function, dim, stop, raised: Mutex::new(None) }
    }

    /// What the function raised, if it did.
    pub(crate) fn raised(self) -> Option<PyErr> {
        self.raised.into_inner().unwrap_or_default()
    }

    /// Values and gradients of states that stand one after the other; none after a failure or an interrupt.
    fn evaluate(&self, states: Vec<f64>) -> Option<(Vec<f64>, Vec<f64>)> {
        if self.stop.load(Ordering::Relaxed) || self.raised.lock().is_ok_and(|raised| raised.is_some()) {
            return None;
        }
        let called = Python::attach(|py| self.call(py, states));
        if let (Err(error), Ok(mut raised)) = (&called, self.raised.lock()) {
            Python::attach(|py| raised.get_or_insert_with(|| error.clone_ref(py)));
        }
        called.ok()
    }

    fn call(&self, py: Python<'_>, states: Vec<f64>) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let (count, dim) = (states.len() / self.dim, self.dim);
        let states = PyArray2::from_vec2(py, &states.chunks(dim).map(<[f64]>::to_vec).collect::<Vec<_>>());
        let states = states.map_err(|error| Failure::bug(error.to_string()))?;
        let returned = self.function.bind(py).call1((states,))?;
        let refused = |found: String| {
            let due = format!("expected log densities ({count},) and gradients ({count}, {dim}) as float64");
            PyErr::from(Failure::argument(format!("`log_density` returned {found}; {due}")))
        };
        let pair = returned.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>();
        let (values, gradients) = pair.map_err(|_| refused(format!("{}", returned.get_type())))?;
        let as_array = py.import("numpy")?.getattr("asarray")?;
        let (values, gradients) = (as_array.call1((values, "float64"))?, as_array.call1((gradients, "float64"))?);
        let shapes = || -> PyResult<String> {
            Ok(format!("arrays of the shapes {} and {}", values.getattr("shape")?, gradients.getattr("shape")?))
        };
        let read_values = values.extract::<PyReadonlyArray1<'_, f64>>();
        let read_gradients = gradients.extract::<PyReadonlyArray2<'_, f64>>();
        match (read_values, read_gradients) {
            (Ok(values), Ok(gradients)) if values.len() == count && gradients.shape() == [count, dim] => {
                Ok((values.as_array().to_vec(), gradients.as_array().iter().copied().collect()))
            }
            _ => Err(refused(shapes()?)),
        }
    }

    fn block(&self, x: &[Block]) -> Option<Evaluated> {
        let states = (0..LANES).flat_map(|lane| x.iter().map(move |block| block.0[lane])).collect();
        let (values, gradients) = self.evaluate(states)?;
        let values = [0, 1, 2, 3, 4, 5, 6, 7].map(|lane: usize| lawful(values[lane]));
        Some((values, gradients))
    }
}

/// What is no log density is a state that cannot be.
fn lawful(value: f64) -> f64 {
    if value.is_nan() || value == f64::INFINITY { f64::NEG_INFINITY } else { value }
}

impl LogDensity for PythonDensity<'_> {
    fn dim(&self) -> usize {
        self.dim
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.evaluate(x.to_vec()).map_or(f64::NEG_INFINITY, |(values, _)| lawful(values[0]))
    }
    fn log_density_block(&self, x: &[Block], _ws: &mut [Block]) -> Block {
        self.block(x).map_or(Block::splat(f64::NEG_INFINITY), |(values, _)| Block(values))
    }
}

impl GradLogDensity for PythonDensity<'_> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let Some((values, gradients)) = self.evaluate(x.to_vec()) else { return f64::NEG_INFINITY };
        grad.copy_from_slice(&gradients);
        lawful(values[0])
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], _ws: &mut [Block]) -> Block {
        let Some((values, gradients)) = self.block(x) else { return Block::splat(f64::NEG_INFINITY) };
        for (lane, gradient) in gradients.chunks(self.dim).enumerate() {
            grad.iter_mut().zip(gradient).for_each(|(block, &g)| block.0[lane] = g);
        }
        Block(values)
    }
}
