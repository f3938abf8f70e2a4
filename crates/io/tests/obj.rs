//! Valid and invalid OBJ files.
#![cfg(feature = "obj")]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "a skipped test prints a message")]

use glam::Vec3;
use globillum_geom::Triangle;
use globillum_io::{IoError, Loaded, Loader, Place, WarningKind, load_obj};
use globillum_material::{Emission, Material, Rgb, Sides};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// The corners of a unit square. Line 5 is the first line after them.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

const CORNERS: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

struct Files(TempDir);

impl Files {
    fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self) -> Result<Loaded, IoError> {
        load_obj(self.path("a.obj"))
    }
}

fn load(obj: impl AsRef<[u8]>) -> Result<Loaded, IoError> {
    Files::new(&[("a.obj", obj.as_ref())]).load()
}

/// Loads a square with the material `m` of the library `mtl`.
fn load_with(mtl: &str) -> Result<Loaded, IoError> {
    let obj = format!("mtllib a.mtl\nusemtl m\n{SQUARE}f 1 2 3 4\n");
    Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).load()
}

#[test]
fn several_libraries_may_be_named_at_once_and_again() {
    let obj =
        format!("mtllib a.mtl b c.mtl no.mtl\nmtllib b c.mtl\nmtllib b c.mtl\n{SQUARE}usemtl n\nf 1 2 3\n");
    let files =
        Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", b"newmtl m\n"), ("b c.mtl", b"newmtl n\n")]);
    let missing = |name: &str| (Place::Line(1), WarningKind::MissingLibrary { name: name.into() });
    let expected = [missing("b"), missing("c.mtl"), missing("no.mtl")];
    assert_eq!(warnings(&files.load().unwrap()), expected);
}

/// All names together are longer than a file system allows a name to be.
#[test]
fn many_libraries_may_be_named_at_once() {
    let names: Vec<String> = (0..100).map(|i| format!("library{i}.mtl")).collect();
    let obj = format!("mtllib {}\n{SQUARE}usemtl m\nf 1 2 3 4\n", names.join(" "));
    let libraries = names.iter().map(|name| (name.as_str(), &b"# empty"[..]));
    let mut files: Vec<_> = libraries.chain([("a.obj", obj.as_bytes())]).collect();
    files[99].1 = b"newmtl m\nKd 1\n";
    let loaded = Files::new(&files).load().unwrap();
    assert_eq!(warnings(&loaded), []);
    assert_eq!(*loaded.model.material(0), Material::lambert(Rgb::WHITE).unwrap());
}

/// The corners of the triangles of these faces, as indices of [`CORNERS`].
fn faces(faces: &str) -> Vec<[usize; 3]> {
    let loaded = load(format!("{SQUARE}{faces}")).unwrap();
    assert_eq!(warnings(&loaded), []);
    let index = |v| CORNERS.iter().position(|c| *c == v).unwrap();
    loaded.model.triangles().iter().map(|t| t.vertices.map(index)).collect()
}

/// All warnings except [`WarningKind::NoLight`].
fn warnings(loaded: &Loaded) -> Vec<(Place, WarningKind)> {
    let warnings = loaded.report.warnings.iter().filter(|w| w.kind != WarningKind::NoLight);
    warnings.map(|w| (w.at.place, w.kind.clone())).collect()
}

/// The error's message, from the file name on.
fn message(result: Result<Loaded, IoError>) -> String {
    let message = result.unwrap_err().to_string();
    assert_eq!(message.lines().count(), 1);
    message[message.find("a.obj").or(message.find("a.mtl")).unwrap()..].to_owned()
}

