//! Scenes that jobs share: each is read when its first job comes, and let go of after its last.

use std::fs;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use patchlight::pipeline::{PipelineError, Workers};
use patchlight::scene::import::read_scene;
use patchlight::scene::{Scene, Sides};
use patchlight::visibility::{self, Backend, OccluderMesh, Visibility};

use super::super::argument_groups::TrustArguments;
use super::super::exit::{Exit, Failure};
use super::super::progress::Voice;
use super::identity;
use super::shared_transport::Transports;

/// A scene in memory.
pub struct Stocked {
    /// As its file says.
    pub scene: Scene,
    /// The other files that it read: material libraries, lights.
    pub libraries: Vec<PathBuf>,
    /// The SHA-256 of its file and of its libraries.
    pub digest: String,
    /// What answers for its geometry, once it is asked for.
    visibility: Mutex<Option<Arc<dyn Visibility>>>,
    /// What paths bring in it, for jobs that change materials alone.
    pub transports: Transports,
}

/// What tells scenes apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Its file.
    pub path: PathBuf,
    /// Which sides emit and receive.
    pub sides: Sides,
    /// A file of lights beside it.
    pub lights: Option<PathBuf>,
    /// What is to answer for its geometry.
    pub backend: Backend,
}

/// Scenes by number.
pub struct Stock {
    slots: Vec<Mutex<Slot>>,
    wanted: Vec<Wanted>,
    trust: TrustArguments,
    voice: Voice,
}

/// A scene, and how many jobs still want it.
#[derive(Default)]
struct Slot {
    jobs: usize,
    read: Option<Result<Arc<Stocked>, (Exit, String)>>,
}

impl Stock {
    /// Nothing is read yet. Scenes read libraries wherever they lie, if so allowed.
    pub fn new(trust: TrustArguments, voice: Voice) -> Self {
        Self { slots: Vec::new(), wanted: Vec::new(), trust, voice }
    }

    /// One more job wants this scene; its number.
    pub fn want(&mut self, wanted: Wanted) -> usize {
        let known = self.wanted.iter().position(|known| *known == wanted);
        let number = known.unwrap_or_else(|| {
            self.wanted.push(wanted);
            self.slots.push(Mutex::default());
            self.slots.len() - 1
        });
        self.slots[number].get_mut().unwrap_or_else(PoisonError::into_inner).jobs += 1;
        number
    }

    /// The scene of this number, read on these threads. Others that want it meanwhile wait until it is read.
    pub fn scene(&self, number: usize, workers: &Workers) -> Result<Arc<Stocked>, Failure> {
        let mut slot = self.slot(number);
        let read =
            || workers.install(|| self.read(&self.wanted[number])).map(Arc::new).map_err(|failure| (failure.exit, failure.message));
        slot.read.get_or_insert_with(read).clone().map_err(|(exit, message)| Failure { exit, message })
    }

    /// A job that wanted it has ended.
    pub fn release(&self, number: usize) {
        let mut slot = self.slot(number);
        slot.jobs -= 1;
        if slot.jobs == 0 {
            slot.read = None;
        }
    }

    fn slot(&self, number: usize) -> MutexGuard<'_, Slot> {
        self.slots[number].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads a scene; that it was repaired is told once.
    fn read(&self, wanted: &Wanted) -> Result<Stocked, Failure> {
        let Wanted { path, sides, lights, .. } = wanted;
        let imported = read_scene(path, &self.trust.import(*sides, lights.clone())).map_err(Failure::bad_input)?;
        let mut digests = String::new();
        for file in [path].into_iter().chain(&imported.libraries) {
            let bytes = fs::read(file).map_err(|error| Failure::bad_input(format_args!("{}: {error}", file.display())))?;
            digests += &identity::digest(&bytes);
        }
        let warnings = imported.diagnostics.warnings().len();
        if warnings > 0 {
            self.voice
                .warn(format_args!("{path}: {warnings} warnings; 'patchlight info {path}' prints them", path = path.display()));
        }
        let digest = identity::digest(digests.as_bytes());
        Ok(Stocked {
            scene: imported.scene,
            libraries: imported.libraries,
            digest,
            visibility: Mutex::default(),
            transports: Transports::default(),
        })
    }
}

impl Stocked {
    /// What answers for its geometry: built once, for all jobs.
    pub fn visibility(&self, backend: Backend) -> Result<Arc<dyn Visibility>, Failure> {
        let mut built = self.visibility.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(answers) = &*built {
            return Ok(answers.clone());
        }
        let answers = visibility::build(backend, &OccluderMesh::of_scene(&self.scene)).map_err(PipelineError::from)?;
        let answers: Arc<dyn Visibility> = Arc::from(answers);
        *built = Some(answers.clone());
        Ok(answers)
    }
}
