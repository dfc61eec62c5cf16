//! Embree 4 through the crate embree4-sys: a second way to ask it, for the benchmark.
//!
//! Its declarations are those of Embree 4.2. `RTCRay` and `RTCOccludedArguments` have stayed as they were, so occlusion is safe
//! with any Embree 4; `RTCRayHit` has grown in 4.3, so first hits are left to obvhs, built when the first one is asked for.
#![allow(unsafe_code, reason = "calls into libembree4")]

use std::{ffi::c_void, ptr, sync::OnceLock};

use embree4_sys as native;

use super::{
    Hit, OccluderMesh, Ray, Segment, Visibility, VisibilityError,
    obvhs::{Obvhs, Tree},
    occluders::{Probe, Question, RayFrame, Sides},
};

/// Four-byte words that an Embree newer than the declarations may take for the rest of its `RTCRayQueryContext`. 4.3 added one.
const SPARE_WORDS: usize = 8;

pub(super) struct Embree4Sys {
    device: native::RTCDevice,
    scene: native::RTCScene,
    frame: RayFrame,
    sides: Sides,
    mesh: OccluderMesh,
    first_hits: OnceLock<Obvhs>,
}

/// What Embree hands through to the filter.
#[repr(C)]
struct Query<'a> {
    context: native::RTCRayQueryContext,
    spare: [u32; SPARE_WORDS],
    sides: &'a Sides,
    probe: &'a Probe,
}

// SAFETY: Device and scene are reference-counted heap objects with no tie to a thread but "its own error flag per device" (Embree
// manual, "Embree API"), which is read only in `new`. Only `new` and `drop` change them, and both own them.
unsafe impl Send for Embree4Sys {}

// SAFETY: Through a shared reference the scene is only asked: "performing ray queries in a scene is thread-safe" (Embree manual,
// "Embree API"). All that a query writes is on its own stack.
unsafe impl Sync for Embree4Sys {}

impl Embree4Sys {
    pub(super) fn new(mesh: &OccluderMesh) -> Result<Self, VisibilityError> {
        let frame = RayFrame::new(mesh);
        let sides = Sides::new(mesh, &frame);
        // SAFETY: The string has its NUL. One build thread, as in wrapper/occlusion.c.
        let device = unsafe { native::rtcNewDevice(c"threads=1,set_affinity=0".as_ptr()) };
        if device.is_null() {
            return Err(native_error("no device for this processor"));
        }
        // SAFETY: The device is alive.
        let scene = unsafe { native::rtcNewScene(device) };
        let embree = Self { device, scene, frame, sides, mesh: mesh.clone(), first_hits: OnceLock::new() };
        if scene.is_null() {
            return Err(native_error("no scene"));
        }

        // SAFETY: The scene is alive and not committed yet; Robust and Medium as in wrapper/occlusion.c.
        unsafe {
            native::rtcSetSceneBuildQuality(scene, native::RTCBuildQuality::MEDIUM);
            native::rtcSetSceneFlags(scene, native::RTCSceneFlags::ROBUST);
        }
        if !mesh.triangles.is_empty() {
            embree.attach_triangles()?;
        }
        // SAFETY: The scene is alive, and nobody else has it; rtcGetDeviceError reads and clears this thread's first error.
        let error = unsafe {
            native::rtcCommitScene(scene);
            native::rtcGetDeviceError(device)
        };
        if error == native::RTCError::NONE { Ok(embree) } else { Err(native_error("the scene could not be built")) }
    }

