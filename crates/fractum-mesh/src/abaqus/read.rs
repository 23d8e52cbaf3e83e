//! From keywords to what they define.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use fractum_math::Vec3;

use super::deck::{self, Keyword, Line};
use super::element;
use super::instance::{Instances, MOST_READ, Motion, Scope};
use super::sets::Sets;
use crate::mesh::list;
use crate::tagged::cursor::Cursor;
use crate::tagged::element_type::{ElementType, Shape};
use crate::tagged::error::Fault;
use crate::tagged::raw::Records;

/// What a file defines.
#[derive(Default)]
pub(super) struct Deck {
    pub(super) node_tags: Vec<u64>,
    pub(super) nodes: Vec<Vec3>,
    /// First node and place of each block.
    pub(super) node_blocks: Vec<(usize, Records)>,
    pub(super) elements: Vec<Element>,
    /// Labels of the corners of all elements.
    pub(super) corners: Vec<u64>,
    pub(super) element_sets: Sets,
    pub(super) node_sets: Sets,
    pub(super) surfaces: Vec<Surface>,
    /// Types of elements that are left out, with their numbers.
    pub(super) left_out: BTreeMap<String, usize>,
    /// Types of elements that turn about an axis.
    pub(super) axisymmetric: BTreeSet<String>,
    /// Labels of nodes that elements of higher order have between their corners.
    pub(super) mid_nodes: Vec<u64>,
    /// What the file has begun and not ended, such as `PART`.
    pub(super) unended: Vec<String>,
    /// Keyword whose data the file ends with, `NODE` or `ELEMENT`; none of others.
    pub(super) ends_within: Option<&'static str>,
    /// Instances of parts.
    pub(super) instances: Instances,
    /// Where the lines of each part stand, by its name in capitals.
    parts: BTreeMap<String, Range<usize>>,
    /// Instance whose lines these are; none of the assembly and of files without parts.
    scope: Scope,
    /// Highest label of a node or element.
    highest: u64,
}

pub(super) struct Element {
    pub(super) tag: u64,
    pub(super) kind: ElementType,
    /// Index of its first corner.
    pub(super) first_corner: usize,
    pub(super) at: usize,
    pub(super) scope: Scope,
    pub(super) shell: bool,
}

/// A surface of element faces.
pub(super) struct Surface {
    pub(super) name: String,
    pub(super) scope: Scope,
    pub(super) at: usize,
    pub(super) internal: bool,
    /// Element or set of elements, and the label of the face.
    pub(super) faces: Vec<(Faced, String)>,
}

pub(super) enum Faced {
    Label(u64),
    Set(usize),
}

/// What the data lines after a keyword are.
enum Block {
    Nodes {
        set: Option<usize>,
    },
    Elements {
        kind: Option<ElementType>,
        name: String,
        set: Option<usize>,
    },
    /// - `scope`: instance whose labels these are
    Set {
        of_nodes: bool,
        set: usize,
        scope: Scope,
        generate: bool,
    },
    Surface(usize),
    SurfaceOfNodes(usize),
    Other,
}

