//! Properties of the strength of beds.

use fractum_kernels::damage::{Beds, EdgeDamage, Restraint, Softens};
use fractum_kernels::material::{
    BedStrength, Bedding, Criterion, CriterionKind, DamageLaw, Elastic, Hooke, Plane, Softening,
};
use fractum_kernels::{Mat3, Sym3, Vec3};

use super::draw::{Draw, Held, hold};

/// Bedded rock of any direction, with its strengths and those of its beds.
struct Rock {
    elastic: Elastic,
    bedding: Bedding,
    plane: Option<Plane>,
    law: DamageLaw,
    strength: BedStrength,
    length: f64,
}

fn rock(draw: &mut Draw, criteria: &[CriterionKind]) -> Rock {
    let plane = draw.one_of(&[None, Some(Plane::Strain), Some(Plane::Stress)]);
    let young_modulus = draw.over_decades(1e8, 1e11);
    let elastic = Elastic { density: 2500.0, young_modulus, poisson_ratio: draw.between(0.05, 0.35) };
    let normal = if plane.is_some() { draw.turn_in_plane() * Vec3::x() } else { draw.vector().normalize() };
    let along = young_modulus * draw.between(0.3, 1.2);
    let poisson_ratio = draw.between(0.05, 0.5) * Bedding::poisson_limit(&elastic, along);
    let shear_modulus = draw.between(0.7, 1.3) * Bedding::estimated_shear_modulus(&elastic, along, poisson_ratio);
    let bedding = Bedding { normal, young_modulus: along, poisson_ratio, shear_modulus };
    let (tensile_strength, fracture_energy) =
        (young_modulus * draw.over_decades(1e-5, 1e-3), draw.over_decades(1.0, 1e3));
    let friction_angle = draw.between(0.0, 60.0).to_radians();
    let across = tensile_strength * draw.over_decades(0.05, 1.0);
    let strength = BedStrength {
        tensile_strength: across,
        cohesion: (across * friction_angle.tan()).max(tensile_strength * draw.over_decades(0.1, 3.0)),
        friction_angle,
        fracture_energy: fracture_energy * draw.over_decades(0.1, 1.0),
    };
    let kind = draw.one_of(criteria);
    let angle = draw.between(5.0, 50.0).to_radians();
    let ratio = kind.least_strength_ratio(angle) * draw.between(1.001, 4.0);
    let criterion = Criterion::new(kind, angle, ratio, elastic.poisson_ratio);
    let law = DamageLaw {
        criterion,
        beds: Some(strength),
        softening: Softening::Exponential,
        ..DamageLaw::rankine(tensile_strength, fracture_energy)
    };
    let mut rock = Rock { elastic, bedding, plane, law, strength, length: 1.0 };
    let softens = rock.softens();
    let longest = 1.0 / softens.length_ratio(tensile_strength, 1.0) / softens.beds.as_ref().unwrap().longest;
    rock.length = draw.between(0.05, 0.6) * longest;
    rock
}

impl Rock {
    fn softens(&self) -> Softens {
        let restraint = Restraint::new(&self.elastic, self.plane, false);
        let beds = Beds::new(&self.elastic, &self.bedding, self.plane, &self.law, restraint.modulus);
        Softens::new(&self.law, Hooke::new(&self.elastic, self.plane), restraint).bedded(beds)
    }

    /// A direction, and the sine and cosine of its angle to the normal of the beds.
    fn direction(&self, draw: &mut Draw) -> (Vec3, f64, f64) {
        let pull = if self.plane.is_some() { draw.turn_in_plane() * Vec3::x() } else { draw.vector().normalize() };
        let cosine = pull.dot(&self.bedding.normal).abs().min(1.0);
        (pull, (1.0 - cosine * cosine).sqrt(), cosine)
    }

    /// Strength of a pull, and whether it parts beds.
    fn jaeger(&self, sine: f64, cosine: f64) -> (f64, bool) {
        let BedStrength { tensile_strength, cohesion, friction_angle, .. } = self.strength;
        let opening = tensile_strength / (cosine * cosine);
        let of_beds = opening.min(cohesion / (sine * cosine + cosine * cosine * friction_angle.tan()));
        (of_beds.min(self.law.tensile_strength), of_beds < self.law.tensile_strength)
    }
}

fn pulled(direction: Vec3) -> Sym3 {
    Sym3::symmetric_part(&(direction * direction.transpose()))
}

