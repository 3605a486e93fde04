//! What the equations say of a density over one axis, as bytes and back.

use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::density::{Extremum, Profile, SlopeJump, Turn};

pub(super) fn write_profile(writer: &mut Writer, profile: &Profile) {
    let Profile {
        extrema,
        turns,
        jumps,
        curvature,
    } = profile;
    writer.count(extrema.len());
    for one in extrema {
        writer.number(one.place).flag(one.is_peak);
        writer.number(one.density).number(one.gathered_error);
    }
    writer.count(turns.len());
    for one in turns {
        writer.number(one.place).flag(one.is_largest);
        writer.number(one.slope).number(one.error);
    }
    writer.count(jumps.len());
    for one in jumps {
        let [below, above] = one.slopes;
        writer.number(one.place).number(below).number(above);
        writer.number(one.error);
    }
    writer.flag(curvature.is_some());
    if let Some((value, error)) = curvature {
        writer.number(*value).number(*error);
    }
}

pub(super) fn read_profile(reader: &mut Reader<'_>) -> Result<Profile, NotWhatWasWritten> {
    let mut profile = Profile::default();
    for _ in 0..reader.count()? {
        profile.extrema.push(Extremum {
            place: reader.number()?,
            is_peak: reader.flag()?,
            density: reader.number()?,
            gathered_error: reader.number()?,
        });
    }
    for _ in 0..reader.count()? {
        profile.turns.push(Turn {
            place: reader.number()?,
            is_largest: reader.flag()?,
            slope: reader.number()?,
            error: reader.number()?,
        });
    }
    for _ in 0..reader.count()? {
        profile.jumps.push(SlopeJump {
            place: reader.number()?,
            slopes: [reader.number()?, reader.number()?],
            error: reader.number()?,
        });
    }
    if reader.flag()? {
        profile.curvature = Some((reader.number()?, reader.number()?));
    }
    Ok(profile)
}