#[test]
fn polygons_become_fans_in_the_order_of_the_file() {
    assert_eq!(faces("f 1 2 3 4\nf 4 3 2"), [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
}

#[test]
fn indices_may_be_negative_and_have_companions() {
    assert_eq!(faces("f -4 -3 -2"), [[0, 1, 2]]);
    let loaded = load(format!("{SQUARE}vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1")).unwrap();
    assert_eq!(loaded.model.triangles(), [Triangle::new(CORNERS[0], CORNERS[1], CORNERS[2])]);
    assert_eq!(warnings(&loaded), [(Place::Line(6), WarningKind::NormalsIgnored { count: 1 })]);
    assert_eq!(faces("f 1/ 2// 3"), [[0, 1, 2]]);
    // Nothing reads texture coordinates and normals, so their indices may be out of range.
    assert_eq!(faces("f 1/9/-9 2//0 3/0"), [[0, 1, 2]]);
    assert_eq!(faces("vt 0 0\nf 1/1/ 2//  3//"), [[0, 1, 2]]);
    // Negative indices count back from the face, not from the end of the file.
    assert_eq!(faces("f -4 -3 -2\nv 0 0 0"), [[0, 1, 2]]);
}

#[test]
fn line_ends_marks_tabs_and_continuations_do_not_matter() {
    let obj = format!("{SQUARE}f 1 2 3\n");
    let expected = load(&obj).unwrap().model;
    let variants = [
        obj.replace('\n', "\r\n"),
        format!("\u{feff}{obj}"),
        obj.replace(' ', "\t"),
        obj.replace("f 1 2 3", "  f 1 \\\n 2 \\\n 3"),
        obj.replace("f 1 2 3", "f 1 \\\r\n2 3\r"),
        format!("# C:\\\n  # C:\\\n{}", obj.replace("0\n", "0 # C:\\\n")),
    ];
    for variant in variants {
        assert_eq!(load(&variant).unwrap().model, expected, "{variant:?}");
    }
}

#[test]
fn weights_divide_and_colours_are_counted() {
    let expected = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
    for (obj, colours) in [
        ("v 0 0 0 1\nv 2 0 0 2\nv 0 1 0\nf 1 2 3", None),
        (
            "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1 1 1\nf 1 2 3",
            Some(WarningKind::ColorsIgnored { count: 2 }),
        ),
    ] {
        let loaded = load(obj).unwrap();
        assert_eq!(loaded.model.triangles(), [expected]);
        assert!(warnings(&loaded).into_iter().eq(colours.map(|kind| (Place::Line(2), kind))), "{obj}");
    }
}

#[test]
fn lines_and_points_are_no_triangles() {
    let loaded = load(format!("{SQUARE}f 1 2 3\nl 1 2 3\np 1\nl 1 2 3 4\n")).unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
    assert_eq!(warnings(&loaded), [(Place::Line(6), WarningKind::NotTriangles { count: 3 })]);
}

#[test]
fn free_form_curves_and_surfaces_are_counted() {
    let curves = "cstype bezier\ndeg 3 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\n";
    let surface = "surf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\nend\nvp 0 1\ncurv2 1\nend\nbzp 1 2 3 4\n";
    let loaded = load(format!("{SQUARE}f 1 2 3\n{curves}{surface}")).unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
    assert_eq!(warnings(&loaded), [(Place::Line(8), WarningKind::FreeFormIgnored { count: 4 })]);
    let text = loaded.report.warnings[0].to_string();
    assert!(text.ends_with("a.obj:8: free-form curves and surfaces are skipped: 4"), "{text}");
}

#[test]
fn statements_of_no_meaning_are_counted() {
    let unknown = |keyword: &str, count| WarningKind::UnknownStatements { keyword: keyword.into(), count };
    let loaded = load(format!("{SQUARE}fo 1 2 3\nf 1 2 3\nF 1 3 4\ncall b.obj\n")).unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
    assert_eq!(warnings(&loaded), [(Place::Line(5), unknown("fo", 3))]);
    let text = loaded.report.warnings[0].to_string();
    assert!(text.ends_with("a.obj:5: unknown statements are ignored, first `fo`: 3"), "{text}");
    let loaded = load_with("newmtl n\nkd 1 1 1\nnewmtl m\nKd 1 0 0\nKE 1 1 1\n").unwrap();
    assert_eq!(warnings(&loaded), [(Place::Line(2), unknown("kd", 2))]);
    let text = load("ply\nformat ascii 1.0\n").unwrap_err().to_string();
    assert!(text.contains("unknown statements are ignored, first `ply`: 2"), "{text}");
}

#[test]
fn statements_without_effect_are_known() {
    let obj = "vt 0 0\no a\ng a b\ns off\nvp 0 1\ncstype bezier\ndeg 3 3\nbmat u 1 0 0 1\nstep 1 1\nparm u 0 1\n\
        trim 0 1 1\nhole 0 1 1\nscrv 0 1 1\nsp 1\nend\ncon 1 0 1 1 2 0 1 1\nmg 1 0.5\nres 1 1\nctech cparm 1\n\
        stech cparma 1 1\nbevel on\nc_interp on\nd_interp on\nlod 1\nusemap off\nmaplib a\nshadow_obj a\n\
        trace_obj a\n";
    assert_eq!(warnings(&load(format!("{SQUARE}f 1 2 3\n{obj}")).unwrap()), []);
    let mtl = "newmtl m\nKd 1 0 0\nKa 1 1 1\nKm 0\nNi 1\nNs 10\nPc 0\nPcr 0\nPs 0\nTf 1 1 1\naniso 0\nanisor 0\n\
        sharpness 60\nillum 2\nd 1\n";
    assert_eq!(warnings(&load_with(mtl).unwrap()), []);
}

#[test]
fn short_faces_are_skipped_and_counted() {
    let loaded = load(format!("{SQUARE}f 1 2\nf 1 2 3\nf 1\n")).unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
    assert_eq!(warnings(&loaded), [(Place::Line(5), WarningKind::ShortFaces { count: 2 })]);
    let text = loaded.report.warnings[0].to_string();
    assert!(text.ends_with("a.obj:5: faces with fewer than three vertices are skipped: 2"), "{text}");
}

#[test]
fn malformed_lines_are_named() {
    let cases = [
        ("v 1 2", "v: expected 3, 4 or 6 numbers"),
        ("v 1 2 3 4 5", "v: expected 3, 4 or 6 numbers"),
        ("v 1 2 3 4 5 6 7", "v: expected 3, 4 or 6 numbers"),
        ("v 1 2 x", "v: `x` is not a number"),
        ("v 1 2 3 0", "v: weight is zero"),
        ("v 0 nan 0", "coordinate is not finite in single precision"),
        ("v 0 0 -inf", "coordinate is not finite in single precision"),
        ("v 0 0 1e999", "coordinate is not finite in single precision"),
        ("v 1 1 1 1e-45", "coordinate is not finite in single precision"),
        ("f", "f: expected at least three vertices"),
        ("f a b c", "f: `a` is not a number"),
        ("f 1 2 99999999999999999999", "f: `99999999999999999999` is not a number"),
        ("f 1/1/1/1 2 3", "f: a vertex has more indices than v/vt/vn"),
        ("f 1/x 2 3", "f: `x` is not a number"),
        ("f 1////1 2 3", "f: a vertex has more indices than v/vt/vn"),
        ("f /1 2 3", "f: expected a number"),
        ("f 1 2 0", "index 0 is out of range (vertices above: 4)"),
        ("f 1 2 5", "index 5 is out of range (vertices above: 4)"),
        ("f 1 2 -5", "index -5 is out of range (vertices above: 4)"),
        ("mtllib", "mtllib: expected a name"),
    ];
    for (line, expected) in cases {
        let result = load(format!("{SQUARE}{line}\nf 1 2 3\n"));
        assert_eq!(message(result), format!("a.obj:5: {expected}"), "{line}");
    }
}

#[test]
fn a_continued_line_keeps_the_count() {
    assert_eq!(message(load("v 0 \\\n 0 \\\n 0\nv x 0 0\n")), "a.obj:4: v: `x` is not a number");
}

#[test]
fn files_without_a_face_are_empty() {
    for obj in ["\n", "# nothing\n", SQUARE, "\u{feff}"] {
        assert_eq!(message(load(obj)), "a.obj: scene has no triangles");
    }
    let skipped = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\nl 1 2\np 1\nf 1 2\ncurv 0 1 1 2\nvn 0 0 1\n";
    let expected = "a.obj: scene has no triangles (faces with fewer than three vertices are skipped: 1; \
        primitives of points or lines are skipped: 2; free-form curves and surfaces are skipped: 1; \
        degenerate triangles are dropped: 2)";
    assert_eq!(message(load(skipped)), expected);
}

#[test]
fn bytes_that_are_not_utf8_are_replaced() {
    let obj = [SQUARE.as_bytes(), b"mtllib a.mtl\nusemtl Gr\xfcn\xfc\xe4\nf 1 2 3\n"].concat();
    let mtl = b"# fine\nnewmtl Gr\xfcn\xfc\xe4\nKd 1\nmap_Kd Gr\xfcn.png\n";
    let loaded = Files::new(&[("a.obj", &obj), ("a.mtl", mtl)]).load().unwrap();
    assert_eq!(*loaded.model.material(0), Material::lambert(Rgb::splat(0.5)).unwrap());
    let textured = WarningKind::TexturesIgnored { name: "Gr\u{fffd}n\u{fffd}".into() };
    let expected = [
        (Place::Line(6), WarningKind::NotUtf8 { count: 3 }),
        (Place::Line(2), WarningKind::NotUtf8 { count: 4 }),
        (Place::Line(2), textured),
    ];
    assert_eq!(warnings(&loaded), expected);
}

#[test]
fn a_missing_file_is_named() {
    let error = load_obj("no/such.obj").unwrap_err();
    assert!(error.to_string().starts_with("no/such.obj: cannot be read: "), "{error}");
}

#[test]
fn faces_without_a_material_are_grey() {
    let model = load(format!("{SQUARE}f 1 2 3\n")).unwrap().model;
    assert_eq!(*model.material(0), Material::lambert(Rgb::splat(0.5)).unwrap());
}

#[test]
fn materials_mean_what_they_say() {
    // tobj reads colours as `f32`.
    let lambert = |r: f32, g: f32, b: f32| Material::lambert([r, g, b].map(f64::from).into()).unwrap();
    let mirror = |x: f32| Material::mirror(Rgb::splat(x.into())).unwrap();
    let light = Emission::new(Rgb::new(9.0, 8.0, 7.0), Sides::Front).unwrap();
    let cases = [
        ("Kd 0.1 0.2 0.3", lambert(0.1, 0.2, 0.3)),
        ("Kd 0.5", lambert(0.5, 0.5, 0.5)),
        ("Kd 0.1 0.2 0.3\nKs 0.9 0.9 0.9\nillum 2", lambert(0.1, 0.2, 0.3)),
        ("Kd 0.1 0.2 0.3\nKs 0.9 0.9 0.9\nillum 3", mirror(0.9)),
        ("Ks 0.9 0.9 0.9", mirror(0.9)),
        ("Ka 7 7 7\nNs 96\nd 1", lambert(0.5, 0.5, 0.5)),
        ("Kd 0\nKe 9 8 7", lambert(0.0, 0.0, 0.0).emitting(light)),
    ];
    for (mtl, expected) in cases {
        let loaded = load_with(&format!("newmtl m\n{mtl}\n")).unwrap();
        assert_eq!(*loaded.model.material(0), expected, "{mtl}");
    }
}

#[test]
fn mirrors_are_those_of_the_table_in_the_documentation() {
    let cases = [
        // Blender writes the metal's colour as `Kd` and a `Ks` of one half for every material.
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 2", false, [0.75, 0.5, 0.25]),
        ("Ks 0.5\nillum 2\nmap_Kd a.png", false, [0.5; 3]),
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 3", true, [0.75, 0.5, 0.25]),
        ("Kd 0.125\nKs 0.5\nillum 3", true, [0.125; 3]),
        // A texture that is not read counts as a grey of one half.
        ("Kd 0.75 0.5 0.25\nmap_Kd a.png", false, [0.375, 0.25, 0.125]),
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 3\nmap_Kd a.png", true, [0.375, 0.25, 0.125]),
        ("Kd 0.75 0.5 0.25\nKs 1\nillum 3", true, [0.75, 0.5, 0.25]),
        ("Ks 0.5\nillum 3\nmap_Kd a.png", true, [0.5; 3]),
        // The extension for physically based materials is read as glTF's factors are.
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 3\nPr 0.125\nPm 1", true, [0.75, 0.5, 0.25]),
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 3\nPm 1\nPr 1", false, [0.75, 0.5, 0.25]),
        ("Kd 0.75 0.5 0.25\nKs 0.5\nillum 3\nPm 0.25\nPr 0.125", true, [0.75, 0.5, 0.25]),
        ("Kd 0.75 0.5 0.25\nPm 0.75", true, [0.75, 0.5, 0.25]),
        ("Kd 0.75 0.5 0.25\nPm 0.25", false, [0.75, 0.5, 0.25]),
        ("Ks 0.5\nillum 3\nPm 1\nPr 0\nmap_Kd a.png", true, [0.5; 3]),
        ("Kd 0.75 0.5 0.25\nPm 1\nPr 0\nmap_Pr a.png", false, [0.75, 0.5, 0.25]),
        ("Kd 0.75 0.5 0.25\nmap_Pm a.png\nPm 1\nPr 0", false, [0.75, 0.5, 0.25]),
        // Mirrors in other files.
        ("Ks 0.75", true, [0.75; 3]),
        ("Kd 0\nKs 0.25\nillum 3", true, [0.25; 3]),
        ("Kd 0.25\nKs 0.75\nillum 3", true, [0.75; 3]),
        ("Kd 0.25\nKs 0\nillum 3", false, [0.25; 3]),
        ("Kd 0.25\nillum 3", false, [0.25; 3]),
    ];
    for (mtl, is_mirror, colour) in cases {
        let colour = Rgb::from(colour);
        let expected = if is_mirror { Material::mirror(colour) } else { Material::lambert(colour) };
        let loaded = load_with(&format!("newmtl m\n{mtl}\n")).unwrap();
        assert_eq!(*loaded.model.material(0), expected.unwrap(), "{mtl}");
        let textured = WarningKind::TexturesIgnored { name: "m".into() };
        let says_so = warnings(&loaded).contains(&(Place::Line(1), textured));
        assert_eq!(says_so, mtl.contains("map_"), "{mtl}");
    }
}

/// `Pm` and `Pr` decide alone, as in glTF; without them `Kd` beside `Ks`.
#[test]
fn only_ideal_materials_are_not_approximated() {
    for (mtl, approximated) in [
        ("Kd 0.75\nKs 0.5\nillum 3\nPr 0\nPm 1", false),
        ("Kd 0.75\nKs 0.5\nPr 1\nPm 0", false),
        ("Kd 0.75\nKs 0\nillum 1\nPr 0.25\nPm 1", true),
        ("Kd 0.75\nKs 0\nPr 0.125\nPm 0", true),
        ("Kd 0\nPr 0.125\nPm 0", false),
        ("Pr 0.125\nPm 0", true),
        ("Kd 0.75\nPr 0\nPm 1\nmap_Pr a.png", true),
        ("Kd 0.75\nKs 0.5", true),
        ("Kd 0.75\nKs 0", false),
    ] {
        let loaded = load_with(&format!("newmtl m\n{mtl}\n")).unwrap();
        let is_it = |(_, kind): &(Place, WarningKind)| matches!(kind, WarningKind::Approximated { .. });
        assert_eq!(warnings(&loaded).iter().any(is_it), approximated, "{mtl}");
    }
}

/// A texture of emission is mostly black where nothing shines.
#[test]
fn what_a_texture_defines_does_not_shine() {
    for (mtl, says_so) in
        [("Ke 1\nmap_Ke a.png", true), ("map_Ke a.png", true), ("Ke 0\nmap_Ke a.png", false), ("Ke 1", false)]
    {
        let loaded = load_with(&format!("newmtl m\n{mtl}\n")).unwrap();
        assert_eq!(loaded.model.material(0).emission == Emission::NONE, mtl != "Ke 1", "{mtl}");
        let ignored = (Place::Line(1), WarningKind::EmissionIgnored { name: "m".into() });
        assert_eq!(warnings(&loaded).contains(&ignored), says_so, "{mtl}");
    }
}

#[test]
fn a_light_too_dim_for_f32_is_not_lost() {
    let message = message(load_with("newmtl m\nKe 0 1e-46 0\n"));
    assert_eq!(message, "a.mtl:2: Ke: `1e-46` is too small for `f32`");
}

#[test]
fn impossible_or_malformed_materials_are_named() {
    let cases = [
        ("Kd", "a.mtl:2: Kd: expected 1 or 3 numbers"),
        ("Kd 1 2", "a.mtl:2: Kd: expected 1 or 3 numbers"),
        ("Kd x", "a.mtl:2: Kd: `x` is not a number"),
        ("illum", "a.mtl:2: illum: expected a number"),
        ("Pm", "a.mtl:2: Pm: expected a number"),
        ("Pm 7", "a.mtl:2: Pm: `7` is not within [0, 1]"),
        ("Pr nan", "a.mtl:2: Pr: `nan` is not within [0, 1]"),
        ("Kd 5 5 5", "a.mtl:2: material `m`: reflectance (5, 5, 5) is not within [0, 1]"),
        ("Kd -1 0 0", "a.mtl:2: material `m`: reflectance (-1, 0, 0) is not within [0, 1]"),
        ("Kd nan", "a.mtl:2: material `m`: reflectance (NaN, NaN, NaN) is not within [0, 1]"),
        (
            "Ke -1",
            "a.mtl:2: material `m`: radiance (-1, -1, -1) has a component that is neither 0 nor within [1e-50, 1e50]",
        ),
    ];
    for (mtl, expected) in cases {
        assert_eq!(message(load_with(&format!("newmtl m\n{mtl}\n"))), expected);
    }
}

#[test]
fn materials_change_within_a_file_without_a_change_of_order() {
    let mtl = b"newmtl a b\nKd 0.25\nnewmtl c\nKd 0.75\n";
    let obj = format!(
        "mtllib m.mtl\n{SQUARE}f 1 2 3\nusemtl a b\nf 2 3 4\ng part\nusemtl c\nf 3 4 1\nusemtl a b\nf 4 1 2\n"
    );
    let model = Files::new(&[("a.obj", obj.as_bytes()), ("m.mtl", mtl)]).load().unwrap().model;
    let firsts: Vec<_> = model.triangles().iter().map(|t| t.vertices[0]).collect();
    assert_eq!(firsts, CORNERS);
    let greys = [0.5, 0.25, 0.75, 0.25].map(|x| Material::lambert(Rgb::splat(x)).unwrap());
    assert_eq!([0, 1, 2, 3].map(|i| *model.material(i)), greys);
}

#[test]
fn what_is_missing_or_ignored_is_warned_of() {
    let obj = format!("mtllib none.mtl\nmtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\nusemtl lost\nf 1 2 3\n");
    let mtl = b"Kd 1\nnewmtl m\nmap_Kd wood.png\nbump b.png\nnewmtl m\nKd 1\n";
    let loaded = Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).load().unwrap();
    let warnings: Vec<_> = loaded.report.warnings.iter().map(ToString::to_string).collect();
    let expected = [
        "a.obj:1: material library `none.mtl` does not exist",
        "a.mtl:2: textures of material `m` are ignored; one of colours counts as grey 0.5",
        "a.mtl:5: material `m` is redefined; the last definition is used",
        "a.mtl:1: unknown statements are ignored, first `Kd`: 1",
        "a.obj:9: material `lost` is not defined; grey is used instead",
        "a.obj: scene has no lights",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.ends_with(expected), "{warning}");
    }
    assert_eq!(*loaded.model.material(0), Material::lambert(Rgb::WHITE).unwrap());
}

