//! Rows 75 to 82: pictures that a scene names. None is read, so none can do harm; that textures
//! are passed over is said.

use super::{Case, Content, gltf, loaded};

pub(super) fn cases() -> Vec<Case> {
    let png = |header: [u8; 13]| {
        let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        file.extend(header);
        // No checksum is right that is all zeros, for these headers.
        file.extend([0; 4]);
        file
    };
    let size = |width: u32, height: u32, depth: u8, colour: u8| {
        let mut header = [0; 13];
        header[..4].copy_from_slice(&width.to_be_bytes());
        header[4..8].copy_from_slice(&height.to_be_bytes());
        (header[8], header[9]) = (depth, colour);
        png(header)
    };
    let radiance = |bytes: &[u8]| [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", bytes].concat();
    let pictures = [
        (75, "a.png", size(8, 8, 8, 2)[..20].to_vec()),
        (76, "a.png", size(8, 8, 8, 2)),
        (77, "a.png", size(65535, 65535, 8, 2)),
        (78, "a.png", size(0, 8, 8, 2)),
        (79, "a.png", size(8, 8, 16, 2)),
        (80, "a.png", size(8, 8, 8, 3)),
        (81, "a.hdr", radiance(b"-Y 100000 +X 100000\n")),
        (82, "a.exr", f32::NAN.to_le_bytes().to_vec()),
    ];
    pictures
        .into_iter()
        .flat_map(|(row, name, bytes)| [by_obj(row, name, &bytes), by_gltf(row, name, &bytes)])
        .collect()
}

fn by_obj(row: u32, name: &str, picture: &[u8]) -> Case {
    let scene = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let library = format!("newmtl m\nKd 0.5\nmap_Kd {name}\n");
    Case::new(
        row,
        "a.obj",
        scene,
        loaded(&["a.mtl:1: textures of material `m` are ignored; one of colours counts as grey 0.5"]),
    )
    .beside("a.mtl", Content::Bytes(library.into()))
    .beside(name, Content::Bytes(picture.into()))
}

fn by_gltf(row: u32, name: &str, picture: &[u8]) -> Case {
    let textured = format!(
        r#","images":[{{"uri":"{name}"}}],"textures":[{{"source":0}}],
        "materials":[{{"name":"m","pbrMetallicRoughness":{{"metallicFactor":0,"baseColorTexture":{{"index":0}}}}}}],"scene""#
    );
    let with_material = gltf::TRIANGLE.replacen(r#""mode":4"#, r#""mode":4,"material":0"#, 1);
    let json = with_material.replacen(r#","scene""#, &textured, 1);
    let warning =
        "a.glb: materials[0]: textures of material `m` are ignored; one of colours counts as grey 0.5";
    Case::new(row, "a.glb", gltf::glb(&json, &gltf::binary()), loaded(&[warning]))
        .beside(name, Content::Bytes(picture.into()))
}
