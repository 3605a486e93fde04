//! Writes sums of powers of one quantity in nested form (Horner): `c0 + c1 x^2 + c2 x^4` becomes
//! `c0 + x² (c1 + x² c2)`, one instruction instead of five.
//!
//! This is the one place where a tape rounds otherwise than the formula is written: by a few units in the last place
//! of the largest term. Even and odd polynomials stay even and odd to the last bit.

use super::values::{Operand, Operation, Values};
use crate::formula::arithmetic::{Binary, Unary};

/// Fewest terms that are worth it.
const FEWEST: usize = 3;
/// Most terms, and highest power.
const MOST: usize = 64;

/// A power of a quantity with its coefficient; `None` for 1.
#[derive(Debug, Clone, Copy)]
struct Term {
    power: u32,
    coefficient: Option<Operand>,
    negative: bool,
}

/// A sum of powers of one quantity.
#[derive(Debug, Clone)]
struct Polynomial {
    /// `None` while there is only a constant.
    base: Option<Operand>,
    terms: Vec<Term>,
    /// Sums that are part of it.
    parts: Vec<u32>,
}

/// Rewrites all polynomials.
pub(super) fn nest(values: Values) -> Values {
    let finder = Finder::new(&values);
    let count = values.operations.len();
    let mut polynomials: Vec<Option<Polynomial>> = Vec::with_capacity(count);
    for value in 0..count {
        let found = finder.polynomial(value, &polynomials);
        polynomials.push(found);
    }
    let mut inside = vec![false; count];
    for value in (0..count).rev() {
        let Some(polynomial) = polynomials[value].take() else {
            continue;
        };
        if inside[value] || !polynomial.is_worth_it() {
            continue;
        }
        // The parts of parts are among the parts.
        for &part in &polynomial.parts {
            inside[part as usize] = true;
        }
        polynomials[value] = Some(polynomial);
    }
    if polynomials.iter().all(Option::is_none) {
        return values;
    }
    rebuild(values, &polynomials, &inside)
}

fn rebuild(mut old: Values, polynomials: &[Option<Polynomial>], inside: &[bool]) -> Values {
    let operations = old.take_operations();
    let mut new: Vec<Operand> = Vec::with_capacity(operations.len());
    for (value, operation) in operations.iter().enumerate() {
        let renamed = |operand: Operand| match operand {
            Operand::Value(value) => new.get(value as usize).copied().unwrap_or(operand),
            _ => operand,
        };
        let operand = match &polynomials[value] {
            // Never looked at.
            _ if inside[value] => Operand::Scalar(0),
            Some(polynomial) => {
                let base = polynomial.base.map_or(Operand::Scalar(0), renamed);
                write(&mut old, polynomial, base)
            }
            None => old.push(operation.map(renamed)),
        };
        new.push(operand);
    }
    for output in &mut old.outputs {
        if let Operand::Value(value) = *output {
            *output = new.get(value as usize).copied().unwrap_or(*output);
        }
    }
    old
}

fn write(values: &mut Values, polynomial: &Polynomial, base: Operand) -> Operand {
    let (lowest, step, degree) = polynomial.shape();
    let zero = values.number(0.0);
    let one = values.number(1.0);
    let mut coefficients = vec![zero; degree + 1];
    for term in &polynomial.terms {
        let coefficient = term.coefficient.unwrap_or(one);
        let place = ((term.power - lowest) / step) as usize;
        coefficients[place] = if term.negative {
            values.negate(coefficient)
        } else {
            coefficient
        };
    }
    let variable = values.integer_power(base, step);
    let sum = values.push_polynomial(variable, coefficients);
    if lowest == 0 {
        return sum;
    }
    let factor = values.integer_power(base, lowest);
    values.push(Operation::Binary(Binary::Multiply, sum, factor))
}

impl Polynomial {
    /// Lowest power, step between powers, and the number of steps to the highest.
    fn shape(&self) -> (u32, u32, usize) {
        let powers = || self.terms.iter().map(|term| term.power);
        let lowest = powers().min().unwrap_or(0);
        let step = powers()
            .fold(0, |step, power| num_integer::gcd(step, power - lowest))
            .max(1);
        let highest = powers().max().unwrap_or(0);
        (lowest, step, ((highest - lowest) / step) as usize)
    }

