//! Where results go: the path checked before the work begins, the file complete before it has its name.

use std::ffi::OsString;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::Error;

/// A file format that results are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputFormat {
    /// XML PolyData.
    Vtp,
    /// XML UnstructuredGrid.
    Vtu,
    /// Legacy PolyData.
    Vtk,
}

impl OutputFormat {
    /// Every format, the default first.
    pub const ALL: [Self; 3] = [Self::Vtp, Self::Vtu, Self::Vtk];

    /// The extension that stands for the format, without its dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Vtp => "vtp",
            Self::Vtu => "vtu",
            Self::Vtk => "vtk",
        }
    }

    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The extensions as a message lists them: `*.vtp, *.vtu or *.vtk`.
    pub(crate) fn known_extensions() -> String {
        let [others @ .., last] = Self::ALL.map(|format| format!("*.{}", format.extension()));
        format!("{} or {last}", others.join(", "))
    }
}

/// A path that was found writable, and the format to write there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output<Format = OutputFormat> {
    path: PathBuf,
    /// Where the file goes: `path`, or what it links to.
    target: PathBuf,
    format: Format,
}

impl Output {
    /// Checks that a file of a known format can be written at `path`, without changing what is there.
    ///
    /// # Errors
    /// [`Error::UnknownExtension`]; [`Error::NoOutputDirectory`]; [`Error::OutputNotAFile`] when something
    /// else has the name; [`Error::OutputNotWritable`] when the directory takes no new file or the present
    /// file is read-only.
    pub fn check(path: impl Into<PathBuf>) -> Result<Self, Error> {
        let path = path.into();
        match OutputFormat::of_path(&path) {
            Some(format) => Self::check_as(path, format),
            None => Err(Error::UnknownExtension { path }),
        }
    }
}

impl<Format: Copy> Output<Format> {
    /// Checks that a file can be written at `path`, whatever its extension, without changing what is there.
    ///
    /// # Errors
    /// As of [`check`](Output::check), but for the extension.
    pub fn check_as(path: impl Into<PathBuf>, format: Format) -> Result<Self, Error> {
        let path = path.into();
        let target = match fs::metadata(&path) {
            Ok(present) if !present.is_file() => return Err(Error::OutputNotAFile { path }),
            Ok(present) if present.permissions().readonly() => {
                let cause = io::Error::new(io::ErrorKind::PermissionDenied, "the present file is read-only");
                return Err(Error::OutputNotWritable { path, cause });
            }
            // Renaming over a link would replace the link.
            Ok(_) => fs::canonicalize(&path),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(path.clone()),
            Err(error) => Err(error),
        };
        let output = match target {
            Ok(target) => Self { path, target, format },
            Err(cause) => return Err(Error::OutputNotWritable { path, cause }),
        };
        if !output.directory().is_dir() {
            let directory = output.directory().to_owned();
            return Err(Error::NoOutputDirectory { path: output.path, directory });
        }
        match output.temporary_file() {
            Ok(_) => Ok(output),
            Err(cause) => Err(Error::OutputNotWritable { path: output.path, cause }),
        }
    }

    /// The path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The format to write.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Writes the file: `content` into a temporary file in the same directory, which takes the name when
    /// complete. A present file is replaced then, keeping its permissions.
    ///
    /// # Errors
    /// [`Error::WriteOutput`] when `content` or the file system fails. The temporary file is removed then,
    /// and a present file stays as it was.
    pub fn write(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        self.try_to_write(content).map_err(|cause| Error::WriteOutput { path: self.path.clone(), cause })
    }

    fn try_to_write(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let file = self.temporary_file()?;
        let mut writer = BufWriter::new(file.as_file());
        content(&mut writer)?;
        writer.flush()?;
        drop(writer);
        if let Ok(present) = fs::metadata(&self.target) {
            file.as_file().set_permissions(present.permissions())?;
        }
        file.persist(&self.target)?;
        Ok(())
    }

