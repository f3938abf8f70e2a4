use globillum_geom::Triangle;
use globillum_material::Material;

/// What a scene is made of, before anything is checked or built: triangles, each with a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    triangles: Vec<Triangle>,
    /// For each triangle, its position in `materials`.
    material_ids: Vec<u32>,
    materials: Vec<Material>,
}

impl Model {
    /// Adds `triangles`, all of `material`, after those already there.
    pub fn add(&mut self, material: Material, triangles: impl IntoIterator<Item = Triangle>) {
        let id = self.materials.len() as u32;
        self.materials.push(material);
        self.triangles.extend(triangles);
        self.material_ids.resize(self.triangles.len(), id);
    }

    /// All triangles, in the order in which they were added: their index is a hit's index.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For each triangle, the position of its material in [`Model::materials`].
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// All materials, one for each call of [`Model::add`].
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
