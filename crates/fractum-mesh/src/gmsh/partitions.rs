//! Into how many parts a mesh was cut.

/// Parts into which Gmsh has cut the mesh of which a file holds one or all; none where the file says nothing of it.
pub fn partitions(bytes: &[u8]) -> Option<usize> {
    let section = |name: &[u8]| {
        let at = bytes.windows(name.len()).position(|window| window == name)? + name.len();
        Some(&bytes[at..])
    };
    let format = section(b"$MeshFormat\n")?;
    let is_binary = format.split(|byte| *byte == b' ').nth(1)? == b"1";
    let count = section(b"$PartitionedEntities\n")?;
    if is_binary {
        return Some(u64::from_le_bytes(*count.first_chunk()?) as usize);
    }
    let digits = count.split(|byte| !byte.is_ascii_digit()).next()?;
    std::str::from_utf8(digits).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_stands_before_all_parts() {
        let text = b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n3\n0\n";
        assert_eq!(partitions(text), Some(3));
        let binary =
            [&b"$MeshFormat\n4.1 1 8\n....$EndMeshFormat\n$PartitionedEntities\n"[..], &12u64.to_le_bytes()].concat();
        assert_eq!(partitions(&binary), Some(12));
        assert_eq!(partitions(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n"), None);
        assert_eq!(partitions(b"$PartitionedEntities\n3\n"), None);
        assert_eq!(partitions(&binary[..binary.len() - 3]), None);
    }
}
