//! What a session of the generator remembers, as bytes and back: where its solver stands, and the trail of each point.
//!
//! A factorisation is not written: it is made again of the same matrix, which takes less time than reading it would.

use std::sync::Arc;

use super::session::GeneratorSession;
use super::stand::Stand;
use super::trail::{Solved, Trail};
use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::continuation::SourceError;
use crate::generator::Generator;
use crate::method::MethodError;
use crate::stationary::generator::{RateSolver, SolverMemory};

/// The solver as it is now, and the trail that the last solve has left.
pub(super) fn write(solver: &RateSolver, stand: Stand, left: Option<&Trail>) -> Vec<u8> {
    let mut writer = Writer::new();
    writer.optional(stand.factorised).optional(stand.solved);
    solver.memory().write(&mut writer);
    writer.flag(left.is_some());
    if let Some(trail) = left {
        trail.write(&mut writer);
    }
    writer.finish()
}

/// Brings a fresh session to where another one was.
pub(super) fn recall(
    session: &mut GeneratorSession,
    left: &[(f64, &[u8])],
) -> Result<(), SourceError> {
    let mut known: Vec<Arc<Solved>> = Vec::new();
    let mut last = None;
    for (value, bytes) in left {
        let mut reader = Reader::new(bytes);
        if reader.is_at_end() {
            continue;
        }
        let stand = Stand {
            factorised: reader.optional()?,
            solved: reader.optional()?,
        };
        last = Some((stand, SolverMemory::read(&mut reader)?));
        if reader.flag()? {
            let trail = Trail::read(&mut reader, &known)?;
            check(session, &trail)?;
            known.extend(trail.newest().cloned());
            session.keep(*value, trail);
        }
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
