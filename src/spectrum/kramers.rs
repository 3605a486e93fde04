//! How often a damped particle goes over a barrier, by formulas that hold for high ones.
//!
//! With ω_A² the curvature of the potential at the bottom, -ω_b² that at the top, ΔV the height and T the temperature,
//! H. A. Kramers (1940) has the rate κ ω_A/(2π) e^{-ΔV/T} with κ = √(1 + g²/(4 ω_b²)) - g/(2 ω_b), which is too much
//! where damping is weak: there, energy comes in too slowly to fill the states near the top. V. I. Mel'nikov and S. V.
//! Meshkov (1986) multiply by A(δ_A) A(δ_B)/A(δ_A + δ_B), where δ is the energy, over T, that is lost in one turn at
//! the height of the barrier in either well, g ∮ y dx/T, and
//! ln A(δ) = 1/(2π) ∫ ln(1 - e^{-δ (λ² + 1/4)}) dλ/(λ² + 1/4).
//! What both leave out is of the order of T/ΔV.

use crate::numerics::bisected;
use crate::system::DampedParticle;

/// Places along the range at which the force's sign is looked at.
const PLACES: usize = 4000;

/// Panels of an integral, three Gauss points each.
const PANELS: usize = 400;

/// Steps outward, each a hundredth of the distance from bottom to top, within which a well ends.
const OUTWARD: usize = 10_000;

/// Angles of the integral in A: it is of a periodic function, smooth but for weak damping.
const ANGLES: usize = 2000;

/// Gauss points of an interval, as shares of its length, with their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Rates over a barrier by formulas, per unit of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EscapeFormulas {
    /// By Kramers' formula for moderate and strong damping.
    pub kramers: f64,
    /// The same with Mel'nikov and Meshkov's factor, for all damping.
    pub melnikov: f64,
}

/// The rates at which a particle goes from the deepest bottom in one region to the deepest in another; regions are told
/// by whether a position at rest is inside. `None` where they have no bottoms within a range, where more than one top
/// is between, or where a well does not end.
pub fn escape_formulas(
    particle: &DampedParticle,
    range: (f64, f64),
    [from, to]: [&dyn Fn(f64) -> bool; 2],
) -> Option<EscapeFormulas> {
    let zeros = zeros(particle, range);
    let bottoms = || (0..zeros.len()).filter(|&at| particle.curvature(zeros[at]) > 0.0);
    let potential: Vec<f64> = (0..zeros.len())
        .scan(0.0, |height, at| {
            if at > 0 {
                *height -= integral(&|x| particle.force(x), zeros[at - 1], zeros[at]);
            }
            Some(*height)
        })
        .collect();
    let deepest = |inside: &dyn Fn(f64) -> bool| {
        let own = bottoms().filter(|&at| inside(zeros[at]));
        own.min_by(|&one, &other| potential[one].total_cmp(&potential[other]))
    };
    let (start, end) = (deepest(from)?, deepest(to)?);
    let top = usize::midpoint(start, end);
    let steepness = -particle.curvature(*zeros.get(top)?);
    if start.abs_diff(end) != 2 || steepness <= 0.0 {
        return None;
    }
    let (damping, temperature) = (particle.damping, particle.temperature);
    let over = steepness.sqrt();
    let half = 0.5 * damping;
    let transmission = over / (half + half.hypot(over));
    let attempts = particle.curvature(zeros[start]).sqrt() / std::f64::consts::TAU;
    let height = potential[top] - potential[start];
    let kramers = transmission * attempts * (-height / temperature).exp();
    let loss = |bottom: usize| {
        let action = action(particle, zeros[bottom], zeros[top])?;
        Some(damping * action / temperature)
    };
    let (own, other) = (loss(start)?, loss(end)?);
    let factor = depopulation(own) * depopulation(other) / depopulation(own + other);
    Some(EscapeFormulas {
        kramers,
        melnikov: kramers * factor,
    })
}

/// A of the energy that is lost in a turn, over the temperature: about that energy where it is small, one where it is
/// large.
fn depopulation(loss: f64) -> f64 {
    // With λ = tan(φ)/2: ln A = 2/π ∫ ln(1 - e^{-δ/(4 cos² φ)}) dφ from 0 to π/2.
    let width = std::f64::consts::FRAC_PI_2 / ANGLES as f64;
    let terms = (0..ANGLES).map(|angle| {
        let cosine = ((angle as f64 + 0.5) * width).cos();
        (-(-0.25 * loss / (cosine * cosine)).exp_m1()).ln()
    });
    (terms.sum::<f64>() / ANGLES as f64).exp()
}

/// Positions in a range at which the force is zero.
fn zeros(particle: &DampedParticle, (from, to): (f64, f64)) -> Vec<f64> {
    let place = |index: usize| from + (to - from) * index as f64 / PLACES as f64;
    let is_back = |x: f64| particle.force(x) < 0.0;
    let changes = (0..PLACES).map(|index| (place(index), place(index + 1)));
    let changes = changes.filter(|&(low, high)| is_back(low) != is_back(high));
    changes
        .map(|(low, high)| halved(is_back, low, high))
        .collect()
}

/// Where a condition changes between two places.
fn halved(condition: impl Fn(f64) -> bool, low: f64, high: f64) -> f64 {
    let first = condition(low);
    bisected((low, high), 100, |middle| condition(middle) == first)
}

