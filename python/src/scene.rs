//! Scenes: from files, arrays and meshes.

use std::path::PathBuf;

use patchlight::scene::import::{ArrayFace, Diagnostics, Draft, ImportError, ImportOptions, read_lights, read_scene_observed};
use patchlight::scene::{self, Sides};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, reals, vectors, wholes};
use crate::diagnostic::Diagnostic;
use crate::errors::{Failure, class_of};
use crate::relight::grouping;
use crate::watch::{Listener, watched};
use crate::workers::workers;

/// What is lit: faces with materials. Unchangeable; may be used by many threads.
///
/// Made by `Scene.read`, `Scene.from_arrays` and `Scene.from_mesh`. What was repaired or looks suspicious is warned of as `SceneWarning`,
/// and all that was noted stands in `diagnostics`.
#[pyclass(frozen, module = "patchlight")]
pub struct Scene {
    pub scene: scene::Scene,
    /// The file that it was read from, if any.
    pub file: PathBuf,
    /// What was repaired or is suspicious.
    pub warnings: Vec<String>,
    /// The faces that these are about, from 1.
    pub warned_faces: Vec<Option<u32>>,
    noted: Vec<Diagnostic>,
}

#[pymethods]
impl Scene {
    /// Reads an .obj file with its material libraries, or a .gltf, .glb, .ply or .stl file: three channels, linear Rec. 709.
    ///
    /// sides: "front", where corners run counter-clockwise, or "both".
    /// allow_any_path: whether other files that it names may lie elsewhere than beside the file or below its folder.
    /// lights: a TOML file of lights that are no surfaces.
    #[staticmethod]
    #[pyo3(signature = (path, *, sides="front", allow_any_path=false, lights=None))]
    fn read(py: Python<'_>, path: PathBuf, sides: &str, allow_any_path: bool, lights: Option<PathBuf>) -> PyResult<Self> {
        let options = ImportOptions { sides: sides_of(sides)?, allow_any_path, lights, ..ImportOptions::default() };
        let workers = workers(None)?;
        let read =
            |observer: &dyn patchlight::progress::Observer| workers.install(|| read_scene_observed(&path, &options, observer));
        let imported = watched(py, &Listener::new(None)?, read)?.map_err(Failure::from)?;
        Self::new(py, imported.scene, &imported.diagnostics, path)
    }

    /// Makes a scene of arrays.
    ///
    /// vertices: float array (V, 3), in metres.
    /// faces: int array (F, K) of indices of vertices, counter-clockwise seen from the front; or a sequence of sequences, where faces
    ///     have different numbers of corners.
    /// reflectance: float, or array (C,) or (M, C): reflectances from 0 to below 1, by material and channel.
    /// exitance: the same in W/m^2: power that is emitted.
    /// materials: int array (F,): which row of these each face has; may be left out where there is one.
    /// sides: "front" or "both".
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, **materials))]
    fn from_arrays(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>, materials: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let helper = vertices.py().import("patchlight._meshes")?.getattr("arrays")?;
        Self::of_parts(&helper.call((vertices, faces), materials)?)
    }

    /// Makes a scene of a mesh, or of a sequence of meshes: anything with `vertices` and `faces`, as trimesh has them, or with `points`
    /// and `cells`, as meshio has them. Takes reflectance, exitance, materials and sides, as `from_arrays` does.
    ///
    /// materials: also one int for each mesh of a sequence, or the name of what meshes know of their faces: `face_attributes` of trimesh,
    ///     `cell_data` of meshio.
    #[staticmethod]
    #[pyo3(signature = (mesh, **materials))]
    fn from_mesh(mesh: &Bound<'_, PyAny>, materials: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let helper = mesh.py().import("patchlight._meshes")?.getattr("of_mesh")?;
        Self::of_parts(&helper.call((mesh,), materials)?)
    }

    /// The same scene under the lights of a TOML file as well: points, spots, measured luminaires, suns and skies, which are no surfaces.
    ///
    /// allow_any_path: whether photometric files that it names may lie elsewhere than beside the file or below its folder.
    #[pyo3(signature = (path, *, allow_any_path=false))]
    fn with_lights(&self, py: Python<'_>, path: PathBuf, allow_any_path: bool) -> PyResult<Self> {
        let read = py.detach(|| read_lights(&path, self.scene.channels(), allow_any_path)).map_err(Failure::from)?;
        let lights = self.scene.lights().iter().cloned().chain(read.lights).collect();
        let scene = self.scene.clone().with_lights(lights);
        let scene = scene.map_err(|source| Failure::from(ImportError::Scene { file: path.clone(), source }))?;
        let noted = self.noted.iter().filter(|noted| noted.kind != "no_light").cloned();
        let noted = noted.chain(read.diagnostics.items.iter().map(Diagnostic::of)).collect();
        let (warnings, warned_faces) = (read.diagnostics.warnings(), read.diagnostics.warned_faces());
        Ok(Self { scene, file: self.file.clone(), warnings, warned_faces, noted })
    }

    /// The same scene with its lights in groups, which `Solution.relight` weights after the solve.
    ///
    /// by: "material" or "object", for a group of each that emits, by its name, and of each light that is no surface; or a dict of groups by name, each a
    ///     sequence of "material NAME", "object NAME" and "light NAME", in which every surface that emits and every light is once.
    fn with_light_groups(&self, by: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scene = self.scene.with_light_groups(&grouping(by)?).map_err(Failure::from)?;
        let (warnings, warned_faces) = (self.warnings.clone(), self.warned_faces.clone());
        Ok(Self { scene, file: self.file.clone(), warnings, warned_faces, noted: self.noted.clone() })
    }

    /// The names of its light groups, in their order; empty if it has none.
    #[getter]
    fn light_groups(&self) -> Vec<&str> {
        self.scene.light_groups().map_or_else(Vec::new, |groups| groups.names().iter().map(String::as_str).collect())
    }

    /// The names of its lights that are no surfaces, in their order.
    #[getter]
    fn light_names(&self) -> Vec<&str> {
        self.scene.lights().iter().map(|light| light.name.as_str()).collect()
    }

    /// Channels: numbers for each reflectance, exitance and radiosity.
    #[getter]
    fn channels(&self) -> usize {
        self.scene.channels()
    }

    /// How many surfaces there are: convex planar polygons with one side each.
    #[getter]
    fn surface_count(&self) -> usize {
        self.scene.surfaces().len()
    }

    /// The area of all surfaces in m^2.
    #[getter]
    fn area(&self) -> f64 {
        self.scene.surfaces().iter().map(|surface| surface.polygon.area()).sum()
    }

    /// The corners of the box around it: float64 array (2, 3), in metres.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bounds = self.scene.bounds();
        array(py, [bounds.min(), bounds.max()].concat(), &[2, 3]).map(Bound::into_any)
    }

    /// The names of its materials, in their order.
    #[getter]
    fn material_names(&self) -> Vec<&str> {
        self.scene.materials().iter().map(|material| material.name.as_str()).collect()
    }

    /// Reflectances: float64 array (materials, channels).
    #[getter]
    fn reflectance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of_materials(py, |material| &material.reflectance)
    }

    /// Exitances: float64 array (materials, channels), in W/m^2.
    #[getter]
    fn exitance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of_materials(py, |material| &material.exitance)
    }

    /// All that was noted when it was made.
    #[getter]
    fn diagnostics(&self) -> Vec<Diagnostic> {
        self.noted.clone()
    }

    fn __repr__(&self) -> String {
        let (surfaces, area) = (self.surface_count(), self.area());
        format!("<patchlight.Scene: {surfaces} surfaces, {area:.6} m^2, {} channels>", self.channels())
    }
}

