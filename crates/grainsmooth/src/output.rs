//! Where results go: the path checked before the work begins, the file complete before it has its name.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use voronoi::Dimension;

use crate::memory::free_space;
use crate::staged_files::{StagedFiles, write_together};
use crate::unfinished::{Unfinished, parent};
use crate::vtk::{VtkEncoding, VtkFormat};
use crate::{Config, Error};

/// A file format that results are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputFormat {
    /// One of VTK's for surfaces.
    Vtk(VtkFormat),
    /// VTK's multi-block file, with its blocks in a folder of the same name.
    Vtm,
    /// STL, every boundary once.
    Stl,
    /// PLY, binary.
    Ply,
    /// OBJ with a group for each boundary.
    Obj,
    /// Gmsh's mesh format 4.1.
    Msh,
    /// Surface Evolver's datafile.
    Fe,
    /// Neper's tessellation of the flat cells.
    Tess,
    /// The grain of each voxel as VTK ImageData.
    Vti,
    /// The grain of each voxel as a NumPy array.
    Npy,
    /// A hexahedron for each voxel, for Abaqus and CalculiX.
    Inp,
    /// The orientation of each pixel, as TSL has it.
    Ang,
    /// The same, as HKL has it.
    Ctf,
    /// A table of the grains' Euler angles.
    Txt,
    /// Neper's list of the grains' orientations.
    Ori,
    /// DAMASK's list of the grains' materials.
    Yaml,
}

impl OutputFormat {
    /// Every format, the default first.
    pub const ALL: [Self; 18] = [
        Self::Vtk(VtkFormat::Vtp),
        Self::Vtk(VtkFormat::Vtu),
        Self::Vtk(VtkFormat::Vtk),
        Self::Vtm,
        Self::Stl,
        Self::Ply,
        Self::Obj,
        Self::Msh,
        Self::Fe,
        Self::Tess,
        Self::Vti,
        Self::Npy,
        Self::Inp,
        Self::Ang,
        Self::Ctf,
        Self::Txt,
        Self::Ori,
        Self::Yaml,
    ];

    /// The extension that stands for the format, without its dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Vtk(format) => format.extension(),
            Self::Vtm => "vtm",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Obj => "obj",
            Self::Msh => "msh",
            Self::Fe => "fe",
            Self::Tess => "tess",
            Self::Vti => "vti",
            Self::Npy => "npy",
            Self::Inp => "inp",
            Self::Ang => "ang",
            Self::Ctf => "ctf",
            Self::Txt => "txt",
            Self::Ori => "ori",
            Self::Yaml => "yaml",
        }
    }

    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The extensions as a message lists them: `*.vtp, *.vtu or *.vtk`.
    pub fn known_extensions() -> String {
        let [others @ .., last] = Self::ALL.map(|format| format!("*.{}", format.extension()));
        format!("{} or {last}", others.join(", "))
    }

    /// Whether the format holds voxels.
    pub fn has_voxels(self) -> bool {
        matches!(self, Self::Vti | Self::Npy | Self::Inp | Self::Ang | Self::Ctf)
    }

    /// Whether the format is a single file, as standard output takes.
    pub fn is_single_file(self) -> bool {
        !matches!(self, Self::Vtm | Self::Msh)
    }

    /// The only dimension that the format can hold, if there is such a one.
    fn only_dimension(self) -> Option<Dimension> {
        match self {
            Self::Stl | Self::Ply | Self::Obj | Self::Msh | Self::Fe => Some(Dimension::Three),
            Self::Ang | Self::Ctf => Some(Dimension::Two),
            Self::Vtk(_) | Self::Vtm | Self::Tess | Self::Vti | Self::Npy | Self::Inp => None,
            Self::Txt | Self::Ori | Self::Yaml => None,
        }
    }

    /// Checks that the format can hold what a config makes, for an output that messages call `path`.
    ///
    /// # Errors
    /// [`Error::FormatDimension`]; [`Error::NoVoxels`] for a format of voxels when their number is not given; [`Error::NoTexture`] for one
    /// of orientations where grains have none.
    pub fn check_fits(self, path: &Path, config: &Config) -> Result<(), Error> {
        let path = || path.to_owned();
        match self.only_dimension() {
            Some(dimension) if dimension != config.dimension => {
                Err(Error::FormatDimension { path: path(), dimension })
            }
            _ if self.has_voxels() && config.file.voxels.is_none() => Err(Error::NoVoxels { path: path() }),
            _ if matches!(self, Self::Txt | Self::Ori | Self::Yaml) && !config.has_texture() => {
                Err(Error::NoTexture { path: path() })
            }
            _ => Ok(()),
        }
    }
}

/// A path that was found writable, and the format to write there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output<Format = OutputFormat> {
    path: PathBuf,
    /// The path from the root on, or what it links to.
    target: PathBuf,
    format: Format,
}

impl Output {
    /// Checks that a file of a known format can be written at `path`, without changing what is there; of a Gmsh mesh
    /// also the script beside it.
    ///
    /// # Errors
    /// [`Error::UnknownExtension`]; [`Error::NoOutputDirectory`]; [`Error::OutputNotAFile`] when something
    /// else has the name; [`Error::OutputNotWritable`] when the directory takes no new file or the present
    /// file is read-only.
    pub fn check(path: impl Into<PathBuf>) -> Result<Self, Error> {
        let path = path.into();
        let Some(format) = OutputFormat::of_path(&path) else { return Err(Error::UnknownExtension { path }) };
        let output = Self::check_as(path, format)?;
        output.gmsh_script()?;
        Ok(output)
    }

