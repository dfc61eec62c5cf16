//! Bakes that take from earlier ones, and leave something for later ones.

use patchlight::bake::{BakeOptions, BakeRecord, BakeReport, Kept, Lightmap};
use patchlight::output::{Destination, Provenance, read_bake_record, write_bake_record};

use super::argument_groups::Whence;
use super::arguments::BakeArguments;
use super::exit::Failure;
use super::files::Outputs;
use super::progress::Voice;

/// What is taken from an earlier bake, and left for a later one.
#[derive(Debug)]
pub struct Again {
    pub earlier: Option<BakeRecord>,
    keep: Option<Destination>,
}

impl Again {
    /// Reads the earlier one. Only lightmaps whose texels are gathered can do either.
    pub fn new(typed: &BakeArguments, is_of_pages: bool, outputs: &mut Outputs) -> Result<Self, Failure> {
        for (flag, is_typed) in [("--keep", typed.keep.is_some()), ("--since", typed.since.is_some())] {
            if is_typed && !is_of_pages {
                return Err(Failure::usage(format_args!("{flag} is for lightmaps: name one, as in -o FILE.exr")));
            }
            if is_typed && typed.from == Some(Whence::Mesh) {
                return Err(Failure::usage(format_args!("{flag} is for texels that are gathered; leave out --from mesh")));
            }
        }
        let keep = typed.keep.as_deref().map(|path| outputs.file(path)).transpose()?;
        let earlier = typed.since.as_deref().map(read_bake_record).transpose().map_err(Failure::bad_input)?;
        Ok(Self { earlier, keep })
    }

    /// Whether texels have to be gathered for it.
    pub fn is_asked(&self) -> bool {
        self.earlier.is_some() || self.keep.is_some()
    }

    /// Whether the earlier bake fits what is asked for: that is known before the solve.
    pub fn check(&self, options: &BakeOptions, error: f64) -> Result<(), Failure> {
        self.earlier.as_ref().map_or(Ok(()), |earlier| earlier.fits(options, error)).map_err(Failure::usage)
    }

    /// Tells what was kept.
    pub fn tell(&self, report: &BakeReport, voice: Voice) {
        if self.earlier.is_none() {
            return;
        }
        let part = |light: &str, kept: Kept| {
            let off = 100.0 * kept.off;
            if kept.is_refused {
                format!("{light} light found anew everywhere: the earlier one, with what it changed by, would be {off:.2}% off")
            } else {
                let all = 100.0 * kept.texels as f64 / report.texels.max(1) as f64;
                format!("{light} light of {} texels ({all:.0}%), {off:.2}% off gathers", kept.texels)
            }
        };
        let [direct, indirect] = report.kept;
        voice.figure("kept", format_args!("{}; {}", part("direct", direct), part("indirect", indirect)));
    }

    /// Writes what a later bake can take.
    pub fn write(&self, lightmap: &Lightmap, provenance: &Provenance, voice: Voice) -> Result<(), Failure> {
        let Some(destination) = &self.keep else { return Ok(()) };
        let path = destination.path().display();
        let Some(record) = &lightmap.record else {
            voice.warn(format_args!("{path} is not written: not all texels were found"));
            return Ok(());
        };
        destination.write(|file| write_bake_record(file, record, provenance))?;
        voice.figure("wrote", format_args!("{path} (for a later bake, --since)"));
        Ok(())
    }
}
