//! The numbers behind the claims as CSV, JSON and Markdown.

use super::chains::{Variant, idle_lanes};
use super::claims::{Crossover, series};
use super::curves::{At, Axis, Ratio, curve, ratio, volumes};
use super::problem::MODELS;
use super::store::Store;
use super::{MULTI, Outcome, Study, factor_key, frame_name, step_of, tuning_key};
use crate::reproduce::claim::{self, Claim};
use serde_json::json;
use sinew::core::random::Stage;
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

/// Writes the numbers behind the claims; `beyond` holds those of the parts beyond the paper by their names.
pub(super) fn write(
    study: &Study,
    store: &Store,
    claims: &[Claim],
    beyond: &serde_json::Map<String, serde_json::Value>,
    folder: &Path,
) -> Outcome<()> {
    let mut cells = String::from(
        "source,frame,dim,contender,setting,units,seconds,log_gm_variance,log_gm_variance_se,median_effective,acceptance\n",
    );
    let mut variables = String::from("source,frame,dim,contender,setting,variable,variance,variance_se\n");
    let mut compared = String::from("source,frame,dim,contender,axis,at,pf_over_hmc,low,high,extrapolated\n");
    let mut bounds = String::from("source,frame,dim,log10_volume_sd,log10_volume_det\n");
    let stage = Stage::new(study.seed, "choo-fleet bootstrap");
    let have_single = claims.iter().any(|claim| claim.id == "CF1");
    for &source in study.size.sources.iter().filter(|_| have_single) {
        for &frame in &study.size.frames {
            for model in &MODELS {
                let (source_name, name, dim) = (source.name(), frame_name(frame), model.dim);
                let [sd, det] = volumes(store, source, frame, model, model.walk(study.isa)?.sd())?;
                let _ = writeln!(bounds, "{source_name},{name},{dim},{sd:.3},{det:.3}");
                let particles = curve(study, store, source, frame, model, None)?;
                for of in [None].into_iter().chain(study.size.variants.iter().map(|v| Some(*v))) {
                    let contender = of.map_or("particle filter", Variant::name).replace(',', "");
                    let found = curve(study, store, source, frame, model, of)?;
                    for (doubling, cell) in study.size.doublings.iter().zip(&found) {
                        let setting = if of.is_some() { 8 } else { model.particles } << doubling;
                        let (log, error) = (cell.log_mean(), cell.log_mean_error(&stage));
                        let _ = writeln!(
                            cells,
                            "{source_name},{name},{dim},{contender},{setting},{:.1},{:.6e},{log:.5},{error:.5},{:.3},{:.4}",
                            cell.units, cell.seconds, cell.effective, cell.acceptance
                        );
                        for (k, [variance, error]) in cell.variances().into_iter().enumerate() {
                            let _ = writeln!(
                                variables,
                                "{source_name},{name},{dim},{contender},{setting},{k},{variance:.5e},{error:.5e}"
                            );
                        }
                    }
                    if of.is_some() {
                        for (axis, axis_name) in [(Axis::Units, "units"), (Axis::Seconds, "seconds")] {
                            for (at, at_name) in [(At::Common, "common"), (At::Extrapolated, "extrapolated")] {
                                let Ratio { value, interval: [low, high], extrapolated } =
                                    ratio(&particles, &found, axis, at, &stage);
                                let _ = writeln!(
                                    compared,
                                    "{source_name},{name},{dim},{contender},{axis_name},{at_name},{value:.4},{low:.4},{high:.4},{extrapolated}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    let mut frames = String::from("source,dim,filter,noise,frame,log_likelihood,log_prior,error_m\n");
    let have_frames = claims.iter().any(|claim| claim.id == "CF8");
    for &source in study.size.sources.iter().filter(|_| have_frames) {
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
    // What was not run this time keeps the tables of the last time.
    for (name, text, judged) in [
        ("cells.csv", &cells, have_single),
        ("variables.csv", &variables, have_single),
        ("ratios.csv", &compared, have_single),
        ("volumes.csv", &bounds, have_single),
        ("frames.csv", &frames, have_frames),
        ("claims.md", &claim::table(claims), !claims.is_empty()),
    ] {
        if judged {
            fs::write(folder.join(name), text)?;
        }
    }
    let claim =
        |c: &Claim| json!({ "id": c.id, "paper": c.paper, "ours": c.ours, "criterion": c.criterion, "pass": c.pass });
    let mut tuned = serde_json::Map::new();
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
    let fit: serde_json::Map<_, _> =
        study.motions.iter().map(|(name, m)| ((*name).to_owned(), json!(1e3 * m.mean_error_m))).collect();
    let results = json!({
        "configuration": store.config,
        "seed": study.seed,
        "isa": study.isa.name(),
        "cells": store.path.file_name().map(|name| name.to_string_lossy().into_owned()),
        "models": factors,
        "tuned": tuned,
        "fit_mm": fit,
        "claims": claims.iter().map(claim).collect::<Vec<_>>(),
        "beyond": beyond,
    });
    fs::write(folder.join("results.json"), serde_json::to_string_pretty(&results)?)?;
    Ok(())
}
