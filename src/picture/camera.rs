//! Where a picture is taken from: a pinhole camera, the rays through its pixels, and its text form.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use thiserror::Error;

use crate::visibility::{NO_PLANE, Ray};

/// A pinhole camera.
///
/// ```
/// use patchlight::picture::Camera;
///
/// let camera = Camera {
///     eye: [0.0, 1.0, 5.0],
///     target: [0.0, 1.0, 0.0],
///     up: [0.0, 1.0, 0.0],
///     field_of_view_degrees: 40.0,
///     width: 640,
///     height: 480,
/// };
/// let centre = camera.rays()?.through(320.0, 240.0);
/// assert_eq!(centre.direction, [0.0, 0.0, -1.0]);
/// # Ok::<(), patchlight::picture::CameraError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, in metres.
    pub eye: [f64; 3],
    /// What is at the centre of the picture.
    pub target: [f64; 3],
    /// What points up in the picture; not parallel to the view.
    pub up: [f64; 3],
    /// Vertical field of view in degrees, above 0 and below 180.
    pub field_of_view_degrees: f64,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
}

/// Why a camera takes no picture.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("camera: {0} has a coordinate that is not finite")]
    NotFinite(&'static str),
    /// Eye and target are the same point.
    #[error("camera: eye and target are the same point")]
    NoDirection,
    /// The up vector is zero or parallel to the view.
    #[error("camera: up is zero or parallel to the view from eye to target")]
    BadUp,
    /// The field of view is not above 0 and below 180 degrees.
    #[error("camera: fov is {0} degrees, it must be above 0 and below 180")]
    BadFieldOfView(f64),
    /// A picture has 1 to 65536 pixels on each side, 2^28 in all.
    #[error(
        "camera: the size {width}x{height} must be 1 to {side} pixels on each side and at most {all} in all",
        side = Camera::MAX_SIDE, all = Camera::MAX_PIXELS
    )]
    BadSize {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The text is not of the form `eye=x,y,z target=x,y,z up=x,y,z fov=degrees`.
    #[error("camera: '{part}' {reason}; write eye=x,y,z target=x,y,z up=x,y,z fov=degrees, any of them may be left out")]
    BadText {
        /// The part of the text that is wrong.
        part: String,
        /// What is wrong with it.
        reason: &'static str,
    },
}

impl Camera {
    /// The most pixels on one side.
    pub const MAX_SIDE: u32 = 65_536;

    /// The most pixels in a picture.
    pub const MAX_PIXELS: u64 = 1 << 28;

    /// Rejects a camera that takes no picture.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn validate(&self) -> Result<(), CameraError> {
        self.rays().map(drop)
    }

    /// The rays through the pixels.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn rays(&self) -> Result<CameraRays, CameraError> {
        for (name, vector) in [("eye", self.eye), ("target", self.target), ("up", self.up)] {
            if vector.iter().any(|x| !x.is_finite()) {
                return Err(CameraError::NotFinite(name));
            }
        }
        let side = 1..=Self::MAX_SIDE;
        let pixels = u64::from(self.width) * u64::from(self.height);
        if !side.contains(&self.width) || !side.contains(&self.height) || pixels > Self::MAX_PIXELS {
            return Err(CameraError::BadSize { width: self.width, height: self.height });
        }
        let degrees = self.field_of_view_degrees;
        if degrees.is_nan() || degrees <= 0.0 || degrees >= 180.0 {
            return Err(CameraError::BadFieldOfView(degrees));
        }

        // A right-handed frame: forward, right, up.
        let eye = DVec3::from(self.eye);
        let forward = (DVec3::from(self.target) - eye).try_normalize().ok_or(CameraError::NoDirection)?;
        let up = DVec3::from(self.up).try_normalize().ok_or(CameraError::BadUp)?;
        let right = forward.cross(up);
        if right.length() < 1e-9 {
            return Err(CameraError::BadUp);
        }
        let right = right.normalize();
        let half_height = (0.5 * degrees).to_radians().tan();
        let pixel = 2.0 * half_height / f64::from(self.height);
        Ok(CameraRays {
            eye,
            forward,
            right: right * pixel,
            down: -right.cross(forward) * pixel,
            centre: (0.5 * f64::from(self.width), 0.5 * f64::from(self.height)),
        })
    }
}

/// The view in the form that [`CameraRequest`] reads; the size is not part of it.
impl fmt::Display for Camera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ex, ey, ez] = self.eye;
        let [tx, ty, tz] = self.target;
        let [ux, uy, uz] = self.up;
        write!(f, "eye={ex},{ey},{ez} target={tx},{ty},{tz} up={ux},{uy},{uz} fov={}", self.field_of_view_degrees)
    }
}

/// The rays of a camera. Pixel positions count in pixels from the top left corner of the picture, columns to the right, rows down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRays {
    eye: DVec3,
    /// Unit vector to the centre of the picture.
    forward: DVec3,
    /// From one pixel to the next on the right, in the plane at distance 1.
    right: DVec3,
    /// From one pixel to the next below.
    down: DVec3,
    /// The centre of the picture, in pixels.
    centre: (f64, f64),
}

