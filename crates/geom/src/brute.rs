use crate::decide::Shear;
use crate::search::{Any, Closest, Search, offer_all};
use crate::{Aabb, Accel, Hit, Probe, Ray, Traverse, Triangles};

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
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.search(ray, Closest::new(ray), probe).hit()
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.search(ray, Any::new(ray), probe).found()
    }
}

impl BruteForce {
    /// Runs `search` over all triangles: the one loop behind every query.
    fn search<S: Search, P: Probe>(&self, ray: &Ray, mut search: S, probe: &mut P) -> S {
        if let Some(shear) = Shear::new(ray) {
            offer_all(&shear, &self.triangles, self.triangles.live().iter().copied(), &mut search, probe);
        }
        search
    }
}

impl Accel for BruteForce {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, &mut ())
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.any(ray, &mut ())
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes()
    }
}
