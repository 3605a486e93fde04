//! Whether a sweep fits into the memory of the machine, and into what the system gives this process; and whether it
//! takes long.

use super::diagnostic::Diagnostic;
use super::memory::{bytes_in_words, has_room, machine_memory};
use super::names::list;
use super::report::Report;
use super::settings::{AxisSettings, Modes, Settings};
use super::sweep::Sweep;
use crate::density::BINS_OF_A_TURN;
use crate::method::Cost;
use crate::stationary::generator::RateError;

/// Room that is tried for at least, in units of what a point takes: finer cells check what is located.
const TRIED: f64 = 3.0;
/// Bytes of half a machine whose memory is not known.
const SMALL_MACHINE: f64 = 2e9;
/// Bytes beside it: what is read and drawn.
const BESIDE: f64 = 1e8;
/// Bytes that each thread takes: room for products of matrices (64 MiB), a heap of its own (as much, and as much again
/// while it is laid out at a multiple of its size), its stack.
const A_THREAD: f64 = 2.2e8;

/// Seconds of a factorisation from which it is told before a sweep begins.
const LONG: f64 = 2.0;

impl Sweep {
    /// What is said of factorisations that take long, after what the method is; empty where none does.
    pub(crate) fn long_factorisation(&self) -> String {
        match self.settings.method.chosen().cost(self.problem.space()) {
            Ok(Cost::Generator(cost)) if cost.factorisation_seconds() > LONG => format!(
                "; a factorisation takes about {:.0} s on two cores, and fewer cells take less (`cells.accuracy`, or \
                 `count`)",
                cost.factorisation_seconds()
            ),
            _ => String::new(),
        }
    }
}

impl Settings {
    /// Unknowns along each axis as the method has it; a few modes where their number is left to the program.
    fn unknowns(&self) -> Vec<usize> {
        let axes = self.axes.iter();
        axes.map(|axis| match axis.modes_by(self.method.kind) {
            Some(Modes::Number(count)) => count,
            Some(Modes::Auto) => 4,
            None if axis.is_cut(self.method.kind) => axis.count.unwrap_or(1),
            None => BINS_OF_A_TURN,
        })
        .collect()
    }

    /// Refuses what the system would not give.
    fn check_given(&self, at_work: f64, kept: f64) -> Result<(), Report> {
        // What is more than the machine has is told elsewhere, and may be a bound that is never reached.
        let most = machine_memory().map_or(SMALL_MACHINE, |memory| 0.5 * memory);
        let beside = BESIDE + A_THREAD * rayon::current_num_threads() as f64;
        let bytes = (at_work + kept + beside).min(most);
        if has_room(bytes) {
            return Ok(());
        }
        let title = format!(
            "a sweep may take {} of memory, and the system gives this process less",
            bytes_in_words(bytes)
        );
        let remedy = "use fewer cells, fewer points or `--threads`, or a higher limit (`ulimit -v`, or that of the batch job)";
        Err(self.refuse_cells(Diagnostic::new(title).remedy(remedy)))
    }

    /// Refuses cells whose least need exceeds the machine's memory; runs before anything is laid out.
    pub(super) fn check_memory(&self) -> Result<(), Report> {
        let is_open = |axis: &AxisSettings| axis.count.is_none() && axis.is_cut(self.method.kind);
        if self.axes.iter().any(is_open) {
            return Ok(());
        }
        let unknowns = self.unknowns();
        let n_cells: f64 = unknowns.iter().map(|&count| count as f64).product();
        let least = self.method.chosen().least_bytes(n_cells, self.axes.len());
        let Some(memory) = machine_memory().filter(|&memory| least > memory) else {
            return Ok(());
        };
        let counts: Vec<String> = unknowns.iter().map(usize::to_string).collect();
        let title = format!(
            "{} cells need at least {} of memory; this machine has {}",
            counts.join(" × "),
            bytes_in_words(least),
            bytes_in_words(memory)
        );
        let axes =
            (0..self.axes.len()).map(|axis| format!("cells.{}.count", self.family.axis(axis)));
        let keys: Vec<String> = axes.collect();
        let diagnostic = Diagnostic::new(title).remedy(format!("lower one of {}", list(&keys)));
        Err(self.refuse_cells(diagnostic))
    }

    /// Refuses cells whose factors exceed the memory that they may take, or that the system gives this process.
    pub(super) fn check_factors(&self, sweep: &Sweep) -> Result<(), Report> {
        let error = match self.method.chosen().cost(sweep.problem.space()) {
            Ok(cost) => {
                let at_work = (sweep.sessions() as f64).max(TRIED) * cost.most_bytes();
                return self.check_given(at_work, sweep.kept_bytes());
            }
            Err(error) => error,
        };
        let memory = machine_memory();
        let has = memory.map(|memory| format!("; this machine has {}", bytes_in_words(memory)));
        // A limit beyond the machine's memory would only let it swap.
        let fits = match (&error, memory) {
            (RateError::Memory { needed, .. }, Some(memory)) => *needed as f64 <= memory,
            _ => true,
        };
        let mut remedy = "use fewer cells".to_owned();
        if fits {
            remedy += ", or raise `method.memory_limit` (gigabytes)";
        }
        remedy += &has.unwrap_or_default();
        Err(self.refuse_cells(Diagnostic::new(error.to_string()).remedy(remedy)))
    }
}