    /// The script beside a Gmsh mesh, found writable.
    pub(crate) fn gmsh_script(&self) -> Result<Option<Output<()>>, Error> {
        let is_gmsh = self.format == OutputFormat::Msh;
        is_gmsh.then(|| Output::check_as(self.path.with_extension("geo"), ())).transpose()
    }

    /// All files and directories that stand for the output, in full: a Gmsh mesh has a script beside it, blocks have a folder.
    pub fn targets(&self) -> Vec<PathBuf> {
        let beside = match self.format {
            OutputFormat::Msh => Some(self.target.with_extension("geo")),
            OutputFormat::Vtm => Some(self.target.with_extension("")),
            _ => None,
        };
        std::iter::once(self.target.clone()).chain(beside).collect()
    }

    /// Checks that the format can hold what a config makes.
    ///
    /// # Errors
    /// As of [`OutputFormat::check_fits`].
    pub fn check_fits(&self, config: &Config) -> Result<(), Error> {
        self.format.check_fits(&self.path, config)
    }

    /// Checks that voxels, whose number of bytes is known beforehand, have room where the file is to go.
    ///
    /// # Errors
    /// [`Error::OutputExceedsDisk`].
    pub fn check_space(&self, config: &Config) -> Result<(), Error> {
        let of_voxel = match self.format {
            OutputFormat::Npy => 4,
            OutputFormat::Vti if config.file.encoding != VtkEncoding::Zlib => config.bytes_of_voxel(),
            _ => 0,
        };
        let needed = config.voxel_count() * u128::from(of_voxel);
        match free_space(parent(&self.target)) {
            Some(available) if needed > u128::from(available) => {
                Err(Error::OutputExceedsDisk { path: self.path.clone(), needed, available })
            }
            _ => Ok(()),
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
            Err(error) if error.kind() == io::ErrorKind::NotFound => in_full(&path)?,
            Err(error) => Err(error),
        };
        match target.and_then(|target| Unfinished::file(&target).map(|_| target)) {
            Ok(target) => Ok(Self { path, target, format }),
            Err(cause) => Err(Error::OutputNotWritable { path, cause }),
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

    /// The path from the root on, or what it links to.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Completes the file under a temporary name, as one of several that appear together.
    ///
    /// # Errors
    /// [`Error::WriteOutput`] when `content` or the file system fails; [`Error::OutputTwice`].
    pub fn stage(
        &self,
        files: &mut StagedFiles,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        files.file(&self.target, &self.path, content)
    }

    /// Writes the file: `content` into a temporary file in the same directory, which takes the name when
    /// complete. A present file is replaced then, keeping its permissions.
    ///
    /// # Errors
    /// [`Error::WriteOutput`] when `content` or the file system fails. The temporary file is removed then,
    /// and a present file stays as it was.
    pub fn write(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        write_together(|files| self.stage(files, content))
    }
}

/// The path of a new file from the root on.
fn in_full(path: &Path) -> Result<io::Result<PathBuf>, Error> {
    let directory = parent(path);
    if !directory.is_dir() {
        return Err(Error::NoOutputDirectory { path: path.to_owned(), directory: directory.to_owned() });
    }
    Ok(fs::canonicalize(directory).map(|directory| directory.join(path.file_name().unwrap_or_default())))
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

    /// Checks that a config makes grains with surfaces.
    ///
    /// # Errors
    /// [`Error::FormatDimension`] in 2D.
    pub fn check_fits(&self, config: &Config) -> Result<(), Error> {
        let dimension = Dimension::Three;
        match config.dimension {
            Dimension::Three => Ok(()),
            Dimension::Two => Err(Error::FormatDimension { path: self.path.clone(), dimension }),
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

    use super::*;

    fn names_in(directory: &Path) -> Vec<OsString> {
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn extension_names_the_format() {
        assert_eq!(OutputFormat::of_path(Path::new("a.b.VTU")), Some(OutputFormat::Vtk(VtkFormat::Vtu)));
        assert_eq!(OutputFormat::of_path(Path::new("vtp")), None);
        for format in OutputFormat::ALL {
            assert_eq!(
                OutputFormat::of_path(&Path::new("grains").with_extension(format.extension())),
                Some(format)
            );
        }

        let known = "*.vtp, *.vtu, *.vtk, *.vtm, *.stl, *.ply, *.obj, *.msh, *.fe, *.tess, *.vti, *.npy, *.inp, *.ang, *.ctf, *.txt, *.ori or *.yaml";
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
        assert!(error.ends_with("the present file is read-only; allow it or choose another path"), "{error}");
        assert_eq!(names_in(directory.path()).len(), 3, "checking leaves nothing behind");
    }

    #[test]
    fn file_appears_complete_and_replaces_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("grains.vtk");
        for text in ["first", "second"] {
            let output = Output::check(&path).unwrap();
            assert_eq!((output.path(), output.format()), (&*path, OutputFormat::Vtk(VtkFormat::Vtk)));
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
