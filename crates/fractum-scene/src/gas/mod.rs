//! Gas in holes and in the cracks that open to them: one network of cells, coupled with the solids at every step.
//!
//! A cell is a hole, a face of an interface or a removed element of the [`CrackNetwork`]. The pressure of tⁿ acts on the walls; the work of these
//! forces, in the two half steps beside tⁿ as that of all forces, is what the cells lose, so that the balance of solids
//! and gas closes as that of the solids does. Between two such half works the gas flows for the time of the step.

mod cavity;
mod face_cells;
mod hole_ends;
mod measure;
mod settings;

use fractum_fem::{CrackCell, CrackNetwork, CrackNetworkState, CrackSide, Solid, cracks};
use fractum_gas::{Amount, Contents, Network, Passage};
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::facet::share_of_torn;
use crate::interfaces::Interfaces;
use crate::time_function::TimeFunction;
use cavity::Cavity;
pub(crate) use cavity::enclosed_volume;
use face_cells::FaceCells;
pub use hole_ends::{HoleEnds, SymmetryPlanes};
pub use measure::GasMeasure;
pub use settings::{Charge, GasHole, GasSettings, GasSource, Stemming};

/// Part of its energy that a cell passes on as a facet between it and another removed element moves, at most.
const LARGEST_EXCHANGE: f64 = 0.2;
/// Factor by which the frequency of the gas is raised when it has become too low, so that the step seldom changes.
const RESERVE: f64 = 1.5;
/// Walls of one cell and its neighbours that share a node, in the plane and in space.
const WALLS_OF_NODE: [f64; 2] = [2.0, 6.0];

/// A wall under pressure.
#[derive(Clone, Copy, Debug)]
struct Wall {
    cell: u32,
    nodes: [u32; 3],
    /// Outward area vector of the element behind it at tⁿ [m²].
    area: Vec3,
}

/// Gas in holes and cracks.
#[derive(Clone)]
pub struct Gas {
    /// With the holes and then the faces of interfaces as mouths.
    cracks: CrackNetwork,
    network: Network,
    holes: Vec<GasHole>,
    faces: FaceCells,
    least_opening: f64,
    in_cracks: bool,
    symmetry: SymmetryPlanes,
    /// Room of each cell: holes first, then faces of interfaces, then those of the cracks in their order.
    cavities: Vec<Cavity>,
    volumes: Vec<f64>,
    /// Out of holes with stemming first, then those of the faces, then those of the cracks.
    passages: Vec<Passage>,
    /// Number of passages out of holes, and of those that are not of cracks.
    vents: usize,
    fixed: usize,
    /// Facet of each passage of a crack, its normal pointing into the first cell.
    facets: Vec<[u32; 3]>,
    walls: Vec<Wall>,
    /// Volume that the walls of each cell sweep per time, outwards [m³/s].
    swept: Vec<f64>,
    /// Area of the walls of each cell [m²].
    wall_area: Vec<f64>,
    /// Energy in all cells at tⁿ [J].
    energy: f64,
    frequency_square: f64,
}

/// What changes during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GasState {
    cracks: CrackNetworkState,
    /// The hole that each face got gas from first.
    from: Vec<Option<u32>>,
    contents: Contents,
    push: Vec<f64>,
    energy: f64,
    frequency_square: f64,
}

/// Where gas is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GasRoom {
    /// In a hole, by its number.
    Hole(usize),
    /// Between the sides of a face of an interface, by its number.
    Face(usize),
    /// In a removed element, by body and element.
    Element(usize, u32),
}

/// A cell of gas as results show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasCell {
    /// Where it is.
    pub room: GasRoom,
    /// Pressure [Pa].
    pub pressure: f64,
    /// Temperature [K].
    pub temperature: f64,
    /// Mean distance of the walls [m]; unlimited in a hole.
    pub opening: f64,
    /// Room for gas [m³].
    pub volume: f64,
    /// Mass and internal energy.
    pub amount: Amount,
}

impl GasCell {
    /// Body and element that was removed there; none of holes and interfaces.
    pub fn element(&self) -> Option<(usize, u32)> {
        if let GasRoom::Element(body, element) = self.room { Some((body, element)) } else { None }
    }
}

