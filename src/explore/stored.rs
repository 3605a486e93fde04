//! The page of a finished sweep: everything it shows stands in it.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::ExploreError;
use super::compose::Shown;
use super::plane::{PlaneScene, coarse_grid, nodes_of};
use crate::cancellation::Cancellation;
use crate::continuation::curve::{CurveTree, Plane};
use crate::continuation::map::{PlaneState, RegimeMap};
use crate::continuation::{SourceError, SweepResult, evenly_spaced};
use crate::density::Observable;
use crate::sweep_file::Sweep;

/// Values a side of a plane at most whose densities stand in its page.
const MOST_VALUES: usize = 21;

/// A page that shows a finished sweep, in one file without any reference to another.
#[derive(Debug, Clone)]
pub struct StoredPage {
    pub(super) html: String,
    pub(super) joint_bits: Option<u32>,
}

impl StoredPage {
    /// The page of a sweep and what it found.
    ///
    /// Marginals are kept to 2⁻²⁴ of their largest value. Joint densities are kept as square roots with 14 bits, or as
    /// few as 8 where the page would exceed 3 MB otherwise: its packed numbers say what that does to a value.
    ///
    /// # Errors
    /// [`ExploreError`].
    pub fn new(sweep: &Sweep, result: &SweepResult) -> Result<Self, ExploreError> {
        let shown = Shown {
            sweep,
            subject: &result.subject,
            labels: &result.labels,
            points: result.points.iter().collect(),
            plane: None,
            across: Vec::new(),
        };
        shown.fitted()
    }

    /// The page of a map: its plane, and densities at nodes of its coarse grid, 21 values a side at most, which are
    /// solved again. `done` is told how many of how many are solved, from whatever
    /// thread.
    ///
    /// # Errors
    /// [`ExploreError`]; [`ExploreError::Source`] with [`SourceError::Interrupted`] when it was cancelled.
    pub fn of_map(
        sweep: &Sweep,
        map: &RegimeMap,
        cancellation: &Cancellation,
        done: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Self, ExploreError> {
        let subject = sweep.problem.subject();
        let plane = PlaneScene::of(&map.plane, &subject.family);
        let plane = plane.with(subject, &map.nodes, (&map.curves, &map.levels, "start"));
        let [first, second] = coarse_grid(&map.nodes, MOST_VALUES);
        let (solved, all) = (AtomicUsize::new(0), first.len() * second.len());
        let count = || done(solved.fetch_add(1, Ordering::Relaxed) + 1, all);
        let states = sweep.plane_states([&first, &second], cancellation, &count)?;
        let states = states.ok_or(ExploreError::NoPlane)?;
        if states.len() < all {
            return Err(SourceError::Interrupted.into());
        }
        show(sweep, &plane, &states).fitted()
    }

    /// The page of curves that were begun at the row `start` of a sweep: their plane, and densities at 21 × 21 places
    /// of its box, which are solved.
    ///
    /// # Errors
    /// As [`StoredPage::of_map`].
    pub fn of_curves(
        sweep: &Sweep,
        plane: &Plane,
        (tree, start): (&CurveTree, &str),
        cancellation: &Cancellation,
        done: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Self, ExploreError> {
        let sides = plane.sides().each_ref();
        let values = sides.map(|side| evenly_spaced((side.from, side.to), MOST_VALUES));
        let (solved, all) = (AtomicUsize::new(0), MOST_VALUES * MOST_VALUES);
        let count = || done(solved.fetch_add(1, Ordering::Relaxed) + 1, all);
        let [first, second] = &values;
        let states = sweep.states_in(plane, [first, second], cancellation, &count)?;
        if states.len() < all {
            return Err(SourceError::Interrupted.into());
        }
        let subject = sweep.problem.subject();
        let plane = PlaneScene::of(plane, &subject.family);
        let plane = plane.with(
            subject,
            &nodes_of(&states),
            (&tree.curves, &tree.levels, start),
        );
        show(sweep, &plane, &states).fitted()
    }

    /// The page.
    pub fn html(&self) -> &str {
        &self.html
    }

    /// Bits to which the square roots of joint densities are kept; `None` where none is watched.
    pub(crate) fn joint_bits(&self) -> Option<u32> {
        self.joint_bits
    }
}

/// What the page of a plane shows.
fn show<'a>(sweep: &'a Sweep, plane: &'a PlaneScene, states: &'a [PlaneState]) -> Shown<'a> {
    Shown {
        sweep,
        subject: sweep.problem.subject(),
        labels: &[],
        points: states.iter().map(|state| &state.point).collect(),
        plane: Some(plane),
        across: states.iter().map(|state| state.values[1]).collect(),
    }
}

