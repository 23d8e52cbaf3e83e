use std::io::{self, Write};

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::PackError;
use crate::domain::{Domain, DomainData};
use crate::random::Random;

/// Spheres that fill a domain.
#[derive(Clone, Debug)]
pub struct Packing {
    /// The shape filled.
    pub domain: Domain,
    /// Seed of the generator.
    pub seed: u64,
    /// κ of the radii.
    pub dispersion: f64,
    /// Centres [m].
    pub position: Vec<Vec3>,
    /// Radii [m].
    pub radius: Vec<f64>,
    /// For each wall of the domain, its name and the particles that touched it at the end of compaction, ascending.
    pub walls: Vec<(String, Vec<u32>)>,
    /// How compaction ended.
    pub compaction: Compaction,
}

/// State at the end of compaction, before the walls were released.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compaction {
    /// Mean contacts of particles that touch no wall.
    pub coordination: f64,
    /// Mean overlap of touching pairs over the mean radius.
    pub overlap: f64,
    /// Touching pairs.
    pub contacts: usize,
    /// Particles without a rigid cage (fewer than four contacts, removed until none is left).
    pub rattlers: usize,
    /// Relaxation iterations in total.
    pub iterations: usize,
}

/// Gap to a wall over the radius below which spheres made elsewhere are on it.
const ON_WALL: f64 = 0.1;

/// First bytes of a packing file.
const MAGIC: &[u8; 8] = b"fractPK1";

#[derive(Serialize, Deserialize)]
struct Header {
    generator: String,
    domain: DomainData,
    seed: u64,
    dispersion: f64,
    count: u64,
    walls: Vec<(String, Vec<u32>)>,
    compaction: Compaction,
}