#[test]
fn a_material_may_have_no_name() {
    let grey = |x| Material::lambert(Rgb::splat(x)).unwrap();
    let obj = |mtl: &str| {
        let obj = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\nusemtl \nf 1 2 3\n");
        Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).load().unwrap()
    };
    let undefined = obj("newmtl m\nKd 0.25\n");
    assert_eq!([0, 1].map(|i| *undefined.model.material(i)), [0.25, 0.5].map(grey));
    let text = undefined.report.warnings[0].to_string();
    assert!(text.ends_with("a.obj:8: usemtl has no name; grey is used instead"), "{text}");
    let defined = obj("newmtl m\nKd 0.25\nnewmtl\nKd 0.75\n");
    assert_eq!([0, 1].map(|i| *defined.model.material(i)), [0.25, 0.75].map(grey));
    assert_eq!(warnings(&defined), []);
}

#[test]
fn libraries_lie_in_the_files_own_folder() {
    for name in ["../a.mtl", "sub/../../a.mtl", "/etc/passwd", r"..\a.mtl", r"\etc\passwd"] {
        let expected = format!("a.obj:1: `{}` is outside the scene's folder", name.replace('\\', "/"));
        assert_eq!(message(load(format!("mtllib {name}\n{SQUARE}f 1 2 3\n"))), expected);
    }
    for name in ["sub/a m.mtl", r".\sub\a m.mtl", r"b\m.mtl"] {
        let obj = format!("mtllib {name}\nusemtl m\n{SQUARE}f 1 2 3\n");
        let files = Files::new(&[("a.obj", obj.as_bytes()), (r"b\m.mtl", b"newmtl m\n")]);
        fs::create_dir(files.path("sub")).unwrap();
        fs::write(files.path("sub/a m.mtl"), "newmtl m\nKd 1\n").unwrap();
        assert_eq!(warnings(&files.load().unwrap()), [], "{name}");
    }
}

