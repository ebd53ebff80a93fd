//! Which rows belong to which columns so that the sum of costs is least?
//!
//! The assignment problem (Kuhn 1955) by shortest augmenting paths (Jonker & Volgenant 1987): rows enter one after the other, each along the path of least reduced cost; potentials u, v keep `cost − u − v ≥ 0`, and 0 where assigned. Every row has a column of its own in which it stays alone at a fixed cost.

/// Stands for a pair that is not allowed.
const FORBIDDEN: f64 = 1e12;

/// For each row its column; `None` where staying alone at the cost `alone` is cheaper or all else is forbidden. Costs that are not finite are forbidden.
#[must_use]
pub fn least_cost(costs: &[Vec<f64>], alone: f64) -> Vec<Option<usize>> {
    let (rows, columns) = (costs.len(), costs.iter().map(Vec::len).max().unwrap_or(0));
    let cost = |row: usize, column: usize| match costs[row].get(column) {
        Some(cost) if cost.is_finite() => *cost,
        None if column == columns + row => alone,
        _ => FORBIDDEN,
    };
    let wide = columns + rows;
    let mut row_of: Vec<Option<usize>> = vec![None; wide];
    let (mut by_row, mut by_column) = (vec![0.0; rows], vec![0.0; wide]);
    for first in 0..rows {
        let mut least = vec![f64::INFINITY; wide];
        let mut before: Vec<Option<usize>> = vec![None; wide];
        let mut is_done = vec![false; wide];
        let (mut row, mut at) = (first, None);
        let end = loop {
            let mut next: Option<usize> = None;
            for column in (0..wide).filter(|column| !is_done[*column]) {
                let reduced = cost(row, column) - by_row[row] - by_column[column];
                if reduced < least[column] {
                    (least[column], before[column]) = (reduced, at);
                }
                if next.is_none_or(|best| least[column] < least[best]) {
                    next = Some(column);
                }
            }
            // A row always finds its own column.
            let Some(column) = next else { break None };
            let step = least[column];
            by_row[first] += step;
            for other in 0..wide {
                match (is_done[other], row_of[other]) {
                    (true, Some(own)) => {
                        by_row[own] += step;
                        by_column[other] -= step;
                    }
                    _ => least[other] -= step,
                }
            }
            is_done[column] = true;
            at = Some(column);
            match row_of[column] {
                Some(taken) => row = taken,
                None => break Some(column),
            }
        };
        let mut column = end;
        while let Some(own) = column {
            let from = before[own];
            row_of[own] = from.map_or(Some(first), |from| row_of[from]);
            column = from;
        }
    }
    let mut found = vec![None; rows];
    for (column, row) in row_of.into_iter().enumerate().take(columns) {
        if let Some(row) = row.filter(|row| cost(*row, column) < FORBIDDEN) {
            found[row] = Some(column);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn total(costs: &[Vec<f64>], found: &[Option<usize>], alone: f64) -> f64 {
        costs.iter().zip(found).map(|(row, column)| column.map_or(alone, |column| row[column])).sum()
    }

    /// The least sum, by trying everything.
    fn exhaustive(costs: &[Vec<f64>], taken: &mut Vec<bool>, alone: f64) -> f64 {
        let Some((row, rest)) = costs.split_first() else { return 0.0 };
        let mut least = alone + exhaustive(rest, taken, alone);
        for (column, cost) in row.iter().enumerate() {
            if !taken[column] && cost.is_finite() {
                taken[column] = true;
                least = least.min(cost + exhaustive(rest, taken, alone));
                taken[column] = false;
            }
        }
        least
    }

    proptest! {
        #[test]
        fn no_other_assignment_costs_less(
            rows in 0..5_usize,
            columns in 0..5_usize,
            numbers in prop::collection::vec(prop_oneof![9 => 0.0..1.0, 1 => Just(f64::INFINITY)], 25),
            alone in 0.0..1.0,
        ) {
            let costs: Vec<Vec<f64>> = (0..rows).map(|row| numbers[5 * row..][..columns].to_vec()).collect();
            let found = least_cost(&costs, alone);
            prop_assert_eq!(found.len(), rows);
            let mut columns_found: Vec<usize> = found.iter().flatten().copied().collect();
            columns_found.sort_unstable();
            columns_found.dedup();
            prop_assert_eq!(columns_found.len(), found.iter().flatten().count());
            let least = exhaustive(&costs, &mut vec![false; columns], alone);
            prop_assert!((total(&costs, &found, alone) - least).abs() < 1e-12);
        }
    }
}
