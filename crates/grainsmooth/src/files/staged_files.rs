//! The files of a run: first each is completed under a temporary name, then all get their own.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Error;
use crate::files::unfinished::{Unfinished, hidden, parent, remove, unfinished_paths};

/// Files and directories that are complete under temporary names.
#[derive(Debug)]
pub struct StagedFiles {
    moves: Vec<Move>,
    targets: BTreeSet<PathBuf>,
    temporaries: Vec<Unfinished>,
}

/// What stands under a temporary name, and the name that it is to have.
#[derive(Debug)]
struct Move {
    from: PathBuf,
    to: PathBuf,
    /// The name as messages have it.
    path: PathBuf,
}

/// Writes files that appear together: `stage` completes each under a temporary name; if all goes well, all get their own
/// names, and otherwise none does, and what was there before stays as it was.
///
/// # Errors
/// Those of `stage`; [`Error::WriteOutput`] where a file cannot get its name.
pub fn write_together<T, E: From<Error>>(
    stage: impl FnOnce(&mut StagedFiles) -> Result<T, E>,
) -> Result<T, E> {
    let mut files = StagedFiles { moves: Vec::new(), targets: BTreeSet::new(), temporaries: Vec::new() };
    let result = stage(&mut files)?;
    files.commit()?;
    Ok(result)
}

impl StagedFiles {
    /// Completes a file that is to be `target`, which messages call `path`. It gets the permissions of a present one.
    pub(crate) fn file(
        &mut self,
        target: &Path,
        path: &Path,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        let write = || {
            let (temporary, file) = Unfinished::file(target)?;
            let mut writer = BufWriter::new(&file);
            content(&mut writer)?;
            writer.flush()?;
            drop(writer);
            if let Ok(present) = fs::metadata(target) {
                file.set_permissions(present.permissions())?;
            }
            Ok(temporary)
        };
        let temporary = write().map_err(|cause| Error::WriteOutput { path: path.to_owned(), cause })?;
        self.add_move(temporary.path().to_owned(), target.to_owned(), path)?;
        self.temporaries.push(temporary);
        Ok(())
    }

    /// Fills a directory that is to be `target`, in place of an empty one, and that messages call `path`.
    pub(crate) fn directory(
        &mut self,
        target: &Path,
        path: &Path,
        fill: impl FnOnce(&Path) -> io::Result<()>,
    ) -> Result<(), Error> {
        let temporary = filled(target, path, fill)?;
        self.add_move(temporary.path().to_owned(), target.to_owned(), path)?;
        self.temporaries.push(temporary);
        Ok(())
    }

    /// Completes files that are to stand in the directory `target`, which may be there and hold others. Messages call
    /// them `path`.
    pub(crate) fn files_in(
        &mut self,
        target: &Path,
        path: &Path,
        fill: impl FnOnce(&Path) -> io::Result<()>,
    ) -> Result<(), Error> {
        let temporary = filled(target, path, fill)?;
        let failed = |cause| Error::WriteOutput { path: path.to_owned(), cause };
        for entry in fs::read_dir(temporary.path()).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            self.add_move(entry.path(), target.join(entry.file_name()), path)?;
        }
        self.temporaries.push(temporary);
        Ok(())
    }

    fn add_move(&mut self, from: PathBuf, to: PathBuf, path: &Path) -> Result<(), Error> {
        if !self.targets.insert(to.clone()) {
            return Err(Error::OutputTwice { path: path.to_owned() });
        }
        self.moves.push(Move { from, to, path: path.to_owned() });
        Ok(())
    }

    /// Gives all their names, or none.
    fn commit(self) -> Result<(), Error> {
        // An interruption waits until all have their names.
        let _held = unfinished_paths();
        let mut changes = Changes::default();
        for Move { from, to, path } in &self.moves {
            if let Err(cause) = changes.rename(from, to) {
                changes.take_back();
                return Err(Error::WriteOutput { path: path.clone(), cause });
            }
        }
        changes.keep();
        Ok(())
    }
}

fn filled(
    target: &Path,
    path: &Path,
    fill: impl FnOnce(&Path) -> io::Result<()>,
) -> Result<Unfinished, Error> {
    let fill = || {
        let temporary = Unfinished::directory(target)?;
        fill(temporary.path())?;
        Ok(temporary)
    };
    fill().map_err(|cause| Error::WriteOutput { path: path.to_owned(), cause })
}

/// What was changed in the file system, in order.
#[derive(Default)]
struct Changes(Vec<Change>);

enum Change {
    /// A file or directory has a name that was free.
    Named(PathBuf),
    /// A file has the name of another, which stands aside.
    Replaced {
        path: PathBuf,
        aside: PathBuf,
    },
    MadeDirectory(PathBuf),
    RemovedDirectory(PathBuf),
}