/// The triangles of a text of `v` and `f` statements with plain indices, read in the plainest way.
fn triangles(obj: &str) -> Vec<Triangle> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for line in obj.lines() {
        let words = || line.split_whitespace().skip(1);
        match line.split_whitespace().next() {
            Some("v") => {
                let numbers: Vec<f32> = words().map(|word| word.parse().unwrap()).collect();
                vertices.push(Vec3::from_slice(&numbers));
            }
            Some("f") => {
                let count = vertices.len() as i64;
                let index = |i: i64| if i < 0 { count + i } else { i - 1 } as usize;
                let face: Vec<_> = words().map(|word| vertices[index(word.parse().unwrap())]).collect();
                triangles.extend((2..face.len()).map(|i| Triangle::new(face[0], face[i - 1], face[i])));
            }
            _ => {}
        }
    }
    triangles.retain(|triangle| !triangle.is_degenerate());
    triangles
}

#[test]
fn triangles_are_those_of_a_plain_reader() {
    let polygons = format!("{SQUARE}v 0.125 -2e-3 +7.\nf 1 2 3 4\nf -1 -2 -3\nf 1 2 3 5 4\n");
    // More corners than tobj reads into one mesh, with a polygon in between.
    let vertices: String =
        (0..9000).map(|i| format!("v {} {}.{i} {:e}\n", i % 97, i % 89, i as f32)).collect();
    let face = |i: i32| format!("f {} {} {}\n", i % 8999 + 1, -1 - i % 8000, i % 77 + 1);
    let faces: String = (0..40_000).map(face).collect();
    let many = format!("{vertices}{faces}f 1 2 3 4 5\n{faces}");
    let bunny = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes/bunny.obj"));
    let bunny =
        fs::read_to_string(&bunny).inspect_err(|_| eprintln!("SKIPPED: {} is not there", bunny.display()));
    for obj in [polygons, many].into_iter().chain(bunny) {
        let (loaded, expected) = (load(&obj).unwrap(), triangles(&obj));
        assert!(!expected.is_empty());
        // `==` does not tell the zeros apart.
        let bits = |triangles: &[Triangle]| -> Vec<_> {
            triangles.iter().flat_map(|t| t.vertices.map(|v| v.to_array().map(f32::to_bits))).collect()
        };
        assert_eq!(bits(loaded.model.triangles()), bits(&expected));
    }
}

