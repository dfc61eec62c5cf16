//! Runs of programs, timed.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Short runs are repeated until they have taken so many CPU seconds, at most so often: the system counts in hundredths.
const ENOUGH_CPU_S: f64 = 0.5;
const MOST_REPEATS: u32 = 5;

/// How often a run is looked at.
const LOOK: Duration = Duration::from_millis(1);

/// Means over the repeats of a run.
pub struct Timed {
    pub cpu_s: f64,
    pub wall_s: f64,
    /// The exit code; `None` if the run was ended by a signal, such as that of the limit.
    pub code: Option<i32>,
}

/// Runs a command some times, each at most as long as the limit.
pub fn timed(command: &mut Command, limit: Duration) -> Timed {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let (start, cpu_before) = (Instant::now(), children_cpu_s());
    let (mut repeats, mut code) = (0, Some(0));
    while repeats == 0 || (code.is_some() && repeats < MOST_REPEATS && children_cpu_s() - cpu_before < ENOUGH_CPU_S) {
        code = ended(&mut command.spawn().expect("the program starts"), limit);
        repeats += 1;
    }
    let count = f64::from(repeats);
    Timed { cpu_s: (children_cpu_s() - cpu_before) / count, wall_s: start.elapsed().as_secs_f64() / count, code }
}

/// Waits for a program, and ends it at the limit.
fn ended(child: &mut Child, limit: Duration) -> Option<i32> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a program can be waited for") {
            return status.code();
        }
        if start.elapsed() > limit {
            child.kill().expect("a program can be ended");
            child.wait().expect("a program can be waited for");
            return None;
        }
        std::thread::sleep(LOOK);
    }
}

/// CPU seconds of all processes that were started and have ended, user and system, by Linux: `/proc/self/stat` in clock ticks of 10 ms.
fn children_cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("this benchmark needs Linux");
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |index: usize| fields[index].parse::<f64>().expect("a count of ticks");
    // After the name in brackets the state is field 3; cutime and cstime are 16 and 17.
    0.01 * (ticks(16 - 3) + ticks(17 - 3))
}
