//! Temporary stub.
#![allow(missing_docs)]
use fractum_math::Vec3;
pub struct Edges<const M: usize> { pub nodes: Vec<[u32; 2]>, pub of_element: Vec<[u32; M]> }
fn edges<const N: usize, const M: usize>(elements: &[[u32; N]], local: [[usize; 2]; M]) -> Edges<M> {
    let key = |e: &[u32; N], l: [usize; 2]| { let (a, b) = (e[l[0]], e[l[1]]); [a.min(b), a.max(b)] };
    let mut nodes: Vec<[u32; 2]> = elements.iter().flat_map(|e| local.map(|l| key(e, l))).collect();
    nodes.sort_unstable(); nodes.dedup();
    let of_element = elements.iter().map(|e| local.map(|l| nodes.binary_search(&key(e, l)).unwrap() as u32)).collect();
    Edges { nodes, of_element }
}
pub fn edges_of_tetrahedra(e: &[[u32; 4]]) -> Edges<6> { edges(e, [[0,1],[0,2],[0,3],[1,2],[1,3],[2,3]]) }
pub fn edges_of_triangles(e: &[[u32; 3]]) -> Edges<3> { edges(e, [[0,1],[1,2],[0,2]]) }
pub fn hilbert_order(p: &[Vec3]) -> Vec<u32> {
    let mut lo = p[0]; let mut hi = p[0];
    for x in p { lo = lo.inf(x); hi = hi.sup(x); }
    let s = (hi - lo).max().max(1e-300);
    let key = |x: &Vec3| -> u64 { let q = (x - lo) * (1023.0 / s); let mut k = 0u64; for b in (0..10).rev() { for a in 0..3 { k = k << 1 | ((q[a] as u64) >> b & 1); } } k };
    let mut o: Vec<u32> = (0..p.len() as u32).collect();
    let keys: Vec<u64> = p.iter().map(key).collect();
    o.sort_by_key(|&i| (keys[i as usize], i)); o
}
