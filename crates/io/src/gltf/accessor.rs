//! Typed reading of buffers. Everything is checked when an accessor is opened, and nothing is
//! copied: what is read later lies within its buffer.

use super::document::Document;
use super::json::{Accessor, Shape};
use crate::loading::Loading;
use crate::{IoError, Location, Place};
use glam::Vec3;
use std::borrow::Cow;

/// Elements of one size at even distances.
#[derive(Clone, Copy)]
struct Slots<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Slots<'a> {
    fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}

/// How an index is stored.
#[derive(Clone, Copy)]
enum IndexType {
    U8,
    U16,
    U32,
}

impl IndexType {
    fn of(component_type: u32) -> Option<Self> {
        match component_type {
            5121 => Some(Self::U8),
            5123 => Some(Self::U16),
            5125 => Some(Self::U32),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 => 4,
        }
    }

    fn read(self, bytes: &[u8]) -> u32 {
        match self {
            Self::U8 => bytes[0].into(),
            Self::U16 => u16::from_le_bytes([bytes[0], bytes[1]]).into(),
            Self::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// The elements of an accessor; those that no buffer has are zero.
struct Elements<'a> {
    dense: Option<Slots<'a>>,
    sparse: Option<Sparse<'a>>,
    count: u64,
}

/// Replacements for single elements, in the order of the elements' indices.
struct Sparse<'a> {
    indices: Slots<'a>,
    index_type: IndexType,
    values: Slots<'a>,
    count: usize,
}

impl<'a> Elements<'a> {
    /// Element `index`, which must be below `count`; `None` for zero.
    fn get(&self, index: u64) -> Option<&'a [u8]> {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.get(index));
        replaced.or_else(|| self.dense.map(|slots| slots.get(index as usize)))
    }
}

impl<'a> Sparse<'a> {
    fn index(&self, position: usize) -> u64 {
        self.index_type.read(self.indices.get(position)).into()
    }

    fn get(&self, index: u64) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.index(middle) < index { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.index(low) == index).then(|| self.values.get(low))
    }
}

/// The positions of a primitive's vertices.
pub(super) struct Positions<'a>(Elements<'a>);

impl Positions<'_> {
    pub(super) fn count(&self) -> u64 {
        self.0.count
    }

    /// Position `index`, which must be below `count`.
    pub(super) fn get(&self, index: u64) -> Vec3 {
        self.0.get(index).map_or(Vec3::ZERO, |bytes| {
            let (components, _) = bytes.as_chunks::<4>();
            let [x, y, z] = [0, 1, 2].map(|i| f32::from_le_bytes(components[i]));
            Vec3::new(x, y, z)
        })
    }
}

/// The vertices that a primitive's triangles refer to.
pub(super) struct Indices<'a> {
    elements: Elements<'a>,
    kind: IndexType,
}

impl Indices<'_> {
    pub(super) fn count(&self) -> u64 {
        self.elements.count
    }

    /// Index number `position`, which must be below `count`.
    pub(super) fn get(&self, position: u64) -> u64 {
        self.elements.get(position).map_or(0, |bytes| self.kind.read(bytes).into())
    }
}

/// Opens accessors.
pub(super) struct Reader<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) buffers: &'a [Cow<'a, [u8]>],
}

