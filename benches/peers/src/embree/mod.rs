//! Embree 4 in all modes: single rays and packets of 4, 8 and 16.

mod ffi;
mod flush;
mod layout;

use crate::measure::timed;
use crate::peer::{Answer, Build, Entry, Family, Packets, Peer, Trial};
use crate::rays::RaySet;
use crate::scenes::Indexed;
use anyhow::{Context, Result, ensure};
use ffi::{Device, Scene};
use flush::FlushToZero;
use globillum::geom::{Ray, SimdLevel};
use layout::{Coherence, Rays};
use std::path::Path;
use std::rc::Rc;

/// The loaded library.
pub(crate) struct Embree {
    device: Rc<Device>,
    pub(crate) version: String,
}

impl Embree {
    /// Loads the library in `EMBREE_LIB`; `None` if that is unset or empty. It uses the instructions of `level` at
    /// most.
    pub(crate) fn from_env(level: SimdLevel) -> Result<Option<Self>> {
        let Some(path) = std::env::var_os("EMBREE_LIB").filter(|path| !path.is_empty()) else {
            return Ok(None);
        };
        let configuration = match level {
            SimdLevel::Avx2 => c"threads=1,isa=avx2",
            _ => c"threads=1",
        };
        let device = Device::load(Path::new(&path), configuration)
            .context("EMBREE_LIB does not name a library of Embree 4")?;
        let version = device.version();
        // Functions of the same names take different arguments in other versions.
        ensure!(version.starts_with("4."), "EMBREE_LIB names Embree {version}, not 4");
        Ok(Some(Self { device: Rc::new(device), version }))
    }

    /// All modes over a mesh, built with the robust flag and without.
    pub(crate) fn build(&self, mesh: &Indexed) -> Result<Vec<Entry>> {
        let mut entries = Vec::new();
        for (family, structure, robust) in
            [(Family::EmbreeRobust, "Embree robust", true), (Family::EmbreeFast, "Embree fast", false)]
        {
            let (scene, seconds) = timed(|| Scene::build(&self.device, &mesh.vertices, &mesh.faces, robust));
            let scene = Rc::new(scene?);
            let build = Build { seconds, bytes: Some(scene.bytes) };
            let entry = |(mode, peer)| Entry { family, structure, mode, build, peer };
            entries.extend(modes(&scene).into_iter().map(entry));
        }
        Ok(entries)
    }
}

/// The name and peer of every mode. Single rays have no coherence flag.
fn modes(scene: &Rc<Scene>) -> [(String, Box<dyn Peer>); 7] {
    use Coherence::{Coherent, Incoherent};
    [
        mode::<1>(scene, Incoherent),
        mode::<4>(scene, Incoherent),
        mode::<8>(scene, Incoherent),
        mode::<16>(scene, Incoherent),
        mode::<4>(scene, Coherent),
        mode::<8>(scene, Coherent),
        mode::<16>(scene, Coherent),
    ]
}

fn mode<const N: usize>(scene: &Rc<Scene>, coherence: Coherence) -> (String, Box<dyn Peer>) {
    let name = format!("{N} {coherence:?}").to_lowercase();
    (name, Box::new(Mode::<N> { scene: scene.clone(), coherence }))
}

/// Packets of `N` rays.
struct Mode<const N: usize> {
    scene: Rc<Scene>,
    coherence: Coherence,
}

impl<const N: usize> Peer for Mode<N> {
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        let query = |rays: &Rays<N>| self.scene.intersect(rays, self.coherence);
        Box::new(Flushed(Packets::new(layout(rays), rays.len(), query)))
    }

    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a> {
        let query = |rays: &Rays<N>| self.scene.occluded(rays, self.coherence);
        Box::new(Flushed(Packets::new(layout(rays), rays.len(), query)))
    }
}

/// Traces with denormal numbers flushed to zero.
struct Flushed<T>(T);

impl<T: Trial> Trial for Flushed<T> {
    fn trace(&mut self) {
        let _mode = FlushToZero::enter();
        self.0.trace();
    }

    fn answers(&self) -> Vec<Answer> {
        self.0.answers()
    }
}

/// Packets of `rays`. The last one is padded with rays whose range is empty.
fn layout<const N: usize>(rays: &[Ray]) -> Vec<Rays<N>> {
    rays.chunks(N).map(layout_packet).collect()
}

fn layout_packet<const N: usize>(rays: &[Ray]) -> Rays<N> {
    let mut packet = Rays::INACTIVE;
    for (lane, ray) in rays.iter().enumerate() {
        for axis in 0..3 {
            packet.origin[axis][lane] = ray.origin[axis] as f32;
            packet.direction[axis][lane] = ray.direction[axis] as f32;
        }
        packet.t_near[lane] = ray.t_min as f32;
        packet.t_far[lane] = ray.t_max as f32;
    }
    packet
}
