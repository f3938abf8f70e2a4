use super::UniformGrid;
use super::mailbox::Mailbox;
use super::walk::Walk;
use crate::decide::Shear;
use crate::search::{Any, Closest, Search, offer_all};
use crate::{Hit, Probe, Ray, Traverse};

impl Traverse for UniformGrid {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.search(ray, Closest::new(ray), probe).hit()
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.search(ray, Any::new(ray), probe).found()
    }
}

impl UniformGrid {
    /// Runs `search` along `ray`: the one traversal behind every query.
    fn search<S: Search, P: Probe>(&self, ray: &Ray, mut search: S, probe: &mut P) -> S {
        let Some(shear) = Shear::new(ray) else { return search };
        let Some(walk) = Walk::new(&self.lattice, &self.triangles.bounds(), ray) else { return search };
        let mut mailbox = Mailbox::new();
        walk.for_each_cell(|cell| {
            probe.visit();
            let listed = self.listed(self.lattice.flat(cell));
            if !listed.is_empty() {
                probe.open();
                let new = listed.iter().copied().filter(|&triangle| mailbox.is_new(triangle));
                offer_all(&shear, &self.triangles, new, &mut search, probe);
            }
            search.t_end()
        });
        search
    }
}
