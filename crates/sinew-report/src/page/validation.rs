//! What a validation of the recording found, read from its table.

use crate::Error;
use sinew_analysis::validate::{CameraCoverage, worth};
use sinew_results::folder_table::FolderTable;
use std::path::Path;

/// Name of the rows that hold all keypoints of a camera.
const ALL: &str = "all";

/// The sentence of `sinew validate`, from `validation.csv`.
pub(super) fn found(path: &Path) -> Result<String, Error> {
    let table = FolderTable::open(path)?;
    let (cameras, keypoints) = (table.texts("camera")?, table.texts("keypoint")?);
    let (counts, inside) = (table.column("count")?, table.column("inside_90")?);
    let rows = cameras.into_iter().zip(keypoints).zip(counts.into_iter().zip(inside));
    let all = rows.filter(|((_, keypoint), _)| keypoint == ALL);
    let held: Vec<CameraCoverage> =
        all.map(|((camera, _), (count, inside))| CameraCoverage { camera, count, inside }).collect();
    Ok(worth(&held))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_is_that_of_the_validation() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("validation.csv");
        let text = "camera,keypoint,count,inside_90\nA,all,100,0.9\nA,Nose,9,0\nB,all,300,0.94\n";
        std::fs::write(&path, text).unwrap();
        let said = found(&path).unwrap();
        assert!(said.starts_with("93 % of what") && said.ends_with("can be taken at their word"), "{said}");
        std::fs::write(&path, "camera,keypoint,count\nA,all,100\n").unwrap();
        assert!(found(&path).unwrap_err().to_string().contains("no column `inside_90`"));
    }
}
