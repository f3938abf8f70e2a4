//! Rows 1 to 41: OBJ and MTL.

use super::{Case, Content, LFS_MESSAGE, LFS_POINTER, Outcome, loaded, refused};

/// The corners of a unit square; what follows starts in line 5.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn obj(row: u32, text: impl Into<Vec<u8>>, outcome: Outcome) -> Case {
    Case::new(row, "a.obj", text, outcome)
}

pub(super) fn cases() -> Vec<Case> {
    [statements(), faces(), files(), libraries(), materials(), sizes()].concat()
}

/// Rows with one bad line, the fifth if not said otherwise.
fn statements() -> Vec<Case> {
    let index = |row, line: &'static str, index: &str, of: &str| {
        (row, line, "Index", format!("5: index {index} is out of range ({of})"))
    };
    let parse = |row, line: &'static str, message: &str| (row, line, "Parse", message.to_owned());
    let not_finite = |row, line: &'static str| {
        (row, line, "NonFinite", "5: coordinate is not finite in single precision".into())
    };
    let lines = [
        index(1, "f 1 2 0", "0", "vertices above: 4"),
        index(2, "f 1 2 5", "5", "vertices above: 4"),
        index(3, "f 1 2 -5", "-5", "vertices above: 4"),
        parse(4, "f 1 2 99999999999999999999", "5: f: `99999999999999999999` is not a number"),
        parse(5, "f a b c", "5: f: `a` is not a number"),
        parse(6, "f", "5: f: expected at least three vertices"),
        parse(9, "vt 0 0\nvn 0 0 1\nf 1/1/1/1 2 3", "7: f: a vertex has more indices than v/vt/vn"),
        parse(10, "v 1 2", "5: v: expected 3, 4 or 6 numbers"),
        parse(11, "v 1 2 3 0", "5: v: weight is zero"),
        not_finite(12, "v 0 nan 0"),
        not_finite(13, "v 0 0 inf"),
        not_finite(14, "v 1e999 0 0"),
        not_finite(15, "v 1 1 1 1e-45"),
        (15, "v 1 1 1e30", "Domain", "5: coordinate 1e30 exceeds 1.1529215e18 in magnitude".into()),
        parse(25, "# \0", "5: text contains a NUL byte"),
    ];
    let case = |(row, line, kind, message)| {
        obj(row, format!("{SQUARE}{line}\nf 1 2 3\n"), refused(kind, format!("a.obj:{message}")))
    };
    lines.map(case).into()
}

/// Rows that load, with a warning or without.
fn faces() -> Vec<Case> {
    let short = |row, face: &str| {
        let outcome = loaded(&["a.obj:5: faces with fewer than three vertices are skipped: 1"]);
        obj(row, format!("{SQUARE}{face}\nf 1 2 3\n"), outcome)
    };
    let flat = |row, text: &str| {
        let outcome = loaded(&["a.obj:5: vertex normals are ignored: 1"]);
        obj(row, format!("{SQUARE}{text}\n"), outcome)
    };
    vec![
        obj(16, format!("{SQUARE}f 1/1 2 3\n"), loaded(&[])),
        obj(17, format!("{SQUARE}f 1//2 2 3\n"), loaded(&[])),
        short(7, "f 1"),
        short(8, "f 1 2"),
        flat(18, "vn 0 0 1\nf 1//1 2 3"),
        flat(19, "vn 0 0 0\nf 1//1 2//1 3//1"),
    ]
}

fn files() -> Vec<Case> {
    let good = format!("{SQUARE}f 1 2 3\n");
    let carriage_returns = "a.obj: lines end in lone carriage returns; save the file with line feeds";
    let replaced = "a.obj:6: bytes that are not UTF-8 are read as U+FFFD: 1";
    let degenerate = "a.obj: scene has no triangles (degenerate triangles are dropped: 1)";
    let empty = || refused("Empty", "a.obj: scene has no triangles");
    vec![
        obj(20, "", refused("Parse", "a.obj: file is empty")),
        obj(20, SQUARE, empty()),
        obj(20, "v 0 0 0\nf 1 1 1\n", refused("Empty", degenerate)),
        obj(21, "# nothing\n", empty()),
        obj(22, good.replace('\n', "\r\n"), loaded(&[])),
        obj(22, good.replace('\n', "\r"), refused("Parse", carriage_returns)),
        obj(23, format!("\u{feff}{good}"), loaded(&[])),
        obj(24, [good.as_bytes(), b"# caf\xe9\n"].concat(), loaded(&[replaced])),
    ]
}

