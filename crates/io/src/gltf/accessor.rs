//! Typed access to buffers. Opening an accessor checks all its bounds and copies nothing, so that later
//! access stays within the buffer. Each accessor is opened once and takes less memory than its JSON.

use super::buffer::Buffers;
use super::document::Document;
use super::json::{self, Shape};
use crate::error::Result;
use crate::limits::check_count;
use crate::loading::Loading;
use crate::{IoError, Location, Place};
use glam::Vec3;

/// Elements at a constant stride.
#[derive(Clone, Copy)]
struct Slots<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Slots<'a> {
    /// Element `index`, of `size` bytes.
    fn get(&self, index: usize, size: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..size]
    }
}

/// The type of a stored index, with its size in bytes.
#[derive(Clone, Copy)]
enum IndexType {
    U8 = 1,
    U16 = 2,
    U32 = 4,
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
        self as usize
    }

    fn read(self, bytes: &[u8]) -> u32 {
        match self {
            Self::U8 => bytes[0].into(),
            Self::U16 => u16::from_le_bytes([bytes[0], bytes[1]]).into(),
            Self::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// The elements of an accessor.
#[derive(Clone, Copy)]
enum Kind {
    Position,
    Index(IndexType),
}

impl Kind {
    /// `None` for elements that a scene does not need.
    fn of(shape: Shape, component_type: u32) -> Option<Self> {
        match (shape, component_type) {
            (Shape::Vec3, 5126) => Some(Self::Position),
            (Shape::Scalar, _) => IndexType::of(component_type).map(Self::Index),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::Position => 12,
            Self::Index(index_type) => index_type.size(),
        }
    }
}

/// The use of an accessor.
#[derive(Clone, Copy)]
pub(super) enum Use {
    Positions,
    Indices,
}

impl Use {
    /// The kind if it fits this use, or a message that says which kind does.
    fn check(self, kind: Option<Kind>) -> Result<Kind, &'static str> {
        match (self, kind) {
            (Self::Positions, Some(kind @ Kind::Position)) => Ok(kind),
            (Self::Indices, Some(kind @ Kind::Index(_))) => Ok(kind),
            (Self::Positions, _) => Err("positions must be VEC3 of floats"),
            (Self::Indices, _) => Err("indices must be SCALAR of unsigned integers"),
        }
    }
}

/// An open accessor. Elements without data in a buffer are zero.
pub(super) struct Accessor<'a> {
    dense: Option<Slots<'a>>,
    /// Boxed, since few accessors have it.
    sparse: Option<Box<Sparse<'a>>>,
    count: u64,
    kind: Kind,
}

/// Replacements for single elements, sorted by index.
struct Sparse<'a> {
    indices: Slots<'a>,
    index_type: IndexType,
    values: Slots<'a>,
    count: usize,
}

impl<'a> Accessor<'a> {
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Position `index`, which must be below `count`.
    pub(super) fn position(&self, index: u64) -> Vec3 {
        self.get(index, 12).map_or(Vec3::ZERO, |bytes| {
            let (components, _) = bytes.as_chunks::<4>();
            let [x, y, z] = [0, 1, 2].map(|i| f32::from_le_bytes(components[i]));
            Vec3::new(x, y, z)
        })
    }

    /// The index at `position`, which must be below `count`; zero if the elements are not indices.
    pub(super) fn index(&self, position: u64) -> u64 {
        let Kind::Index(index_type) = self.kind else { return 0 };
        self.get(position, index_type.size()).map_or(0, |bytes| index_type.read(bytes).into())
    }

    /// Element `index` of `size` bytes; `None` if it is zero.
    fn get(&self, index: u64, size: usize) -> Option<&'a [u8]> {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.get(index, size));
        replaced.or_else(|| self.dense.map(|slots| slots.get(index as usize, size)))
    }
}

impl<'a> Sparse<'a> {
    fn index(&self, position: usize) -> u64 {
        self.index_type.read(self.indices.get(position, self.index_type.size())).into()
    }

    fn get(&self, index: u64, size: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.index(middle) < index { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.index(low) == index).then(|| self.values.get(low, size))
    }
}