impl CameraRays {
    pub(super) fn eye(&self) -> DVec3 {
        self.eye
    }

    /// How far a point lies in front of the plane through the eye, in metres.
    pub(super) fn depth(&self, point: DVec3) -> f64 {
        self.forward.dot(point - self.eye)
    }

    /// The position in the picture of a point in front of the eye.
    pub(super) fn position(&self, point: DVec3) -> (f64, f64) {
        let arm = (point - self.eye) / self.depth(point);
        let along = |step: DVec3| step.dot(arm) / step.length_squared();
        (self.centre.0 + along(self.right), self.centre.1 + along(self.down))
    }

    /// The ray through a position in the picture; `(0.5, 0.5)` is the centre of the top left pixel. Its direction has length 1.
    pub fn through(&self, column: f64, row: f64) -> Ray {
        let direction = self.forward + (column - self.centre.0) * self.right + (row - self.centre.1) * self.down;
        Ray { origin: self.eye.to_array(), direction: direction.normalize().to_array(), origin_plane: NO_PLANE }
    }

    /// The ray of one of `samples` sub-samples of a pixel: through the pixel's centre if there is one, else through a point of a
    /// rank-1 lattice that is the same in every pixel. `sample` counts from 0.
    pub fn through_pixel(&self, column: u32, row: u32, sample: u32, samples: u32) -> Ray {
        let (dx, dy) = if samples <= 1 {
            (0.5, 0.5)
        } else {
            // With the golden ratio n points are evenly spread over both axes for every n (the Fibonacci lattice, if n is a
            // Fibonacci number).
            const GOLDEN: f64 = 0.618_033_988_749_894_9;
            ((f64::from(sample) + 0.5) / f64::from(samples), (0.5 + f64::from(sample) * GOLDEN).fract())
        };
        self.through(f64::from(column) + dx, f64::from(row) + dy)
    }
}

/// A view as typed: `eye=x,y,z target=x,y,z up=x,y,z fov=degrees`, separated by blanks, each at most once, any of them left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraRequest {
    /// The eye, in metres.
    pub eye: Option<[f64; 3]>,
    /// What is at the centre of the picture.
    pub target: Option<[f64; 3]>,
    /// What points up in the picture.
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    pub field_of_view_degrees: Option<f64>,
}

impl CameraRequest {
    /// `default` with what is asked for put in its place.
    ///
    /// # Errors
    /// See [`CameraError`]: the result is validated.
    pub fn apply_to(&self, default: Camera) -> Result<Camera, CameraError> {
        let camera = Camera {
            eye: self.eye.unwrap_or(default.eye),
            target: self.target.unwrap_or(default.target),
            up: self.up.unwrap_or(default.up),
            field_of_view_degrees: self.field_of_view_degrees.unwrap_or(default.field_of_view_degrees),
            ..default
        };
        camera.validate().map(|()| camera)
    }
}

impl FromStr for CameraRequest {
    type Err = CameraError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut request = Self::default();
        for part in text.split_whitespace() {
            let bad = |reason| CameraError::BadText { part: part.to_owned(), reason };
            let (key, value) = part.split_once('=').ok_or_else(|| bad("has no '='"))?;
            let repeated = match key {
                "eye" => request.eye.replace(parse_vector(value).ok_or_else(|| bad("needs three numbers"))?).is_some(),
                "target" => request.target.replace(parse_vector(value).ok_or_else(|| bad("needs three numbers"))?).is_some(),
                "up" => request.up.replace(parse_vector(value).ok_or_else(|| bad("needs three numbers"))?).is_some(),
                "fov" => {
                    let degrees: f64 = value.parse().map_err(|_| bad("needs a number of degrees"))?;
                    if degrees.is_nan() || degrees <= 0.0 || degrees >= 180.0 {
                        return Err(CameraError::BadFieldOfView(degrees));
                    }
                    request.field_of_view_degrees.replace(degrees).is_some()
                }
                _ => return Err(bad("is no key of a camera")),
            };
            if repeated {
                return Err(bad("is given twice"));
            }
        }
        Ok(request)
    }
}

