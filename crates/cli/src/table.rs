//! Tables of text for a terminal.

use std::fmt::Write;

/// How the cells of a column are aligned.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// The rows below one another, columns two spaces apart, without blanks at the ends of lines.
pub(crate) fn table(columns: &[Align], rows: &[Vec<String>]) -> String {
    let length = |text: &String| text.chars().count();
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(length).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::from(" ");
        for ((cell, &width), &align) in row.iter().zip(&widths).zip(columns) {
            // Writing into a string cannot fail.
            let _ = match align {
                Align::Left => write!(line, " {cell:<width$} "),
                Align::Right => write!(line, " {cell:>width$} "),
            };
        }
        out += line.trim_end();
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_in_characters() {
        let rows = [["⟨r²⟩", "1"], ["a", "100"]].map(|row| row.map(String::from).to_vec());
        assert_eq!(table(&[Align::Left, Align::Right], &rows), "  ⟨r²⟩    1\n  a     100\n");
    }
}
