//! Blocks of states, group after group: a group has as many states as a register has numbers.
//!
//! What kernels compute with has its type, and so have the places that it is read from: code that reads half of a block is other code than what reads the other half. Copied out, both halves run the same.

use std::cell::RefCell;

thread_local! {
    /// Input and output of the group at work.
    static COPIES: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// Bytes of a line of the processor's cache, which no register read crosses.
const LINE: usize = 64;

/// Calls `of_copies` with this thread's memory for at least so many numbers; their values mean nothing.
fn with_copies(length: usize, of_copies: impl FnOnce(&mut [f64])) {
    COPIES.with(|kept| {
        // Work within work finds none, and makes its own.
        let mut copies = kept.take();
        let needed = length + LINE / size_of::<f64>();
        if copies.len() < needed {
            copies.resize(needed, 0.0);
        }
        let first = copies.as_ptr().align_offset(LINE);
        of_copies(&mut copies[first..]);
        kept.replace(copies);
    });
}

/// The first groups of `rest`, which keeps the others.
fn split<'a, const N: usize>(rest: &mut &'a mut [[f64; N]], length: usize) -> &'a mut [[f64; N]] {
    let (first, others) = std::mem::take(rest).split_at_mut(length);
    *rest = others;
    first
}

/// Runs work on a block of so many states, `N` of them at a time: groups of `input` are copied out, those of `output` back.
pub(crate) fn in_groups<const N: usize, const I: usize, const O: usize, B: AsRef<[f64]> + AsMut<[f64]>>(
    lanes: usize,
    input: [&[B]; I],
    mut output: [&mut [B]; O],
    ws: &mut [[f64; N]],
    run: impl Fn([&[[f64; N]]; I], [&mut [[f64; N]]; O], &mut [[f64; N]]),
) {
    let length = input.iter().map(|blocks| blocks.len()).chain(output.iter().map(|blocks| blocks.len())).sum::<usize>();
    with_copies(N * length, |copies| {
        for first in (0..lanes).step_by(N) {
            let mut rest = copies.as_chunks_mut::<N>().0;
            let read = input.map(|blocks| {
                let groups = split(&mut rest, blocks.len());
                for (group, block) in groups.iter_mut().zip(blocks) {
                    group.copy_from_slice(&block.as_ref()[first..first + N]);
                }
                &*groups
            });
            let mut written = output.each_ref().map(|blocks| split(&mut rest, blocks.len()));
            run(read, written.each_mut().map(|groups| &mut **groups), ws);
            for (blocks, groups) in output.iter_mut().zip(written) {
                for (block, group) in blocks.iter_mut().zip(groups) {
                    block.as_mut()[first..first + N].copy_from_slice(group);
                }
            }
        }
    });
}

/// Runs work on a group in which all states are the same one.
pub(crate) fn one_in_a_group<const N: usize, const I: usize, const O: usize>(
    input: [&[f64]; I],
    mut output: [&mut [f64]; O],
    workspace: usize,
    run: impl Fn([&[[f64; N]]; I], [&mut [[f64; N]]; O], &mut [[f64; N]]),
) {
    let length = input.iter().map(|state| state.len()).chain(output.iter().map(|state| state.len())).sum::<usize>();
    with_copies(N * (length + workspace), |copies| {
        let mut rest = copies.as_chunks_mut::<N>().0;
        let read = input.map(|state| {
            let groups = split(&mut rest, state.len());
            for (group, &x) in groups.iter_mut().zip(state) {
                *group = [x; N];
            }
            &*groups
        });
        let mut written = output.each_ref().map(|state| split(&mut rest, state.len()));
        run(read, written.each_mut().map(|groups| &mut **groups), split(&mut rest, workspace));
        for (state, groups) in output.iter_mut().zip(written) {
            for (x, group) in state.iter_mut().zip(groups) {
                *x = group[0];
            }
        }
    });
}
