use super::*;

#[test]
fn the_first_doubt_decides_status_and_reason() {
    use BifurcationStatus::{Unchecked, Unconfirmed, Unresolved};
    let density = Density {
        axes: vec![Axis::uniform(-1.0, 1.0, 100).unwrap()],
        values: vec![0.5; 100],
    };
    let doubts = |change: &dyn Fn(&mut Evidence<'_>)| {
        let mut evidence = Evidence {
            check: None,
            densities: Vec::new(),
            unchecked: None,
            cell_check: CellCheck::OnFinerCells {
                ratio: 1.5,
                follows: None,
            },
            refined: 1,
            is_diffused: false,
            parts: ErrorParts::default(),
            width: 1e-3,
            tolerance: 1e-3,
            density: &density,
            is_noisy: false,
            wider: None,
        };
        change(&mut evidence);
        evidence.doubts()
    };
    assert_eq!(status_of(&doubts(&|_| ())), BifurcationStatus::Located);
    let off = |one: &mut Evidence<'_>| one.unchecked = Some(Doubt::GridCheckOff);
    assert_eq!(doubts(&off), [Doubt::GridCheckOff]);
    assert_eq!(status_of(&doubts(&off)), Unchecked);
    let needless = doubts(&|one| {
        off(one);
        one.cell_check = CellCheck::Needless;
    });
    assert_eq!(needless, []);
    let diffused = doubts(&|one| {
        off(one);
        one.is_diffused = true;
    });
    assert_eq!(diffused[0], Doubt::NumericalDiffusion);
    assert_eq!(status_of(&diffused), Unconfirmed);
    let wide = doubts(&|one| {
        off(one);
        one.width = 2e-3;
    });
    assert_eq!(wide[0], Doubt::WideBracket(2e-3));
    assert_eq!(status_of(&wide), Unresolved);
    let coarse = doubts(&|one| {
        off(one);
        one.parts.grid = 2e-3;
    });
    assert_eq!(coarse[0], Doubt::CoarseCells(2e-3, Some(200.0)));
    assert_eq!(status_of(&coarse), Unresolved);
    let nowhere = doubts(&|one| {
        one.check = Some(Doubt::NotOnFinerCells);
        one.densities = vec![Doubt::Jump];
    });
    assert_eq!(nowhere, [Doubt::NotOnFinerCells, Doubt::Jump]);
    assert_eq!(status_of(&nowhere), Unconfirmed);
}
