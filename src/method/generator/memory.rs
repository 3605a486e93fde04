//! What a session of the generator remembers, as bytes and back: where its solver stands, and the trail of each point.
//!
//! A factorisation is not written: it is made again of the same matrix, which takes less time than reading it would.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::relaxation::Relaxation;
use super::session::GeneratorSession;
use super::stand::Stand;
use super::trail::{News, Trail, TrailPoint};
use crate::bytes::{NotWhatWasWritten, from_bytes, to_bytes};
use crate::continuation::SourceError;
use crate::generator::Generator;
use crate::method::MethodError;
use crate::stationary::generator::SolverMemory;

/// What a solve leaves in its session.
#[derive(Serialize, Deserialize)]
struct SessionMemory<Trail> {
    stand: Stand,
    solver: SolverMemory,
    trail: Option<Trail>,
}

/// The solver as it is now, and the trail that the last solve has left.
pub(super) fn write(session: &GeneratorSession) -> Vec<u8> {
    let left = session.trails.newest().filter(|_| session.has_left);
    to_bytes(&SessionMemory {
        stand: session.stand,
        solver: session.solver.memory(),
        trail: left.map(|(_, trail)| trail.news()),
    })
}

/// Brings a fresh session to where another one was.
pub(super) fn recall(
    session: &mut GeneratorSession,
    left: &[(f64, &[u8])],
) -> Result<(), SourceError> {
    let mut known: Vec<Arc<TrailPoint>> = Vec::new();
    let mut last = None;
    for (value, bytes) in left.iter().filter(|(_, bytes)| !bytes.is_empty()) {
        let left: SessionMemory<News<TrailPoint, Relaxation>> = from_bytes(bytes)?;
        if let Some(news) = left.trail {
            let trail = Trail::of_news(news, &known).ok_or(NotWhatWasWritten)?;
            check(session, &trail)?;
            known.extend(trail.newest().cloned());
            session.keep(*value, trail);
        }
        last = Some((left.stand, left.solver));
    }
    if let Some((stand, solver)) = last {
        session.stand = stand;
        restore(session, &solver)?;
    }
    Ok(())
}

/// Refuses vectors that are not on the cells of the source.
fn check(session: &GeneratorSession, trail: &Trail) -> Result<(), NotWhatWasWritten> {
    let cells = session.source.problem.space().n_cells();
    let fits = trail.lengths().iter().all(|&length| length == cells);
    fits.then_some(()).ok_or(NotWhatWasWritten)
}

fn restore(session: &mut GeneratorSession, solver: &SolverMemory) -> Result<(), MethodError> {
    let factorised = at(session, session.stand.factorised)?;
    let solved = at(session, session.stand.solved)?;
    let solved = solved.map(|generator| (generator.matrix, generator.escape));
    let factorised = factorised.map(|generator| generator.matrix);
    session
        .solver
        .restore(solver, factorised.as_ref(), solved)?;
    Ok(())
}

fn at(session: &GeneratorSession, value: Option<f64>) -> Result<Option<Generator>, MethodError> {
    let Some(value) = value else {
        return Ok(None);
    };
    let source = &session.source;
    let system = source.system_at(value)?;
    Ok(Some(
        source.assemble(system.as_ref(), source.options.scheme)?,
    ))
}