fn libraries() -> Vec<Case> {
    let naming = |row, name: &str, outcome| obj(row, format!("mtllib {name}\n{SQUARE}f 1 2 3\n"), outcome);
    let escape =
        |name: &str| refused("PathEscape", format!("a.obj:1: `{name}` is outside the scene's folder"));
    let no_file = || refused("Reference", "a.obj:1: `a.mtl` cannot be read: is not a regular file");
    vec![
        naming(26, "none.mtl", loaded(&["a.obj:1: material library `none.mtl` does not exist"])),
        naming(27, "../../x.mtl", escape("../../x.mtl")),
        naming(28, "/etc/passwd", escape("/etc/passwd")),
        naming(28, "a.mtl", escape("a.mtl")).beside("a.mtl", Content::Link("/etc/passwd")),
        naming(29, "a.mtl", no_file()).beside("a.mtl", Content::Folder),
        naming(29, "a.mtl", refused("Reference", format!("a.obj:1: `a.mtl` {LFS_MESSAGE}")))
            .beside("a.mtl", Content::Bytes(LFS_POINTER.into())),
        naming(30, "a.mtl", no_file()).beside("a.mtl", Content::Pipe),
        Case {
            row: 30,
            files: vec![("zero.obj".into(), Content::Link("/dev/zero"))],
            outcome: refused("NotRegularFile", "zero.obj: is not a regular file"),
        },
    ]
}

fn materials() -> Vec<Case> {
    let with = |row, mtl: &str, outcome| {
        let text = format!("mtllib a.mtl\nusemtl m\n{SQUARE}f 1 2 3\n");
        obj(row, text, outcome).beside("a.mtl", Content::Bytes(mtl.into()))
    };
    let impossible = |row, line: &str, albedo: &str| {
        let message = format!("a.mtl:2: material `m`: reflectance {albedo} is not within [0, 1]");
        with(row, &format!("newmtl m\n{line}\n"), refused("Material", message))
    };
    let specular = "a.mtl:4: material `m`: reflectance (5, 5, 5) is not within [0, 1]";
    let emissive = "a.mtl:4: material `m`: radiance (-1, -1, -1) has a component that is neither 0 nor within [1e-50, 1e50]";
    let again = "a.mtl:3: material `m` is redefined; the last definition is used";
    let unknown = "a.obj:2: material `m` is not defined; grey is used instead";
    let glass = [
        "a.mtl:1: textures of material `m` are ignored; one of colours counts as grey 0.5",
        "a.mtl:1: transparency of material `m` is ignored: it is opaque",
        "a.mtl:1: material `m` is approximated by an ideal diffuse surface",
    ];
    vec![
        with(31, "newmtl m\nKd 0.5\n", loaded(&[])),
        with(32, "newmtl m\nKd\n", refused("Parse", "a.mtl:2: Kd: expected 1 or 3 numbers")),
        impossible(33, "Kd nan 0 0", "(NaN, 0, 0)"),
        impossible(34, "Kd -1 0 0", "(-1, 0, 0)"),
        impossible(35, "Kd 5 5 5", "(5, 5, 5)"),
        with(35, "newmtl m\nillum 3\nKd 0\nKs 5\n", refused("Material", specular)),
        with(35, "newmtl m\nKd 0\n# dark\nKe -1\n", refused("Material", emissive)),
        with(36, "newmtl m\nKd 0\nnewmtl m\nKd 1\n", loaded(&[again])),
        with(37, "newmtl other\n", loaded(&[unknown])),
        with(37, "newmtl m\nKd 0.5\nKs 0.5\nd 0.1\nmap_Kd a.png\n", loaded(&glass)),
    ]
}

/// Rows of many, and of too many, within the default limits.
fn sizes() -> Vec<Case> {
    let switching = "usemtl red\nf 1 2 3\nusemtl blue\nf 3 2 1\n".repeat(1 << 12);
    let missing =
        ["red", "blue"].map(|name| format!("material `{name}` is not defined; grey is used instead"));
    let missing = [format!("a.obj:5: {}", missing[0]), format!("a.obj:7: {}", missing[1])];
    let long_line = format!("{SQUARE}# {}\nf 1 2 3\n", "-".repeat(16 << 20));
    let many_corners = format!("{SQUARE}f {}\n", "1 2 3 ".repeat(30_000));
    let dart = format!("{SQUARE}v 0.9 0.5 0\nf 1 2 3 4\nf 1 2 5 3 4\nf 2 5 3\n");
    let bow_tie = format!("{SQUARE}f 1 3 2 4\n");
    let odd = |line: u32| format!("a.obj:{line}: non-convex polygons are triangulated as fans: 1");
    vec![
        obj(38, format!("{SQUARE}{switching}"), Outcome::Loaded { warnings: missing.into() }),
        obj(39, long_line, refused("TooLarge", "a.obj:5: too many bytes in a line (limit: 16777216)")),
        obj(40, many_corners, refused("TooLarge", "a.obj:5: too many vertices in a polygon (limit: 65536)")),
        obj(41, dart, Outcome::Loaded { warnings: vec![odd(7)] }),
        obj(41, bow_tie, Outcome::Loaded { warnings: vec![odd(5)] }),
    ]
}
