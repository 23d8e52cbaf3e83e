use std::collections::BTreeMap;

use fractum_math::Vec3;

use crate::{ClosedSurface, PackError, SurfaceData};

/// Reads an STL file, binary or ASCII, as a closed surface.
///
/// # Errors
/// Those of [`read_stl_facets`] and of [`ClosedSurface::new`].
pub fn read_stl(bytes: &[u8], scale: f64) -> Result<ClosedSurface, PackError> {
    let SurfaceData { points, triangles } = read_stl_facets(bytes, scale)?;
    let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
    ClosedSurface::new(&points, &triangles)
}

/// Reads the triangles of an STL file, binary or ASCII; vertices with equal coordinates are merged.
///
/// - `bytes`: the whole file
/// - `scale`: metres per file unit (STL has none)
///
/// # Errors
/// [`PackError::Stl`] with the offset or line for a malformed file.
pub fn read_stl_facets(bytes: &[u8], scale: f64) -> Result<SurfaceData, PackError> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(PackError::Stl(format!("scale {scale}; expected a positive number of metres per unit")));
    }
    let corners = if is_binary(bytes) { binary(bytes) } else { ascii(bytes)? };
    let mut ids: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for corner in corners.chunks_exact(3) {
        let mut triangle = [0u32; 3];
        for (id, &c) in triangle.iter_mut().zip(corner) {
            // Adding zero makes -0 and +0 the same vertex.
            let key = c.map(|v| (v + 0.0).to_bits());
            *id = *ids.entry(key).or_insert_with(|| {
                points.push(c.map(|v| v * scale));
                points.len() as u32 - 1
            });
        }
        if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0] {
            triangles.push(triangle);
        }
    }
    if triangles.is_empty() {
        return Err(PackError::Stl("no triangles".into()));
    }
    Ok(SurfaceData { points, triangles })
}

/// A binary file states its own length; "solid" at the start proves nothing, as many binary writers put it there.
fn is_binary(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(80..84) else { return false };
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    count.checked_mul(50).and_then(|n| n.checked_add(84)) == Some(bytes.len())
}

fn binary(bytes: &[u8]) -> Vec<[f64; 3]> {
    let float = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let vertices = |facet: &[u8]| [0, 1, 2].map(|v| [0, 1, 2].map(|c| float(&facet[12 + 12 * v + 4 * c..])));
    bytes[84..].chunks_exact(50).flat_map(vertices).collect()
}

fn ascii(bytes: &[u8]) -> Result<Vec<[f64; 3]>, PackError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|e| PackError::Stl(format!("neither text nor a complete binary file (offset {})", e.valid_up_to())))?;
    if !text.trim_start().starts_with("solid") {
        return Err(PackError::Stl(
            "it does not start with `solid`, and its length is not that of a binary file".into(),
        ));
    }
    let mut corners = Vec::new();
    let mut ended = false;
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => {
                let mut next = || words.next().and_then(|w| w.parse::<f64>().ok());
                let (Some(x), Some(y), Some(z)) = (next(), next(), next()) else {
                    return Err(PackError::Stl(format!(
                        "line {}: expected `vertex x y z`, found `{}`",
                        number + 1,
                        line.trim()
                    )));
                };
                corners.push([x, y, z]);
            }
            Some("endfacet") if corners.len() % 3 != 0 => {
                return Err(PackError::Stl(format!("line {}: a facet without three vertices", number + 1)));
            }
            Some("endsolid") => ended = true,
            _ => {}
        }
    }
    if ended && corners.len() % 3 == 0 {
        Ok(corners)
    } else {
        Err(PackError::Stl("the file ends before `endsolid`".into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::cube;

    fn ascii_cube() -> String {
        let (points, triangles) = cube(1.0);
        let mut text = String::from("solid cube\n");
        for t in triangles {
            text += "facet normal 0 0 0\nouter loop\n";
            for v in t {
                let p = points[v as usize];
                text += &format!("vertex {} {} {}\n", p.x, p.y, p.z);
            }
            text += "endloop\nendfacet\n";
        }
        text + "endsolid cube\n"
    }

    fn binary_cube() -> Vec<u8> {
        let (points, triangles) = cube(1.0);
        let mut bytes = b"solid, and still binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for t in triangles {
            bytes.extend([0u8; 12]);
            for v in t {
                points[v as usize].iter().for_each(|&c| bytes.extend((c as f32).to_le_bytes()));
            }
            bytes.extend([0u8; 2]);
        }
        bytes
    }

    #[test]
    fn both_flavours_give_the_same_cube() {
        for bytes in [ascii_cube().into_bytes(), binary_cube()] {
            let surface = read_stl(&bytes, 1e-3).unwrap();
            assert!((surface.volume() - 1e-9).abs() < 1e-20);
        }
    }

    #[test]
    fn truncated_files_are_errors_at_every_length() {
        let text = ascii_cube().into_bytes();
        for end in (0..text.len() - 10).step_by(7) {
            assert!(read_stl(&text[..end], 1.0).is_err(), "text cut at {end}");
        }
        let binary = binary_cube();
        for end in 0..binary.len() {
            assert!(read_stl(&binary[..end], 1.0).is_err(), "binary cut at {end}");
        }
    }

    #[test]
    fn an_open_file_names_its_open_edges() {
        let text = ascii_cube();
        let open = text.replacen(
            "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 1 0\nendloop\nendfacet\n",
            "",
            1,
        );
        assert_ne!(open, text);
        assert!(matches!(read_stl(open.as_bytes(), 1.0), Err(PackError::OpenSurface { open: 3, .. })));
    }
}
