//! Kernels that are compiled once, where their leaf is defined.
//!
//! A generic density is compiled again in every crate that evaluates it, for each instruction set. With these macros it is a function of its own crate.

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
