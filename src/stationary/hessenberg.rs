//! The small least-squares problem of GMRES (Saad and Schultz 1986).

use nalgebra::{DMatrix, DVector};

/// The Hessenberg matrix, made triangular by rotations as it grows.
pub(crate) struct Triangle {
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    right: Vec<f64>,
}

impl Triangle {
    /// An empty one, for a start of a size.
    pub(crate) fn new(size: f64) -> Self {
        Self {
            columns: Vec::new(),
            rotations: Vec::new(),
            right: vec![size],
        }
    }

    /// Takes a column with its entry below the diagonal; gives the norm of the residual.
    pub(crate) fn push(&mut self, mut column: Vec<f64>, below: f64) -> f64 {
        for (index, &(cosine, sine)) in self.rotations.iter().enumerate() {
            let (a, b) = (column[index], column[index + 1]);
            column[index] = cosine * a + sine * b;
            column[index + 1] = cosine * b - sine * a;
        }
        let last = column.len() - 1;
        let length = column[last].hypot(below);
        let (cosine, sine) = if length > 0.0 {
            (column[last] / length, below / length)
        } else {
            (1.0, 0.0)
        };
        column[last] = length;
        let end = self.right[last];
        self.right[last] = cosine * end;
        self.right.push(-sine * end);
        self.rotations.push((cosine, sine));
        self.columns.push(column);
        (sine * end).abs()
    }

    /// Weights of the basis vectors, and the smallest singular value.
    pub(crate) fn solve(&self) -> (Vec<f64>, f64) {
        let n = self.columns.len();
        if n == 0 {
            return (Vec::new(), 1.0);
        }
        let entry =
            |row: usize, column: usize| self.columns[column].get(row).copied().unwrap_or(0.0);
        let matrix = DMatrix::from_fn(n, n, entry);
        let right = DVector::from_column_slice(&self.right[..n]);
        let weights = matrix.solve_upper_triangular(&right);
        let smallest = matrix.singular_values().min();
        let weights = weights.map_or_else(|| vec![0.0; n], |weights| weights.as_slice().to_vec());
        (weights, smallest)
    }
}
