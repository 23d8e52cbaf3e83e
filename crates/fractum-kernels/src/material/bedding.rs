//! Elasticity of bedded rock, which is the same in all directions within the beds and differs along their normal.

use core::f64::consts::PI;

use super::{Elastic, Plane};
use crate::elementary::{cos, sin};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::{Mat3, Sym3, Vec3};

/// Directions of a half circle in which the fastest wave is sought.
const DIRECTIONS: u32 = 720;

/// What distinguishes the normal of the beds from directions within them, beside [`Elastic`], which holds within them.
///
/// A pull σ along the normal stretches by σ/E' along it and contracts by ν' times as much within the beds; a pull within the beds contracts along the normal
/// by ν' E/E' times its stretch. Lekhnitskii, *Theory of Elasticity of an Anisotropic Body* (1981), section 3; Amadei, *Int. J. Rock Mech. Min. Sci.* 33
/// (1996) 293-325.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bedding {
    /// Unit normal of the beds.
    pub normal: Vec3,
    /// Young's modulus along the normal E' [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν' of a pull along the normal.
    pub poisson_ratio: f64,
    /// Shear modulus G' between the beds [Pa].
    pub shear_modulus: f64,
}

impl Bedding {
    /// Saint-Venant's estimate of the shear modulus, 1/G' = 1/E + (1 + 2ν')/E' [Pa]: exact where the beds do not matter.
    ///
    /// - `elastic`: E; `young_modulus` E' [Pa]; `poisson_ratio` ν'
    pub fn estimated_shear_modulus(elastic: &Elastic, young_modulus: f64, poisson_ratio: f64) -> f64 {
        1.0 / (1.0 / elastic.young_modulus + (1.0 + 2.0 * poisson_ratio) / young_modulus)
    }

    /// What |ν'| stays below, √((1 - ν) E'/(2E)): with positive moduli and -1 < ν < 1 every strain then stores energy.
    ///
    /// - `elastic`: E and ν; `young_modulus` E' [Pa]
    pub fn poisson_limit(elastic: &Elastic, young_modulus: f64) -> f64 {
        (0.5 * (1.0 - elastic.poisson_ratio) * young_modulus / elastic.young_modulus).sqrt()
    }

    /// Young's modulus of a pull in a direction, 1/(a⁴/E + (1/G' - 2ν'/E') a² c² + c⁴/E') [Pa].
    ///
    /// - `cosine`: c of the angle between the pull and the normal; a² = 1 - c²
    pub fn young_modulus_along(&self, elastic: &Elastic, cosine: f64) -> f64 {
        let (along, within) = (cosine * cosine, 1.0 - cosine * cosine);
        let both = 1.0 / self.shear_modulus - 2.0 * self.poisson_ratio / self.young_modulus;
        1.0 / (within * within / elastic.young_modulus + both * within * along + along * along / self.young_modulus)
    }
}

/// Linear elasticity without symmetry in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Stress xx yy zz xy yz zx (rows) per strain xx yy zz, 2xy, 2yz, 2zx (columns) [Pa]; symmetric.
    rows: [[f64; 6]; 6],
}

