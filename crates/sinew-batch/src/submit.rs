//! Files that hand a study to Slurm, Snakemake or GNU parallel.

use super::shard::Shard;
use crate::Error;
use sinew_results::write_whole;
use std::path::Path;

const SLURM: &str = include_str!("submit.sh");
const SNAKEMAKE: &str = include_str!("Snakefile");
const PARALLEL: &str = include_str!("parallel.sh");

/// Writes `submit.sh`, `Snakefile` and `parallel.sh` for a number of shards.
///
/// # Errors
/// Errors of the disk.
pub fn write_submit_files(study: &Path, shards: usize) -> Result<(), Error> {
    let absolute = std::path::absolute(study).map_err(sinew::Error::io("read", study))?;
    let quoted = format!("'{}'", absolute.display().to_string().replace('\'', "'\\''"));
    let last = Shard { index: shards.saturating_sub(1), count: shards }.index;
    for (name, template) in [("submit.sh", SLURM), ("Snakefile", SNAKEMAKE), ("parallel.sh", PARALLEL)] {
        let text = template
            .replace("{STUDY}", &quoted)
            .replace("{SHARDS}", &shards.to_string())
            .replace("{LAST}", &last.to_string());
        write_whole(&study.join(name), text.as_bytes())?;
    }
    Ok(())
}