    fn temporary_file(&self) -> io::Result<NamedTempFile> {
        let mut prefix = OsString::from(".");
        prefix.push(self.target.file_name().unwrap_or_default());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".part");
        // What any new file gets; the system takes the umask away from it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(self.directory())
    }

    fn directory(&self) -> &Path {
        match self.target.parent() {
            Some(directory) if directory != Path::new("") => directory,
            _ => Path::new("."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(directory: &Path) -> Vec<OsString> {
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn extension_names_the_format() {
        assert_eq!(OutputFormat::of_path(Path::new("a.b.VTU")), Some(OutputFormat::Vtu));
        assert_eq!(OutputFormat::of_path(Path::new("vtp")), None);
        for format in OutputFormat::ALL {
            assert_eq!(
                OutputFormat::of_path(&Path::new("grains").with_extension(format.extension())),
                Some(format)
            );
        }

        for name in ["grains", "grains.obj", ".vtp"] {
            let error = Output::check(name).unwrap_err().to_string();
            assert_eq!(error, format!("{name}: unknown extension; name the file *.vtp, *.vtu or *.vtk"));
        }
    }

    #[test]
    fn paths_that_cannot_be_written_are_found_beforehand() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);

        let error = Output::check(at("missing/grains.vtp")).unwrap_err();
        assert!(matches!(&error, Error::NoOutputDirectory { directory, .. } if *directory == at("missing")));
        assert!(error.to_string().contains("create it"), "{error}");

        fs::create_dir(at("folder.vtp")).unwrap();
        assert!(matches!(Output::check(at("folder.vtp")), Err(Error::OutputNotAFile { .. })));

        fs::write(at("file"), "").unwrap();
        let error = Output::check(at("file/grains.vtp")).unwrap_err().to_string();
        assert!(error.starts_with(&at("file/grains.vtp").display().to_string()), "{error}");

        fs::write(at("kept.vtp"), "kept").unwrap();
        let mut permissions = fs::metadata(at("kept.vtp")).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(at("kept.vtp"), permissions).unwrap();
        let error = Output::check(at("kept.vtp")).unwrap_err().to_string();
        assert!(error.ends_with("the present file is read-only; allow it or choose another path"), "{error}");
        assert_eq!(names_in(directory.path()).len(), 3, "checking leaves nothing behind");
    }

    #[test]
    fn file_appears_complete_and_replaces_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("grains.vtk");
        for text in ["first", "second"] {
            let output = Output::check(&path).unwrap();
            assert_eq!((output.path(), output.format()), (&*path, OutputFormat::Vtk));
            output.write(|out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
            assert_eq!(names_in(directory.path()), ["grains.vtk"]);
        }
    }

    #[test]
    fn failed_write_leaves_nothing_and_keeps_the_old_file() {
        let full_disk = |out: &mut dyn Write| {
            out.write_all(&[b'x'; 100_000])?;
            Err(io::ErrorKind::StorageFull.into())
        };
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("grains.vtp");
        let output = Output::check(&path).unwrap();

        let error = output.write(full_disk).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!(
                "{}: writing failed and left nothing: no storage space",
                path.display()
            )),
            "{error}"
        );
        assert!(names_in(directory.path()).is_empty());

        output.write(|out| out.write_all(b"good")).unwrap();
        output.write(full_disk).unwrap_err();
        assert_eq!(fs::read_to_string(&path).unwrap(), "good");
        assert_eq!(names_in(directory.path()), ["grains.vtp"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_replaced_one() {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;

        let directory = tempfile::tempdir().unwrap();
        let plain = directory.path().join("plain");
        fs::write(&plain, "").unwrap();
        let path = directory.path().join("grains.vtp");
        let output = Output::check(&path).unwrap();
        output.write(|out| out.write_all(b"1")).unwrap();
        assert_eq!(mode(&path), mode(&plain));

        fs::set_permissions(&path, PermissionsExt::from_mode(0o640)).unwrap();
        output.write(|out| out.write_all(b"2")).unwrap();
        assert_eq!((mode(&path), fs::read(&path).unwrap()), (0o640, b"2".to_vec()));
    }

    #[cfg(unix)]
    #[test]
    fn link_stays_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let (target, link) = (directory.path().join("target"), directory.path().join("link.vtp"));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        Output::check(&link).unwrap().write(|out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    }
}
