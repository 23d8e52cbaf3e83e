//! Strength by the angle to the beds of a rock.

use core::f64::consts::PI;

use crate::damage::restraint::{in_plane, obliquity};
use crate::damage::seen::{Band, Seen};
use crate::elementary::{cos, sin};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::material::{Bedding, Criterion, DamageLaw, Elastic, Plane, Stiffness};
use crate::{Sym3, Vec3};

/// Directions of a half circle in which the longest band is sought.
const DIRECTIONS: u32 = 180;

/// How far the equivalent stress over the largest principal one may exceed what a pull alone gives, for damage to count as an opening.
const OPENS: f64 = 2.0;

/// Components of a plane body that bear stress.
const IN_PLANE: &[usize] = &[0, 1, 3];
const IN_SPACE: &[usize] = &[0, 1, 2, 3, 4, 5];

/// The planes of the beds, in which rock is weaker: Jaeger's plane of weakness (*Geol. Mag.* 97 (1960) 65-72) with a tension cut-off.
#[derive(Clone, Copy, Debug)]
struct Weakness {
    /// f_t of the rock over that of the planes, at least 1.
    tension: f64,
    /// f_t of the rock over the cohesion of the planes.
    shear: f64,
    /// tan φ.
    friction: f64,
    /// G_f of the rock over that of the planes.
    energy: f64,
    /// Largest equivalent stress of a pull over that pull, over all directions; at least 1.
    most: f64,
}

/// What damage knows of beds: the elasticity that they make, and the strength of their planes.
///
/// The equivalent stress is the larger one of the rock's own criterion and of that of the planes, max(σ_n f_t/f_b, (|τ| + σ_n tan φ) f_t/c_b) with the traction
/// σ_n, τ on a plane of the beds: it reaches f_t where either breaks.
///
/// A pull p in the direction e that breaks an edge has the equivalent stress k p, and stores p²/(2 E_e) with Young's modulus E_e of its direction. Softening sees
/// x = k E_e ε_e, which is q where nothing holds the edge sideways, and never more than q. Its band takes the fracture energy G of what broke where the length in
/// the softening is l E' G_f/(k² E_e G), with E' and G_f of the rock within the beds. k, E_e and this factor stay as they were when damage began; the direction of
/// ε_e is that of the largest principal stress. Damage that begins by sliding or crushing under pressure sees q.
#[derive(Clone, Debug)]
pub struct Beds {
    /// The law of the body.
    pub stiffness: Stiffness,
    /// Strain with engineering shears per stress [1/Pa].
    compliance: [[f64; 6]; 6],
    normal: Vec3,
    is_plane: bool,
    weakness: Option<Weakness>,
    /// E' within the beds [Pa].
    modulus: f64,
    /// Largest factor on the characteristic length that a pull brings about.
    pub longest: f64,
}

impl Beds {
    /// Beds in a body in space, or in a plane one.
    ///
    /// - `modulus`: E' of the rock within the beds [Pa]
    pub fn new(elastic: &Elastic, bedding: &Bedding, plane: Option<Plane>, law: &DamageLaw, modulus: f64) -> Self {
        let (stiffness, is_plane) = (Stiffness::new(elastic, bedding, plane), plane.is_some());
        let weakness = law.beds.map(|beds| Weakness {
            tension: law.tensile_strength / beds.tensile_strength,
            shear: law.tensile_strength / beds.cohesion,
            friction: sin(beds.friction_angle) / cos(beds.friction_angle),
            energy: law.fracture_energy / beds.fracture_energy,
            most: 1.0,
        });
        let compliance = inverse(stiffness.rows(), if is_plane { IN_PLANE } else { IN_SPACE });
        let normal = bedding.normal;
        let mut beds = Beds { stiffness, compliance, normal, is_plane, weakness, modulus, longest: 1.0 };
        let [one, other] = if is_plane { [Vec3::x(), Vec3::y()] } else { [normal, across(normal)] };
        let (mut most, mut longest) = (1.0_f64, 0.0_f64);
        for step in 0..DIRECTIONS {
            let angle = PI * f64::from(step) / f64::from(DIRECTIONS);
            let pull = one * cos(angle) + other * sin(angle);
            let bed = beds.of_planes(dyad(pull));
            most = most.max(bed);
            longest = longest.max(beds.longer(beds.along(pull).0, bed, bed > 1.0));
        }
        if let Some(weakness) = &mut beds.weakness {
            weakness.most = most;
        }
        Beds { longest, ..beds }
    }

