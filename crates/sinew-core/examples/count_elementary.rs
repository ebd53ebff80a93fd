//! Evaluates an elementary function on blocks of eight a given number of times, for counting instructions:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/count_elementary avx2 exp 1000
//! valgrind --tool=callgrind target/release/examples/count_elementary avx2 exp 2000
//! ```
//!
//! The difference of the two counts, divided by 1000 · 16, is the number of instructions for a block.

use sinew_core::elementary::{exp, ln, sin_cos};
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};
use std::hint::black_box;

/// Blocks on which one call of the kernel works.
const BLOCKS: usize = 16;

struct Apply<'a>(&'a str, &'a mut [Block]);

impl Kernel<Block> for Apply<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        match self.0 {
            "exp" => self.1.iter_mut().for_each(|x| exp(V::load(x)).store(x)),
            "ln" => self.1.iter_mut().for_each(|x| ln(V::load(x)).store(x)),
            _ => self.1.iter_mut().for_each(|x| sin_cos(V::load(x)).0.store(x)),
        }
    }
}

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, function, times] = &arguments[..] else {
        return Err("give an instruction set, `exp`, `ln` or `sin`, and a number of times".into());
    };
    let isa = Isa::by_name(set).ok_or(format!("this processor has no `{set}`"))?;
    for _ in 0..times.parse::<usize>().map_err(|error| error.to_string())? {
        let mut x = black_box([Block::splat(0.7); BLOCKS]);
        dispatch(isa, Apply(function, &mut x));
        black_box(&x);
    }
    Ok(())
}