impl Gas {
    /// Gas in the holes of a solid without displacement, before its cracks are found.
    pub fn new(solid: &Solid, settings: GasSettings) -> Self {
        let GasSettings { law, slits, least_opening, in_cracks, outside_pressure, symmetry, holes } = settings;
        let mut network = Network::new(law, slits, outside_pressure);
        let mut cavities = Vec::new();
        for hole in &holes {
            let volume = enclosed_volume(solid, &hole.facets, &hole.ends, |node| solid.reference[node as usize]);
            let amount = match hole.charge {
                Charge::Amount(amount) => amount,
                Charge::State { pressure, temperature } => {
                    let (mass, energy) = law.law().contents(volume, pressure, temperature).unwrap_or_default();
                    Amount { mass, energy }
                }
            };
            network.push_cell(amount);
            cavities.push(Cavity::hole(volume));
        }
        let vents = (0..).zip(&holes).filter_map(|(cell, hole)| Some(hole.stemming?.passage(cell, f64::NEG_INFINITY)));
        let passages: Vec<Passage> = vents.collect();
        let mouths = holes.iter().map(|hole| hole.facets.clone()).collect();
        Gas {
            cracks: CrackNetwork::new(solid, mouths),
            network,
            holes,
            faces: FaceCells::default(),
            least_opening,
            in_cracks,
            symmetry,
            volumes: Vec::new(),
            vents: passages.len(),
            fixed: passages.len(),
            passages,
            facets: Vec::new(),
            walls: Vec::new(),
            swept: Vec::new(),
            wall_area: Vec::new(),
            energy: 0.0,
            frequency_square: 0.0,
            cavities,
        }
    }

    /// Lets gas that enters cracks enter interfaces too, before its first step.
    pub(crate) fn enter(&mut self, solid: &Solid, interfaces: &Interfaces) {
        if !self.in_cracks || interfaces.is_empty() {
            return;
        }
        self.faces = FaceCells::new(interfaces);
        let Gas { cracks, network, holes, faces, cavities, passages, facets, .. } = self;
        let of_holes = holes.iter().map(|hole| hole.facets.clone());
        *cracks = CrackNetwork::new(solid, of_holes.chain(faces.sides.iter().map(|sides| sides.to_vec())).collect());
        cavities.truncate(holes.len());
        cavities.extend(faces.cavities(solid, self.least_opening));
        network.truncate(holes.len());
        faces.sides.iter().for_each(|_| network.push_cell(Amount::default()));
        passages.truncate(self.vents);
        passages.extend(faces.passages(solid, cracks, holes, self.symmetry));
        facets.clear();
        self.fixed = self.passages.len();
        self.open(solid);
    }

    /// Volume of a hole without load [m³]; not positive where its facets are turned inside out or flat.
    pub fn hole_volume(solid: &Solid, facets: &[[u32; 3]], ends: &HoleEnds) -> f64 {
        enclosed_volume(solid, facets, ends, |node| solid.reference[node as usize])
    }

    /// Lets the gas find what is open already, before its first step.
    pub(crate) fn open(&mut self, solid: &Solid) {
        if self.in_cracks {
            self.cracks.extend_by_all(solid);
            self.add_cells(solid);
        }
        self.update_rooms(solid);
        self.find_walls(solid);
        for cell in 0..self.cavities.len() {
            self.cavities[cell].push = self.network.pressure(cell, self.volumes[cell]) * self.cavities[cell].share;
        }
        self.update_frequency(solid);
    }

    /// Lets gas enter what the removal of elements has opened.
    pub(crate) fn extend(&mut self, solid: &Solid, removed: &[(usize, u32)]) {
        if self.in_cracks {
            self.cracks.extend(solid, removed.iter().copied());
            self.add_cells(solid);
        }
    }

    /// The first cell of cracks.
    fn first_of_cracks(&self) -> usize {
        self.holes.len() + self.faces.sides.len()
    }

    /// Cells and passages of the cracks that the network has reached since.
    fn add_cells(&mut self, solid: &Solid) {
        let first = self.first_of_cracks();
        for number in self.cavities.len() - first..self.cracks.cells().len() {
            let cell = self.cracks.cells()[number].clone();
            let (body, element) = (cell.body as usize, cell.element);
            let volume = solid.element_volume(body, element);
            let length = cracks::characteristic_length(solid, body, element);
            self.cavities.push(Cavity::crack(volume, length, self.least_opening));
            self.network.push_cell(Amount::default());
            for (side, nodes) in cell.sides.iter().zip(&cell.nodes) {
                let beyond = match side {
                    CrackSide::Mouth(mouth) => *mouth,
                    // The later one of two cells makes their passage.
                    CrackSide::Cell(other) if (*other as usize) < number => first as u32 + other,
                    CrackSide::Outside if !self.symmetry.hold(solid, nodes, length) => Passage::OUTSIDE,
                    _ => continue,
                };
                let passage = self.passage(solid, number, *side, nodes);
                self.passages.push(Passage { cells: [(first + number) as u32, beyond], ..passage });
                self.facets.push(*nodes);
            }
        }
    }

