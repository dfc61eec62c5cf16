//! What tables are printed with.

pub fn heading(title: &str, columns: &[&str]) {
    println!("\n{title}\n\n| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

pub fn percent(part: f64) -> String {
    format!("{:.1}%", 100.0 * part)
}
