//! Maps of the plane that a live page asks for: made while the page waits, and how far they are.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;
use serde_json::json;

use super::ask::{AskMap, AskMapProgress};
use super::{Live, Stop, answer, read};
use crate::cancellation::Cancellation;
use crate::continuation::SourceError;
use crate::continuation::map::MapProgress;
use crate::explore::plane::PlaneScene;

/// How far the maps in the making are, by their lanes.
#[derive(Debug, Default)]
pub(super) struct Mapping {
    lanes: Mutex<BTreeMap<String, MappingState>>,
}

/// How far a map is.
#[derive(Debug, Default, Clone, Copy, Serialize)]
struct MappingState {
    /// Nodes that are solved.
    nodes: usize,
    /// Nodes that are known to be wanted.
    wanted: usize,
    /// Points of curves that were met.
    points: usize,
}

impl Mapping {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, MappingState>> {
        self.lanes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self, lane: &str, told: &MapProgress<'_>) {
        let mut lanes = self.lock();
        // A map that was given up goes on for a moment; it is not told of any more.
        let Some(progress) = lanes.get_mut(lane) else {
            return;
        };
        match *told {
            MapProgress::Solved { done, wanted, .. } => {
                progress.nodes = progress.nodes.max(done);
                progress.wanted = wanted;
            }
            MapProgress::Met { done, .. } => progress.points = progress.points.max(done),
        }
    }
}

impl Live {
    /// The map of the plane, as soon as it is made; nothing where it was given up.
    pub(in crate::explore) fn map(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskMap = read(body)?;
            let sweep = self.base.at(&ask.values).map_err(Stop::Refused)?;
            let lane = self.lanes.enter(&ask.lane, ask.ticket).ok_or(Stop::Stale)?;
            let cancellation = Cancellation::new();
            if ask.stop || !lane.begin(&cancellation) {
                self.mapping.lock().remove(&ask.lane);
                return Err(Stop::Stale);
            }
            self.mapping
                .lock()
                .insert(ask.lane.clone(), MappingState::default());
            let made = sweep.map(&cancellation, &|told| self.mapping.tell(&ask.lane, told));
            if cancellation.is_cancelled() {
                return Err(Stop::Stale);
            }
            lane.end();
            self.mapping.lock().remove(&ask.lane);
            let map = match made {
                Ok(Some(map)) => map,
                Ok(None) => {
                    return Err(Stop::Refused(
                        "the sweep file has no section [map]".to_owned(),
                    ));
                }
                Err(SourceError::Interrupted) => return Err(Stop::Stale),
                Err(error) => return Err(Stop::Refused(error.to_string())),
            };
            let plane = PlaneScene::of(&map.plane, &map.subject.family);
            let plane = plane.with(
                &map.subject,
                &map.nodes,
                (&map.curves, &map.levels, "start"),
            );
            Ok(plane.found)
        })
    }

    /// How far the map of a lane is; nothing where none is in the making.
    pub(in crate::explore) fn map_progress(&self, body: &[u8]) -> Vec<u8> {
        answer(|| {
            let ask: AskMapProgress = read(body)?;
            let state = self.mapping.lock().get(&ask.lane).copied();
            Ok(json!(state))
        })
    }
}
