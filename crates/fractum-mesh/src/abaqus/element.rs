//! Types and faces of elements.

use crate::tagged::element_type::{ElementType, Shape};

/// Families of elements by the beginning of their names, with their nodes. A digit after it is another family.
const FAMILIES: [(&[&str], Shape, usize); 18] = [
    (&["C3D4", "DC3D4", "AC3D4", "F3D4"], Shape::Tetrahedron, 4),
    (&["C3D10", "DC3D10", "AC3D10"], Shape::Tetrahedron, 10),
    (&["C3D8", "DC3D8", "AC3D8", "F3D8", "SC8", "CSS8"], Shape::Hexahedron, 8),
    (&["C3D20", "DC3D20", "AC3D20"], Shape::Hexahedron, 20),
    (&["C3D27"], Shape::Hexahedron, 27),
    (&["C3D6", "DC3D6", "AC3D6", "F3D6", "SC6"], Shape::Prism, 6),
    (&["C3D15", "DC3D15", "AC3D15"], Shape::Prism, 15),
    (&["C3D13"], Shape::Pyramid, 13),
    (&["C3D5", "DC3D5", "AC3D5"], Shape::Pyramid, 5),
    (
        &["CPE3", "CPS3", "CPEG3", "CAX3", "CGAX3", "DCAX3", "DC2D3", "S3", "STRI3", "M3D3", "R3D3", "SFM3D3", "DS3"],
        Shape::Triangle,
        3,
    ),
    (
        &["CPE6", "CPS6", "CPEG6", "CAX6", "CGAX6", "DCAX6", "DC2D6", "STRI65", "M3D6", "SFM3D6", "DS6", "S6"],
        Shape::Triangle,
        6,
    ),
    (
        &["CPE4", "CPS4", "CPEG4", "CAX4", "CGAX4", "DCAX4", "DC2D4", "S4", "M3D4", "R3D4", "SFM3D4", "DS4"],
        Shape::Quad,
        4,
    ),
    (&["CPE8", "CPS8", "CPEG8", "CAX8", "CGAX8", "DCAX8", "DC2D8", "S8", "M3D8", "SFM3D8", "DS8"], Shape::Quad, 8),
    (&["S9", "M3D9"], Shape::Quad, 9),
    (&["T2D2", "T3D2", "B21", "B31", "B23", "B33", "R2D2", "RB2D2", "RB3D2", "DC1D2"], Shape::Line, 2),
    (&["T2D3", "T3D3", "B22", "B32", "DC1D3"], Shape::Line, 3),
    (&["SAX1"], Shape::Line, 2),
    (&["SAX2"], Shape::Line, 3),
];

/// The type of that name, in capitals; none for springs, masses and others that are no part of a body.
pub(super) fn of_name(name: &str) -> Option<ElementType> {
    let is_of =
        |family: &str| name.strip_prefix(family).is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()));
    let (_, shape, nodes) = FAMILIES.iter().find(|(families, ..)| families.iter().any(|family| is_of(family)))?;
    Some(ElementType { shape: *shape, nodes: *nodes })
}

/// Whether elements of that type stand for a ring.
pub(super) fn is_axisymmetric(name: &str) -> bool {
    ["CAX", "CGAX", "DCAX", "SAX"].iter().any(|family| name.starts_with(family))
}

/// Whether elements of that type have faces above and below, and sides, rather than sides alone.
pub(super) fn is_shell(name: &str) -> bool {
    ["S", "DS", "M3D", "R3D"].iter().any(|family| {
        let rest = name.strip_prefix(family).and_then(|rest| rest.strip_prefix("TRI").or(Some(rest)));
        rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    })
}

/// What a surface takes of an element.
pub(super) enum Face {
    /// The element itself.
    Whole,
    /// Corners of a side or facet, by their places in the element.
    Side(&'static [usize]),
}

/// The face of that label, as `S2`; none where such an element has none. Sides of shells are `E1`, ..., or `S3`, ... as CalculiX counts
/// them after the faces.
pub(super) fn face(shape: Shape, shell: bool, label: &str) -> Option<Face> {
    let label = label.to_uppercase();
    let flat = matches!(shape, Shape::Triangle | Shape::Quad);
    if flat && ["SPOS", "SNEG", "SP", "SN"].contains(&label.as_str()) {
        return Some(Face::Whole);
    }
    let number: usize = label.strip_prefix(['S', 'E'])?.parse().ok()?;
    let before = if shell && label.starts_with('S') { 2 } else { 0 };
    if (1..=before).contains(&number) {
        return Some(Face::Whole);
    }
    shape.faces().get(number.checked_sub(before + 1)?).map(|side| Face::Side(side))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_shapes_whatever_follows_them() {
        for (name, shape, nodes) in [
            ("C3D4", Shape::Tetrahedron, 4),
            ("C3D10MH", Shape::Tetrahedron, 10),
            ("C3D8R", Shape::Hexahedron, 8),
            ("CPS3", Shape::Triangle, 3),
            ("S3R", Shape::Triangle, 3),
            ("STRI65", Shape::Triangle, 6),
            ("S4R5", Shape::Quad, 4),
            ("CPE4RT", Shape::Quad, 4),
            ("B31OS", Shape::Line, 2),
        ] {
            assert_eq!(of_name(name), Some(ElementType { shape, nodes }), "{name}");
        }
        for name in ["S3", "S8R", "STRI65", "M3D4", "R3D4"] {
            assert!(is_shell(name), "{name}");
        }
        for name in ["CPS4", "SPRINGA", "SC8R", "C3D8", "SAX1"] {
            assert!(!is_shell(name), "{name}");
        }
        for name in ["SPRINGA", "MASS", "C3D", "", "C3D11", "CONN3D2"] {
            assert_eq!(of_name(name), None, "{name}");
        }
    }
}
