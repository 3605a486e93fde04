//! Bounds on what a file may ask for, so that no input can exhaust the stack or the memory.

/// Longest text of one formula, in bytes.
pub(crate) const FORMULA_BYTES: usize = 64 * 1024;
/// Longest text of all definitions together, in bytes.
pub(crate) const DEFINITION_BYTES: usize = 1024 * 1024;
/// Deepest nesting of parentheses, calls, signs and exponents.
pub const NESTING: usize = 64;
/// Longest name, in characters.
pub(crate) const NAME_LENGTH: usize = 64;
/// Most states.
pub const STATES: usize = 64;
/// Most parameters.
pub const PARAMETERS: usize = 1024;
/// Most named definitions.
pub const DEFINITIONS: usize = 1024;
/// Most distinct subexpressions in one scope.
pub const NODES: usize = 1 << 17;
/// Most kinks that are told of one expression.
pub(crate) const KINKS: usize = 256;
/// Longest text that is printed for one expression, in bytes.
pub(crate) const PRINTED_BYTES: usize = 64 * 1024;
/// Most intermediate results that a tape may have to keep at one time.
pub(crate) const REGISTERS: usize = 4096;