    /// Equivalent stress of the planes of the beds, which grows with the stress; zero where these are as strong as the rock [Pa].
    #[inline]
    pub fn of_planes(&self, stress: Sym3) -> f64 {
        let Some(Weakness { tension, shear, friction, .. }) = self.weakness else { return 0.0 };
        let traction = stress * self.normal;
        let across = traction.dot(&self.normal);
        let along = traction - self.normal * across;
        let sliding = (along.dot(&along).sqrt() + across * friction) * shear;
        sliding.max(across * tension).max(0.0)
    }

    /// Equivalent stress of rock with its beds [Pa].
    pub fn equivalent_stress(&self, criterion: &Criterion, stress: Sym3) -> f64 {
        criterion.equivalent_stress(stress).max(self.of_planes(stress))
    }

    /// Whether the equivalent stress surely stays at or below `threshold` [Pa]; false when in doubt.
    #[inline(always)]
    pub fn surely_below(&self, criterion: &Criterion, stress: Sym3, threshold: f64) -> bool {
        criterion.surely_below(stress, threshold) && self.of_planes(stress) <= threshold
    }

    /// What an edge sees.
    ///
    /// - `[strength, kappa, at_onset]`: strength, largest equivalent stress so far, and what restraint added at the onset of damage [Pa], infinite before
    /// - `band`: of an edge whose damage has begun
    pub fn seen(&self, criterion: &Criterion, [strength, kappa, at_onset]: [f64; 3], band: Band, stress: Sym3) -> Seen {
        let (of_rock, of_planes) = (criterion.equivalent_stress(stress), self.of_planes(stress));
        let q = of_rock.max(of_planes);
        if q <= kappa {
            return Seen { stress: q, ..Seen::NOTHING };
        }
        let (first, direction) = self.first(stress);
        if at_onset == f64::INFINITY {
            let modulus = self.along(direction).0;
            let added = first - modulus * contract(dyad(direction), self.strain(stress));
            let parts = of_planes > of_rock;
            let most = self.weakness.filter(|_| parts).map_or(1.0, |weakness| weakness.most);
            let pull = if q <= OPENS * most * first { q / first } else { 0.0 };
            let longer = self.longer(modulus, if pull > 0.0 { pull.min(most) } else { most }, parts);
            return Seen {
                lateral: added * (kappa / q),
                band: Band { pull, longer, direction, held: self.held(direction, modulus) },
                ..Seen { stress: q, ..Seen::NOTHING }
            };
        }
        let k = band.pull;
        if k == 0.0 || first <= 0.0 {
            return Seen { stress: q, ..Seen::NOTHING };
        }
        // Modulus and ratio of the pull that began it: an element that opens askew must not seem softer than it was.
        let (modulus, ratio) = self.along(band.direction);
        let added = first - modulus * contract(dyad(direction), self.strain(stress));
        let more = (added - at_onset).max(0.0);
        let stress = q.min(k * (first - more));
        let share = |counted: f64| (counted / (k * first)).clamp(0.0, 1.0);
        if stress <= strength {
            return Seen { stress, share: share(stress), lateral: at_onset, ..Seen::NOTHING };
        }
        // As in bodies without beds, with Poisson's ratio of the pull. A band that opens straight owes to its neighbours what it owed at the onset: m is 1.
        let m = if ratio > 0.0 && band.held > 0.0 {
            let askew = if self.is_plane { ratio } else { ratio / (1.0 - ratio) };
            let straight = if self.is_plane { askew } else { 2.0 * askew };
            obliquity(askew, self.is_plane, straight * more / (band.held * (first - strength / k)))
        } else {
            1.0
        };
        let counted = strength + (stress - strength) / m.sqrt();
        Seen { stress: counted, share: share(counted), lateral: at_onset, ..Seen::NOTHING }
    }

