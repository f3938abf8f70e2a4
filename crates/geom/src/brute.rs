use crate::decide::Shear;
use crate::query::{AnyHit, ClosestHit, Query, offer_all};
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
        self.query(ray, ClosestHit::new(ray), probe).hit()
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.query(ray, AnyHit::new(ray), probe).found()
    }
}

impl BruteForce {
    /// Runs `query` over all triangles: the one loop behind every query.
    fn query<Q: Query, P: Probe>(&self, ray: &Ray, mut query: Q, probe: &mut P) -> Q {
        if let Some(shear) = Shear::new(ray) {
            offer_all(&shear, &self.triangles, self.triangles.live().iter().copied(), &mut query, probe);
        }
        query
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
