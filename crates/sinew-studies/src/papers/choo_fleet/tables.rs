//! The numbers behind the claims as CSV, JSON and Markdown.

use super::chains::{Variant, idle_lanes};
use super::crossover::Crossover;
use super::curves::{curve, volumes};
use super::problem::{MODELS, Model};
use super::scene::Source;
use super::study::{MULTI, Study, factor_key, frame_name, series, step_of, tuning_key};
use crate::papers::claim::{self, Claim};
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use serde_json::{Map, Value, json};
use sinew::core::random::Stage;
use sinew_tests::evaluation::equal_variance::{At, Axis, Cell, Ratio, ratio};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The crossover as CSV.
pub(super) fn crossover(found: &[Crossover]) -> String {
    let mut out = String::from("dim,contender,pf_over_hmc,low,high\n");
    for Crossover { dim, variant, ratio: [middle, low, high] } in found {
        let _ = writeln!(out, "{dim},{},{middle:.3},{low:.3},{high:.3}", variant.name().replace(',', ""));
    }
    out
}

/// The tables of single frames as CSV: cells, variables, ratios and volumes.
struct SingleFrames {
    cells: String,
    variables: String,
    compared: String,
    bounds: String,
    stage: Stage,
}

impl SingleFrames {
    fn new(seed: u64) -> Self {
        Self {
            cells: String::from(
                "source,frame,dim,contender,setting,units,seconds,log_gm_variance,log_gm_variance_se,median_effective,acceptance\n",
            ),
            variables: String::from("source,frame,dim,contender,setting,variable,variance,variance_se\n"),
            compared: String::from("source,frame,dim,contender,axis,at,pf_over_hmc,low,high,extrapolated\n"),
            bounds: String::from("source,frame,dim,log10_volume_sd,log10_volume_det\n"),
            stage: Stage::new(seed, "choo-fleet bootstrap"),
        }
    }

    /// Adds what is known of a model in a frame.
    fn add(&mut self, study: &Study, store: &Store, source: Source, frame: usize, model: &Model) -> Outcome<()> {
        let start = format!("{},{},{}", source.name(), frame_name(frame), model.dim);
        let [sd, det] = volumes(store, source, frame, model, model.walk(study.isa)?.sd())?;
        let _ = writeln!(self.bounds, "{start},{sd:.3},{det:.3}");
        let particles = curve(study, store, source, frame, model, None)?;
        for of in [None].into_iter().chain(study.size.variants.iter().map(|v| Some(*v))) {
            let start = format!("{start},{}", of.map_or("particle filter", Variant::name).replace(',', ""));
            let found = curve(study, store, source, frame, model, of)?;
            for (doubling, cell) in study.size.doublings.iter().zip(&found) {
                let setting = if of.is_some() { 8 } else { model.particles } << doubling;
                self.add_cell(&format!("{start},{setting}"), cell);
            }
            if of.is_some() {
                self.compare(&start, &particles, &found);
            }
        }
        Ok(())
    }

    fn add_cell(&mut self, start: &str, cell: &Cell) {
        let (log, error) = (cell.log_mean(), cell.log_mean_error(&self.stage));
        let _ = writeln!(
            self.cells,
            "{start},{:.1},{:.6e},{log:.5},{error:.5},{:.3},{:.4}",
            cell.units, cell.seconds, cell.effective, cell.acceptance
        );
        for (k, [variance, error]) in cell.variances().into_iter().enumerate() {
            let _ = writeln!(self.variables, "{start},{k},{variance:.5e},{error:.5e}");
        }
    }

    fn compare(&mut self, start: &str, particles: &[Cell], chains: &[Cell]) {
        for (axis, axis_name) in [(Axis::Units, "units"), (Axis::Seconds, "seconds")] {
            for (at, at_name) in [(At::Common, "common"), (At::Extrapolated, "extrapolated")] {
                let Ratio { value, interval: [low, high], extrapolated } =
                    ratio(particles, chains, axis, at, &self.stage);
                let _ = writeln!(
                    self.compared,
                    "{start},{axis_name},{at_name},{value:.4},{low:.4},{high:.4},{extrapolated}"
                );
            }
        }
    }
}

