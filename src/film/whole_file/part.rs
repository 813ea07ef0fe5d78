//! Temporary files on the way to their final names, and those that dead programs left behind.
//!
//! A temporary file is locked as long as the program that writes it lives; the system gives the lock back however that
//! ends.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

/// How the names of temporary files begin and end.
const NAME: [&str; 2] = [".whitted-", ".part"];

/// A temporary file in `folder`, gone when dropped. Its name is short whatever the target's, so
/// that a name that just fits does not fail here.
pub(super) fn create(folder: &Path) -> io::Result<NamedTempFile> {
    loop {
        let [prefix, suffix] = NAME;
        let file = tempfile::Builder::new()
            .prefix(prefix)
            .suffix(suffix)
            // Opened here, because tempfile would shut out everyone else, whatever the umask.
            .make_in(folder, |path| File::create_new(path))?;
        match file.as_file().try_lock() {
            Ok(()) if file.path().exists() => return Ok(file),
            // Without locks nobody sweeps.
            Err(TryLockError::Error(_)) => return Ok(file),
            // Swept between creation and lock.
            Ok(()) | Err(TryLockError::WouldBlock) => {}
        }
    }
}

/// Deletes the temporary files in `folder` whose programs are dead. What cannot be deleted stays.
pub(super) fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|n| n.starts_with(NAME[0]) && n.ends_with(NAME[1]));
        if !is_ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            // While the lock is held, or its writer could have locked it meanwhile.
            let _ = fs::remove_file(entry.path());
        }
    }
}
