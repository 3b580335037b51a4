//! Where networks go: a path of a known format, or a directory of grains.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use voronoi::Dimension;

use super::output_format::{OutputFormat, ToWrite};
use crate::files::output::{OutputPath, in_full};
use crate::files::staged_files::StagedFiles;
use crate::files::unfinished::{Unfinished, parent};
use crate::memory::free_space;
use crate::{Config, Error};

/// A path that was found writable, and the format of networks to write there.
pub type Output<Format = OutputFormat> = OutputPath<Format>;

impl OutputPath<OutputFormat> {
    /// Checks that a file of a known format can be written at `path`, without changing what is there; of a Gmsh mesh
    /// also the script beside it.
    ///
    /// # Errors
    /// [`Error::UnknownExtension`]; [`Error::NoOutputDirectory`]; [`Error::OutputNotAFile`] when something
    /// else has the name; [`Error::OutputNotWritable`] when the directory takes no new file or the present
    /// file is read-only.
    pub fn check(path: impl Into<PathBuf>) -> Result<Self, Error> {
        let path = path.into();
        let Some(format) = OutputFormat::of_path(&path) else {
            return Err(Error::UnknownExtension { path, known: OutputFormat::known_extensions() });
        };
        let output = Self::check_as(path, format)?;
        output.file_beside()?;
        Ok(output)
    }

    /// The file beside this one, where the format has one, found writable.
    pub(crate) fn file_beside(&self) -> Result<Option<OutputPath<()>>, Error> {
        self.format().file_beside(self.path()).map(|path| OutputPath::check_as(path, ())).transpose()
    }

    /// All files and directories that stand for the output, in full: a Gmsh mesh has a script beside it, blocks have a folder.
    pub fn targets(&self) -> Vec<PathBuf> {
        std::iter::once(self.target().to_owned()).chain(self.format().beside(self.target())).collect()
    }

    /// Checks that the format can hold what there is to write.
    ///
    /// # Errors
    /// As of [`OutputFormat::check_holds`].
    pub fn check_holds(&self, to_write: &ToWrite) -> Result<(), Error> {
        self.format().check_holds(self.path(), to_write)
    }

    /// Checks that voxels, whose number of bytes is known beforehand, have room where the file is to go.
    ///
    /// # Errors
    /// [`Error::OutputExceedsDisk`].
    pub fn check_space(&self, config: &Config) -> Result<(), Error> {
        let needed = config.voxel_count() * u128::from(self.format().bytes_of_voxel(config));
        match free_space(parent(self.target())) {
            Some(available) if needed > u128::from(available) => {
                Err(Error::OutputExceedsDisk { path: self.path().to_owned(), needed, available })
            }
            _ => Ok(()),
        }
    }
}

/// A directory for files that was found fit to be made, and the format of the files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputDirectory {
    path: PathBuf,
    /// The path from the root on.
    target: PathBuf,
    format: OutputFormat,
}

impl OutputDirectory {
    /// Checks that a directory can be made at `path`, or that an empty one is there.
    ///
    /// # Errors
    /// [`Error::OutputDirectoryTaken`] when something else is there; [`Error::NoOutputDirectory`];
    /// [`Error::OutputNotWritable`].
    pub fn check(path: impl Into<PathBuf>, format: OutputFormat) -> Result<Self, Error> {
        let path = path.into();
        let is_free = match fs::read_dir(&path) {
            Ok(mut entries) => entries.next().is_none(),
            Err(error) => error.kind() == io::ErrorKind::NotFound,
        };
        if !is_free {
            return Err(Error::OutputDirectoryTaken { path });
        }
        match in_full(&path)?.and_then(|target| Unfinished::directory(&target).map(|_| target)) {
            Ok(target) => Ok(Self { path, target, format }),
            Err(cause) => Err(Error::OutputNotWritable { path, cause }),
        }
    }

    /// Checks that grains of a dimension have surfaces.
    ///
    /// # Errors
    /// [`Error::FormatDimension`] in 2D.
    pub fn check_dimension(&self, dimension: Dimension) -> Result<(), Error> {
        match dimension {
            Dimension::Three => Ok(()),
            Dimension::Two => {
                Err(Error::FormatDimension { path: self.path.clone(), dimension: Dimension::Three })
            }
        }
    }

    /// The path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The format of the files.
    pub fn format(&self) -> OutputFormat {
        self.format
    }

    /// The path from the root on.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Completes the directory under a temporary name.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub(crate) fn stage(
        &self,
        files: &mut StagedFiles,
        fill: impl FnOnce(&Path) -> io::Result<()>,
    ) -> Result<(), Error> {
        files.directory(&self.target, &self.path, fill)
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;
    use std::io::Write;

    use super::*;

    fn names_in(directory: &Path) -> Vec<OsString> {
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn extension_names_the_format() {
        assert_eq!(OutputFormat::of_path(Path::new("a.b.VTU")), OutputFormat::of_extension("vtu"));
        assert_eq!(OutputFormat::of_path(Path::new("vtp")), None);
        for &format in OutputFormat::ALL {
            assert_eq!(
                OutputFormat::of_path(&Path::new("grains").with_extension(format.extension())),
                Some(format)
            );
        }

        let known = OutputFormat::known_extensions();
        assert!(known.starts_with("*.vtp, *.vtu, ") && known.ends_with(" or *.yaml"), "{known}");
        for name in ["grains", "grains.off", ".vtp"] {
            let error = Output::check(name).unwrap_err().to_string();
            assert_eq!(error, format!("{name}: unknown extension; name the file {known}"));
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
        assert!(
            error.ends_with("the present file is read-only; make it writable or choose another path"),
            "{error}"
        );
        assert_eq!(names_in(directory.path()).len(), 3, "checking leaves nothing behind");
    }

    #[test]
    fn file_appears_complete_and_replaces_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("grains.vtk");
        for text in ["first", "second"] {
            let output = Output::check(&path).unwrap();
            assert_eq!(
                (output.path(), output.format()),
                (&*path, OutputFormat::of_extension("vtk").unwrap())
            );
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