impl<'a> Reader<'a> {
    pub(super) fn positions(&self, index: u32, loading: &Loading<'_>) -> Result<Positions<'a>, IoError> {
        let (accessor, at) = self.accessor(index, loading)?;
        if (accessor.shape, accessor.component_type) != (Shape::Vec3, 5126) {
            return Err(wrong(at, "positions must be VEC3 of floats"));
        }
        Ok(Positions(self.elements(accessor, 12, &at, loading)?))
    }

    pub(super) fn indices(&self, index: u32, loading: &Loading<'_>) -> Result<Indices<'a>, IoError> {
        let (accessor, at) = self.accessor(index, loading)?;
        match IndexType::of(accessor.component_type).filter(|_| accessor.shape == Shape::Scalar) {
            Some(kind) => Ok(Indices { elements: self.elements(accessor, kind.size(), &at, loading)?, kind }),
            None => Err(wrong(at, "indices must be SCALAR of unsigned integers")),
        }
    }

    fn accessor(&self, index: u32, loading: &Loading<'_>) -> Result<(&'a Accessor, Location), IoError> {
        let at = loading.at(Place::Accessor(index as usize));
        let all = &self.document.accessors;
        match all.get(index as usize) {
            Some(accessor) => Ok((accessor, at)),
            None => Err(wrong(at, &format!("does not exist, there are {}", all.len()))),
        }
    }

    fn elements(
        &self,
        accessor: &Accessor,
        size: usize,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<Elements<'a>, IoError> {
        let view = |index| self.view(index, at, loading);
        let count = accessor.count;
        let limit = loading.limits.json_values;
        if accessor.buffer_view.is_none() && count > limit {
            let what = "elements without a buffer view";
            return Err(IoError::TooLarge { at: at.clone(), what, limit });
        }
        let dense = accessor.buffer_view.map(view).transpose()?;
        let dense = dense
            .map(|(bytes, stride)| slots(bytes, stride, accessor.byte_offset, size, count, at))
            .transpose()?;
        let Some(sparse) = accessor.sparse.as_deref() else {
            return Ok(Elements { dense, sparse: None, count });
        };
        let index_type = IndexType::of(sparse.indices.component_type)
            .ok_or_else(|| wrong(at.clone(), "sparse indices must be unsigned integers"))?;
        let (bytes, _) = view(sparse.indices.buffer_view)?;
        let indices = slots(bytes, None, sparse.indices.byte_offset, index_type.size(), sparse.count, at)?;
        let (bytes, _) = view(sparse.values.buffer_view)?;
        let values = slots(bytes, None, sparse.values.byte_offset, size, sparse.count, at)?;
        let sparse = Sparse { indices, index_type, values, count: sparse.count as usize };
        check_order(&sparse, count, at)?;
        Ok(Elements { dense, sparse: Some(sparse), count })
    }

    /// The bytes of a buffer view and their stride, if it declares one.
    fn view(
        &self,
        index: u32,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<(&'a [u8], Option<u64>), IoError> {
        let views = &self.document.buffer_views;
        let view = views.get(index as usize);
        let view = view.ok_or_else(|| wrong(at.clone(), &format!("bufferViews[{index}] does not exist")))?;
        let at = loading.at(Place::BufferView(index as usize));
        let buffer = self.buffers.get(view.buffer as usize);
        let buffer =
            buffer.ok_or_else(|| wrong(at.clone(), &format!("buffers[{}] does not exist", view.buffer)))?;
        let end = view.byte_offset.checked_add(view.byte_length).filter(|end| *end <= buffer.len() as u64);
        let end = end.ok_or_else(|| wrong(at, "reaches beyond its buffer"))?;
        Ok((&buffer[view.byte_offset as usize..end as usize], view.byte_stride))
    }
}

/// `count` elements of `size` bytes from `offset` on, or an error if `bytes` has not that many.
fn slots<'a>(
    bytes: &'a [u8],
    stride: Option<u64>,
    offset: u64,
    size: usize,
    count: u64,
    at: &Location,
) -> Result<Slots<'a>, IoError> {
    let stride = stride.unwrap_or(size as u64);
    if stride < size as u64 {
        return Err(wrong(
            at.clone(),
            &format!("a stride of {stride} is less than an element of {size} bytes"),
        ));
    }
    let length = count.saturating_sub(1).checked_mul(stride).and_then(|length| {
        let last = if count > 0 { size as u64 } else { 0 };
        length.checked_add(last)?.checked_add(offset)
    });
    match length {
        Some(length) if length <= bytes.len() as u64 => {
            Ok(Slots { bytes: &bytes[offset as usize..], stride: stride as usize, size })
        }
        _ => Err(wrong(at.clone(), &format!("{count} elements reach beyond the buffer view"))),
    }
}

/// Sparse indices must rise, and stay within the accessor: then each can be found by halving.
fn check_order(sparse: &Sparse<'_>, count: u64, at: &Location) -> Result<(), IoError> {
    let mut least = 0;
    for position in 0..sparse.count {
        let index = sparse.index(position);
        if index < least {
            return Err(wrong(at.clone(), "sparse indices do not rise"));
        }
        if index >= count {
            return Err(wrong(at.clone(), &format!("sparse index {index} is beyond its {count} elements")));
        }
        least = index + 1;
    }
    Ok(())
}

fn wrong(at: Location, message: &str) -> IoError {
    IoError::Accessor { at, message: message.into() }
}
