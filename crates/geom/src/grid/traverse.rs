use super::UniformGrid;
use super::mailbox::Mailbox;
use super::walk::Walk;
use crate::decide::Shear;
use crate::search::offer_all;
use crate::{Probe, Ray, Search, Traverse};

impl Traverse for UniformGrid {
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