/// Whether a polygon of these corners in the plane y = 0 is loaded without a warning that it is not convex.
fn is_convex(corners: &[[f32; 2]]) -> bool {
    let vertices: String = corners.iter().map(|[x, z]| format!("v {x} 0 {z}\n")).collect();
    let face: String = (0..corners.len()).map(|i| format!(" {}", i + 5)).collect();
    let loaded = load(format!("{SQUARE}{vertices}f 1 2 3\nf{face}\n")).unwrap();
    !warnings(&loaded).iter().any(|(_, kind)| matches!(kind, WarningKind::NonConvex { .. }))
}

#[test]
fn darts_bow_ties_and_stars_are_not_convex() {
    let star = [0.0, 144.0, 288.0, 72.0, 216.0_f32].map(|a| a.to_radians().sin_cos().into());
    let odd: [&[[f32; 2]]; 5] = [
        &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
        &[[0.0, 0.0], [2.0, 2.0], [0.0, 1.0], [-2.0, 2.0]],
        &[[2.0, 2.0], [0.0, 1.0], [-2.0, 2.0], [0.0, 0.0]],
        &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]],
        &star,
    ];
    for corners in odd {
        assert!(!is_convex(corners), "{corners:?}");
    }
}

#[test]
fn squares_regular_polygons_and_straight_corners_are_convex() {
    let decagon = std::array::from_fn::<_, 10, _>(|i| (36.0 * i as f32).to_radians().sin_cos().into());
    let even: [&[[f32; 2]]; 5] = [
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        &[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        &decagon,
    ];
    for corners in even {
        assert!(is_convex(corners), "{corners:?}");
    }
}

/// The first warning about a square light at `(x, y, 0)` below a ceiling at y = 1. `half` is half its side.
fn warning_about_light(x: f64, y: f64, half: f64) -> Option<WarningKind> {
    let square = |x: f64, y: f64, half: f64| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        corners.map(|[dx, dz]| format!("v {} {y} {}\n", x + dx * half, dz * half)).concat()
            + "f -4 -3 -2 -1\n"
    };
    let room = square(0.0, 1.0, 1.0) + &square(0.0, -1.0, 1.0);
    let obj = format!("mtllib a.mtl\n{room}usemtl m\n{}", square(x, y, half));
    let files = Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", b"newmtl m\nKe 1\n")]);
    files.load().unwrap().report.warnings.first().map(|warning| warning.kind.clone())
}

