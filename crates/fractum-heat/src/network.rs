use fractum_math::CHUNK;
use rayon::prelude::*;

/// Points with heat capacities, and the pairs of them that conduct.
#[derive(Clone, Debug, Default)]
pub struct HeatNetwork {
    /// Heat capacity of each point [J/K].
    capacity: Vec<f64>,
    pairs: Vec<[u32; 2]>,
    /// Where the links of each point begin.
    starts: Vec<u32>,
    links: Vec<Link>,
    /// The two links of each pair.
    places: Vec<[u32; 2]>,
}

/// One end of a pair, as its point sees it.
#[derive(Clone, Copy, Debug, Default)]
struct Link {
    other: u32,
    /// [W/K].
    conductance: f64,
}

impl HeatNetwork {
    /// Joins points by pairs.
    ///
    /// - `capacity` [J/K], > 0; `pairs`: each once; `conductances` [W/K], one per pair
    pub fn new(capacity: Vec<f64>, pairs: &[[u32; 2]], conductances: &[f64]) -> Self {
        let mut starts = vec![0u32; capacity.len() + 1];
        for &end in pairs.iter().flatten() {
            starts[end as usize + 1] += 1;
        }
        for point in 0..capacity.len() {
            starts[point + 1] += starts[point];
        }
        let mut next = starts.clone();
        let mut links = vec![Link::default(); 2 * pairs.len()];
        let mut place = |point: u32, other: u32| {
            let place = next[point as usize];
            next[point as usize] += 1;
            links[place as usize].other = other;
            place
        };
        let places = pairs.iter().map(|&[i, j]| [place(i, j), place(j, i)]).collect();
        let mut network = HeatNetwork { capacity, pairs: pairs.to_vec(), starts, links, places };
        network.set_conductances(conductances);
        network
    }

    /// Gives the pairs other conductances [W/K], in their order.
    pub fn set_conductances(&mut self, conductances: &[f64]) {
        for (places, &conductance) in self.places.iter().zip(conductances) {
            places.iter().for_each(|&place| self.links[place as usize].conductance = conductance);
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.capacity.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.capacity.is_empty()
    }

    /// The pairs.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Heat capacity of each point [J/K].
    pub fn capacity(&self) -> &[f64] {
        &self.capacity
    }

    /// Conductance of a pair [W/K].
    pub fn conductance(&self, pair: usize) -> f64 {
        self.links[self.places[pair][0] as usize].conductance
    }

    /// Sum of the conductances of a point, and of their magnitudes [W/K].
    pub(crate) fn sums(&self, point: usize) -> (f64, f64) {
        let links = self.row(point);
        links.iter().fold((0.0, 0.0), |(sum, size), l| (sum + l.conductance, size + l.conductance.abs()))
    }

    #[inline(always)]
    fn row(&self, point: usize) -> &[Link] {
        &self.links[self.starts[point] as usize..self.starts[point + 1] as usize]
    }

    /// Heat that flows into a point from its partners [W].
    #[inline(always)]
    pub(crate) fn flow_into(&self, point: usize, temperature: &[f64]) -> f64 {
        let own = temperature[point];
        self.row(point).iter().fold(0.0, |sum, link| sum + link.conductance * (temperature[link.other as usize] - own))
    }

    /// Heat that flows into every point [W].
    pub fn flows(&self, temperature: &[f64], out: &mut [f64]) {
        out.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
            for (i, out) in (chunk * CHUNK..).zip(out) {
                *out = self.flow_into(i, temperature);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_point_gives_the_other_takes() {
        let network = HeatNetwork::new(vec![1.0; 3], &[[0, 1], [2, 1]], &[0.3, -0.7]);
        let mut flows = [0.0; 3];
        network.flows(&[100.0, 250.0, 400.0], &mut flows);
        assert_eq!(flows, [0.3 * 150.0, 0.3 * -150.0 + -0.7 * 150.0, -0.7 * -150.0]);
        assert_eq!(network.conductance(1), -0.7);
        assert_eq!(network.sums(1), (0.3 - 0.7, 1.0));
    }
}
