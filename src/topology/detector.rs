//! The detector by persistence: what is present of the components of superlevel and sublevel sets makes the signature.

use super::candidate::{Candidate, judge};
use super::closed::Cover;
use super::exact::{self, by_kind_and_height, present_places};
use super::indicator::{
    Counted, at_centre, correct, correct_about_centre, flanks_from_centre, flanks_of_crests,
    shoulders,
};
use super::persistence::{components, grid};
use super::place_error;
use super::significance::Limits;
use super::surroundings::{contents, rims};
use super::{
    DetectOptions, Detection, Detector, Feature, FeatureKind, Flank, Indicator, IndicatorKind,
    Signature,
};
use crate::density::EstimatedDensity;

/// Peaks, valleys and craters of densities over one or two axes by persistence.
///
/// - A peak is present when it stands above its saddle by more than noise makes at the chosen confidence
///   (over all looks of the sweep) and more than the floor. The highest peak of a positive density always is. A
///   peak at an end of the range is a peak.
/// - A valley belongs to every other peak: the saddle where it merges, with the same verdict.
/// - A crater (two axes) is a basin that higher ground encloses. The highest point of its rim is the peak of
///   largest persistence; the rim has further peaks only where they are significant.
///
/// Persistence is the difference of the cell values, to which the standard errors belong; over two axes less
/// what the grid itself makes along oblique ridges and trenches. Position and density are refined below a
/// cell. A density without sampling errors is judged by the floor alone. A density over
/// other numbers of axes, with vectors of the wrong length, with values that are not finite or none
/// positive, has no features.
#[derive(Debug, Clone)]
pub struct PersistenceDetector {
    options: DetectOptions,
    looks: usize,
}

impl PersistenceDetector {
    /// A detector for a sweep that looks at `looks` densities in all (parameter values × observables); the
    /// confidence of the options holds for all of them together.
    pub fn new(options: DetectOptions, looks: usize) -> Self {
        Self { options, looks }
    }

    /// What counts in a density with so many cells.
    fn limits(&self, density: &EstimatedDensity, cells: usize) -> Limits {
        Limits::new(
            &self.options,
            self.looks,
            density.density.axes.len(),
            cells,
            (density.density.maximum(), density.negligible_height()),
        )
        .beside_ends(density.truncation.level)
    }
}

