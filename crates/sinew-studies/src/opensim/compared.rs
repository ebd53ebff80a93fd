//! Angles of a run beside coordinates of an OpenSim model: bias, spread, correlation, and what a bias comes from.

use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::table::{header, row};
use sinew::formats::mot::{self, Mot};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Rows of the tables: a coordinate, our columns whose sum it is, and OpenSim's column.
///
/// Markers show the turn of the shoulders from the pelvis; how much of it the spine and how much the shoulder girdle has is a matter of the body's prior, and OpenSim's model has no girdle.
const ROWS: [(&str, &[&str], &str); 27] = [
    ("pelvis_tilt", &["pelvis_tilt"], "pelvis_tilt"),
    ("pelvis_list", &["pelvis_list"], "pelvis_list"),
    ("pelvis_rotation", &["pelvis_rotation"], "pelvis_rotation"),
    ("pelvis_tx, mm", &["pelvis_tx"], "pelvis_tx"),
    ("pelvis_ty, mm", &["pelvis_ty"], "pelvis_ty"),
    ("pelvis_tz, mm", &["pelvis_tz"], "pelvis_tz"),
    ("lumbar_bending", &["lumbar_bending"], "L5_S1_Lat_Bending"),
    ("lumbar_rotation", &["lumbar_rotation"], "L5_S1_axial_rotation"),
    ("… with girdle_rz", &["lumbar_rotation", "girdle_rz"], "L5_S1_axial_rotation"),
    ("hip_flexion_r", &["hip_flexion_r"], "hip_flexion_r"),
    ("hip_flexion_l", &["hip_flexion_l"], "hip_flexion_l"),
    ("hip_adduction_r", &["hip_adduction_r"], "hip_adduction_r"),
    ("hip_adduction_l", &["hip_adduction_l"], "hip_adduction_l"),
    ("hip_rotation_r", &["hip_rotation_r"], "hip_rotation_r"),
    ("hip_rotation_l", &["hip_rotation_l"], "hip_rotation_l"),
    ("knee_angle_r", &["knee_angle_r"], "knee_angle_r"),
    ("knee_angle_l", &["knee_angle_l"], "knee_angle_l"),
    ("ankle_angle_r", &["ankle_angle_r"], "ankle_angle_r"),
    ("ankle_angle_l", &["ankle_angle_l"], "ankle_angle_l"),
    ("arm_flex_r", &["arm_flex_r"], "arm_flex_r"),
    ("arm_flex_l", &["arm_flex_l"], "arm_flex_l"),
    ("arm_add_r", &["arm_add_r"], "arm_add_r"),
    ("arm_add_l", &["arm_add_l"], "arm_add_l"),
    ("arm_rot_r", &["arm_rot_r"], "arm_rot_r"),
    ("arm_rot_l", &["arm_rot_l"], "arm_rot_l"),
    ("elbow_flex_r", &["elbow_flex_r"], "elbow_flex_r"),
    ("elbow_flex_l", &["elbow_flex_l"], "elbow_flex_l"),
];

/// A motion file, degrees and metres.
pub(super) struct Angles(Mot);

impl Angles {
    pub(super) fn read(path: &Path) -> Outcome<Self> {
        let motion = mot::read(&path.display().to_string(), &fs::read_to_string(path)?)?;
        if motion.in_degrees { Ok(Self(motion)) } else { Err(format!("{}: radians", path.display()).into()) }
    }

    /// A column; lengths in millimetres.
    fn column(&self, name: &str) -> Option<Vec<f64>> {
        let place = self.0.columns.iter().position(|column| column == name)?;
        let scale = if is_length(name) { 1000.0 } else { 1.0 };
        Some(self.0.rows.iter().map(|row| scale * row[place]).collect())
    }

    fn sum(&self, names: &[&str]) -> Option<Vec<f64>> {
        let columns = names.iter().map(|name| self.column(name)).collect::<Option<Vec<_>>>()?;
        Some((0..self.0.rows.len()).map(|row| columns.iter().map(|column| column[row]).sum()).collect())
    }
}

fn is_length(name: &str) -> bool {
    name.starts_with("pelvis_t") && name.len() == "pelvis_tx".len()
}

fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values);
    mean(values.iter().map(|x| (x - middle).powi(2))).sqrt()
}

/// Differences; of angles in [−180, 180).
fn differences(a: &[f64], b: &[f64], is_length: bool) -> Vec<f64> {
    let apart = |(a, b): (&f64, &f64)| {
        if is_length { a - b } else { (a - b + 180.0).rem_euclid(360.0) - 180.0 }
    };
    a.iter().zip(b).map(apart).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (middle_a, middle_b) = (mean(a), mean(b));
    let products: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - middle_a) * (b - middle_b)).collect();
    mean(&products) / (deviation(a) * deviation(b))
}

/// What is compared of a coordinate.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Mean of ours less OpenSim's, the standard deviation of the difference, and the correlation.
    bias: f64,
    spread: f64,
    correlation: f64,
    /// Standard deviation of our angle.
    motion: f64,
    /// Angles of the model's markers by our definitions less its coordinates: in the poses of the recording, and of the model at rest from its markers and from its joints.
    definition: Option<f64>,
    at_rest: Option<f64>,
    at_rest_joints: Option<f64>,
}

/// A run beside its inverse kinematics.
pub(super) struct Compared(Vec<Option<Row>>);

