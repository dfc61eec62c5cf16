//! What is said on stderr while the work goes on.

use std::fmt;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use patchlight::progress::{Observer, Progress, Stage};
use serde_json::json;

use super::argument_groups::ProgressKind;
use super::interrupt;
use super::ranks;
use super::stderr::say;

/// How the user wants to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voice {
    /// A bar, then the key figures.
    Bar,
    /// A line now and then, then the key figures.
    Plain,
    /// Only the key figures.
    Summary,
    /// JSON, one object a line.
    Json,
    /// Only warnings and errors.
    None,
    /// Nothing: that of a job among others, of which the batch tells, or of a process of which the first one tells.
    Job,
}

impl Voice {
    /// What `kind` means on this terminal.
    pub fn new(kind: ProgressKind) -> Self {
        match kind {
            _ if !ranks::is_first() => Self::Job,
            ProgressKind::Auto if std::io::stderr().is_terminal() => Self::Bar,
            ProgressKind::Auto => Self::Summary,
            ProgressKind::Plain => Self::Plain,
            ProgressKind::Json => Self::Json,
            ProgressKind::None => Self::None,
        }
    }

    /// Tells a key figure.
    pub fn figure(self, name: &str, text: fmt::Arguments<'_>) {
        match self {
            Self::None | Self::Job => {}
            Self::Json => say(format_args!("{}", json!({ "event": "figure", "name": name, "text": text.to_string() }))),
            _ => say(format_args!("{name:<9} {text}")),
        }
    }

    /// Warns.
    pub fn warn(self, text: fmt::Arguments<'_>) {
        match self {
            Self::Job => {}
            Self::Json => say(format_args!("{}", json!({ "event": "warning", "text": text.to_string() }))),
            _ => say(format_args!("warning: {text}")),
        }
    }

    /// At most one message in this time, unless the stage changes.
    fn interval(self) -> Duration {
        match self {
            Self::Bar => Duration::from_millis(50),
            Self::Json => Duration::from_millis(500),
            _ => Duration::from_secs(2),
        }
    }
}

/// What was told last.
#[derive(Clone, Copy)]
struct Told {
    at: Instant,
    stage: Stage,
    fraction: f64,
    /// When the step began that goes on since then, and what was done of it by then.
    begun: (Instant, f64),
}

impl Told {
    /// What is told next: a stage that has less done than before begins anew.
    fn next(last: Option<Self>, progress: &Progress, now: Instant) -> Self {
        let fraction = progress.fraction.unwrap_or(0.0);
        let same = last.filter(|last| last.stage == progress.stage && last.fraction <= fraction);
        Self { at: now, stage: progress.stage, fraction, begun: same.map_or((now, fraction), |last| last.begun) }
    }

    /// Seconds that are left of the step if it goes on as until now; `None` where too little is done of it to tell.
    fn left_s(&self) -> Option<f64> {
        /// What goes on for less is done soon.
        const WORTH_TELLING_S: f64 = 1.0;
        const LEAST_PART: f64 = 0.02;
        let (taken, part) = ((self.at - self.begun.0).as_secs_f64(), self.fraction - self.begun.1);
        (taken >= WORTH_TELLING_S && part >= LEAST_PART && self.fraction < 1.0).then(|| taken * (1.0 - self.fraction) / part)
    }
}

/// Passes progress on, and interrupts that have ended nothing yet: each ends one stage. A job is ended by the second one alone.
pub struct Watcher {
    voice: Voice,
    start: Instant,
    last: Mutex<Option<Told>>,
    bar: Option<ProgressBar>,
    /// Whether an interrupt was passed on.
    is_interrupted: AtomicBool,
}

