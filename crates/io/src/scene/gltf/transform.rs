use crate::scene::range;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json::Node;

/// How far the length of a rotation's quaternion may be from 1. Exporters round the components.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// The transform of a node relative to its parent, or a message that says why it is invalid.
pub(super) fn local(node: &Node) -> Result<DAffine3, String> {
    let transform = match &node.matrix {
        Some(_) if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() => {
            return Err("`matrix` excludes `translation`, `rotation` and `scale`".into());
        }
        Some(columns) => of_matrix(columns)?,
        None => of_parts(node)?,
    };
    check_range(&transform)?;
    Ok(transform)
}

/// Checks that all components are within the range of coordinates.
pub(super) fn check_range(transform: &DAffine3) -> Result<(), String> {
    range::check_range("transform component", transform.to_cols_array())
}

fn of_matrix(columns: &[f32; 16]) -> Result<DAffine3, String> {
    let matrix = DMat4::from_cols_array(&columns.map(f64::from));
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err("matrix is not affine".into());
    }
    let transform = DAffine3::from_mat4(matrix);
    if transform.matrix3.determinant() == 0.0 {
        return Err("matrix is singular".into());
    }
    Ok(transform)
}

/// The scale may be zero, since files hide nodes that way.
fn of_parts(node: &Node) -> Result<DAffine3, String> {
    let vector = |parts: Option<[f32; 3]>, default| {
        parts.map_or(default, |parts| DVec3::from_array(parts.map(f64::from)))
    };
    let rotation = match node.rotation {
        // Exact, unlike the normalised quaternion.
        None => DQuat::IDENTITY,
        Some(parts) => {
            let rotation = DQuat::from_array(parts.0.map(f64::from));
            let length = rotation.length();
            if !(1.0 - LENGTH_TOLERANCE..=1.0 + LENGTH_TOLERANCE).contains(&length) {
                return Err(format!("rotation is not a unit quaternion: its length is {length}"));
            }
            rotation / length
        }
    };
    let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}
