//! Facets of a surface: how they are cut, and their colour under one light.

/// Height of the box, as a share of its sides.
pub(super) const HEIGHT: f64 = 0.62;
/// Facets that are bent more than this share of the box are drawn as two triangles.
const BENT: f64 = 0.012;
/// Where the light comes from: from the left, the front, above. Not of unit length.
const LIGHT: [f64; 3] = [-0.45, -0.35, 0.85];
/// Share of a colour that is left in full shadow.
const AMBIENT: f64 = 0.52;

/// A facet as it is drawn: whole where it is nearly flat, else cut along the diagonal that keeps a ridge. Of a triangle
/// the last corner stands twice; the parts follow each other toward the viewer.
pub(super) fn parts(corners: [[f64; 3]; 4]) -> Vec<[[f64; 3]; 4]> {
    let [a, b, c, d] = corners;
    let bend = a[2] + c[2] - b[2] - d[2];
    if bend.abs() < BENT {
        return vec![corners];
    }
    if bend > 0.0 {
        vec![[a, c, d, d], [a, b, c, c]]
    } else {
        vec![[b, c, d, d], [a, b, d, d]]
    }
}

/// How a facet faces the light: 0 away from it, 1 toward it.
pub(super) fn brightness(corners: &[[f64; 3]; 4]) -> f64 {
    let [a, b, c, d] = corners;
    let along = |p: &[f64; 3], q: &[f64; 3]| [q[0] - p[0], q[1] - p[1], HEIGHT * (q[2] - p[2])];
    // The diagonals of a quadrilateral; of a triangle two of its sides.
    let (u, v) = (along(a, c), along(b, d));
    let normal = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let length = |v: &[f64; 3]| v.iter().map(|part| part * part).sum::<f64>().sqrt();
    let product: f64 = normal.iter().zip(&LIGHT).map(|(n, l)| n * l).sum();
    let cosine = product / (length(&normal) * length(&LIGHT)).max(f64::MIN_POSITIVE);
    cosine.clamp(0.0, 1.0)
}

/// A colour under light; in 32 steps, so that neighbours share theirs.
pub(super) fn shade((r, g, b): (u8, u8, u8), brightness: f64) -> (u8, u8, u8) {
    let factor = AMBIENT + (1.0 - AMBIENT) * (32.0 * brightness).round() / 32.0;
    // A flat floor keeps its colour; what faces the light is lighter still.
    let flat = AMBIENT + (1.0 - AMBIENT) * 0.83;
    let shade = |value: u8| (f64::from(value) * factor / flat).min(255.0).round() as u8;
    (shade(r), shade(g), shade(b))
}

/// How far facets reach beyond their corners, in pixels: neighbours overlap by twice as much, so that no seam shines
/// through. A rim around each would do the same in three times the time.
const OVERLAP: f64 = 0.4;
/// A corner moves outward by so many times that at most, however sharp it is.
const SHARPEST: f64 = 2.0;

/// The corners of a facet on the page, in pixels, moved outward; corners that coincide are one.
pub(super) fn grow(corners: &[(f64, f64); 4]) -> Vec<(f64, f64)> {
    let mut places: Vec<(f64, f64)> = Vec::with_capacity(4);
    for &(x, y) in corners {
        let is_new = |&(a, b): &(f64, f64)| (a - x).hypot(b - y) > 1e-6;
        if places.iter().all(is_new) {
            places.push((x, y));
        }
    }
    let n = places.len();
    if n < 3 {
        return places;
    }
    let side = |k: usize| {
        let ((a, b), (c, d)) = (places[k % n], places[(k + 1) % n]);
        (c - a, d - b)
    };
    let twice_area: f64 = (0..n)
        .map(|k| {
            let ((a, b), (c, d)) = (places[k], places[(k + 1) % n]);
            a * d - b * c
        })
        .sum();
    let turn = if twice_area < 0.0 { -1.0 } else { 1.0 };
    let normal = |k: usize| {
        let (x, y) = side(k);
        let length = turn * x.hypot(y);
        (y / length, -x / length)
    };
    let moved = |k: usize| {
        let (one, other) = (normal(k + n - 1), normal(k));
        let sum = (one.0 + other.0, one.1 + other.1);
        // Both sides move by the overlap: the corner goes along the sum of their normals.
        let cosine = 1.0 + one.0 * other.0 + one.1 * other.1;
        let far =
            (OVERLAP / cosine.max(1e-9)).min(SHARPEST * OVERLAP / sum.0.hypot(sum.1).max(1e-9));
        (places[k].0 + far * sum.0, places[k].1 + far * sum.1)
    };
    (0..n).map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grown_facets_reach_beyond_their_sides() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let mut turned = square;
        turned.reverse();
        for facet in [square, turned] {
            for (corner, grown) in facet.iter().zip(grow(&facet)) {
                let wanted = |value: f64| if value > 5.0 { 10.4 } else { -0.4 };
                assert!((grown.0 - wanted(corner.0)).abs() < 1e-12, "{grown:?}");
                assert!((grown.1 - wanted(corner.1)).abs() < 1e-12, "{grown:?}");
            }
        }
        // A triangle has its last corner twice; a needle's tip stays near.
        let needle = grow(&[(0.0, 0.0), (10.0, 0.01), (10.0, -0.01), (10.0, -0.01)]);
        assert_eq!(needle.len(), 3);
        assert!((needle[0].0 + 0.8).abs() < 1e-3, "{needle:?}");
        assert!(
            needle
                .iter()
                .all(|place| place.0.is_finite() && place.1.is_finite())
        );
        assert_eq!(grow(&[(1.0, 1.0); 4]), [(1.0, 1.0)]);
    }

    #[test]
    fn what_faces_the_light_is_brighter() {
        let facet = |left: f64, right: f64| {
            brightness(&[
                [0.0, 0.0, left],
                [0.1, 0.0, right],
                [0.1, 0.1, right],
                [0.0, 0.1, left],
            ])
        };
        // The light comes from the left: a slope that rises to the right faces it.
        assert!(facet(0.0, 0.1) > facet(0.0, 0.0) && facet(0.0, 0.0) > facet(0.1, 0.0));
        assert!((facet(0.0, 0.0) - 0.83).abs() < 0.01, "{}", facet(0.0, 0.0));
    }

    #[test]
    fn bent_facets_keep_ridges_and_cover_the_whole() {
        let flat = [
            [0.0, 0.0, 0.1],
            [1.0, 0.0, 0.1],
            [1.0, 1.0, 0.1],
            [0.0, 1.0, 0.1],
        ];
        assert_eq!(parts(flat), [flat]);
        let mut ridge = flat;
        (ridge[0][2], ridge[2][2]) = (0.5, 0.5);
        let area = |[a, b, c, d]: &[[f64; 3]; 4]| {
            let (u, v) = ([c[0] - a[0], c[1] - a[1]], [d[0] - b[0], d[1] - b[1]]);
            0.5 * (u[0] * v[1] - u[1] * v[0])
        };
        let cut = parts(ridge);
        assert!(
            cut.iter()
                .all(|part| part.contains(&ridge[0]) && part.contains(&ridge[2]))
        );
        assert!((cut.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-12);
        let mut other = flat;
        (other[1][2], other[3][2]) = (0.5, 0.5);
        let cut = parts(other);
        assert!(
            cut.iter()
                .all(|part| part.contains(&other[1]) && part.contains(&other[3]))
        );
        assert!((cut.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
