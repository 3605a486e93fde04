//! Where the updates of fronts lie, from a front's elimination until its parent has taken it over.
//!
//! A front with m boundary cells gives an update of m² numbers. Both halves of every box may be in flight together, and
//! a subtree's memory then is as much as the levels of its tree need at once. Two stretches serve by turns: a front's
//! update lies in one, those of its children in the other, those of its grandchildren, which are no longer needed, in
//! the first again. So every place is known beforehand, and one block of memory, kept from one factorisation to the
//! next, holds them all.

/// Numbers that the updates of a subtree take, whatever the number of threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct UpdateSpace {
    /// Of the stretch with the update of the subtree's top.
    pub(super) of_top: usize,
    /// Of the stretch with the updates of its children.
    pub(super) of_children: usize,
}

impl UpdateSpace {
    /// Of a front with so many boundary cells above two subtrees (or none, which take no space).
    pub(super) fn above([left, right]: [Self; 2], boundary: usize) -> Self {
        let grandchildren = left.of_children.saturating_add(right.of_children);
        Self {
            of_top: grandchildren.max(boundary.saturating_mul(boundary)),
            of_children: left.of_top.saturating_add(right.of_top),
        }
    }

    /// Of both stretches.
    pub(super) fn total(self) -> usize {
        self.of_top.saturating_add(self.of_children)
    }
}

/// The two stretches, or the parts of them that are a subtree's.
pub(super) struct Updates<'a, T> {
    /// That with the update of the subtree's top, which comes first in it.
    of_top: &'a mut [T],
    /// That with the updates of its children.
    of_children: &'a mut [T],
}

impl<'a, T> Updates<'a, T> {
    /// The stretches in a block of [`UpdateSpace::total`] numbers.
    pub(super) fn new(block: &'a mut [T], space: UpdateSpace) -> Self {
        let (of_top, of_children) = block.split_at_mut(space.of_top);
        Self {
            of_top,
            of_children,
        }
    }

    /// The parts of the two subtrees below the top, of which the left one takes so much.
    pub(super) fn below(&mut self, left: UpdateSpace) -> [Updates<'_, T>; 2] {
        let (of_left, of_right) = self.of_children.split_at_mut(left.of_top);
        let (below_left, below_right) = self.of_top.split_at_mut(left.of_children);
        let part = |of_top, of_children| Updates {
            of_top,
            of_children,
        };
        [part(of_left, below_left), part(of_right, below_right)]
    }

    /// The update of the top, with so many boundary cells, and the stretch with those of its children.
    pub(super) fn top(&mut self, boundary: usize) -> (&mut [T], &[T]) {
        (&mut self.of_top[..boundary * boundary], &*self.of_children)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Space of a whole binary tree whose fronts have the given boundaries, level by level from the top.
    fn space(boundaries: &[usize]) -> UpdateSpace {
        match boundaries.split_first() {
            None => UpdateSpace::default(),
            Some((&top, below)) => UpdateSpace::above([space(below); 2], top),
        }
    }

    /// Writes the number of every front into its whole update, children first, and finds those of its children as they
    /// were left.
    fn fill(number: usize, boundaries: &[usize], mut updates: Updates<'_, usize>) {
        let Some((&top, below)) = boundaries.split_first() else {
            return;
        };
        let left = space(below);
        for (half, part) in updates.below(left).into_iter().enumerate() {
            fill(2 * number + half, below, part);
        }
        let (update, children) = updates.top(top);
        update.fill(number);
        let child = below.first().map_or(0, |m| m * m);
        let (first, second) = children.split_at(left.of_top);
        assert!(first[..child].iter().all(|&n| n == 2 * number));
        assert!(second[..child].iter().all(|&n| n == 2 * number + 1));
    }

    #[test]
    fn an_update_lies_where_no_other_is_needed() {
        for boundaries in [&[0][..], &[0, 3], &[0, 3, 5, 2], &[0, 9, 6, 4, 3, 5, 1]] {
            let space = space(boundaries);
            let mut block = vec![0; space.total()];
            fill(1, boundaries, Updates::new(&mut block, space));
        }
    }

    #[test]
    fn two_levels_share_what_three_would_take() {
        let space = space(&[0, 4, 3, 2]);
        // Two fours above, or eight twos below; four threes between.
        assert_eq!(space.of_children, 32);
        assert_eq!(space.of_top, 36);
    }
}
