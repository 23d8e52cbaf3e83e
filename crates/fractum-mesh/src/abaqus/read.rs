//! From keywords to what they define.

use std::collections::BTreeMap;

use fractum_math::Vec3;

use super::deck::{self, Keyword, Line};
use super::element;
use super::sets::{Sets, label};
use crate::tagged::cursor::Cursor;
use crate::tagged::element_type::{ElementType, Shape};
use crate::tagged::error::{Fault, Problem};
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
    parts: usize,
    instances: usize,
    /// Whether the lines are those of the assembly.
    in_assembly: bool,
}

pub(super) struct Element {
    pub(super) tag: u64,
    pub(super) kind: ElementType,
    /// Index of its first corner.
    pub(super) first_corner: usize,
    pub(super) at: usize,
}

/// A surface of element faces.
pub(super) struct Surface {
    pub(super) name: String,
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
    Nodes { set: Option<usize> },
    Elements { kind: Option<ElementType>, name: String, set: Option<usize> },
    Set { of_nodes: bool, set: usize, generate: bool },
    Surface(usize),
    SurfaceOfNodes(usize),
    Instance,
    Other,
}

impl Deck {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut cursor = Cursor::new(bytes);
        cursor.skip_byte_order_mark();
        let mut deck = Deck::default();
        let mut block = Block::Other;
        while let Some(line) = deck::next(&mut cursor)? {
            match line {
                Line::Keyword(keyword) => block = deck.open(&keyword)?,
                Line::Data { at, fields } => deck.data(&mut cursor, &block, at, &fields)?,
            }
        }
        if deck.elements.is_empty() {
            let expected = "at least one *ELEMENT of tetrahedra or triangles";
            return Err(Fault { at: bytes.len(), problem: Problem::Truncated { expected: expected.to_owned() } });
        }
        Ok(deck)
    }

    fn open(&mut self, keyword: &Keyword) -> Result<Block, Fault> {
        let internal = keyword.get("INTERNAL").is_some();
        Ok(match keyword.name.as_str() {
            "NODE" if self.in_assembly => {
                let found = "nodes of the assembly, such as reference points";
                return Err(unsupported(keyword, found, "export one flat file without parts"));
            }
            "NODE" => {
                if keyword.get("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) {
                    return Err(unsupported(keyword, "coordinates about an axis", "write rectangular ones"));
                }
                let set =
                    keyword.get("NSET").map(|name| self.node_sets.open(name, keyword.at, internal, self.in_assembly));
                Block::Nodes { set: set.transpose()? }
            }
            "ELEMENT" => {
                let name = keyword.require("TYPE")?.to_uppercase();
                let kind = element::of_name(&name);
                if let Some(kind) = kind.filter(|kind| kind.shape.corners() == 0) {
                    let found = format!("elements of type {name}, which are {}", kind.shape.plural());
                    return Err(unsupported(keyword, &found, "mesh with tetrahedra (C3D4, C3D10)"));
                }
                let open = |name| self.element_sets.open(name, keyword.at, internal, self.in_assembly);
                Block::Elements { kind, name, set: keyword.get("ELSET").map(open).transpose()? }
            }
            "NSET" | "ELSET" => {
                let of_nodes = keyword.name == "NSET";
                let name = keyword.require(&keyword.name)?;
                let sets = if of_nodes { &mut self.node_sets } else { &mut self.element_sets };
                let generate = keyword.get("GENERATE").is_some();
                Block::Set { of_nodes, set: sets.open(name, keyword.at, internal, self.in_assembly)?, generate }
            }
            "SURFACE" => self.open_surface(keyword, internal)?,
            "PART" => {
                self.parts += 1;
                if self.parts > 1 {
                    return Err(unsupported(
                        keyword,
                        "a second part",
                        "export one part, or one flat file without parts",
                    ));
                }
                Block::Other
            }
            "INSTANCE" => {
                self.instances += 1;
                if self.instances > 1 {
                    return Err(unsupported(keyword, "a second instance", "export one flat file without parts"));
                }
                // The lines of an independent instance are those of its part.
                self.in_assembly = false;
                Block::Instance
            }
            "ASSEMBLY" | "ENDINSTANCE" | "ENDASSEMBLY" => {
                self.in_assembly = keyword.name != "ENDASSEMBLY";
                Block::Other
            }
            "INCLUDE" => return Err(unsupported(keyword, "a further file", "put its lines here")),
            "SYSTEM" => return Err(unsupported(keyword, "another system of coordinates", "export without it")),
            _ => Block::Other,
        })
    }

    fn open_surface(&mut self, keyword: &Keyword, internal: bool) -> Result<Block, Fault> {
        let name = keyword.require("NAME")?;
        let kind = keyword.get("TYPE").unwrap_or("ELEMENT").to_uppercase();
        Ok(match kind.as_str() {
            "ELEMENT" => {
                self.surfaces.push(Surface { name: name.to_owned(), at: keyword.at, internal, faces: Vec::new() });
                Block::Surface(self.surfaces.len() - 1)
            }
            "NODE" => Block::SurfaceOfNodes(self.node_sets.open(name, keyword.at, internal, self.in_assembly)?),
            // Analytical ones are no part of the mesh.
            _ => Block::Other,
        })
    }

    fn data(&mut self, cursor: &mut Cursor, block: &Block, at: usize, fields: &[&str]) -> Result<(), Fault> {
        match block {
            Block::Nodes { set } => self.node(*set, at, fields),
            Block::Elements { kind, name, set } => self.element(cursor, (*kind, name), *set, at, fields),
            Block::Set { of_nodes, set, generate } => {
                let sets = if *of_nodes { &mut self.node_sets } else { &mut self.element_sets };
                if *generate {
                    let numbers: Vec<Option<u64>> = given(fields).map(label).collect();
                    match numbers[..] {
                        [Some(first), Some(last)] => sets.add_range(*set, [first, last, 1]),
                        [Some(first), Some(last), Some(step)] => sets.add_range(*set, [first, last, step]),
                        _ => return Err(Fault::unexpected(at, found(fields), "first, last and step of a set")),
                    }
                    return Ok(());
                }
                given(fields).try_for_each(|field| sets.add_field(*set, at, field))
            }
            Block::Surface(surface) => {
                let (of, face) = (fields[0], fields.get(1).copied().unwrap_or_default());
                let set = || self.element_sets.find(deck::unquoted(of)).map(Faced::Set);
                let Some(of) = label(of).map(Faced::Label).or_else(set) else {
                    let expected = "an element or a set of elements that is defined above, and a face, as `part, S1`";
                    return Err(Fault::unexpected(at, found(fields), expected));
                };
                self.surfaces[*surface].faces.push((of, face.to_owned()));
                Ok(())
            }
            Block::SurfaceOfNodes(set) => self.node_sets.add_field(*set, at, fields[0]),
            Block::Instance => {
                let found = format!("`{}`, by which an instance is moved or turned", fields.join(", "));
                Err(Fault::unexpected(at, found, "an instance as its part lies"))
            }
            Block::Other => Ok(()),
        }
    }

    fn node(&mut self, set: Option<usize>, at: usize, fields: &[&str]) -> Result<(), Fault> {
        let wrong = || Fault::unexpected(at, found(fields), "a node: label and up to three coordinates");
        let label = label(fields[0]).ok_or_else(wrong)?;
        let mut position = Vec3::zeros();
        for (x, field) in position.iter_mut().zip(&fields[1..]).filter(|(_, field)| !field.is_empty()) {
            *x = field.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong)?;
        }
        self.node_blocks.push((self.nodes.len(), Records { at, stride: 0 }));
        self.node_tags.push(label);
        self.nodes.push(position);
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
        let take = |numbers: &mut Vec<u64>, fields: &[&str]| {
            given(fields)
                .try_for_each(|field| field.parse().map(|number| numbers.push(number)))
                .map_err(|_| wrong(fields))
        };
        take(&mut numbers, fields)?;
        while numbers.len() < kind.nodes + 1 {
            let Some(Line::Data { fields: more, .. }) = deck::next(cursor)? else { return Err(wrong(fields)) };
            take(&mut numbers, &more)?;
        }
        if numbers.len() > kind.nodes + 1 {
            return Err(wrong(fields));
        }
        self.elements.push(Element { tag: numbers[0], kind, first_corner: self.corners.len(), at });
        self.corners.extend_from_slice(&numbers[1..=kind.shape.corners()]);
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
