//! Runs a tape.

use std::cell::RefCell;

use multiversion::multiversion;

use super::instruction::{Instruction, Source, Step};
use super::kernel::{
    All, Each, Lane, binary, multiply_add, polynomial, product, two_products, unary, write,
};
use super::values::{Operand, Scalars};
use crate::formula::arithmetic::select;
use crate::formula::{LANES, Lanes};

/// Expressions with bound parameters, ready to run. It may be run from any number of threads at a time.
#[derive(Debug, Clone)]
pub struct Tape {
    pub(super) steps: Vec<Step>,
    pub(super) scalars: Scalars,
    pub(super) coefficients: Vec<Vec<u32>>,
    pub(super) fixed: Vec<Option<f64>>,
    pub(super) states: usize,
    pub(super) registers: usize,
}

/// Room for intermediate results. It grows to what a tape needs and is then reused.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    registers: Vec<Room>,
    scalars: Vec<f64>,
}

/// A register. Vector instructions are fastest on whole cache lines.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Room(Lanes);

thread_local! {
    /// Each thread's own room, so that [`Tape::run`] needs none from its caller and allocates once a thread.
    static WORKSPACE: RefCell<Workspace> = const {
        RefCell::new(Workspace { registers: Vec::new(), scalars: Vec::new() })
    };
}

impl Tape {
    /// Number of passes over the lanes.
    pub fn instructions(&self) -> usize {
        self.steps.len()
    }

    /// Number of intermediate results kept at one time, each of [`LANES`] numbers.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// The value of an expression that depends on neither state nor time.
    pub(crate) fn constant(&self, output: usize) -> Option<f64> {
        self.fixed.get(output).copied().flatten()
    }

    /// Values of all expressions for a batch of states: `states[axis][lane]` in, `outputs[expression][lane]` out.
    /// With fewer states or places than the tape has, all outputs are NaN.
    pub fn run(&self, time: f64, states: &[Lanes], outputs: &mut [Lanes]) {
        let done = WORKSPACE.try_with(|workspace| {
            let mut workspace = workspace.try_borrow_mut().ok()?;
            self.run_with(&mut workspace, time, states, outputs);
            Some(())
        });
        // A thread that is ending has no room left.
        if !matches!(done, Ok(Some(()))) {
            self.run_with(&mut Workspace::default(), time, states, outputs);
        }
    }

    /// As [`Tape::run`], in a room of the caller's.
    pub(crate) fn run_with(
        &self,
        workspace: &mut Workspace,
        time: f64,
        states: &[Lanes],
        outputs: &mut [Lanes],
    ) {
        let (Some(states), Some(outputs)) = (
            states.get(..self.states),
            outputs.get_mut(..self.fixed.len()),
        ) else {
            outputs.fill([f64::NAN; LANES]);
            return;
        };
        if workspace.registers.len() < self.registers {
            workspace
                .registers
                .resize(self.registers, Room([0.0; LANES]));
        }
        let registers = &mut workspace.registers[..self.registers];
        let scalars = if self.scalars.time.is_none() {
            &self.scalars.values[..]
        } else {
            self.at_time(time, &mut workspace.scalars);
            &workspace.scalars[..]
        };
        let numbers = Numbers {
            scalars,
            coefficients: &self.coefficients,
        };
        execute(&self.steps, numbers, states, registers, outputs);
    }

    /// All numbers that are the same in all lanes, at this time.
    fn at_time(&self, time: f64, scalars: &mut Vec<f64>) {
        scalars.clear();
        scalars.extend_from_slice(&self.scalars.values);
        if let Some(place) = self
            .scalars
            .time
            .and_then(|place| scalars.get_mut(place as usize))
        {
            *place = time;
        }
        for (place, operation) in &self.scalars.clock {
            let value = operation.apply(|operand| match operand {
                Operand::Scalar(place) => scalars.get(place as usize).copied().unwrap_or(f64::NAN),
                _ => f64::NAN,
            });
            if let Some(place) = scalars.get_mut(*place as usize) {
                *place = value;
            }
        }
    }

    /// Values of all expressions at one state.
    pub fn at(&self, time: f64, state: &[f64]) -> Vec<f64> {
        let states: Vec<Lanes> = state.iter().map(|&value| [value; LANES]).collect();
        let mut outputs = vec![[0.0; LANES]; self.fixed.len()];
        self.run(time, &states, &mut outputs);
        outputs.iter().map(|lanes| lanes[0]).collect()
    }
}

/// Numbers that are the same in all lanes.
#[derive(Clone, Copy)]
struct Numbers<'a> {
    scalars: &'a [f64],
    coefficients: &'a [Vec<u32>],
}

