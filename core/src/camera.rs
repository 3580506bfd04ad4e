//! Cameras: from pixels to rays, without trigonometry.

use core::fmt;

use glam::Vec3;

use crate::math::{Exact, Math, length_squared};
use crate::ray::Ray;

/// A pinhole and the rectangle in front of it onto which the picture is projected.
///
/// Only the rectangle's direction and shape as seen from the pinhole count, not its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, in world space.
    pub eye: Vec3,
    /// From the eye to the picture's top left corner.
    pub corner: Vec3,
    /// Along the picture's top edge, from its left to its right corner.
    pub right: Vec3,
    /// Along the picture's left edge, from its top to its bottom corner.
    pub down: Vec3,
}

/// Why some numbers are not a [`Camera`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CameraError {
    /// A number is not finite, or so large that its square is not, or a corner of the picture so far.
    NotFinite,
    /// The eye and the target are one point, or too close to tell the direction.
    NoDirection,
    /// `up` is zero or, to within 2^-20 of its length, along the view.
    UpAlongView,
    /// The tangent of half the field of view, upwards or sideways, is not between 0 and 2^20, both
    /// excluded; of a frustum, of any of its four parts.
    FieldOfView,
    /// The picture has no width or no height: the aspect ratio is not above 0, `left` is not less than
    /// `right`, or `bottom` not less than `top`.
    NoExtent,
    /// The image plane is not in front of the eye, or so near that the square of its distance is not a
    /// normal number.
    Distance,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a number of the camera is not finite or too large",
            Self::NoDirection => "the eye and the target are the same point",
            Self::UpAlongView => "up is zero or parallel to the view",
            Self::FieldOfView => "the field of view must be above 0 and below 180 degrees",
            Self::NoExtent => "the picture has no width or no height",
            Self::Distance => "the image plane must be in front of the eye",
        })
    }
}

impl core::error::Error for CameraError {}

/// Right, up and forward: unit vectors.
struct Basis {
    right: Vec3,
    up: Vec3,
    forward: Vec3,
}

impl Basis {
    fn new(eye: Vec3, target: Vec3, up: Vec3) -> Result<Self, CameraError> {
        let view = target - eye;
        let (view_squared, up_squared) = (length_squared(&view), length_squared(&up));
        if !(eye.is_finite() && view_squared.is_finite() && up_squared.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if view_squared == 0.0 {
            return Err(CameraError::NoDirection);
        }
        if up_squared == 0.0 {
            return Err(CameraError::UpAlongView);
        }
        let forward = Exact::normalize(view);
        let right = forward.cross(Exact::normalize(up));
        const PARALLEL: f32 = 1.0 / (1_u64 << 40) as f32;
        // Also true for NaN.
        if !(length_squared(&right) > PARALLEL) {
            return Err(CameraError::UpAlongView);
        }
        let right = Exact::normalize(right);
        Ok(Self {
            right,
            up: right.cross(forward),
            forward,
        })
    }
}

/// Tangents of half a field of view are less.
const WIDEST: f32 = (1 << 20) as f32;

impl Camera {
    /// A camera at `eye` that looks at `target`, with `up` towards the picture's top.
    ///
    /// `tan_half_fov` is the tangent of half the vertical field of view, `aspect` the picture's width
    /// over its height. Right is forward × up.
    ///
    /// # Errors
    ///
    /// Where that is no picture; see [`CameraError`].
    pub fn look_at(
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        tan_half_fov: f32,
        aspect: f32,
    ) -> Result<Self, CameraError> {
        let basis = Basis::new(eye, target, up)?;
        if !(tan_half_fov > 0.0 && tan_half_fov < WIDEST) {
            return Err(CameraError::FieldOfView);
        }
        let half_width = tan_half_fov * aspect;
        if !(half_width > 0.0) {
            return Err(CameraError::NoExtent);
        }
        if !(half_width < WIDEST) {
            return Err(CameraError::FieldOfView);
        }
        let (right, up) = (basis.right * half_width, basis.up * tan_half_fov);
        Ok(Self {
            eye,
            corner: basis.forward - right + up,
            right: right * 2.0,
            down: up * -2.0,
        })
    }

