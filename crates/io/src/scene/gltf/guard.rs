//! A check of the JSON before the crate `gltf` reads it. The crate keeps 32 bits of an index, so an index of
//! 2^32 would become 0, and it allocates up to a kilobyte for an object of two bytes.

use serde::de::{
    DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor,
};
use std::fmt;

/// The content of a JSON text, without `extras` and the extensions that are not read.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Counts {
    pub(super) objects: u64,
    /// All values, including objects.
    pub(super) values: u64,
}

/// Counts what `text` contains. The error is for malformed JSON and for an index beyond 32 bits.
pub(super) fn check(text: &str) -> serde_json::Result<Counts> {
    let mut counts = Counts::default();
    let mut deserializer = serde_json::Deserializer::from_str(text);
    Value { role: Role::Other, counts: &mut counts }.deserialize(&mut deserializer)?;
    deserializer.end()?;
    Ok(counts)
}

/// What a value is for. The elements of an array have the role of the array.
#[derive(Clone, Copy)]
enum Role {
    /// An index, or a number of which the crate keeps 32 bits just so.
    Index,
    /// An object whose members are indices, whatever their keys.
    Attributes,
    Extensions,
    /// Content that the crate does not read.
    Unread,
    Other,
}

impl Role {
    /// The role of the member `key` of an object with this role.
    fn of_member(self, key: &str) -> Self {
        match (self, key) {
            (Self::Unread, _) | (_, "extras") => Self::Unread,
            (Self::Attributes, _) => Self::Index,
            (Self::Extensions, key) if key != "KHR_lights_punctual" => Self::Unread,
            (_, "extensions") => Self::Extensions,
            (_, "attributes" | "targets") => Self::Attributes,
            (
                _,
                "buffer" | "bufferView" | "camera" | "children" | "componentType" | "indices" | "light"
                | "material" | "mesh" | "mode" | "nodes" | "scene" | "skin",
            ) => Self::Index,
            _ => Self::Other,
        }
    }
}

/// Visits a value without keeping it.
struct Value<'a> {
    role: Role,
    counts: &'a mut Counts,
}

impl<'de> DeserializeSeed<'de> for Value<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        if matches!(self.role, Role::Unread) {
            return deserializer.deserialize_ignored_any(IgnoredAny).map(|_| ());
        }
        self.counts.values += 1;
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Value<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self.role, Role::Index) { "an index of 32 bits" } else { "a value" })
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<(), E> {
        match (self.role, u32::try_from(number)) {
            (Role::Index, Err(_)) => Err(E::invalid_value(Unexpected::Unsigned(number), &self)),
            _ => Ok(()),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<(), A::Error> {
        while elements.next_element_seed(Value { role: self.role, counts: self.counts })?.is_some() {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        self.counts.objects += 1;
        while let Some(role) = members.next_key_seed(Key(self.role))? {
            members.next_value_seed(Value { role, counts: self.counts })?;
        }
        Ok(())
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }
}

/// A key of an object with this role. Its value is the role of the member.
struct Key(Role);

impl<'de> DeserializeSeed<'de> for Key {
    type Value = Role;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Role, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for Key {
    type Value = Role;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<Role, E> {
        Ok(self.0.of_member(key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_and_values_are_counted() {
        for (text, objects, values) in
            [("0", 0, 1), ("{}", 1, 1), (r#"[[],{"a":{"b":null}}]"#, 2, 5), (r#"{"extras":[true,{}]}"#, 1, 1)]
        {
            assert_eq!(check(text).unwrap(), Counts { objects, values }, "{text}");
        }
    }

    #[test]
    fn indices_have_32_bits_wherever_the_crate_reads_them() {
        for members in [
            r#""scene":N"#,
            r#""scenes":[{"nodes":[0,N]}]"#,
            r#""nodes":[{"children":[N]}]"#,
            r#""nodes":[{"extensions":{"KHR_lights_punctual":{"light":N}}}]"#,
            r#""meshes":[{"primitives":[{"attributes":{"TEXCOORD_7":N}}]}]"#,
            r#""meshes":[{"primitives":[{"targets":[{"POSITION":N}]}]}]"#,
            r#""meshes":[{"primitives":[{"mode":N}]}]"#,
            r#""accessors":[{"sparse":{"indices":{"componentType":N}}}]"#,
        ] {
            let with = |number: u64| check(&format!("{{{}}}", members.replace('N', &number.to_string())));
            assert!(with(u32::MAX.into()).is_ok(), "{members}");
            let message = with(1 << 32).unwrap_err().to_string();
            let expected =
                "invalid value: integer `4294967296`, expected an index of 32 bits at line 1 column";
            assert!(message.starts_with(expected), "{members}: {message}");
        }
    }

    #[test]
    fn other_numbers_have_any_size() {
        for members in [
            r#""bufferViews":[{"byteOffset":N}]"#,
            r#""nodes":[{"translation":[N,0,0]}]"#,
            r#""accessors":[{"sparse":{"indices":{"byteOffset":N}}}]"#,
            r#""nodes":[{"extras":{"mesh":N}}]"#,
            r#""nodes":[{"extensions":{"VENDOR_a":{"mesh":N}}}]"#,
        ] {
            assert!(check(&format!("{{{}}}", members.replace('N', "4294967296"))).is_ok(), "{members}");
        }
    }
}
