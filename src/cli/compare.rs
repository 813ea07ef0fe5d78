//! `whitted compare`: how far two pictures are apart.

use std::fmt::Write;
use std::io::{self, IsTerminal, Read};
use std::path::Path;

use anyhow::{Context, anyhow};
use image::RgbImage;
use whitted::film::heatmap::{Scale, write_heatmap};
use whitted::film::metrics::{
    channel_differences, decode_png_rgb8, read_png_rgb8, structural_similarity,
};
use whitted::film::{Difference, WholeFile};

use super::args::CompareArgs;
use super::failure::Failure;
use super::streams;
use super::target::check_spared;

/// The file name that stands for standard input or output.
const STREAM: &str = "-";

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let map = args.heatmap.as_deref().map(|path| Map::prepare(path, args)).transpose()?;
    if [&args.a, &args.b].iter().all(|path| path.as_os_str() == STREAM) {
        return Err(Failure::usage(anyhow!(
            "both pictures are to come from standard input, which holds one; name a file for the other"
        )));
    }
    let (a, b) = (read_picture(&args.a)?, read_picture(&args.b)?);
    let difference = Difference::between(&a, &b)
        .with_context(|| format!("{} and {}", args.a.display(), args.b.display()))?;
    let similarity = structural_similarity(&a, &b)?;
    let text =
        if args.json { json(&difference, similarity)? } else { table(&difference, similarity)? };
    match map {
        Some(Map::Stdout) => {
            let mut bytes = Vec::new();
            write_map(&a, &b, &mut bytes).context("--heatmap")?;
            streams::to_stdout(|stdout| stdout.write_all(&bytes))?;
            streams::note(text.trim_end());
        }
        Some(Map::File(file)) => {
            file.commit(|writer| write_map(&a, &b, writer)).context("--heatmap")?;
            streams::print(text.as_bytes())?;
        }
        None => streams::print(text.as_bytes())?,
    }
    match args.fail_above {
        Some(limit) if difference.rmse > limit => Err(Failure::over_limit(anyhow!(
            "the pictures differ by {:.4} of 255 levels (root mean square), more than --fail-above {limit}",
            difference.rmse
        ))),
        _ => Ok(()),
    }
}

/// Reads a PNG file, or one from standard input.
pub(crate) fn read_picture(path: &Path) -> Result<RgbImage, Failure> {
    if path.as_os_str() != STREAM {
        return Ok(read_png_rgb8(path)?);
    }
    let mut bytes = Vec::new();
    io::stdin().read_to_end(&mut bytes).context("standard input cannot be read")?;
    Ok(decode_png_rgb8(io::Cursor::new(bytes), Path::new("standard input"))?)
}

/// Where the picture of the differences goes.
enum Map {
    Stdout,
    File(WholeFile),
}

impl Map {
    /// The place that the user names, which is none of the pictures that are compared.
    fn prepare(path: &Path, args: &CompareArgs) -> Result<Self, Failure> {
        if path.as_os_str() == STREAM {
            let fault = if args.json {
                "the numbers of --json go to standard output too; name a file for one"
            } else if io::stdout().is_terminal() {
                "standard output is a terminal, which shows no PNG; redirect it or name a file"
            } else {
                return Ok(Self::Stdout);
            };
            return Err(Failure::usage(anyhow!("--heatmap -: {fault}")));
        }
        let file = WholeFile::prepare(path).context("--heatmap")?;
        let is_png =
            path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        if file.is_on_disk() && !is_png {
            return Err(Failure::usage(anyhow!(
                "--heatmap {}: is written as PNG; end the name with .png",
                path.display()
            )));
        }
        check_spared("--heatmap", &file, "which is compared", [&args.a, &args.b])?;
        Ok(Self::File(file))
    }
}

fn write_map(a: &RgbImage, b: &RgbImage, writer: impl io::Write) -> io::Result<()> {
    write_heatmap(&channel_differences(a, b), a.width(), &Scale::LEVELS, writer)
}

fn table(difference: &Difference, similarity: f64) -> Result<String, Failure> {
    let Difference { rmse, mean, worst, share_over_8 } = difference;
    let mut text = String::new();
    writeln!(text, "RMSE         {rmse:.4} of 255 levels")?;
    writeln!(text, "mean         {mean:.4} of 255 levels")?;
    writeln!(text, "PSNR         {:.2} dB", difference.psnr())?;
    writeln!(text, "worst pixel  {} levels at column {}, row {}", worst.levels, worst.x, worst.y)?;
    writeln!(text, "off by > 8   {:.4} % of the pixels", share_over_8 * 100.0)?;
    writeln!(text, "SSIM         {similarity:.6}")?;
    Ok(text)
}

fn json(difference: &Difference, similarity: f64) -> Result<String, Failure> {
    let psnr = difference.psnr();
    let object = serde_json::json!({
        "rmse": difference.rmse,
        "mean": difference.mean,
        "psnr": psnr.is_finite().then_some(psnr),
        "worst": { "levels": difference.worst.levels, "x": difference.worst.x, "y": difference.worst.y },
        "share_over_8": difference.share_over_8,
        "ssim": similarity,
    });
    Ok(serde_json::to_string_pretty(&object)? + "\n")
}
