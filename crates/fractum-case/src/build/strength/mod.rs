//! Strength where it varies over a body: by place, and by chance.

mod flaws;
mod particles;
mod places;
mod spots;

use fractum_fem::{Body, ElementKind};
use fractum_math::Vec3;
use fractum_math::elementary::{cbrt, ln, pow};
use rand::SeedableRng;
use rand_distr::{Distribution as _, OpenClosed01, Uniform};
use rand_pcg::Pcg64Mcg;

use super::Context;
use super::bodies::{Numbering, Part};
use crate::model::{Damage, Distribution, Reference, Scatter, SolidBody, Weibull};
use flaws::Reach;
use places::Places;
use spots::weakest_of_edges;

/// Diameter of the penny-shaped crack that runs at a stress σ, over E Gf/σ² (Griffith; Sneddon 1946): a spot of that size at least has to
/// be weak for a body to break at its strength.
const PENNY: f64 = std::f64::consts::FRAC_PI_2;

/// What a body with Weibull's strength is expected to bear.
#[derive(Clone, Debug)]
pub struct WeibullReport {
    /// Name of the body.
    pub body: String,
    /// Its volume [m³], or the area of its free surface [m²], where damage may occur.
    pub measure: f64,
    /// Volume or area that the strength belongs to.
    pub reference: Reference,
    /// Diameter of a weak spot at the strength given [m].
    pub correlation_length: f64,
    /// Whether weaker flaws have larger spots, with one over the strength squared.
    pub grows: bool,
    /// Diameter of a weak spot over the mean size of elements, or diameter of particles.
    pub sizes: f64,
    /// Mean of the strength under uniform tension [Pa].
    pub mean: f64,
    /// Standard deviation over mean.
    pub variation: f64,
    /// Strength at its weakest flaw [Pa], and where that lies [m]; none where it has no flaw.
    pub weakest: Option<(f64, Vec3)>,
}

impl WeibullReport {
    /// That of a body without name.
    ///
    /// - `strength` [Pa] and `measure` [m³], [m²] of the body; `[radius, size]`: of a weak spot, and of an element or particle [m]
    fn of(
        weibull: &Weibull,
        strength: f64,
        measure: f64,
        [radius, size]: [f64; 2],
        weakest: Option<flaws::Flaw>,
    ) -> Self {
        WeibullReport {
            body: String::new(),
            measure,
            reference: weibull.reference,
            correlation_length: 2.0 * radius,
            grows: weibull.correlation_length.is_none(),
            sizes: 2.0 * radius / size,
            mean: strength * weibull.mean(measure),
            variation: weibull.variation(),
            weakest: weakest.map(|flaw| (strength * weibull.factor(flaw.level), flaw.place)),
        }
    }
}

/// A solid body whose edges are given their strength.
struct Edges<'a> {
    body: &'a Body,
    /// Place among the solid bodies.
    index: usize,
    nodes: &'a [Vec3],
    /// Nodes of each, ascending.
    ends: Vec<[u32; 2]>,
    /// Which of them may be damaged; empty where all may.
    marked: &'a [bool],
}

impl Edges<'_> {
    fn middle(&self, edge: usize) -> Vec3 {
        let [i, j] = self.ends[edge].map(|node| self.nodes[node as usize]);
        (i + j) * 0.5
    }

    /// Those of an element that may be damaged.
    fn of_element(&self, element: usize) -> impl Iterator<Item = usize> + '_ {
        let corners = self.body.shape.node_count();
        let nodes = &self.body.elements[element];
        let pairs = (0..corners).flat_map(move |i| (i + 1..corners).map(move |j| [nodes[i], nodes[j]]));
        let edge = move |[i, j]: [u32; 2]| self.ends.binary_search(&[i.min(j), i.max(j)]).expect("an edge of the body");
        pairs.map(edge).filter(move |&edge| self.marked.get(edge).copied().unwrap_or(true))
    }
}

