use fractum_math::Vec3;

/// Where on a facet its closest place to a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Within the facet.
    Inside,
    /// On the side from this corner to the next.
    Side(usize),
    /// At this corner.
    Corner(usize),
}

/// Vector from `x` to the plane through `a` with (unnormalised) normal `n`, along n: exact where n is an axis.
#[inline]
fn to_plane(w: &Vec3, n: &Vec3) -> Vec3 {
    n * (n.dot(w) / n.norm_squared())
}

/// Vector from `x` to the line along `u`, as u × (w × u)/u²: no part along u is left by rounding.
#[inline]
fn to_line(w: &Vec3, u: &Vec3) -> Vec3 {
    u.cross(&w.cross(u)) / u.norm_squared()
}

/// Vector from `x` to the closest place of the edge from a to b.
pub(crate) fn closest_on_segment(x: &Vec3, a: &Vec3, b: &Vec3) -> Vec3 {
    closest_on_line(x, a, b).1
}

/// Closest place of the line from a to b to `x`, and the vector from `x` to it; at an end its side is that from the end to itself.
pub(crate) fn closest_on_line(x: &Vec3, a: &Vec3, b: &Vec3) -> (Place, Vec3) {
    let (u, w) = (b - a, a - x);
    let along = -w.dot(&u);
    if along <= 0.0 {
        (Place::Side(0), w)
    } else if along >= u.norm_squared() {
        (Place::Side(1), b - x)
    } else {
        (Place::Inside, to_line(&w, &u))
    }
}

/// Closest place of a triangle to `x`, and the vector from `x` to it.
///
/// Regions after Ericson, *Real-Time Collision Detection* (2005), 5.1.5. Offsets are formed from `x` to corners, and not
/// as differences of two places, so that a lateral component that is zero by symmetry is zero to the last bit.
#[inline]
pub(crate) fn closest_on_triangle(x: &Vec3, [a, b, c]: [&Vec3; 3]) -> (Place, Vec3) {
    let (ab, ac) = (b - a, c - a);
    let (wa, wb, wc) = (a - x, b - x, c - x);
    let (d1, d2) = (-ab.dot(&wa), -ac.dot(&wa));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (Place::Corner(0), wa);
    }
    let (d3, d4) = (-ab.dot(&wb), -ac.dot(&wb));
    if d3 >= 0.0 && d4 <= d3 {
        return (Place::Corner(1), wb);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (Place::Side(0), to_line(&wa, &ab));
    }
    let (d5, d6) = (-ab.dot(&wc), -ac.dot(&wc));
    if d6 >= 0.0 && d5 <= d6 {
        return (Place::Corner(2), wc);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (Place::Side(2), to_line(&wa, &ac));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (Place::Side(1), to_line(&wb, &(c - b)));
    }
    (Place::Inside, to_plane(&wa, &ab.cross(&ac)))
}

/// Closest place of a planar convex polygon to `x`, and the vector from `x` to it.
pub(crate) fn closest_on_polygon(x: &Vec3, corners: &[u32], points: &[Vec3]) -> (Place, Vec3) {
    let count = corners.len();
    let p = |k: usize| &points[corners[k % count] as usize];
    let normal = area_vector(corners, points);
    let mut best: Option<(f64, Place, Vec3)> = None;
    for k in 0..count {
        let (a, b) = (p(k), p(k + 1));
        let (u, w) = (b - a, a - x);
        // Negative where x projects beyond this side.
        if normal.dot(&w.cross(&u)) > 0.0 {
            continue;
        }
        let along = -w.dot(&u);
        let (place, offset) = if along <= 0.0 {
            (Place::Corner(k), w)
        } else if along >= u.norm_squared() {
            (Place::Corner((k + 1) % count), b - x)
        } else {
            (Place::Side(k), to_line(&w, &u))
        };
        let square = offset.norm_squared();
        if best.as_ref().is_none_or(|(least, ..)| square < *least) {
            best = Some((square, place, offset));
        }
    }
    match best {
        Some((_, place, offset)) => (place, offset),
        None => (Place::Inside, to_plane(&(p(0) - x), &normal)),
    }
}

/// Twice the area vector of a planar polygon.
pub(crate) fn area_vector(corners: &[u32], points: &[Vec3]) -> Vec3 {
    let p = |k: usize| points[corners[k] as usize];
    (1..corners.len() - 1).map(|k| (p(k) - p(0)).cross(&(p(k + 1) - p(0)))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_place_of_the_triangle_is_closer(
            corners in prop::array::uniform3(prop::array::uniform3(-1f64..1.0)),
            x in prop::array::uniform3(-2f64..2.0),
            samples in prop::collection::vec((0f64..1.0, 0f64..1.0), 20),
        ) {
            let [a, b, c] = corners.map(Vec3::from);
            prop_assume!((b - a).cross(&(c - a)).norm() > 1e-2);
            let x = Vec3::from(x);
            let (place, offset) = closest_on_triangle(&x, [&a, &b, &c]);
            for (s, t) in samples {
                let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                let sample = a + (b - a) * s + (c - a) * t;
                prop_assert!((sample - x).norm() >= offset.norm() - 1e-12);
            }
            let (again, same) = closest_on_polygon(&x, &[0, 1, 2], &[a, b, c]);
            prop_assert!((offset - same).norm() < 1e-9, "{:?} {:?}", place, again);
        }
    }

    #[test]
    fn a_centre_straight_above_gives_no_lateral_part() {
        let points = [Vec3::new(-0.3, 0.0, -0.1), Vec3::new(0.7, 0.0, -0.1), Vec3::new(0.1, 0.9, -0.1)];
        let x = Vec3::new(0.123, 0.234, 0.5);
        let (place, offset) = closest_on_triangle(&x, [&points[0], &points[1], &points[2]]);
        assert_eq!((place, offset.x, offset.y), (Place::Inside, 0.0, 0.0));
        let (place, offset) = closest_on_triangle(&Vec3::new(0.123, -0.2, 0.5), [&points[0], &points[1], &points[2]]);
        assert_eq!((place, offset.x), (Place::Side(0), 0.0));
    }
}
