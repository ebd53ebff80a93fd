//! Which table of a result folder a CSV file is, by its header.

use sinew_formats::tidy_csv;

/// Where the motion is that the tables are about, in words.
pub const MOTION_FILES: &str = "markers.trc (points), angles.mot (angles) or motion.bvh (skeleton) of the same folder";

/// A table of a result folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultTable {
    /// `joints.csv`.
    Joints,
    /// `keypoints.csv`.
    Keypoints,
    /// `angles.csv`.
    Angles,
    /// `state.csv`.
    State,
    /// `frames.csv`.
    Frames,
    /// `actions.csv`.
    Actions,
    /// `markers_sd.csv`.
    MarkersSd,
    /// `gait_events.csv`.
    GaitEvents,
    /// `gait_parameters.csv`.
    GaitParameters,
    /// `gait_cycles.csv`.
    GaitCycles,
    /// `comparison.csv`.
    Comparison,
}

impl ResultTable {
    /// The table that a text is; `None` for the tables of others.
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        let header = text.lines().find(|line| !line.trim().is_empty())?;
        let columns = tidy_csv::read_cells("", header).ok()?.columns;
        let has = |names: &[&str]| names.iter().all(|name| columns.iter().any(|column| column == name));
        if has(&["frame", "time_s", "person", "joint", "x_mean_m"]) {
            Some(Self::Joints)
        } else if has(&["frame", "time_s", "person", "keypoint", "x_mean_m"]) {
            Some(Self::Keypoints)
        } else if has(&["time_s", "person", "name", "mean_deg"]) {
            Some(Self::Angles)
        } else if has(&["frame", "time_s", "person", "name", "unit", "mean"]) {
            Some(Self::State)
        } else if has(&["frame", "time_s", "observed", "quality", "restarted"]) {
            Some(Self::Frames)
        } else if has(&["frame", "time_s", "part", "cluster", "model", "share"]) {
            Some(Self::Actions)
        } else if has(&["side", "event", "point", "frame", "time_s"]) {
            Some(Self::GaitEvents)
        } else if has(&["row", "side", "strides", "start_s", "end_s"]) {
            Some(Self::GaitParameters)
        } else if has(&["side", "angle", "percent", "cycles", "mean_deg"]) {
            Some(Self::GaitCycles)
        } else if has(&["name", "axis", "count", "worth"]) {
            Some(Self::Comparison)
        } else {
            let [frame, time, deviations @ ..] = &columns[..] else { return None };
            let only_deviations = !deviations.is_empty() && deviations.iter().all(|column| column.ends_with("_sd_m"));
            (frame == "frame" && time == "time_s" && only_deviations).then_some(Self::MarkersSd)
        }
    }

    /// What it holds, and what a row is about.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Joints => "marginals of the points, a row for each point in a frame",
            Self::Keypoints => "marginals of the keypoints as detectors see them, a row for each keypoint in a frame",
            Self::Angles => "marginals of the angles of joints, a row for each angle in a frame",
            Self::State => "marginals of the body's degrees of freedom, a row for each in a frame",
            Self::Frames => "diagnostics, a row for each frame",
            Self::Actions => "actions, a row for each cluster and model that moved a part in a frame",
            Self::MarkersSd => "standard deviations of the markers, a row for each frame",
            Self::GaitEvents => "heel strikes and toe offs, a row for each event",
            Self::GaitParameters => "strides of a walk, a row for each, then means and standard deviations",
            Self::Comparison => "agreement with a reference, a row for each point and axis, or angle",
            Self::GaitCycles => "angles over the gait cycle, a row for each per cent of an angle and side",
        }
    }

    /// Column that says what a row is about besides its frame.
    #[must_use]
    pub const fn name_column(self) -> Option<&'static str> {
        match self {
            Self::Joints => Some("joint"),
            Self::Keypoints => Some("keypoint"),
            Self::Angles | Self::State | Self::Comparison => Some("name"),
            Self::Actions => Some("part"),
            Self::GaitEvents => Some("event"),
            Self::GaitParameters => Some("side"),
            Self::GaitCycles => Some("angle"),
            Self::Frames | Self::MarkersSd => None,
        }
    }

    /// Whether its rows belong to frames.
    #[must_use]
    pub const fn has_frames(self) -> bool {
        !matches!(self, Self::GaitEvents | Self::GaitParameters | Self::GaitCycles | Self::Comparison)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_recognised_by_their_header() {
        let check = |header: &str, expected| assert_eq!(ResultTable::of(header), expected, "{header}");
        check("frame,time_s,person,joint,x_mean_m,y_mean_m\n0,0,0,Nose,1,2\n", Some(ResultTable::Joints));
        check("frame,time_s,person,keypoint,x_mean_m\n", Some(ResultTable::Keypoints));
        check("\u{feff}time_s;person;name;mean_deg\r\n", Some(ResultTable::Angles));
        check("frame,time_s,person,name,unit,mean,q05,q95\n", Some(ResultTable::State));
        check("frame,time_s,observed,quality,restarted,ess\n", Some(ResultTable::Frames));
        check("frame,time_s,person,part,cluster,model,share\n", Some(ResultTable::Actions));
        check("frame,time_s,RHip_sd_m,Nose_sd_m\n", Some(ResultTable::MarkersSd));
        check("side,event,point,frame,time_s,time_q05_s,time_q95_s\n", Some(ResultTable::GaitEvents));
        check("row,side,strides,start_s,end_s,step_length_m\n", Some(ResultTable::GaitParameters));
        check("side,angle,percent,cycles,mean_deg,sd_deg\n", Some(ResultTable::GaitCycles));
        check("name,axis,count,worth,bias_m\n", Some(ResultTable::Comparison));
        check("time_s,RHip_x_m,RHip_y_m,RHip_z_m\n", None);
        check("frame,time_s,RHip_sd_m,knee_deg\n", None);
        check("frame,time_s\n", None);
        check("", None);
    }
}
