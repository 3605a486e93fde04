//! Advective schemes by name, and their face stencils.
//!
//! The unknowns are point values at the nodes of a grid that is uniform in the cell coordinate, so the flux
//! function taken at the nodes is reconstructed as if it were a row of cell averages (Shu and Osher 1988):
//! the difference of two reconstructions is the derivative at a node to full order.

/// Cells a face stencil may touch on either side of the face.
pub(super) const REACH: usize = 3;

/// Weights on the `2 REACH` cells around a face, from the lowest up.
pub(super) type Window = [f64; 2 * REACH];

/// Share of the dissipation that is kept where Legendre modes carry an internal state. With the state cut into cells a
/// density is a thin ridge across them, which dissipation has to hold together; the coefficients of modes are smooth in
/// the other coordinates, and half of it halves the error (docs/accuracy.md). Without any, what nears an end of the
/// range comes back as wiggles.
pub(super) const DAMPING_BESIDE_MODES: f64 = 0.5;

/// Share of the difference of two parabolas at a break that is damped. It is a third difference: of all of it the means
/// of oscillators are off by half as much more, of less the slopes on both sides come apart (docs/accuracy.md).
const DAMPING_AT_BREAKS: f64 = 0.5;

/// How much of the advective scheme's dissipation is kept. What two shares differ by is an error of the cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dissipation {
    /// All of it.
    Full,
    /// Half of it.
    Half,
}

/// How the advective flux through a face is reconstructed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AdvectiveScheme {
    /// Fifth order, biased upwind: damps what the grid cannot resolve (half as much where modes carry an internal
    /// state).
    #[default]
    Upwind5,
    /// Fourth order, central: no dissipation of its own.
    Central4,
    /// Sixth order, central: no dissipation of its own.
    Central6,
}

words! { AdvectiveScheme, pub name: Upwind5: "upwind5", Central4: "central4", Central6: "central6" }

impl AdvectiveScheme {
    /// Cells on either side of a face that its full stencil uses.
    pub(crate) fn reach(self) -> usize {
        match self {
            Self::Upwind5 | Self::Central6 => 3,
            Self::Central4 => 2,
        }
    }

    /// Central weights and dissipation weights of a face with `cells` cells available on either side. The flux
    /// is Σ central·f - |speed| Σ dissipation·p; central minus or plus dissipation is the upwind-biased
    /// stencil of order 2·cells - 1.
    pub(super) fn symmetric(self, cells: usize) -> (Window, Window) {
        let (central, dissipation): (Window, Window) = match cells.min(self.reach()) {
            0 => ([0.0; 6], [0.0; 6]),
            1 => (
                [0.0, 0.0, 0.5, 0.5, 0.0, 0.0],
                [0.0, 0.0, -0.5, 0.5, 0.0, 0.0],
            ),
            2 => (
                [0.0, -1.0, 7.0, 7.0, -1.0, 0.0].map(|weight| weight / 12.0),
                [0.0, 1.0, -3.0, 3.0, -1.0, 0.0].map(|weight| weight / 12.0),
            ),
            _ => (
                [1.0, -8.0, 37.0, 37.0, -8.0, 1.0].map(|weight| weight / 60.0),
                [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0].map(|weight| weight / 60.0),
            ),
        };
        match self {
            Self::Upwind5 => (central, dissipation),
            Self::Central4 | Self::Central6 => (central, [0.0; 6]),
        }
    }

    /// The same of a face near which the density is not smooth, of the numbers of cells below and above in which it is:
    /// the mean of what flows from below and from above, and half of what they differ by. Central minus or plus
    /// dissipation is one of them. `None` where no cell is left on one side.
    pub(super) fn one_sided(self, below: usize, above: usize) -> Option<(Window, Window)> {
        let (below, above) = (below.min(self.reach()), above.min(self.reach()));
        let from_below = upwind((below, above))?;
        let from_above = mirrored(upwind((above, below))?);
        Some(self.between(half_sum(from_below, from_above), from_below, from_above))
    }

