//! What cells say of several motions together, each with the same weight.

use super::contender::{Contender, Disturbance, Method, Motion, disturbed};
use super::motions::{BLANK_FRAMES, DISTURBED, FOUND_WITHIN};
use crate::papers::seed_results::{Mean, ONE_SIDED, REPLICATES, Results, differences};
use crate::papers::worth::{Errors, lost, recovered};
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use sinew_tests::evaluation::grouped_block_bootstrap;

/// A method on a motion.
const fn on(method: Method, motion: Motion) -> Contender {
    Contender { method, motion }
}

impl Results<'_> {
    /// Mean over motions of a quantity's mean over frames and seeds; the error is over motions, and of a single one over seeds.
    pub(super) fn over(&self, method: Method, motions: &[Motion], path: &str) -> Outcome<Mean> {
        let of = |motion: &Motion| self.mean(&on(method, *motion), path, None);
        let each = motions.iter().map(of).collect::<Outcome<Vec<Mean>>>()?;
        Ok(match each[..] {
            [single] => single,
            _ => Mean::of(&each.iter().map(|mean| mean.value).collect::<Vec<_>>()),
        })
    }

    /// Milliseconds of processor time a frame, mean over motions.
    pub(super) fn ms_over(&self, method: Method, motions: &[Motion]) -> Outcome<f64> {
        let of = |motion: &Motion| Ok(self.ms(&on(method, *motion))?.value);
        Ok(mean(&motions.iter().map(of).collect::<Outcome<Vec<f64>>>()?))
    }

    /// Mean limb ratio, and the numbers of runs that keep and that lose the person, of how many.
    pub(super) fn kept_and_lost(&self, method: Method, motions: &[Motion]) -> Outcome<(f64, [usize; 3])> {
        let (mut ratios, mut counts) = (vec![], [0, 0, motions.len() * self.seeds as usize]);
        for motion in motions {
            let contender = on(method, *motion);
            let (ratio, kept) = self.kept(&contender)?;
            ratios.push(ratio.value);
            counts[0] += kept;
            let runs = self.runs(&contender)?;
            counts[1] += runs.iter().filter(|[found, mean_pose]| lost(found, mean_pose, self.block)).count();
        }
        Ok((mean(&ratios), counts))
    }

    /// Mean difference a − b of absolute errors, paired by motion, seed and frame, and the ends of its one-sided 95 % intervals: motions drawn again, and blocks of a second within their runs.
    pub(super) fn difference_over(&self, a: Method, b: Method, motions: &[Motion]) -> Outcome<[f64; 3]> {
        let mut groups = vec![];
        for motion in motions {
            let [a, b] = [a, b].map(|method| self.series(&on(method, *motion), "/absolute"));
            groups.push(differences(&a?, &b?));
        }
        let value = mean(groups.iter().map(|series| mean(series.concat())).collect::<Vec<_>>());
        let reach = ONE_SIDED * grouped_block_bootstrap(&groups, self.block, REPLICATES, 1);
        Ok([value - reach, value, value + reach])
    }

    /// Mean share of particles off the manifold, of a tracker that counts them.
    pub(super) fn off_manifold(&self, method: Method, motions: &[Motion]) -> Outcome<f64> {
        let of = |motion: &Motion| -> Outcome<Vec<f64>> {
            let share = |seed| Ok(self.cell(&on(method, *motion), seed)?["off_manifold"].as_f64().unwrap_or(f64::NAN));
            (1..=self.seeds).map(share).collect()
        };
        Ok(mean(motions.iter().map(of).collect::<Outcome<Vec<_>>>()?.concat()))
    }

    /// Runs that find the person again after a disturbance, and all.
    pub(super) fn recovered(&self, method: Method, by: Disturbance) -> Outcome<[usize; 2]> {
        // Frame 0 is not judged.
        let ends = match by {
            Disturbance::Blank => DISTURBED + BLANK_FRAMES - 1,
            Disturbance::Displaced => DISTURBED - 1,
        };
        let (mut found, mut all) = (0, 0);
        for motion in disturbed(by) {
            let runs = self.runs(&on(method, motion))?;
            all += runs.len();
            let is_found = |[run, mean_pose]: &&[Errors; 2]| recovered(run, mean_pose, ends..ends + FOUND_WITHIN);
            found += runs.iter().filter(is_found).count();
        }
        Ok([found, all])
    }
}
