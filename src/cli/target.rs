//! Where results go, checked before the work for them starts.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use whitted::film::{Film, Format, Label, OutputFile, Share, WholeFile, write_png};

use super::failure::Failure;
use super::streams;

/// Where a picture goes.
pub(crate) enum Picture {
    Stdout,
    File(OutputFile),
}

impl Picture {
    /// The place that the user names, or one named after the scene; with the share in its name if `named_by_share`.
    pub(crate) fn prepare(
        output: Option<&Path>,
        scene: &str,
        share: Option<Share>,
        named_by_share: bool,
    ) -> Result<Self, Failure> {
        let path = match output {
            Some(path) if path == Path::new("-") => {
                return if io::stdout().is_terminal() {
                    Err(Failure::usage(anyhow!(
                        "--output -: standard output is a terminal, which shows no PNG; redirect \
                         it or name a file"
                    )))
                } else {
                    Ok(Self::Stdout)
                };
            }
            Some(path) => path.to_owned(),
            None => PathBuf::from(format!("{scene}.png")),
        };
        let path = match share {
            Some(share) if named_by_share => with_share(&path, share),
            _ => path,
        };
        let file = OutputFile::prepare(path)?;
        if share.is_some() && file.format() == Format::Ppm {
            return Err(Failure::usage(anyhow!(
                "{}: a .ppm file cannot say which tile it is; write .png or .exr",
                file.file().path().display()
            )));
        }
        Ok(Self::File(file))
    }

    /// The file, if it is one on disk, beside which there can be a checkpoint.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(file) if file.file().is_on_disk() => Some(file.file().path()),
            _ => None,
        }
    }

    pub(crate) fn format(&self) -> Format {
        match self {
            Self::Stdout => Format::Png,
            Self::File(file) => file.format(),
        }
    }

    /// For the user.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Stdout => "a PNG to standard output".to_owned(),
            Self::File(file) => file.file().path().display().to_string(),
        }
    }

    pub(crate) fn write(&self, film: &Film, label: &Label) -> Result<(), Failure> {
        match self {
            Self::Stdout => {
                let mut bytes = Vec::new();
                write_png(film, Some(label), &mut bytes)?;
                streams::to_stdout(|stdout| stdout.write_all(&bytes))
            }
            Self::File(file) => Ok(file.commit(film, Some(label))?),
        }
    }
}

/// The name with the share behind its stem: `a-3of64.png`.
fn with_share(path: &Path, Share { index, of }: Share) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{index}of{of}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Where the statistics go.
pub(crate) enum StatsTarget {
    Stdout,
    File(WholeFile),
}

impl StatsTarget {
    /// The place that the user names, with the share in its name if there are several.
    pub(crate) fn prepare(path: &Path, share: Option<Share>) -> Result<Self, Failure> {
        if path == Path::new("-") {
            return Ok(Self::Stdout);
        }
        let path = share.map_or_else(|| path.to_owned(), |share| with_share(path, share));
        Ok(Self::File(WholeFile::prepare(path).context("--stats")?))
    }

    pub(crate) fn write(&self, json: &str) -> Result<(), Failure> {
        match self {
            Self::Stdout => streams::to_stdout(|stdout| stdout.write_all(json.as_bytes())),
            Self::File(file) => {
                let done = file.commit(|writer| writer.write_all(json.as_bytes()));
                Ok(done.context("--stats")?)
            }
        }
    }
}

/// Two results in one place would spoil each other.
pub(crate) fn check_apart(picture: &Picture, stats: Option<&StatsTarget>) -> Result<(), Failure> {
    let place = match (picture, stats) {
        (Picture::Stdout, Some(StatsTarget::Stdout)) => "standard output",
        (Picture::File(picture), Some(StatsTarget::File(stats)))
            if picture.file().is_same_file(stats) =>
        {
            "the same file"
        }
        _ => return Ok(()),
    };
    Err(Failure::usage(anyhow!("--output and --stats both go to {place}; name another for one")))
}

/// A result must not take the place of a file that it is made from.
pub(crate) fn check_spared<'a>(
    flag: &str,
    result: &WholeFile,
    purpose: &str,
    sources: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    match sources.into_iter().find(|source| result.replaces(source)) {
        None => Ok(()),
        Some(source) => Err(Failure::usage(anyhow!(
            "{flag} {}: would replace {}, {purpose}; name another file",
            result.path().display(),
            source.display()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_named_before_the_extension() {
        let name = |path: &str| with_share(Path::new(path), Share { index: 3, of: 64 });
        assert_eq!(name("a/b.c.exr"), Path::new("a/b.c-3of64.exr"));
        assert_eq!(name("b.png"), Path::new("b-3of64.png"));
    }
}
