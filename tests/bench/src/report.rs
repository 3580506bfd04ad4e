//! What a run found, for the terminal and for `tests/charts/bench.md`.

use std::path::PathBuf;

/// Text in Markdown.
#[derive(Debug, Default)]
pub struct Report(pub String);

impl Report {
    /// A line of its own.
    pub fn note(&mut self, text: &str) {
        println!("{text}\n");
        self.0 += &format!("{text}\n\n");
    }

    /// A table under a heading.
    pub fn table(&mut self, title: &str, head: &[&str], rows: &[Vec<String>]) {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let head: Vec<_> = head.iter().map(|&it| it.to_owned()).collect();
        let mut text = format!("## {title}\n\n{}", line(&head));
        text += &format!("|{}\n", "---|".repeat(head.len()));
        rows.iter().for_each(|row| text += &line(row));
        println!("{text}");
        self.0 += &text;
        self.0.push('\n');
    }
}

/// A quotient, to three digits.
pub fn ratio(x: f64) -> String {
    match x {
        _ if x >= 99.95 => format!("{x:.0}"),
        _ if x >= 9.995 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    }
}

/// A file among the charts.
pub fn chart(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../charts")
        .join(name)
}
