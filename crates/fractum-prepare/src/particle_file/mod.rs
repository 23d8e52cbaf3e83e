//! Files of particles: tables, LAMMPS data and dumps, extended xyz. The content says which of them a file is.

mod lammps_data;
mod lammps_dump;
mod table;
mod xyz;

use fractum_math::Vec3;

use crate::asked::{At, Fault, ParticleFile};

/// Particles as a file has them, in the order of their numbers there.
#[derive(Clone, Debug, Default)]
pub(crate) struct FileParticles {
    /// What the file is.
    pub(crate) format: &'static str,
    /// Centres [m].
    pub(crate) position: Vec<Vec3>,
    /// Radii [m].
    pub(crate) radius: Vec<f64>,
    /// Velocities [m/s]; empty where they are not taken.
    pub(crate) velocity: Vec<Vec3>,
    /// Angular velocities [1/s]; empty where there are none.
    pub(crate) spin: Vec<Vec3>,
    /// Bonds i < j between them, ascending, each once.
    pub(crate) bonds: Vec<[u32; 2]>,
    /// What the plan says of the file beside its format and the number of particles.
    pub(crate) notes: Vec<String>,
}

impl FileParticles {
    /// What was read, in words.
    pub(crate) fn told(&self) -> String {
        let notes: String = self.notes.iter().map(|note| format!("; {note}")).collect();
        format!("read {} of a file: {} particles{notes}", self.format, self.radius.len())
    }
}

/// A line that is not what it should be.
pub(crate) struct Wrong {
    /// What was found, with the line.
    found: String,
    expected: &'static str,
}

impl Wrong {
    fn at(line: usize, found: impl std::fmt::Display, expected: &'static str) -> Self {
        Wrong { found: format!("line {line}: {found}"), expected }
    }
}

/// A particle of a file, in the units of the file.
#[derive(Clone, Debug, Default)]
struct Row {
    id: Option<i64>,
    species: Option<String>,
    line: usize,
    position: [f64; 3],
    radius: f64,
    velocity: Option<[f64; 3]>,
    spin: Option<[f64; 3]>,
}

/// A file before it is chosen from.
#[derive(Default)]
struct Content {
    format: &'static str,
    rows: Vec<Row>,
    /// Bonds: lines, and numbers of their particles.
    bonds: Vec<(usize, [i64; 2])>,
    notes: Vec<String>,
}

/// Reads a file of particles.
///
/// # Errors
/// A file that is none, or a line of it that is wrong.
pub(crate) fn read(asked: &ParticleFile<'_>) -> Result<FileParticles, Fault> {
    let fault = |found: String, expected: &'static str| Fault { expected, ..Fault::new(At::File, found) };
    let text = std::str::from_utf8(asked.bytes).map_err(|_| fault("is not text".to_owned(), table::EXPECTED))?;
    let (content, has_frames) = if lammps_dump::is_one(text) {
        (lammps_dump::read(text, asked.frame), true)
    } else if xyz::is_one(text) {
        (xyz::read(text, asked.frame), true)
    } else if lammps_data::is_one(text) {
        (lammps_data::read(text), false)
    } else {
        (table::read(text), false)
    };
    let mut content = content.map_err(|wrong| fault(wrong.found, wrong.expected))?;
    if asked.frame.is_some() && !has_frames {
        return Err(fault(format!("is {}, which has no frames", content.format), "a dump or an xyz file beside frame"));
    }
    if let Some(species) = asked.species {
        choose(&mut content, species).map_err(|found| fault(found, "a type of particles of the file"))?;
    }
    in_order(&mut content.rows).map_err(|found| fault(found, "particles of different numbers"))?;
    taken(content, asked).map_err(|found| fault(found, "particles with radius and place"))
}

