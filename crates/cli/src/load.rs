use crate::console::warn;
use crate::interrupt::{Interrupt, NOTHING};
use anyhow::{Result, ensure};
use globillum::geom::Triangle;
use globillum::io::{IoError, LoadMonitor, LoadReport, Loaded, Loader, Warning, WarningKind};
use std::mem::discriminant;
use std::path::Path;

/// Which of a file's warnings are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Warnings {
    All,
    /// The first of each kind, and how many follow.
    FirstOfEachKind,
}

/// Loads a scene by `loader` unless a signal comes, and warns of what was left out; the caller says so if there
/// are no lights. Fails for a folder.
pub(crate) fn load(
    path: &Path,
    loader: Loader<'_>,
    warnings: Warnings,
    interrupt: &Interrupt,
) -> Result<Loaded> {
    ensure!(!path.is_dir(), "{}: is a folder, not a scene file", path.display());
    let loaded = match loader.monitor(interrupt as &dyn LoadMonitor).load(path) {
        Err(IoError::Cancelled { .. }) => return Err(interrupt.error(NOTHING).into()),
        loaded => loaded?,
    };
    lines(&loaded.report, warnings).iter().for_each(warn);
    Ok(loaded)
}

/// Loads the triangles of a file whose materials do not matter, and warns of what was left out.
///
/// # Errors
/// Those of [`globillum::io::load`].
pub fn load_mesh(path: &Path) -> Result<Vec<Triangle>> {
    let loaded = globillum::io::load(path)?;
    lines(&loaded.report, Warnings::All).iter().for_each(warn);
    Ok(loaded.model.triangles().to_vec())
}

/// The warnings of a file, one a line, except that it has no lights.
fn lines(report: &LoadReport, warnings: Warnings) -> Vec<String> {
    let mut groups: Vec<(&Warning, usize)> = Vec::new();
    for warning in report.warnings.iter().filter(|warning| warning.kind != WarningKind::NoLight) {
        let group = groups.iter_mut().find(|(first, _)| is_same_kind(&first.kind, &warning.kind));
        match group.filter(|_| warnings == Warnings::FirstOfEachKind) {
            Some((_, count)) => *count += 1,
            None => groups.push((warning, 1)),
        }
    }
    let line = |(first, count): (&Warning, usize)| match count {
        1 => first.to_string(),
        _ => format!("{first} (first of {count} such warnings; --verbose lists all)"),
    };
    groups.into_iter().map(line).collect()
}

/// Whether two warnings differ in names of materials, counts and places at most.
fn is_same_kind(a: &WarningKind, b: &WarningKind) -> bool {
    match (a, b) {
        (WarningKind::Approximated { by: a, .. }, WarningKind::Approximated { by: b, .. }) => a == b,
        // Few extensions are ignored in a file, and one may matter more than another.
        (WarningKind::ExtensionIgnored { name: a }, WarningKind::ExtensionIgnored { name: b }) => a == b,
        _ => discriminant(a) == discriminant(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Warnings of a library: two kinds, one of them with two outcomes.
    fn report(folder: &Path) -> LoadReport {
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let mtl =
            "newmtl a\nmap_Kd a.png\nKd 1\nnewmtl b\nmap_Kd b.png\nKd 1\nKs 1\nnewmtl c\nd 0.5\nKd 1\nKs 1\n";
        for (name, content) in [("a.obj", obj), ("a.mtl", mtl)] {
            std::fs::write(folder.join(name), content).expect("an empty folder can be filled");
        }
        globillum::io::load(folder.join("a.obj")).expect("it is well-formed").report
    }

    #[test]
    fn each_kind_is_one_line_with_its_count_and_its_first_place() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let report = report(folder.path());
        let shown = |warnings| {
            let place = format!("{}/", folder.path().display());
            lines(&report, warnings).iter().map(|line| line.replace(&place, "")).collect::<Vec<_>>()
        };
        assert_eq!(
            shown(Warnings::FirstOfEachKind),
            [
                "a.mtl:1: textures of material `a` are ignored; one of colours counts as grey 0.5 (first of 2 such warnings; --verbose lists all)",
                "a.mtl:4: material `b` is approximated by an ideal diffuse surface \
                 (first of 2 such warnings; --verbose lists all)",
                "a.mtl:8: transparency of material `c` is ignored: it is opaque",
            ]
        );
        assert_eq!(
            shown(Warnings::All),
            [
                "a.mtl:1: textures of material `a` are ignored; one of colours counts as grey 0.5",
                "a.mtl:4: textures of material `b` are ignored; one of colours counts as grey 0.5",
                "a.mtl:4: material `b` is approximated by an ideal diffuse surface",
                "a.mtl:8: transparency of material `c` is ignored: it is opaque",
                "a.mtl:8: material `c` is approximated by an ideal diffuse surface",
            ]
        );
    }

    #[test]
    fn outcomes_of_one_kind_are_told_apart() {
        let by = |name: &str, by| WarningKind::Approximated { name: name.into(), by };
        assert!(is_same_kind(&by("a", "an ideal mirror"), &by("b", "an ideal mirror")));
        assert!(!is_same_kind(&by("a", "an ideal mirror"), &by("a", "an ideal diffuse surface")));
        assert!(!is_same_kind(&by("a", "an ideal mirror"), &WarningKind::NoLight));
        let extension = |name: &str| WarningKind::ExtensionIgnored { name: name.into() };
        assert!(
            is_same_kind(&extension("a"), &extension("a")) && !is_same_kind(&extension("a"), &extension("b"))
        );
    }
}
