//! From the simulation's space to pixels and back, in double precision; the shaders do the same in single precision,
//! relative to the camera's centre.

use corpuscle_scene::Camera;

/// A rectangle of the frame in pixels, from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// Half of the angle that the smaller side of the stage spans in perspective: 20 degrees.
const HALF_ANGLE_TANGENT: f64 = 0.363_970_234_266_202_4;

/// A camera together with the part of a frame that it fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Point of the simulation in the middle of the stage.
    pub centre: [f64; 3],
    /// Rows: the directions right, up and towards the viewer.
    pub rotation: [[f64; 3]; 3],
    /// From the eye to the centre; 0 for [`Camera::Plane`].
    pub distance: f64,
    /// Pixels in the simulation's length, at the centre.
    pub scale: f64,
    frame: [f64; 2],
    middle: [f64; 2],
}

impl Projection {
    /// The camera's extent fits into `stage`; the rest of a frame of `frame` pixels shows what lies around.
    pub fn new(camera: Camera, frame: [f64; 2], stage: Rectangle) -> Self {
        let middle = [stage.left + 0.5 * stage.width, stage.top + 0.5 * stage.height];
        match camera {
            Camera::Plane { centre, extent } => Self {
                centre: [centre[0], centre[1], 0.0],
                rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                distance: 0.0,
                scale: (stage.width / extent[0]).min(stage.height / extent[1]),
                frame,
                middle,
            },
            Camera::Orbit { target, distance, yaw, pitch } => {
                let (sin_yaw, cos_yaw) = yaw.sin_cos();
                let (sin_pitch, cos_pitch) = pitch.sin_cos();
                let focal = 0.5 * stage.width.min(stage.height) / HALF_ANGLE_TANGENT;
                Self {
                    centre: target,
                    // Yaw 0 looks along +y, with x to the right and z up.
                    rotation: [
                        [cos_yaw, sin_yaw, 0.0],
                        [-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch],
                        [sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch],
                    ],
                    distance,
                    scale: focal / distance,
                    frame,
                    middle,
                }
            }
        }
    }

    /// Whether the camera looks in perspective.
    pub fn is_spatial(&self) -> bool {
        self.distance > 0.0
    }

    /// Pixels in a unit of length at distance 1.
    pub fn focal(&self) -> f64 {
        self.scale * self.distance
    }

    /// Distance from the eye before which nothing is drawn.
    pub fn near(&self) -> f64 {
        0.01 * self.distance
    }

    /// Eye space to clip space, in columns as OpenGL takes it.
    pub(crate) fn matrix(&self) -> [[f32; 4]; 4] {
        // The middle of the stage, from -1 to 1 upwards.
        let shift = [2.0 * self.middle[0] / self.frame[0] - 1.0, 1.0 - 2.0 * self.middle[1] / self.frame[1]];
        let columns = if self.is_spatial() {
            let (near, far) = (self.near(), 100.0 * self.distance);
            let focal = self.focal();
            [
                [2.0 * focal / self.frame[0], 0.0, 0.0, 0.0],
                [0.0, 2.0 * focal / self.frame[1], 0.0, 0.0],
                [-shift[0], -shift[1], (near + far) / (near - far), -1.0],
                [0.0, 0.0, 2.0 * near * far / (near - far), 0.0],
            ]
        } else {
            [
                [2.0 * self.scale / self.frame[0], 0.0, 0.0, 0.0],
                [0.0, 2.0 * self.scale / self.frame[1], 0.0, 0.0],
                [0.0; 4],
                [shift[0], shift[1], 0.0, 1.0],
            ]
        };
        columns.map(|column| column.map(|x| x as f32))
    }

    /// Where a place appears, in pixels from the upper left corner; none behind the eye.
    pub fn pixel(&self, place: [f64; 3]) -> Option<[f64; 2]> {
        let from_centre: [f64; 3] = std::array::from_fn(|k| place[k] - self.centre[k]);
        let [x, y, z] = self.rotation.map(|row| row.iter().zip(&from_centre).map(|(r, p)| r * p).sum::<f64>());
        let scale = if self.is_spatial() {
            let depth = self.distance - z;
            if depth <= self.near() {
                return None;
            }
            self.focal() / depth
        } else {
            self.scale
        };
        Some([self.middle[0] + scale * x, self.middle[1] - scale * y])
    }

    /// The place that appears at a pixel, in the plane through the centre across the line of sight.
    pub fn place(&self, pixel: [f64; 2]) -> [f64; 3] {
        let right = (pixel[0] - self.middle[0]) / self.scale;
        let up = (self.middle[1] - pixel[1]) / self.scale;
        std::array::from_fn(|k| self.centre[k] + right * self.rotation[0][k] + up * self.rotation[1][k])
    }
}

/// A number as two floats whose sum holds 48 of its bits.
///
/// The shader subtracts two such numbers part by part: the difference of nearly equal ones keeps the bits that single
/// precision alone would lose, and what was uploaded stays valid wherever the camera goes and whatever the time is.
pub(crate) fn pair(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// [`pair`] of each component: the high parts, then the low ones.
pub(crate) fn pairs<const N: usize>(x: [f64; N]) -> [[f32; N]; 2] {
    let parts = x.map(pair);
    [parts.map(|p| p[0]), parts.map(|p| p[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STAGE: Rectangle = Rectangle { left: 100.0, top: 50.0, width: 600.0, height: 400.0 };

    #[test]
    fn the_extent_fills_the_stage() {
        let camera = Camera::Plane { centre: [3.0, 4.0], extent: [3.0, 2.0] };
        let projection = Projection::new(camera, [800.0, 600.0], STAGE);
        assert_eq!(projection.pixel([1.5, 5.0, 0.0]), Some([100.0, 50.0]));
        assert_eq!(projection.place([700.0, 450.0]), [4.5, 3.0, 0.0]);
    }

    #[test]
    fn a_pixel_and_its_place_agree_in_space() {
        let camera = Camera::Orbit { target: [1.0, -2.0, 0.5], distance: 7.0, yaw: 0.7, pitch: -0.3 };
        let projection = Projection::new(camera, [800.0, 600.0], STAGE);
        let pixel = [321.0, 123.0];
        let back = projection.pixel(projection.place(pixel)).unwrap_or_default();
        assert!((back[0] - pixel[0]).abs() < 1e-9 && (back[1] - pixel[1]).abs() < 1e-9);
        // Straight behind the eye.
        let eye: [f64; 3] = std::array::from_fn(|k| projection.centre[k] + 7.5 * projection.rotation[2][k]);
        assert_eq!(projection.pixel(eye), None);
    }

    #[test]
    fn a_pair_holds_48_bits() {
        for x in [1.0e6 + 1.0e-4, -std::f64::consts::PI, 1.0 / 3.0, 0.0] {
            let [high, low] = pair(x);
            assert!((f64::from(high) + f64::from(low) - x).abs() <= x.abs() * 2.0f64.powi(-48));
        }
    }
}
