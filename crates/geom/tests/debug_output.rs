//! `Accel` requires `Debug`, so users see what it prints in the first `dbg!`.

use globillum_geom::Triangles;
use globillum_geom::conformance::shapes::statue;
use globillum_testkit::accelerators;

#[test]
fn it_is_counts_however_many_triangles_there_are() {
    let triangles = Triangles::new(statue(1000).triangles()).unwrap();
    let count = triangles.len();
    let text = format!("{triangles:?}");
    assert!(text.starts_with(&format!("Triangles {{ len: {count}, degenerate: 0, bounds")), "{text}");
    assert!(text.len() < 300, "{text}");
    for (name, build) in accelerators::all() {
        let accel = build(&triangles).unwrap();
        let text = format!("{accel:?}");
        let shows = |what: &str, number: usize| text.contains(&format!("{what}: {number}"));
        assert!(shows("triangles", count) || shows("len", count), "{name}: {text}");
        assert!(shows("bytes", accel.bytes()) && text.len() < 300, "{name}: {text}");
    }
}
