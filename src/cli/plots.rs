//! `solve --plots`: what a run tells about itself, as pictures.

use std::path::Path;

use patchlight::output::{Destination, Plot, Provenance, RunReport, write_plot};

use super::exit::Failure;
use super::files::Outputs;
use super::progress::Voice;

/// The files of all plots.
#[derive(Debug)]
pub struct PlotFiles(Vec<(Plot, Destination)>);

impl PlotFiles {
    /// In a folder, which is made where there is none.
    pub fn new(folder: &Path, outputs: &mut Outputs) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::usage(format_args!("cannot make the folder {} ({error})", folder.display())))?;
        let file = |plot: Plot| Ok((plot, outputs.file(&folder.join(plot.file_name()))?));
        Ok(Self(Plot::ALL.into_iter().map(file).collect::<Result<_, Failure>>()?))
    }

    /// Draws them all.
    pub fn write(&self, report: &RunReport, provenance: &Provenance, voice: Voice) -> Result<(), Failure> {
        for (plot, destination) in &self.0 {
            destination.write(|file| write_plot(file, *plot, report, provenance))?;
            voice.figure("wrote", format_args!("{}", destination.path().display()));
        }
        Ok(())
    }
}
