//! Passes through the factors, which two iterations may share.
//!
//! A pass of forward and backward substitution is bound by reading the factors, so that two vectors take little longer
//! than one. An iteration is written as a plain sequence of steps (an `async` function) that waits at its [`Seat`]
//! whenever it needs a pass; whoever runs it lets all that wait have the same one. What an iteration gives does not
//! depend on whom it shares with.

use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::sync::{Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use super::preconditioner::Preconditioner;

/// Where one iteration leaves a residual and finds M⁻¹ of it.
#[derive(Default)]
pub(super) struct Seat {
    left: Mutex<Option<Vec<f64>>>,
    given: Mutex<Option<Vec<f64>>>,
}

fn take(place: &Mutex<Option<Vec<f64>>>) -> Option<Vec<f64>> {
    place.lock().unwrap_or_else(PoisonError::into_inner).take()
}

fn store(place: &Mutex<Option<Vec<f64>>>, vector: Vec<f64>) {
    *place.lock().unwrap_or_else(PoisonError::into_inner) = Some(vector);
}

impl Seat {
    /// M⁻¹ of a residual, with the next pass.
    pub(super) async fn pass(&self, residual: Vec<f64>) -> Vec<f64> {
        store(&self.left, residual);
        poll_fn(|_| take(&self.given).map_or(Poll::Pending, Poll::Ready)).await
    }
}

/// Runs one iteration; `apply` is M⁻¹.
pub(super) fn run_alone<T>(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    seat: &Seat,
    work: impl Future<Output = T>,
) -> T {
    let mut work = pin!(work);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(done) = work.as_mut().poll(&mut context) {
            return done;
        }
        if let Some(residual) = take(&seat.left) {
            store(&seat.given, apply(&residual));
        }
    }
}

/// Runs two iterations side by side as long as both need passes; gives what they gave, and the number of passes.
pub(super) fn together<A: Send, B: Send>(
    kept: &Preconditioner,
    [first, second]: [&Seat; 2],
    a: impl Future<Output = A> + Send,
    b: impl Future<Output = B> + Send,
) -> (A, B, usize) {
    let (mut a, mut b) = (pin!(a), pin!(b));
    let (mut of_a, mut of_b) = (None, None);
    let mut passes = 0;
    loop {
        rayon::join(
            || go_on(a.as_mut(), &mut of_a),
            || go_on(b.as_mut(), &mut of_b),
        );
        match (take(&first.left), take(&second.left)) {
            (Some(one), Some(other)) => {
                let [one, other] = kept.apply([&one, &other]);
                store(&first.given, one);
                store(&second.given, other);
            }
            (Some(one), None) => {
                let [one] = kept.apply([&one]);
                store(&first.given, one);
            }
            (None, Some(other)) => {
                let [other] = kept.apply([&other]);
                store(&second.given, other);
            }
            (None, None) => {}
        }
        passes += 1;
        (of_a, of_b) = match (of_a, of_b) {
            (Some(a), Some(b)) => return (a, b, passes - 1),
            unfinished => unfinished,
        };
    }
}

/// Runs an iteration to its next pass, or to its end.
fn go_on<T>(work: Pin<&mut impl Future<Output = T>>, done: &mut Option<T>) {
    if done.is_none()
        && let Poll::Ready(value) = work.poll(&mut Context::from_waker(Waker::noop()))
    {
        *done = Some(value);
    }
}
