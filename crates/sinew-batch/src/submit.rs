//! Files that hand a study to Slurm, Snakemake or GNU parallel.

use super::shard::Shard;
use crate::Error;
use sinew_results::{place, write_whole};
use std::path::Path;

const SLURM: &str = include_str!("submit.sh");
const SNAKEMAKE: &str = include_str!("Snakefile");
const PARALLEL: &str = include_str!("parallel.sh");

/// Their names.
pub(super) const SUBMIT_NAMES: [&str; 3] = ["submit.sh", "Snakefile", "parallel.sh"];

/// Writes `submit.sh`, `Snakefile` and `parallel.sh` for a number of shards.
///
/// # Errors
/// Errors of the disk.
pub fn write_submit_files(study: &Path, shards: usize) -> Result<(), Error> {
    let absolute = std::path::absolute(study).map_err(sinew::Error::io("read", study))?;
    let shown = absolute.display().to_string();
    let quoted = format!("'{}'", shown.replace('\'', "'\\''"));
    // A Snakefile is Python, whose strings JSON's are.
    let in_python = serde_json::to_string(&shown).unwrap_or_default();
    let last = Shard { index: shards.saturating_sub(1), count: shards }.index;
    let templates = [(SLURM, &quoted), (SNAKEMAKE, &in_python), (PARALLEL, &quoted)];
    for (name, (template, study_path)) in SUBMIT_NAMES.into_iter().zip(templates) {
        let text = template
            .replace("{STUDY}", study_path)
            .replace("{SHARDS}", &shards.to_string())
            .replace("{LAST}", &last.to_string());
        write_whole(&place(study, name)?, text.as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// The shell and, where there is one, Python say which folder the files mean.
    #[cfg(unix)]
    #[test]
    fn paths_with_quotes_and_blanks_are_kept() {
        let root = tempfile::tempdir().unwrap();
        let study = root.path().join("anna's \"long\" $study \\ \u{e4}");
        std::fs::create_dir(&study).unwrap();
        write_submit_files(&study, 3).unwrap();
        let first = |file: &str, word: &str| {
            let text = std::fs::read_to_string(study.join(file)).unwrap();
            text.lines().find(|line| line.starts_with(word)).unwrap().to_owned()
        };
        let said = |program: &str, script: String| {
            let output = Command::new(program).args(["-c", &script]).output().ok()?;
            Some(String::from_utf8(output.stdout).unwrap())
        };
        let shown = study.display().to_string();
        let shell = format!("{}; printf %s \"$study\"", first("submit.sh", "study="));
        assert_eq!(said("sh", shell).unwrap(), shown);
        let python = format!("{}; print(study, end='')", first("Snakefile", "study = "));
        assert!(said("python3", python).is_none_or(|found| found == shown));
        let last = first("parallel.sh", "sinew batch gather").replace("sinew batch gather", "printf %s");
        assert_eq!(said("sh", last).unwrap(), shown);
    }
}