impl Changes {
    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        let directory = parent(to);
        if !directory.is_dir() {
            fs::create_dir(directory)?;
            self.0.push(Change::MadeDirectory(directory.to_owned()));
        }
        if to.is_dir() {
            fs::remove_dir(to)?;
            self.0.push(Change::RemovedDirectory(to.to_owned()));
        }
        if fs::symlink_metadata(to).is_ok() {
            let aside = set_aside(to)?;
            self.0.push(Change::Replaced { path: to.to_owned(), aside });
            return fs::rename(from, to);
        }
        fs::rename(from, to)?;
        self.0.push(Change::Named(to.to_owned()));
        Ok(())
    }

    /// Puts all back as it was. What cannot be put back stays where messages can no longer help.
    fn take_back(self) {
        for change in self.0.into_iter().rev() {
            let _ = match change {
                Change::Named(path) => {
                    remove(&path);
                    Ok(())
                }
                // Where both names still are the same file, renaming does nothing.
                Change::Replaced { path, aside } => fs::rename(&aside, path).map(|()| remove(&aside)),
                Change::MadeDirectory(path) => fs::remove_dir(path),
                Change::RemovedDirectory(path) => fs::create_dir(path),
            };
        }
    }

    /// Removes what was replaced.
    fn keep(self) {
        for change in self.0 {
            if let Change::Replaced { aside, .. } = change {
                remove(&aside);
            }
        }
    }
}

/// Gives a file a second, hidden name; where the file system knows no second names, that name alone.
fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let prefix = hidden(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".old");
    let aside = builder.make_in(parent(path), |aside| {
        fs::hard_link(path, aside).or_else(|cause| match cause.kind() {
            // Another name is tried then.
            io::ErrorKind::AlreadyExists => Err(cause),
            _ => fs::rename(path, aside),
        })
    })?;
    Ok(aside.into_temp_path().keep()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Stages a file over `old`, a new one, a directory in place of an empty one, files of a folder, and then `last`.
    fn stage_all(directory: &Path, last: &Path) -> Result<(), Error> {
        let write = |text: &'static str| move |out: &mut dyn Write| out.write_all(text.as_bytes());
        let at = |name: &str| directory.join(name);
        write_together(|files| {
            files.file(&at("old"), Path::new("old"), write("changed"))?;
            files.file(&at("new"), Path::new("new"), write("new"))?;
            files.directory(&at("empty"), Path::new("empty"), |folder| fs::write(folder.join("one"), "1"))?;
            files
                .files_in(&at("folder"), Path::new("folder"), |folder| fs::write(folder.join("two"), "2"))?;
            files.file(last, Path::new("last"), write("last"))?;
            assert_eq!(fs::read_to_string(at("old")).unwrap(), "kept", "nothing has its name yet");
            if last.starts_with(at("gone")) {
                fs::remove_dir_all(at("gone")).unwrap();
            }
            Ok(())
        })
    }

    fn prepared() -> tempfile::TempDir {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("old"), "kept").unwrap();
        for name in ["empty", "gone"] {
            fs::create_dir(directory.path().join(name)).unwrap();
        }
        directory
    }

    #[test]
    fn all_files_appear_together() {
        let directory = prepared();
        let at = |name: &str| directory.path().join(name);
        stage_all(directory.path(), &at("last")).unwrap();
        assert_eq!(names_in(directory.path()), ["empty", "folder", "gone", "last", "new", "old"]);
        for (name, text) in
            [("old", "changed"), ("new", "new"), ("empty/one", "1"), ("folder/two", "2"), ("last", "last")]
        {
            assert_eq!(fs::read_to_string(at(name)).unwrap(), text);
        }
    }

    #[test]
    fn what_cannot_have_its_name_takes_back_the_names_of_all() {
        let directory = prepared();
        let at = |name: &str| directory.path().join(name);
        let error = stage_all(directory.path(), &at("gone/last")).unwrap_err().to_string();
        assert!(error.starts_with("last: writing failed and left nothing: "), "{error}");
        assert_eq!(names_in(directory.path()), ["empty", "old"]);
        assert_eq!(fs::read_to_string(at("old")).unwrap(), "kept");
        assert!(names_in(&at("empty")).is_empty());
    }

    #[test]
    fn two_outputs_of_one_path_are_refused() {
        let directory = prepared();
        let error = stage_all(directory.path(), &directory.path().join("new")).unwrap_err().to_string();
        assert_eq!(error, "last: two outputs have this path; give each a path of its own");
        assert_eq!(names_in(directory.path()), ["empty", "gone", "old"]);
    }
}