    /// Length and width of the passage through a side of a crack cell.
    fn passage(&self, solid: &Solid, number: usize, side: CrackSide, nodes: &[u32; 3]) -> Passage {
        let middle = |cell: &CrackCell| solid.element_middle(cell.body as usize, cell.element);
        let cells = self.cracks.cells();
        let own = middle(&cells[number]);
        let [a, b, c] = nodes.map(|node| solid.reference[node as usize]);
        let plane = nodes[1] == nodes[2];
        let centre = if plane { (a + b) * 0.5 } else { (a + b + c) / 3.0 };
        let other = if let CrackSide::Cell(other) = side { middle(&cells[other as usize]) } else { centre };
        let area = cracks::area_at(solid, nodes, |node| solid.reference[node as usize]).norm();
        // The crack cuts an edge of the plane in a point, a triangle in a line of about the root of its area.
        let width = if plane { area / (b - a).norm() } else { area.sqrt() };
        Passage { cells: [0; 2], length: (other - own).norm(), width, opening: 0.0 }
    }

    /// Room of every cell and opening of every passage, as the nodes lie.
    fn update_rooms(&mut self, solid: &Solid) {
        let first = self.first_of_cracks();
        let Gas { cracks, holes, faces, cavities, volumes, passages, vents, .. } = self;
        let (of_holes, rest) = cavities.split_at_mut(holes.len());
        let (of_faces, of_cracks) = rest.split_at_mut(faces.sides.len());
        for (cavity, hole) in of_holes.iter_mut().zip(&*holes) {
            let at = |node: u32| solid.position(node as usize);
            cavity.enclose(enclosed_volume(solid, &hole.facets, &hole.ends, at));
        }
        for (face, cavity) in of_faces.iter_mut().enumerate() {
            cavity.enclose(faces.enclosed(solid, face));
        }
        for (cavity, cell) in of_cracks.iter_mut().zip(cracks.cells()) {
            cavity.enclose(cracks::present_volume(solid, cell.body as usize, cell.element));
        }
        volumes.clear();
        volumes.extend(cavities.iter().map(|cavity| cavity.volume));
        for passage in &mut passages[*vents..] {
            let is_shut = |cell: usize| (holes.len()..first).contains(&cell) && !faces.is_open[cell - holes.len()];
            if passage.cells.iter().any(|cell| is_shut(*cell as usize)) {
                continue;
            }
            let [one, other] = passage.cells.map(|cell| cavities.get(cell as usize).map(Cavity::opening));
            let (one, other) = (one.unwrap_or(f64::INFINITY), other.unwrap_or(f64::INFINITY));
            // Two halves one behind the other: as tight as the tighter one makes them.
            passage.opening = if other.is_finite() { 2.0 * one * other / (one + other) } else { one };
        }
    }

    /// Walls with their present areas: of the holes, then of the cracks.
    fn find_walls(&mut self, solid: &Solid) {
        let first = self.first_of_cracks();
        let Gas { cracks, holes, faces, walls, wall_area, cavities, .. } = self;
        walls.clear();
        wall_area.clear();
        wall_area.resize(cavities.len(), 0.0);
        let mut add = |cell: usize, nodes: &[u32; 3]| {
            let area = cracks::area_at(solid, nodes, |node| solid.position(node as usize));
            let area =
                area * share_of_torn(&area, &cracks::area_at(solid, nodes, |node| solid.reference[node as usize]));
            wall_area[cell] += area.norm();
            walls.push(Wall { cell: cell as u32, nodes: *nodes, area });
        };
        let is_open = |cell: usize| cell.checked_sub(holes.len()).is_none_or(|face| faces.is_open[face]);
        for (cell, mouth) in cracks.mouths().iter().enumerate().filter(|(cell, _)| is_open(*cell)) {
            let live = mouth.facets.iter().zip(&mouth.live).filter(|(_, live)| **live);
            live.for_each(|(nodes, _)| add(cell, nodes));
        }
        for (number, cell) in cracks.cells().iter().enumerate() {
            cell.walls().for_each(|nodes| add(first + number, nodes));
        }
    }

    /// Volume that the walls of each cell sweep per time at the present velocities.
    fn find_swept(&mut self, solid: &Solid) {
        let Gas { walls, swept, cavities, .. } = self;
        swept.clear();
        swept.resize(cavities.len(), 0.0);
        for wall in walls {
            swept[wall.cell as usize] -= wall.area.dot(&mean_velocity(solid, &wall.nodes));
        }
    }

