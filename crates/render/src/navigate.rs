//! Moving a camera with a mouse.

use corpuscle_scene::Camera;

use crate::Projection;

/// Radians for each pixel of a drag in space: a third of a turn across 420 pixels.
const TURN: f64 = 0.005;

/// The camera `factor` times nearer, with the place under `cursor` (in pixels) staying under it.
#[must_use]
pub fn zoomed(camera: Camera, projection: &Projection, cursor: [f64; 2], factor: f64) -> Camera {
    match camera {
        Camera::Plane { centre, extent } => {
            let fixed = projection.place(cursor);
            Camera::Plane {
                centre: std::array::from_fn(|k| fixed[k] + (centre[k] - fixed[k]) / factor),
                extent: extent.map(|length| length / factor),
            }
        }
        Camera::Orbit { target, distance, yaw, pitch } => Camera::Orbit { target, distance: distance / factor, yaw, pitch },
    }
}

/// The camera after the mouse went `way` pixels to the right and down with its button held: shifted in the plane, turned
/// around its target in space.
#[must_use]
pub fn dragged(camera: Camera, projection: &Projection, way: [f64; 2]) -> Camera {
    match camera {
        Camera::Plane { centre, extent } => {
            let centre = [centre[0] - way[0] / projection.scale, centre[1] + way[1] / projection.scale];
            Camera::Plane { centre, extent }
        }
        Camera::Orbit { target, distance, yaw, pitch } => {
            // Short of the poles, where the vertical would flip.
            let pitch = (pitch + TURN * way[1]).clamp(-1.55, 1.55);
            Camera::Orbit { target, distance, yaw: yaw - TURN * way[0], pitch }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rectangle;

    const STAGE: Rectangle = Rectangle { left: 0.0, top: 0.0, width: 800.0, height: 600.0 };
    const PLANE: Camera = Camera::Plane { centre: [5.0, -2.0], extent: [4.0, 3.0] };

    #[test]
    fn the_place_under_the_cursor_stays() {
        let project = |camera| Projection::new(camera, [800.0, 600.0], STAGE);
        let cursor = [123.0, 456.0];
        let before = project(PLANE).place(cursor);
        let after = project(zoomed(PLANE, &project(PLANE), cursor, 1.7)).place(cursor);
        assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn a_drag_takes_the_picture_along() {
        let project = |camera| Projection::new(camera, [800.0, 600.0], STAGE);
        let before = project(PLANE).place([300.0, 200.0]);
        let after = project(dragged(PLANE, &project(PLANE), [40.0, -25.0])).place([340.0, 175.0]);
        assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-12));
        // In space, what is near follows the mouse.
        let orbit = Camera::Orbit { target: [0.0; 3], distance: 5.0, yaw: 0.0, pitch: 0.0 };
        let near = [0.0, -1.0, 0.0];
        let [x, y] = project(dragged(orbit, &project(orbit), [30.0, 20.0])).pixel(near).unwrap_or_default();
        assert!(x > 400.0 && y > 300.0);
    }
}
