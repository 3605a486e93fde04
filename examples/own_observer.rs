//! A sweep with an observer of one's own that prints every point as it is done and stops the sweep early.
//!
//! Run with `cargo run --release --example own_observer`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::{LocateOptions, Observer, Point, sweep};
use pbif::density::Observable;
use pbif::method::{Problem, SgcmOptions, SgcmSource};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, registry};
use pbif::topology::{DetectOptions, PersistenceDetector};

/// Stops once the density has had two peaks at three points.
struct UntilTwoPeaks {
    seen: usize,
    cancellation: Cancellation,
}

impl Observer for UntilTwoPeaks {
    fn point(
        &mut self,
        point: &Point,
        done: usize,
        _remaining: usize,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if let Some(detection) = point.detections.first() {
            let signature = detection.signature;
            println!("{done:3}  a = {:+.3}  {signature}", point.value);
            self.seen += usize::from(signature.peaks == 2);
        }
        if self.seen >= 3 {
            self.cancellation.cancel();
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // dx = (a x - x³) dt + σ dW: one peak for a ≤ 0, two for a > 0.
    let path = Path::parameter("a", -1.0, 1.0);
    let family = Family::new(registry::find("bistable")?, &[("sigma2", 0.5)], path)?;
    let space = CellSpace::new(vec![Axis::uniform(-2.5, 2.5, 100)?])?;
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)])?;
    let options = SgcmOptions {
        samples: 5000,
        ..SgcmOptions::default()
    };
    let cancellation = Cancellation::new();
    let source = SgcmSource::new(&problem, &options, &cancellation)?;
    let points = 21;
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let locate = LocateOptions {
        tolerance: Some(0.1),
        ..LocateOptions::default()
    };
    let mut observer = UntilTwoPeaks {
        seen: 0,
        cancellation: cancellation.clone(),
    };
    let result = sweep(
        &source,
        &detector,
        points,
        &locate,
        &cancellation,
        &mut observer,
    )?;
    let solved = result.points.len();
    println!("{solved} points, interrupted: {}", result.interrupted);
    Ok(())
}
