//! What the live page asks for: densities at any values of the parameters, changes between two values, sample paths, a
//! sweep file, the page of an edited one.
//!
//! Requests come in lanes with rising tickets: a newer one of a lane makes the older ones stale. What waits is dropped,
//! what is being solved is cancelled. Solves are warm: sessions are kept for the parameters that do not move.

mod ask;
mod bound;
mod edit;
mod lanes;
mod mapping;
mod paths;
mod sessions;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::ExploreError;
use super::frame::{Frame, band};
use super::html;
use super::pack::deflate;
use super::plane::PlaneScene;
use super::scene::{Label, Scene};
use crate::cancellation::Cancellation;
use crate::continuation::{Point, SourceError};
use crate::density::{EstimatedDensity, Observable};
use crate::sweep_file::{SolveError, Sweep};
use crate::topology::PersistenceDetector;
use ask::{AskLocate, AskSolve, AskSweepFile};
use bound::Base;
use lanes::Lanes;
use mapping::Mapping;
use paths::Runs;
use sessions::{Sessions, Solving};

/// The live side of a sweep.
pub(super) struct Live {
    base: Base,
    detector: PersistenceDetector,
    sessions: Mutex<Sessions>,
    lanes: Lanes,
    mapping: Mapping,
    runs: Runs,
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live").finish_non_exhaustive()
    }
}

/// What a request comes to, as JSON. That a value is refused or a request stale is an answer like others: browsers
/// write failures into their consoles.
#[derive(Debug, Serialize)]
#[serde(rename_all = "lowercase")]
enum Answer<T> {
    /// What was asked for.
    Done(T),
    /// Why not, for people.
    Refused(String),
    /// A newer request has taken its place.
    Stale(bool),
}

/// Why there is no answer.
enum Stop {
    Refused(String),
    Stale,
}

#[derive(Debug, Serialize)]
struct LivePage<'a> {
    live: bool,
    /// The sweep file that its editor begins with.
    typed: String,
    /// Axes of a state.
    dimension: usize,
    #[serde(flatten)]
    scene: &'a Scene,
    plane: Option<PlaneScene>,
    frames: [(); 0],
    arrays: Vec<PackedArray>,
}

#[derive(Debug, Serialize)]
struct SolveAnswer {
    ticket: u64,
    frame: Frame,
    arrays: Vec<PackedArray>,
    milliseconds: f64,
}

/// The cells of a watched density, with its values and band as little-endian doubles in base64; `None` where they were
/// not asked for.
#[derive(Debug, Serialize)]
struct PackedArray {
    edges: Vec<Vec<f64>>,
    values: Option<String>,
    band: Option<String>,
    band_is: Option<&'static str>,
}

#[derive(Debug, Serialize)]
struct Located {
    ticket: u64,
    labels: Vec<Label>,
}

impl Live {
    pub(super) fn new(sweep: &Sweep) -> Self {
        Self {
            detector: sweep.detector(),
            base: Base::new(sweep),
            sessions: Mutex::default(),
            lanes: Lanes::default(),
            mapping: Mapping::default(),
            runs: Runs::default(),
        }
    }

    /// The page that asks this.
    pub(super) fn page(&self) -> Result<String, ExploreError> {
        let sweep = self.base.sweep();
        let edges = |&observable: &Observable| {
            let axes = sweep.problem.axes_of(observable).into_iter();
            axes.map(|axis| axis.edges().to_vec()).collect()
        };
        let told = LivePage {
            live: true,
            typed: Self::typed(sweep),
            dimension: sweep.problem.space().dimension(),
            scene: &Scene::new(sweep, &[]),
            plane: PlaneScene::new(sweep),
            frames: [],
            arrays: (sweep.problem.observables().iter())
                .map(|observable| PackedArray {
                    edges: edges(observable),
                    values: None,
                    band: None,
                    band_is: None,
                })
                .collect(),
        };
        let told = deflate(&serde_json::to_vec(&told)?);
        Ok(html::page(&sweep.settings.title, &told, &[], true))
    }

    /// Cancels whatever is being solved.
    pub(super) fn stop(&self) {
        self.lanes.cancel_all();
    }