impl Stiffness {
    /// The law of a bedded body in space, or of a plane one: σ = λ tr ε + 2 μ ε + α ((n·ε n) + tr ε n⊗n) + 2 (G' - μ) (n⊗ε n + ε n⊗n) + β (n·ε n) n⊗n.
    ///
    /// A plane body has no shear stress on its plane: where the beds strike askew to it, plane strain leaves away the shear stress that holds the motion
    /// across the plane, and plane stress has none.
    pub fn new(elastic: &Elastic, bedding: &Bedding, plane: Option<Plane>) -> Self {
        let Bedding { normal: n, young_modulus: normal, poisson_ratio: nu, shear_modulus } = *bedding;
        let (young, in_beds) = (elastic.young_modulus, elastic.poisson_ratio);
        let rest = 1.0 - in_beds - 2.0 * nu * nu * young / normal;
        let mu = young / (2.0 * (1.0 + in_beds));
        let lambda = 0.5 * young / rest - mu;
        let alpha = young * nu / rest - lambda;
        let shear = 2.0 * (shear_modulus - mu);
        let beta = normal * (1.0 - in_beds) / rest - lambda - 2.0 * mu - 2.0 * alpha - 2.0 * shear;
        let dyad = n * n.transpose();
        let stress = |strain: Mat3| {
            let (trace, stretch, pulled) = (strain.trace(), n.dot(&(strain * n)), dyad * strain);
            Mat3::identity() * (lambda * trace + alpha * stretch)
                + strain * (2.0 * mu)
                + dyad * (alpha * trace + beta * stretch)
                + (pulled + pulled.transpose()) * shear
        };
        let mut rows = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut unit = [0.0; 6];
            unit[column] = if column < 3 { 1.0 } else { 0.5 };
            let stress = Sym3::symmetric_part(&stress(Sym3(unit).to_matrix()));
            for (row, value) in rows.iter_mut().zip(stress.0) {
                row[column] = value;
            }
        }
        let mut made = Stiffness { rows };
        match plane {
            None | Some(Plane::Axisymmetric) => {}
            Some(Plane::Strain) => [4, 5].into_iter().for_each(|axis| made.forget(axis)),
            Some(Plane::Stress) => [2, 4, 5].into_iter().for_each(|axis| made.release(axis)),
        }
        made
    }

    /// A component of stress becomes zero, by the strain that goes with it.
    fn release(&mut self, axis: usize) {
        let pivot = self.rows[axis];
        for row in 0..6 {
            let factor = self.rows[row][axis] / pivot[axis];
            for column in 0..6 {
                self.rows[row][column] -= factor * pivot[column];
            }
        }
        self.forget(axis);
    }

    /// A component of strain has no stress, and no other strain any there.
    fn forget(&mut self, axis: usize) {
        self.rows[axis] = [0.0; 6];
        self.rows.iter_mut().for_each(|row| row[axis] = 0.0);
    }

    /// Stress xx yy zz xy yz zx (rows) per strain xx yy zz, 2xy, 2yz, 2zx (columns) [Pa]; symmetric.
    pub fn rows(&self) -> &[[f64; 6]; 6] {
        &self.rows
    }

    /// Stress of a strain [Pa].
    #[inline(always)]
    pub fn stress(&self, strain: Sym3) -> Sym3 {
        let [xx, yy, zz, xy, yz, zx] = strain.0;
        let strain = [xx, yy, zz, 2.0 * xy, 2.0 * yz, 2.0 * zx];
        let mut stress = [0.0; 6];
        for (column, value) in strain.into_iter().enumerate() {
            for row in 0..6 {
                stress[row] += self.rows[column][row] * value;
            }
        }
        Sym3(stress)
    }

    /// Force per displacement between two gradients: K_ab = C_acbd g_c h_d [Pa times their units].
    #[inline]
    pub fn between(&self, g: &[f64; 3], h: &[f64; 3]) -> [[f64; 3]; 3] {
        /// Place of a pair of axes among the six components.
        const PLACE: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
        let mut sum = [[0.0; 3]; 3];
        for (a, row) in sum.iter_mut().enumerate() {
            for (b, value) in row.iter_mut().enumerate() {
                for c in 0..3 {
                    for d in 0..3 {
                        *value += self.rows[PLACE[a][c]][PLACE[b][d]] * g[c] * h[d];
                    }
                }
            }
        }
        sum
    }

    /// Christoffel's tensor of plane waves along a unit direction [Pa]: its principal values are ρ c², its axes the motions.
    pub fn of_waves(&self, direction: Vec3) -> Sym3 {
        let direction: [f64; 3] = direction.into();
        let [[xx, xy, zx], [_, yy, yz], [_, _, zz]] = self.between(&direction, &direction);
        Sym3([xx, yy, zz, xy, yz, zx])
    }

    /// Traction per velocity √(ρ Γ) of a facet through which plane waves leave along its normal [Pa s/m].
    ///
    /// - `density` ρ [kg/m³]; `normal`: unit normal of the facet
    pub fn impedance(&self, density: f64, normal: Vec3) -> Mat3 {
        let (moduli, motions) = self.of_waves(normal).eigen();
        let root = moduli.map(|modulus| (density * modulus.max(0.0)).sqrt());
        motions * Mat3::from_diagonal(&root.into()) * motions.transpose()
    }

    /// ρ c² of the fastest and of the slowest wave along the directions that two perpendicular unit vectors span, to 1e-5 [Pa].
    ///
    /// - `in_plane`: whether nothing moves along z
    pub fn extreme_moduli(&self, [a, b]: [Vec3; 2], in_plane: bool) -> [f64; 2] {
        let (mut fastest, mut slowest) = (0.0_f64, f64::INFINITY);
        for k in 0..DIRECTIONS {
            let angle = PI * f64::from(k) / f64::from(DIRECTIONS);
            let [first, second, third] = self.of_waves(a * cos(angle) + b * sin(angle)).principal_values();
            fastest = fastest.max(first);
            slowest = slowest.min(if in_plane { second } else { third });
        }
        [fastest, slowest]
    }

    /// Tensor Q of which g·Q g is the sum of the principal values of Christoffel's tensor along g [Pa].
    pub fn sum_over_waves(&self) -> Sym3 {
        let r = &self.rows;
        Sym3([
            r[0][0] + r[3][3] + r[5][5],
            r[1][1] + r[3][3] + r[4][4],
            r[2][2] + r[4][4] + r[5][5],
            r[0][3] + r[1][3] + r[4][5],
            r[1][4] + r[2][4] + r[3][5],
            r[0][5] + r[2][5] + r[3][4],
        ])
    }
}