impl Compared {
    /// Reads what `opensim_ik.py` wrote.
    pub(super) fn read(ours: &Angles, fit: &Path) -> Outcome<Self> {
        let angles = |name: &str| Angles::read(&fit.join(name));
        let (ik, model) = (angles("ik.mot")?, angles("model_markers.mot")?);
        let (rest_ik, rest, joints) = (angles("rest_ik.mot")?, angles("rest.mot")?, angles("rest_joints.mot")?);
        let row = |&(_, names, theirs): &(&str, &[&str], &str)| {
            let is_length = is_length(theirs);
            let (our, their) = (ours.sum(names)?, ik.column(theirs)?);
            let by_definition = |angles: &Angles, coordinates: &Angles| {
                let differences = differences(&angles.column(names[0])?, &coordinates.column(theirs)?, is_length);
                Some(mean(&differences))
            };
            let apart = differences(&our, &their, is_length);
            Some(Row {
                bias: mean(&apart),
                spread: deviation(&apart),
                correlation: correlation(&our, &their),
                motion: deviation(&our),
                definition: by_definition(&model, &ik),
                at_rest: by_definition(&rest, &rest_ik),
                at_rest_joints: by_definition(&joints, &rest_ik),
            })
        };
        Ok(Self(ROWS.iter().map(row).collect()))
    }
}

/// Mean over seeds, and their standard deviation where there are several.
fn over_seeds(values: &[f64]) -> String {
    match values {
        [] => "—".into(),
        [one] => signed(*one),
        several => format!("{} ± {:.1}", signed(mean(several)), deviation(several)),
    }
}

fn signed(value: f64) -> String {
    format!("{value:+.1}").replace('-', "−")
}

/// A correlation; none where one of the two does not move.
fn correlated(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}").replace('-', "−") } else { "—".into() }
}

/// The table of markers: where they are from the model's joints, and how far the fit leaves them away.
pub(super) fn markers(fit: &Path) -> Outcome<String> {
    let mut text =
        header("| marker | forward of the joint's centre, mm | above, mm | to the right, mm | left by the fit, mm |");
    let path = fit.join("fit.csv");
    for line in fs::read_to_string(&path)?.lines().skip(1) {
        let [name, rms, offsets @ ..] = &line.split(',').collect::<Vec<_>>()[..] else {
            return Err(format!("{}: `{line}`", path.display()).into());
        };
        let number = |cell: &&str| cell.trim().parse().map_or("—".into(), signed);
        let offsets: Vec<String> = offsets.iter().map(number).collect();
        let rms: f64 = rms.parse()?;
        row!(text, "{name} | {} | {rms:.1}", offsets.join(" | "));
    }
    Ok(text)
}

/// The table of a person, over seeds.
pub(super) fn table(seeds: &[Compared]) -> String {
    let mut text =
        header("| coordinate | bias | spread | r | our sd | by definition | by fit | rest, markers | rest, joints |");
    for (place, (name, ..)) in ROWS.iter().enumerate() {
        let rows: Vec<Row> = seeds.iter().filter_map(|seed| seed.0[place]).collect();
        if rows.is_empty() {
            continue;
        }
        let usual = |value: fn(&Row) -> f64| mean(rows.iter().map(value).collect::<Vec<_>>());
        let maybe = |value: &dyn Fn(&Row) -> Option<f64>| {
            let values: Vec<f64> = rows.iter().filter_map(value).collect();
            if values.is_empty() { "—".into() } else { signed(mean(&values)) }
        };
        row!(
            text,
            "{name} | {} | {:.1} | {} | {:.1} | {} | {} | {} | {}",
            over_seeds(&rows.iter().map(|row| row.bias).collect::<Vec<_>>()),
            usual(|row| row.spread),
            correlated(usual(|row| row.correlation)),
            usual(|row| row.motion),
            maybe(&|row| row.definition),
            maybe(&|row| row.definition.map(|part| row.bias - part)),
            maybe(&|row| row.at_rest),
            maybe(&|row| row.at_rest_joints),
        );
    }
    text
}

/// The table of inverse kinematics beside others of the same motion.
pub(super) fn variation(usual: &Angles, others: &[Angles; 2]) -> String {
    let mut text =
        header("| coordinate | Pose2Sim's markers: bias | spread | r | model with muscles: bias | spread | r |");
    for (name, ours, theirs) in ROWS {
        let Some(usual) = usual.column(theirs).filter(|_| ours.len() == 1) else { continue };
        let _ = write!(text, "| {name} |");
        for other in others {
            let Some(other) = other.column(theirs) else {
                text += " — | — | — |";
                continue;
            };
            let apart = differences(&other, &usual, is_length(theirs));
            let r = correlated(correlation(&other, &usual));
            let _ = write!(text, " {} | {:.1} | {r} |", signed(mean(&apart)), deviation(&apart));
        }
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_angles_are_taken_around_the_circle() {
        assert_eq!(differences(&[179.0, -10.0], &[-179.0, 10.0], false), [-2.0, -20.0]);
        assert_eq!(differences(&[700.0], &[100.0], true), [600.0]);
    }

    #[test]
    fn bias_spread_and_correlation_of_a_line() {
        let (a, b) = ([1.0, 2.0, 3.0], [5.0, 7.0, 9.0]);
        let apart = differences(&a, &b, false);
        assert!((mean(&apart) + 5.0).abs() < 1e-12 && (deviation(&apart) - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((correlation(&a, &b) - 1.0).abs() < 1e-12);
    }
}
