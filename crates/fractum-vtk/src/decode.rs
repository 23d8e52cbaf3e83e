//! What the tests of the writers look at, as the reader of files of any program finds it.

use super::file::{Array, Document};

pub(super) struct Decoded<'a>(Document<'a>);

pub(super) fn decode(file: &[u8]) -> Decoded<'_> {
    assert!(file.ends_with(b"\n  </AppendedData>\n</VTKFile>\n"));
    Decoded(Document::read(file, &["UnstructuredGrid", "PolyData"]).unwrap())
}

impl Decoded<'_> {
    pub(super) fn sizes(&self) -> [usize; 2] {
        [self.0.points, self.0.cells]
    }

    fn array(&self, name: &str) -> &Array {
        self.0.arrays.iter().find(|array| array.name == name).unwrap_or_else(|| panic!("no {name}"))
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.0.arrays.iter().any(|array| array.name == name)
    }

    pub(super) fn bytes(&self, name: &str) -> Vec<u8> {
        self.0.bytes(self.array(name)).unwrap()
    }

    pub(super) fn components(&self, name: &str) -> usize {
        self.array(name).components
    }

    pub(super) fn f64(&self, name: &str) -> Vec<f64> {
        self.bytes(name).chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().unwrap())).collect()
    }

    pub(super) fn i32(&self, name: &str) -> Vec<i32> {
        self.bytes(name).chunks_exact(4).map(|bytes| i32::from_ne_bytes(bytes.try_into().unwrap())).collect()
    }
}
