//! Hands a hash of the sources to the compiler: two builds that may differ in a sample have different ones.

fn main() -> std::io::Result<()> {
    globillum_source_hash::emit()
}
