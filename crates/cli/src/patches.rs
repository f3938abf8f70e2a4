//! The patches of a scene file, and what they are called.

use crate::console;
use clap::ValueEnum;
use globillum::integrator::view_factors::Patches;
use globillum::io::{Loaded, Object};
use std::collections::HashMap;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PatchKind {
    /// All triangles of a material, numbered from 0 as a glTF file lists them, or from 1 in the order of their first use in
    /// an OBJ file. The material of triangles without one has 0 in an OBJ file, and in a glTF file the next number
    Material,
    /// All triangles of the objects of a name: `o` or `g` of OBJ, nodes of glTF
    Object,
    /// Each triangle, numbered from 0
    Triangle,
}

/// Patches with their names.
pub(crate) struct NamedPatches {
    pub(crate) patches: Patches,
    /// `None` if they are called by their numbers.
    names: Option<Vec<String>>,
}

/// The names of targets that are no patches.
const RESERVED_NAMES: [&str; 2] = ["surroundings", "back"];

impl NamedPatches {
    /// The patches of a file that was loaded with its objects, if they are to be patches.
    pub(crate) fn of(loaded: &Loaded, kind: PatchKind) -> Self {
        let count = loaded.model.triangles().len();
        match kind {
            PatchKind::Triangle => Self { patches: Patches::of_triangles(count as u32), names: None },
            PatchKind::Material => Self::of_materials(loaded.model.material_ids()),
            PatchKind::Object => Self::of_objects(&loaded.objects, count),
        }
    }

    /// Materials without triangles are no patches.
    fn of_materials(ids: &[u32]) -> Self {
        let mut used = ids.to_vec();
        used.sort_unstable();
        used.dedup();
        let patch = |id: &u32| used.partition_point(|used| used < id) as u32;
        let patches = Patches::new(used.len() as u32, ids.iter().map(patch).collect());
        Self { patches, names: Some(used.iter().map(|id| format!("material {id}")).collect()) }
    }

    fn of_objects(objects: &[Object], triangles: usize) -> Self {
        let (mut names, mut numbers, mut ids) = (Vec::new(), HashMap::new(), vec![0; triangles]);
        for object in objects {
            let patch = *numbers.entry(&object.name).or_insert_with(|| {
                names.push(object.name.clone());
                names.len() as u32 - 1
            });
            ids[object.triangles.clone()].fill(patch);
        }
        rename_reserved(&mut names);
        Self { patches: Patches::new(names.len() as u32, ids), names: Some(names) }
    }

    /// What a patch is called.
    pub(crate) fn name(&self, patch: u32) -> String {
        self.names.as_ref().map_or_else(|| patch.to_string(), |names| names[patch as usize].clone())
    }
}

/// Gives other names to objects that are called as targets that are no patches.
fn rename_reserved(names: &mut [String]) {
    for reserved in RESERVED_NAMES {
        let Some(place) = names.iter().position(|name| name == reserved) else { continue };
        let mut name = format!("object {reserved}");
        while names.contains(&name) {
            name.insert_str(0, "object ");
        }
        console::warn(format_args!(
            "object `{reserved}` is written as `{name}`: `{reserved}` is another target"
        ));
        names[place] = name;
    }
}
