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
use serde_json::{Value, json};

use super::ExploreError;
use super::compose::edges;
use super::frame::{band, frame};
use super::html;
use super::pack::deflate;
use super::plane::PlaneScene;
use super::scene::{label, scene};
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

/// Why there is no answer.
enum Stop {
    Refused(String),
    Stale,
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
        let arrays = sweep.problem.observables().iter().map(|&observable| {
            let axes = sweep.problem.axes_of(observable);
            let edges = edges(&axes);
            json!({ "edges": edges, "values": null, "band": null, "band_is": null })
        });
        let mut told = scene(sweep, &[], &[]);
        told["live"] = json!(true);
        // The sweep file that its editor begins with.
        told["typed"] = json!(Self::typed(sweep));
        told["dimension"] = json!(sweep.problem.space().dimension());
        told["plane"] = PlaneScene::new(sweep).map_or(Value::Null, |plane| plane.told());
        told["frames"] = json!([]);
        told["arrays"] = arrays.collect();
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
            let densities = point.densities.iter();
            let grids = densities.map(|density| grid(density, ask.marginals_only));
            Ok(json!({
                "ticket": ask.ticket,
                "frame": frame(&point, &bound.sweep.settings.family),
                "arrays": grids.collect::<Vec<_>>(),
                "milliseconds": 1e3 * clock.elapsed().as_secs_f64(),
            }))
        })
    }

    /// Takes a place in a lane, with what stops the work that begins.
    fn begin<'l>(
        &'l self,
        lane: &'l str,
        ticket: u64,
    ) -> Result<(lanes::Slot<'l>, Cancellation), Stop> {
        let slot = self.lanes.enter(lane, ticket).ok_or(Stop::Stale)?;
        let cancellation = Cancellation::new();
        let has_begun = slot.begin(&cancellation);
        has_begun.then_some((slot, cancellation)).ok_or(Stop::Stale)
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
            let (lane, cancellation) = self.begin(&ask.lane, ask.ticket)?;
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
            let changes = changes.map(|row| label(row, &result.subject));
            Ok(json!({ "ticket": ask.ticket, "labels": changes.collect::<Vec<_>>() }))
        })
    }

    /// The sweep at these values of the other parameters, as a sweep file.
    pub(super) fn sweep_file(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskSweepFile = read(body)?;
            let text = self.base.sweep_file(&ask.values).map_err(Stop::Refused)?;
            Ok(text.into())
        })
    }
}

/// What a request is told when the program itself is at fault.
const FAULT: &str = "the program met an error of its own at these values, which its terminal shows; other values can go on being asked for";

/// The answer to a request, as JSON: what was asked for, why not, for people, or that a newer request has taken its
/// place. That a value is refused or a request stale is an answer like others: browsers write failures into their
/// consoles. A panic is one too: it ends neither the server nor other requests. What it may leave behind is not used
/// again: a session is kept only after a solve that came back.
fn answer(make: impl FnOnce() -> Result<Value, Stop>) -> Vec<u8> {
    let answer = match catch_unwind(AssertUnwindSafe(make)) {
        Ok(Ok(done)) => json!({ "done": done }),
        Ok(Err(Stop::Refused(reason))) => json!({ "refused": reason }),
        Ok(Err(Stop::Stale)) => json!({ "stale": true }),
        Err(_) => json!({ "refused": FAULT }),
    };
    answer.to_string().into_bytes()
}

fn read<'b, T: serde::Deserialize<'b>>(body: &'b [u8]) -> Result<T, Stop> {
    serde_json::from_slice(body).map_err(|error| Stop::Refused(error.to_string()))
}

/// The cells of a watched density, with its values and band as little-endian doubles in base64; null where they were
/// not asked for.
fn grid(estimated: &EstimatedDensity, marginals_only: bool) -> Value {
    let is_marginal = matches!(estimated.observable, Observable::Marginal(_));
    let band = is_marginal.then(|| band(estimated)).flatten();
    json!({
        "edges": edges(&estimated.density.axes),
        "values": (is_marginal || !marginals_only).then(|| doubles(&estimated.density.values)),
        "band": band.as_ref().map(|band| doubles(&band.0)),
        "band_is": band.map(|band| band.1),
    })
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
        let told: fn() -> Result<Value, Stop> = || panic!("an error of the program");
        let told = String::from_utf8(answer(told)).unwrap();
        assert!(
            told.starts_with("{\"refused\":\"the program met an error"),
            "{told}"
        );
        assert_eq!(answer(|| Ok(json!(7))), b"{\"done\":7}");
    }
}