    /// A camera as [`look_at`](Self::look_at), with the picture from `left` to `right` and from
    /// `bottom` to `top` on a plane across the view at `distance` from the eye: a frustum that need not
    /// be symmetric.
    ///
    /// # Errors
    ///
    /// Where that is no picture; see [`CameraError`].
    #[allow(clippy::too_many_arguments)]
    pub fn frustum(
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        left: f32,
        right: f32,
        bottom: f32,
        top: f32,
        distance: f32,
    ) -> Result<Self, CameraError> {
        let basis = Basis::new(eye, target, up)?;
        let bounds = [left, right, bottom, top, distance];
        if !bounds.iter().all(|x| x.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(right > left && top > bottom) {
            return Err(CameraError::NoExtent);
        }
        if !(distance > 0.0 && distance * distance >= f32::MIN_POSITIVE) {
            return Err(CameraError::Distance);
        }
        let widest = WIDEST * distance;
        if !bounds[..4].iter().all(|edge| edge.abs() < widest) {
            return Err(CameraError::FieldOfView);
        }
        let camera = Self {
            eye,
            corner: basis.forward * distance + basis.right * left + basis.up * top,
            right: basis.right * (right - left),
            down: basis.up * (bottom - top),
        };
        // The farthest of the picture's points are its corners.
        let (left, right) = (camera.corner, camera.corner + camera.right);
        let corners = [left, right, left + camera.down, right + camera.down];
        if !corners.iter().all(|it| length_squared(it).is_finite()) {
            return Err(CameraError::NotFinite);
        }
        Ok(camera)
    }
}

/// A camera and the number of pixels of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where from, and what of the world.
    pub camera: Camera,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

impl View {
    /// The rays through the centers of a row's pixels, left to right; rows count from the top.
    ///
    /// ```
    /// use whitted::{Camera, Vec3, View};
    ///
    /// let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0)?;
    /// let view = View { camera, width: 3, height: 3 };
    /// assert_eq!(view.rays(1).len(), 3);
    /// assert_eq!(view.rays(1).nth(1).map(|ray| ray.direction), Some(Vec3::NEG_Z));
    /// # Ok::<(), whitted::CameraError>(())
    /// ```
    #[inline]
    pub fn rays(&self, row: u32) -> Rays {
        let camera = &self.camera;
        let down = camera.down / self.height as f32;
        Rays {
            eye: camera.eye,
            start: camera.corner + down * (row as f32 + 0.5),
            step: camera.right / self.width as f32,
            column: 0,
            width: self.width,
        }
    }
}

/// See [`View::rays`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays {
    pub(crate) eye: Vec3,
    pub(crate) start: Vec3,
    pub(crate) step: Vec3,
    pub(crate) column: u32,
    pub(crate) width: u32,
}

impl Rays {
    /// Leaves out so many rays.
    #[inline]
    pub(crate) fn pass(&mut self, rays: usize) {
        let left = (self.width - self.column) as usize;
        self.column += rays.min(left) as u32;
    }
}

impl Iterator for Rays {
    type Item = Ray;

    #[inline]
    fn nth(&mut self, passed: usize) -> Option<Ray> {
        self.pass(passed);
        self.next()
    }

