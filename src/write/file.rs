//! Files that are either whole or not there.

use crate::error::{Error, Result};
use image::{DynamicImage, ImageFormat};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::{Builder, NamedTempFile};

/// How the names of temporary files begin and end.
const PREFIX: &str = ".trace-";
const SUFFIX: &str = ".tmp";
/// A temporary file that is older than this belongs to a run that was killed.
const ABANDONED: Duration = Duration::from_secs(600);

/// Puts bytes in a file: they go to a temporary file in the same folder, which then takes the name. A
/// file of that name keeps its old content until then, and its permissions; a link is followed. `-` is
/// standard output, where a reader that has gone away is not an error. What is not a regular file, such as
/// a pipe, is written to directly.
///
/// # Errors
/// [`Error::Write`] with the path and the reason; nothing is left behind.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = if path.as_os_str() == "-" { to_stdout(bytes) } else { to_file(path, bytes) };
    written.map_err(|cause| Error::Write { path: path.to_owned(), cause })
}

/// The same with a picture, as PNG.
///
/// # Errors
/// [`Error::Write`] with the path and the reason.
pub fn write_png(path: &Path, picture: &DynamicImage) -> Result<()> {
    let mut png = io::Cursor::new(Vec::new());
    let encoded = picture.write_to(&mut png, ImageFormat::Png);
    encoded.map_err(|e| Error::Write { path: path.to_owned(), cause: io::Error::other(e) })?;
    write_file(path, &png.into_inner())
}

fn to_stdout(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

fn to_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (target, old) = match fs::metadata(path) {
        Ok(old) if old.is_dir() => return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")),
        Ok(old) if !old.is_file() => return fs::OpenOptions::new().write(true).open(path)?.write_all(bytes),
        Ok(old) if old.permissions().readonly() => {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only"));
        }
        Ok(old) => (fs::canonicalize(path)?, Some(old.permissions())),
        Err(_) => (path.to_owned(), None),
    };
    let mut file = temporary_beside(&target).map_err(plain)?;
    file.write_all(bytes).map_err(plain)?;
    if let Some(permissions) = old {
        file.as_file().set_permissions(permissions)?;
    }
    file.persist(&target).map(drop).map_err(|e| plain(e.error))
}

/// A new file in the target's folder, with the permissions of any new file.
fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
    builder.tempfile_in(folder)
}

/// Removes what killed runs left in a folder: temporary files that nobody has written to for ten minutes, where a write
/// takes milliseconds. What cannot be listed or removed stays.
pub fn remove_abandoned(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        let ours = name.starts_with(PREFIX.as_bytes()) && name.ends_with(SUFFIX.as_bytes());
        let age = || entry.metadata().ok().filter(fs::Metadata::is_file)?.modified().ok()?.elapsed().ok();
        if ours && age().is_some_and(|age| age > ABANDONED) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The error without the temporary file's name.
fn plain(error: io::Error) -> io::Error {
    match error.kind() {
        io::ErrorKind::NotFound => io::Error::new(error.kind(), "the folder does not exist"),
        kind => kind.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        write_file(&path, b"first").unwrap();
        write_file(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.svg"]);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("no/such/a.svg");
        let error = write_file(&path, b"x").unwrap_err();
        assert!(error.to_string().contains("a.svg"), "{error}");
        assert_eq!(std::error::Error::source(&error).unwrap().to_string(), "the folder does not exist");
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_folder_and_a_read_only_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write_file(folder.path(), b"x").is_err());
        let path = folder.path().join("a.svg");
        fs::write(&path, b"old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert!(write_file(&path, b"new").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.svg"]);
    }

    #[test]
    fn only_old_temporary_files_of_ours_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let hour_ago = std::time::SystemTime::now() - 6 * ABANDONED;
        let kept = [".hidden.tmp", ".trace-", ".trace-x.svg", ".trace-young.tmp", "trace-a.tmp", "x.svg"];
        for name in kept.iter().chain(&[".trace-old.tmp", ".trace-a b.tmp"]) {
            let file = fs::File::create(folder.path().join(name)).unwrap();
            file.set_modified(if name.contains("young") { hour_ago + 6 * ABANDONED } else { hour_ago }).unwrap();
        }
        fs::create_dir(folder.path().join(".trace-folder.tmp")).unwrap();
        remove_abandoned(folder.path());
        remove_abandoned(&folder.path().join("nowhere"));
        let left = names(folder.path());
        assert_eq!(left.len(), kept.len() + 1, "{left:?}");
        assert!(kept.iter().all(|name| left.contains(&(*name).into())), "{left:?}");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let (ours, plain) = (folder.path().join("a.svg"), folder.path().join("b.svg"));
        write_file(&ours, b"x").unwrap();
        fs::write(&plain, b"x").unwrap();
        assert_eq!(mode(&ours), mode(&plain));
        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        write_file(&ours, b"y").unwrap();
        assert_eq!(mode(&ours), 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_written_to() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("a.svg"), folder.path().join("link.svg"));
        fs::write(&file, b"x").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_file(&link, b"y").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"y");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_file(Path::new("/dev/null"), b"z").unwrap();
    }
}
