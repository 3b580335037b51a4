//! The settings that files carry, found again in each of them.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use memchr::memmem;
use quick_xml::escape::unescape;
use serde::Deserialize;

use super::series::step_path;
use crate::config::settings::{BEGIN, END, PREFIXES};
use crate::names::CONFIG;
use crate::vtk::field_text;

/// Most formats have the text near their beginning: so many bytes are searched.
const SEARCHED_AT_BEGIN: u64 = 1 << 20;

/// Formats without comments have it behind all else: so many bytes are searched.
const SEARCHED_AT_END: u64 = 1 << 16;

/// The settings that a file carries, as TOML; nothing where it has none.
///
/// # Errors
/// Whatever the file system reports.
pub fn embedded_config(path: &Path) -> io::Result<Option<String>> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        // Collections have it in their files.
        Some("vtm") => embedded_config(&path.with_extension("").join("boundaries.vtp")),
        Some("pvd") => embedded_config(&step_path(path, 0)),
        Some("json") => Ok(of_json(File::open(path)?)),
        Some("stl") => Ok(of_stl(&ends(path)?)),
        Some("html") => {
            let text = extracted(&ends(path)?);
            Ok(text.and_then(|text| Some(unescape(&text).ok()?.into_owned())))
        }
        Some("vtp" | "vtu" | "vti") => {
            let bytes = ends(path)?;
            // Where numbers are encoded, texts are too.
            let encoded = || extracted(field_text(&bytes, CONFIG)?.as_bytes());
            Ok(extracted(&bytes).or_else(encoded))
        }
        _ => Ok(extracted(&ends(path)?)),
    }
}

/// The beginning of a file and its end, which is all of a small one.
fn ends(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    (&mut file).take(SEARCHED_AT_BEGIN).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == SEARCHED_AT_BEGIN {
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(SEARCHED_AT_BEGIN.max(length.saturating_sub(SEARCHED_AT_END))))?;
        file.read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

fn extracted(bytes: &[u8]) -> Option<String> {
    let begin = memmem::find(bytes, BEGIN.as_bytes())?;
    let end = begin + memmem::find(&bytes[begin..], END.as_bytes())?;
    let prefix = PREFIXES.iter().find(|prefix| bytes[..begin].ends_with(prefix.as_bytes()));
    let text = std::str::from_utf8(&bytes[begin..end]).ok()?;
    // The first line is a comment of TOML.
    let lines = text.lines().skip(1);
    let lines = lines.map(|line| prefix.and_then(|prefix| line.strip_prefix(prefix)).unwrap_or(line));
    Some(lines.map(|line| format!("{line}\n")).collect())
}

/// What an object has under `settings`.
fn of_json(file: File) -> Option<String> {
    #[derive(Deserialize)]
    struct Object {
        settings: toml::Table,
    }
    let object: Object = serde_json::from_reader(BufReader::new(file)).ok()?;
    toml::to_string(&object.settings).ok()
}

/// The table in the name of a solid: the first line of a text, or the 80 bytes at the head of a binary file.
fn of_stl(bytes: &[u8]) -> Option<String> {
    let head = if bytes.starts_with(b"solid") {
        bytes.split(|byte| *byte == b'\n').next()?
    } else {
        bytes.get(..80)?
    };
    let table = &head[memmem::find(head, b", grainsmooth ")?..];
    let table = std::str::from_utf8(&table[memmem::find(table, b"{")?..]).ok()?;
    let file: toml::Table = format!("settings={table}").parse().ok()?;
    toml::to_string(file.get("settings")?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Config, Provenance};

    #[test]
    fn settings_are_found_behind_any_sign() {
        let config = Config { random_seed: u64::MAX, ..Config::default() };
        let table: toml::Table = config.to_toml().parse().unwrap();
        assert_eq!(table["rng-seed"].as_str(), Some("18446744073709551615"));
        assert_eq!(table["box"].as_array().map(Vec::len), Some(3));
        for sign in PREFIXES {
            let mut bytes = b"ply\n".to_vec();
            Provenance::Config(&config).write_comments(sign, &mut bytes).unwrap();
            bytes.extend([0xff, 0, 1]);
            assert_eq!(extracted(&bytes).unwrap().parse(), Ok(table.clone()), "{sign}");
            assert_eq!(extracted(&bytes[..bytes.len() - 60]), None, "cut off");
        }
        let raw = [&[7, 0, 0, 0, 0, 0, 0, 0xff], config.to_toml().as_bytes(), &[0, 0xfe]].concat();
        assert_eq!(extracted(&raw).unwrap().parse(), Ok(table));
        assert_eq!(extracted(b"seeds = 200"), None);
    }
}
