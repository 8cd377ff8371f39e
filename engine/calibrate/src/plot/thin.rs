//! Fewer dots that look the same.

use std::collections::HashSet;

/// Most dots of a panel: keeps a sheet of 16 below 2 MB.
const MOST: usize = 1100;

/// Keeps one dot of each square of a grid, the first; coarsens the grid until few enough are left.
/// A dot that stands alone always stays.
pub(super) fn thinned(dots: &[[i32; 2]]) -> Vec<[i32; 2]> {
    let mut side = 3;
    loop {
        let mut taken = HashSet::new();
        let kept: Vec<_> = dots
            .iter()
            .copied()
            .filter(|dot| taken.insert(dot.map(|place| place.div_euclid(side))))
            .collect();
        if kept.len() <= MOST {
            return kept;
        }
        side += 1 + side / 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowds_are_thinned_and_loners_stay() {
        let mut dots: Vec<_> = (0..200)
            .flat_map(|x| (0..100).map(move |y| [x, y]))
            .collect();
        dots.push([5000, 5000]);
        let kept = thinned(&dots);
        assert!(
            (MOST / 3..=MOST).contains(&kept.len()),
            "{} dots of 20001",
            kept.len()
        );
        assert!(kept.contains(&[5000, 5000]), "the far dot is gone");
    }

    #[test]
    fn few_dots_all_stay() {
        let dots = [[0, 0], [10, 0], [20, 5]];
        assert_eq!(thinned(&dots), dots);
    }
}