    /// Whether there are terms enough, and not many more powers than terms.
    fn is_worth_it(&self) -> bool {
        self.base.is_some() && self.terms.len() >= FEWEST && self.shape().2 <= 2 * self.terms.len()
    }

    fn join(mut self, other: Self, negative: bool) -> Option<Self> {
        let base = match (self.base, other.base) {
            (Some(one), Some(other)) if one != other => return None,
            (base, None) | (_, base) => base,
        };
        let clash = |term: &Term| self.terms.iter().any(|own| own.power == term.power);
        if other.terms.iter().any(clash) || self.terms.len() + other.terms.len() > MOST {
            return None;
        }
        let signed = |term: Term| Term {
            negative: term.negative != negative,
            ..term
        };
        self.terms.extend(other.terms.into_iter().map(signed));
        self.parts.extend(other.parts);
        Some(Self { base, ..self })
    }
}

struct Finder<'a> {
    values: &'a Values,
    uses: Vec<u32>,
    /// Every value as a power of a quantity that is not itself a product of equal factors.
    powers: Vec<(Operand, u32)>,
}

impl<'a> Finder<'a> {
    fn new(values: &'a Values) -> Self {
        let mut finder = Self {
            values,
            uses: values.uses(),
            powers: Vec::new(),
        };
        for (value, operation) in values.operations.iter().enumerate() {
            let power = match *operation {
                Operation::Binary(Binary::Multiply, a, b) => finder
                    .power(a)
                    .zip(finder.power(b))
                    .filter(|(a, b)| a.0 == b.0),
                _ => None,
            };
            let power = power.map(|((base, a), (_, b))| (base, a + b));
            let power = power.filter(|(_, power)| *power <= MOST as u32);
            finder
                .powers
                .push(power.unwrap_or((Operand::Value(value as u32), 1)));
        }
        finder
    }

    fn power(&self, operand: Operand) -> Option<(Operand, u32)> {
        match operand {
            Operand::State(_) => Some((operand, 1)),
            Operand::Value(value) => self.powers.get(value as usize).copied(),
            Operand::Scalar(_) => None,
        }
    }

    /// A sum or difference as a polynomial, given those of the values before it.
    fn polynomial(&self, value: usize, before: &[Option<Polynomial>]) -> Option<Polynomial> {
        let (a, b, negative) = match self.values.operations.get(value)? {
            Operation::Binary(Binary::Add, a, b) => (*a, *b, false),
            Operation::Binary(Binary::Subtract, a, b) => (*a, *b, true),
            _ => return None,
        };
        let part = |operand: Operand| {
            if let Operand::Value(value) = operand
                && self.uses.get(value as usize) == Some(&1)
                && let Some(Some(polynomial)) = before.get(value as usize)
            {
                let mut polynomial = polynomial.clone();
                polynomial.parts.push(value);
                return Some(polynomial);
            }
            let (base, term) = self.term(operand, false)?;
            Some(Polynomial {
                base,
                terms: vec![term],
                parts: Vec::new(),
            })
        };
        part(a)?.join(part(b)?, negative)
    }

    fn term(&self, operand: Operand, negative: bool) -> Option<(Option<Operand>, Term)> {
        if let Operand::Scalar(_) = operand {
            return Some((
                None,
                Term {
                    power: 0,
                    coefficient: Some(operand),
                    negative,
                },
            ));
        }
        if let Operand::Value(value) = operand {
            match self.values.operation(value) {
                Operation::Unary(Unary::Negate, inner) if !negative => {
                    return self.term(inner, true);
                }
                Operation::Binary(Binary::Multiply, a, scalar @ Operand::Scalar(_)) => {
                    let (base, power) = self.power(a)?;
                    let term = Term {
                        power,
                        coefficient: Some(scalar),
                        negative,
                    };
                    return Some((Some(base), term));
                }
                _ => {}
            }
        }
        let (base, power) = self.power(operand)?;
        Some((
            Some(base),
            Term {
                power,
                coefficient: None,
                negative,
            },
        ))
    }
}
