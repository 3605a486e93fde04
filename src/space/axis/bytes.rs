//! An axis as bytes and back, the same to the bit: for what a program keeps of unfinished work.

use super::Axis;
use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::space::Series;
use crate::space::grading::Piece;

impl Axis {
    /// All of it.
    pub(crate) fn write(&self, writer: &mut Writer) {
        writer.numbers(&self.edges).numbers(&self.nodes);
        writer.count(self.pieces.len());
        for piece in &self.pieces {
            writer.number(piece.from).number(piece.to);
            writer.count(piece.first_cell).count(piece.cells);
            writer.number(piece.bulk);
            let terms = piece.terms.iter();
            let terms: Vec<f64> = terms.flat_map(|&(a, b, c)| [a, b, c]).collect();
            writer.numbers(&terms);
            writer.number(piece.raw_from).number(piece.scale);
        }
        let (code, mean, deviation) = match self.series {
            None => (0, 0.0, 0.0),
            Some(Series::Legendre) => (1, 0.0, 0.0),
            Some(Series::Hermite { mean, deviation }) => (2, mean, deviation),
        };
        writer.count(code).number(mean).number(deviation);
    }

    /// What was written.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`], also for edges that do not ascend and pieces that do not hold the cells.
    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Self, NotWhatWasWritten> {
        let (edges, nodes) = (reader.numbers()?, reader.numbers()?);
        let mut pieces = Vec::new();
        for _ in 0..reader.count()? {
            pieces.push(read_piece(reader)?);
        }
        let (code, mean, deviation) = (reader.count()?, reader.number()?, reader.number()?);
        let series = match code {
            0 => None,
            1 => Some(Series::Legendre),
            2 => Some(Series::Hermite { mean, deviation }),
            _ => return Err(NotWhatWasWritten),
        };
        let axis = Self {
            edges,
            nodes,
            pieces,
            series,
        };
        axis.is_sound().then_some(axis).ok_or(NotWhatWasWritten)
    }

    /// Whether every cell has its edges, its node and, but for modes, its piece.
    fn is_sound(&self) -> bool {
        let ascending = self.edges.windows(2).all(|pair| pair[0] < pair[1]);
        let mut cells = 0;
        let joined = self.pieces.iter().all(|piece| {
            let follows = piece.first_cell == cells && piece.cells > 0;
            cells = cells.saturating_add(piece.cells);
            follows
        });
        let held = if self.is_modes() { 0 } else { self.nodes.len() };
        ascending && self.edges.len() == self.nodes.len() + 1 && joined && cells == held
    }
}

fn read_piece(reader: &mut Reader<'_>) -> Result<Piece, NotWhatWasWritten> {
    let (from, to) = (reader.number()?, reader.number()?);
    let (first_cell, cells) = (reader.count()?, reader.count()?);
    let bulk = reader.number()?;
    let terms = reader.numbers()?;
    let (triples, []) = terms.as_chunks::<3>() else {
        return Err(NotWhatWasWritten);
    };
    Ok(Piece {
        from,
        to,
        first_cell,
        cells,
        bulk,
        terms: triples.iter().map(|&[a, b, c]| (a, b, c)).collect(),
        raw_from: reader.number()?,
        scale: reader.number()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    #[test]
    fn axes_of_every_kind_come_back_and_cut_ones_are_refused() {
        let grading = Grading {
            at: vec![-0.5, 0.0],
            smallest: 0.01,
        };
        let axes = [
            Axis::uniform(-1.0, 2.0, 7),
            Axis::graded(-1.0, 2.0, 40, &grading),
            Axis::modes(-0.3, 0.3, 5),
            Axis::hermite(0.1, 2.0, 6),
        ];
        for axis in axes.map(Result::unwrap) {
            let mut writer = Writer::new();
            axis.write(&mut writer);
            let bytes = writer.finish();
            let back = Axis::read(&mut Reader::new(&bytes)).unwrap();
            assert_eq!(back, axis);
            for length in 0..bytes.len() {
                let cut = &bytes[..length];
                assert!(Axis::read(&mut Reader::new(cut)).is_err(), "{length}");
            }
        }
    }
}
