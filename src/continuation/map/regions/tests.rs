use super::*;

#[test]
fn a_wall_parts_what_is_nearer_across_it() {
    let canvas = Canvas { size: [40, 40] };
    // Upright at 0.7: pixels between belong to the seed far to the left, not to the one just to the right.
    let walls = canvas.walls(&[vec![[0.7, 0.0], [0.7, 1.0]]]);
    let seeds = [
        (canvas.pixel([0.1, 0.5]), 0, false),
        (canvas.pixel([0.8, 0.5]), 1, false),
        // Too near to the wall to tell.
        (canvas.pixel([0.68, 0.5]), 1, true),
    ];
    let owners = canvas.owners(&walls, &seeds);
    assert_eq!(owners[canvas.pixel([0.66, 0.9])], 0);
    assert_eq!(owners[canvas.pixel([0.74, 0.1])], 1);
    let (numbers, count) = canvas.components(&owners);
    assert_eq!(count, 2);
    let depth = canvas.depth(&numbers);
    assert_eq!(depth[canvas.pixel([0.35, 0.5])], 13);
    assert_eq!(depth[canvas.pixel([0.0, 0.5])], 0);
}

#[test]
fn a_slanted_wall_has_no_gap() {
    let canvas = Canvas { size: [64, 48] };
    let walls = canvas.walls(&[vec![[0.0, 0.1], [0.5, 0.45], [1.0, 0.9]]]);
    let seeds = [(canvas.pixel([0.9, 0.1]), 0, false)];
    let mut owners = vec![NONE; walls.len()];
    let of = seeds.iter().map(|&(pixel, kind, _)| (pixel, kind));
    canvas.flood(&mut owners, Some(&walls), of);
    assert_eq!(owners[canvas.pixel([0.1, 0.9])], NONE);
    assert_eq!(owners[canvas.pixel([0.5, 0.2])], 0);
}
