use globillum_geom::Triangle;
use globillum_material::Material;
use std::collections::TryReserveError;

/// What a scene is made of, before anything is checked or built: triangles, each with a material.
///
/// ```
/// use glam::Vec3;
/// use globillum_geom::Triangle;
/// use globillum_integrator::Model;
/// use globillum_material::{Material, Rgb};
///
/// let mut model = Model::default(); // or the one that a file was loaded as
/// let floor = [Triangle::new(Vec3::ZERO, Vec3::Z, Vec3::X)];
/// model.add(Material::lambert(Rgb::splat(0.5))?, floor);
/// // Seen from below its vertices run counter-clockwise: it shines downward.
/// let light = [Triangle::new(Vec3::Y, Vec3::Y + Vec3::X, Vec3::Y + Vec3::Z)];
/// model.add(Material::light(Rgb::splat(10.0))?, light);
/// assert!(model.triangles()[0].normal().y > 0.0 && model.triangles()[1].normal().y < 0.0);
/// # Ok::<(), globillum_material::MaterialError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    triangles: Vec<Triangle>,
    /// For each triangle, its position in `materials`.
    material_ids: Vec<u32>,
    materials: Vec<Material>,
}

/// A material of a [`Model`], as [`Model::add_material`] hands it out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialId(u32);

impl Model {
    /// Adds `triangles`, all of `material`, after those already there.
    pub fn add(&mut self, material: Material, triangles: impl IntoIterator<Item = Triangle>) {
        let MaterialId(id) = self.add_material(material);
        self.triangles.extend(triangles);
        self.material_ids.resize(self.triangles.len(), id);
    }

    /// Adds a material that triangles may be given later, and many times, by [`Model::push`].
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Makes all triangles of that material of another one.
    ///
    /// # Panics
    /// If `id` is another model's, and this one has not that many.
    pub fn set_material(&mut self, id: MaterialId, material: Material) {
        self.materials[id.0 as usize] = material;
    }

    /// Adds a triangle of a material that is already there.
    ///
    /// # Panics
    /// If `material` is another model's, and this one has not that many.
    pub fn push(&mut self, material: MaterialId, triangle: Triangle) {
        assert!((material.0 as usize) < self.materials.len(), "a material of another model");
        self.triangles.push(triangle);
        self.material_ids.push(material.0);
    }

    /// Makes room for so many triangles more.
    ///
    /// # Errors
    /// If there is not that much memory.
    pub fn try_reserve(&mut self, additional: usize) -> Result<(), TryReserveError> {
        self.triangles.try_reserve(additional)?;
        self.material_ids.try_reserve(additional)
    }

    /// All triangles, in the order in which they were added: their index is a hit's index.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For each triangle, the position of its material in [`Model::materials`].
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// All materials, in the order in which they were added.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The material of triangle `index`.
    ///
    /// # Panics
    /// If there are not that many triangles.
    pub fn material(&self, index: usize) -> &Material {
        &self.materials[self.material_ids[index] as usize]
    }

    /// Adds all of `other` after what is already there.
    pub fn append(&mut self, other: &Model) {
        let offset = self.materials.len() as u32;
        self.triangles.extend(&other.triangles);
        self.material_ids.extend(other.material_ids.iter().map(|id| id + offset));
        self.materials.extend(&other.materials);
    }
}
