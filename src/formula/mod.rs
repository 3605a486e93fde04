//! Formulas of stochastic equations: read, differentiated, analysed, and run on [`LANES`] states at a time.
//!
//! # From text to numbers
//!
//! ```
//! use pbif::formula::scope::{Scope, Symbols};
//! use pbif::formula::LANES;
//!
//! let mut symbols = Symbols::default();
//! symbols.add_state("x")?;
//! symbols.add_state("y")?;
//! for name in ["kappa", "alpha", "mu", "f_c"] {
//!     symbols.add_parameter(name)?;
//! }
//! symbols.define("V", "α x²/2 + μ x⁴/4")?;
//! let mut scope = Scope::new(symbols).map_err(|errors| errors[0].clone())?;
//! let drift = [scope.formula("y")?, scope.formula("-kappa y - x (alpha + mu x^2) - f_c sign(y)")?];
//! let tape = scope.compile(&drift).bind(&[0.01, 1.0, 0.01, 0.02])?;
//! let (states, mut slopes) = ([[2.0; LANES], [3.0; LANES]], [[0.0; LANES]; 2]);
//! tape.run(0.0, &states, &mut slopes);
//! assert!((slopes[1][63] - (-0.03 - 2.0 * 1.04 - 0.02)).abs() < 1e-15);
//! assert_eq!(scope.typeset(drift[1]), "-κ y - x (α + μ x²) - f_c sign(y)");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The language
//!
//! - Numbers: `1`, `1.5`, `.5`, `1e-3`. Names: letters, digits and `_`; Greek letters and their names are the same
//!   (`α`, `alpha`), and so are `c₀`, `c0` and `c_0`. `t` is time; `pi` and `e` are the constants unless they are
//!   given to something else.
//! - `+ - * / ^`, with `-x^2 = -(x^2)`, `2^3^2 = 2^9`, `2^-1 = 0.5`; also `·`, `×`, `−` and exponents as in `x²`.
//! - A product may do without its sign where it cannot be misread: a name or a parenthesis after a blank (`c1 x`,
//!   `x (a + b)`), after a number (`2x`, `2(x + 1)`), after a parenthesis (`(a)(b)`) or after a raised exponent
//!   (`σ²x`). Refused with a remedy are `1/2 x` (is x divided too?), `x^2y`, `x 2`, `f_c(x)` for a name that is no
//!   function, and `sin x`.
//! - Comparisons `< <= > >= == !=` are 1 where they hold and 0 where not; `if(condition, value, otherwise)`.
//! - Functions: `sin cos tan asin acos atan sinh cosh tanh exp log log10 sqrt cbrt abs sign step floor min max hypot
//!   atan2 pow`; `ln` is `log`, `sgn` is `sign`. `sign(0) = 0`, `step(0) = 1/2`. NaN stays NaN.
//!
//! # What holds
//!
//! Every operation has one meaning ([`arithmetic`]), shared by constant folding, evaluation at a point and the lanes
//! of a tape; simplification changes no bit of any value. The one exception is [`Program::bind`](tape::Program::bind),
//! which nests polynomials. No input can exhaust the stack or the memory: everything is bounded by [`limits`].

pub mod analysis;
pub mod arithmetic;
pub mod graph;
mod lanes;
pub mod language;
#[cfg(any(feature = "store", feature = "figures"))]
pub(crate) mod latex;
pub mod limits;
pub mod mathml;
mod print;
pub mod scope;
pub mod tape;

pub use lanes::{LANES, Lanes};
pub use print::TooLong;
