/// The shape of an element, whatever its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    Point,
    Line,
    Triangle,
    Quad,
    Tetrahedron,
    Hexahedron,
    Prism,
    Pyramid,
}

/// A Gmsh element type with a fixed number of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ElementType {
    pub(crate) shape: Shape,
    /// Nodes per element in the file; the corners come first.
    pub(crate) nodes: usize,
}

impl Shape {
    pub(crate) fn dimension(self) -> u8 {
        match self {
            Shape::Point => 0,
            Shape::Line => 1,
            Shape::Triangle | Shape::Quad => 2,
            Shape::Tetrahedron | Shape::Hexahedron | Shape::Prism | Shape::Pyramid => 3,
        }
    }

    /// Corner nodes, which are all that the reader keeps.
    pub(crate) fn corners(self) -> usize {
        match self {
            Shape::Point => 1,
            Shape::Line => 2,
            Shape::Triangle => 3,
            Shape::Quad | Shape::Tetrahedron => 4,
            Shape::Pyramid => 5,
            Shape::Prism => 6,
            Shape::Hexahedron => 8,
        }
    }

    /// Corners of each facet of a solid, or of each side of a flat element, in the order of Abaqus. Facets turn as seen
    /// from within.
    pub(crate) fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Shape::Point | Shape::Line => &[],
            Shape::Triangle => &[&[0, 1], &[1, 2], &[2, 0]],
            Shape::Quad => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            Shape::Tetrahedron => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
            Shape::Pyramid => &[&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]],
            Shape::Prism => &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
            Shape::Hexahedron => {
                &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]]
            }
        }
    }

    pub(crate) fn singular(self) -> &'static str {
        match self {
            Shape::Point => "point",
            Shape::Line => "line",
            Shape::Triangle => "triangle",
            Shape::Quad => "quadrilateral",
            Shape::Tetrahedron => "tetrahedron",
            Shape::Hexahedron => "hexahedron",
            Shape::Prism => "prism",
            Shape::Pyramid => "pyramid",
        }
    }

    pub(crate) fn plural(self) -> &'static str {
        match self {
            Shape::Point => "points",
            Shape::Line => "lines",
            Shape::Triangle => "triangles",
            Shape::Quad => "quadrilaterals",
            Shape::Tetrahedron => "tetrahedra",
            Shape::Hexahedron => "hexahedra",
            Shape::Prism => "prisms",
            Shape::Pyramid => "pyramids",
        }
    }

    /// `1 prism`, `12 prisms`.
    pub(crate) fn counted(self, count: usize) -> String {
        format!("{count} {}", if count == 1 { self.singular() } else { self.plural() })
    }
}

impl ElementType {
    /// The type with that Gmsh number; none for polygons, enriched elements and numbers that Gmsh does not use.
    pub(crate) fn from_code(code: u64) -> Option<ElementType> {
        let (shape, nodes) = match code {
            15 => (Shape::Point, 1),
            1 => (Shape::Line, 2),
            8 => (Shape::Line, 3),
            26..=28 => (Shape::Line, code as usize - 22),
            62..=66 => (Shape::Line, code as usize - 55),
            2 => (Shape::Triangle, 3),
            9 => (Shape::Triangle, 6),
            20 => (Shape::Triangle, 9),
            21 => (Shape::Triangle, 10),
            22 => (Shape::Triangle, 12),
            23 | 24 => (Shape::Triangle, 15),
            25 => (Shape::Triangle, 21),
            42..=46 => (Shape::Triangle, [28, 36, 45, 55, 66][code as usize - 42]),
            52..=56 => (Shape::Triangle, [18, 21, 24, 27, 30][code as usize - 52]),
            3 => (Shape::Quad, 4),
            10 => (Shape::Quad, 9),
            16 => (Shape::Quad, 8),
            36..=41 => (Shape::Quad, [16, 25, 36, 12, 16, 20][code as usize - 36]),
            47..=51 => (Shape::Quad, [49, 64, 81, 100, 121][code as usize - 47]),
            57..=61 => (Shape::Quad, [24, 28, 32, 36, 40][code as usize - 57]),
            4 => (Shape::Tetrahedron, 4),
            11 => (Shape::Tetrahedron, 10),
            29..=33 => (Shape::Tetrahedron, [20, 35, 56, 22, 28][code as usize - 29]),
            71..=75 => (Shape::Tetrahedron, [84, 120, 165, 220, 286][code as usize - 71]),
            79..=83 => (Shape::Tetrahedron, [34, 40, 46, 52, 58][code as usize - 79]),
            137 => (Shape::Tetrahedron, 16),
            5 => (Shape::Hexahedron, 8),
            12 => (Shape::Hexahedron, 27),
            17 => (Shape::Hexahedron, 20),
            92..=98 => (Shape::Hexahedron, [64, 125, 216, 343, 512, 729, 1000][code as usize - 92]),
            99..=105 => (Shape::Hexahedron, [32, 44, 56, 68, 80, 92, 104][code as usize - 99]),
            6 => (Shape::Prism, 6),
            13 => (Shape::Prism, 18),
            18 => (Shape::Prism, 15),
            7 => (Shape::Pyramid, 5),
            14 => (Shape::Pyramid, 14),
            19 => (Shape::Pyramid, 13),
            118..=124 => (Shape::Pyramid, [30, 55, 91, 140, 204, 285, 385][code as usize - 118]),
            125..=131 => (Shape::Pyramid, [21, 29, 37, 45, 53, 61, 69][code as usize - 125]),
            _ => return None,
        };
        Some(ElementType { shape, nodes })
    }

