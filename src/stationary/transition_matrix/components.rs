//! Strongly connected components of a transition matrix by Tarjan's algorithm (SIAM J. Comput. 1, 1972),
//! without recursion.

use super::chain::SoundMatrix;

/// Components of the graph with an edge j → i for every P_ij > 0, the sink left out.
pub(super) struct Components {
    /// Component of each cell. Numbers are topological: an edge between components goes from a smaller to a
    /// larger number.
    pub(super) of: Vec<u32>,
    /// Number of components.
    pub(super) count: usize,
}

const UNSEEN: u32 = u32::MAX;

/// State of the depth-first search. It follows rows, hence edges backward: components come out sources first.
struct Search {
    /// Order in which cells were first seen.
    seen: Vec<u32>,
    /// Lowest order reachable backward through the search tree and one more edge.
    low: Vec<u32>,
    /// Seen cells whose component is not complete.
    open: Vec<u32>,
    found: Components,
}

impl Components {
    /// Finds the components in time linear in the number of entries.
    pub(super) fn of(matrix: &SoundMatrix<'_>) -> Self {
        let n = matrix.len();
        let mut search = Search {
            seen: vec![UNSEEN; n],
            low: vec![UNSEEN; n],
            open: Vec::new(),
            found: Self {
                of: vec![UNSEEN; n],
                count: 0,
            },
        };
        let mut orders = 0;
        for root in 0..n {
            if search.seen[root] == UNSEEN {
                search.from(root, matrix, &mut orders);
            }
        }
        search.found
    }
}

impl Search {
    fn enter(&mut self, cell: usize, orders: &mut u32) {
        self.seen[cell] = *orders;
        self.low[cell] = *orders;
        *orders += 1;
        self.open.push(cell as u32);
    }

    fn from(&mut self, root: usize, matrix: &SoundMatrix<'_>, orders: &mut u32) {
        self.enter(root, orders);
        let mut path = vec![(root, matrix.row(root))];
        while let Some((cell, sources)) = path.last_mut() {
            let cell = *cell;
            if let Some((source, _)) = sources.next() {
                if self.seen[source] == UNSEEN {
                    self.enter(source, orders);
                    path.push((source, matrix.row(source)));
                } else if self.found.of[source] == UNSEEN {
                    self.low[cell] = self.low[cell].min(self.seen[source]);
                }
            } else {
                path.pop();
                if let Some(&(parent, _)) = path.last() {
                    self.low[parent] = self.low[parent].min(self.low[cell]);
                }
                self.close(cell);
            }
        }
    }

    /// Completes the component of a cell that reaches nothing older.
    fn close(&mut self, cell: usize) {
        if self.low[cell] != self.seen[cell] {
            return;
        }
        while let Some(member) = self.open.pop() {
            self.found.of[member as usize] = self.found.count as u32;
            if member as usize == cell {
                break;
            }
        }
        self.found.count += 1;
    }
}
