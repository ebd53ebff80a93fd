//! A simulated cluster that runs a million trials: which of scheduler, file system and processors limits.
//!
//! 1000 nodes with two workers each. A scheduler starts jobs, and a shared file system does operations on names (create, rename, remove), one after the other, at the rates below; a worker waits for its own. A trial takes its computing, exponentially
//! spread about the mean for a half of it, then its overhead on the node, then its operations on the shared file system. Jobs are trials or shards.

use crate::support::table::{header, row};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

const TRIALS: u64 = 1_000_000;
const WORKERS: u64 = 2000;
/// Jobs that a scheduler starts in a second: an assumption, as is the next.
const STARTS_PER_S: f64 = 200.0;
/// Operations on names that a shared file system does in a second, for all.
const OPERATIONS_PER_S: f64 = 20_000.0;
/// Time, in whole microseconds.
const MICRO: f64 = 1e6;

/// A way to run the trials.
struct Design {
    name: &'static str,
    trials_a_job: u64,
    /// Operations on names of a trial, and of a job.
    operations: [u64; 2],
}

/// Results in folders: some 110 files and 40 folders, most of them created, and half renamed.
const FOLDER: u64 = 200;
/// A ledger and an archive are appended to; scratch is on the node.
const PACKED: u64 = 0;

const DESIGNS: [Design; 4] = [
    Design { name: "a job a trial, folders", trials_a_job: 1, operations: [FOLDER, 6] },
    Design { name: "2000 shards, folders", trials_a_job: TRIALS / WORKERS, operations: [FOLDER, 6] },
    Design { name: "a job a trial, packed", trials_a_job: 1, operations: [PACKED, 6] },
    Design { name: "2000 shards, packed", trials_a_job: TRIALS / WORKERS, operations: [PACKED, 6] },
];

/// What a design comes to.
struct Came {
    hours: f64,
    /// Shares of the time in which scheduler, file system and workers are busy.
    busy: [f64; 3],
}

/// A number between 0 and 1 that looks random and is always the same.
fn spread(trial: u64) -> f64 {
    let mut x = trial.wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 31;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 29)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// What a worker does next, at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    /// Begins the next trial of its job, with the number of trials left, or asks for a job.
    Begin(u64),
    /// Waits for a number of operations of the file system, with the number of trials left.
    Write(u64, u64),
}

fn came(design: &Design, computing_s: f64, overhead_s: f64) -> Came {
    let micros = |seconds: f64| (seconds * MICRO) as u64;
    let start = micros(1.0 / STARTS_PER_S);
    let mut events: BinaryHeap<Reverse<(u64, Next)>> = (0..WORKERS).map(|_| Reverse((0, Next::Begin(0)))).collect();
    let (mut scheduler, mut disk, mut given, mut begun, mut end) = (0_u64, 0_u64, 0_u64, 0_u64, 0_u64);
    let (mut starts, mut operations, mut worked) = (0_u64, 0_u64, 0.0);
    while let Some(Reverse((mut now, next))) = events.pop() {
        end = end.max(now);
        match next {
            Next::Begin(mut left) => {
                let mut own = design.operations[0];
                if left == 0 {
                    left = design.trials_a_job.min(TRIALS - given);
                    if left == 0 {
                        continue;
                    }
                    scheduler = scheduler.max(now) + start;
                    now = scheduler;
                    given += left;
                    starts += 1;
                    own += design.operations[1];
                }
                let seconds = computing_s * (0.5 - 0.5 * (1.0 - spread(begun)).ln()) + overhead_s;
                begun += 1;
                worked += seconds;
                let next = if own > 0 { Next::Write(own, left - 1) } else { Next::Begin(left - 1) };
                events.push(Reverse((now + micros(seconds), next)));
            }
            Next::Write(own, left) => {
                disk = disk.max(now) + micros(own as f64 / OPERATIONS_PER_S);
                operations += own;
                events.push(Reverse((disk, Next::Begin(left))));
            }
        }
    }
    let seconds = end as f64 / MICRO;
    let busy = [
        starts as f64 / STARTS_PER_S / seconds,
        operations as f64 / OPERATIONS_PER_S / seconds,
        worked / WORKERS as f64 / seconds,
    ];
    Came { hours: seconds / 3600.0, busy }
}

/// The table of all designs.
pub(super) fn table(computing_s: f64, overhead_s: f64) -> String {
    let mut text = header(&format!(
        "| {TRIALS} trials of {computing_s} s and {overhead_s} s overhead, {WORKERS} workers | hours | scheduler busy, % | file system busy, % | workers computing, % |"
    ));
    for design in &DESIGNS {
        let Came { hours, busy } = came(design, computing_s, overhead_s);
        let [scheduler, disk, workers] = busy.map(|share| 100.0 * share);
        row!(text, "{} | {hours:.2} | {scheduler:.0} | {disk:.0} | {workers:.0}", design.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_part_sets_the_time() {
        // 500 trials a worker, one second each, nothing else: 500 s and the unevenness of the last.
        let alone = came(&DESIGNS[3], 1.0, 0.0);
        assert!((alone.hours * 3600.0 / 500.0 - 1.0).abs() < 0.25, "{}", alone.hours);
        // 200 operations of 50 microseconds a trial, one after the other.
        let disk = came(&DESIGNS[1], 0.1, 0.0);
        assert!((disk.hours * 3600.0 / 1e4 - 1.0).abs() < 0.05 && disk.busy[1] > 0.95, "{}", disk.hours);
        // A job a trial, 200 starts a second.
        let scheduler = came(&DESIGNS[2], 0.1, 0.0);
        assert!((scheduler.hours * 3600.0 / 5e3 - 1.0).abs() < 0.05 && scheduler.busy[0] > 0.95);
    }
}
