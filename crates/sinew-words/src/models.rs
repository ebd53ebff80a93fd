//! Files that hold no learned model.

use sinew::dynamics::model_file::{ModelFileProblem, ModelFormat};
use std::fmt::{Debug, Display};

pub(crate) fn help<P: Debug + Display>(error: &ModelFileProblem<P>) -> Option<String> {
    Some(match error {
        ModelFileProblem::Json { format: ModelFormat { command, .. }, .. }
        | ModelFileProblem::Format { format: ModelFormat { command, .. }, .. } => {
            format!("give a file that `{command}` wrote; if it did write this one, learn the model again")
        }
        ModelFileProblem::Version { format: ModelFormat { command, .. }, .. } => {
            format!("learn the model again with this version of sinew: `{command}`")
        }
        ModelFileProblem::Value { format: ModelFormat { command, .. }, .. } => {
            format!("the file was changed or damaged after it was written; learn the model again: `{command}`")
        }
        _ => return None,
    })
}
