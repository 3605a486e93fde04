//! What a check of a located value saw, as bytes and back.

use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::continuation::{CheckedBy, CheckedIndicator, KeptCheck};
use crate::topology::IndicatorKind;

/// All of it.
pub(super) fn write(writer: &mut Writer, check: &KeptCheck) {
    let seen = &check.seen;
    writer.text(seen.by.name()).text(seen.kind.code());
    writer.number(seen.value).count(seen.observable);
    writer.numbers(&seen.place).optional(seen.indicator);
    writer.flag(seen.failure.is_some());
    writer.text(seen.failure.as_deref().unwrap_or_default());
    writer.flag(check.left.is_some());
    writer.bytes(check.left.as_deref().unwrap_or_default());
}

/// What was written.
pub(super) fn read(reader: &mut Reader<'_>) -> Result<KeptCheck, NotWhatWasWritten> {
    let (by, kind) = (reader.text()?, reader.text()?);
    let by = CheckedBy::ALL.into_iter().find(|one| one.name() == by);
    let seen = CheckedIndicator {
        by: by.ok_or(NotWhatWasWritten)?,
        kind: IndicatorKind::of_code(kind).ok_or(NotWhatWasWritten)?,
        value: reader.number()?,
        observable: reader.count()?,
        place: reader.numbers()?,
        indicator: reader.optional()?,
        failure: {
            let there = reader.flag()?;
            let words = reader.text()?;
            there.then(|| words.to_owned())
        },
    };
    let there = reader.flag()?;
    let left = reader.bytes()?;
    Ok(KeptCheck {
        seen,
        left: there.then(|| left.to_vec()),
    })
}
