//! The grid of cells: numbering, finding the cell of a state, centres and volumes.

use super::{Axis, SpaceError};

/// A rectilinear grid over Ω in d = 1…4 dimensions. Cells are numbered with the last axis fastest
/// (C order): cell `(i, j)` of an `n × m` grid has number `i m + j`. The sink has no number; where a
/// state's cell is asked for, `None` means the sink.
#[derive(Debug, Clone, PartialEq)]
pub struct CellSpace {
    axes: Vec<Axis>,
    strides: Vec<usize>,
    n_cells: usize,
}

impl CellSpace {
    /// Largest number of cells: numbers fit in 32 bits, which the sparse matrices rely on.
    pub(crate) const LIMIT: usize = u32::MAX as usize;

    /// The product of the axes.
    ///
    /// # Errors
    /// [`SpaceError::Dimension`] or [`SpaceError::TooManyCells`].
    pub fn new(axes: Vec<Axis>) -> Result<Self, SpaceError> {
        if axes.is_empty() || axes.len() > crate::MAX_DIMENSION {
            return Err(SpaceError::Dimension { axes: axes.len() });
        }
        let mut strides = vec![1; axes.len()];
        let mut n_cells: usize = 1;
        for (stride, axis) in strides.iter_mut().zip(&axes).rev() {
            *stride = n_cells;
            n_cells = n_cells
                .checked_mul(axis.count())
                .filter(|&cells| cells <= Self::LIMIT)
                .ok_or(SpaceError::TooManyCells { limit: Self::LIMIT })?;
        }
        Ok(Self {
            axes,
            strides,
            n_cells,
        })
    }

    /// Number of axes d.
    pub fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// The axes, in the order of the state's coordinates.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Lower and upper end of every axis, in their order and units.
    pub(crate) fn ranges(&self) -> Vec<(f64, f64)> {
        let axes = self.axes.iter();
        axes.map(|axis| (axis.from(), axis.to())).collect()
    }

    /// Number of cells, the sink not counted.
    pub fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// Number of cells along each axis.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(Axis::count).collect()
    }

    /// Position of a cell along one axis.
    pub fn position(&self, cell: usize, axis: usize) -> usize {
        cell / self.strides[axis] % self.axes[axis].count()
    }

    /// Positions of all cells along one axis, in their order.
    pub(crate) fn positions(&self, axis: usize) -> impl Iterator<Item = usize> + use<> {
        let (stride, count) = (self.strides[axis], self.axes[axis].count());
        let blocks = self.n_cells / (stride * count).max(1);
        (0..blocks).flat_map(move |_| {
            (0..count).flat_map(move |position| std::iter::repeat_n(position, stride))
        })
    }

    /// Volumes of all cells, in their order.
    pub(crate) fn volumes(&self) -> Vec<f64> {
        let mut volumes = vec![1.0; self.n_cells];
        for (index, axis) in self.axes.iter().enumerate() {
            let positions = self.positions(index);
            let widths = positions.map(|position| axis.width(position));
            volumes
                .iter_mut()
                .zip(widths)
                .for_each(|(volume, width)| *volume *= width);
        }
        volumes
    }

    /// Number of the cell at the given positions, one an axis.
    pub fn number(&self, positions: &[usize]) -> usize {
        positions
            .iter()
            .zip(&self.strides)
            .map(|(position, stride)| position * stride)
            .sum()
    }

    /// The cell that holds a state; `None` is the sink (outside Ω, or not finite).
    pub fn find(&self, state: &[f64]) -> Option<usize> {
        let mut number = 0;
        for ((axis, stride), &coordinate) in self.axes.iter().zip(&self.strides).zip(state) {
            number += stride * axis.find(coordinate)?;
        }
        Some(number)
    }

    /// Middle of a cell: d coordinates.
    pub fn centre(&self, cell: usize) -> Vec<f64> {
        let axes = self.axes.iter().enumerate();
        axes.map(|(index, axis)| axis.centre(self.position(cell, index)))
            .collect()
    }

    /// Node of a cell: d coordinates.
    pub(crate) fn node(&self, cell: usize) -> Vec<f64> {
        let axes = self.axes.iter().enumerate();
        axes.map(|(index, axis)| axis.nodes()[self.position(cell, index)])
            .collect()
    }

    /// The state that stands for a cell: the node of an axis of modes, the middle along others.
    pub(crate) fn place(&self, cell: usize) -> Vec<f64> {
        let along = |(index, axis): (usize, &Axis)| {
            let position = self.position(cell, index);
            match axis.is_modes() {
                true => axis.nodes()[position],
                false => axis.centre(position),
            }
        };
        self.axes.iter().enumerate().map(along).collect()
    }

    /// Volume of a cell (length in one dimension, area in two).
    pub fn volume(&self, cell: usize) -> f64 {
        let axes = self.axes.iter().enumerate();
        axes.map(|(index, axis)| axis.width(self.position(cell, index)))
            .product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> CellSpace {
        let x = Axis::uniform(-1.0, 1.0, 4).unwrap();
        let y = Axis::uniform(0.0, 3.0, 3).unwrap();
        CellSpace::new(vec![x, y]).unwrap()
    }

    #[test]
    fn numbers_positions_and_centres_agree() {
        let space = space();
        assert_eq!(space.n_cells(), 12);
        for cell in 0..space.n_cells() {
            let positions = [space.position(cell, 0), space.position(cell, 1)];
            assert_eq!(space.number(&positions), cell);
            assert_eq!(space.find(&space.centre(cell)), Some(cell));
        }
        for (cell, volume) in space.volumes().into_iter().enumerate() {
            assert_eq!(volume, space.volume(cell));
            let positions = [0, 1].map(|axis| space.positions(axis).nth(cell));
            assert_eq!(
                positions,
                [0, 1].map(|axis| Some(space.position(cell, axis)))
            );
        }
        let total: f64 = (0..12).map(|cell| space.volume(cell)).sum();
        assert!((total - 6.0).abs() < 1e-12);
    }

    #[test]
    fn outside_and_overflow_are_the_sink() {
        let space = space();
        assert_eq!(space.find(&[1.5, 1.0]), None);
        assert_eq!(space.find(&[0.0, -0.1]), None);
        assert_eq!(space.find(&[f64::NAN, 1.0]), None);
        assert_eq!(space.find(&[f64::INFINITY, 1.0]), None);
        assert_eq!(space.find(&[1.0, 3.0]), Some(11));
    }

    #[test]
    fn too_many_cells_or_axes_are_refused() {
        let axis = Axis::uniform(0.0, 1.0, 1000).unwrap();
        assert!(matches!(
            CellSpace::new(vec![axis.clone(); 4]),
            Err(SpaceError::TooManyCells { .. })
        ));
        assert!(matches!(
            CellSpace::new(vec![axis; 5]),
            Err(SpaceError::Dimension { axes: 5 })
        ));
        assert!(CellSpace::new(Vec::new()).is_err());
    }
}
