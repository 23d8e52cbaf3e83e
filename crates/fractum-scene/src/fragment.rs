use fractum_fem::Solid;
use fractum_math::{Vec3, connected};

/// A connected piece of a solid or of a bonded body, or a single discrete element that nothing holds any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// Nodes in the piece; particles in that of a bonded body, and after the nodes where both are tied.
    pub nodes: Vec<u32>,
    /// Elements that are still there.
    pub elements: usize,
    /// Bonds that still hold.
    pub bonds: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Volume of its elements, or of the continuum that its particles stand for [m³]; 0 for a single discrete element.
    pub volume: f64,
    /// Centre of mass [m].
    pub centroid: Vec3,
    /// Velocity of the centre of mass [m/s].
    pub velocity: Vec3,
    /// Corners of the box around it [m].
    pub bounds: [Vec3; 2],
}

impl Fragment {
    /// Largest side of the box around it [m].
    pub fn extent(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).max()
    }

    /// One piece of both.
    fn take(&mut self, other: Fragment) {
        let mass = self.mass + other.mass;
        let mean = |a: Vec3, b: Vec3| (a * self.mass + b * other.mass) / mass;
        (self.centroid, self.velocity) = (mean(self.centroid, other.centroid), mean(self.velocity, other.velocity));
        self.bounds = [self.bounds[0].inf(&other.bounds[0]), self.bounds[1].sup(&other.bounds[1])];
        self.mass = mass;
        self.volume += other.volume;
        self.elements += other.elements;
        self.bonds += other.bonds;
        self.nodes.extend(other.nodes);
    }
}

/// Pieces of solids and of bonded bodies, those that ties hold together as one.
///
/// - `links`: pairs of a particle and a node that are tied
pub(crate) fn joined(
    mut solids: Vec<Fragment>,
    mut bonded: Vec<Fragment>,
    links: impl Iterator<Item = (u32, u32)>,
) -> Vec<Fragment> {
    let owners = |pieces: &[Fragment]| {
        let size = pieces.iter().flat_map(|p| &p.nodes).max().map_or(0, |n| *n as usize + 1);
        let mut owner = vec![0u32; size];
        for (index, piece) in (0..).zip(pieces) {
            piece.nodes.iter().for_each(|&n| owner[n as usize] = index);
        }
        owner
    };
    let (of_node, of_particle) = (owners(&solids), owners(&bonded));
    let shift = solids.len() as u32;
    solids.append(&mut bonded);
    let pairs = links.map(|(particle, node)| [of_node[node as usize], shift + of_particle[particle as usize]]);
    let part = connected(solids.len(), pairs);
    let mut whole: Vec<Option<Fragment>> = solids.into_iter().map(Some).collect();
    for index in (0..whole.len()).rev() {
        let first = part[index] as usize;
        if first != index
            && let Some(part) = whole[index].take()
            && let Some(first) = &mut whole[first]
        {
            first.take(part);
        }
    }
    whole.into_iter().flatten().collect()
}

/// Pieces connected by elements, heaviest first.
pub fn fragments(solid: &Solid) -> Vec<Fragment> {
    let part = parts(solid);
    let mut elements = vec![0usize; part.len()];
    let mut volume = vec![0.0; part.len()];
    for body in 0..solid.body_count() {
        let alive = solid.alive(body);
        for (index, nodes) in solid.body(body).elements.iter().enumerate().filter(|(e, _)| alive[*e]) {
            let place = part[nodes[0] as usize] as usize;
            elements[place] += 1;
            volume[place] += solid.element_volume(body, index as u32);
        }
    }
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
    for (node, &place) in (0..).zip(&part) {
        members[place as usize].push(node);
    }
    let mut pieces: Vec<Fragment> = members
        .into_iter()
        .enumerate()
        .filter(|(_, nodes)| !nodes.is_empty())
        .map(|(place, nodes)| piece(solid, nodes, elements[place], volume[place]))
        .collect();
    pieces.sort_by(|a, b| b.mass.total_cmp(&a.mass).then(a.nodes[0].cmp(&b.nodes[0])));
    pieces
}

/// The smallest node that live elements connect each node to.
pub(crate) fn parts(solid: &Solid) -> Vec<u32> {
    let links = (0..solid.body_count()).flat_map(|body| {
        let corners = solid.body(body).shape.node_count();
        let alive = solid.body(body).elements.iter().zip(solid.alive(body)).filter(|(_, alive)| **alive);
        alive.flat_map(move |(nodes, _)| nodes[1..corners].iter().map(|&node| [nodes[0], node]))
    });
    connected(solid.reference.len(), links)
}

fn piece(solid: &Solid, nodes: Vec<u32>, elements: usize, volume: f64) -> Fragment {
    let (mut mass, mut centroid, mut velocity) = (0.0, Vec3::zeros(), Vec3::zeros());
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for &node in &nodes {
        let (i, position) = (node as usize, solid.position(node as usize));
        mass += solid.mass[i];
        centroid += position * solid.mass[i];
        velocity += solid.velocity[i] * solid.mass[i];
        low = low.inf(&position);
        high = high.sup(&position);
    }
    let bounds = [low, high];
    Fragment { nodes, elements, bonds: 0, mass, volume, centroid: centroid / mass, velocity: velocity / mass, bounds }
}
