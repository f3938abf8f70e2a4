use crate::RenderError;
use crate::light::DeltaLight;
use glam::DAffine3;
use globillum_geom::{Aabb, Triangle};
use globillum_material::{Emission, Material, MaterialError, Rgb, Sides};
use std::collections::TryReserveError;

/// Triangles with materials, delta lights and an environment, from which [`Scene::build`](crate::Scene::build) makes a scene.
/// Triangles are not checked yet.
///
/// ```
/// use glam::Vec3;
/// use globillum_geom::Triangle;
/// use globillum_integrator::Model;
/// use globillum_material::{Material, Rgb};
///
/// let mut model = Model::default();
/// let floor = [Triangle::new(Vec3::ZERO, Vec3::Z, Vec3::X)];
/// model.add(Material::lambert(Rgb::splat(0.5))?, floor);
/// // Emits downward, where its vertices run counter-clockwise.
/// let light = [Triangle::new(Vec3::Y, Vec3::Y + Vec3::X, Vec3::Y + Vec3::Z)];
/// model.add(Material::light(Rgb::splat(10.0))?, light);
/// assert!(model.triangles()[0].normal().y > 0.0 && model.triangles()[1].normal().y < 0.0);
/// # Ok::<(), globillum_material::MaterialError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    pub(super) triangles: Vec<Triangle>,
    /// For each triangle, the index of its material in `materials`.
    pub(super) material_ids: Vec<u32>,
    pub(super) materials: Vec<Material>,
    pub(super) delta_lights: Vec<DeltaLight>,
    pub(super) environment: Rgb,
}

/// A material of a [`Model`], returned by [`Model::add`], [`Model::add_material`] and [`Model::material_id`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(u32);

impl MaterialId {
    /// The index of the material in [`Model::materials`] of its model.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Model {
    /// Appends `triangles` of one `material`, and returns this for [`Model::push`] and [`Model::set_material`].
    pub fn add(&mut self, material: Material, triangles: impl IntoIterator<Item = Triangle>) -> MaterialId {
        let id = self.add_material(material);
        self.triangles.extend(triangles);
        self.material_ids.resize(self.triangles.len(), id.0);
        id
    }

    /// Adds a material for use in [`Model::push`].
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Replaces the material; every triangle that uses `id` follows.
    ///
    /// # Panics
    /// If `id` belongs to another model and is out of range here.
    pub fn set_material(&mut self, id: MaterialId, material: Material) {
        assert!((id.0 as usize) < self.materials.len(), "a material of another model");
        self.materials[id.0 as usize] = material;
    }

    /// Appends a triangle of a material of this model.
    ///
    /// # Panics
    /// If `material` belongs to another model and is out of range here.
    pub fn push(&mut self, material: MaterialId, triangle: Triangle) {
        assert!((material.0 as usize) < self.materials.len(), "a material of another model");
        self.triangles.push(triangle);
        self.material_ids.push(material.0);
    }

    /// Adds a light without extent.
    pub fn add_delta_light(&mut self, light: DeltaLight) {
        self.delta_lights.push(light);
    }

    /// Surrounds the model with an environment of constant `radiance`; without it, the environment is black.
    ///
    /// # Errors
    /// [`MaterialError::Emission`] for a component that no light may have ([`Emission::allows`]). The environment then
    /// stays as it is.
    pub fn set_environment(&mut self, radiance: Rgb) -> Result<(), MaterialError> {
        self.environment = Emission::new(radiance, Sides::Both)?.radiance();
        Ok(())
    }

    /// Reserves memory for `additional` more triangles.
    ///
    /// # Errors
    /// If the memory cannot be allocated.
    pub fn try_reserve(&mut self, additional: usize) -> Result<(), TryReserveError> {
        self.triangles.try_reserve(additional)?;
        self.material_ids.try_reserve(additional)
    }

    /// All triangles in the order in which they were added; a hit names them by this index.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For each triangle, the index of its material in [`Model::materials`].
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// The material of triangle `index`, for [`Model::set_material`] and [`Model::push`].
    ///
    /// ```
    /// use glam::Vec3;
    /// use globillum_geom::Triangle;
    /// use globillum_integrator::Model;
    /// use globillum_material::{Material, Rgb};
    ///
    /// /// Makes mirrors of all triangles that have the material of the first one.
    /// fn polish(model: &mut Model) -> Result<(), globillum_material::MaterialError> {
    ///     let id = model.material_id(0);
    ///     model.set_material(id, Material::mirror(Rgb::splat(0.9))?);
    ///     Ok(())
    /// }
    ///
    /// let mut model = Model::default();
    /// model.add(Material::lambert(Rgb::splat(0.5))?, [Triangle::new(Vec3::ZERO, Vec3::Z, Vec3::X)]);
    /// polish(&mut model)?;
    /// assert_eq!(*model.material(0), Material::mirror(Rgb::splat(0.9))?);
    /// # Ok::<(), globillum_material::MaterialError>(())
    /// ```
    ///
    /// # Panics
    /// If `index` is not below the number of triangles.
    pub fn material_id(&self, index: usize) -> MaterialId {
        MaterialId(self.material_ids[index])
    }

