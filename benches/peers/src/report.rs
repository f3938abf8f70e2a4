//! The figures of a run, and their ratios.

use crate::measure::Outcome;
use crate::peer::{Build, Entry, Family};
use crate::rays::{Kind, RaySet};
use serde::Serialize;

/// All figures of a run.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) machine: Machine,
    /// The kinds of rays, in the order of the figures.
    pub(crate) kinds: [Kind; 3],
    pub(crate) meshes: Vec<MeshReport>,
    pub(crate) ratios: Vec<Ratio>,
}

/// Machine, versions and command of a run.
#[derive(Debug, Serialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) rustc: String,
    pub(crate) rustflags: String,
    /// Embree's version, or "absent".
    pub(crate) embree: String,
    pub(crate) date: String,
    pub(crate) command: String,
}

/// The figures of one mesh.
#[derive(Debug, Serialize)]
pub(crate) struct MeshReport {
    pub(crate) mesh: String,
    pub(crate) triangles: usize,
    /// The number of rays of each kind.
    pub(crate) rays: [usize; 3],
    /// The integrator's rays; empty unless the scene is an interior.
    pub(crate) wavefronts: Vec<SetReport>,
    pub(crate) rows: Vec<Row>,
}

/// A set of an integrator's rays.
#[derive(Debug, Serialize)]
pub(crate) struct SetReport {
    pub(crate) name: String,
    pub(crate) rays: usize,
    /// Whether there are too few rays for the figures to be relied on.
    pub(crate) is_small: bool,
}

impl SetReport {
    /// Sets with fewer rays than this are small: they take less than a millisecond.
    const SMALL: usize = 20_000;

    pub(crate) fn of(set: &RaySet) -> Self {
        Self { name: set.name.clone(), rays: set.len(), is_small: set.len() < Self::SMALL }
    }
}

/// The figures of one entry over one mesh.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) family: Family,
    pub(crate) structure: &'static str,
    pub(crate) mode: String,
    pub(crate) build: Build,
    /// In the order of [`Kind::ALL`].
    pub(crate) outcomes: [Outcome; 3],
    /// In the order of [`MeshReport::wavefronts`].
    pub(crate) wavefronts: Vec<Outcome>,
}

impl Row {
    pub(crate) fn new(entry: &Entry, outcomes: [Outcome; 3], wavefronts: Vec<Outcome>) -> Self {
        let Entry { family, structure, mode, build, .. } = entry;
        Self { family: *family, structure, mode: mode.clone(), build: *build, outcomes, wavefronts }
    }
}

/// A line of a table: the best of some rows for each mesh and kind of rays.
pub(crate) struct Line {
    pub(crate) name: String,
    covers: Box<dyn Fn(&Row) -> bool>,
}

impl Line {
    fn new(name: impl Into<String>, covers: impl Fn(&Row) -> bool + 'static) -> Self {
        Self { name: name.into(), covers: Box::new(covers) }
    }

    fn of(row: &Row) -> Self {
        let (structure, mode) = (row.structure, row.mode.clone());
        let name = if mode.is_empty() { structure.to_owned() } else { format!("{structure}, {mode}") };
        Self::new(name, move |row| row.structure == structure && row.mode == mode)
    }

    pub(crate) fn rows<'a>(&'a self, mesh: &'a MeshReport) -> impl Iterator<Item = &'a Row> {
        mesh.rows.iter().filter(|row| (self.covers)(row))
    }

    /// Million rays per second, kind by kind; `None` if no row is covered.
    pub(crate) fn speeds(&self, mesh: &MeshReport) -> Option<[f64; 3]> {
        let speeds = self.rows(mesh).map(|row| row.outcomes.map(|outcome| outcome.best));
        speeds.reduce(|a, b| std::array::from_fn(|kind| a[kind].max(b[kind])))
    }

    /// Million rays per second of one of the integrator's sets of rays; `None` if no row is covered.
    pub(crate) fn wavefront_speed(&self, mesh: &MeshReport, set: usize) -> Option<f64> {
        self.rows(mesh).map(|row| row.wavefronts[set].best).reduce(f64::max)
    }

    fn mean_speed(&self, meshes: &[MeshReport]) -> f64 {
        geometric_mean(meshes.iter().filter_map(|mesh| self.speeds(mesh)).flatten()).unwrap_or(0.0)
    }
}

/// The lines of the table of speeds: every mode of this library and of the crates, and the best modes of
/// Embree.
pub(crate) fn lines(meshes: &[MeshReport]) -> Vec<Line> {
    let rows = meshes.first().into_iter().flat_map(|mesh| &mesh.rows);
    let mut lines: Vec<_> = rows.filter(|row| !row.family.is_embree()).map(Line::of).collect();
    lines.extend(embree_lines());
    lines
}

fn embree_lines() -> [Line; 2] {
    [
        Line::new("Embree, best robust", |row| row.family == Family::EmbreeRobust),
        Line::new("Embree, best of all", |row| row.family.is_embree()),
    ]
}

/// What the integrator's rays are reported for: this library's fastest structure in batches, and its peers.
pub(crate) fn wavefront_lines(meshes: &[MeshReport]) -> Vec<Line> {
    best(Family::OursBatch, meshes).into_iter().chain(peer_lines()).collect()
}

fn peer_lines() -> impl Iterator<Item = Line> {
    let crates = Line::new("fastest Rust crate", |row| row.family == Family::RustCrate);
    embree_lines().into_iter().chain([crates])
}