    fn attach_triangles(&self) -> Result<(), VisibilityError> {
        let vertices: Vec<[f32; 3]> =
            self.mesh.vertices.iter().map(|&vertex| self.frame.point(vertex).as_vec3().to_array()).collect();
        let triangles = &self.mesh.triangles;

        // SAFETY: Device and scene are alive. rtcSetNewGeometryBuffer returns room for the counted elements (and its own padding)
        // or NULL, which is checked before anything is copied. The scene retains the geometry when it is attached, so that it may
        // be released here. `filter` has the signature RTCFilterFunctionN and expects the context that `is_blocked` passes.
        unsafe {
            let geometry = native::rtcNewGeometry(self.device, native::RTCGeometryType::TRIANGLE);
            if geometry.is_null() {
                return Err(native_error("no geometry"));
            }
            let (vertex, index) = (native::RTCBufferType::VERTEX, native::RTCBufferType::INDEX);
            let to = native::rtcSetNewGeometryBuffer(geometry, vertex, 0, native::RTCFormat::FLOAT3, 12, vertices.len());
            let indices = native::rtcSetNewGeometryBuffer(geometry, index, 0, native::RTCFormat::UINT3, 12, triangles.len());
            if to.is_null() || indices.is_null() {
                native::rtcReleaseGeometry(geometry);
                return Err(native_error("no memory for the triangles"));
            }
            ptr::copy_nonoverlapping(vertices.as_ptr(), to.cast(), vertices.len());
            ptr::copy_nonoverlapping(triangles.as_ptr(), indices.cast(), triangles.len());
            native::rtcSetGeometryBuildQuality(geometry, native::RTCBuildQuality::MEDIUM);
            native::rtcSetGeometryOccludedFilterFunction(geometry, Some(filter));
            native::rtcCommitGeometry(geometry);
            native::rtcAttachGeometryByID(self.scene, geometry, 0);
            native::rtcReleaseGeometry(geometry);
        }
        Ok(())
    }

    fn is_blocked(&self, probe: &Probe) -> bool {
        let mut query = Query {
            context: native::RTCRayQueryContext { instID: [u32::MAX] },
            spare: [u32::MAX; SPARE_WORDS],
            sides: &self.sides,
            probe,
        };
        let mut arguments = native::RTCOccludedArguments {
            flags: native::RTCRayQueryFlags::INCOHERENT,
            feature_mask: native::RTCFeatureFlags(u32::MAX),
            context: ptr::from_mut(&mut query).cast(),
            filter: None,
            occluded: None,
        };
        let (origin, direction) = (probe.origin, probe.direction);
        let mut ray = native::RTCRay {
            org_x: origin.x,
            org_y: origin.y,
            org_z: origin.z,
            dir_x: direction.x,
            dir_y: direction.y,
            dir_z: direction.z,
            tnear: probe.near,
            tfar: 1.0,
            ..native::RTCRay::default()
        };
        // SAFETY: The scene is committed. The ray is finite with tnear >= 0 (`RayFrame` lets nothing else through) and aligned to
        // 16 bytes by its type, as the manual of rtcOccluded1 demands. Arguments and context outlive the call.
        unsafe { native::rtcOccluded1(self.scene, &mut ray, &mut arguments) };
        ray.tfar < 0.0
    }
}

/// Rejects a hit that does not block.
///
/// # Safety
/// Embree calls it with a context that `is_blocked` made, and one ray.
unsafe extern "C" fn filter(arguments: *const native::RTCFilterFunctionNArguments) {
    // SAFETY: Embree passes valid arguments, and rtcOccluded1 passes one ray (N = 1), so that primID is word 5 of the hit and
    // `valid` one word (manual of rtcSetGeometryIntersectFilterFunction, and rtcore_ray.h). The context is the head of a `Query`.
    unsafe {
        let arguments = &*arguments;
        let query: &Query = &*arguments.context.cast::<c_void>().cast();
        let triangle = *arguments.hit.cast::<u32>().add(5);
        if !query.sides.blocks(triangle as usize, query.probe) {
            *arguments.valid = 0;
        }
    }
}

fn native_error(message: &str) -> VisibilityError {
    VisibilityError::Native { backend: "embree4-sys", message: message.to_owned() }
}

impl Drop for Embree4Sys {
    fn drop(&mut self) {
        // SAFETY: Made in `new` and released only here; `&mut self` proves that no query runs. The scene may be NULL after a
        // failure.
        unsafe {
            if !self.scene.is_null() {
                native::rtcReleaseScene(self.scene);
            }
            native::rtcReleaseDevice(self.device);
        }
    }
}

impl Visibility for Embree4Sys {
    fn description(&self) -> String {
        // SAFETY: The device is alive; the call only reads.
        let version = unsafe { native::rtcGetDeviceProperty(self.device, native::RTCDeviceProperty::VERSION) };
        format!("embree4-sys on embree {}.{}.{}, first hits by obvhs 0.4", version / 10_000, version / 100 % 100, version % 100)
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        for (segment, occluded) in segments.iter().zip(occluded) {
            *occluded = match self.frame.segment(segment) {
                Question::Answered(answer) => answer,
                Question::Open(probe) => self.is_blocked(&probe),
            };
        }
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.first_hits.get_or_init(|| Obvhs::new(&self.mesh, Tree::CwBvh)).first_hits(rays, hits);
    }
}
