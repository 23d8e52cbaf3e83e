//! What an implicit solver needs of a solid: the secant stiffness of its cells, and the damage that a trial would bring.
//!
//! The cells and laws are those of the explicit kernel. A trial leaves the history of the edges alone; it advances when
//! [`Solid::update_internal_forces`] sees the displacements that were found.

use fractum_kernels::damage::{Band, EdgeDamage, Seen, Taken};
use fractum_kernels::material::Stiffness;
use fractum_math::{Mat3, Ragged, Sym3, Vec3};

use crate::body::Kinematics;
use crate::body::elasticity::Elasticity;
use crate::cells::block::Cells;
use crate::cells::thermal_strain::ThermalStrain;
use crate::motion::phase_damage::{phase_values, raise_phases, trial_phases};
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::{BodyModel, Solid};

/// Damage of every cell, block by block; empty rows for blocks without damage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellDamage {
    cells: Vec<Vec<f64>>,
    /// Values of the phase fields that it comes from, body by body.
    phases: Vec<Vec<f64>>,
}

/// One cell: nodes, and the stiffness of its body times V (1 - d).
#[derive(Clone, Copy, Debug)]
pub struct SecantCell<'a> {
    /// Number of its first pair of nodes, counting those of all cells, n² each.
    pub first_pair: usize,
    /// Nodes.
    pub nodes: &'a [u32],
    /// Gradients of their shape functions over the cell [1/m], as many as nodes; around an axis the third components are those for the hoop strain.
    pub gradients: &'a [[f64; 3]],
    /// Whether it lies around an axis.
    around: bool,
    /// λ V (1 - d) and μ V (1 - d) [N m].
    lame: [f64; 2],
    /// The stiffness of beds, which replaces them, and V (1 - d) [m³].
    bedded: Option<(&'a Stiffness, f64)>,
    /// Stress of its thermal strain, the same in all directions, times V (1 - d) [N m]; of beds the thermal strain. 0 where nothing expands.
    thermal: f64,
    /// Strain at which it is free of stress, where there is one.
    born: Option<&'a Sym3>,
}

impl SecantCell<'_> {
    /// Stress that a displacement gradient adds, times V (1 - d) [N m].
    #[inline]
    pub fn stress_change(&self, h: &Mat3) -> Mat3 {
        self.stress_beyond(h, 0.0)
    }

    /// Stress at a displacement gradient times V (1 - d) [N m].
    pub fn stress(&self, h: &Mat3) -> Mat3 {
        self.stress_beyond(h, 1.0)
    }

    /// The same with a share of the thermal strain and of that at which it is free of stress.
    #[inline]
    fn stress_beyond(&self, h: &Mat3, share: f64) -> Mat3 {
        let since = self.born.map(|born| h - born.to_matrix() * share);
        let h = since.as_ref().unwrap_or(h);
        let Some((stiffness, left)) = self.bedded else {
            let [lambda, mu] = self.lame;
            return (h + h.transpose()) * mu + Mat3::identity() * (lambda * h.trace() - share * self.thermal);
        };
        let strain = Sym3::symmetric_part(h) - Sym3::isotropic(share * self.thermal);
        (stiffness.stress(strain) * left).to_matrix()
    }

    /// Displacement gradient by displacements of all nodes [m].
    pub fn gradient(&self, field: &[Vec3]) -> Mat3 {
        let mut h = Mat3::zeros();
        for (&node, g) in self.nodes.iter().zip(self.gradients) {
            h += field[node as usize] * Vec3::from(*g).transpose();
        }
        if self.around {
            h.set_column(2, &Vec3::new(0.0, 0.0, h[(0, 2)]));
        }
        h
    }

    /// Adds the forces on its nodes that hold a stress times volume.
    fn add_forces(&self, mut stress: Mat3, force: &mut [Vec3]) {
        if self.around {
            stress.set_column(2, &Vec3::new(stress[(2, 2)], 0.0, 0.0));
        }
        for (&node, g) in self.nodes.iter().zip(self.gradients) {
            force[node as usize] += stress * Vec3::from(*g);
        }
    }

    /// Stiffness between two nodes with these gradients along the first `B` axes [N/m].
    #[inline]
    pub fn between<const B: usize>(&self, gi: &[f64; 3], gj: &[f64; 3]) -> [[f64; B]; B] {
        if self.around {
            return self.around_axis(gi, gj);
        }
        if let Some((stiffness, left)) = self.bedded {
            let whole = stiffness.between(gi, gj);
            return std::array::from_fn(|a| std::array::from_fn(|b| left * whole[a][b]));
        }
        let [lambda, mu] = self.lame;
        let dot: f64 = (0..B).map(|a| gi[a] * gj[a]).sum();
        std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let diagonal = if a == b { dot } else { 0.0 };
                lambda * gi[a] * gj[b] + mu * (gi[b] * gj[a] + diagonal)
            })
        })
    }

    /// The same around an axis, where displacements along the radius strain the circumference too.
    fn around_axis<const B: usize>(&self, gi: &[f64; 3], gj: &[f64; 3]) -> [[f64; B]; B] {
        let [lambda, mu] = self.lame;
        let volumetric = |g: &[f64; 3], a: usize| if a == 0 { g[0] + g[2] } else { g[a] };
        let dot = gi[0] * gj[0] + gi[1] * gj[1];
        std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let diagonal = if a == b { dot } else { 0.0 };
                let hoop = if a == 0 && b == 0 { 2.0 * gi[2] * gj[2] } else { 0.0 };
                lambda * volumetric(gi, a) * volumetric(gj, b) + mu * (gi[b] * gj[a] + diagonal + hoop)
            })
        })
    }
}

