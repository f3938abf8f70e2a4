use super::json::Node;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use globillum_geom::Triangles;

/// Where a node places what it holds, relative to its parent; an error says what is wrong with it.
pub(super) fn local(node: &Node<'_, true>) -> Result<DAffine3, String> {
    let transform = match node.matrix.as_deref() {
        Some(columns) => of_matrix(columns)?,
        None => of_parts(node)?,
    };
    check_range(&transform)?;
    Ok(transform)
}

/// Refuses a transform that no coordinate would survive.
pub(super) fn check_range(transform: &DAffine3) -> Result<(), String> {
    let limit = f64::from(Triangles::MAX_COORDINATE);
    match transform.to_cols_array().into_iter().find(|x| !(-limit..=limit).contains(x)) {
        Some(x) => Err(format!("transform component {x:e} exceeds {limit:e} in magnitude")),
        None => Ok(()),
    }
}

fn of_matrix(columns: &[f64; 16]) -> Result<DAffine3, String> {
    let matrix = DMat4::from_cols_array(columns);
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err("matrix is not affine".into());
    }
    let transform = DAffine3::from_mat4(matrix);
    if transform.matrix3.determinant() == 0.0 {
        return Err("matrix is singular".into());
    }
    Ok(transform)
}

/// A scale of zero is allowed here, since it is how nodes are hidden.
fn of_parts(node: &Node<'_, true>) -> Result<DAffine3, String> {
    let vector = |parts: &Option<Box<[f64; 3]>>, default| {
        parts.as_deref().map_or(default, |parts| DVec3::from_array(*parts))
    };
    let rotation = match node.rotation.as_deref() {
        // The most common one shall not cost a rounding.
        None => DQuat::IDENTITY,
        Some(parts) => {
            let rotation = DQuat::from_array(*parts);
            let length = rotation.length();
            if !(length.is_finite() && length > 0.0) {
                return Err("rotation is not a unit quaternion".into());
            }
            rotation / length
        }
    };
    let (scale, translation) = (vector(&node.scale, DVec3::ONE), vector(&node.translation, DVec3::ZERO));
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}
