//! Heat from one side of an interface to the other, where they touch.

use fractum_fem::Solid;

use super::ThermalMaterial;
use crate::interfaces::Interfaces;

/// Coefficient of heat transfer over that of an element as long as the face, λ/l, where none is given.
const FIRM: f64 = 100.0;

/// A corner of a face of an interface.
#[derive(Clone, Copy, Debug)]
struct Corner {
    face: u32,
    corner: u8,
    /// Nodes on both sides, ascending.
    pair: [u32; 2],
    /// Conductance while the sides touch [W/K].
    conductance: f64,
    touches: bool,
}

/// Corners of interfaces that heat passes.
#[derive(Clone, Debug, Default)]
pub(super) struct Crossings(Vec<Corner>);

impl Crossings {
    /// - `transfer`: coefficient of each kind of interfaces [W/(m² K)]
    pub(super) fn new(
        solid: &Solid,
        interfaces: &Interfaces,
        solids: &[ThermalMaterial],
        transfer: &[Option<f64>],
    ) -> Self {
        let mut corners = Vec::new();
        for (number, face) in interfaces.faces().iter().enumerate() {
            let whole = interfaces.reading(number).area;
            let length = if face.corners() == 2 { face.length(solid) } else { (2.0 * whole).sqrt() };
            let conductivity = face.elements.map(|(body, _)| solids[body as usize].conductivity);
            let firm = FIRM * conductivity[0].max(conductivity[1]) / length;
            let coefficient = transfer.get(face.kind as usize).copied().flatten().unwrap_or(firm);
            let area = whole / face.corners() as f64;
            for corner in 0..face.corners() {
                let [a, b] = face.sides.map(|side| side[corner]);
                if a != b {
                    corners.push(Corner {
                        face: number as u32,
                        corner: corner as u8,
                        pair: [a.min(b), a.max(b)],
                        conductance: coefficient * area,
                        touches: true,
                    });
                }
            }
        }
        let mut crossings = Crossings(corners);
        crossings.look(solid, interfaces);
        crossings
    }

    /// Nodes on both sides of each corner.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.0.iter().map(|corner| corner.pair)
    }

    /// Conductances as they are [W/K].
    pub(super) fn conductances(&self) -> impl Iterator<Item = f64> {
        self.0.iter().map(|corner| if corner.touches { corner.conductance } else { 0.0 })
    }

    /// Looks which sides touch; whether any has met or parted.
    pub(super) fn look(&mut self, solid: &Solid, interfaces: &Interfaces) -> bool {
        let mut changed = false;
        for own in &mut self.0 {
            let touches = interfaces.touches(solid, own.face as usize, own.corner as usize);
            changed |= std::mem::replace(&mut own.touches, touches) != touches;
        }
        changed
    }
}