/// An edge that may be damaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamagePoint {
    /// Body it belongs to.
    pub body: usize,
    /// Largest equivalent stress so far [Pa].
    pub kappa: f64,
    /// Equivalent stress over which softening takes place, E' G_f/(l f_t) [Pa].
    pub softening: f64,
    /// Strength [Pa].
    pub strength: f64,
    /// Whether it is broken.
    pub broken: bool,
    /// Damage so far.
    pub damage: f64,
    /// Sum of the lateral principal stresses at the onset of damage [Pa]; infinite before.
    pub lateral: f64,
    /// Part of the largest effective principal stress that belonged to the opening when κ last grew.
    pub share: f64,
    /// What an edge of bedded rock has kept of the onset of its damage.
    pub band: Band,
}

/// Why a solid cannot be treated by secant stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotSecant {
    /// A body turns with its elements.
    Corotational,
    /// Cracks close.
    Unilateral,
    /// Closed cracks rub.
    Friction,
    /// Damage takes time.
    Rate,
    /// Strength grows with the rate of strain.
    StrainRate,
}

impl Solid {
    /// What of a body keeps it from being treated by secant stiffness, with the index of the body.
    pub fn not_secant(&self) -> Option<(usize, NotSecant)> {
        let of = |model: &BodyModel| {
            let zone = model.body.damage.as_ref();
            match zone.map(|zone| &zone.law) {
                _ if zone.is_some_and(|zone| zone.rate.is_some()) => Some(NotSecant::StrainRate),
                _ if model.body.kinematics == Kinematics::Corotational => Some(NotSecant::Corotational),
                Some(law) if law.unilateral => Some(NotSecant::Unilateral),
                Some(law) if law.friction.is_some() => Some(NotSecant::Friction),
                Some(law) if law.rate_time > 0.0 => Some(NotSecant::Rate),
                _ => None,
            }
        };
        self.bodies.iter().enumerate().find_map(|(index, model)| Some((index, of(model)?)))
    }

    /// Nodes of every cell, in the order of [`Solid::for_each_cell`].
    pub fn cell_nodes(&self) -> Ragged {
        let nodes = |block: &Block, cell| block.cells.global_nodes(cell).map(|n| n as u32).collect::<Vec<u32>>();
        Ragged::from_rows(self.blocks.iter().flat_map(|b| (0..b.cells.len()).map(move |cell| nodes(b, cell))))
    }

