//! The balance that a (quasi-)steady state satisfies, with one cell held.
//!
//! F(p) = Q p + r(p) p with r(p) = (escape · p) / Σp. Its entries sum to zero for every p, because the columns
//! of Q sum to minus the escape: the balance of one cell follows from the others and is dropped.

use sprs::CsMat;

/// A generator with its escape and the cell that is held.
pub(super) struct Balance<'a> {
    pub(super) matrix: &'a CsMat<f64>,
    pub(super) escape: &'a [f64],
    pub(super) held: usize,
}

/// The derivative of the balance at a mass vector.
pub(super) struct Jacobian<'a> {
    balance: &'a Balance<'a>,
    mass: &'a [f64],
    total: f64,
    rate: f64,
}

/// out ← out + Q x, columns in order.
pub(super) fn add_product(matrix: &CsMat<f64>, x: &[f64], out: &mut [f64]) {
    for (column, &weight) in matrix.outer_iterator().zip(x) {
        for (&row, &rate) in column.indices().iter().zip(column.data()) {
            out[row] += rate * weight;
        }
    }
}

/// Q x.
pub(crate) fn product(matrix: &CsMat<f64>, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    add_product(matrix, x, &mut out);
    out
}

/// Qᵀ x.
pub(crate) fn transposed_product(matrix: &CsMat<f64>, x: &[f64]) -> Vec<f64> {
    let columns = matrix.outer_iterator();
    let sum = |indices: &[usize], rates: &[f64]| {
        let pairs = indices.iter().zip(rates);
        pairs.map(|(&row, rate)| rate * x[row]).sum::<f64>()
    };
    columns
        .map(|column| sum(column.indices(), column.data()))
        .collect()
}

/// Σ a b.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Balance<'_> {
    /// Whether any mass escapes.
    pub(super) fn leaks(&self) -> bool {
        self.escape.iter().any(|&rate| rate > 0.0)
    }

    /// r(p).
    pub(super) fn escape_rate(&self, mass: &[f64]) -> f64 {
        let total: f64 = mass.iter().sum();
        let lost = dot(self.escape, mass);
        if lost == 0.0 { 0.0 } else { lost / total }
    }

    /// F(p) of all cells, the held one included.
    pub(super) fn full_residual(&self, mass: &[f64]) -> Vec<f64> {
        let rate = self.escape_rate(mass);
        let mut residual: Vec<f64> = mass.iter().map(|value| rate * value).collect();
        add_product(self.matrix, mass, &mut residual);
        residual
    }

    /// F(p) with zero at the held cell.
    pub(super) fn residual(&self, mass: &[f64]) -> Vec<f64> {
        let mut residual = self.full_residual(mass);
        residual[self.held] = 0.0;
        residual
    }

    /// ‖F(p)‖₁ / ‖|Q| |p|‖₁.
    pub(super) fn relative_residual(&self, mass: &[f64]) -> f64 {
        let residual: f64 = self
            .full_residual(mass)
            .iter()
            .map(|value| value.abs())
            .sum();
        let columns = self.matrix.outer_iterator().zip(mass);
        let scale: f64 = columns
            .map(|(column, value)| {
                let rates: f64 = column.data().iter().map(|rate| rate.abs()).sum();
                rates * value.abs()
            })
            .sum();
        if scale > 0.0 {
            residual / scale
        } else {
            residual
        }
    }

    /// The derivative at a mass vector.
    pub(super) fn jacobian<'a>(&'a self, mass: &'a [f64]) -> Jacobian<'a> {
        Jacobian {
            balance: self,
            mass,
            total: mass.iter().sum(),
            rate: self.escape_rate(mass),
        }
    }
}

impl Jacobian<'_> {
    /// F'(p) v for a v that is zero at the held cell; the result is zero there too.
    pub(super) fn apply(&self, vector: &[f64]) -> Vec<f64> {
        let balance = self.balance;
        let mut out = if self.rate == 0.0 {
            vec![0.0; vector.len()]
        } else {
            let sum: f64 = vector.iter().sum();
            let change = (dot(balance.escape, vector) - self.rate * sum) / self.total;
            let terms = vector.iter().zip(self.mass);
            terms.map(|(v, p)| self.rate * v + change * p).collect()
        };
        add_product(balance.matrix, vector, &mut out);
        out[balance.held] = 0.0;
        out
    }
}
