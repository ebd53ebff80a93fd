//! NumPy arrays in and out: shapes are checked here, in words, and results are handed over without a copy.

use crate::failure::{Failure, USAGE};
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{Element, IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Values with their derivatives.
pub(crate) type Two<'py> = (Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyArrayDyn<f64>>);

/// A dimension of an argument: its name and, where it is known, its length.
pub(crate) type Dimension = (&'static str, Option<usize>);

/// An argument as numbers in C order: itself if it is that already, else a copy.
pub(crate) struct Numbers<'py> {
    name: &'static str,
    array: PyReadonlyArrayDyn<'py, f64>,
}

/// Whether the numbers of an array lie one after the other where numbers may lie: those within a file's bytes may begin at any byte.
fn is_plain(array: &Bound<'_, PyArrayDyn<f64>>) -> bool {
    array.is_c_contiguous() && array.data().is_aligned()
}

/// An argument as numbers in C order.
pub(crate) fn numbers<'py>(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Numbers<'py>> {
    let borrowed = |array: &Bound<'py, PyArrayDyn<f64>>| {
        array.try_readonly().map_err(|_| Failure::argument(format!("`{name}` is being written to by another call")))
    };
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
        && is_plain(array)
    {
        return Ok(Numbers { name, array: borrowed(array)? });
    }
    let py = value.py();
    let made = py.import("numpy")?.call_method1("require", (value, "float64", ["C_CONTIGUOUS", "ALIGNED"]));
    let made = made.map_err(|error| Failure {
        causes: vec![error.to_string()],
        ..Failure::argument(format!("`{name}` is no array of numbers"))
    })?;
    let array = made.cast::<PyArrayDyn<f64>>().map_err(|_| Failure::argument(format!("`{name}` is no array")))?;
    Ok(Numbers { name, array: borrowed(array)? })
}

impl Numbers<'_> {
    /// All numbers, the last index fastest.
    pub(crate) fn values(&self) -> Result<&[f64], Failure> {
        self.array.as_slice().map_err(|error| Failure::bug(format!("`{}`: {error}", self.name)))
    }

    /// Length of each dimension.
    pub(crate) fn shape(&self) -> &[usize] {
        self.array.shape()
    }

    /// The dimensions before the last ones, which must be these.
    pub(crate) fn leading(&self, last: &[Dimension]) -> Result<&[usize], Failure> {
        let shape = self.shape();
        let split = shape.len().checked_sub(last.len()).map(|at| shape.split_at(at));
        let fits = |found: &[usize]| found.iter().zip(last).all(|(n, (_, due))| due.is_none_or(|due| due == *n));
        match split {
            Some((leading, found)) if fits(found) => Ok(leading),
            _ => Err(self.refused("..., ", last)),
        }
    }

    /// The lengths of exactly these dimensions.
    pub(crate) fn exactly(&self, dimensions: &[Dimension]) -> Result<&[usize], Failure> {
        match self.leading(dimensions) {
            Ok([]) => Ok(self.shape()),
            _ => Err(self.refused("", dimensions)),
        }
    }

    fn refused(&self, before: &str, dimensions: &[Dimension]) -> Failure {
        let word = |(name, due): &Dimension| due.map_or((*name).to_owned(), |due| format!("{name} = {due}"));
        let expected = dimensions.iter().map(word).collect::<Vec<_>>().join(", ");
        let mut found = self.shape().iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        if self.shape().len() == 1 {
            found += ",";
        }
        Failure::argument(format!("`{}` has the shape ({found}); expected ({before}{expected})", self.name))
    }

    /// A failure where a number is not finite.
    pub(crate) fn finite(&self) -> Result<&[f64], Failure> {
        let values = self.values()?;
        match values.iter().position(|x| !x.is_finite()) {
            None => Ok(values),
            Some(at) => {
                let name = self.name;
                Err(Failure::argument(format!("`{name}`: number {at} is {}; all must be finite", values[at])))
            }
        }
    }
}

/// Some numbers as an array that owns them.
pub(crate) fn array<'py, T: Element>(
    py: Python<'py>,
    shape: impl IntoIterator<Item = usize>,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let shape: Vec<usize> = shape.into_iter().collect();
    let array = ArrayD::from_shape_vec(IxDyn(&shape), values).map_err(|error| Failure::bug(error.to_string()))?;
    Ok(array.into_pyarray(py))
}

/// Arrays by name, as the record of that name in `sinew/_records.py`.
pub(crate) fn record<'py>(py: Python<'py>, name: &str, fields: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    py.import("sinew._records")?.getattr(name)?.call((), Some(fields))
}

/// An array for the result of a batch, whose numbers mean nothing yet: NumPy takes large ones in large pages.
pub(crate) fn empty<'py>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let made = py.import("numpy")?.call_method1("empty", (shape.to_vec(),))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>().map_err(|_| Failure::bug("numpy.empty makes no array of float64"))?)
}

/// An array of the caller's for a result of that shape.
pub(crate) fn given_place<'py>(
    name: &'static str,
    out: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let fits = out.cast::<PyArrayDyn<f64>>().ok().filter(|out| out.shape() == shape && is_plain(out));
    let due = format!("`{name}` must be an array of float64 in C order of the shape {shape:?}, aligned");
    Ok(fits.cloned().ok_or_else(|| Failure::argument(due))?)
}

/// Lets `write` fill an array.
pub(crate) fn filled<'py, T>(
    out: &Bound<'py, PyArrayDyn<f64>>,
    write: impl FnOnce(&mut [f64]) -> PyResult<T>,
) -> PyResult<T> {
    let place = out.try_readwrite();
    let mut place = place.map_err(|error| Failure::argument(format!("the array of the result: {error}")))?;
    let numbers = place.as_slice_mut().map_err(|error| Failure::bug(error.to_string()))?;
    write(numbers)
}

/// Shape of a result: what came before, then what is new.
pub(crate) fn shaped(leading: &[usize], last: &[usize]) -> Vec<usize> {
    [leading, last].concat()
}

/// An exact count of numbers.
pub(crate) fn fixed<const N: usize>(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f64; N]> {
    let numbers = numbers(name, value)?;
    numbers.exactly(&[("n", Some(N))])?;
    let values = numbers.finite()?;
    Ok(values.try_into().map_err(|_| Failure::bug("a length"))?)
}

/// The number of a frame; numbers are counted in 32 bits where frames are tracked.
pub(crate) fn frame_number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<u64> {
    let number = value.extract::<u32>().map_err(|_| {
        Failure::argument(format!("`{name}` is {value}; expected a whole number from 0 to {}", u32::MAX))
    })?;
    Ok(number.into())
}

/// Zeros for the result of a batch. They are taken from the system as they are and first touched by whoever writes them.
pub(crate) fn room(counts: &[usize]) -> Result<Vec<f64>, Failure> {
    Ok(vec![0.0; affordable(counts)?])
}

/// How many numbers an array of that shape has, if there is memory for them: what takes it cannot refuse.
pub(crate) fn affordable(counts: &[usize]) -> Result<usize, Failure> {
    let total = counts.iter().try_fold(1_usize, |all, n| all.checked_mul(*n));
    total.filter(|total| Vec::<f64>::new().try_reserve_exact(*total).is_ok()).ok_or_else(|| {
        let what = format!("no memory for an array of the shape {counts:?}; do less at a time");
        Failure { code: USAGE, what, causes: vec![], help: None }
    })
}