    /// Brings the gas to tⁿ and adds its forces to the nodes.
    ///
    /// - `elapsed`: time since the forces were last computed [s]
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, interfaces: &Interfaces, time: f64, elapsed: f64) {
        for (cell, hole) in self.holes.iter().enumerate() {
            if let Some(source) = &hole.source {
                let rate = |of: &TimeFunction| of(time - 0.5 * elapsed, &Vec3::zeros()) * elapsed;
                self.network.supply(cell, Amount { mass: rate(&source.mass), energy: rate(&source.energy) });
            }
        }
        let stemmed = (0..).zip(&self.holes).filter_map(|(cell, hole)| Some(hole.stemming?.passage(cell, time)));
        self.passages.iter_mut().zip(stemmed).for_each(|(passage, now)| *passage = now);
        self.exchange_across_facets(solid, elapsed);
        self.faces.look(interfaces);
        self.update_rooms(solid);
        self.network.flow(elapsed, &self.volumes, &self.passages);
        self.trace();
        self.find_walls(solid);
        self.find_swept(solid);
        for (cell, cavity) in self.cavities.iter_mut().enumerate() {
            let swept = 0.5 * elapsed * cavity.share * self.swept[cell];
            cavity.push = cavity.share * self.network.push_walls(cell, cavity.volume, swept);
        }
        self.energy = self.network.total().energy;
        self.update_frequency(solid);
        for wall in &self.walls {
            let force = wall.area * -self.cavities[wall.cell as usize].push;
            let corners = if wall.nodes[1] == wall.nodes[2] { 2 } else { 3 };
            for &node in &wall.nodes[..corners] {
                solid.force[node as usize] += force / corners as f64;
            }
        }
    }

    /// Takes the work of the forces of tⁿ in the half step after it out of the gas.
    pub(crate) fn spend_work(&mut self, solid: &Solid, dt_after: f64) {
        self.find_swept(solid);
        for (cell, cavity) in self.cavities.iter().enumerate() {
            self.network.do_work(cell, 0.5 * dt_after * cavity.push * self.swept[cell]);
        }
    }

    /// A facet between two removed elements moves with its nodes: what one of them loses in volume the other one gains, and
    /// the gas on one side does work on that on the other.
    fn exchange_across_facets(&mut self, solid: &Solid, elapsed: f64) {
        for (passage, nodes) in self.passages[self.fixed..].iter().zip(&self.facets) {
            let [own, other] = passage.cells.map(|cell| cell as usize);
            let Some(beyond) = self.cavities.get(other) else { continue };
            let push = self.cavities[own].push.min(beyond.push);
            if push <= 0.0 {
                continue;
            }
            let middle = |node: u32| solid.position(node as usize) - solid.velocity[node as usize] * (0.5 * elapsed);
            let area = cracks::area_at(solid, nodes, middle);
            let work = push * area.dot(&mean_velocity(solid, nodes)) * elapsed;
            let energy = |cell: usize| LARGEST_EXCHANGE * self.network.contents().cells[cell].energy.max(0.0);
            let work = work.clamp(-energy(own), energy(other));
            self.network.do_work(own, -work);
            self.network.do_work(other, work);
        }
    }

    /// Bound of the frequency that the gas as a spring gives the nodes of its walls: the sums over rows of M⁻¹K.
    fn update_frequency(&mut self, solid: &Solid) {
        let mut largest: f64 = 0.0;
        for wall in &self.walls {
            let cell = wall.cell as usize;
            let cavity = &self.cavities[cell];
            let stiffness = self.network.modulus(cell, cavity.volume) * cavity.share * cavity.share / cavity.volume
                * self.wall_area[cell];
            let plane = wall.nodes[1] == wall.nodes[2];
            let (corners, walls) = if plane { (2.0, WALLS_OF_NODE[0]) } else { (3.0, WALLS_OF_NODE[1]) };
            let mass = wall.nodes.iter().map(|&node| solid.mass[node as usize]).fold(f64::INFINITY, f64::min);
            largest = largest.max(walls * stiffness * wall.area.norm() / (corners * mass));
        }
        if largest > self.frequency_square {
            self.frequency_square = RESERVE * largest;
        }
    }

    /// Square of the frequency that the gas adds to that of the solids [1/s²].
    pub(crate) fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    /// Internal energy at tⁿ, what was supplied and what has leaked so far [J].
    pub(crate) fn energies(&self) -> [f64; 3] {
        let contents = self.network.contents();
        [self.energy, contents.supplied.energy, contents.leaked.energy]
    }

    /// Finds the hole from which faces have got gas first, themselves or in the cracks that were reached from them.
    fn trace(&mut self) {
        if self.faces.sides.is_empty() {
            return;
        }
        let first = self.first_of_cracks();
        let Gas { cracks, network, faces, holes, passages, vents, .. } = self;
        let mouth_of = |cell: usize| match cell.checked_sub(first) {
            Some(number) => cracks.cells().get(number).map(|own| own.mouth as usize),
            None => Some(cell),
        };
        for [a, b] in passages[*vents..].iter().map(|passage| passage.cells) {
            for [cell, other] in [[a, b], [b, a]] {
                let [Some(own), Some(beyond)] = [cell, other].map(|cell| mouth_of(cell as usize)) else { continue };
                let Some(face) = own.checked_sub(holes.len()).filter(|face| faces.from[*face].is_none()) else {
                    continue;
                };
                if network.contents().cells[cell as usize].mass > 0.0 {
                    let of_face = |face: usize| faces.from[face];
                    faces.from[face] = beyond.checked_sub(holes.len()).map_or(Some(beyond as u32), of_face);
                }
            }
        }
    }

    /// The cells: holes first, then faces of interfaces, then those of the cracks in the order in which they were reached.
    pub fn cells(&self) -> impl Iterator<Item = GasCell> {
        let (holes, first) = (self.holes.len(), self.first_of_cracks());
        self.cavities.iter().enumerate().map(move |(index, cavity)| {
            let of_crack = |number: usize| {
                let cell = &self.cracks.cells()[number];
                GasRoom::Element(cell.body as usize, cell.element)
            };
            GasCell {
                room: match index {
                    hole if hole < holes => GasRoom::Hole(hole),
                    face if face < first => GasRoom::Face(face - holes),
                    cell => of_crack(cell - first),
                },
                // After a step half of its work is already out of the gas: the pressure of tⁿ is that on the walls.
                pressure: cavity.push / cavity.share,
                temperature: self.network.temperature(index, cavity.volume),
                opening: cavity.opening(),
                volume: cavity.volume,
                amount: self.network.contents().cells[index],
            }
        })
    }

    /// Nodes around the holes, some of them more than once.
    pub(crate) fn hole_nodes(&self) -> impl Iterator<Item = u32> {
        self.holes.iter().flat_map(|hole| hole.facets.iter().flatten()).copied()
    }

    /// Number of holes.
    pub fn hole_count(&self) -> usize {
        self.holes.len()
    }

    /// What has leaked to the outside so far, with its enthalpy.
    pub fn leaked(&self) -> Amount {
        self.network.contents().leaked
    }

    /// Number of faces of interfaces that gas may enter.
    pub fn face_count(&self) -> usize {
        self.faces.sides.len()
    }

    /// Area of the walls of a hole, and of the interfaces and cracks that were reached from it, without load; or of all walls where gas is [m²].
    pub fn wetted_area(&self, solid: &Solid, hole: Option<usize>) -> f64 {
        let first = self.holes.len();
        let is_wet = |face: usize| match hole {
            Some(hole) => self.faces.from[face] == Some(hole as u32),
            None => self.network.contents().cells[first + face].mass > 0.0,
        };
        let holes = (0..first).filter(|own| hole.is_none_or(|hole| hole == *own));
        let faces = (0..self.face_count()).filter(|face| is_wet(*face)).map(|face| first + face);
        holes.chain(faces).map(|mouth| self.cracks.wetted_area(solid, mouth)).sum()
    }

    pub(crate) fn state(&self) -> GasState {
        GasState {
            cracks: self.cracks.state(),
            from: self.faces.from.clone(),
            contents: self.network.contents().clone(),
            push: self.cavities.iter().map(|cavity| cavity.push).collect(),
            energy: self.energy,
            frequency_square: self.frequency_square,
        }
    }

    /// Puts a saved state back, once the solid has lost its elements again.
    pub(crate) fn restore(&mut self, solid: &Solid, state: GasState) {
        self.cracks.restore(solid, &state.cracks);
        self.add_cells(solid);
        self.faces.from = state.from;
        self.update_rooms(solid);
        self.network.restore(state.contents);
        self.cavities.iter_mut().zip(state.push).for_each(|(cavity, push)| cavity.push = push);
        self.energy = state.energy;
        self.frequency_square = state.frequency_square;
    }
}

impl std::fmt::Debug for Gas {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Gas({} holes, {} cells in cracks)", self.holes.len(), self.cracks.cells().len())
    }
}

fn mean_velocity(solid: &Solid, nodes: &[u32; 3]) -> Vec3 {
    let [a, b, c] = nodes.map(|node| solid.velocity[node as usize]);
    if nodes[1] == nodes[2] { (a + b) * 0.5 } else { (a + b + c) / 3.0 }
}
