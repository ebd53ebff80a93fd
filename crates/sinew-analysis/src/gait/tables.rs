//! `gait_events.csv`, `gait_parameters.csv` and `gait_cycles.csv` as text.

use super::analysis::GaitAnalysis;
use super::strides::PARAMETERS;
use super::summary::{ParameterSummary, summary};
use super::varied::{Varied, interval};
use super::walk::SIDES;
use sinew_formats::tidy_csv::{Cell, write_header, write_row};
use std::io;

/// A number that is not finite becomes an empty cell.
fn number(value: f64) -> Cell<'static> {
    if value.is_finite() { Cell::Number(value) } else { Cell::Empty }
}

/// Rounded to so much: digits beyond it are noise of the processor.
fn rounded(value: f64) -> Cell<'static> {
    number((value * 1e6).round() / 1e6)
}

fn ends(interval: Option<[f64; 2]>) -> [Cell<'static>; 2] {
    interval.map_or([Cell::Empty; 2], |ends| ends.map(rounded))
}

fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<String, sinew::Error> {
    let mut bytes = vec![];
    write(&mut bytes).map_err(sinew::Error::io("write", "a table of gait"))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// `side,event,point,frame,time_s,time_q05_s,time_q95_s,definition`.
pub(super) fn events(gait: &GaitAnalysis) -> Result<String, sinew::Error> {
    text(|out| {
        let columns = ["side", "event", "point", "frame", "time_s", "time_q05_s", "time_q95_s", "definition"];
        write_header(out, &columns)?;
        gait.events.iter().zip(&gait.event_frames).try_for_each(|(event, frame)| {
            let [low, high] = ends(interval(&event.draws_s));
            let (side, kind) = (Cell::Text(SIDES[event.side]), Cell::Text(event.kind.name()));
            let (frame, time) = (rounded(*frame), rounded(event.time_s));
            let definition = Cell::Text(event.kind.definition());
            write_row(out, &[side, kind, Cell::Text(&event.point), frame, time, low, high, definition])
        })
    })
}

/// A row for each stride, then mean and standard deviation of each side and of both.
pub(super) fn parameters(gait: &GaitAnalysis) -> Result<String, sinew::Error> {
    let names = PARAMETERS.iter().flat_map(|name| {
        let (bare, unit) = unit(name);
        ["", "_q05", "_q95"].map(|end| format!("{bare}{end}{unit}"))
    });
    let columns: Vec<String> =
        ["row", "side", "strides", "start_s", "end_s"].map(str::to_owned).into_iter().chain(names).collect();
    text(|out| {
        write_header(out, &columns)?;
        for stride in &gait.strides {
            let head = ["stride", SIDES[stride.side]].map(Cell::Text);
            let mut cells = [&head[..], &[Cell::Integer(1), rounded(stride.start_s), rounded(stride.end_s)]].concat();
            cells.extend(stride.parameters.iter().flat_map(|found| with_interval(found.as_ref())));
            write_row(out, &cells)?;
        }
        for (side, name) in [(Some(0), SIDES[0]), (Some(1), SIDES[1]), (None, "both")] {
            let found = summary(&gait.strides, side);
            let count = gait.strides.iter().filter(|stride| side.is_none_or(|side| stride.side == side)).count();
            let head = |row| [Cell::Text(row), Cell::Text(name), Cell::Integer(count as i64), Cell::Empty, Cell::Empty];
            let mean = |found: &Option<ParameterSummary>| with_interval(found.as_ref().map(|found| &found.mean));
            let sd = |found: &Option<ParameterSummary>| {
                [found.as_ref().map_or(Cell::Empty, |found| rounded(found.sd)), Cell::Empty, Cell::Empty]
            };
            write_row(out, &head("mean").into_iter().chain(found.iter().flat_map(mean)).collect::<Vec<_>>())?;
            write_row(out, &head("sd").into_iter().chain(found.iter().flat_map(sd)).collect::<Vec<_>>())?;
        }
        Ok(())
    })
}

/// The name of a parameter without its unit, and the unit with its underscore.
fn unit(name: &str) -> (&str, &str) {
    let units = ["_m_per_s", "_per_min", "_m", "_s", "_share"];
    let unit = units.into_iter().find(|unit| name.ends_with(unit)).unwrap_or_default();
    name.split_at(name.len() - unit.len())
}

fn with_interval(found: Option<&Varied>) -> [Cell<'static>; 3] {
    let [low, high] = ends(found.and_then(Varied::interval));
    [found.map_or(Cell::Empty, |found| rounded(found.mean)), low, high]
}

/// `side,angle,percent,cycles,mean_deg,sd_deg,q05_deg,q95_deg`.
pub(super) fn cycles(gait: &GaitAnalysis) -> Result<String, sinew::Error> {
    text(|out| {
        write_header(out, &["side", "angle", "percent", "cycles", "mean_deg", "sd_deg", "q05_deg", "q95_deg"])?;
        for cycle in &gait.cycles {
            for (percent, (mean, sd)) in (0..).zip(cycle.mean_deg.iter().zip(&cycle.sd_deg)) {
                let [low, high] = ends(cycle.interval_deg.as_ref().map(|ends| ends.each_ref().map(|x| x[percent])));
                let head = [Cell::Text(SIDES[cycle.side]), Cell::Text(&cycle.angle)];
                let counts = [percent, cycle.cycles].map(|count| Cell::Integer(count as i64));
                let numbers = [rounded(*mean), rounded(*sd), low, high];
                write_row(out, &[&head[..], &counts, &numbers].concat())?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_last_in_every_column() {
        let split: Vec<(&str, &str)> = PARAMETERS.iter().map(|name| unit(name)).collect();
        assert!(split.iter().all(|(bare, unit)| !bare.is_empty() && !unit.is_empty()), "{split:?}");
        assert_eq!(unit("speed_m_per_s"), ("speed", "_m_per_s"));
        assert_eq!(unit("step_length_m"), ("step_length", "_m"));
    }
}
