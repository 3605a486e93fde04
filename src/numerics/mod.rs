//! Numerical routines that several rooms share.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

mod limit;
pub(crate) use limit::limit_at_zero;

/// a·b, in a fixed order of eight sums, which run at once: the same everywhere.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = left.remainder().iter().zip(right.remainder());
    let tail: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in left.zip(right) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + tail
}

/// y ← y + factor x.
pub(crate) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (slot, value) in y.iter_mut().zip(x) {
        *slot += factor * value;
    }
}

/// Σ |a - b|.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}

/// The smallest and the largest of some numbers; infinite, the first above the second, of none.
pub(crate) fn ends_of(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    })
}

/// What `make` gives of each number below `count`, in their order, made on all threads: coarse tasks, one a number. The
/// error of the first that has one; then those that are not begun are left out.
pub(crate) fn in_parallel<T: Send, E: Send>(
    count: usize,
    make: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let slots: Vec<Mutex<Option<Result<T, E>>>> = (0..count).map(|_| Mutex::default()).collect();
    let has_failed = AtomicBool::new(false);
    for_each_number(count, &|number| {
        if has_failed.load(Ordering::Relaxed) {
            return;
        }
        let made = make(number);
        has_failed.fetch_or(made.is_err(), Ordering::Relaxed);
        *slots[number].lock().unwrap_or_else(PoisonError::into_inner) = Some(made);
    });
    let made = slots.into_iter().map(Mutex::into_inner);
    made.filter_map(|made| made.unwrap_or_else(PoisonError::into_inner))
        .collect()
}

/// What divides work among threads is compiled once for all coarse tasks.
#[inline(never)]
fn for_each_number(count: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(task);
}

/// A bracket narrowed by halving, so often or until its ends are neighbouring numbers: where `is_first` holds in its
/// middle, that takes the place of its first end, else that of its second one.
pub(crate) fn narrowed(
    (mut first, mut second): (f64, f64),
    halvings: usize,
    mut is_first: impl FnMut(f64) -> bool,
) -> (f64, f64) {
    for _ in 0..halvings {
        let middle = 0.5 * (first + second);
        if middle == first || middle == second {
            break;
        }
        if is_first(middle) {
            first = middle;
        } else {
            second = middle;
        }
    }
    (first, second)
}

/// The middle of a bracket that is [`narrowed`].
pub(crate) fn bisected(
    ends: (f64, f64),
    halvings: usize,
    is_first: impl FnMut(f64) -> bool,
) -> f64 {
    let (first, second) = narrowed(ends, halvings, is_first);
    0.5 * (first + second)
}

/// Sorts by a number of each item, the smallest first; items of equal numbers stay in their order.
pub(crate) fn sort_ascending<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let numbers: Vec<f64> = items.iter().map(number).collect();
    put_in(order_of(&numbers), items);
}

/// Sorts by a number of each item, the largest first; items of equal numbers stay in their order.
pub(crate) fn sort_descending<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    sort_ascending(items, |item| -number(item));
}

/// The places of numbers, that of the smallest first.
#[inline(never)]
fn order_of(numbers: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
    order
}

/// Puts items in an order that is given by their places, one cycle of it after the other.
fn put_in<T>(mut order: Vec<usize>, items: &mut [T]) {
    for first in 0..order.len() {
        let mut place = first;
        while order[place] != first {
            let next = std::mem::replace(&mut order[place], place);
            items.swap(place, next);
            place = next;
        }
        order[place] = place;
    }
}

/// Variance of a number from its values without one group of samples each (Tukey's jackknife).
pub(crate) fn jackknife_variance(without: impl Iterator<Item = f64> + Clone) -> f64 {
    let groups = without.clone().count() as f64;
    let mean = without.clone().sum::<f64>() / groups;
    let squares: f64 = without.map(|value| (value - mean).powi(2)).sum();
    (groups - 1.0) / groups * squares
}

/// Standard error of a number: the root of its [`jackknife_variance`].
pub(crate) fn jackknife(without: impl Iterator<Item = f64> + Clone) -> f64 {
    jackknife_variance(without).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_ends_at_neighbouring_numbers_on_both_sides() {
        let (below, above) = narrowed((0.0, 4.0), 200, |x| x * x < 2.0);
        assert_eq!(above, below.next_up());
        assert!(below * below < 2.0 && above * above >= 2.0);
        // A bracket may be given from above, and few halvings leave it wide.
        assert_eq!(narrowed((4.0, 0.0), 2, |x| x > 2.5), (3.0, 2.0));
        assert_eq!(bisected((4.0, 0.0), 2, |x| x > 2.5), 2.5);
    }

    #[test]
    fn tasks_side_by_side_give_their_results_in_order_or_an_error() {
        let squares = in_parallel(50, |number| Ok::<_, usize>(number * number)).unwrap();
        assert!(
            squares
                .iter()
                .enumerate()
                .all(|(number, square)| number * number == *square)
        );
        assert_eq!(squares.len(), 50);
        let failed = in_parallel(50, |number| if number == 17 { Err(number) } else { Ok(()) });
        assert_eq!(failed, Err(17));
        assert_eq!(in_parallel(0, |_| Ok::<_, ()>(())), Ok(Vec::new()));
    }

    #[test]
    fn items_are_sorted_as_by_comparisons() {
        let numbers = [
            3.0,
            -0.0,
            7.5,
            0.0,
            -0.0,
            f64::NAN,
            3.0,
            -f64::INFINITY,
            1e-300,
            3.0,
        ];
        let items: Vec<(usize, f64)> = numbers.into_iter().enumerate().collect();
        for count in 0..=items.len() {
            let mut compared = items[..count].to_vec();
            let (mut up, mut down) = (compared.clone(), compared.clone());
            let places = |items: &[(usize, f64)]| items.iter().map(|one| one.0).collect::<Vec<_>>();
            sort_ascending(&mut up, |one| one.1);
            compared.sort_by(|a, b| a.1.total_cmp(&b.1));
            assert_eq!(places(&up), places(&compared));
            sort_descending(&mut down, |one| one.1);
            compared.sort_by_key(|one| one.0);
            compared.sort_by(|a, b| b.1.total_cmp(&a.1));
            assert_eq!(places(&down), places(&compared));
        }
    }

    #[test]
    fn leaving_one_value_out_gives_the_standard_error_of_a_mean() {
        let values = [1.0, 2.0, 4.0, 7.0];
        let sum: f64 = values.iter().sum();
        let without = values.iter().map(|value| (sum - value) / 3.0);
        let mean = 0.25 * sum;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        assert!((jackknife(without) - (squares / 12.0).sqrt()).abs() < 1e-14);
    }
}