    #[inline]
    fn next(&mut self) -> Option<Ray> {
        if self.column >= self.width {
            return None;
        }
        let to_pixel = self.start + self.step * (self.column as f32 + 0.5);
        self.column += 1;
        Some(Ray::new(self.eye, Exact::normalize(to_pixel)))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = (self.width - self.column) as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Rays {}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Vec3 = Vec3::new(1.0, 2.0, 3.0);

    #[test]
    fn degenerate_cameras_are_refused() {
        use CameraError::*;
        let look = |eye, target, up, tan, aspect| Camera::look_at(eye, target, up, tan, aspect);
        let cases = [
            ("fine", look(EYE, Vec3::ZERO, Vec3::Y, 0.5, 1.0), None),
            (
                "eye at target",
                look(EYE, EYE, Vec3::Y, 0.5, 1.0),
                Some(NoDirection),
            ),
            (
                "up along view",
                look(EYE, Vec3::ZERO, EYE, 0.5, 1.0),
                Some(UpAlongView),
            ),
            (
                "up against view",
                look(EYE, Vec3::ZERO, -EYE * 7.0, 0.5, 1.0),
                Some(UpAlongView),
            ),
            (
                "no up",
                look(EYE, Vec3::ZERO, Vec3::ZERO, 0.5, 1.0),
                Some(UpAlongView),
            ),
            (
                "zero field",
                look(EYE, Vec3::ZERO, Vec3::Y, 0.0, 1.0),
                Some(FieldOfView),
            ),
            (
                "half turn",
                look(EYE, Vec3::ZERO, Vec3::Y, 1.633e16, 1.0),
                Some(FieldOfView),
            ),
            (
                "no field",
                look(EYE, Vec3::ZERO, Vec3::Y, f32::NAN, 1.0),
                Some(FieldOfView),
            ),
            (
                "no width",
                look(EYE, Vec3::ZERO, Vec3::Y, 0.5, 0.0),
                Some(NoExtent),
            ),
            (
                "no end to the sides",
                look(EYE, Vec3::ZERO, Vec3::Y, 0.5, 1e20),
                Some(FieldOfView),
            ),
            (
                "eye nowhere",
                look(Vec3::NAN, Vec3::ZERO, Vec3::Y, 0.5, 1.0),
                Some(NotFinite),
            ),
            (
                "up infinite",
                look(EYE, Vec3::ZERO, Vec3::INFINITY, 0.5, 1.0),
                Some(NotFinite),
            ),
        ];
        for (name, camera, error) in cases {
            assert_eq!(camera.err(), error, "{name}");
        }
        let frustum =
            |l, r, b, t, d| Camera::frustum(EYE, Vec3::ZERO, Vec3::Y, l, r, b, t, d).err();
        assert_eq!(frustum(-1.0, 1.0, -1.0, 1.0, 2.0), None);
        assert_eq!(frustum(1.0, 1.0, -1.0, 1.0, 2.0), Some(NoExtent));
        assert_eq!(frustum(-1.0, 1.0, 1.0, -1.0, 2.0), Some(NoExtent));
        assert_eq!(frustum(-1.0, 1.0, -1.0, 1.0, 0.0), Some(Distance));
        assert_eq!(frustum(-1.0, 1.0, -1.0, 1.0, 1e-20), Some(Distance));
        assert_eq!(frustum(-1.0, 1.0, -1.0, f32::NAN, 1.0), Some(NotFinite));
        assert_eq!(frustum(-1.0, 1e20, -1.0, 1.0, 1.0), Some(FieldOfView));
        assert_eq!(frustum(-1e20, 1e20, -1e20, 1e20, 1e20), Some(NotFinite));
    }

    #[test]
    fn a_symmetric_frustum_is_a_look_at() {
        let view = |camera| View {
            camera,
            width: 8,
            height: 6,
        };
        let look = view(Camera::look_at(EYE, Vec3::ZERO, Vec3::Y, 0.5, 1.5).unwrap());
        let frustum = Camera::frustum(EYE, Vec3::ZERO, Vec3::Y, -1.5, 1.5, -1.0, 1.0, 2.0);
        let frustum = view(frustum.unwrap());
        for row in 0..6 {
            for (a, b) in look.rays(row).zip(frustum.rays(row)) {
                assert!((a.direction - b.direction).length() < 1e-6);
                assert!((a.direction.length_squared() - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn rows_run_right_and_down() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0).unwrap();
        let view = View {
            camera,
            width: 2,
            height: 2,
        };
        let signs: [[(bool, bool); 2]; 2] = [0, 1].map(|row| {
            let mut rays = view.rays(row);
            [(); 2].map(|()| {
                let direction = rays.next().unwrap().direction;
                (direction.x > 0.0, direction.y > 0.0)
            })
        });
        assert_eq!(
            signs,
            [
                [(false, true), (true, true)],
                [(false, false), (true, false)]
            ]
        );
    }
}