    /// Calls `work` for every cell that is still there.
    pub fn for_each_cell(&self, damage: &CellDamage, mut work: impl FnMut(SecantCell<'_>)) {
        let (mut nodes, mut gradients) = (Vec::new(), Vec::new());
        let mut next_pair = 0;
        for (index, block) in self.blocks.iter().enumerate() {
            let Elasticity { hooke, bedded } = &self.bodies[block.body].elasticity;
            let cells = &block.cells;
            for cell in 0..cells.len() {
                let count = cells.local_nodes(cell).len();
                let first_pair = next_pair;
                next_pair += count * count;
                let left = damage.cells[index].get(cell).map_or(1.0, |d| 1.0 - d) * cells.volume[cell];
                if left <= 0.0 {
                    continue;
                }
                nodes.clear();
                nodes.extend(cells.global_nodes(cell).map(|n| n as u32));
                gradients.clear();
                gradients.push([0.0; 3]);
                for g in &cells.gradients[cells.range(cell)] {
                    for (base, g) in gradients[0].iter_mut().zip(g) {
                        *base -= g;
                    }
                    gradients.push(*g);
                }
                gradients[0][2] += cells.hoop(cell).unwrap_or(0.0);
                let (lambda, mu) = (hooke.lambda * left, hooke.mu * left);
                let bedded = bedded.as_deref().map(|stiffness| (stiffness, left));
                let per_strain = |unit: f64| if bedded.is_some() { 1.0 } else { lambda * unit + 2.0 * mu };
                let thermal = |own: &ThermalStrain| own.now(cell) * per_strain(own.unit.trace());
                let thermal = cells.thermal.as_deref().map_or(0.0, thermal);
                let (lame, born) = ([lambda, mu], cells.born.as_ref().map(|born| &born[cell]));
                let around = cells.hoop.is_some();
                work(SecantCell {
                    first_pair,
                    nodes: &nodes,
                    gradients: &gradients,
                    around,
                    lame,
                    bedded,
                    thermal,
                    born,
                });
            }
        }
    }

    /// Forces that hold the displacements `field` against the secant stiffness, thermal strains and those at which cells are free of stress [N].
    pub fn secant_force(&self, damage: &CellDamage, field: &[Vec3], force: &mut [Vec3]) {
        add_up(self, damage, field, 1.0, force);
    }

    /// Forces that change with the displacements by `change`, K u [N].
    pub fn secant_change(&self, damage: &CellDamage, change: &[Vec3], force: &mut [Vec3]) {
        add_up(self, damage, change, 0.0, force);
    }

    /// Damage of the cells as it stands.
    pub fn cell_damage(&self) -> CellDamage {
        let of = |block: &Block| match &block.law {
            BlockLaw::Elastic => Vec::new(),
            _ => (0..block.cells.len()).map(|cell| block.damage_of(cell)).collect(),
        };
        CellDamage { cells: self.blocks.iter().map(of).collect(), phases: phase_values(self) }
    }

    /// The edges that may be damaged, in the order of [`Solid::effective_stresses`].
    pub fn damage_points(&self) -> Vec<DamagePoint> {
        let mut points = Vec::new();
        for (body, field) in self.edge_fields() {
            let model = &self.bodies[body].body;
            let energy = model.damage.as_ref().map_or(0.0, |zone| zone.law.fracture_energy);
            let longest = field.softens.beds.as_ref().map_or(1.0, |beds| beds.longest);
            for (index, edge) in field.state.iter().enumerate() {
                let &EdgeDamage { broken, damage, lateral, share, .. } = edge;
                let longer = if longest == 1.0 || lateral == f64::INFINITY { longest } else { edge.band().longer };
                let kappa = field.onset(index);
                let softening =
                    field.softens.restraint.modulus * energy / (field.length[index] * longer * field.strength[index]);
                points.push(DamagePoint {
                    body,
                    kappa,
                    softening,
                    broken,
                    damage,
                    lateral,
                    share,
                    band: edge.band(),
                    strength: field.strength[index],
                });
            }
        }
        points
    }

    /// Effective stress of every edge that may be damaged under displacements [Pa].
    pub fn effective_stresses(&self, field: &[Vec3], stresses: &mut Vec<Sym3>) {
        add_stresses(self, field, Cells::elastic_strain, stresses);
    }

    /// What a change of the displacements adds to [`Solid::effective_stresses`] [Pa]; linear in it.
    pub fn effective_stress_changes(&self, change: &[Vec3], stresses: &mut Vec<Sym3>) {
        add_stresses(self, change, |_, _, strain| strain, stresses);
    }

    /// What each of these edges sees under its effective stress; nothing where the equivalent stress surely stays below
    /// `threshold` [Pa].
    pub fn see(
        &self,
        points: &[DamagePoint],
        stresses: &[Sym3],
        threshold: impl Fn(&DamagePoint) -> f64,
        seen: &mut Vec<Seen>,
    ) {
        seen.clear();
        seen.extend(points.iter().zip(stresses).map(|(point, &stress)| {
            let model = &self.bodies[point.body];
            let criterion = self.criterion(point.body);
            let beds = model.softens.as_ref().and_then(|softens| softens.beds.as_ref());
            let threshold = threshold(point);
            let is_below = match beds {
                Some(beds) => beds.surely_below(criterion, stress, threshold),
                None => criterion.surely_below(stress, threshold),
            };
            if is_below {
                return Seen { share: point.share, ..Seen::NOTHING };
            }
            let history = [point.strength, point.kappa, point.lateral];
            let seen = match beds {
                Some(beds) => beds.seen(criterion, history, point.band, stress),
                None => model.body.restraint().seen(criterion, history, stress, criterion.equivalent_stress(stress)),
            };
            match seen {
                seen if seen.stress > point.kappa => seen,
                seen => Seen { share: point.share, ..seen },
            }
        }));
    }

    /// The edge that is closest to damage, or furthest beyond it: its body, its middle without load [m], and its equivalent
    /// stress over the one at which damage begins. None where nothing may be damaged or all stress is far from it.
    pub fn most_strained_edge(&self) -> Option<(usize, Vec3, f64)> {
        let points = self.damage_points();
        let (mut stresses, mut seen) = (Vec::new(), Vec::new());
        self.effective_stresses(&self.displacement, &mut stresses);
        self.see(&points, &stresses, |point| point.kappa, &mut seen);
        let ratios = seen.iter().zip(&points).map(|(seen, point)| seen.stress / point.kappa);
        let (index, ratio) = ratios.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut edges = self.edge_fields().flat_map(|(body, field)| field.edges.iter().map(move |&edge| (body, edge)));
        let (body, edge) = edges.nth(index)?;
        let [a, b] = self.bodies[body].edges.as_ref()?.nodes(edge).map(|n| self.reference[n as usize]);
        Some((body, (a + b) * 0.5, ratio))
    }

    fn criterion(&self, body: usize) -> &fractum_kernels::material::Criterion {
        let zone = self.bodies[body].body.damage.as_ref();
        &zone.expect("a damage point belongs to a body with damage").law.criterion
    }

    /// Damage of the cells once every edge has seen this.
    pub fn trial_damage(&self, seen: &[Seen], trial: &mut CellDamage) {
        trial.cells.resize(self.blocks.len(), Vec::new());
        let mut of_edges =
            self.edge_fields().flat_map(|(_, field)| (0..field.state.len()).map(move |i| (field, i))).zip(seen);
        let mut next = |count: usize, damage: &mut Vec<f64>| {
            damage.clear();
            damage.extend(of_edges.by_ref().take(count).map(|((field, index), &seen)| field.trial(index, seen)));
        };
        for (block, trial) in self.blocks.iter().zip(&mut trial.cells) {
            if let Some(field) = block.edge_field() {
                next(field.state.len(), trial);
            }
        }
        trial_phases(self, seen, &mut trial.cells, &mut trial.phases);
        let mut damage = Vec::new();
        let mut first = self.blocks.iter().filter_map(Block::edge_field).map(|field| field.state.len()).sum::<usize>();
        for (body, model) in self.bodies.iter().enumerate() {
            let (Some(standard), Some(edges)) = (&model.standard, &model.edges) else { continue };
            next(standard.field.state.len(), &mut damage);
            let of_body = &seen[first..first + standard.field.state.len()];
            first += of_body.len();
            if let Some(field) = &model.phase {
                field.raise(&trial.phases[body], |edge| of_body[edge as usize].share, &mut damage);
            }
            for (block, trial) in self.blocks.iter().zip(&mut trial.cells).filter(|(b, _)| b.body == body) {
                let of = |(cell, &e): (usize, &u32)| {
                    standard
                        .element_damage(&edges.of_element(e), |edge| damage[edge as usize])
                        .max(block.damage_of(cell))
                };
                *trial = block.items.iter().enumerate().map(of).collect();
            }
        }
    }

    /// Lets every edge see this, as the solid goes straight from the displacements `before` to
    /// `after`.
    ///
    /// What damage takes on the way is booked; [`Solid::update_internal_forces`] at `after` then finds nothing new.
    ///
    /// - `trial`: the damage that this brings
    pub fn raise_history(&mut self, seen: &[Seen], trial: &CellDamage, before: &[Vec3], after: &[Vec3]) {
        let Solid { blocks, bodies, .. } = self;
        let mut next = 0;
        for block in blocks {
            let elasticity = &bodies[block.body].elasticity;
            let Block { law: BlockLaw::Edges(field), cells, dissipated, .. } = block else { continue };
            for cell in 0..field.state.len() {
                let seen = seen[next];
                next += 1;
                if seen.stress <= field.onset(cell) {
                    continue;
                }
                let ends = cells.elastic_ends(cell, [before, after]);
                let growth = field.load_at_rest(cell, seen);
                let taken = Taken::straight(0.5 * elasticity.stress(ends[1]).dot(ends[0]));
                *dissipated += taken.by(growth) * cells.volume[cell];
            }
        }
        for standard in bodies.iter_mut().filter_map(|model| model.standard.as_mut()) {
            for edge in 0..standard.field.state.len() {
                standard.field.load_at_rest(edge, seen[next]);
                next += 1;
            }
        }
        self.blocks.iter_mut().for_each(Block::expect_any_damage);
        raise_phases(self, &trial.phases, before, after);
    }

    /// Whether some body may be damaged.
    pub fn has_damage(&self) -> bool {
        self.bodies.iter().any(|model| model.body.damage.is_some())
    }
}

/// Adds up the nodal forces of the cells under a field.
///
/// - `share`: part of the thermal stresses that counts, and of the strains at which cells are free of stress
fn add_up(solid: &Solid, damage: &CellDamage, field: &[Vec3], share: f64, force: &mut [Vec3]) {
    force.fill(Vec3::zeros());
    solid.for_each_cell(damage, |cell| {
        let stress = cell.stress_beyond(&cell.gradient(field), share);
        cell.add_forces(stress, force);
    });
}

/// Effective stresses of the edges that may be damaged, in the order of [`Solid::damage_points`].
///
/// - `elastic`: the strain that stress belongs to, of a cell with a strain
fn add_stresses(
    solid: &Solid,
    field: &[Vec3],
    elastic: impl Fn(&Cells, usize, Sym3) -> Sym3,
    stresses: &mut Vec<Sym3>,
) {
    stresses.clear();
    let stress = |block: &Block, cell: usize| {
        let strain = Sym3::symmetric_part(&block.cells.gradient(cell, |node| field[node]));
        solid.bodies[block.body].elasticity.stress(elastic(&block.cells, cell, strain))
    };
    for block in solid.blocks.iter().filter(|b| matches!(b.law, BlockLaw::Edges(_))) {
        stresses.extend((0..block.cells.len()).map(|cell| stress(block, cell)));
    }
    for model in &solid.bodies {
        let Some(standard) = &model.standard else { continue };
        let element = |e: u32| {
            let (block, cell) = model.location.of(e);
            stress(&solid.blocks[block as usize], cell as usize)
        };
        for edge in 0..standard.field.state.len() {
            let (mut sum, mut count) = (Sym3::ZERO, 0);
            for &e in standard.elements_of_edge.row(edge).iter().filter(|&&e| model.alive[e as usize]) {
                sum += element(e);
                count += 1;
            }
            stresses.push(sum * (1.0 / f64::from(count.max(1))));
        }
    }
}