/// The table of frames in a row as CSV.
fn frames_in_a_row(study: &Study, store: &Store, is_run: bool) -> Outcome<String> {
    let mut frames = String::from("source,dim,filter,noise,frame,log_likelihood,log_prior,error_m\n");
    for &source in study.size.sources.iter().filter(|_| is_run) {
        for index in 0..MULTI.len() {
            let dim = MODELS[MULTI[index].0].dim;
            let all = ["log_likelihood", "log_prior", "error_m"].map(|name| series(study, store, source, index, name));
            let [a, b, c] = all;
            let (a, b, c) = (a?, b?, c?);
            for (filter, name) in ["hmc", "particle filter"].into_iter().enumerate() {
                for noise in 0..study.size.noises {
                    for frame in 0..a[filter][noise].len() {
                        let _ = writeln!(
                            frames,
                            "{},{dim},{name},{noise},{},{:.4},{:.4},{:.6}",
                            source.name(),
                            frame + 1,
                            a[filter][noise][frame],
                            b[filter][noise][frame],
                            c[filter][noise][frame]
                        );
                    }
                }
            }
        }
    }
    Ok(frames)
}

/// What was run and what it came to, apart from the tables.
fn results(study: &Study, store: &Store, beyond: &Map<String, Value>) -> Outcome<Value> {
    let mut tuned = Map::new();
    for model in &MODELS {
        for variant in Variant::ALL {
            let step = step_of(store, model, variant)?;
            let value = json!({ "eta": step.eta, "steps": step.steps, "acceptance": step.acceptance });
            tuned.insert(tuning_key(model, variant), value);
        }
    }
    let factors: Vec<_> = MODELS
        .iter()
        .map(|m| json!({ "dim": m.dim, "gradient_factor": store.get(&factor_key(m)), "idle_lane_factor": idle_lanes(m.chains) }))
        .collect();
    let fit: Map<_, _> =
        study.motions.iter().map(|(name, m)| ((*name).to_owned(), json!(1e3 * m.mean_error_m))).collect();
    Ok(json!({
        "configuration": store.config,
        "seed": study.seed,
        "isa": study.isa.name(),
        "cells": store.path.file_name().map(|name| name.to_string_lossy().into_owned()),
        "models": factors,
        "tuned": tuned,
        "fit_mm": fit,
        "beyond": beyond,
    }))
}

/// Writes the numbers behind the claims; `beyond` holds what goes beyond the paper, part by part.
pub(super) fn write(
    study: &Study,
    store: &Store,
    claims: &[Claim],
    beyond: &Map<String, Value>,
    folder: &Path,
) -> Outcome<()> {
    let mut single = SingleFrames::new(study.seed);
    let have_single = claims.iter().any(|claim| claim.id == "CF1");
    for &source in study.size.sources.iter().filter(|_| have_single) {
        for &frame in &study.size.frames {
            for model in &MODELS {
                single.add(study, store, source, frame, model)?;
            }
        }
    }
    let have_frames = claims.iter().any(|claim| claim.id == "CF8");
    let frames = frames_in_a_row(study, store, have_frames)?;
    // What was not run this time keeps the tables of the last time.
    for (name, text, judged) in [
        ("cells.csv", &single.cells, have_single),
        ("variables.csv", &single.variables, have_single),
        ("ratios.csv", &single.compared, have_single),
        ("volumes.csv", &single.bounds, have_single),
        ("frames.csv", &frames, have_frames),
        ("claims.md", &claim::table(claims), !claims.is_empty()),
    ] {
        if judged {
            fs::write(folder.join(name), text)?;
        }
    }
    let results = results(study, store, beyond)?;
    fs::write(folder.join("results.json"), serde_json::to_string_pretty(&results)?)?;
    Ok(())
}