/// All accessors. Each is opened on first use.
pub(super) struct Accessors<'a> {
    document: &'a Document<'a>,
    buffers: &'a Buffers<'a>,
    /// Read once, since many accessors may share a view.
    views: Vec<json::BufferView>,
    opened: Vec<Option<Accessor<'a>>>,
    /// The number of sparse elements of all open accessors.
    sparse_elements: u64,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(document: &'a Document<'a>, buffers: &'a Buffers<'a>) -> Self {
        let mut views = Vec::with_capacity(document.buffer_views.len());
        views.extend(document.buffer_views.iter());
        let opened = (0..document.accessors.len()).map(|_| None).collect();
        Self { document, buffers, views, opened, sparse_elements: 0 }
    }

    /// Accessor `index`, if it is open.
    pub(super) fn get(&self, index: u32) -> Option<&Accessor<'a>> {
        self.opened.get(index as usize)?.as_ref()
    }

    /// Opens accessor `index` for this use, unless it is open.
    pub(super) fn open(&mut self, index: u32, used_as: Use, loading: &Loading<'_>) -> Result<()> {
        let at = loading.at(Place::Accessor(index as usize));
        match self.opened.get(index as usize) {
            Some(Some(opened)) => {
                used_as.check(Some(opened.kind)).map_err(|rule| wrong(&at, rule))?;
            }
            Some(None) => self.opened[index as usize] = Some(self.read(index, used_as, &at, loading)?),
            None => return Err(wrong(&at, &format!("does not exist (accessors: {})", self.opened.len()))),
        }
        Ok(())
    }

    /// Reads accessor `index`, which must exist, and checks its bounds.
    fn read(
        &mut self,
        index: u32,
        used_as: Use,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<Accessor<'a>> {
        let json = self.document.accessors.get(index as usize);
        let kind = json.as_ref().and_then(|json| Kind::of(json.shape, json.component_type));
        let kind = used_as.check(kind).map_err(|rule| wrong(at, rule))?;
        let json = json.ok_or_else(|| wrong(at, "does not exist"))?;
        let (count, size) = (json.count, kind.size());
        let dense = json.buffer_view.map(|view| self.view(view, at, loading)).transpose()?;
        let dense = dense.map(|view| view.slots(json.byte_offset, size, count, at)).transpose()?;
        if dense.is_none() {
            let limit = loading.limits.json_values;
            check_count(count, limit, "elements without a buffer view", || at.clone())?;
        }
        let sparse = json.sparse.map(|json| self.sparse(&json, size, count, at, loading)).transpose()?;
        Ok(Accessor { dense, sparse: sparse.map(Box::new), count, kind })
    }

    /// Replacements for some of `count` elements of `size` bytes.
    fn sparse(
        &mut self,
        json: &json::Sparse,
        size: usize,
        count: u64,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<Sparse<'a>> {
        let index_type = IndexType::of(json.indices.component_type)
            .ok_or_else(|| wrong(at, "sparse indices must be unsigned integers"))?;
        let packed = |view| Ok(View { stride: None, ..self.view(view, at, loading)? });
        let view: View<'a> = packed(json.indices.buffer_view)?;
        let indices = view.slots(json.indices.byte_offset, index_type.size(), json.count, at)?;
        let values = packed(json.values.buffer_view)?.slots(json.values.byte_offset, size, json.count, at)?;
        let sparse = Sparse { indices, index_type, values, count: json.count as usize };
        // Accessors may share their sparse elements, but each checks all of them.
        self.sparse_elements = self.sparse_elements.saturating_add(json.count);
        let limit = loading.jail.bytes_read();
        check_count(self.sparse_elements, limit, "elements of sparse accessors", || at.clone())?;
        check_order(&sparse, count, at)?;
        Ok(sparse)
    }

    /// Buffer view `index`.
    fn view(&self, index: u32, at: &Location, loading: &Loading<'_>) -> Result<View<'a>> {
        let missing = |at: &Location, what, index| wrong(at, &format!("{what}[{index}] does not exist"));
        let view = self.views.get(index as usize).ok_or_else(|| missing(at, "bufferViews", index))?;
        let at = &loading.at(Place::BufferView(index as usize));
        let buffer = self.buffers.get(view.buffer).ok_or_else(|| missing(at, "buffers", view.buffer))?;
        let end = view.byte_offset.checked_add(view.byte_length).filter(|end| *end <= buffer.len() as u64);
        let end = end.ok_or_else(|| wrong(at, "buffer view exceeds its buffer"))?;
        Ok(View { bytes: &buffer[view.byte_offset as usize..end as usize], stride: view.byte_stride })
    }
}

/// The bytes of a buffer view and their stride, if it declares one.
struct View<'a> {
    bytes: &'a [u8],
    stride: Option<u64>,
}

impl<'a> View<'a> {
    /// `count` elements of `size` bytes from `offset` on, or an error if they exceed the view.
    fn slots(&self, offset: u64, size: usize, count: u64, at: &Location) -> Result<Slots<'a>> {
        let stride = self.stride.unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(wrong(at, &format!("byte stride {stride} is less than the element size of {size}")));
        }
        let last = if count > 0 { size as u64 } else { 0 };
        let length = count.saturating_sub(1).checked_mul(stride).and_then(|length| length.checked_add(last));
        let end = length.and_then(|length| length.checked_add(offset));
        end.filter(|end| *end <= self.bytes.len() as u64)
            .map(|_| Slots { bytes: &self.bytes[offset as usize..], stride: stride as usize })
            .ok_or_else(|| wrong(at, &format!("{count} elements exceed the buffer view")))
    }
}

/// Checks that sparse indices increase, for the binary search, and are below `count`.
fn check_order(sparse: &Sparse<'_>, count: u64, at: &Location) -> Result<()> {
    let mut least = 0;
    for position in 0..sparse.count {
        let index = sparse.index(position);
        if index < least {
            return Err(wrong(at, "sparse indices do not increase"));
        }
        if index >= count {
            return Err(wrong(at, &format!("sparse index {index} is out of range (elements: {count})")));
        }
        least = index + 1;
    }
    Ok(())
}

fn wrong(at: &Location, message: &str) -> IoError {
    IoError::Accessor { at: at.clone(), message: message.into() }
}