/// Keeps the particles of a type.
fn choose(content: &mut Content, species: &str) -> Result<(), String> {
    let mut known: Vec<String> = content.rows.iter().filter_map(|row| row.species.clone()).collect();
    known.sort();
    known.dedup();
    if known.is_empty() {
        return Err(format!("is {}, whose particles have no types", content.format));
    }
    if !known.iter().any(|own| own == species) {
        return Err(format!("has no particles of the type \"{species}\"; it has {}", known.join(", ")));
    }
    let all = content.rows.len();
    content.rows.retain(|row| row.species.as_deref() == Some(species));
    content.notes.push(format!("those of the type {species}, of {all}"));
    Ok(())
}

/// Particles in the order of their numbers: programs that run in parallel write them in any.
fn in_order(rows: &mut [Row]) -> Result<(), String> {
    if rows.iter().any(|row| row.id.is_none()) {
        return Ok(());
    }
    rows.sort_by_key(|row| row.id);
    match rows.windows(2).find(|pair| pair[0].id == pair[1].id) {
        Some([first, second]) => {
            let id = first.id.unwrap_or_default();
            Err(format!("lines {} and {}: both are particle {id}", first.line, second.line))
        }
        _ => Ok(()),
    }
}

/// Particles in SI units.
fn taken(content: Content, asked: &ParticleFile<'_>) -> Result<FileParticles, String> {
    let Content { format, rows, bonds, mut notes } = content;
    let bonds = between(&rows, &bonds, asked.species.is_some())?;
    if rows.is_empty() {
        return Err("holds no particle".to_owned());
    }
    for Row { line, position, radius, .. } in &rows {
        if !(position.iter().all(|x| x.is_finite()) && radius.is_finite() && *radius > 0.0) {
            return Err(format!("line {line}: a particle of radius {radius} at {position:?}"));
        }
    }
    let vector = |v: &[f64; 3], unit: f64| Vec3::from(*v) * unit;
    let all = |of: fn(&Row) -> Option<[f64; 3]>, unit: f64| -> Vec<Vec3> {
        let found: Vec<Vec3> = rows.iter().map_while(|row| of(row).map(|v| vector(&v, unit))).collect();
        if found.len() == rows.len() { found } else { Vec::new() }
    };
    let (velocity, spin) = match asked.velocity_unit {
        Some(unit) => (all(|row| row.velocity, unit), all(|row| row.spin, 1.0)),
        None => (Vec::new(), Vec::new()),
    };
    let has_velocities = rows.iter().all(|row| row.velocity.is_some());
    match asked.velocity_unit {
        Some(_) if !has_velocities => return Err(format!("is {format}, without velocities of all particles")),
        Some(_) if spin.is_empty() => notes.push("with their velocities, without rotation".to_owned()),
        Some(_) => notes.push("with their velocities and rotations".to_owned()),
        None if has_velocities => notes.push("without its velocities (velocity_unit takes them)".to_owned()),
        None => {}
    }
    let wild = velocity.iter().chain(&spin).position(|v| !v.iter().all(|x| x.is_finite()));
    if let Some(place) = wild {
        return Err(format!("line {}: a velocity that is no number", rows[place % rows.len()].line));
    }
    Ok(FileParticles {
        format,
        position: rows.iter().map(|row| vector(&row.position, asked.unit)).collect(),
        radius: rows.iter().map(|row| row.radius * asked.unit).collect(),
        velocity,
        spin,
        bonds,
        notes,
    })
}

