//! What frames show: a file per population.

use serde::{Deserialize, Serialize};

/// A population that frames show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Population {
    /// Elements of solids.
    Solid,
    /// Discrete elements.
    Debris,
    /// Particles of bonded bodies.
    Bonded,
    /// Loose particles.
    Loose,
    /// Bonds that hold.
    Bonds,
    /// Facets that removal has exposed.
    Cracks,
    /// Gas in cracks.
    Gas,
    /// Surfaces of rigid bodies.
    Rigid,
    /// Interfaces between elements.
    Interfaces,
    /// Contacts of particles.
    Contacts,
}

impl Population {
    /// All of them.
    pub const ALL: [Population; 10] = [
        Population::Solid,
        Population::Debris,
        Population::Bonded,
        Population::Loose,
        Population::Bonds,
        Population::Cracks,
        Population::Gas,
        Population::Rigid,
        Population::Interfaces,
        Population::Contacts,
    ];

    /// Its number in the collection.
    pub fn number(self) -> u32 {
        self.names().0
    }

    /// Its name in the collection.
    pub fn name(self) -> &'static str {
        self.names().1
    }

    /// The population of that name.
    pub fn named(name: &str) -> Option<Self> {
        Population::ALL.into_iter().find(|population| population.name() == name)
    }

    /// Folder of its files in the results folder.
    pub fn folder(self) -> &'static str {
        self.names().2[0]
    }

    /// What the names of its files in frame `number` begin with.
    pub fn stem(self, number: u64) -> String {
        format!("{}-{number:05}", self.names().2[1])
    }

    /// What the names of its files end with.
    pub fn ending(self) -> &'static str {
        self.names().2[2]
    }

    /// Number, name, and folder, stem and ending of its files.
    fn names(self) -> (u32, &'static str, [&'static str; 3]) {
        match self {
            Population::Solid => (0, "solid", ["fields", "solid", "vtu"]),
            Population::Debris => (1, "discrete elements", ["particles", "particles", "vtp"]),
            Population::Bonded => (2, "bonded particles", ["particles", "bonded", "vtp"]),
            Population::Loose => (6, "loose particles", ["particles", "loose", "vtp"]),
            Population::Bonds => (3, "bonds", ["bonds", "bonds", "vtp"]),
            Population::Cracks => (4, "cracks", ["cracks", "cracks", "vtp"]),
            Population::Gas => (5, "gas", ["gas", "gas", "vtu"]),
            Population::Rigid => (7, "rigid bodies", ["rigid", "rigid", "vtp"]),
            Population::Interfaces => (8, "interfaces", ["interfaces", "interfaces", "vtp"]),
            Population::Contacts => (9, "contacts", ["contacts", "contacts", "vtp"]),
        }
    }

    /// Whether pictures show it.
    pub fn is_drawn(self) -> bool {
        use Population::{Bonds, Contacts, Cracks, Gas, Interfaces};
        !matches!(self, Bonds | Contacts | Cracks | Gas | Interfaces)
    }

    /// Whether it is what the case is about: pictures frame it, and magnify how far it has moved.
    pub fn is_body(self) -> bool {
        self.is_drawn() && self != Population::Rigid
    }
}
