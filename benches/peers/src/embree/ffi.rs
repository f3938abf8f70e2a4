//! The used functions of Embree 4, loaded at run time.
//!
//! [`Device`] and [`Scene`] are a safe interface to them. It relies on the following: signatures and layouts
//! are those of Embree 4's public headers; the library is never unloaded; the owner of a handle releases it
//! once; a query reads and writes no memory of this program except the packet it is given.
#![allow(unsafe_code, reason = "calls a C library")]

use super::layout::{Aligned, Arguments, Coherence, Hits, INVALID, RayHits, Rays};
use anyhow::{Result, ensure};
use libloading::Library;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicIsize, Ordering};

type Handle = *mut c_void;

/// Declares the functions and loads them by name.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of a loaded library.
        #[allow(non_snake_case, reason = "Embree's names")]
        struct Api {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Api {
            /// Loads the library at `path`. It is never unloaded, because its threads may outlive every device.
            fn load(path: &Path) -> Result<Self> {
                // SAFETY: Embree's initialisers have no preconditions, and the signatures are those of its
                // headers.
                unsafe {
                    let library = ManuallyDrop::new(Library::new(path)?);
                    Ok(Self {
                        $($name: *library.get(concat!(stringify!($name), "\0").as_bytes())?,)*
                    })
                }
            }
        }
    };
}

functions! {
    rtcNewDevice: fn(*const c_char) -> Handle;
    rtcReleaseDevice: fn(Handle);
    rtcGetDeviceError: fn(Handle) -> c_int;
    rtcGetDeviceProperty: fn(Handle, c_int) -> isize;
    rtcSetDeviceMemoryMonitorFunction: fn(Handle, MemoryMonitor, *mut c_void);
    rtcNewScene: fn(Handle) -> Handle;
    rtcReleaseScene: fn(Handle);
    rtcSetSceneFlags: fn(Handle, c_int);
    rtcSetSceneBuildQuality: fn(Handle, c_int);
    rtcCommitScene: fn(Handle);
    rtcNewGeometry: fn(Handle, c_int) -> Handle;
    rtcReleaseGeometry: fn(Handle);
    rtcCommitGeometry: fn(Handle);
    rtcAttachGeometry: fn(Handle, Handle) -> c_uint;
    rtcSetNewGeometryBuffer: fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
    rtcIntersect1: fn(Handle, *mut c_void, *mut Arguments);
    rtcIntersect4: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
    rtcIntersect8: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
    rtcIntersect16: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
    rtcOccluded1: fn(Handle, *mut c_void, *mut Arguments);
    rtcOccluded4: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
    rtcOccluded8: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
    rtcOccluded16: fn(*const c_int, Handle, *mut c_void, *mut Arguments);
}

type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Adds to the counter that `bytes_held` points to.
unsafe extern "C" fn count_bytes(bytes_held: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the pointer is a device's counter, which outlives the device.
    let bytes_held = unsafe { &*bytes_held.cast::<AtomicIsize>() };
    bytes_held.fetch_add(bytes, Ordering::Relaxed);
    true
}

const GEOMETRY_TRIANGLE: c_int = 0;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const QUALITY_HIGH: c_int = 2;
const SCENE_ROBUST: c_int = 1 << 2;
const PROPERTY_VERSION: c_int = 0;

/// A loaded library, building on one thread.
///
/// There should be one for the whole run: each time that devices come and go, the library resets
/// its threads, which may leave one of them spinning.
pub(crate) struct Device {
    api: Api,
    handle: Handle,
    bytes_held: Rc<AtomicIsize>,
}

impl Device {
    /// Loads the library at `path`, with a configuration of the device.
    pub(crate) fn load(path: &Path, configuration: &CStr) -> Result<Self> {
        let api = Api::load(path)?;
        let bytes_held = Rc::new(AtomicIsize::new(0));
        let counter = Rc::as_ptr(&bytes_held).cast_mut().cast();
        // SAFETY: the configuration ends with a zero, and the counter is kept beside the handle.
        unsafe {
            let handle = (api.rtcNewDevice)(configuration.as_ptr());
            ensure!(!handle.is_null(), "Embree has no device");
            (api.rtcSetDeviceMemoryMonitorFunction)(handle, count_bytes, counter);
            Ok(Self { api, handle, bytes_held })
        }
    }

