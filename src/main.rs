//! pbif
fn main() {}