impl Numbers<'_> {
    #[inline(always)]
    fn scalar(&self, place: u32) -> f64 {
        self.scalars
            .get(place as usize)
            .copied()
            .unwrap_or(f64::NAN)
    }
}

/// Everything an instruction may read.
struct Frame<'a> {
    numbers: Numbers<'a>,
    states: &'a [Lanes],
    /// The registers before the target, and those after it.
    before: &'a [Room],
    after: &'a [Room],
}

static NOTHING: Lanes = [0.0; LANES];

impl Frame<'_> {
    #[inline(always)]
    fn lanes(&self, place: u16) -> &Lanes {
        let place = place as usize;
        if let Some(state) = self.states.get(place) {
            return state;
        }
        let register = place - self.states.len();
        let room = self
            .before
            .get(register)
            .or_else(|| self.after.get(register.wrapping_sub(self.before.len() + 1)));
        room.map_or(&NOTHING, |room| &room.0)
    }

    #[inline(always)]
    fn scalar(&self, place: u32) -> f64 {
        self.numbers.scalar(place)
    }

    /// Lanes of an operand that is never a scalar.
    #[inline(always)]
    fn source(&self, source: Source) -> &Lanes {
        match source {
            Source::Lanes(place) => self.lanes(place),
            Source::Scalar(_) => &NOTHING,
        }
    }
}

/// Runs a body for an operand of either kind.
macro_rules! with {
    ($frame:ident, $source:expr, $name:ident => $body:expr) => {
        match $source {
            Source::Lanes(place) => {
                let $name = Each($frame.lanes(place));
                $body
            }
            Source::Scalar(place) => {
                let $name = All($frame.scalar(place));
                $body
            }
        }
    };
}

// Its bodies are the largest of the program: only instruction sets that are measurably faster have one.
#[multiversion(targets(
    "x86_64+avx+avx2+avx512bw+avx512cd+avx512dq+avx512f+avx512vl+bmi1+bmi2+fma",
    "x86_64+avx+avx2+bmi1+bmi2+fma"
))]
fn execute(
    steps: &[Step],
    numbers: Numbers<'_>,
    states: &[Lanes],
    registers: &mut [Room],
    outputs: &mut [Lanes],
) {
    for step in steps {
        let target = step.target as usize;
        let (before, target, after) = if step.is_output {
            let Some(target) = outputs.get_mut(target) else {
                return;
            };
            (&*registers, target, &[][..])
        } else {
            let Some((before, rest)) = registers.split_at_mut_checked(target) else {
                return;
            };
            let Some((target, after)) = rest.split_first_mut() else {
                return;
            };
            (&*before, &mut target.0, &*after)
        };
        let frame = Frame {
            numbers,
            states,
            before,
            after,
        };
        perform(&frame, &step.instruction, target);
    }
}

#[inline(always)]
fn perform(frame: &Frame<'_>, instruction: &Instruction<Source>, target: &mut Lanes) {
    // By reference: a copy of the instruction is written in parts and read as a whole, which stalls.
    match *instruction {
        Instruction::Copy(a) => with!(frame, a, a => write(target, |lane| a.at(lane))),
        Instruction::Unary(operation, a) => match a {
            Source::Lanes(place) => unary(operation, target, frame.lanes(place)),
            Source::Scalar(place) => target.fill(operation.apply(frame.scalar(place))),
        },
        Instruction::Binary(operation, a, b) => match (a, b) {
            (Source::Lanes(a), b) => {
                let a = Each(frame.lanes(a));
                with!(frame, b, b => binary(operation, target, a, b));
            }
            (Source::Scalar(a), b) => {
                let a = All(frame.scalar(a));
                binary(operation, target, a, Each(frame.source(b)));
            }
        },
        Instruction::Select(condition, yes, no) => with!(frame, condition, condition => {
            with!(frame, yes, yes => with!(frame, no, no => {
                write(target, |lane| select(condition.at(lane), yes.at(lane), no.at(lane)));
            }));
        }),
        Instruction::Product(factor, a, b) => {
            let a = frame.source(a);
            with!(frame, b, b => product(factor, target, a, b));
        }
        Instruction::MultiplyAdd(signs, factor, [a, b, c]) => {
            let a = frame.source(a);
            with!(frame, b, b => with!(frame, c, c => {
                multiply_add(signs, factor, target, (a, b), c);
            }));
        }
        Instruction::TwoProducts(signs, [a, b, c, d]) => {
            let (a, c) = (frame.source(a), frame.source(c));
            with!(frame, b, b => with!(frame, d, d => {
                two_products(signs, target, (a, b), (c, d));
            }));
        }
        Instruction::Polynomial(a, list) => {
            let Some(list) = frame.numbers.coefficients.get(list as usize) else {
                return;
            };
            polynomial(target, frame.source(a), list, |place| frame.scalar(place));
        }
    }
}
