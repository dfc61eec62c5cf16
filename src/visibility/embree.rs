//! Embree 3 or 4, through wrapper/occlusion.h.
//!
//! The only state that Rust shares with the wrapper are the plane numbers and equations, which the wrapper reads in Embree's filter
//! callback. The tree is built on one thread, so that it does not depend on the number of threads, and no threads of Embree's
//! remain that would compete with the solver's.
#![allow(unsafe_code, reason = "calls into wrapper/occlusion.c")]

use std::{ffi::CStr, ptr::NonNull};

use super::{
    Hit, OccluderMesh, Ray, Segment, Visibility, VisibilityError,
    occluders::{Probe, Question, RayFrame, Sides},
};

/// The declarations of wrapper/occlusion.h, made by bindgen.
mod native {
    #![allow(dead_code, missing_docs, non_camel_case_types, reason = "generated from a C header")]
    include!(concat!(env!("OUT_DIR"), "/occlusion.rs"));
}

/// Segments handed over at once: enough to hide the cost of the call, few enough to stay in the first-level cache.
const BATCH: usize = 64;

pub(super) struct Embree {
    scene: NonNull<native::occlusion_scene>,
    frame: RayFrame,
    surfaces: Vec<u32>,
    /// Read by the native scene through pointers: never changed while `scene` lives.
    sides: Sides,
}

// SAFETY: Device and scene are reference-counted heap objects with no tie to a thread but "its own error flag per device" (Embree
// manual, "Embree API"), which is read only where the scene is built. Calls on one object must not overlap ("API calls that
// access the same object are not thread-safe, unless specified differently", ibid.): only building and dropping are such, and
// both own the scene.
unsafe impl Send for Embree {}

// SAFETY: Through a shared reference only occlusion_occluded, occlusion_first, occlusion_first_coherent and occlusion_embree_version
// can be called. The first three call rtcOccluded8, rtcIntersect1 and rtcIntersect8 ("performing ray queries in a scene is
// thread-safe", Embree manual, "Embree API") and keep all that they write on their own stack or in the caller's slices, and the
// filter callback reads the scene's constants and `sides`; the last reads a constant of the device.
unsafe impl Sync for Embree {}

impl Embree {
    pub(super) fn new(mesh: &OccluderMesh) -> Result<Self, VisibilityError> {
        let frame = RayFrame::new(mesh);
        let sides = Sides::new(mesh, &frame);
        let vertices: Vec<[f32; 3]> = mesh.vertices.iter().map(|&vertex| frame.point(vertex).as_vec3().to_array()).collect();

        let native_mesh = native::occlusion_mesh {
            vertices: vertices.as_ptr(),
            vertex_count: vertices.len(),
            triangles: mesh.triangles.as_ptr(),
            triangle_count: mesh.triangles.len(),
            planes: sides.planes.as_ptr(),
            equations: sides.equations.as_ptr(),
            tolerance: frame.tolerance(),
        };
        // SAFETY: The pointers are valid for the counts beside them; `OccluderMesh::validate` has checked, before any backend is
        // built, that the vertices are finite, that all indices are below the vertex count and that there are fewer than 2^31
        // triangles with one plane and one equation each. Vertices and triangles are copied (rtcSetNewGeometryBuffer, so Embree's
        // demand of padding after the last element is met). `sides` outlives the scene: the heap blocks of its vectors do not
        // move with it, and `drop` destroys the scene first.
        let scene = unsafe { native::occlusion_create(&native_mesh) };

        let backend = "embree";
        let scene = NonNull::new(scene).ok_or(VisibilityError::OutOfMemory { backend })?;
        let embree = Self { scene, frame, surfaces: mesh.surfaces.clone(), sides };
        // SAFETY: The scene is alive; the message is NULL or a string with an end, in memory of the scene, and copied at once.
        let message = unsafe {
            let message = native::occlusion_error(scene.as_ptr());
            (!message.is_null()).then(|| CStr::from_ptr(message).to_string_lossy().into_owned())
        };
        match message {
            // RTC_ERROR_OUT_OF_MEMORY, in the words of Embree and of the wrapper alike.
            Some(message) if message.ends_with("out of memory") => Err(VisibilityError::OutOfMemory { backend }),
            Some(message) => Err(VisibilityError::Native { backend, message }),
            None => Ok(embree),
        }
    }

    fn version(&self) -> u32 {
        // SAFETY: The scene is alive and was built without error, so it has a device; rtcGetDeviceProperty only reads.
        unsafe { native::occlusion_embree_version(self.scene.as_ptr()) }
    }

