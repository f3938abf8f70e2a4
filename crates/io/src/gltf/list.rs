//! Lists in JSON that stay in the text: the smallest object takes three bytes of a file, but may take a
//! hundred bytes of memory.
//!
//! A structure with lists is read twice. With `KEPT = false`, every element is checked and dropped. With
//! `KEPT = true`, the lists keep their text and are not checked again.

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;
use std::marker::PhantomData;

/// A list whose elements are parsed on demand.
pub(super) struct List<'a, T, const KEPT: bool> {
    text: &'a str,
    /// The offset of each element in `text`.
    offsets: Vec<u32>,
    elements: PhantomData<T>,
}

impl<'a, T: Deserialize<'a>> List<'a, T, true> {
    pub(super) fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Element `index`; `None` if it does not exist.
    pub(super) fn get(&self, index: usize) -> Option<T> {
        let rest = self.text.get(*self.offsets.get(index)? as usize..)?;
        // The element is well-formed, since the first reading has checked it.
        T::deserialize(&mut serde_json::Deserializer::from_str(rest)).ok()
    }

    /// All elements, in order.
    pub(super) fn iter(&self) -> impl Iterator<Item = T> {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

impl<T, const KEPT: bool> Default for List<'_, T, KEPT> {
    fn default() -> Self {
        Self { text: "", offsets: Vec::new(), elements: PhantomData }
    }
}

impl<'de: 'a, 'a, T: Deserialize<'de>, const KEPT: bool> Deserialize<'de> for List<'a, T, KEPT> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !KEPT {
            for_each(deserializer, |_: T| ())?;
            return Ok(Self::default());
        }
        let text = <&RawValue>::deserialize(deserializer)?.get();
        let offsets = offsets(text).map_err(D::Error::custom)?;
        Ok(Self { text, offsets, elements: PhantomData })
    }
}

/// The offset of each element of the list `text`. The elements are counted first, since a growing vector takes
/// more memory.
fn offsets(text: &str) -> Result<Vec<u32>, serde_json::Error> {
    let mut count = 0;
    for_each(&mut serde_json::Deserializer::from_str(text), |_: IgnoredAny| count += 1)?;
    let mut offsets = Vec::with_capacity(count);
    for_each(&mut serde_json::Deserializer::from_str(text), |element: &RawValue| {
        offsets.push((element.get().as_ptr().addr() - text.as_ptr().addr()) as u32);
    })?;
    Ok(offsets)
}

/// An iterator over a list of indices, which are parsed on demand.
#[derive(Clone, Default)]
pub(super) struct Indices<'a, const KEPT: bool> {
    /// The text from the next index on.
    text: &'a str,
}

impl<'a> Indices<'a, true> {
    /// All indices in `text`.
    fn of(text: &'a str) -> Self {
        Self { text: text.trim_start_matches(|c: char| !c.is_ascii_digit()) }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.text.is_empty()
    }
}

impl Iterator for Indices<'_, true> {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        let end = self.text.find(|c: char| !c.is_ascii_digit()).unwrap_or(self.text.len());
        let (index, rest) = self.text.split_at(end);
        *self = Self::of(rest);
        index.parse().ok()
    }
}

impl<'de: 'a, 'a, const KEPT: bool> Deserialize<'de> for Indices<'a, KEPT> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !KEPT {
            for_each(deserializer, |_: u32| ())?;
            return Ok(Self::default());
        }
        let text = <&RawValue>::deserialize(deserializer)?.get();
        Ok(Self { text: Indices::of(text).text })
    }
}

/// The number of elements of a list.
#[derive(Default)]
pub(super) struct Count<T> {
    pub(super) count: usize,
    elements: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Count<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut count = 0;
        for_each(deserializer, |_: T| count += 1)?;
        Ok(Self { count, elements: PhantomData })
    }
}

/// Calls `visit` for each element of a list.
fn for_each<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
    visit: impl FnMut(T),
) -> Result<(), D::Error> {
    deserializer.deserialize_seq(ForEach(visit, PhantomData))
}

struct ForEach<F, T>(F, PhantomData<T>);

impl<'de, T: Deserialize<'de>, F: FnMut(T)> Visitor<'de> for ForEach<F, T> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut elements: A) -> Result<(), A::Error> {
        while let Some(element) = elements.next_element()? {
            (self.0)(element);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_read_where_they_stand() {
        let text = r#" [ "a" ,"b,]", "\"[" , "" ]"#;
        let list: List<'_, String, true> = serde_json::from_str(text).unwrap();
        assert_eq!(list.iter().collect::<Vec<_>>(), ["a", "b,]", "\"[", ""]);
        assert_eq!((list.len(), list.offsets.capacity(), list.get(4)), (4, 4, None));
    }

    #[test]
    fn indices_are_read_to_the_last() {
        for (text, expected) in
            [("[]", vec![]), (" [ 7 ] ", vec![7]), ("[0,\n4294967295 , 1]", vec![0, u32::MAX, 1])]
        {
            let mut indices: Indices<'_, true> = serde_json::from_str(text).unwrap();
            assert_eq!(indices.clone().collect::<Vec<_>>(), expected);
            indices.by_ref().take(expected.len()).for_each(drop);
            assert!(indices.is_empty(), "{text}");
        }
    }

    #[test]
    fn what_is_not_kept_is_checked_as_a_vector_would_be() {
        for text in ["[1, 2, -1]", "[1 2]", "[1, 2.0]", "[\n\"a\"]", "{}", "null", "[4294967296]", "[0"] {
            let of_vector = serde_json::from_str::<Vec<u32>>(text).err().unwrap().to_string();
            let of_list = serde_json::from_str::<List<'_, u32, false>>(text).err().unwrap().to_string();
            let of_indices = serde_json::from_str::<Indices<'_, false>>(text).err().unwrap().to_string();
            let of_count = serde_json::from_str::<Count<u32>>(text).err().unwrap().to_string();
            assert_eq!([&of_list, &of_indices, &of_count], [&of_vector; 3], "{text}");
        }
    }
}