#[test]
fn lights_that_overlap_a_triangle_in_their_plane_are_reported() {
    let expected = Some(WarningKind::CoplanarLights { count: 2 });
    assert_eq!(warning_about_light(0.1, 1.0, 0.3), expected);
    assert_eq!(warning_about_light(0.1, 0.995, 0.3), None);
    assert_eq!(warning_about_light(2.0, 1.0, 1.0), None);
}

/// The names and triangles of the objects of an OBJ file, and the number of its triangles.
fn objects(obj: &str) -> (Vec<(String, std::ops::Range<usize>)>, usize) {
    let files = Files::new(&[("a.obj", obj.as_bytes())]);
    let loaded = Loader::new().keep_objects().load(files.path("a.obj")).unwrap();
    let count = loaded.model.triangles().len();
    assert!(files.load().unwrap().objects.is_empty(), "they are kept if asked for");
    (loaded.objects.into_iter().map(|object| (object.name, object.triangles)).collect(), count)
}

#[test]
fn objects_are_what_follows_a_name() {
    let name = |name: &str, triangles| (name.to_owned(), triangles);
    let all = format!(
        "{SQUARE}f 1 2 3 4\no wall east\nf 1 2 3\ng\nf 1 2 3\no none\ng 5\nf 1 1 2\no last\nf 2 3 4\n"
    );
    let expected = [
        name("default", 0..2),
        name("wall east", 2..3),
        name("default", 3..4),
        name("5", 4..4),
        name("last", 4..5),
    ];
    assert_eq!(objects(&all), (expected.to_vec(), 5));
    assert_eq!(objects(&format!("o a\n{SQUARE}f 1 2 3\n")), ([name("a", 0..1)].to_vec(), 1));
}

#[test]
fn materials_have_their_names() {
    let obj = format!(
        "mtllib a.mtl\n{SQUARE}f 1 2 3\nusemtl red wood\nf 1 2 3\nusemtl none\nf 1 2 3\nusemtl red wood\nf 2 3 4\n"
    );
    let files = Files::new(&[
        ("a.obj", obj.as_bytes()),
        ("a.mtl", b"newmtl unused\nKd 1\nnewmtl red wood\nKd 0.5 0 0\n"),
    ]);
    let mut loaded = files.load().unwrap();
    let names: Vec<_> = loaded.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["red wood", "none"]);
    let ids: Vec<_> = (0..4).map(|triangle| loaded.model.material_id(triangle)).collect();
    let [red, none] = [0, 1].map(|at| loaded.materials[at].id);
    assert!(ids[1..] == [red, none, red] && ids[0] != red && ids[0] != none);
    let mirror = Material::mirror(Rgb::splat(0.5)).unwrap();
    loaded.model.set_material(red, mirror);
    assert_eq!(
        [0, 1, 2, 3].map(|triangle| *loaded.model.material(triangle) == mirror),
        [false, true, false, true]
    );
}
