//! Figure 4.10 as SVG files: errors of all ways, by links of the global solution and by time of a point.

use std::path::Path;

use super::measure::{Ladder, Row, Rung, Way};
use super::plot::{Plot, Scale};

pub fn draw(ladder: &Ladder, folder: &Path) -> std::io::Result<()> {
    let by_links = |rung: &Rung, _: &Row| rung.report.counts.links as f64;
    let by_time = |_: &Rung, row: &Row| row.micros;
    let name = ladder.name;
    std::fs::write(folder.join(format!("local_pass_{name}_links.svg")), plot(ladder, ["", "links"], &by_links))?;
    std::fs::write(folder.join(format!("local_pass_{name}_time.svg")), plot(ladder, [" us", "CPU time of a point"], &by_time))
}

fn plot(ladder: &Ladder, [unit, label]: [&str; 2], place: &dyn Fn(&Rung, &Row) -> f64) -> String {
    let curve = |way: Way| -> Vec<(f64, f64)> {
        let rows = ladder.rungs.iter().flat_map(|rung| rung.rows.iter().filter(|row| row.way == way).map(move |row| (rung, row)));
        rows.map(|(rung, row)| (place(rung, row), 100.0 * row.errors.l1)).collect()
    };
    let points: Vec<(f64, f64)> = Way::all().flat_map(curve).collect();
    let title = format!("{}: relative L1 error", ladder.name.replace('_', " "));
    let mut plot = Plot::new(&title, [Scale::Logarithmic; 2], [unit, "%"], label, &points);
    Way::all().for_each(|way| plot.curve(&way.name(), &curve(way), matches!(way, Way::Own(_)), true));
    plot.finish()
}