/// Work per volume of an edge that goes on straight from an unstrained state through `onset`, where damage begins, and from there along `further` until it has
/// nothing left; and the damage in the end.
fn work(softens: &Softens, strength: f64, length: f64, onset: Sym3, further: Sym3) -> (f64, f64) {
    let beds = softens.beds.as_ref().unwrap();
    let mut edge = EdgeDamage::intact(strength);
    let mut last = (onset, beds.stiffness.stress(onset));
    let mut work = 0.5 * last.1.dot(onset);
    let mut far = 0.0;
    let mut step = 1e-4;
    while (1.0 - edge.damage) * edge.kappa > 1e-4 * strength && far < 1e7 {
        far += step;
        step *= 1.01;
        let strain = onset + further * far;
        let stress = beds.stiffness.stress(strain);
        let seen = softens.see_with_beds(beds, &edge, strength, stress);
        softens.load(&mut edge, seen, strength, length, 0.0);
        let nominal = stress * (1.0 - edge.damage);
        work += 0.5 * (nominal + last.1).dot(strain - last.0);
        last = (strain, nominal);
    }
    (work, edge.damage)
}

/// A pull at any angle breaks where Jaeger says and costs the energy of what it breaks, whether its sides are free or held; pressed beds slide where Jaeger says.
pub(crate) fn by_angle(draw: &mut Draw) -> Held {
    let rock = rock(draw, &[CriterionKind::Rankine, CriterionKind::MohrCoulomb]);
    let (softens, Rock { law, strength, .. }) = (rock.softens(), &rock);
    let (beds, ft) = (softens.beds.as_ref().unwrap(), law.tensile_strength);
    let (direction, sine, cosine) = rock.direction(draw);
    let words =
        format!("{:?}, {:?} {:?}, {strength:?} in {ft} Pa, cosine {cosine}", rock.plane, rock.elastic, rock.bedding);
    let (exact, parts) = rock.jaeger(sine, cosine);
    let found = ft / beds.equivalent_stress(&law.criterion, pulled(direction));
    hold((found / exact - 1.0).abs() < 1e-6, || format!("{words}: breaks at {found} instead of {exact}"))?;

    // Pressed to σ₁ and σ₃, beds whose normal lies at an angle to σ₁ slide at σ₁ - σ₃ = (c + σ₃ tan φ)/(sin cos - cos² tan φ).
    let slope = strength.friction_angle.tan();
    let turned = sine * cosine - cosine * cosine * slope;
    if turned > 1e-3 {
        let side = draw.between(0.0, 3.0) * ft;
        let more = (strength.cohesion + side * slope) / turned;
        // Of any principal stress across that plane.
        let q = beds.of_planes(pulled(direction) * -more + Sym3::isotropic(-side));
        hold((q / ft - 1.0).abs() < 1e-6, || format!("{words}: q = {q} as it slides"))?;
    }

    let energy = if parts { strength.fracture_energy } else { law.fracture_energy };
    // Between the two the beds and the rock break at once.
    if parts && exact > 0.98 * ft {
        return Ok(());
    }
    let strain = strain_of(&rock, pulled(direction) * (exact * (1.0 - 1e-9)));
    let (free, _) = work(&softens, ft, rock.length, strain, strain);
    let ratio = free * rock.length / energy;
    hold((ratio - 1.0).abs() < 0.01, || format!("{words}: a free pull takes {ratio} of its energy"))?;

    // A band across the pull that is held sideways: what it adds to the traction has the direction of the traction.
    if !parts || cosine > 0.999 {
        let traction = pulled(direction) * direction * exact;
        let opening = inverse(beds.stiffness.of_waves(direction), rock.plane.is_some()) * traction;
        let further = Sym3::symmetric_part(&(opening * direction.transpose()));
        let (held, _) = work(&softens, ft, rock.length, strain, further);
        let ratio = held * rock.length / energy;
        hold((ratio - 1.0).abs() < 0.01, || format!("{words}: a band that is held takes {ratio} of its energy"))?;
    }
    Ok(())
}

fn strain_of(rock: &Rock, stress: Sym3) -> Sym3 {
    let rows = *rock.softens().beds.as_ref().unwrap().stiffness.rows();
    if rock.plane.is_some() {
        let axes = [0, 1, 3];
        let matrix = Mat3::from_fn(|i, j| rows[axes[i]][axes[j]]).try_inverse().unwrap();
        let strain = matrix * Vec3::from_fn(|i, _| stress.0[axes[i]]);
        return Sym3([strain.x, strain.y, 0.0, 0.5 * strain.z, 0.0, 0.0]);
    }
    let all = nalgebra::Matrix6::from_fn(|i, j| rows[i][j]).try_inverse().unwrap();
    let strain = all * nalgebra::Vector6::from(stress.0);
    Sym3(std::array::from_fn(|i| if i < 3 { strain[i] } else { 0.5 * strain[i] }))
}

fn inverse(waves: Sym3, in_plane: bool) -> Mat3 {
    let mut matrix = waves.to_matrix();
    if in_plane {
        matrix[(2, 2)] = 1.0;
    }
    matrix.try_inverse().unwrap()
}

