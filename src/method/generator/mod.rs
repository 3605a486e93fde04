//! The generator, solved directly: its settings, what a point costs, what the last points say of the next one, relaxation, the source.

mod cost;
mod one_axis;
mod options;
mod relaxation;
mod source;
mod trail;

pub use cost::GeneratorCost;
pub use options::GeneratorMethodOptions;
pub use source::GeneratorSource;
pub(super) use trail::Trail;
