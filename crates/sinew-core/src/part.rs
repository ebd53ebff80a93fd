//! Parts of a state: sorted index sets, partitions that cover it once, and trees of parts.
//!
//! Partitioned, hierarchical and coarse-to-fine trackers differ in the [`PartTree`] that they walk.

use crate::Error;

/// A sorted set of distinct coordinates of a state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part(Vec<usize>);

impl Part {
    /// Sorts and validates the indices of a part of a state of dimension `dim`.
    ///
    /// # Errors
    /// [`Error::EmptyPart`], [`Error::IndexOutOfRange`] or [`Error::DuplicateIndex`].
    pub fn new(mut indices: Vec<usize>, dim: usize) -> Result<Self, Error> {
        indices.sort_unstable();
        if indices.is_empty() {
            return Err(Error::EmptyPart);
        }
        if let Some(&index) = indices.iter().find(|&&i| i >= dim) {
            return Err(Error::IndexOutOfRange { index, dim });
        }
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Error::DuplicateIndex { index: pair[0] });
        }
        Ok(Self(indices))
    }

    /// The indices, ascending.
    #[must_use]
    pub fn indices(&self) -> &[usize] {
        &self.0
    }
}

/// Parts that cover a state exactly once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Partition(Vec<Part>);

impl Partition {
    /// Validates that the parts are disjoint and cover `0..dim`.
    ///
    /// # Errors
    /// [`Error::DuplicateIndex`] or [`Error::Uncovered`].
    pub fn new(parts: Vec<Part>, dim: usize) -> Result<Self, Error> {
        let mut seen = vec![false; dim];
        for &index in parts.iter().flat_map(Part::indices) {
            if index >= dim {
                return Err(Error::IndexOutOfRange { index, dim });
            }
            if std::mem::replace(&mut seen[index], true) {
                return Err(Error::DuplicateIndex { index });
            }
        }
        match seen.iter().position(|&covered| !covered) {
            Some(index) => Err(Error::Uncovered { index }),
            None => Ok(Self(parts)),
        }
    }

    /// The parts, in the order given.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.0
    }
}

/// A partition whose parts have parents: the order in which a body is searched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartTree {
    partition: Partition,
    parents: Vec<Option<usize>>,
}

impl PartTree {
    /// Validates that there is a parent entry for each part and that parents come first.
    ///
    /// # Errors
    /// [`Error::ParentCount`] or [`Error::ParentNotBefore`].
    pub fn new(partition: Partition, parents: Vec<Option<usize>>) -> Result<Self, Error> {
        if parents.len() != partition.parts().len() {
            return Err(Error::ParentCount { parts: partition.parts().len(), parents: parents.len() });
        }
        match parents.iter().enumerate().find(|(i, parent)| parent.is_some_and(|p| p >= *i)) {
            Some((part, _)) => Err(Error::ParentNotBefore { part }),
            None => Ok(Self { partition, parents }),
        }
    }

    /// The parts.
    #[must_use]
    pub const fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Parent of each part.
    #[must_use]
    pub fn parents(&self) -> &[Option<usize>] {
        &self.parents
    }

    /// The parts of each depth, those without a parent first.
    #[must_use]
    pub fn levels(&self) -> Vec<Vec<usize>> {
        let mut depths: Vec<usize> = vec![];
        let mut levels: Vec<Vec<usize>> = vec![];
        for (part, parent) in self.parents.iter().enumerate() {
            let depth = parent.map_or(0, |parent| depths[parent] + 1);
            depths.push(depth);
            levels.resize(levels.len().max(depth + 1), vec![]);
            levels[depth].push(part);
        }
        levels
    }

    /// The parts that hang on a part, at any distance.
    #[must_use]
    pub fn descendants(&self, part: usize) -> Vec<usize> {
        let mut found = vec![false; self.parents.len()];
        for (other, parent) in self.parents.iter().enumerate() {
            found[other] = parent.is_some_and(|parent| parent == part || found[parent]);
        }
        (0..found.len()).filter(|&other| found[other]).collect()
    }

    /// The coordinates of some parts, one part after the other.
    #[must_use]
    pub fn coordinates(&self, parts: &[usize]) -> Vec<usize> {
        parts.iter().flat_map(|&part| self.partition.parts()[part].indices()).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(indices: &[usize]) -> Part {
        Part::new(indices.to_vec(), 5).expect("valid part")
    }

    #[test]
    fn parts_are_sorted_and_checked() {
        assert_eq!(part(&[3, 1]).indices(), [1, 3]);
        assert_eq!(Part::new(vec![], 5), Err(Error::EmptyPart));
        assert_eq!(Part::new(vec![5], 5), Err(Error::IndexOutOfRange { index: 5, dim: 5 }));
        assert_eq!(Part::new(vec![2, 2], 5), Err(Error::DuplicateIndex { index: 2 }));
    }

    #[test]
    fn parts_sum_to_whole() {
        let all = vec![part(&[0, 1]), part(&[2, 4]), part(&[3])];
        let partition = Partition::new(all.clone(), 5).expect("covers 0..5 once");
        assert_eq!(partition.parts().iter().map(|p| p.indices().len()).sum::<usize>(), 5);
        assert_eq!(Partition::new(all[..2].to_vec(), 5), Err(Error::Uncovered { index: 3 }));
        assert_eq!(
            Partition::new(vec![part(&[0, 1, 2, 3]), part(&[3, 4])], 5),
            Err(Error::DuplicateIndex { index: 3 })
        );
        assert_eq!(Partition::new(all.clone(), 4), Err(Error::IndexOutOfRange { index: 4, dim: 4 }));
        let tree = PartTree::new(partition.clone(), vec![None, Some(0), Some(0)]).expect("parents first");
        assert_eq!((tree.partition(), tree.parents()), (&partition, &[None, Some(0), Some(0)][..]));
        assert_eq!((tree.levels(), tree.descendants(0)), (vec![vec![0], vec![1, 2]], vec![1, 2]));
        assert_eq!(tree.coordinates(&[2, 0]), [3, 0, 1]);
        let chain = PartTree::new(partition.clone(), vec![None, Some(0), Some(1)]).expect("parents first");
        assert_eq!((chain.levels(), chain.descendants(0)), (vec![vec![0], vec![1], vec![2]], vec![1, 2]));
        assert_eq!((chain.descendants(1), chain.descendants(2)), (vec![2], vec![]));
        assert_eq!(
            PartTree::new(partition.clone(), vec![None, Some(1), Some(0)]),
            Err(Error::ParentNotBefore { part: 1 })
        );
        assert_eq!(PartTree::new(partition, vec![None]), Err(Error::ParentCount { parts: 3, parents: 1 }));
    }
}