/// A line for each structure, over all its modes.
pub(crate) fn structures(meshes: &[MeshReport]) -> Vec<Line> {
    let rows = meshes.first().into_iter().flat_map(|mesh| &mesh.rows);
    let mut names: Vec<_> = rows.map(|row| row.structure).collect();
    names.dedup();
    names.into_iter().map(|name| Line::new(name, move |row| row.structure == name)).collect()
}

/// The speed of one line divided by that of another.
#[derive(Debug, Serialize)]
pub(crate) struct Ratio {
    pub(crate) ours: String,
    pub(crate) peer: String,
    /// Mesh by mesh, kind by kind.
    pub(crate) by_mesh: Vec<Option<[f64; 3]>>,
    /// Geometric means over the meshes, kind by kind.
    pub(crate) means: Option<[f64; 3]>,
}

/// The ratios of this library's best structure, in batches and ray by ray, to Embree and to the fastest crate.
pub(crate) fn ratios(meshes: &[MeshReport]) -> Vec<Ratio> {
    let peers: Vec<_> = peer_lines().collect();
    let ours = [Family::OursBatch, Family::OursSingle].into_iter().filter_map(|family| best(family, meshes));
    let over = |ours| peers.iter().map(move |peer| ratio(&ours, peer, meshes));
    ours.flat_map(over).collect()
}

/// The line of `family` that is fastest over all meshes and kinds of rays.
fn best(family: Family, meshes: &[MeshReport]) -> Option<Line> {
    let rows = meshes.first()?.rows.iter().filter(|row| row.family == family);
    rows.map(Line::of).max_by(|a, b| a.mean_speed(meshes).total_cmp(&b.mean_speed(meshes)))
}

fn ratio(ours: &Line, peer: &Line, meshes: &[MeshReport]) -> Ratio {
    let over = |mesh| {
        let (a, b) = (ours.speeds(mesh)?, peer.speeds(mesh)?);
        Some(std::array::from_fn(|kind| a[kind] / b[kind]))
    };
    let by_mesh: Vec<Option<[f64; 3]>> = meshes.iter().map(over).collect();
    let mean = |kind: usize| geometric_mean(by_mesh.iter().flatten().map(|ratios| ratios[kind]));
    let [camera, bounce, shadow] = [0, 1, 2].map(mean);
    let means = camera.zip(bounce).zip(shadow).map(|((camera, bounce), shadow)| [camera, bounce, shadow]);
    Ratio { ours: ours.name.clone(), peer: peer.name.clone(), by_mesh, means }
}

/// The geometric mean; `None` if there are no numbers.
fn geometric_mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0), |(sum, count), x| (sum + x.ln(), count + 1));
    (count > 0).then(|| (sum / f64::from(count)).exp())
}

/// The names of the kinds, in the order of the figures of a cell.
pub(crate) fn kinds() -> String {
    Kind::ALL.map(|kind| format!("{kind:?}").to_lowercase()).join(" / ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Differences;

    fn row(family: Family, structure: &'static str, speeds: [f64; 3]) -> Row {
        let build = Build { seconds: 1.0, bytes: None };
        let outcome = |best| Outcome { best, median: best, differences: Differences::default() };
        Row {
            family,
            structure,
            mode: String::new(),
            build,
            outcomes: speeds.map(outcome),
            wavefronts: Vec::new(),
        }
    }

    fn mesh(rows: Vec<Row>) -> MeshReport {
        MeshReport { mesh: "mesh".to_owned(), triangles: 1, rays: [1; 3], wavefronts: Vec::new(), rows }
    }

    #[test]
    fn the_geometric_mean_is_correct() {
        assert_eq!(geometric_mean([].into_iter()), None);
        let mean = geometric_mean([0.5, 2.0, 8.0].into_iter()).expect("three numbers have a mean");
        assert!((mean - 2.0).abs() < 1e-15);
    }

    #[test]
    fn ratios_use_the_best_rows_and_allow_absent_peers() {
        let rows = |scale: f64| {
            vec![
                row(Family::OursBatch, "slow", [scale, 1.0, 1.0]),
                row(Family::OursBatch, "quick", [2.0 * scale, 3.0, 4.0]),
                row(Family::RustCrate, "a", [1.0, 2.0, 1.0]),
                row(Family::RustCrate, "b", [2.0, 1.0, 1.0]),
            ]
        };
        let ratios = ratios(&[mesh(rows(1.0)), mesh(rows(4.0))]);
        assert_eq!(ratios.len(), 3, "there are no single-ray entries");
        assert!(ratios.iter().all(|ratio| ratio.ours == "quick"));
        assert_eq!(ratios[0].means, None, "Embree is absent");
        assert_eq!(ratios[2].by_mesh, [Some([1.0, 1.5, 4.0]), Some([4.0, 1.5, 4.0])]);
        let [camera, ..] = ratios[2].means.expect("the crates are there");
        assert!((camera - 2.0).abs() < 1e-15);
    }

    #[test]
    fn every_structure_has_one_line() {
        let rows = || ["a", "a", "b", "c", "c"].map(|name| row(Family::OursBatch, name, [1.0; 3])).into();
        let names: Vec<_> = structures(&[mesh(rows()), mesh(rows())]).into_iter().map(|l| l.name).collect();
        assert_eq!(names, ["a", "b", "c"]);
    }
}
