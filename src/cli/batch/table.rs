//! Tables of all jobs, in the order of the plan.
//!
//! The table of results is the same bytes in every run; what jobs took stands in a table of its own.

use std::io::{self, Write};

use super::journal::Record;
use super::plan::{Job, Plan};

/// The columns of a table, and its rows.
pub struct Table {
    /// What columns are called.
    pub names: Vec<String>,
    /// Texts by row and column; empty where nothing is known.
    pub rows: Vec<Vec<String>>,
}

/// What stands before and after parameters in the table of results.
const BEFORE: [&str; 2] = ["name", "scene"];
const AFTER: [&str; 8] = ["exit", "stopped_by", "norm", "requested", "claimed", "confidence", "points_missed", "message"];

impl Table {
    /// What came of each job.
    pub fn of_results<'a>(plan: &Plan, done: impl Iterator<Item = (&'a Job, &'a Record)>) -> Self {
        let names = BEFORE.iter().chain(&[]).map(|&name| name.to_owned());
        let names = names.chain(plan.parameters.iter().cloned()).chain(AFTER.iter().map(|&name| name.to_owned())).collect();
        let row = |(job, record): (&Job, &Record)| {
            let figures = &record.figures;
            let after = [
                &record.exit.to_string(),
                &figures.stopped_by,
                &figures.norm,
                &figures.requested,
                &figures.claimed,
                &figures.confidence,
                &figures.points_missed,
                &figures.message,
            ];
            [&job.name, &job.scene].into_iter().chain(&job.values).chain(after).cloned().collect()
        };
        Self { names, rows: done.map(row).collect() }
    }

    /// What each job took.
    pub fn of_costs<'a>(done: impl Iterator<Item = (&'a Job, &'a Record)>) -> Self {
        let names = ["name", "cpu_s", "wall_s", "attempts"].map(str::to_owned).to_vec();
        let row = |(job, record): (&Job, &Record)| {
            let cost = record.cost;
            let cpu_s = cost.cpu_s.map_or(String::new(), |cpu_s| format!("{cpu_s:.3}"));
            vec![job.name.clone(), cpu_s, format!("{:.3}", cost.wall_s), cost.attempts.to_string()]
        };
        Self { names, rows: done.map(row).collect() }
    }

    /// All jobs of a plan, and the files that each will write.
    pub fn of_plan(plan: &Plan) -> Self {
        let names = BEFORE.iter().map(|&name| name.to_owned()).chain(plan.parameters.iter().cloned()).chain(["outputs".to_owned()]);
        let row = |job: &Job| {
            let outputs = job.outputs.iter().map(|output| output.text.as_str()).collect::<Vec<_>>().join(" ");
            [&job.name, &job.scene].into_iter().chain(&job.values).chain([&outputs]).cloned().collect()
        };
        Self { names: names.collect(), rows: plan.jobs.iter().map(row).collect() }
    }

    /// Writes it as CSV.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write(&self, writer: impl Write) -> io::Result<()> {
        let mut csv = csv::Writer::from_writer(writer);
        [&self.names].into_iter().chain(&self.rows).try_for_each(|row| csv.write_record(row))?;
        csv.flush()
    }
}