    /// The densities at some values of the parameters.
    pub(super) fn solve(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskSolve = read(body)?;
            let bound = self.base.bind(&ask).map_err(Stop::Refused)?;
            let lane = self.lanes.enter(&ask.lane, ask.ticket).ok_or(Stop::Stale)?;
            let clock = Instant::now();
            let mut sessions = self.sessions.lock().unwrap_or_else(PoisonError::into_inner);
            let fresh = |cancellation: &Cancellation| lane.begin(cancellation);
            let point = match sessions.solve(&bound, fresh) {
                Ok(solution) => solution,
                Err(Solving::Stale | Solving::Source(SourceError::Interrupted)) => {
                    return Err(Stop::Stale);
                }
                Err(Solving::Source(error)) => return Err(Stop::Refused(error.to_string())),
                Err(Solving::Open(error)) => return Err(Stop::Refused(error)),
            };
            drop(sessions);
            lane.end();
            let point = self.detected(point, bound.value, clock);
            let grids = point
                .densities
                .iter()
                .map(|density| grid(density, ask.marginals_only));
            Ok(SolveAnswer {
                ticket: ask.ticket,
                arrays: grids.collect(),
                frame: Frame::new(&point, &bound.sweep.settings.family),
                milliseconds: 1e3 * clock.elapsed().as_secs_f64(),
            })
        })
    }

    fn detected(
        &self,
        solution: crate::continuation::Solution<'static>,
        value: f64,
        clock: Instant,
    ) -> Point {
        let mut point = Point::undetected(value, solution);
        point.detect(&self.detector);
        point.seconds = clock.elapsed().as_secs_f64();
        point
    }

    /// The changes of topology between two values of the swept parameter.
    pub(super) fn locate(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskLocate = read(body)?;
            let sweep = self.base.between(&ask).map_err(Stop::Refused)?;
            let lane = self.lanes.enter(&ask.lane, ask.ticket).ok_or(Stop::Stale)?;
            let cancellation = Cancellation::new();
            if !lane.begin(&cancellation) {
                return Err(Stop::Stale);
            }
            let result = sweep
                .run(&cancellation, &mut ())
                .map_err(|error: SolveError| {
                    if cancellation.is_cancelled() {
                        Stop::Stale
                    } else {
                        Stop::Refused(error.to_string())
                    }
                })?;
            if result.interrupted {
                return Err(Stop::Stale);
            }
            lane.end();
            let labels = result.labels.iter();
            let changes = labels.filter(|row| row.bifurcation().is_some());
            Ok(Located {
                ticket: ask.ticket,
                labels: changes
                    .map(|row| Label::new(row, &result.subject))
                    .collect(),
            })
        })
    }

    /// The sweep at these values of the other parameters, as a sweep file.
    pub(super) fn sweep_file(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskSweepFile = read(body)?;
            self.base.sweep_file(&ask.values).map_err(Stop::Refused)
        })
    }
}

/// What a request is told when the program itself is at fault.
const FAULT: &str = "the program met an error of its own at these values, which its terminal shows; other values can go on being asked for";

/// The answer to a request. A panic is one too: it ends neither the server nor other requests. What it may leave behind
/// is not used again: a session is kept only after a solve that came back.
fn answer<T: Serialize>(make: impl FnOnce() -> Result<T, Stop>) -> Vec<u8> {
    let made = catch_unwind(AssertUnwindSafe(make));
    let answer = match made {
        Ok(Ok(done)) => Answer::Done(done),
        Ok(Err(Stop::Refused(reason))) => Answer::Refused(reason),
        Ok(Err(Stop::Stale)) => Answer::Stale(true),
        Err(_) => Answer::Refused(FAULT.to_owned()),
    };
    serde_json::to_vec(&answer).unwrap_or_default()
}

fn read<'b, T: serde::Deserialize<'b>>(body: &'b [u8]) -> Result<T, Stop> {
    serde_json::from_slice(body).map_err(|error| Stop::Refused(error.to_string()))
}

fn grid(estimated: &EstimatedDensity, marginals_only: bool) -> PackedArray {
    let is_marginal = matches!(estimated.observable, Observable::Marginal(_));
    let band = is_marginal.then(|| band(estimated)).flatten();
    let edges = estimated.density.axes.iter();
    PackedArray {
        edges: edges.map(|axis| axis.edges().to_vec()).collect(),
        values: (is_marginal || !marginals_only).then(|| doubles(&estimated.density.values)),
        band_is: band.as_ref().map(|band| band.1),
        band: band.map(|band| doubles(&band.0)),
    }
}

fn doubles(values: &[f64]) -> String {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::panic)]
    fn a_panic_is_an_answer() {
        let told: fn() -> Result<(), Stop> = || panic!("an error of the program");
        let told = String::from_utf8(answer(told)).unwrap();
        assert!(
            told.starts_with("{\"refused\":\"the program met an error"),
            "{told}"
        );
        assert_eq!(answer(|| Ok::<_, Stop>(7)), b"{\"done\":7}");
    }
}