impl Scene {
    /// What `solve` was given: a scene, a path, or a mesh.
    pub fn of<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        let py = object.py();
        if let Ok(scene) = object.cast::<Self>() {
            return Ok(scene.clone());
        }
        if let Ok(path) = object.extract::<PathBuf>() {
            return Bound::new(py, Self::read(py, path, "front", false, None)?);
        }
        Bound::new(py, Self::from_mesh(object, None)?)
    }

    fn new(py: Python<'_>, scene: scene::Scene, diagnostics: &Diagnostics, file: PathBuf) -> PyResult<Self> {
        let warnings = diagnostics.warnings();
        let (warn, class) = (py.import("warnings")?.getattr("warn")?, class_of(py, "SceneWarning")?);
        for warning in &warnings {
            warn.call1((warning, &class))?;
        }
        let (warned_faces, noted) = (diagnostics.warned_faces(), diagnostics.items.iter().map(Diagnostic::of).collect());
        Ok(Self { scene, file, warnings, warned_faces, noted })
    }

    /// Of what `patchlight/_meshes.py` makes of arrays and meshes: vertices, corners, counts, materials, reflectances, exitances, sides.
    fn of_parts(parts: &Bound<'_, PyAny>) -> PyResult<Self> {
        let part = |number: usize| parts.get_item(number);
        let (reflectance, exitance) = (reals(&part(4)?, "reflectance")?, reals(&part(5)?, "exitance")?);
        let (reflectance, exitance) = (reflectance.as_array(), exitance.as_array());
        let channels = reflectance.shape().last().copied().unwrap_or(0);
        let mut draft = Draft::new(channels, sides_of(&part(6)?.extract::<String>()?)?);
        for (rho, e) in reflectance.rows().into_iter().zip(exitance.rows()) {
            draft.add_material(&rho.to_vec(), &e.to_vec());
        }
        (draft.vertices, _) = vectors(&part(0)?, "vertices")?;
        draft.corners = wholes(&part(1)?, "faces")?;
        let faces = wholes(&part(2)?, "counts")?.into_iter().zip(wholes(&part(3)?, "materials")?);
        let number = |number: u64| u32::try_from(number).unwrap_or(u32::MAX);
        draft.faces = faces.map(|(count, material)| ArrayFace { corners: count as usize, material: number(material) }).collect();

        let py = parts.py();
        let workers = workers(None)?;
        let (scene, diagnostics) = py.detach(|| workers.install(|| draft.build())).map_err(Failure::from)?;
        Self::new(py, scene, &diagnostics, PathBuf::new())
    }

    fn of_materials<'py>(&self, py: Python<'py>, what: fn(&scene::Material) -> &Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        let materials = self.scene.materials();
        let numbers = materials.iter().flat_map(what).copied().collect();
        array(py, numbers, &[materials.len(), self.scene.channels()]).map(Bound::into_any)
    }
}

fn sides_of(name: &str) -> Result<Sides, Failure> {
    match name {
        "front" => Ok(Sides::Front),
        "both" => Ok(Sides::Both),
        _ => Err(Failure::argument(format_args!("sides is '{name}', it must be 'front' or 'both'"))),
    }
}
