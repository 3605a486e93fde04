//! Families that tests share.

use super::{Family, Path, registry};

/// The paper's first example along its friction level.
pub(crate) fn coulomb() -> Family {
    let fixed = [("kappa", 0.01), ("sigma2", 0.01)];
    let path = Path::parameter("f_c", -0.02, 0.01);
    Family::new(registry::find("coulomb").unwrap(), &fixed, path).unwrap()
}

/// The smallest model with a bifurcation, along its growth rate.
pub(crate) fn bistable(from: f64, to: f64) -> Family {
    let path = Path::parameter("a", from, to);
    Family::new(
        registry::find("bistable").unwrap(),
        &[("sigma2", 0.5)],
        path,
    )
    .unwrap()
}