impl Detector for PersistenceDetector {
    fn name(&self) -> &'static str {
        "persistence"
    }

    fn detect(&self, density: &EstimatedDensity) -> Detection {
        let nothing = || Detection {
            signature: Signature::default(),
            is_seen: true,
            indicators: Vec::new(),
            features: Vec::new(),
        };
        if let Some(cover) = Cover::of(density) {
            let limits = |laid: &EstimatedDensity, cells: usize| self.limits(laid, cells);
            let found = cover.detection(limits, self.doubt());
            return found.unwrap_or_else(nothing);
        }
        let Some(grid) = grid(density) else {
            return nothing();
        };
        let limits = self.limits(density, grid.values.len());
        if let Some(profile) = &density.structure.profile {
            return exact::detection(density, profile, &limits, self.doubt());
        }
        let (peaks, craters) = components(grid);
        let peaks = judge(peaks, false, density, &limits);
        let craters = judge(craters, true, density, &limits);
        let rims = rims(grid, density, &craters, &limits);
        let persistent = contents(&peaks, &craters, &rims);
        let on_rim = |peak: &&Candidate| {
            let cell = peak.component.birth;
            rims.iter().any(|rim| rim.owns(cell))
        };
        let mut features: Vec<Feature> = Vec::new();
        for peak in peaks.iter().filter(|peak| !on_rim(peak)) {
            features.push(peak.feature(density, FeatureKind::Peak, peak.component.birth));
            if let Some(saddle) = peak.component.death {
                features.push(peak.feature(density, FeatureKind::Valley, saddle));
            }
        }
        for rim in &rims {
            // By falling persistence: the first stands for the rim as a whole.
            let whole = peaks.iter().find(|peak| rim.owns(peak.component.birth));
            features.extend(rim.features(density, whole));
        }
        for crater in &craters {
            features.push(crater.feature(density, FeatureKind::Crater, crater.component.birth));
        }
        features.sort_by(by_kind_and_height);
        let indicators = at_centre(density);
        let [peaks, craters] =
            [FeatureKind::Peak, FeatureKind::Crater].map(|kind| present_places(&features, kind));
        let around_centre = rims.iter().filter(|one| one.holds_centre(density));
        let counted = Counted {
            signature: persistent,
            peaks: &peaks,
            craters: &craters,
            rings_around_centre: around_centre.filter(|one| one.is_ring).count(),
        };
        let signature = correct(density, &indicators, self.doubt(), &counted);
        correct_about_centre(density, &indicators, self.doubt(), &mut features);
        for feature in &mut features {
            feature.errors = place_error::errors(density, feature);
        }
        Detection {
            signature,
            is_seen: signature.craters <= persistent.craters,
            indicators,
            features,
        }
    }

    fn indicator(
        &self,
        density: &EstimatedDensity,
        kind: IndicatorKind,
        near: &[f64],
    ) -> Option<Indicator> {
        match Cover::of(density) {
            Some(cover) => cover.indicator(kind, near),
            None => (kind.traits().read)(density, near),
        }
    }

    fn flanks(&self, density: &EstimatedDensity, detected: &Detection) -> Vec<Flank> {
        if let Some(cover) = Cover::of(density) {
            return cover.flanks();
        }
        match density.density.axes.len() {
            1 => shoulders(density),
            _ => {
                let of_crests = flanks_of_crests(density, self.options.floor, detected);
                [flanks_from_centre(density), of_crests].concat()
            }
        }
    }

    fn floor(&self) -> f64 {
        self.options.floor
    }

    fn confidence(&self) -> f64 {
        self.options.confidence
    }

    fn doubt(&self) -> f64 {
        (1.0 - self.options.confidence) / self.looks.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Density, Observable};
    use crate::space::Axis;
    use crate::topology::Verdict;

    fn estimated(values: Vec<f64>, errors: Vec<f64>) -> EstimatedDensity {
        let axis = Axis::uniform(0.0, 1.0, 8).unwrap();
        EstimatedDensity {
            standard_error: errors,
            ..EstimatedDensity::new(
                Observable::Marginal(0),
                Density {
                    axes: vec![axis],
                    values,
                },
            )
        }
    }

    fn detector() -> PersistenceDetector {
        PersistenceDetector::new(DetectOptions::default(), 1)
    }

    #[test]
    fn densities_without_sense_have_no_features() {
        let zeros = vec![0.0; 8];
        let mut broken = vec![1.0; 8];
        broken[3] = f64::NAN;
        for (values, errors) in [
            (zeros.clone(), zeros.clone()),
            (vec![-1.0; 8], zeros.clone()),
            (broken, zeros.clone()),
            (vec![1.0; 7], zeros.clone()),
            (vec![1.0; 8], vec![0.0; 3]),
        ] {
            let detection = detector().detect(&estimated(values, errors));
            assert_eq!(detection.signature.peaks, 0);
            assert!(detection.features.is_empty());
        }
    }

    #[test]
    fn the_highest_peak_is_present_however_noisy_and_persists_over_zero() {
        let values = vec![0.0, 1.0, 2.0, 1.5, 1.8, 0.2, 0.1, 0.3];
        let detection = detector().detect(&estimated(values, vec![5.0; 8]));
        assert_eq!(detection.signature.peaks, 1);
        let highest = detection.ranked(FeatureKind::Peak, 0).unwrap();
        assert_eq!(
            (highest.persistence, highest.verdict),
            (2.0, Verdict::Present)
        );
        // The others are listed as absent with their valleys, in falling persistence.
        let second = detection.ranked(FeatureKind::Peak, 1).unwrap();
        assert!((second.persistence - 0.3).abs() < 1e-12 && second.verdict == Verdict::Absent);
        let valley = detection.ranked(FeatureKind::Valley, 0).unwrap();
        assert_eq!(valley.persistence, second.persistence);
        assert_eq!(detection.ranked(FeatureKind::Valley, 2), None);
    }

    #[test]
    fn only_the_strongest_absent_features_are_listed() {
        let axis = Axis::uniform(0.0, 1.0, 40).unwrap();
        let values = (0..40).map(|i| 10.0 + f64::from(i % 2) * f64::from(i) * 0.01);
        let density = EstimatedDensity {
            standard_error: vec![1.0; 40],
            ..EstimatedDensity::new(
                Observable::Marginal(0),
                Density {
                    axes: vec![axis],
                    values: values.collect(),
                },
            )
        };
        let detection = detector().detect(&density);
        let peaks = |verdict| {
            let features = detection.features.iter();
            let of_kind = features.filter(|feature| feature.kind == FeatureKind::Peak);
            of_kind.filter(|feature| feature.verdict == verdict).count()
        };
        assert_eq!((peaks(Verdict::Present), peaks(Verdict::Absent)), (1, 4));
    }
}
