//! Steady states of transition matrices.
