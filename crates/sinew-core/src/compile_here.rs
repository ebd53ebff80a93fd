//! Where kernels are compiled: into the code of an instruction set, or once in the crate of their leaf.
//!
//! A generic density is compiled again in every crate that evaluates it, for each instruction set. With `compile_…_here!` it is a function of its own crate.

/// In the `impl LaneDensity` of a leaf: its kernels are compiled in its own crate, and not again in each that evaluates it. For leaves that take long to compile.
#[macro_export]
macro_rules! compile_density_here {
    () => {
        fn eval_block(
            &self,
            isa: $crate::lanes::Isa,
            x: &[$crate::lanes::Block],
            grad: Option<&mut [$crate::lanes::Block]>,
            ws: &mut [$crate::lanes::Block],
        ) -> $crate::lanes::Block {
            $crate::density::run_block(self, isa, x, grad, ws)
        }
        fn eval_one(&self, isa: $crate::lanes::Isa, x: &[f64], grad: Option<&mut [f64]>) -> f64 {
            $crate::density::run_one(self, isa, x, grad)
        }
    };
}

/// [`compile_density_here!`](crate::compile_density_here) for the `impl LaneGaussNewton` of a leaf.
#[macro_export]
macro_rules! compile_curvature_here {
    () => {
        fn curvature_block(
            &self,
            isa: $crate::lanes::Isa,
            which: $crate::density::Curvature,
            x: &[$crate::lanes::Block],
            out: &mut [$crate::lanes::Block],
            ws: &mut [$crate::lanes::Block],
        ) {
            $crate::density::run_curvature(self, isa, which, x, out, ws);
        }
    };
}

/// Puts `#[inline(always)]` on every function in it, methods of an `impl` or free ones: what each function that computes with a [`Real`](crate::lanes::Real) needs.
///
/// [`dispatch`](crate::lanes::dispatch) enters code that is compiled for the instruction set of the processor. A function that is not inlined there is compiled for the baseline, where each operation on
/// lanes is a call: nothing warns, and it takes many times as long. So write all methods of a [`LaneDensity`](crate::density::LaneDensity), and the functions that they call, within this macro.
///
/// ```
/// use sinew_core::density::{LaneDensity, Lanes, LogDensity};
/// use sinew_core::elementary::exp;
/// use sinew_core::inlined;
/// use sinew_core::lanes::{Isa, Real};
///
/// inlined! {
///     fn square<V: Real>(x: V) -> V {
///         x * x
///     }
/// }
///
/// /// log p = eˣ − x − x².
/// struct Bend;
/// impl LaneDensity for Bend {
///     inlined! {
///         fn dim(&self) -> usize {
///             1
///         }
///         fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
///             let x = V::load(&x[0]);
///             let e = exp(x);
///             if GRAD {
///                 (e - V::splat(1.0) - x - x).store(&mut grad[0]);
///             }
///             e - x - square(x)
///         }
///     }
/// }
/// assert_eq!(Lanes { leaf: Bend, isa: Isa::best() }.log_density(&[0.0]), 1.0);
/// ```
#[macro_export]
macro_rules! inlined {
    ($($function:item)*) => {
        $(#[inline(always)] $function)*
    };
}