    /// The same of a face on which the density has a break, with three cells of its own on either side: the mean of the
    /// fluxes of both sides. Where it is the second derivative that jumps, these are of the cubics through the nodes of
    /// a side that share value and slope at the face. Where the slope jumps, they are of parabolas, and in the central
    /// scheme of fourth order of lines, as what both schemes share is no part of the stated error.
    ///
    /// Fluxes are not values at the face, but of a function whose averages over cells are the nodes' values. They jump
    /// by a twenty-fourth of h² times the jump of the second derivative there; half of that is missing in the cells on
    /// either side, whose rates along other axes make it good (`LineSampler`, and `jumps` where slopes jump).
    ///
    /// Values at the face are the same from both sides, and those of both parabolas are held together by dissipation.
    pub(super) fn at_break(self, slope_jumps: bool) -> (Window, Window) {
        let [far, middle, near] = match (self, slope_jumps) {
            (_, false) => [20.0, -106.0, 362.0].map(|weight| weight / 276.0),
            (Self::Central4, true) => [0.0, -1.0, 3.0].map(|weight| weight / 2.0),
            (Self::Upwind5 | Self::Central6, true) => [2.0, -7.0, 11.0].map(|weight| weight / 6.0),
        };
        let flux = [far, middle, near, 0.0, 0.0, 0.0];
        let value =
            [3.0, -10.0, 15.0, 0.0, 0.0, 0.0].map(|weight| DAMPING_AT_BREAKS * weight / 8.0);
        self.between(half_sum(flux, mirrored(flux)), value, mirrored(value))
    }

    /// Weights of the slope at a face of the nodes on one side, from the face on, in cell coordinates: of the parabola
    /// through three. The central scheme of fourth order does without: what both schemes share is no part of the stated
    /// error, and what fluxes leave out is of second order.
    pub(super) fn slope(self) -> Option<[f64; REACH]> {
        match self {
            Self::Central4 => None,
            Self::Upwind5 | Self::Central6 => Some([-2.0, 3.0, -1.0]),
        }
    }

    /// The same of the face that is next to the wall below it, with the weights of the derivative there by the cell
    /// coordinate, of the four cells from the wall on; mirrored beside a wall above it. The flux f is zero at the wall,
    /// so that f - f''/24, which differences of fluxes want, follows from its values at this face and the next one:
    /// 13/12 of the former less a twenty-fourth of the latter. The central scheme of fourth order does without, and
    /// takes the means and differences of the two cells: what both schemes share is no part of the stated error. So it
    /// does without what makes good the flux through the wall (`jumps`).
    pub(super) fn beside_wall(self) -> Option<WallStencil> {
        let dissipation = match self {
            Self::Central4 => return None,
            Self::Upwind5 => [0.0, 0.0, -1.0, 3.0, -3.0, 1.0].map(|weight| weight / 24.0),
            Self::Central6 => [0.0; 6],
        };
        Some(WallStencil {
            // Values at both faces are those of the cubic through four nodes.
            central: [0.0, 0.0, 131.0, 381.0, -139.0, 27.0].map(|weight| weight / 384.0),
            dissipation,
            derivative: [0.0, 0.0, -23.0, 21.0, 3.0, -1.0].map(|weight| weight / 24.0),
            along: [2.0, -3.0, 1.0].map(|weight| weight / 24.0),
        })
    }

    /// Central weights with the dissipation that belongs to values from either side.
    fn between(self, central: Window, below: Window, above: Window) -> (Window, Window) {
        let dissipation = match self {
            Self::Upwind5 => std::array::from_fn(|k| 0.5 * (above[k] - below[k])),
            Self::Central4 | Self::Central6 => [0.0; 6],
        };
        (central, dissipation)
    }
}

/// Weights at the face next to a wall.
pub(super) struct WallStencil {
    pub(super) central: Window,
    pub(super) dissipation: Window,
    pub(super) derivative: Window,
    /// What of the rates along other axes, in the cells from the wall on, is added to those of the cell at the wall.
    pub(super) along: [f64; REACH],
}

impl WallStencil {
    /// The same beside a wall above the face: derivatives and what is damped change their signs.
    pub(super) fn mirrored(self) -> Self {
        let turned = |window: Window| mirrored(window).map(|weight| -weight);
        Self {
            central: mirrored(self.central),
            dissipation: turned(self.dissipation),
            derivative: turned(self.derivative),
            along: self.along,
        }
    }
}

fn half_sum(one: Window, other: Window) -> Window {
    std::array::from_fn(|k| 0.5 * (one[k] + other[k]))
}

fn mirrored(mut window: Window) -> Window {
    window.reverse();
    window
}

/// Weights of the flux through a face from below, by the polynomial through the averages of at most three cells below
/// and two above.
fn upwind(cells: (usize, usize)) -> Option<Window> {
    let sixth = 1.0 / 6.0;
    Some(match cells {
        (0, _) | (_, 0) => return None,
        (1, 1) => [0.0, 0.0, 0.5, 0.5, 0.0, 0.0],
        (1, _) => [0.0, 0.0, 2.0, 5.0, -1.0, 0.0].map(|weight| sixth * weight),
        (2, _) => [0.0, -1.0, 5.0, 2.0, 0.0, 0.0].map(|weight| sixth * weight),
        (_, 1) => [1.0, -5.0, 13.0, 3.0, 0.0, 0.0].map(|weight| weight / 12.0),
        (..) => [2.0, -13.0, 47.0, 27.0, -3.0, 0.0].map(|weight| weight / 60.0),
    })
}
