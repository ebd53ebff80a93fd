//! Blocks of states, group after group.
//!
//! What kernels compute with has its type, and so have the places that it is read from: code that reads half of a block is other code than what reads the other half. Copied out, both halves run the same.

use std::cell::RefCell;

/// States in a group: the numbers of one register of AVX2, or of two of the baseline.
const GROUP: usize = 4;
/// One coordinate of a group of states.
pub(crate) type Group = [f64; GROUP];
/// Groups in a block.
const GROUPS: usize = 2;

thread_local! {
    /// Input and output of the group at work.
    static COPIES: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// Bytes of a line of the processor's cache, which no register read crosses.
const LINE: usize = 64;

/// Calls `of_copies` with this thread's memory for at least so many groups; their values mean nothing, and are no numbers where assertions are checked: tests see who reads them or leaves them.
fn with_copies(length: usize, of_copies: impl FnOnce(&mut [Group])) {
    COPIES.with(|kept| {
        // Work within work finds none, and makes its own.
        let mut copies = kept.take();
        let needed = GROUP * length + LINE / size_of::<f64>();
        if copies.len() < needed {
            copies.resize(needed, 0.0);
        }
        if cfg!(debug_assertions) {
            copies.fill(f64::NAN);
        }
        let first = copies.as_ptr().align_offset(LINE);
        of_copies(copies[first..].as_chunks_mut().0);
        kept.replace(copies);
    });
}

/// The first groups of `rest`, which keeps the others.
fn split<'a>(rest: &mut &'a mut [Group], length: usize) -> &'a mut [Group] {
    let (first, others) = std::mem::take(rest).split_at_mut(length);
    *rest = others;
    first
}

/// Runs work on a block of states, group after group: those of `input` are copied out, those of `output` back.
pub(crate) fn in_groups<const I: usize, const O: usize, B: AsRef<[f64]> + AsMut<[f64]>>(
    input: [&[B]; I],
    mut output: [&mut [B]; O],
    ws: &mut [Group],
    run: impl Fn([&[Group]; I], [&mut [Group]; O], &mut [Group]),
) {
    let length = input.iter().map(|blocks| blocks.len()).chain(output.iter().map(|blocks| blocks.len())).sum();
    with_copies(length, |copies| {
        for which in 0..GROUPS {
            let mut rest = &mut *copies;
            let read = input.map(|blocks| {
                let groups = split(&mut rest, blocks.len());
                for (group, block) in groups.iter_mut().zip(blocks) {
                    *group = block.as_ref().as_chunks().0[which];
                }
                &*groups
            });
            let mut written = output.each_ref().map(|blocks| split(&mut rest, blocks.len()));
            run(read, written.each_mut().map(|groups| &mut **groups), ws);
            for (blocks, groups) in output.iter_mut().zip(written) {
                for (block, group) in blocks.iter_mut().zip(groups) {
                    block.as_mut().as_chunks_mut().0[which] = *group;
                }
            }
        }
    });
}

/// Runs work on a group in which all states are the same one.
pub(crate) fn one_in_a_group<const I: usize, const O: usize>(
    input: [&[f64]; I],
    mut output: [&mut [f64]; O],
    workspace: usize,
    run: impl Fn([&[Group]; I], [&mut [Group]; O], &mut [Group]),
) {
    let length = input.iter().map(|state| state.len()).chain(output.iter().map(|state| state.len())).sum::<usize>();
    with_copies(length + workspace, |copies| {
        let mut rest = copies;
        let read = input.map(|state| {
            let groups = split(&mut rest, state.len());
            for (group, &x) in groups.iter_mut().zip(state) {
                *group = [x; GROUP];
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