/// Three finite numbers separated by commas.
pub(super) fn parse_vector(text: &str) -> Option<[f64; 3]> {
    let mut numbers = text.split(',').map(|number| number.parse::<f64>().ok().filter(|x| x.is_finite()));
    let vector = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: [1.0, 2.0, 3.0],
            target: [1.0, 2.0, -3.0],
            up: [0.0, 1.0, 0.0],
            field_of_view_degrees: 90.0,
            width: 20,
            height: 10,
        }
    }

    #[test]
    fn corners_of_the_picture_lie_where_the_field_of_view_says() {
        // 90 degrees over the height: at distance 1 the picture reaches from -1 to 1, and from -2 to 2 across.
        let rays = camera().rays().unwrap();
        let at_distance_1 = |column, row| {
            let d = DVec3::from(rays.through(column, row).direction);
            d / -d.z
        };
        assert!(at_distance_1(0.0, 0.0).distance(DVec3::new(-2.0, 1.0, -1.0)) < 1e-12);
        assert!(at_distance_1(20.0, 10.0).distance(DVec3::new(2.0, -1.0, -1.0)) < 1e-12);
        assert!(at_distance_1(10.0, 5.0).distance(DVec3::new(0.0, 0.0, -1.0)) < 1e-12);
    }

    #[test]
    fn directions_have_length_1_and_start_at_the_eye_on_no_plane() {
        let rays = camera().rays().unwrap();
        for sample in 0..7 {
            let ray = rays.through_pixel(19, 3, sample, 7);
            assert!((DVec3::from(ray.direction).length() - 1.0).abs() < 1e-12);
            assert_eq!((ray.origin, ray.origin_plane), ([1.0, 2.0, 3.0], NO_PLANE));
        }
    }

    #[test]
    fn sub_samples_fill_their_pixel_evenly() {
        // Recover the position in the picture from the direction; mean and mean square are those of a uniform square.
        let rays = camera().rays().unwrap();
        for samples in [2, 4, 8, 16, 64] {
            let (mut mean, mut square) = ((0.0, 0.0), (0.0, 0.0));
            for sample in 0..samples {
                let d = DVec3::from(rays.through_pixel(4, 7, sample, samples).direction);
                let (x, y) = (10.0 + 5.0 * d.x / -d.z - 4.0, 5.0 - 5.0 * d.y / -d.z - 7.0);
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y), "{x} {y}");
                mean = (mean.0 + x / f64::from(samples), mean.1 + y / f64::from(samples));
                square = (square.0 + x * x / f64::from(samples), square.1 + y * y / f64::from(samples));
            }
            let noise = 0.5 / f64::from(samples);
            assert!((mean.0 - 0.5).abs() < noise && (mean.1 - 0.5).abs() < noise, "{samples}: mean {mean:?}");
            assert!((square.0 - 1.0 / 3.0).abs() < noise && (square.1 - 1.0 / 3.0).abs() < noise, "{samples}: square {square:?}");
        }
        assert_eq!(rays.through_pixel(4, 7, 0, 1), rays.through(4.5, 7.5));
    }

    #[test]
    fn text_goes_there_and_back() {
        let camera = Camera { field_of_view_degrees: 54.25, eye: [0.1, -2.5e-3, 1e6], ..camera() };
        let request: CameraRequest = camera.to_string().parse().unwrap();
        let other = Camera { eye: [9.0; 3], target: [8.0; 3], up: [1.0, 0.0, 0.0], field_of_view_degrees: 20.0, ..camera };
        assert_eq!(request.apply_to(other).unwrap(), camera);
    }

    #[test]
    fn what_is_left_out_stays_as_it_was() {
        let request: CameraRequest = "fov=70".parse().unwrap();
        assert_eq!(request.apply_to(camera()).unwrap(), Camera { field_of_view_degrees: 70.0, ..camera() });
        assert_eq!("".parse::<CameraRequest>().unwrap(), CameraRequest::default());
    }

    #[test]
    fn bad_text_is_named() {
        for text in ["eye", "eye=1,2", "eye=1,2,3,4", "eye=1,2,x", "eye=1,2,inf", "fov=", "tilt=3", "fov=40 fov=40", "eye = 1,2,3"]
        {
            assert!(matches!(text.parse::<CameraRequest>(), Err(CameraError::BadText { .. })), "{text}");
        }
        for text in ["fov=0", "fov=180", "fov=-3", "fov=NaN"] {
            assert!(matches!(text.parse::<CameraRequest>(), Err(CameraError::BadFieldOfView(_))), "{text}");
        }
    }

    #[test]
    fn impossible_cameras_are_rejected() {
        let bad = |change: fn(&mut Camera)| {
            let mut camera = camera();
            change(&mut camera);
            camera.validate().unwrap_err()
        };
        assert_eq!(bad(|c| c.target = c.eye), CameraError::NoDirection);
        assert_eq!(bad(|c| c.up = [0.0, 0.0, 2.0]), CameraError::BadUp);
        assert_eq!(bad(|c| c.up = [0.0; 3]), CameraError::BadUp);
        assert_eq!(bad(|c| c.eye[1] = f64::NAN), CameraError::NotFinite("eye"));
        assert_eq!(bad(|c| c.field_of_view_degrees = 180.0), CameraError::BadFieldOfView(180.0));
        assert_eq!(bad(|c| c.width = 0), CameraError::BadSize { width: 0, height: 10 });
        assert_eq!(bad(|c| c.height = 70_000), CameraError::BadSize { width: 20, height: 70_000 });
    }
}