/// Bonds as pairs of places in the list of particles.
///
/// - `chosen`: whether particles were left out, with their bonds
fn between(rows: &[Row], bonds: &[(usize, [i64; 2])], chosen: bool) -> Result<Vec<[u32; 2]>, String> {
    let mut pairs = Vec::with_capacity(bonds.len());
    for (line, ends) in bonds {
        let place = |id: i64| rows.binary_search_by_key(&Some(id), |row| row.id).ok().map(|place| place as u32);
        match ends.map(place) {
            [Some(first), Some(second)] if first != second => pairs.push([first.min(second), first.max(second)]),
            [Some(_), Some(_)] => return Err(format!("line {line}: a bond of particle {} with itself", ends[0])),
            _ if chosen => {}
            [first, _] => {
                let id = if first.is_none() { ends[0] } else { ends[1] };
                return Err(format!("line {line}: a bond of particle {id}, which is not there"));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    Ok(pairs)
}

/// Names of columns, and what of a particle they are.
#[derive(Clone, Debug, Default)]
struct Columns {
    count: usize,
    id: Option<usize>,
    species: Option<usize>,
    position: [Option<usize>; 3],
    /// Bounds of the box that coordinates are shares of, by axis.
    scaled: Option<[[f64; 2]; 3]>,
    radius: Option<usize>,
    /// 1 for radii, 0.5 for diameters.
    half: f64,
    velocity: [Option<usize>; 3],
    spin: [Option<usize>; 3],
}

impl Columns {
    /// Those of these names; other names are passed over.
    fn of<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let mut own = Columns { half: 1.0, ..Columns::default() };
        for (place, name) in names.into_iter().enumerate() {
            own.count = place + 1;
            let axis = |list: [&str; 3]| list.iter().position(|known| *known == name);
            let name_of_axis = |lists: &[[&str; 3]]| lists.iter().find_map(|list| axis(*list));
            match name {
                "id" | "particle_identifier" => own.id = Some(place),
                "type" | "species" | "element" | "particle_type" => own.species = Some(place),
                "radius" | "r" => (own.radius, own.half) = (Some(place), 1.0),
                "diameter" if own.radius.is_none() => (own.radius, own.half) = (Some(place), 0.5),
                _ => {
                    if let Some(axis) = name_of_axis(&[["x", "y", "z"], ["xu", "yu", "zu"]]) {
                        own.position[axis] = own.position[axis].or(Some(place));
                    } else if let Some(axis) = name_of_axis(&[["vx", "vy", "vz"]]) {
                        own.velocity[axis] = Some(place);
                    } else if let Some(axis) = name_of_axis(&[["omegax", "omegay", "omegaz"], ["wx", "wy", "wz"]]) {
                        own.spin[axis] = Some(place);
                    }
                }
            }
        }
        own
    }

    /// What is missing of a particle.
    fn lacks(&self) -> Option<&'static str> {
        let names = ["x", "y", "z"];
        let missing = self.position.iter().position(Option::is_none).map(|axis| names[axis]);
        missing.or(self.radius.is_none().then_some("radius"))
    }

    /// A particle from the words of a line.
    fn row(&self, words: &[&str], line: usize) -> Result<Row, Wrong> {
        let word = |place: usize| {
            let expected = "as many columns as there are names of them";
            words.get(place).copied().ok_or_else(|| Wrong::at(line, format!("has {} columns", words.len()), expected))
        };
        let number = |place: usize| -> Result<f64, Wrong> {
            let word = word(place)?;
            word.parse().map_err(|_| Wrong::at(line, format!("`{word}`"), "a number"))
        };
        let vector = |places: &[Option<usize>; 3]| -> Result<Option<[f64; 3]>, Wrong> {
            let [Some(x), Some(y), Some(z)] = *places else { return Ok(None) };
            Ok(Some([number(x)?, number(y)?, number(z)?]))
        };
        let mut position = vector(&self.position)?.unwrap_or([f64::NAN; 3]);
        if let Some(bounds) = self.scaled {
            for (x, [low, high]) in position.iter_mut().zip(bounds) {
                *x = low + *x * (high - low);
            }
        }
        let id = self.id.map(|place| {
            let word = word(place)?;
            word.parse().map_err(|_| Wrong::at(line, format!("`{word}`"), "the number of a particle"))
        });
        Ok(Row {
            id: id.transpose()?,
            species: self.species.map(|place| word(place).map(str::to_owned)).transpose()?,
            line,
            position,
            radius: self.radius.map_or(Ok(f64::NAN), number)? * self.half,
            velocity: vector(&self.velocity)?,
            spin: vector(&self.spin)?,
        })
    }
}

/// Lines with their numbers from 1 on.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines())
}

/// What follows of a file that ends too early.
fn cut_short(text: &str, expected: &'static str) -> Wrong {
    Wrong::at(text.lines().count(), "the file ends here", expected)
}

#[cfg(test)]
mod tests;
