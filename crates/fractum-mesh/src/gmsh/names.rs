use crate::tagged::cursor::{Cursor, What, quote};
use crate::tagged::error::Fault;
use crate::tagged::raw::PhysicalName;

/// Reads `$PhysicalNames` up to and with its end: text in every version, even of binary files.
pub(super) fn read(cursor: &mut Cursor) -> Result<Vec<PhysicalName>, Fault> {
    let mut record = cursor.record(What::one("the number of physical names"))?;
    let count = record.unsigned("the count")?;
    record.end()?;
    let mut names: Vec<PhysicalName> = Vec::with_capacity(cursor.capacity(count, 6));
    for index in 0..count {
        let what = What { noun: "physical name", index: index as usize, count: count as usize };
        names.push(read_name(cursor, what)?);
    }
    cursor.end_section("PhysicalNames")?;
    Ok(names)
}

fn read_name(cursor: &mut Cursor, what: What) -> Result<PhysicalName, Fault> {
    let mut record = cursor.record(what)?;
    let at = record.at();
    let dimension = record.unsigned("the dimension")?;
    if record.rest().trim_ascii().starts_with(b"\"") {
        let message = "found a physical name without a dimension (MSH 2.0); convert with: \
                       gmsh in.msh -save -format msh41 -o out.msh";
        return Err(Fault::unsupported(at, message));
    }
    let tag = record.integer32("the tag")?;
    if dimension > 3 {
        return Err(Fault::unexpected(at, format!("dimension {dimension}"), format!("0 to 3 in {what}")));
    }
    let (start, quoted) = (record.at(), record.rest().trim_ascii());
    let [b'"', name @ .., b'"'] = quoted else {
        return Err(Fault::unexpected(start, quote(quoted), format!("a name in double quotes in {what}")));
    };
    let Ok(name) = std::str::from_utf8(name) else {
        return Err(Fault::unexpected(start, quote(quoted), format!("a name in UTF-8 in {what}; save the file so")));
    };
    Ok(PhysicalName { dimension: dimension as u8, tag, name: name.to_owned(), at })
}