impl Watcher {
    pub fn new(voice: Voice) -> Self {
        let bar = (voice == Voice::Bar).then(|| {
            let bar = ProgressBar::new(1000).with_style(style_of(None));
            bar.enable_steady_tick(Duration::from_millis(120));
            bar
        });
        Self { voice, start: Instant::now(), last: Mutex::new(None), bar, is_interrupted: AtomicBool::new(false) }
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        if *self.is_interrupted.get_mut() {
            interrupt::settle();
        }
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Watcher {
    fn progress(&self, progress: &Progress) {
        // Whoever comes while another thread talks says nothing: the next report follows soon.
        let Ok(mut last) = self.last.try_lock() else { return };
        let now = Instant::now();
        let new_stage = last.is_none_or(|last| last.stage != progress.stage);
        if !new_stage && last.is_some_and(|last| now - last.at < self.voice.interval()) {
            return;
        }
        let told = Told::next(*last, progress, now);
        *last = Some(told);
        match (self.voice, &self.bar) {
            (Voice::Bar, Some(bar)) => {
                bar.set_style(style_of(progress.fraction));
                bar.set_position((1000.0 * progress.fraction.unwrap_or(0.0)) as u64);
                bar.set_message(describe(progress, told.left_s()));
            }
            (Voice::Plain, _) => {
                say(format_args!("{:>8.1} s  {}", self.start.elapsed().as_secs_f64(), describe(progress, told.left_s())))
            }
            (Voice::Json, _) => {
                let time_s = self.start.elapsed().as_secs_f64();
                say(format_args!("{}", json!({ "event": "progress", "time_s": time_s, "progress": progress })));
            }
            _ => {}
        }
    }

    fn cancelled(&self) -> bool {
        let ends_stage = self.voice != Voice::Job && interrupt::is_pending();
        if ends_stage {
            self.is_interrupted.store(true, Ordering::Relaxed);
        }
        ends_stage || interrupt::leaves_out()
    }
}

/// Ends the work when its time is over, or by an interrupt.
pub struct Timed {
    pub watcher: Watcher,
    pub end: Option<Instant>,
}

impl Observer for Timed {
    fn progress(&self, progress: &Progress) {
        self.watcher.progress(progress);
    }

    fn cancelled(&self) -> bool {
        self.watcher.cancelled() || self.end.is_some_and(|end| Instant::now() >= end)
    }
}

/// A bar where the part that is done is known, else a spinner alone.
fn style_of(fraction: Option<f64>) -> ProgressStyle {
    let template = if fraction.is_some() { "{spinner} {elapsed} {bar:24} {msg}" } else { "{spinner} {elapsed} {msg}" };
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_spinner())
}

/// A progress report in words, with the seconds that are left of the step, if that is known: what matters most first, for narrow terminals.
fn describe(progress: &Progress, left_s: Option<f64>) -> String {
    let mut text = match progress.stage {
        Stage::Read => "reading",
        Stage::Build => "building",
        Stage::Refine => "refining",
        Stage::Gather => "gathering",
        Stage::Cells => "finding cells",
        Stage::Error => "estimating the error",
        Stage::Mesh => "making the lit mesh",
        Stage::Sample => "evaluating points",
        Stage::Render => "taking the picture",
    }
    .to_owned();
    if progress.round > 0 {
        text += &format!(", round {}", progress.round);
    }
    if let Some(fraction) = progress.fraction {
        text += &format!(" {:.0}%", 100.0 * fraction);
    }
    if let Some(error) = progress.error.filter(|error| error.is_finite()) {
        text += &format!(", error {:.2}%", 100.0 * error);
    }
    match left_s {
        Some(seconds) if seconds < 90.0 => text += &format!(", about {:.0} s left of this step", seconds.ceil()),
        Some(seconds) => text += &format!(", about {:.0} min left of this step", seconds / 60.0),
        None => {}
    }
    if progress.links > 0 {
        text += &format!(", {} links", progress.links);
    }
    if progress.elements > 0 {
        text += &format!(", {} elements", progress.elements);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_told_in_words() {
        let mut progress =
            Progress { stage: Stage::Refine, round: 3, fraction: None, links: 12, elements: 34, error: Some(0.0312) };
        assert_eq!(describe(&progress, None), "refining, round 3, error 3.12%, 12 links, 34 elements");
        progress = Progress { stage: Stage::Render, round: 0, fraction: Some(0.5), links: 0, elements: 0, error: None };
        assert_eq!(describe(&progress, Some(12.2)), "taking the picture 50%, about 13 s left of this step");
        assert_eq!(describe(&progress, Some(600.0)), "taking the picture 50%, about 10 min left of this step");
        progress = Progress { stage: Stage::Mesh, round: 0, fraction: None, links: 0, elements: 1234, error: Some(f64::INFINITY) };
        assert_eq!(describe(&progress, None), "making the lit mesh, 1234 elements");
    }

    #[test]
    fn what_is_left_follows_from_what_the_step_took_so_far() {
        let start = Instant::now();
        let at = |last, fraction, seconds| {
            let progress = Progress { stage: Stage::Error, round: 1, fraction, links: 0, elements: 0, error: None };
            Told::next(last, &progress, start + Duration::from_secs(seconds))
        };
        let begun = at(None, Some(0.1), 0);
        let later = at(Some(begun), Some(0.3), 10);
        assert!(begun.left_s().is_none() && (later.left_s().unwrap() - 35.0).abs() < 1e-9);
        // The stage begins anew where less is done than before; where nothing is known, nothing is told.
        assert!(at(Some(later), Some(0.05), 20).left_s().is_none());
        let again = at(Some(at(Some(later), Some(0.0), 20)), Some(0.5), 25);
        assert!((again.left_s().unwrap() - 5.0).abs() < 1e-9);
        assert!(at(Some(at(None, None, 0)), None, 50).left_s().is_none());
        assert!(at(Some(later), Some(1.0), 20).left_s().is_none());
    }
}