/// Bits of a joint density that are tried, the finest first; the last is taken however large the page becomes.
const JOINT_BITS: [u32; 4] = [14, 12, 10, 8];

/// Size of a page that is aimed at, in bytes.
const AIM: usize = 3_000_000;

impl Shown<'_> {
    /// The page with as many bits for joint densities as fit.
    pub(super) fn fitted(&self) -> Result<StoredPage, ExploreError> {
        let subject = self.subject;
        let is_joint = |observable: &Observable| matches!(observable, Observable::Joint(..));
        let has_joint = subject.observables.iter().any(is_joint);
        let ladder = if has_joint {
            &JOINT_BITS[..]
        } else {
            &JOINT_BITS[..1]
        };
        let mut smallest = None;
        for &bits in ladder {
            let html = self.compose(bits)?;
            let fits = html.len() <= AIM;
            smallest = Some((html, bits));
            if fits {
                break;
            }
        }
        let (html, bits) = smallest.unwrap_or_default();
        Ok(StoredPage {
            html,
            joint_bits: has_joint.then_some(bits),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancellation::Cancellation;
    use crate::continuation::Point;
    use crate::explore::pack::{Packed, Scale};
    use crate::sweep_file::SweepFile;
    use base64::Engine as _;
    use serde_json::Value;

    fn swept(settings: &[(&str, &str)]) -> (Sweep, SweepResult) {
        let text = include_str!("../../sweeps/coulomb_fc.toml");
        let mut file = SweepFile::parse("coulomb_fc.toml", text);
        file.set("locate.grid_check", "off");
        for (key, value) in settings {
            file.set(key, value);
        }
        let never = Cancellation::new();
        let sweep = file.validate().unwrap().prepare(&never).unwrap();
        let result = sweep.run(&never, &mut ()).unwrap();
        (sweep, result)
    }

    const SMALL: [(&str, &str); 4] = [
        ("sweep.points", "5"),
        ("cells.x.count", "30"),
        ("cells.y.count", "30"),
        ("locate.tolerance", "0.01"),
    ];

    fn block(html: &str, id: &str) -> Vec<u8> {
        let mark = format!("id=\"{id}\">");
        let text = html.split(&mark).nth(1).unwrap();
        let text = text.split("</script>").next().unwrap();
        base64::engine::general_purpose::STANDARD
            .decode(text)
            .unwrap()
    }

    fn words(html: &str) -> Value {
        let json = miniz_oxide::inflate::decompress_to_vec_zlib(&block(html, "scene")).unwrap();
        serde_json::from_slice(&json).unwrap()
    }

    fn packed(html: &str, stated: &Value, frames: usize) -> Packed {
        Packed {
            top: stated["top"].as_f64().unwrap(),
            levels: stated["levels"].as_u64().unwrap() as u32,
            scale: match stated["scale"].as_str() {
                Some("root") => Scale::Root,
                _ => Scale::Linear,
            },
            cells: stated["cells"].as_u64().unwrap() as usize,
            frames,
            bytes: block(html, &format!("block-{}", stated["block"])),
        }
    }

    #[test]
    fn a_page_holds_the_densities_and_what_was_found_in_them() {
        let (sweep, result) = swept(&SMALL);
        let page = StoredPage::new(&sweep, &result).unwrap();
        let told = words(page.html());
        assert_eq!(page.joint_bits(), Some(14));
        assert_eq!(told["swept"]["name"], "f_c");
        assert_eq!(told["sweep_file"], sweep.to_toml());
        assert_eq!(
            told["labels"].as_array().unwrap().len(),
            result.labels.len()
        );
        let with_density = || (result.points.iter()).filter(|point| !point.densities.is_empty());
        let at: Vec<f64> = with_density().map(|point| point.value).collect();
        assert!(at.len() > 3);
        for (number, point) in result.points.iter().enumerate() {
            let frame = &told["frames"][number];
            assert_eq!(frame["value"], point.value);
            assert_eq!(frame["residual"], point.report.residual);
            for (found, detection) in
                (frame["found"].as_array().unwrap().iter()).zip(&point.detections)
            {
                assert_eq!(found["words"], detection.signature.to_string());
            }
        }
        for (k, arrays) in told["arrays"].as_array().unwrap().iter().enumerate() {
            let packed = packed(page.html(), &arrays["values"], at.len());
            let frames = packed.unpack(&at);
            for (frame, point) in frames.iter().zip(with_density()) {
                let stored = &point.densities[k].density;
                let edges: Vec<f64> = serde_json::from_value(arrays["edges"][0].clone()).unwrap();
                assert_eq!(edges, stored.axes[0].edges());
                for (value, stored) in frame.iter().zip(&stored.values) {
                    assert!((value - stored).abs() <= packed.error_at(*stored));
                }
            }
        }
        let bands = told["arrays"][0]["band_is"].as_str().unwrap();
        assert!(bands.contains("second discretisation"), "{bands}");
    }

    #[test]
    fn fields_of_passages_stand_behind_the_densities() {
        let text = concat!(
            include_str!("../../sweeps/coulomb_fc.toml"),
            "\n[passage]\nover = { from = \"x < -0.5\", to = \"x > 0.5\", ",
            "fields = [\"committor\", \"reactive-current\"] }\n"
        );
        let mut file = SweepFile::parse("coulomb_fc.toml", text);
        for (key, value) in [("locate.grid_check", "off"), ("sweep.points", "3")]
            .iter()
            .chain(&SMALL[1..])
        {
            file.set(key, value);
        }
        let never = Cancellation::new();
        let sweep = file.validate().unwrap().prepare(&never).unwrap();
        let result = sweep.run(&never, &mut ()).unwrap();
        let page = StoredPage::new(&sweep, &result).unwrap();
        let told = words(page.html());
        let densities = result.subject.observables.len();
        let names = [
            "over_committor",
            "over_reactive_current_x",
            "over_reactive_current_y",
        ];
        for (number, name) in names.into_iter().enumerate() {
            let place = densities + number;
            let (one, arrays) = (&told["observables"][place], &told["arrays"][place]);
            assert_eq!(
                (one["name"].as_str(), one["field"].as_str()),
                (Some(name), Some(&*name.replace('_', " ")))
            );
            let has = |point: &&Point| point.report.fields.iter().any(|one| one.name == name);
            let known = || result.points.iter().filter(has);
            let at: Vec<f64> = known().map(|point| point.value).collect();
            assert!(at.len() >= 3);
            let packed = packed(page.html(), &arrays["values"], at.len());
            for (frame, point) in packed.unpack(&at).iter().zip(known()) {
                let field = point
                    .report
                    .fields
                    .iter()
                    .find(|field| field.name == name)
                    .unwrap();
                for (value, stored) in frame.iter().zip(&field.values) {
                    let stored = if stored.is_finite() { *stored } else { 0.0 };
                    assert!((value - stored).abs() <= packed.error_at(stored));
                }
            }
        }
        let told = told["observables"].as_array().unwrap();
        assert!(
            told.iter()
                .take(densities)
                .all(|one| one["field"].is_null())
        );
    }

    #[test]
    fn values_without_a_steady_state_have_a_frame_and_no_density() {
        // Friction that feeds energy in, on a range that does not hold it.
        let mut settings = SMALL.to_vec();
        settings.extend([
            ("cells.x.from", "-1.0"),
            ("cells.x.to", "1.0"),
            ("cells.y.from", "-1.0"),
            ("cells.y.to", "1.0"),
            ("method.escape_limit", "1e-3"),
        ]);
        let (sweep, result) = swept(&settings);
        assert!(result.points[0].densities.is_empty());
        let told = words(StoredPage::new(&sweep, &result).unwrap().html());
        assert_eq!(told["frames"][0]["status"], "no-steady-state");
        let words = told["frames"][0]["findings"][0].as_str().unwrap();
        assert!(words.starts_with("no steady state in Ω"), "{words}");
        let frames = told["arrays"][0]["frames"].as_array().unwrap();
        assert!(frames.iter().all(|number| number != 0));
    }
}
