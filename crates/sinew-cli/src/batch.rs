//! `sinew batch`: many trials by a plan, in shards, and one table over all.

use super::args::General;
use super::batch_args::{BatchCommand, GatherArgs, PlanArgs, RunArgs, UnpackArgs};
use super::ended::Ended;
use super::error::{Error, Written};
use super::report::{self, Report};
use super::table::aligned;
use super::terminal::Terminal;
use crate::study_words;
use serde_json::json;
use sinew::config::common::THREADS;
use sinew::config::{Sources, resolve};
use sinew::run::threads::wanted;
use sinew_batch::gather::gather;
use sinew_batch::plan::{PLAN_NAMES, StudyPlan, plan, write};
use sinew_batch::run::{ShardEnd, run as run_shard};
use sinew_batch::shard::Shard;
use sinew_batch::trial_table::Gathered;
use sinew_batch::{unpack, write_submit_files};
use sinew_results::Occupied;
use std::path::PathBuf;

/// Runs the command.
pub(crate) fn run(what: &BatchCommand, general: &General, report: &Report) -> Result<Ended, Error> {
    match what {
        BatchCommand::Plan(args) => planned(args, general, report),
        BatchCommand::Run(args) => shard(args, general, report),
        BatchCommand::Gather(args) => gathered(args, general),
        BatchCommand::Unpack(args) => unpacked(args, general),
    }
}

/// Problems of trials that a plan names, at most.
const NAMED: usize = 5;

fn planned(args: &PlanArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let study = general.out.as_ref().map(PathBuf::from).ok_or(Error::NoPlace(Written::Study))?;
    if let Some(path) = PLAN_NAMES.map(|name| study.join(name)).into_iter().find(|path| path.exists())
        && !general.force
    {
        return Err(sinew_results::Error::OutputExists { path, found: Occupied::File }.into());
    }
    let tasks = plan(&args.trials, args.share)?;
    let root = std::path::absolute(&args.trials).map_err(sinew::Error::io("read", &args.trials))?;
    let known = StudyPlan {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        root,
        packed: args.pack,
        share: args.share,
        trials: None,
    };
    write(&study, &known, &tasks)?;
    write_submit_files(&study, args.shards)?;
    let problems: Vec<String> =
        tasks.iter().filter_map(|task| Some(format!("{}: {}", task.trial, task.problem.as_ref()?))).collect();
    report.warnings(&problems[..problems.len().min(NAMED)]);
    if problems.len() > NAMED {
        report.warning(&format!("{} more trials cannot be run; `tasks.jsonl` says why", problems.len() - NAMED));
    }
    let mut pools: Vec<&String> = tasks.iter().filter_map(|task| task.pool.as_ref()).collect();
    pools.sort_unstable();
    pools.dedup();
    let shared = tasks.iter().filter(|task| task.pool.is_some()).count();
    if args.answer.json {
        report::answer_json(&json!({
            "study": study, "trials": tasks.len(), "cannot_be_run": problems.len(), "pooled": shared, "pools": pools.len(),
        }))?;
        return Ok(Ended::Done);
    }
    let shown = study.display();
    let rows = [
        ("trials", format!("{}, of which {} cannot be run", tasks.len(), problems.len())),
        ("set-ups", format!("{shared} trials share {} set-ups; the others make their own", pools.len())),
        ("plan", shown.to_string()),
    ];
    let rows: Vec<(String, String)> = rows.map(|(left, right)| (left.to_owned(), right)).into();
    let next = format!(
        "\nNext:\n  sinew batch run {shown}\n  sinew batch gather {shown}\nor `sbatch {shown}/submit.sh`, `sh {shown}/parallel.sh`, `snakemake -d {shown} -s {shown}/Snakefile`\n"
    );
    report::answer(&(aligned(&rows) + &next))?;
    Ok(Ended::Done)
}

/// The part that was requested, by flag or by a scheduler.
fn wanted_shard(args: &RunArgs) -> Result<Shard, Error> {
    if let Some(shard) = args.shard {
        return Ok(shard);
    }
    let known = Shard::from_environment(|name| std::env::var(name).ok(), args.shards).map_err(Error::Shard)?;
    Ok(known.unwrap_or(Shard::WHOLE))
}

fn shard(args: &RunArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let shard = wanted_shard(args)?;
    let threads = general.threads.iter().map(|threads| (THREADS.key, threads.clone())).collect();
    let config = resolve(&Sources { flags: threads, environment: vec![], file: None })?.track();
    let end = run_shard(&args.study, shard, wanted(&config), &Terminal { general, report }, study_words::exit_code)?;
    let ShardEnd { before, done, doubtful, failed, left } = &end;
    if args.answer.json {
        report::answer_json(&json!({
            "shard": shard.to_string(), "before": before, "done": done, "doubtful": doubtful,
            "failed": failed.iter().map(|(trial, why)| json!({ "trial": trial, "why": why })).collect::<Vec<_>>(),
            "left": left,
        }))?;
    } else {
        let rows = [
            ("shard", shard.to_string()),
            ("before", format!("{before} were done")),
            ("now", format!("{} done, of which {doubtful} doubtful; {} failed", done + doubtful, failed.len())),
        ];
        let rows: Vec<(String, String)> = rows.map(|(left, right)| (left.to_owned(), right)).into();
        report::answer(&aligned(&rows))?;
    }
    if *left > 0 {
        report.note(&format!("interrupted; {left} trials are left; the same command continues"));
        return Ok(Ended::Interrupted);
    }
    Ok(match (failed.is_empty(), doubtful) {
        (false, _) => Ended::Failed,
        (true, 0) => Ended::Done,
        (true, _) => Ended::Doubtful,
    })
}

fn gathered(args: &GatherArgs, general: &General) -> Result<Ended, Error> {
    let Gathered { counts: [done, doubtful, failed, missing], lacking } = gather(&args.study, args.by, general.force)?;
    if args.answer.json {
        report::answer_json(&json!({
            "done": done, "doubtful": doubtful, "failed": failed, "missing": missing,
            "lacking": lacking.iter().map(|(trial, why)| json!({ "trial": trial, "why": why })).collect::<Vec<_>>(),
        }))?;
    } else {
        let mut rows = vec![
            ("trials".to_owned(), format!("{done} done, {doubtful} doubtful, {failed} failed, {missing} missing")),
            ("table".to_owned(), args.study.join("summary.csv").display().to_string()),
            ("groups".to_owned(), args.study.join("groups.csv").display().to_string()),
            ("page".to_owned(), args.study.join("report.html").display().to_string()),
        ];
        rows.extend(lacking.iter().take(20).cloned());
        if lacking.len() > 20 {
            rows.push(("…".to_owned(), format!("{} more; the table has all", lacking.len() - 20)));
        }
        report::answer(&aligned(&rows))?;
    }
    Ok(if failed + missing > 0 { Ended::Failed } else { Ended::Done })
}

fn unpacked(args: &UnpackArgs, general: &General) -> Result<Ended, Error> {
    let out = general.out.as_ref().map(PathBuf::from).ok_or(Error::NoPlace(Written::Trial))?;
    unpack(&args.study, &args.trial, &out, general.force)?;
    report::answer(&format!("{}\n", out.display()))?;
    Ok(Ended::Done)
}
