//! Instances of parts: which labels are theirs, and where they lie.

use fractum_math::{Vec3, rotation_by};

/// Instance to which lines belong; none of the assembly and of files without parts.
pub(super) type Scope = Option<usize>;

/// Bytes of parts that all instances may repeat.
pub(super) const MOST_READ: usize = 1 << 32;

/// Instances in the order of the file. Each has labels of its own.
#[derive(Default)]
pub(super) struct Instances {
    pub(super) list: Vec<Instance>,
    /// What is added to labels of the assembly.
    of_assembly: u64,
    is_set_apart: bool,
    bytes: usize,
}

pub(super) struct Instance {
    pub(super) name: String,
    motion: Motion,
    /// What is added to its labels.
    offset: u64,
}

/// How an instance lies beside its part: moved, then turned.
#[derive(Clone, Copy, Default)]
pub(super) struct Motion {
    shift: Vec3,
    /// A point of the axis, and the vector of the rotation.
    turn: Option<(Vec3, Vec3)>,
}

impl Motion {
    /// Takes a line of an instance; none of one that says something else.
    pub(super) fn add(&mut self, line: usize, fields: &[&str]) -> Option<()> {
        let given = fields.iter().filter(|field| !field.is_empty());
        let numbers: Vec<f64> =
            given.map(|field| field.parse().ok().filter(|x: &f64| x.is_finite())).collect::<Option<_>>()?;
        match (line, numbers.as_slice()) {
            (0, shift) if shift.len() <= 3 => {
                self.shift.iter_mut().zip(shift).for_each(|(x, &by)| *x = by);
            }
            (0 | 1, &[ax, ay, az, bx, by, bz, degrees]) => {
                let (from, to) = (Vec3::new(ax, ay, az), Vec3::new(bx, by, bz));
                let axis = (to - from).try_normalize(0.0)?;
                self.turn = Some((from, axis * degrees.to_radians()));
            }
            _ => return None,
        }
        Some(())
    }

    fn of(&self, position: Vec3) -> Vec3 {
        let moved = position + self.shift;
        self.turn.map_or(moved, |(axis, turn)| axis + rotation_by(turn) * (moved - axis))
    }
}

impl Instances {
    /// Opens an instance, whose labels follow those up to `highest`.
    pub(super) fn open(&mut self, name: &str, motion: Motion, highest: u64) -> usize {
        self.list.push(Instance { name: name.to_owned(), motion, offset: highest });
        self.list.len() - 1
    }

    /// Sets labels of the assembly apart from those of the instances before it.
    pub(super) fn set_apart(&mut self, scope: Scope, highest: u64) {
        if scope.is_none() && !self.list.is_empty() && !std::mem::replace(&mut self.is_set_apart, true) {
            self.of_assembly = highest;
        }
    }

    /// Whether so many bytes of a part may be read once more.
    pub(super) fn may_read(&mut self, bytes: usize) -> bool {
        self.bytes = self.bytes.saturating_add(bytes);
        self.bytes <= MOST_READ
    }

    /// Number of the instance of that name.
    pub(super) fn find(&self, name: &str) -> Scope {
        self.list.iter().position(|instance| instance.name.eq_ignore_ascii_case(name))
    }

    /// A label, which may follow the name of an instance and a point; none of what is no number.
    pub(super) fn label(&self, field: &str, scope: Scope) -> Option<u64> {
        let (scope, label) = match field.rsplit_once('.') {
            Some((instance, label)) => (self.find(super::deck::unquoted(instance)).or(scope), label),
            None => (scope, field),
        };
        let offset = scope.map_or(self.of_assembly, |instance| self.list[instance].offset);
        label.parse::<u64>().ok()?.checked_add(offset)
    }

    /// Where a node of a part lies in an instance.
    pub(super) fn placed(&self, position: Vec3, scope: Scope) -> Vec3 {
        scope.map_or(position, |instance| self.list[instance].motion.of(position))
    }
}
