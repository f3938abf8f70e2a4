use crate::decide::Shear;
use crate::search::offer_all;
use crate::{Aabb, Accel, Any, Closest, Hit, Probe, Ray, Search, Traverse, Triangles};

/// Tests every triangle: slow, and the definition of what every other structure must answer.
#[derive(Clone, Debug)]
pub struct BruteForce {
    triangles: Triangles,
}

impl BruteForce {
    /// Takes the triangles as they are; nothing is built.
    pub fn build(triangles: &Triangles) -> Self {
        Self { triangles: triangles.clone() }
    }
}

impl Traverse for BruteForce {
    fn search<S: Search, P: Probe>(&self, ray: &Ray, mut search: S, probe: &mut P) -> S {
        if let Some(shear) = Shear::new(ray) {
            offer_all(&shear, &self.triangles, self.triangles.live().iter().copied(), &mut search, probe);
        }
        search
    }
}

impl Accel for BruteForce {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.search(ray, Closest::new(ray), &mut ()).hit()
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.search(ray, Any::new(ray), &mut ()).found()
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes()
    }
}