    fn trace_segments(&self, segments: &[native::occlusion_segment], occluded: &mut [u8]) {
        assert_eq!(segments.len(), occluded.len());
        // SAFETY: The scene was built without error. Both pointers are valid for `len` elements. `RayFrame` lets only finite
        // segments of some length through, and tnear is not negative, as the manual of rtcOccluded1 demands: it "does not do any
        // error checks".
        unsafe { native::occlusion_occluded(self.scene.as_ptr(), segments.as_ptr(), segments.len(), occluded.as_mut_ptr()) };
    }

    fn trace_rays(&self, segments: &[native::occlusion_segment], triangles: &mut [u32]) {
        assert_eq!(segments.len(), triangles.len());
        // SAFETY: As in `trace_segments`; the manual of rtcIntersect1 demands the same.
        unsafe { native::occlusion_first(self.scene.as_ptr(), segments.as_ptr(), segments.len(), triangles.as_mut_ptr()) };
    }

    fn trace_coherent_rays(&self, segments: &[native::occlusion_segment], triangles: &mut [u32]) {
        assert_eq!(segments.len(), triangles.len());
        // SAFETY: As in `trace_segments`; the manual of rtcIntersect8 demands the same.
        unsafe {
            native::occlusion_first_coherent(self.scene.as_ptr(), segments.as_ptr(), segments.len(), triangles.as_mut_ptr());
        }
    }

    /// First hits by one of the above.
    fn first_hits_by(&self, trace: impl Fn(&[native::occlusion_segment], &mut [u32]), rays: &[Ray], hits: &mut [Option<Hit>]) {
        let mut batch = [EMPTY; BATCH];
        let mut triangles = [0_u32; BATCH];
        let mut open = Vec::with_capacity(BATCH.min(rays.len()));
        for (rays, hits) in rays.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
            // Collect the rays that can hit something.
            open.clear();
            for (place, (ray, hit)) in rays.iter().zip(hits.iter_mut()).enumerate() {
                *hit = None;
                if let Some((probe, length)) = self.frame.ray(ray) {
                    batch[open.len()] = native_segment(&probe);
                    open.push((place, probe, length));
                }
            }

            // Embree says which triangle; its plane says where.
            trace(&batch[..open.len()], &mut triangles[..open.len()]);
            for (&(place, ref probe, length), &triangle) in open.iter().zip(&triangles) {
                if triangle != u32::MAX {
                    let triangle = triangle as usize;
                    hits[place] = Some(self.sides.hit(triangle, self.surfaces[triangle], probe, length));
                }
            }
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: Made by occlusion_create, destroyed only here; `&mut self` proves that no query runs. rtcReleaseScene and
        // rtcReleaseDevice free what they count, in this order, on whatever thread.
        unsafe { native::occlusion_destroy(self.scene.as_ptr()) };
    }
}

impl Visibility for Embree {
    fn description(&self) -> String {
        let version = self.version();
        format!("embree {}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        let mut batch = [EMPTY; BATCH];
        let mut places = [0_usize; BATCH];
        let mut answers = [0_u8; BATCH];
        for (segments, occluded) in segments.chunks(BATCH).zip(occluded.chunks_mut(BATCH)) {
            // Answer what needs no tracing, and collect the rest.
            let mut open = 0;
            for (place, (segment, occluded)) in segments.iter().zip(occluded.iter_mut()).enumerate() {
                match self.frame.segment(segment) {
                    Question::Answered(answer) => *occluded = answer,
                    Question::Open(probe) => {
                        batch[open] = native_segment(&probe);
                        places[open] = place;
                        open += 1;
                    }
                }
            }

            self.trace_segments(&batch[..open], &mut answers[..open]);
            for (&place, &answer) in places[..open].iter().zip(&answers) {
                occluded[place] = answer != 0;
            }
        }
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.first_hits_by(|segments, triangles| self.trace_rays(segments, triangles), rays, hits);
    }

    fn coherent_first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.first_hits_by(|segments, triangles| self.trace_coherent_rays(segments, triangles), rays, hits);
    }
}

const EMPTY: native::occlusion_segment =
    native::occlusion_segment { from: [0.0; 3], to: [0.0; 3], origin: [0.0; 3], direction: [0.0; 3], near: 0.0, planes: [0; 2] };

#[inline]
fn native_segment(probe: &Probe) -> native::occlusion_segment {
    native::occlusion_segment {
        from: probe.from.to_array(),
        to: probe.to.to_array(),
        origin: probe.origin.to_array(),
        direction: probe.direction.to_array(),
        near: probe.near,
        planes: probe.planes,
    }
}
