//! Typed indices: a link index cannot be used where a joint index is meant.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

/// An index into one kind of table.
pub trait Idx: Copy + Eq + Ord + std::hash::Hash {
    /// The index `position` entries from the start of its table.
    fn new(position: usize) -> Self;
    /// Position in the table.
    fn index(self) -> usize;
}

macro_rules! define_idx {
    ($(#[$doc:meta])* $name:ident, $prefix:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(u32);

        impl Idx for $name {
            fn new(position: usize) -> Self {
                Self(u32::try_from(position).expect("tables hold fewer than 2^32 entries"))
            }
            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($prefix, "{}"), self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    };
}

define_idx!(
    /// A link of a robot; prints as `l3`.
    LinkIdx, "l");
define_idx!(
    /// A joint of a robot, fixed joints included; prints as `j3`.
    JointIdx, "j");
define_idx!(
    /// An independently driven joint value of a robot; prints as `d3`.
    DofIdx, "d");
define_idx!(
    /// A body of a world (not a robot link); prints as `b3`.
    BodyIdx, "b");

/// A vector addressed by a typed index.
#[derive(Clone, PartialEq)]
pub struct TypedVec<I, T> {
    items: Vec<T>,
    index: PhantomData<fn(I)>,
}

impl<I: Idx, T> TypedVec<I, T> {
    /// An empty table.
    pub fn new() -> Self {
        Self { items: Vec::new(), index: PhantomData }
    }

    /// Appends `item` and returns its index.
    pub fn push(&mut self, item: T) -> I {
        let index = I::new(self.items.len());
        self.items.push(item);
        index
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether the table holds nothing.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// All entries, in index order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.items.iter()
    }

    /// All entries, mutable, in index order.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.items.iter_mut()
    }

    /// All indices with their entries, in order.
    pub fn enumerate(&self) -> impl ExactSizeIterator<Item = (I, &T)> {
        self.items.iter().enumerate().map(|(i, t)| (I::new(i), t))
    }

    /// All indices, in order.
    pub fn indices(&self) -> impl ExactSizeIterator<Item = I> + use<I, T> {
        (0..self.items.len()).map(I::new)
    }

    /// The entry at `index`, or `None` past the end.
    pub fn get(&self, index: I) -> Option<&T> {
        self.items.get(index.index())
    }

    /// The first index whose entry satisfies `test`.
    pub fn position(&self, test: impl FnMut(&T) -> bool) -> Option<I> {
        self.items.iter().position(test).map(I::new)
    }

    /// The entries as a slice.
    pub fn as_slice(&self) -> &[T] {
        &self.items
    }
}

impl<I: Idx, T> Default for TypedVec<I, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<I: Idx, T> FromIterator<T> for TypedVec<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(iter: It) -> Self {
        Self { items: iter.into_iter().collect(), index: PhantomData }
    }
}

impl<I: Idx, T> From<Vec<T>> for TypedVec<I, T> {
    fn from(items: Vec<T>) -> Self {
        Self { items, index: PhantomData }
    }
}

impl<I: Idx, T> Index<I> for TypedVec<I, T> {
    type Output = T;
    fn index(&self, index: I) -> &T {
        &self.items[index.index()]
    }
}

impl<I: Idx, T> IndexMut<I> for TypedVec<I, T> {
    fn index_mut(&mut self, index: I) -> &mut T {
        &mut self.items[index.index()]
    }
}

impl<'a, I: Idx, T> IntoIterator for &'a TypedVec<I, T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.items.iter()
    }
}

impl<I, T: fmt::Debug> fmt::Debug for TypedVec<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&self.items).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_print_with_their_prefix() {
        assert_eq!(LinkIdx::new(3).to_string(), "l3");
        assert_eq!(format!("{:?}", DofIdx::new(0)), "d0");
    }

    #[test]
    fn typed_vec_returns_what_was_pushed() {
        let mut table: TypedVec<JointIdx, &str> = TypedVec::new();
        let a = table.push("a");
        let b = table.push("b");
        assert_eq!((table[a], table[b]), ("a", "b"));
        assert_eq!(table.position(|s| *s == "b"), Some(b));
        assert_eq!(table.get(JointIdx::new(2)), None);
    }
}