impl Deck {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut cursor = Cursor::new(bytes);
        cursor.skip_byte_order_mark();
        let mut deck = Deck::default();
        deck.ends_within = match deck.lines(&mut cursor)? {
            Block::Nodes { .. } => Some("NODE"),
            Block::Elements { .. } => Some("ELEMENT"),
            _ => None,
        };
        if deck.instances.list.is_empty() {
            // A file of parts alone.
            let parts = std::mem::take(&mut deck.parts);
            for (name, lines) in &parts {
                if parts.len() > 1 {
                    deck.scope = Some(deck.instances.open(name, Motion::default(), deck.highest));
                }
                deck.lines(&mut Cursor { bytes: &bytes[..lines.end], at: lines.start })?;
            }
        }
        if deck.elements.is_empty() {
            return Err(deck.without_elements(bytes));
        }
        Ok(deck)
    }

    /// What to say of a file without elements that are read.
    fn without_elements(&self, bytes: &[u8]) -> Fault {
        let expected = "at least one *ELEMENT of a solid, such as C3D4, C3D8 or CPS4";
        if self.left_out.is_empty() {
            return Fault::unsupported(bytes.len(), format!("the file has no elements; expected {expected}"));
        }
        let types: Vec<String> = self.left_out.keys().cloned().collect();
        let message = format!("all elements are of types that are no bodies ({}); expected {expected}", list(&types));
        Fault::unsupported(bytes.len(), message)
    }

    /// Reads lines up to the end of the cursor; the block in which they end.
    fn lines(&mut self, cursor: &mut Cursor) -> Result<Block, Fault> {
        let mut block = Block::Other;
        while let Some(line) = deck::next(cursor)? {
            match line {
                Line::Keyword(keyword) => block = self.open(cursor, &keyword)?,
                Line::Data { at, fields } => self.data(cursor, &block, at, &fields)?,
            }
        }
        Ok(block)
    }

    fn open(&mut self, cursor: &mut Cursor, keyword: &Keyword) -> Result<Block, Fault> {
        let internal = keyword.get("INTERNAL").is_some();
        let scope = self.scope;
        self.note_ends(&keyword.name);
        Ok(match keyword.name.as_str() {
            "NODE" => {
                if keyword.get("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) {
                    return Err(unsupported(keyword, "coordinates about an axis", "write rectangular ones"));
                }
                self.instances.set_apart(scope, self.highest);
                let set = keyword.get("NSET").map(|name| self.node_sets.open(name, keyword.at, internal, scope));
                Block::Nodes { set }
            }
            "ELEMENT" => {
                self.instances.set_apart(scope, self.highest);
                let name = keyword.require("TYPE")?.to_uppercase();
                if element::is_axisymmetric(&name) {
                    self.axisymmetric.insert(name.clone());
                }
                let open = |name| self.element_sets.open(name, keyword.at, internal, scope);
                Block::Elements { kind: element::of_name(&name), set: keyword.get("ELSET").map(open), name }
            }
            "NSET" | "ELSET" => {
                let of_nodes = keyword.name == "NSET";
                let name = keyword.require(&keyword.name)?;
                let of = keyword.get("INSTANCE").and_then(|name| self.instances.find(name)).or(scope);
                let elements = keyword.get("ELSET").filter(|_| of_nodes);
                let elements = elements.and_then(|name| self.element_sets.find(name, of, &self.instances));
                let sets = if of_nodes { &mut self.node_sets } else { &mut self.element_sets };
                let set = sets.open(name, keyword.at, internal, scope);
                if let Some(elements) = elements {
                    sets.add_nodes_of(set, elements);
                }
                Block::Set { of_nodes, set, scope: of, generate: keyword.get("GENERATE").is_some() }
            }
            "SURFACE" => self.open_surface(keyword, internal)?,
            "PART" => {
                let (from, mut to) = (cursor.at, cursor.bytes.len());
                while let Some((at, line)) = cursor.line() {
                    if deck::is_keyword(line, "ENDPART") {
                        self.note_ends("ENDPART");
                        to = at;
                        break;
                    }
                }
                self.parts.insert(keyword.get("NAME").unwrap_or_default().to_uppercase(), from..to);
                Block::Other
            }
            "INSTANCE" => self.instance(cursor, keyword)?,
            "ENDINSTANCE" | "ASSEMBLY" | "ENDASSEMBLY" => {
                self.scope = None;
                Block::Other
            }
            "INCLUDE" => return Err(unsupported(keyword, "a further file", "put its lines here")),
            "SYSTEM" => return Err(unsupported(keyword, "another system of coordinates", "export without it")),
            "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" => {
                let found = "nodes or elements by a rule";
                return Err(unsupported(keyword, found, "write them out, as Abaqus/CAE and most programs do"));
            }
            _ => Block::Other,
        })
    }

    /// Keeps what a keyword begins and must end by another one.
    fn note_ends(&mut self, name: &str) {
        if ["PART", "INSTANCE", "ASSEMBLY", "STEP"].contains(&name) {
            self.unended.push(name.to_owned());
        } else if let Some(last) = name.strip_prefix("END").and_then(|of| self.unended.iter().rposition(|n| n == of)) {
            self.unended.remove(last);
        }
    }

    /// Reads the lines of a part as those of its instance, and leaves those that the instance has itself.
    fn instance(&mut self, cursor: &mut Cursor, keyword: &Keyword) -> Result<Block, Fault> {
        let mut motion = Motion::default();
        for line in 0.. {
            let before = cursor.at;
            let Some(Line::Data { at, fields }) = deck::next(cursor)? else {
                cursor.at = before;
                break;
            };
            motion.add(line, &fields).ok_or_else(|| {
                let expected = "three numbers that move an instance, or seven that turn it";
                Fault::unexpected(at, found(&fields), expected)
            })?;
        }
        let part = keyword.get("PART").and_then(|part| self.parts.get(&part.to_uppercase())).cloned();
        let length = part.as_ref().map_or(0, Range::len);
        if !self.instances.may_read(length) {
            let found = format!("instance {} of more than {MOST_READ} bytes of parts", self.instances.list.len() + 1);
            return Err(unsupported(keyword, &found, "give fractum fewer of them"));
        }
        self.scope = Some(self.instances.open(keyword.get("NAME").unwrap_or_default(), motion, self.highest));
        if let Some(lines) = part {
            self.lines(&mut Cursor { bytes: &cursor.bytes[..lines.end], at: lines.start })?;
        }
        Ok(Block::Other)
    }

    fn open_surface(&mut self, keyword: &Keyword, internal: bool) -> Result<Block, Fault> {
        let name = keyword.require("NAME")?;
        let (at, scope) = (keyword.at, self.scope);
        let kind = keyword.get("TYPE").unwrap_or("ELEMENT").to_uppercase();
        Ok(match kind.as_str() {
            "ELEMENT" => {
                self.surfaces.push(Surface { name: name.to_owned(), scope, at, internal, faces: Vec::new() });
                Block::Surface(self.surfaces.len() - 1)
            }
            "NODE" => Block::SurfaceOfNodes(self.node_sets.open_surface(name, at, internal, scope)),
            // Analytical ones are no part of the mesh.
            _ => Block::Other,
        })
    }

    fn data(&mut self, cursor: &mut Cursor, block: &Block, at: usize, fields: &[&str]) -> Result<(), Fault> {
        match block {
            Block::Nodes { set } => self.node(*set, at, fields),
            Block::Elements { kind, name, set } => self.element(cursor, (*kind, name), *set, at, fields),
            Block::Set { of_nodes, set, scope, generate } => {
                let Deck { node_sets, element_sets, instances, .. } = self;
                let sets = if *of_nodes { node_sets } else { element_sets };
                if *generate {
                    let label = |&field: &&str| instances.label(field, *scope);
                    let step = fields.get(2).filter(|step| !step.is_empty()).map_or(Some(1), |step| step.parse().ok());
                    match (fields.first().and_then(label), fields.get(1).and_then(label), step) {
                        (Some(first), Some(last), Some(step)) => sets.add_range(*set, [first, last, step]),
                        _ => return Err(Fault::unexpected(at, found(fields), "first, last and step of a set")),
                    }
                    return Ok(());
                }
                given(fields).try_for_each(|field| sets.add_field(*set, at, field, *scope, instances))
            }
            Block::Surface(surface) => {
                let (of, face) = (fields[0], fields.get(1).copied().unwrap_or_default());
                let label = self.instances.label(of, self.scope).map(Faced::Label);
                let set = || self.element_sets.find(deck::unquoted(of), self.scope, &self.instances).map(Faced::Set);
                let Some(of) = label.or_else(set) else {
                    let expected = "an element or a set of elements that is defined above, and a face, as `part, S1`";
                    return Err(Fault::unexpected(at, found(fields), expected));
                };
                self.surfaces[*surface].faces.push((of, face.to_owned()));
                Ok(())
            }
            Block::SurfaceOfNodes(set) => self.node_sets.add_field(*set, at, fields[0], self.scope, &self.instances),
            Block::Other => Ok(()),
        }
    }

    fn node(&mut self, set: Option<usize>, at: usize, fields: &[&str]) -> Result<(), Fault> {
        let wrong = || Fault::unexpected(at, found(fields), "a node: label and up to three coordinates");
        let label = self.instances.label(fields[0], self.scope).ok_or_else(wrong)?;
        let mut position = Vec3::zeros();
        for (x, field) in position.iter_mut().zip(&fields[1..]).filter(|(_, field)| !field.is_empty()) {
            *x = field.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong)?;
        }
        self.node_blocks.push((self.nodes.len(), Records { at, stride: 0 }));
        self.node_tags.push(label);
        self.nodes.push(self.instances.placed(position, self.scope));
        self.highest = self.highest.max(label);
        if let Some(set) = set {
            self.node_sets.add(set, label);
        }
        Ok(())
    }

    fn element(
        &mut self,
        cursor: &mut Cursor,
        (kind, name): (Option<ElementType>, &str),
        set: Option<usize>,
        at: usize,
        fields: &[&str],
    ) -> Result<(), Fault> {
        let Some(kind) = kind else {
            *self.left_out.entry(name.to_owned()).or_default() += 1;
            return Ok(());
        };
        let wrong = |fields: &[&str]| {
            let expected = format!("an element of type {name}: label and {} nodes", kind.nodes);
            Fault::unexpected(at, found(fields), expected)
        };
        let mut numbers: Vec<u64> = Vec::with_capacity(kind.nodes + 1);
        let (instances, scope) = (&self.instances, self.scope);
        let take = |numbers: &mut Vec<u64>, fields: &[&str]| {
            given(fields)
                .try_for_each(|field| instances.label(field, scope).map(|number| numbers.push(number)))
                .ok_or_else(|| wrong(fields))
        };
        take(&mut numbers, fields)?;
        while numbers.len() < kind.nodes + 1 {
            let Some(Line::Data { fields: more, .. }) = deck::next(cursor)? else { return Err(wrong(fields)) };
            take(&mut numbers, &more)?;
        }
        if numbers.len() > kind.nodes + 1 {
            return Err(wrong(fields));
        }
        let (first_corner, shell) = (self.corners.len(), element::is_shell(name));
        self.elements.push(Element { tag: numbers[0], kind, first_corner, at, scope, shell });
        if kind.shape == Shape::Line {
            // The last node is the other end; those between come before it.
            numbers.swap(2, kind.nodes);
        }
        let (corners, mid_nodes) = numbers[1..].split_at(kind.shape.corners());
        self.corners.extend_from_slice(corners);
        self.mid_nodes.extend_from_slice(mid_nodes);
        self.highest = self.highest.max(numbers[0]);
        if let Some(set) = set {
            self.element_sets.add(set, numbers[0]);
        }
        Ok(())
    }
}

impl Element {
    /// Labels of its corners.
    pub(super) fn corners<'a>(&self, all: &'a [u64]) -> &'a [u64] {
        &all[self.first_corner..self.first_corner + self.kind.shape.corners()]
    }

    /// Its shape, whatever its order.
    pub(super) fn shape(&self) -> Shape {
        self.kind.shape
    }
}

/// Fields that are not empty: lines may end with a comma.
fn given<'f>(fields: &'f [&str]) -> impl Iterator<Item = &'f str> {
    fields.iter().copied().filter(|field| !field.is_empty())
}

fn found(fields: &[&str]) -> String {
    crate::tagged::cursor::quote(fields.join(", ").as_bytes())
}

fn unsupported(keyword: &Keyword, found: &str, remedy: &str) -> Fault {
    Fault::unsupported(keyword.at, format!("*{} gives {found}; {remedy}", keyword.name))
}
