use std::path::Path;

/// Whether a text is the name of a file of sizes: its extension is one of tables, or there is such a file.
pub(crate) fn is_table_file(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    matches!(extension.to_str(), Some("csv" | "txt")) || path.is_file()
}