impl Packing {
    /// Spheres made elsewhere, in the domain that they fill. On a wall are those that come nearer to it than a tenth of their radius.
    ///
    /// - `position`, `radius`: of each [m], as many of one as of the other
    pub fn of_spheres(domain: Domain, position: Vec<Vec3>, radius: Vec<f64>) -> Self {
        let names = domain.wall_names().iter();
        let mut walls: Vec<(String, Vec<u32>)> = names.map(|name| ((*name).to_owned(), Vec::new())).collect();
        for (i, (x, r)) in (0..).zip(position.iter().zip(&radius)) {
            domain.walls_at(x, |wall, depth, _| {
                if depth < (1.0 + ON_WALL) * r {
                    walls[wall].1.push(i);
                }
            });
        }
        let (least, largest) = radius.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &r| (l.min(r), h.max(r)));
        let mean = radius.iter().sum::<f64>() / radius.len() as f64;
        let compaction = Compaction { coordination: 0.0, overlap: 0.0, contacts: 0, rattlers: 0, iterations: 0 };
        Packing { domain, seed: 0, dispersion: (largest - least) / mean, position, radius, walls, compaction }
    }

    /// From the centre of the first particle of a pair to that of the second, or to its nearest image [m].
    pub fn apart(&self, [i, j]: [usize; 2]) -> Vec3 {
        let apart = self.position[j] - self.position[i];
        self.domain.period().map_or(apart, |period| period.nearest(apart))
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Mean radius [m].
    pub fn mean_radius(&self) -> f64 {
        self.radius.iter().sum::<f64>() / self.radius.len() as f64
    }

    /// Volume of all spheres [m³].
    pub fn sphere_volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.iter().map(|r| r.powi(3)).sum::<f64>()
    }

    /// The particles of a wall set.
    pub fn wall(&self, name: &str) -> Option<&[u32]> {
        self.walls.iter().find(|(n, _)| n == name).map(|(_, set)| set.as_slice())
    }

    /// For each particle, how far it is from touching exactly the walls that it touched at the end of compaction [m]: release
    /// of the walls leaves their particles up to some hundredths of a radius off them. Zero for the others.
    pub fn shift_to_walls(&self) -> Vec<Vec3> {
        self.way_to_walls(|depth, radius| depth - radius)
    }

    /// From each centre to the wall that it touched, to the edge or corner of several; zero for the others [m].
    pub fn to_walls(&self) -> Vec<Vec3> {
        self.way_to_walls(|depth, _| depth)
    }

    /// The way out of the shape at each particle that touched one wall, a flat one; zero for the others.
    pub fn out_of_flat_walls(&self) -> Vec<Vec3> {
        let mut walls = vec![0u32; self.len()];
        self.walls.iter().flat_map(|(_, set)| set).for_each(|&i| walls[i as usize] += 1);
        let mut out = vec![Vec3::zeros(); self.len()];
        for (wall, (_, set)) in self.walls.iter().enumerate() {
            let way = |i: u32| {
                let mut way = Vec3::zeros();
                self.domain.walls_at(&self.position[i as usize], |other, _, inward| {
                    if other == wall {
                        way = -inward;
                    }
                });
                way
            };
            let Some(first) = set.first().map(|&i| way(i)) else { continue };
            if set.iter().all(|&i| (way(i) - first).norm() < 1e-9) {
                set.iter().filter(|&&i| walls[i as usize] == 1).for_each(|&i| out[i as usize] = first);
            }
        }
        out
    }

    /// The way of each particle towards the walls that it touched.
    ///
    /// - `length`: of the way to one of them, from the depth of the centre below it and the radius
    fn way_to_walls(&self, length: impl Fn(f64, f64) -> f64) -> Vec<Vec3> {
        let mut way = vec![Vec3::zeros(); self.len()];
        for (wall, (_, set)) in self.walls.iter().enumerate() {
            for &i in set {
                let i = i as usize;
                self.domain.walls_at(&self.position[i], |other, depth, inward| {
                    if other == wall {
                        way[i] -= inward * length(depth, self.radius[i]);
                    }
                });
            }
        }
        way
    }

    /// For each particle, whether it touched a wall.
    pub fn on_wall(&self) -> Vec<bool> {
        let mut on = vec![false; self.len()];
        self.walls.iter().flat_map(|(_, set)| set).for_each(|&i| on[i as usize] = true);
        on
    }

    /// The packing as bytes: a header and raw little-endian arrays, closed by a checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = Header {
            generator: Random::NAME.into(),
            domain: self.domain.data(),
            seed: self.seed,
            dispersion: self.dispersion,
            count: self.len() as u64,
            walls: self.walls.clone(),
            compaction: self.compaction,
        };
        // Serialising plain numbers and strings into memory has no way to fail.
        let header = postcard::to_stdvec(&header).unwrap_or_default();
        let mut bytes = MAGIC.to_vec();
        bytes.extend((header.len() as u64).to_le_bytes());
        bytes.extend(header);
        for (x, r) in self.position.iter().zip(&self.radius) {
            [x.x, x.y, x.z, *r].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }

    /// Reads what [`Packing::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`PackError::File`] for anything else: wrong kind, cut short, or changed.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PackError> {
        let bad = |what: &str| PackError::File(what.into());
        if !bytes.starts_with(MAGIC) {
            return Err(bad("this is not a fractum packing"));
        }
        let word = |at: usize| -> Option<[u8; 8]> { bytes.get(at..at + 8)?.try_into().ok() };
        let split = bytes.len().saturating_sub(4);
        let (body, sum) = bytes.split_at(split);
        if split < 16 || sum != crc32fast::hash(body).to_le_bytes() {
            return Err(bad("it is cut short or damaged (its checksum does not match)"));
        }
        let length = word(8).map_or(0, u64::from_le_bytes);
        let end = usize::try_from(length).ok().and_then(|n| n.checked_add(16)).filter(|&end| end <= body.len());
        let end = end.ok_or_else(|| bad("its header is longer than the file"))?;
        let header: Header =
            postcard::from_bytes(&body[16..end]).map_err(|e| PackError::File(format!("header: {e}")))?;
        let floats: Vec<f64> = body[end..]
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]))
            .collect();
        let count = floats.len() / 4;
        if header.count != count as u64 || (body.len() - end) != 32 * count || count == 0 {
            return Err(bad("its particle count does not match its length"));
        }
        let sound = |v: &[f64]| v.iter().all(|c| c.is_finite()) && v[3] > 0.0;
        if !floats.chunks_exact(4).all(sound) || header.walls.iter().flat_map(|w| &w.1).any(|&i| i as usize >= count) {
            return Err(bad("it holds impossible numbers"));
        }
        Ok(Packing {
            domain: Domain::from_data(&header.domain)?,
            seed: header.seed,
            dispersion: header.dispersion,
            position: floats.chunks_exact(4).map(|v| Vec3::new(v[0], v[1], v[2])).collect(),
            radius: floats.chunks_exact(4).map(|v| v[3]).collect(),
            walls: header.walls,
            compaction: header.compaction,
        })
    }

    /// Writes `id,x [m],y [m],z [m],radius [m],walls`, one line per particle.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "id,x [m],y [m],z [m],radius [m],walls")?;
        let mut walls = vec![String::new(); self.len()];
        for (name, set) in &self.walls {
            for &i in set {
                let text = &mut walls[i as usize];
                *text += if text.is_empty() { "" } else { " " };
                *text += name;
            }
        }
        for (i, (x, r)) in self.position.iter().zip(&self.radius).enumerate() {
            writeln!(out, "{i},{:e},{:e},{:e},{:e},{}", x.x, x.y, x.z, r, walls[i])?;
        }
        Ok(())
    }

    /// Writes VTK PolyData (`.vtp`): points with `radius` [m] and `wall` (bits in the order of the wall sets), and the
    /// bonds as lines with their particles' ids.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vtp(&self, bonds: &[[u32; 2]], out: &mut dyn Write) -> io::Result<()> {
        let mut wall = vec![0i32; self.len()];
        for (w, (_, set)) in self.walls.iter().enumerate() {
            set.iter().for_each(|&i| wall[i as usize] |= 1 << w);
        }
        let n = self.len();
        let sections: [Vec<u8>; 6] = [
            self.position.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes).collect(),
            self.radius.iter().flat_map(|r| r.to_le_bytes()).collect(),
            wall.iter().flat_map(|w| w.to_le_bytes()).collect(),
            (0..n as i64).flat_map(i64::to_le_bytes).collect(),
            (1..=n as i64).flat_map(i64::to_le_bytes).collect(),
            bonds.iter().flatten().flat_map(|&i| i64::from(i).to_le_bytes()).collect(),
        ];
        let line_ends: Vec<u8> = (1..=bonds.len() as i64).flat_map(|k| (2 * k).to_le_bytes()).collect();
        let mut offset = 0;
        let mut place = |bytes: &Vec<u8>| {
            let at = offset;
            offset += 8 + bytes.len();
            at
        };
        let at: Vec<usize> = sections.iter().chain([&line_ends]).map(&mut place).collect();
        let array = |kind: &str, name: &str, components: usize, at: usize| {
            format!(
                r#"<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{at}"/>"#
            )
        };
        writeln!(
            out,
            r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData><Piece NumberOfPoints="{n}" NumberOfVerts="{n}" NumberOfLines="{}" NumberOfStrips="0" NumberOfPolys="0">
<Points>{}</Points>
<PointData>{}{}</PointData>
<Verts>{}{}</Verts>
<Lines>{}{}</Lines>
</Piece></PolyData>
<AppendedData encoding="raw">"#,
            bonds.len(),
            array("Float64", "Points", 3, at[0]),
            array("Float64", "radius", 1, at[1]),
            array("Int32", "wall", 1, at[2]),
            array("Int64", "connectivity", 1, at[3]),
            array("Int64", "offsets", 1, at[4]),
            array("Int64", "connectivity", 1, at[5]),
            array("Int64", "offsets", 1, at[6]),
        )?;
        out.write_all(b"_")?;
        for bytes in sections.iter().chain([&line_ends]) {
            out.write_all(&(bytes.len() as u64).to_le_bytes())?;
            out.write_all(bytes)?;
        }
        out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PackSpec, pack};

    fn small() -> Packing {
        pack(&PackSpec::new(Domain::cylinder(1.0, 0.4), 200, 11)).unwrap()
    }

    #[test]
    fn a_stored_packing_comes_back_bit_for_bit() {
        let packing = small();
        let back = Packing::from_bytes(&packing.to_bytes()).unwrap();
        assert_eq!(back.to_bytes(), packing.to_bytes());
        assert_eq!(back.walls, packing.walls);
    }

    #[test]
    fn a_damaged_file_is_an_error_at_every_byte() {
        let bytes = small().to_bytes();
        for cut in (0..bytes.len()).step_by(13) {
            assert!(matches!(Packing::from_bytes(&bytes[..cut]), Err(PackError::File(_))));
        }
        for at in (0..bytes.len()).step_by(17) {
            let mut changed = bytes.clone();
            changed[at] ^= 0x10;
            assert!(matches!(Packing::from_bytes(&changed), Err(PackError::File(_))), "byte {at}");
        }
    }

    #[test]
    fn shifted_particles_touch_their_walls_exactly() {
        let packing = small();
        let (shift, to_walls) = (packing.shift_to_walls(), packing.to_walls());
        for (wall, (name, set)) in packing.walls.iter().enumerate() {
            for &i in set {
                let i = i as usize;
                let place = packing.position[i] + shift[i];
                packing.domain.walls_at(&place, |other, depth, _| {
                    assert!(other != wall || (depth - packing.radius[i]).abs() < 1e-12, "{name} {depth}");
                });
                packing.domain.walls_at(&(packing.position[i] + to_walls[i]), |other, depth, _| {
                    assert!(other != wall || depth.abs() < 1e-12, "{name} {depth}");
                });
            }
        }
        let out = packing.out_of_flat_walls();
        assert!(out.iter().zip(&to_walls).all(|(out, way)| out.cross(way).norm() < 1e-12));
        assert!(out.iter().any(|out| (out.norm() - 1.0).abs() < 1e-12));
        assert!(shift.iter().any(|s| s.norm() > 0.0) && shift.iter().all(|s| s.norm() < 0.1 * packing.mean_radius()));
        assert!(packing.on_wall().iter().zip(&shift).all(|(on, s)| *on || s.norm() == 0.0));
    }

    #[test]
    fn csv_has_one_line_per_particle() {
        let packing = small();
        let mut text = Vec::new();
        packing.write_csv(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), packing.len() + 1);
        assert!(text.lines().skip(1).all(|l| l.split(',').count() == 6));
    }
}
