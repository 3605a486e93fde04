//! One state of each regime of a map: densities well inside the regions, to be shown and stored.

use super::found::RegimeMap;
use super::{RegionSample, SourceInPlane};
use crate::cancellation::Cancellation;
use crate::continuation::SourceError;
use crate::topology::Signature;

/// Columns and rows of the picture in which places well inside are looked for.
const PICTURE: [usize; 2] = [120, 120];
/// A region smaller than this share of the box has no density of its own.
const LEAST: f64 = 0.01;
/// Most densities of one observable.
const MOST: usize = 8;

/// A density of each signature of every observable, in its largest region; those that cannot be solved are left out.
///
/// # Errors
/// [`SourceError`] where no source can be made.
pub(super) fn samples(
    map: &RegimeMap,
    source: &SourceInPlane<'_>,
    cancellation: &Cancellation,
) -> Result<Vec<RegionSample>, SourceError> {
    let mut wanted: Vec<(usize, [f64; 2])> = Vec::new();
    for observable in 0..map.subject.observables.len() {
        let Some(picture) = map.regions(observable, PICTURE) else {
            continue;
        };
        let mut seen: Vec<Signature> = Vec::new();
        for region in picture
            .regions
            .iter()
            .filter(|region| region.share >= LEAST)
        {
            let Some(signature) = region.signature else {
                continue;
            };
            if !seen.contains(&signature) && seen.len() < MOST {
                seen.push(signature);
                wanted.push((observable, region.inside));
            }
        }
    }
    let plane = map.plane.afresh();
    let source = source(&plane)?;
    let mut session = source.open(cancellation);
    let mut samples = Vec::new();
    for (index, (observable, values)) in wanted.into_iter().enumerate() {
        let place = plane.place(values);
        let coordinate = match index {
            0 => plane.begin(place),
            _ => plane.lay(place),
        };
        match session.solve(coordinate) {
            Ok(solution) => {
                if let Some(found) = solution.densities.get(observable) {
                    samples.push(RegionSample {
                        observable,
                        values,
                        density: found.density.clone(),
                    });
                }
            }
            Err(SourceError::Interrupted) => break,
            Err(SourceError::Method(_)) => {}
        }
    }
    Ok(samples)
}