    /// The library's version.
    pub(crate) fn version(&self) -> String {
        // SAFETY: the device is alive.
        let version = unsafe { (self.api.rtcGetDeviceProperty)(self.handle, PROPERTY_VERSION) };
        format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    /// Gives `geometry` a buffer that holds `items`.
    fn fill<T: Copy>(&self, geometry: Handle, buffer: c_int, format: c_int, items: &[T]) -> Result<()> {
        let set = self.api.rtcSetNewGeometryBuffer;
        // SAFETY: the new buffer has room for these items, and nothing else refers to it yet.
        unsafe {
            let start = set(geometry, buffer, 0, format, size_of::<T>(), items.len());
            ensure!(!start.is_null(), "Embree has no memory for {} items", items.len());
            start.cast::<T>().copy_from_nonoverlapping(items.as_ptr(), items.len());
        }
        Ok(())
    }

    /// Memory of all scenes of the device, in bytes.
    fn bytes_held(&self) -> isize {
        self.bytes_held.load(Ordering::Relaxed)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: this is the only owner of the handle, which is not used again.
        unsafe { (self.api.rtcReleaseDevice)(self.handle) }
    }
}

/// A mesh, built with the highest quality.
pub(crate) struct Scene {
    device: Rc<Device>,
    handle: Handle,
    /// Memory in bytes, including buffers.
    pub(crate) bytes: usize,
}

impl Scene {
    pub(crate) fn build(
        device: &Rc<Device>,
        vertices: &[[f32; 3]],
        faces: &[[u32; 3]],
        robust: bool,
    ) -> Result<Self> {
        ensure!(
            faces.iter().flatten().all(|&i| (i as usize) < vertices.len()),
            "a face refers to a missing vertex"
        );
        let api = &device.api;
        let bytes_before = device.bytes_held();
        // SAFETY: every handle is valid while it is used.
        unsafe {
            let handle = (api.rtcNewScene)(device.handle);
            let mut built = Self { device: device.clone(), handle, bytes: 0 };
            (api.rtcSetSceneFlags)(handle, if robust { SCENE_ROBUST } else { 0 });
            (api.rtcSetSceneBuildQuality)(handle, QUALITY_HIGH);
            let geometry = (api.rtcNewGeometry)(device.handle, GEOMETRY_TRIANGLE);
            device.fill(geometry, BUFFER_VERTEX, FORMAT_FLOAT3, vertices)?;
            device.fill(geometry, BUFFER_INDEX, FORMAT_UINT3, faces)?;
            (api.rtcCommitGeometry)(geometry);
            (api.rtcAttachGeometry)(handle, geometry);
            (api.rtcReleaseGeometry)(geometry);
            (api.rtcCommitScene)(handle);
            let error = (api.rtcGetDeviceError)(device.handle);
            ensure!(error == 0, "Embree reports error {error}");
            built.bytes = (device.bytes_held() - bytes_before).max(0) as usize;
            Ok(built)
        }
    }

    /// The closest hit of each ray: the triangle, and `t`.
    #[inline]
    pub(crate) fn intersect<const N: usize>(
        &self,
        rays: &Rays<N>,
        coherence: Coherence,
    ) -> [Option<(u32, f32)>; N] {
        const { assert!(matches!(N, 1 | 4 | 8 | 16)) };
        let mut packet = Aligned(RayHits { rays: *rays, hits: Hits::NONE });
        let (valid, mut arguments) = (Aligned([-1; N]), Arguments::new(coherence));
        let (valid, arguments) = (valid.0.as_ptr(), &raw mut arguments);
        let (api, scene, pointer) = (&self.device.api, self.handle, (&raw mut packet).cast());
        // SAFETY: `packet` and `valid` are laid out and aligned for `N` rays.
        unsafe {
            match N {
                1 => (api.rtcIntersect1)(scene, pointer, arguments),
                4 => (api.rtcIntersect4)(valid, scene, pointer, arguments),
                8 => (api.rtcIntersect8)(valid, scene, pointer, arguments),
                _ => (api.rtcIntersect16)(valid, scene, pointer, arguments),
            }
        }
        let RayHits { rays, hits } = &packet.0;
        std::array::from_fn(|i| (hits.geometry[i] != INVALID).then(|| (hits.triangle[i], rays.t_far[i])))
    }

    /// Whether each ray hits anything.
    #[inline]
    pub(crate) fn occluded<const N: usize>(&self, rays: &Rays<N>, coherence: Coherence) -> [bool; N] {
        const { assert!(matches!(N, 1 | 4 | 8 | 16)) };
        let mut packet = Aligned(*rays);
        let (valid, mut arguments) = (Aligned([-1; N]), Arguments::new(coherence));
        let (valid, arguments) = (valid.0.as_ptr(), &raw mut arguments);
        let (api, scene, pointer) = (&self.device.api, self.handle, (&raw mut packet).cast());
        // SAFETY: `packet` and `valid` are laid out and aligned for `N` rays.
        unsafe {
            match N {
                1 => (api.rtcOccluded1)(scene, pointer, arguments),
                4 => (api.rtcOccluded4)(valid, scene, pointer, arguments),
                8 => (api.rtcOccluded8)(valid, scene, pointer, arguments),
                _ => (api.rtcOccluded16)(valid, scene, pointer, arguments),
            }
        }
        packet.0.t_far.map(|t| t < 0.0)
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: this is the only owner of the handle, which is not used again. The device is released later.
        unsafe { (self.device.api.rtcReleaseScene)(self.handle) }
    }
}