/// q grows with the stress as a number does, is convex, and turns with the beds; nothing mends on any way, and no step of damage gives energy.
pub(crate) fn way(draw: &mut Draw) -> Held {
    let rock = rock(
        draw,
        &[
            CriterionKind::Rankine,
            CriterionKind::MohrCoulomb,
            CriterionKind::PureMohrCoulomb,
            CriterionKind::DruckerPrager,
            CriterionKind::ModifiedMohrCoulomb,
        ],
    );
    let softens = rock.softens();
    let (beds, ft, criterion) = (softens.beds.as_ref().unwrap(), rock.law.tensile_strength, &rock.law.criterion);
    let words = format!("{:?} {:?}, {:?}", criterion.kind(), rock.plane, rock.strength);
    let in_plane = rock.plane.is_some();
    let turn = if in_plane { draw.turn_in_plane() } else { draw.turn() };
    let turned = |tensor: Sym3| Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()));
    let normal = turn * rock.bedding.normal;
    let other = Rock { bedding: Bedding { normal, ..rock.bedding }, law: rock.law.clone(), ..rock };
    let of_turned = other.softens();
    let any = |draw: &mut Draw, far: f64| {
        let [xx, yy, zz, xy, yz, zx]: [f64; 6] = std::array::from_fn(|_| far * draw.between(-1.0, 1.0));
        if in_plane { Sym3([xx, yy, 0.0, xy, 0.0, 0.0]) } else { Sym3([xx, yy, zz, xy, yz, zx]) }
    };
    let (one, two) = (any(draw, 2.0 * ft), any(draw, 2.0 * ft));
    let q = |stress: Sym3| beds.equivalent_stress(criterion, stress);
    let times = draw.over_decades(0.1, 10.0);
    hold((q(one * times) - times * q(one)).abs() <= 1e-6 * times * ft, || format!("{words}: not in proportion"))?;
    let share = draw.between(0.0, 1.0);
    let (mean, most) = (q(one * share + two * (1.0 - share)), share * q(one) + (1.0 - share) * q(two));
    let is_convex = criterion.kind() == CriterionKind::ModifiedMohrCoulomb || mean <= most + 1e-6 * ft;
    hold(is_convex, || format!("{words}: {mean} between, {most}"))?;
    let of_other = of_turned.beds.as_ref().unwrap();
    let off = of_other.equivalent_stress(criterion, turned(one)) - q(one);
    hold(off.abs() <= 1e-6 * ft, || format!("{words}: turned by {off}"))?;
    if beds.surely_below(criterion, one, ft) {
        hold(q(one) <= ft * (1.0 + 1e-7), || format!("{words}: hides {}", q(one)))?;
    }

    let far = ft / rock.elastic.young_modulus * draw.over_decades(0.5, 20.0);
    let (one, two) = (any(draw, far), any(draw, far));
    let (mut edge, mut turning) = (EdgeDamage::intact(ft), EdgeDamage::intact(ft));
    let (mut from, mut nominal) = (Sym3::ZERO, Sym3::ZERO);
    for at in (1..=300).map(|step| f64::from(step) / 300.0) {
        let to = one * ((7.0 * at).sin() * at) + two * (17.0 * at).sin();
        let stress = beds.stiffness.stress(to);
        let (before, damage) = (edge, edge.damage);
        let seen = softens.see_with_beds(beds, &edge, ft, stress);
        hold(seen.stress <= q(stress) * (1.0 + 1e-9), || format!("{words}: sees {seen:?} of {}", q(stress)))?;
        let growth = softens.load(&mut edge, seen, ft, rock.length, 0.0);
        hold(growth >= 0.0 && (0.0..=1.0).contains(&edge.damage), || format!("{words}: {edge:?} after {before:?}"))?;
        let mends = edge.kappa < before.kappa || before.broken && !edge.broken || edge.lateral > before.lateral;
        hold(!mends, || format!("{words}: mends to {edge:?} from {before:?}"))?;
        let is_kept = before.lateral == f64::INFINITY || edge.band() == before.band();
        hold(is_kept, || format!("{words}: another band after the onset"))?;
        let (stored, now) = (0.5 * nominal.dot(from), stress * (1.0 - edge.damage));
        let missing = 0.5 * (nominal + now).dot(to - from) + stored - 0.5 * now.dot(to);
        let taken = softens.taken(damage, [from, to], stress, None).by(growth);
        let scale = stress.dot(to) + ft * far;
        hold(growth == 0.0 || (taken - missing.max(0.0)).abs() <= 1e-6 * scale, || {
            format!("{words}: takes {taken} of {missing}")
        })?;
        let turned_stress = of_other.stiffness.stress(turned(to));
        let seen = of_turned.see_with_beds(of_other, &turning, ft, turned_stress);
        of_turned.load(&mut turning, seen, ft, rock.length, 0.0);
        let off = edge.damage - turning.damage;
        hold(off.abs() < 1e-3, || format!("{words}: damage {} turned, {}", turning.damage, edge.damage))?;
        (from, nominal) = (to, now);
    }
    Ok(())
}
