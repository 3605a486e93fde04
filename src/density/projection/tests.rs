use super::*;
use crate::space::Grading;

fn project(
    space: &CellSpace,
    observable: Observable,
    mass: &[f64],
) -> Result<Density, DensityError> {
    Projection::new(space, observable)?.density(mass)
}

fn axes() -> Vec<Axis> {
    let grading = Grading {
        at: vec![0.2],
        smallest: 0.1,
    };
    vec![
        Axis::graded(-1.0, 2.0, 6, &grading).unwrap(),
        Axis::uniform(0.0, 3.0, 3).unwrap(),
        Axis::uniform(-2.0, 5.0, 4).unwrap(),
        Axis::uniform(-1.0, 1.0, 2).unwrap(),
    ]
}

/// A mass that is a product over the axes, so that every projection is a product too.
fn product_mass(space: &CellSpace) -> (Vec<f64>, Vec<Vec<f64>>) {
    let factors: Vec<Vec<f64>> = space
        .axes()
        .iter()
        .enumerate()
        .map(|(k, axis)| {
            let raw: Vec<f64> = (0..axis.count())
                .map(|i| 1.0 + ((i * i + k) % 5) as f64)
                .collect();
            let sum: f64 = raw.iter().sum();
            raw.iter().map(|value| value / sum).collect()
        })
        .collect();
    let mass = (0..space.n_cells())
        .map(|cell| {
            (0..space.dimension())
                .map(|k| factors[k][space.position(cell, k)])
                .product()
        })
        .collect();
    (mass, factors)
}

#[test]
fn product_masses_project_onto_their_factors_in_every_dimension_and_order() {
    for dimension in 1..=4 {
        let space = CellSpace::new(axes()[..dimension].to_vec()).unwrap();
        let (mass, factors) = product_mass(&space);
        for a in 0..dimension {
            let density = project(&space, Observable::Marginal(a), &mass).unwrap();
            for (i, value) in density.values.iter().enumerate() {
                assert!((value * space.axes()[a].width(i) - factors[a][i]).abs() < 1e-14);
            }
            for b in (0..dimension).filter(|&b| b != a) {
                let density = project(&space, Observable::Joint(a, b), &mass).unwrap();
                assert_eq!(density.axes[0], space.axes()[a]);
                let columns = density.axes[1].count();
                for (cell, mass) in density.masses().iter().enumerate() {
                    let expected = factors[a][cell / columns] * factors[b][cell % columns];
                    assert!((mass - expected).abs() < 1e-14);
                }
                let total: f64 = density.masses().iter().sum();
                assert!((total - 1.0).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn wrong_axes_and_lengths_are_refused() {
    let space = CellSpace::new(axes()[..2].to_vec()).unwrap();
    let mass = vec![1.0 / 18.0; 18];
    let error = |observable| project(&space, observable, &mass).unwrap_err();
    assert_eq!(
        error(Observable::Marginal(2)),
        DensityError::Axis {
            axis: 2,
            dimension: 2
        }
    );
    assert_eq!(
        error(Observable::Joint(1, 1)),
        DensityError::RepeatedAxis { axis: 1 }
    );
    let short = project(&space, Observable::Marginal(0), &mass[1..]);
    assert_eq!(
        short.unwrap_err(),
        DensityError::Length {
            given: 17,
            wanted: 18
        }
    );
}