    /// Factor on the characteristic length of an edge that a pull parts.
    ///
    /// - `pull`: k, of planes of beds at least 1; `parts`: whether it parts beds
    fn longer(&self, modulus: f64, pull: f64, parts: bool) -> f64 {
        let (k, energy) = self.weakness.filter(|_| parts).map_or((1.0, 1.0), |beds| (pull.max(1.0), beds.energy));
        self.modulus * energy / (k * k * modulus)
    }

    /// Young's modulus along a direction [Pa], and the mean of Poisson's ratio across it.
    fn along(&self, direction: Vec3) -> (f64, f64) {
        let dyad = dyad(direction);
        let strain = self.strain(dyad);
        let along = contract(dyad, strain);
        let all = strain[0] + strain[1] + if self.is_plane { 0.0 } else { strain[2] };
        (1.0 / along, (along - all) / along * if self.is_plane { 1.0 } else { 0.5 })
    }

    /// Part of a growing pull that a band across it owes to its neighbours, 1 - E_e e·Q⁻¹ e with Christoffel's tensor Q: it opens by Q⁻¹ of its traction.
    fn held(&self, direction: Vec3, modulus: f64) -> f64 {
        let mut waves = self.stiffness.of_waves(direction).to_matrix();
        if self.is_plane {
            // Nothing moves along z.
            waves.fill_row(2, 0.0);
            waves.fill_column(2, 0.0);
            waves[(2, 2)] = 1.0;
        }
        waves.try_inverse().map_or(0.0, |inverse| 1.0 - modulus * direction.dot(&(inverse * direction)))
    }

    /// Strain with engineering shears of a stress.
    fn strain(&self, stress: Sym3) -> [f64; 6] {
        let mut strain = [0.0; 6];
        for (row, value) in self.compliance.iter().zip(stress.0) {
            for (strain, part) in strain.iter_mut().zip(row) {
                *strain += part * value;
            }
        }
        strain
    }

    /// Largest principal stress [Pa], and its direction.
    fn first(&self, stress: Sym3) -> (f64, Vec3) {
        if self.is_plane {
            let [xx, yy, _, xy, ..] = stress.0;
            let half = 0.5 * (xx - yy);
            let reach = (half * half + xy * xy).sqrt() + half.abs();
            let axis = if half >= 0.0 { Vec3::new(reach, xy, 0.0) } else { Vec3::new(xy, reach, 0.0) };
            let size = axis.dot(&axis).sqrt();
            (in_plane(stress)[0], if size > 0.0 { axis * (1.0 / size) } else { Vec3::x() })
        } else {
            let (values, axes) = stress.eigen();
            (values[0], axes.column(0).into_owned())
        }
    }
}

/// e ⊗ e.
fn dyad(e: Vec3) -> Sym3 {
    Sym3([e.x * e.x, e.y * e.y, e.z * e.z, e.x * e.y, e.y * e.z, e.z * e.x])
}

/// Work of a stress on a strain with engineering shears.
fn contract(stress: Sym3, strain: [f64; 6]) -> f64 {
    stress.0.iter().zip(strain).map(|(stress, strain)| stress * strain).sum()
}

/// A unit vector across another one.
fn across(normal: Vec3) -> Vec3 {
    let other = normal.cross(&Vec3::ith(normal.iamin(), 1.0));
    other * (1.0 / other.dot(&other).sqrt())
}

/// Inverse of the rows and columns `active` of a positive definite matrix; zero elsewhere.
fn inverse(rows: &[[f64; 6]; 6], active: &[usize]) -> [[f64; 6]; 6] {
    let mut a = *rows;
    for &k in active {
        let pivot = 1.0 / a[k][k];
        for &i in active {
            for &j in active {
                if i != k && j != k {
                    a[i][j] -= a[i][k] * a[k][j] * pivot;
                }
            }
        }
        for &i in active.iter().filter(|i| **i != k) {
            a[i][k] *= -pivot;
            a[k][i] *= pivot;
        }
        a[k][k] = pivot;
    }
    let is_active = |i: usize| active.contains(&i);
    core::array::from_fn(|i| core::array::from_fn(|j| if is_active(i) && is_active(j) { a[i][j] } else { 0.0 }))
}