impl Context<'_> {
    /// Which edges of a body may be damaged where not all may, factors on the strength of each where it varies, and those that it has by its flaws.
    ///
    /// - `index`: of the body among the solids; `boundary`: free facets of all solids
    pub(super) fn edges_of(
        &mut self,
        (part, index): (&Part, usize),
        body: &Body,
        damage: &Damage,
        numbering: &Numbering,
        boundary: &[[u32; 3]],
    ) -> (Vec<bool>, [Vec<f64>; 2]) {
        let SolidBody { damage_where, strength_factor, .. } = part.body;
        let (mut marked, mut factors) = (Vec::new(), Vec::new());
        let weibull = damage.scatter.as_ref().and_then(Scatter::weibull);
        let varies = strength_factor.is_some() || damage.scatter.is_some() && weibull.is_none();
        if damage_where.is_none() && !varies && weibull.is_none() {
            return (marked, Default::default());
        }
        let (mut wrong, mut ends) = (None, Vec::new());
        let nodes = &numbering.positions;
        body.each_edge(nodes.len(), |[i, j]| {
            let middle = (nodes[i as usize] + nodes[j as usize]) * 0.5;
            marked.extend(damage_where.as_ref().map(|condition| condition.value.holds_at(middle)));
            let by_place = strength_factor.as_ref().map_or(1.0, |factor| factor.value.at(middle));
            if !(by_place > 0.0 && by_place.is_finite()) {
                wrong.get_or_insert((by_place, middle));
            }
            let by_chance = damage.scatter.as_ref().map_or(1.0, |scatter| factor_of_edge(scatter, middle));
            factors.extend(varies.then_some(by_place * by_chance));
            ends.extend(weibull.map(|_| [i, j]));
        });
        if let Some(condition) = damage_where.as_ref().filter(|_| !marked.contains(&true)) {
            let found = ": no edge of the body fulfils the condition";
            self.error(&condition.place, found, "damage somewhere, or damage = false");
        }
        if let Some(((value, p), factor)) = wrong.zip(strength_factor.as_ref()) {
            let found = format!(" is {value} at ({:.4e}, {:.4e}, {:.4e}) m", p.x, p.y, p.z);
            self.error(&factor.place, found, "a positive factor everywhere");
        }
        let by_flaws = weibull.map(|(weibull, seed)| {
            let edges = Edges { body, index, nodes, ends, marked: &marked };
            self.weibull_factors(&edges, (weibull, seed), damage, boundary)
        });
        (marked, [factors, by_flaws.unwrap_or_default()])
    }

    /// Factors on the strength of the edges of a body, each by the weakest flaw within its reach.
    fn weibull_factors(
        &mut self,
        edges: &Edges<'_>,
        (weibull, seed): (&Weibull, u64),
        damage: &Damage,
        boundary: &[[u32; 3]],
    ) -> Vec<f64> {
        let zone = damage.law.process_zone(edges.body.elastic.young_modulus);
        let reach = match weibull.correlation_length {
            Some(length) => Reach::of_length(length),
            None => Reach::of_crack(PENNY * zone, weibull.modulus),
        };
        let places = Places::new(edges, weibull.reference, boundary, seed);
        let shares = places.shares(edges);
        let share = self.division.map(|division| &division.bodies[edges.index]);
        let exchange = self.exchange.as_deref().filter(|_| share.is_some());
        let is_owned = |element: usize| share.is_none_or(|share| share.is_owned[element]);
        let total = spots::total(exchange, edges, &shares, is_owned);
        let reference = weibull.reference.measure();
        let [element, body] = [total.measure / total.elements, total.measure].map(|x| x / reference);
        let most = reach.level_kept(|radius| places.spot(edges, radius) / reference, element, body);
        let mut flaws = places.flaws_below(edges, most);
        flaws.retain(|(element, _)| edges.of_element(*element as usize).next().is_some());
        let (levels, weakest) = weakest_of_edges(exchange, edges, &flaws, (reach, most), is_owned);
        let strength = damage.law.tensile_strength;
        let size = match edges.body.shape {
            ElementKind::T4 => cbrt(6.0 * 2f64.sqrt() * total.size),
            ElementKind::T3 => (4.0 * total.size / 3f64.sqrt()).sqrt(),
        };
        let report = WeibullReport::of(weibull, strength, total.measure, [reach.radius, size], weakest);
        self.weibull.push(WeibullReport { body: edges.body.name.clone(), ..report });
        levels.into_iter().map(|level| weibull.factor(level)).collect()
    }
}

/// The factor that one edge draws for itself, by its place alone: its own stream of the named generator PCG-64 MCG.
fn factor_of_edge(scatter: &Scatter, middle: Vec3) -> f64 {
    let place = middle.iter().fold(scatter.seed, |hash, c| (hash ^ c.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut generator = Pcg64Mcg::seed_from_u64(place);
    match scatter.distribution {
        Distribution::Weibull(_) => 1.0,
        Distribution::WeibullPerEdge { modulus } => {
            let survival: f64 = OpenClosed01.sample(&mut generator);
            pow(-ln(survival), 1.0 / modulus)
        }
        // Parameters were checked with the case; 1 would be "no scatter".
        Distribution::UniformPerEdge { width } => {
            Uniform::new_inclusive(1.0 - width, 1.0 + width).map_or(1.0, |d| d.sample(&mut generator))
        }
    }
}