fn panel(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let points = GAUSS.iter();
    let terms = points.map(|(share, weight)| weight * f(from + share * (to - from)));
    terms.sum::<f64>() * (to - from)
}

fn integral(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let place = |index: usize| from + (to - from) * index as f64 / PANELS as f64;
    let panels = (0..PANELS).map(|index| panel(f, place(index), place(index + 1)));
    panels.sum()
}

/// ∮ y dx over a turn in a well at the energy of its top: twice ∫ √(2 (V_b - V)) from where it turns round to the top.
/// `None` where it does not turn round.
fn action(particle: &DampedParticle, bottom: f64, top: f64) -> Option<f64> {
    let force = |x: f64| particle.force(x);
    let below = |from: f64, to: f64| integral(&force, from, to);
    // V_b - V at the bottom, and outward from there.
    let mut depth = below(top, bottom);
    let step = 0.01 * (bottom - top);
    let mut end = bottom;
    for _ in 0..OUTWARD {
        let next = depth + panel(&force, end, end + step);
        if next < 0.0 {
            break;
        }
        (depth, end) = (next, end + step);
    }
    let turns = |x: f64| depth + panel(&force, end, x) < 0.0;
    if !turns(end + step) {
        return None;
    }
    let turn = halved(turns, end, end + step);
    // With x = turn + (top - turn) s², the root of V_b - V is smooth in s; summed from the top on.
    let place = |s: f64| turn + (top - turn) * s * s;
    let (mut depth, mut last, mut sum) = (0.0, top, 0.0);
    for index in (0..PANELS).rev() {
        for (share, weight) in GAUSS.iter().rev() {
            let s = (index as f64 + share) / PANELS as f64;
            let x = place(s);
            depth += panel(&force, last, x);
            last = x;
            sum += weight / PANELS as f64 * 2.0 * s * (2.0 * f64::max(depth, 0.0)).sqrt();
        }
    }
    Some(2.0 * sum * (top - turn).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Family, Path, TypedModel};

    /// Of a particle with a force and a damping, at the temperature of Duffing's well in `docs/passage.md`.
    fn particle(force: &str, damping: f64) -> DampedParticle {
        let model = TypedModel::new("own", "own", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", format!("{force} - {damping} y"))
            .with_noise("y", ["sqrt(2 T)"])
            .with_parameters([crate::system::ParameterDescription::from("T")]);
        let family = Family::new(model.build().unwrap(), &[], Path::parameter("T", 0.0, 1.0));
        family.unwrap().particle_at(0.06 * damping).unwrap()
    }

    fn rates(force: &str, damping: f64) -> Option<EscapeFormulas> {
        let particle = particle(force, damping);
        let (left, right) = (|x: f64| x < -0.7, |x: f64| x > 0.7);
        escape_formulas(&particle, (-3.0, 3.1), [&left, &right])
    }

    #[test]
    fn duffings_well_has_the_action_and_the_rate_of_its_closed_forms() {
        // V = x⁴/4 - x²/2: ∮ y dx = 4/3 at the top, ΔV = 1/4, ω² = 2 and 1.
        let action = action(&particle("x - x^3", 0.5), -1.0, 0.0).unwrap();
        assert!((action - 4.0 / 3.0).abs() < 1e-9, "{action}");
        for damping in [0.02, 0.5, 20.0] {
            let found = rates("x - x^3", damping).unwrap();
            let transmission = (1.0 + 0.25 * damping * damping).sqrt() - 0.5 * damping;
            let attempts = 2f64.sqrt() / std::f64::consts::TAU;
            let exact = transmission * attempts * (-0.25 / 0.06_f64).exp();
            assert!((found.kramers / exact - 1.0).abs() < 1e-9, "{found:?}");
            let one = depopulation(damping * 4.0 / 3.0 / 0.06);
            let both = depopulation(damping * 8.0 / 3.0 / 0.06);
            assert!((found.melnikov / exact - one * one / both).abs() < 1e-8);
        }
    }

    #[test]
    fn the_factor_is_the_energy_that_is_lost_where_that_is_small_and_one_where_it_is_large() {
        assert!((depopulation(1e-4) / 1e-4 - 1.0).abs() < 1e-2);
        assert!((depopulation(60.0) - 1.0).abs() < 1e-6);
        // ln A = -Σ erfc(√(n δ)/2)/n, the sum of the logarithm's series term by term; here at δ = 16.
        let erfc = [4.677_734_981_047e-3, 6.334_248_366_624e-5, 9.633_570_086e-7];
        let exact = (-erfc[0] - erfc[1] / 2.0 - erfc[2] / 3.0_f64).exp();
        assert!((depopulation(16.0) - exact).abs() < 1e-7);
    }

    #[test]
    fn without_one_barrier_between_two_wells_there_are_no_rates() {
        // One well; four wells, of which two are on the way; no bottom on the right.
        assert_eq!(rates("-x", 0.5), None);
        assert_eq!(rates("-x*(x^2 - 0.25)*(x^2 - 1)*(x^2 - 4)", 0.5), None);
        assert_eq!(rates("(x - 1)*(x + 1)*exp(-x^2)", 0.5), None);
    }
}
