//! One block of binary data that a table of contents points into.

use serde::Serialize;

/// Where an array lies in a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) struct Span {
    /// Bytes from the start of the block; a multiple of four.
    pub(super) offset: usize,
    /// Number of components.
    pub(super) count: usize,
}

/// Little-endian arrays one after another, each aligned to four bytes.
#[derive(Debug, Default)]
pub(super) struct Block {
    bytes: Vec<u8>,
}

impl Block {
    /// Appends components of `SIZE` bytes each.
    pub(super) fn put<const SIZE: usize>(
        &mut self,
        components: impl IntoIterator<Item = [u8; SIZE]>,
    ) -> Span {
        let offset = self.bytes.len();
        components.into_iter().for_each(|c| self.bytes.extend_from_slice(&c));
        let count = (self.bytes.len() - offset) / SIZE;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        Span { offset, count }
    }

    /// Appends single-precision numbers.
    pub(super) fn put_f32(&mut self, numbers: impl IntoIterator<Item = f32>) -> Span {
        self.put(numbers.into_iter().map(f32::to_le_bytes))
    }

    /// The bytes so far; their number is a multiple of four.
    pub(super) fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_aligned() {
        let mut block = Block::default();
        assert_eq!(block.put([[1u8, 2], [3, 4], [5, 6]]), Span { offset: 0, count: 3 });
        assert_eq!(block.put_f32([1.0]), Span { offset: 8, count: 1 });
        assert_eq!(block.as_bytes(), [1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 128, 63]);
    }
}
