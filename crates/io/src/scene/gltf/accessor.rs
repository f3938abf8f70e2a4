//! Typed access to buffers. Opening an accessor checks all its bounds and copies nothing, so that later
//! access stays within the buffer. Each accessor is opened once.

use super::buffer::Buffers;
use super::document::Document;
use crate::error::Result;
use crate::limits::check_count;
use crate::scene::loading::Loading;
use crate::{IoError, Location, Place};
use glam::Vec3;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type, sparse};
use gltf::json::validation::Checked::Valid;
use gltf::json::validation::USize64;
use gltf::json::{self, Index, buffer};
use std::rc::Rc;

/// Elements of `size` bytes at a constant stride.
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

/// The unsigned integer in one, two or four bytes.
fn integer(bytes: &[u8]) -> u32 {
    match *bytes {
        [a] => a.into(),
        [a, b] => u16::from_le_bytes([a, b]).into(),
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

/// The use of an accessor.
#[derive(Clone, Copy)]
pub(super) enum Use {
    Positions,
    Indices,
}

impl Use {
    /// The bytes of an element if `json` fits this use, or a message that says what does.
    fn element_size(self, json: &json::Accessor) -> Result<usize, &'static str> {
        use ComponentType::{F32, U8, U16, U32};
        let Valid(GenericComponentType(component)) = json.component_type else { return Err(self.rule()) };
        match (self, json.type_, component) {
            (Self::Positions, Valid(Type::Vec3), F32) => Ok(12),
            (Self::Indices, Valid(Type::Scalar), U8 | U16 | U32) => Ok(component.size()),
            _ => Err(self.rule()),
        }
    }

    fn rule(self) -> &'static str {
        match self {
            Self::Positions => "positions must be VEC3 of floats",
            Self::Indices => "indices must be SCALAR of unsigned integers",
        }
    }
}

/// An open accessor. Elements without data in a buffer are zero.
pub(super) struct Accessor<'a> {
    dense: Option<Slots<'a>>,
    /// Boxed, since few accessors have it.
    sparse: Option<Box<Sparse<'a>>>,
    count: u64,
}

/// Replacements for single elements, sorted by index.
struct Sparse<'a> {
    indices: Slots<'a>,
    values: Slots<'a>,
    count: usize,
}

impl<'a> Accessor<'a> {
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Position `index`, which must be below `count`.
    pub(super) fn position(&self, index: u64) -> Vec3 {
        self.get(index).map_or(Vec3::ZERO, |bytes| {
            let (components, _) = bytes.as_chunks::<4>();
            let [x, y, z] = [0, 1, 2].map(|i| f32::from_le_bytes(components[i]));
            Vec3::new(x, y, z)
        })
    }

    /// The index at `position`, which must be below `count`. The elements must be indices.
    pub(super) fn index(&self, position: u64) -> u64 {
        self.get(position).map_or(0, |bytes| integer(bytes).into())
    }

    /// Element `index`; `None` if it is zero.
    fn get(&self, index: u64) -> Option<&'a [u8]> {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.get(index));
        replaced.or_else(|| self.dense.map(|slots| slots.get(index as usize)))
    }
}

impl<'a> Sparse<'a> {
    fn index(&self, position: usize) -> u64 {
        integer(self.indices.get(position)).into()
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

/// All accessors. Each is opened on first use.
pub(super) struct Accessors<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    opened: Vec<Option<Rc<Accessor<'a>>>>,
    /// The number of sparse elements of all open accessors.
    sparse_elements: u64,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>) -> Self {
        Self { document, buffers, opened: vec![None; document.accessors.len()], sparse_elements: 0 }
    }

    /// Accessor `index`, opened for this use.
    pub(super) fn open(
        &mut self,
        index: Index<json::Accessor>,
        used_as: Use,
        loading: &Loading<'_>,
    ) -> Result<Rc<Accessor<'a>>> {
        let (index, document) = (index.value(), self.document);
        let at = loading.at(Place::Accessor(index));
        let Some(json) = document.accessors.get(index) else {
            return Err(wrong(&at, &format!("does not exist (accessors: {})", self.opened.len())));
        };
        let size = used_as.element_size(json).map_err(|rule| wrong(&at, rule))?;
        if let Some(opened) = &self.opened[index] {
            return Ok(Rc::clone(opened));
        }
        let opened = Rc::new(self.read(json, size, &at, loading)?);
        Ok(Rc::clone(self.opened[index].insert(opened)))
    }

    /// Reads an accessor of elements of `size` bytes and checks its bounds.
    fn read(
        &mut self,
        json: &json::Accessor,
        size: usize,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<Accessor<'a>> {
        let (count, offset) = (json.count.0, json.byte_offset.unwrap_or_default().0);
        let dense = json.buffer_view.map(|view| self.view(view, at, loading)).transpose()?;
        let dense = dense.map(|view| view.slots(offset, size, count, at)).transpose()?;
        if dense.is_none() {
            let limit = loading.limits.json_values;
            check_count(count, limit, "elements without a buffer view", || at.clone())?;
        }
        let sparse =
            json.sparse.as_ref().map(|json| self.sparse(json, size, count, at, loading)).transpose()?;
        Ok(Accessor { dense, sparse: sparse.map(Box::new), count })
    }

    /// Replacements for some of `count` elements of `size` bytes.
    fn sparse(
        &mut self,
        json: &sparse::Sparse,
        size: usize,
        count: u64,
        at: &Location,
        loading: &Loading<'_>,
    ) -> Result<Sparse<'a>> {
        let Valid(IndexComponentType(component)) = json.indices.component_type else {
            return Err(wrong(at, "sparse indices must be unsigned integers"));
        };
        let packed = |view, offset: USize64, size| {
            View { stride: None, ..self.view(view, at, loading)? }.slots(offset.0, size, json.count.0, at)
        };
        let indices = packed(json.indices.buffer_view, json.indices.byte_offset, component.size())?;
        let values = packed(json.values.buffer_view, json.values.byte_offset, size)?;
        let sparse = Sparse { indices, values, count: json.count.0 as usize };
        // Accessors may share their sparse elements, but each checks all of them.
        self.sparse_elements = self.sparse_elements.saturating_add(json.count.0);
        let limit = loading.files.bytes_read();
        check_count(self.sparse_elements, limit, "elements of sparse accessors", || at.clone())?;
        check_order(&sparse, count, at)?;
        Ok(sparse)
    }

    /// Buffer view `index`.
    fn view(&self, index: Index<buffer::View>, at: &Location, loading: &Loading<'_>) -> Result<View<'a>> {
        let missing = |at: &Location, what, index| wrong(at, &format!("{what}[{index}] does not exist"));
        let index = index.value();
        let view = self.document.buffer_views.get(index).ok_or_else(|| missing(at, "bufferViews", index))?;
        let (at, buffer) = (&loading.at(Place::BufferView(index)), view.buffer.value());
        let bytes = self.buffers.get(buffer).ok_or_else(|| missing(at, "buffers", buffer))?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0).filter(|end| *end <= bytes.len() as u64);
        let end = end.ok_or_else(|| wrong(at, "buffer view exceeds its buffer"))?;
        let stride = view.byte_stride.map(|stride| stride.0 as u64);
        Ok(View { bytes: &bytes[start as usize..end as usize], stride })
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
            .map(|_| Slots { bytes: &self.bytes[offset as usize..], stride: stride as usize, size })
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
