//! A part of the tasks: those whose place leaves a remainder. Schedulers say which in the environment.

use sinew_input::flag::flag_with;
use std::fmt;
use std::str::FromStr;

/// Task `k` belongs to shard `k mod count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0 on.
    pub index: usize,
    /// How many there are.
    pub count: usize,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Whether a task at that place belongs to it.
    #[must_use]
    pub const fn holds(&self, place: usize) -> bool {
        place % self.count == self.index
    }

    /// What a scheduler says: Slurm's job arrays, or Kubernetes' indexed jobs, whose number of completions `count` must say.
    ///
    /// # Errors
    /// A sentence on what is missing or no number.
    pub fn from_environment(
        variable: impl Fn(&str) -> Option<String>,
        count: Option<usize>,
    ) -> Result<Option<Self>, String> {
        let number = |name: &str| match variable(name) {
            None => Ok(None),
            Some(text) => {
                text.parse::<usize>().map(Some).map_err(|_| format!("`{name}` is `{text}`; expected a number"))
            }
        };
        let (index, own_count) = match number("SLURM_ARRAY_TASK_ID")? {
            Some(id) => {
                let first = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(0);
                let own_count = number("SLURM_ARRAY_TASK_COUNT")?;
                let span = number("SLURM_ARRAY_TASK_MAX")?.map(|last| last + 1 - first.min(last));
                // Some tasks of an array that are begun again are numbered as in the whole one.
                let differs = |other: Option<usize>| own_count.is_some() && other.is_some() && other != own_count;
                if differs(span) || differs(count) {
                    return Err(format!(
                        "this job array is a part of another: give each task its {}",
                        flag_with("shard", "I/N")
                    ));
                }
                (id.saturating_sub(first), own_count)
            }
            None => match number("JOB_COMPLETION_INDEX")? {
                Some(index) => (index, None),
                None if count.is_some() => {
                    return Err(format!(
                        "no scheduler says which of these parts this is: give {}",
                        flag_with("shard", "I/N")
                    ));
                }
                None => return Ok(None),
            },
        };
        let Some(count) = count.or(own_count) else {
            return Err("the environment says which part this is, and not of how many".into());
        };
        if index < count {
            Ok(Some(Self { index, count }))
        } else {
            Err(format!("part {index} of {count}: parts are counted from 0"))
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if index < count => Ok(Self { index, count }),
            _ => Err("expected I/N, part I of N, counted from 0: 0/4, 1/4, 2/4, 3/4".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_has_one_shard() {
        for count in 1..6 {
            let shards: Vec<Shard> = (0..count).map(|index| Shard { index, count }).collect();
            for place in 0..20 {
                assert_eq!(shards.iter().filter(|shard| shard.holds(place)).count(), 1);
            }
        }
    }

    #[test]
    fn shards_are_read() {
        assert_eq!("3/16".parse(), Ok(Shard { index: 3, count: 16 }));
        for wrong in ["4/4", "1", "-1/3", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn schedulers_say_which_shard() {
        let with = |pairs: &'static [(&str, &str)], count| {
            let variable =
                |name: &str| pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned());
            Shard::from_environment(variable, count)
        };
        assert_eq!(with(&[], None), Ok(None));
        let slurm = &[("SLURM_ARRAY_TASK_ID", "4"), ("SLURM_ARRAY_TASK_MIN", "1"), ("SLURM_ARRAY_TASK_COUNT", "8")];
        assert_eq!(with(slurm, None), Ok(Some(Shard { index: 3, count: 8 })));
        let again = &[
            ("SLURM_ARRAY_TASK_ID", "7"),
            ("SLURM_ARRAY_TASK_MIN", "3"),
            ("SLURM_ARRAY_TASK_MAX", "7"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
        ];
        assert!(with(again, None).is_err() && with(&again[..], Some(16)).is_err() && with(slurm, Some(16)).is_err());
        assert!(with(&[], Some(4)).is_err());
        let kubernetes = &[("JOB_COMPLETION_INDEX", "2")];
        assert_eq!(with(kubernetes, Some(5)), Ok(Some(Shard { index: 2, count: 5 })));
        assert!(with(kubernetes, None).is_err() && with(kubernetes, Some(2)).is_err());
        assert!(with(&[("SLURM_ARRAY_TASK_ID", "x")], Some(2)).is_err());
    }
}