    /// Whether the element has nodes besides its corners.
    pub(crate) fn has_mid_nodes(self) -> bool {
        self.nodes > self.shape.corners()
    }

    /// What to say about a number that [`ElementType::from_code`] does not know.
    pub(crate) fn name_of_unknown(code: i64) -> String {
        match code {
            34 | 69 => format!("element type {code} (polygon)"),
            35 => format!("element type {code} (polyhedron)"),
            67 | 68 | 70 => format!("element type {code} (border element)"),
            84..=89 | 132 => format!("element type {code} (element of order 0)"),
            133..=136 => format!("element type {code} (enriched element)"),
            _ => format!("element type {code}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edge_of_a_solid_is_passed_once_each_way() {
        for shape in [Shape::Tetrahedron, Shape::Pyramid, Shape::Prism, Shape::Hexahedron] {
            let around = |face: &&'static [usize]| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]);
            let mut edges: Vec<[usize; 2]> = shape.faces().iter().flat_map(around).collect::<Vec<_>>();
            edges.sort_unstable();
            let mut back: Vec<[usize; 2]> = edges.iter().map(|&[a, b]| [b, a]).collect();
            back.sort_unstable();
            assert_eq!(edges, back, "{shape:?}");
            edges.dedup();
            // Euler: corners - edges + faces = 2, and each edge is there twice.
            assert_eq!(shape.corners() + shape.faces().len(), 2 + edges.len() / 2, "{shape:?}");
        }
    }

    #[test]
    fn node_counts_are_those_of_complete_and_serendipity_orders() {
        // complete order p: p+1, (p+1)(p+2)/2, (p+1)², (p+1)(p+2)(p+3)/6, (p+1)³ nodes
        let complete = |p: usize| {
            let n = p + 1;
            [n, n * (n + 1) / 2, n * n, n * (n + 1) * (n + 2) / 6, n * n * n]
        };
        let orders: [(usize, [u64; 5]); 5] = [
            (1, [1, 2, 3, 4, 5]),
            (2, [8, 9, 10, 11, 12]),
            (3, [26, 21, 36, 29, 92]),
            (4, [27, 23, 37, 30, 93]),
            (10, [66, 46, 51, 75, 0]),
        ];
        for (order, codes) in orders {
            for (code, nodes) in codes.into_iter().zip(complete(order)).filter(|(code, _)| *code > 0) {
                assert_eq!(ElementType::from_code(code).unwrap().nodes, nodes, "type {code}");
            }
        }
        for (code, nodes) in [(16, 8), (17, 20), (18, 15), (19, 13), (20, 9), (39, 12), (99, 32)] {
            assert_eq!(ElementType::from_code(code).unwrap().nodes, nodes, "type {code}");
        }
        assert_eq!(ElementType::from_code(34), None);
        assert_eq!(ElementType::from_code(u64::MAX), None);
    }
}
