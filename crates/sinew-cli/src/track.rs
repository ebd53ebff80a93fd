//! `sinew track`: settings, the run, and its answer.

use super::args::{General, TrackArgs};
use super::ended::{Ended, doubts};
use super::error::Error;
use super::live;
use super::report::{self, Report};
use super::sync;
use super::table::{columns, table};
use super::terminal::Terminal;
use sinew::run::settings::{settings, with_stated_rate};
use sinew::run::{CameTo, Request, calibration, how_to_resume};
use sinew::track::job::Outcome;
use sinew_report::written_page::write_for_run;
use sinew_results::people::{PeopleSummary, PersonTracked};
use sinew_results::{Summary, is_incomplete};
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &TrackArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let terminal = Terminal { general, report };
    let given = [&args.settings.given[..], &general.settings()].concat();
    let resolved = settings(&given, general.config.as_deref())?;
    let mut resolved = with_stated_rate(resolved, &terminal)?;
    report.warnings(&resolved.warnings);
    report.warnings(&resolved.idle_flags());
    if args.sync {
        resolved = sync::synchronised(resolved, report)?;
    }
    if args.print_config {
        if args.answer.json {
            report::answer_json(&resolved.to_json())?;
        } else {
            report::answer(&resolved.describe())?;
        }
        return Ok(Ended::Done);
    }
    report.detail(&resolved.describe());
    if let Some(from) = &args.live {
        return live::run(from, args, &resolved, general, report);
    }
    let request = Request {
        resume: args.resume,
        page: args.report,
        write_calibration: args.write_calibration.clone(),
        settings_file: general.config.clone(),
        ..Request::default()
    };
    let config = resolved.track();
    let out = config.out.clone();
    let came_to = sinew::run::track(&resolved, &request, &terminal)?;
    if args.report {
        write_for_run(&out, &calibration(&config)?, &terminal)?;
    }
    match came_to {
        CameTo::One(outcome) => one_person(&outcome, &out, args, report),
        CameTo::Complete(summary) => complete(&summary, &out, args, report),
        CameTo::Several(summary) => several_people(&summary, &out, args, report),
    }
}

/// Says what the run of one person came to.
fn one_person(outcome: &Outcome, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    let Summary { complete, failed_diagnostics, warnings, .. } = &outcome.summary;
    report.warnings(warnings);
    if args.answer.json {
        report::answer_json(&serde_json::to_value(&outcome.summary).unwrap_or_default())?;
    } else {
        report::answer(&table(outcome, out))?;
    }
    if !complete {
        return Ok(interrupted(out, report));
    }
    Ok(doubts(failed_diagnostics, report))
}

fn interrupted(out: &Path, report: &Report) -> Ended {
    let became = match is_incomplete(out) {
        true => "what was done is written and marked incomplete",
        false => "the results that were there are as they were, and what was done is beside them",
    };
    report.note(&format!("interrupted; {became}; {}", how_to_resume()));
    Ended::Interrupted
}

/// Says that there is nothing to do.
fn complete(summary: &serde_json::Value, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    if args.answer.json {
        report::answer_json(summary)?;
    } else {
        report::answer(&format!(
            "nothing to do: the results in {} are complete, of these settings and data\n",
            out.display()
        ))?;
    }
    let failed = summary["failed_diagnostics"].as_array().into_iter().flatten();
    Ok(doubts(&failed.filter_map(|text| text.as_str()).collect::<Vec<_>>(), report))
}

/// A row a person: when they were seen, by which cameras, and what became of their run.
fn people_table(summary: &PeopleSummary, out: &Path) -> String {
    let heads = ["person", "frames", "seconds", "seen by two", "cameras", "tracked", "results"].map(str::to_owned);
    let row = |person: &PersonTracked| {
        let tracked = match (&person.failed, person.complete, person.trusted) {
            (Some(_), _, _) => "no",
            (None, true, true) => "yes",
            (None, true, false) => "doubtful",
            (None, false, _) => "in part",
        };
        let [first, end] = person.frames;
        vec![
            person.person.to_string(),
            format!("{first}..{end}"),
            format!("{:.1}", (end - first) as f64 / summary.fps),
            person.seen_frames.to_string(),
            person.seen_by(&summary.cameras),
            tracked.to_owned(),
            out.join(&person.folder).display().to_string(),
        ]
    };
    columns(&heads, &summary.people.iter().map(row).collect::<Vec<_>>())
}

/// Says what became of everybody.
fn several_people(summary: &PeopleSummary, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    if args.answer.json {
        report::answer_json(&serde_json::to_value(summary).unwrap_or_default())?;
    } else {
        report::answer(&people_table(summary, out))?;
    }
    if !summary.complete {
        return Ok(interrupted(out, report));
    }
    for person in &summary.people {
        let number = person.person;
        person.failed_diagnostics.iter().for_each(|failed| report.failed(&format!("person {number}: {failed}")));
    }
    let is_trusted = summary.people.iter().all(|person| person.trusted);
    Ok(if is_trusted { Ended::Done } else { Ended::Doubtful })
}

#[cfg(test)]
mod tests {
    use crate::args::{Cli, Command};
    use clap::Parser as _;
    use sinew::config::{Sources, resolve};

    #[test]
    fn chains_reach_the_sampler() {
        let cli = Cli::try_parse_from(["sinew", "track", "--chains", "24"]).unwrap();
        let Command::Track(args) = cli.command else { panic!("another command") };
        let resolved = resolve(&Sources { flags: args.settings.given, ..Sources::default() }).unwrap();
        let settings = resolved.settings().unwrap();
        assert!(format!("{:?}", settings.method).contains("Config { chains: 24,"), "{settings:?}");
    }
}
