//! What other programs can name, crate by crate, beside a listing of it that is kept in
//! `tests/public_api/`, so that no change of it goes unnoticed.
//!
//! `GLOBILLUM_BLESS=1 cargo test -p globillum-tests --test suite public_api::` writes the listings anew. They are made from the
//! sources by a parser: what macros write is not seen, nor traits that types of other crates are
//! given, and items of all features are listed.

#[path = "public_api/listing.rs"]
mod listing;

use std::path::Path;

/// Fails unless the listing of the crate in `folder` is the one that is kept as `name`.
fn assert_listed(folder: &str, name: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let found = listing::of_crate(&root.join(folder).join("src/lib.rs"));
    let path = root.join("tests/public_api").join(name);
    if std::env::var_os("GLOBILLUM_BLESS").is_some() {
        std::fs::write(&path, &found).expect("the listing can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    for (number, (kept, found)) in kept.lines().zip(found.lines()).enumerate() {
        assert_eq!(kept, found, "{name}:{}: meant? Then GLOBILLUM_BLESS=1 writes it", number + 1);
    }
    assert_eq!(
        kept.lines().count(),
        found.lines().count(),
        "{name}: meant? Then GLOBILLUM_BLESS=1 writes it"
    );
}

#[test]
fn geom() {
    assert_listed("crates/geom", "geom.rs.txt");
}

#[test]
fn material() {
    assert_listed("crates/material", "material.rs.txt");
}

#[test]
fn integrator() {
    assert_listed("crates/integrator", "integrator.rs.txt");
}

#[test]
fn io() {
    assert_listed("crates/io", "io.rs.txt");
}

#[test]
fn scenes() {
    assert_listed("crates/scenes", "scenes.rs.txt");
}

#[test]
fn facade() {
    assert_listed(".", "globillum.rs.txt");
}