    /// All materials in the order in which they were added.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// All delta lights in the order in which they were added.
    pub fn delta_lights(&self) -> &[DeltaLight] {
        &self.delta_lights
    }

    /// All delta lights, to change or remove those of a file.
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use globillum_integrator::{DeltaLight, Model};
    /// # use globillum_material::Rgb;
    /// # let mut model = Model::default();
    /// # model.add_delta_light(DeltaLight::point(Vec3::Y, Rgb::splat(20.0))?);
    /// # model.add_delta_light(DeltaLight::directional(-Vec3::Y, Rgb::splat(3.0))?);
    /// // No sun, and lamps of half the intensity.
    /// model.delta_lights_mut().retain(|light| light.position().is_some());
    /// for light in model.delta_lights_mut() {
    ///     *light = light.with_value(0.5 * light.value())?;
    /// }
    /// # assert_eq!(model.delta_lights(), [DeltaLight::point(Vec3::Y, Rgb::splat(10.0))?]);
    /// # Ok::<(), globillum_integrator::DeltaLightError>(())
    /// ```
    pub fn delta_lights_mut(&mut self) -> &mut Vec<DeltaLight> {
        &mut self.delta_lights
    }

    /// The constant radiance of the environment.
    pub fn environment(&self) -> Rgb {
        self.environment
    }

    /// The material of triangle `index`.
    ///
    /// # Panics
    /// If `index` is not below the number of triangles.
    pub fn material(&self, index: usize) -> &Material {
        &self.materials[self.material_ids[index] as usize]
    }

    /// The bounds of all vertices, [`Aabb::EMPTY`] if there are none. NaN coordinates are ignored. Delta lights
    /// do not count.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.triangles.iter().flat_map(|triangle| triangle.vertices))
    }

    /// Transforms all triangles and delta lights. Points are computed in `f64` and rounded once to `f32`.
    ///
    /// A mirroring transform keeps fronts ([`Triangle::transformed`]): a mirrored light emits from the same side
    /// of its surface. A singular transform makes degenerate triangles, which are never hit. Emitted radiance
    /// is not scaled, so a light of twice the size has four times the power.
    ///
    /// The position of a delta light is transformed as a point, its direction as a vector. Its intensity or
    /// irradiance stays: at twice the distance, the irradiance of a point light is a quarter.
    ///
    /// ```
    /// use glam::{DAffine3, DVec3, Vec3};
    /// use globillum_geom::Triangle;
    /// use globillum_integrator::Model;
    /// use globillum_material::{Material, Rgb};
    ///
    /// let mut model = Model::default();
    /// let triangle = Triangle::new(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 4.0);
    /// model.add(Material::lambert(Rgb::splat(0.5))?, [triangle]);
    /// // Fit into a box of side 1 around the origin.
    /// let bounds = model.bounds();
    /// let center = bounds.center();
    /// let scale = 1.0 / bounds.extent().max_element();
    /// model.transform(&(DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_translation(-center)))?;
    /// assert_eq!((model.bounds().min, model.bounds().max), (Vec3::new(-0.5, -0.25, 0.0), Vec3::new(0.5, 0.25, 0.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RenderError::Geometry`] for the first triangle whose transformed coordinates are not finite or exceed
    /// [`Triangle::MAX_COORDINATE`](globillum_geom::Triangle::MAX_COORDINATE), [`RenderError::DeltaLight`] for
    /// a delta light that leaves this domain or whose direction becomes zero. The model is then unchanged.
    pub fn transform(&mut self, transform: &DAffine3) -> Result<(), RenderError> {
        let moved = |(index, triangle): (usize, &Triangle)| {
            let moved = Triangle::transformed(triangle.vertices.map(|v| v.as_dvec3()), transform);
            moved.validate(index).map(|()| moved)
        };
        let triangles = self.triangles.iter().enumerate().map(moved).collect::<Result<_, _>>()?;
        let lights = self.delta_lights.iter().map(|light| light.transformed(transform));
        self.delta_lights = lights.collect::<Result<_, _>>()?;
        self.triangles = triangles;
        Ok(())
    }

    /// Appends the triangles, materials and delta lights of `other`, but not its environment. A [`MaterialId`] of `other` is
    /// none of this model's.
    pub fn append(&mut self, other: &Model) {
        let offset = self.materials.len() as u32;
        self.triangles.extend(&other.triangles);
        self.material_ids.extend(other.material_ids.iter().map(|id| id + offset));
        self.materials.extend(&other.materials);
        self.delta_lights.extend(&other.delta_lights);
    }
}
