//! Puts instructions in an order that keeps few results alive, and results into registers.

use super::fuse::Fused;
use super::instruction::{Instruction, Source, Step};
use super::run::Tape;
use super::values::{Operand, Values};
use crate::formula::limits;

/// Where a value is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Storage {
    Register(usize),
    /// An output that no other value needs.
    Output(usize),
}

/// Makes the tape; `None` where it keeps too many results at one time.
pub(super) fn allocate(values: Values, fused: Fused, states: usize) -> Option<Tape> {
    let order = order(&values, &fused);
    let places = Places::new(&values, &fused, &order);
    if places.registers > limits::REGISTERS || values.outputs.len() > limits::REGISTERS {
        return None;
    }
    let source = |operand: Operand| match operand {
        Operand::State(state) => Source::Lanes(state),
        Operand::Scalar(place) => Source::Scalar(place),
        Operand::Value(value) => match places.of[value as usize] {
            Some(Storage::Register(register)) => Source::Lanes((states + register) as u16),
            _ => Source::Lanes(u16::MAX),
        },
    };
    let to_output = |instruction, output: usize| Step {
        instruction,
        target: output as u16,
        is_output: true,
    };
    let mut steps = Vec::with_capacity(order.len() + values.outputs.len());
    for &value in &order {
        let Some(instruction) = fused[value] else {
            continue;
        };
        let instruction = instruction.map(source);
        match places.of[value] {
            Some(Storage::Output(output)) => steps.push(to_output(instruction, output)),
            Some(Storage::Register(register)) => {
                steps.push(Step {
                    instruction,
                    target: register as u16,
                    is_output: false,
                });
                // Copied as soon as it is there, before its register is used again.
                let copy = Instruction::Copy(source(Operand::Value(value as u32)));
                let outputs = places.outputs[value].iter();
                steps.extend(outputs.map(|&output| to_output(copy, output)));
            }
            None => {}
        }
    }
    for (output, &operand) in values.outputs.iter().enumerate() {
        if !matches!(operand, Operand::Value(_)) {
            steps.push(to_output(Instruction::Copy(source(operand)), output));
        }
    }
    let fixed = values
        .outputs
        .iter()
        .map(|&output| values.fixed(output))
        .collect();
    let registers = places.registers;
    Some(Tape {
        steps,
        scalars: values.scalars,
        coefficients: values.coefficients,
        fixed,
        states,
        registers,
    })
}

/// Where all values are kept.
struct Places {
    of: Vec<Option<Storage>>,
    /// The outputs that each value is.
    outputs: Vec<Vec<usize>>,
    registers: usize,
}

impl Places {
    fn new(values: &Values, fused: &Fused, order: &[usize]) -> Self {
        let mut last_use = vec![None; fused.len()];
        for (position, &value) in order.iter().enumerate() {
            for operand in values_in(fused, value) {
                last_use[operand] = Some(position);
            }
        }
        let mut outputs: Vec<Vec<usize>> = vec![Vec::new(); fused.len()];
        for (output, &operand) in values.outputs.iter().enumerate() {
            if let Operand::Value(value) = operand {
                outputs[value as usize].push(output);
            }
        }
        let mut places = Self {
            of: vec![None; fused.len()],
            outputs,
            registers: 0,
        };
        let mut free = Vec::new();
        for (position, &value) in order.iter().enumerate() {
            // The result's register is taken before those of the operands are given back, so that no instruction
            // writes what it reads.
            let place = match (&places.outputs[value][..], last_use[value]) {
                (&[output], None) => Storage::Output(output),
                _ => Storage::Register(free.pop().unwrap_or_else(|| {
                    places.registers += 1;
                    places.registers - 1
                })),
            };
            places.of[value] = Some(place);
            let mut done = values_in(fused, value);
            done.retain(|&operand| last_use[operand] == Some(position));
            if last_use[value].is_none() {
                done.push(value);
            }
            done.sort_unstable();
            done.dedup();
            for value in done {
                if let Some(Storage::Register(register)) = places.of[value] {
                    free.push(register);
                }
            }
        }
        places
    }
}

/// The values that an instruction works on.
fn values_in(fused: &Fused, value: usize) -> Vec<usize> {
    let operands = fused[value].map_or_else(Vec::new, Instruction::operands);
    let values = operands.into_iter().filter_map(|operand| match operand {
        Operand::Value(value) => Some(value as usize),
        _ => None,
    });
    values.collect()
}

/// Operands before what needs them, and of two operands the one first that keeps more registers busy.
fn order(values: &Values, fused: &Fused) -> Vec<usize> {
    // Sethi and Ullman's number of registers, exact for trees.
    let mut need = vec![1_usize; fused.len()];
    let by_need = |operands: &mut Vec<usize>, need: &[usize]| {
        operands.sort_unstable();
        operands.dedup();
        operands.sort_by_key(|&operand| std::cmp::Reverse(need[operand]));
    };
    for value in 0..fused.len() {
        let mut operands = values_in(fused, value);
        by_need(&mut operands, &need);
        let busy = operands
            .iter()
            .enumerate()
            .map(|(held, &operand)| held + need[operand]);
        need[value] = busy.max().unwrap_or(1).max(1);
    }
    let mut placed = vec![false; fused.len()];
    let mut order = Vec::new();
    for &output in &values.outputs {
        let Operand::Value(root) = output else {
            continue;
        };
        // A value comes twice: when its operands are still to do, and when they are done.
        let mut path = vec![(root as usize, false)];
        while let Some((value, done)) = path.pop() {
            if placed[value] {
                continue;
            }
            if done {
                placed[value] = true;
                order.push(value);
                continue;
            }
            path.push((value, true));
            let mut operands = values_in(fused, value);
            by_need(&mut operands, &need);
            path.extend(operands.into_iter().rev().map(|operand| (operand, false)));
        }
    }
    order
}
