//! Finding the files that another file names: beside it, in whatever letter case, and from Windows paths.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::scene::text::name_of;

/// The largest picture file that is read, in bytes.
pub(crate) const LARGEST_PICTURE: u64 = 1 << 30;

/// The file that `name` means in a file of the folder `base`: the path as it is, then with its letters in any case,
/// then its last part alone beside the file.
pub(crate) fn find(base: &Path, name: &str) -> Option<PathBuf> {
    if name.is_empty() || name.contains('\0') {
        return None;
    }
    let direct = base.join(name);
    if direct.is_file() {
        return Some(direct);
    }
    let forward = name.replace('\\', "/");
    let parts: Vec<&str> = forward.split('/').filter(|part| !part.is_empty()).collect();
    let has_drive = parts.first().is_some_and(|part| part.ends_with(':'));
    if !forward.starts_with('/')
        && !has_drive
        && let Some(path) = walk(base, &parts)
    {
        return Some(path);
    }
    walk(base, parts.last().map(std::slice::from_ref)?)
}

/// Follows `parts` from `base`, each in any letter case, to a file.
fn walk(base: &Path, parts: &[&str]) -> Option<PathBuf> {
    let mut path = base.to_owned();
    for part in parts {
        path = match *part {
            "." => continue,
            ".." => path.join(".."),
            part => {
                let exact = path.join(part);
                if exact.exists() { exact } else { path.join(entry(&path, part)?) }
            }
        };
    }
    path.is_file().then_some(path)
}

/// The entry of a folder that has this name in other letter case or encoding; the first by name if there are several.
fn entry(folder: &Path, name: &str) -> Option<std::ffi::OsString> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let wanted = name.to_lowercase();
    let entries = fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.file_name()));
    entries.filter(|entry| name_of(entry.as_encoded_bytes()).to_lowercase() == wanted).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_any_case_and_from_other_systems() {
        let folder = tempfile::tempdir().expect("a folder");
        let base = folder.path();
        fs::create_dir(base.join("Tex")).expect("a folder");
        fs::write(base.join("Tex/Wood.PNG"), "").expect("a file");
        fs::write(base.join("stone.jpg"), "").expect("a file");
        for (name, file) in [
            ("stone.jpg", "stone.jpg"),
            ("STONE.JPG", "stone.jpg"),
            ("C:\\Users\\me\\Stone.jpg", "stone.jpg"),
            ("/home/me/stone.jpg", "stone.jpg"),
            ("..\\other\\stone.jpg", "stone.jpg"),
            ("tex\\wood.png", "Tex/Wood.PNG"),
            (".\\tex/WOOD.png", "Tex/Wood.PNG"),
        ] {
            assert_eq!(find(base, name), Some(base.join(file)), "{name}");
        }
        for name in ["", "wood.png", "Tex", "/", "\\", "stone.jpg/x"] {
            assert_eq!(find(base, name), None, "{name}");
        }
    }
}
