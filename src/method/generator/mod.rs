//! The generator, solved directly: its settings, what the last points say of the next one, relaxation, the source.

mod options;
mod relaxation;
mod source;
mod trail;

pub use options::GeneratorMethodOptions;
pub use source::GeneratorSource;
pub(super) use trail::Trail;
