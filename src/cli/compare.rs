//! `whitted compare`: how far two pictures are apart.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, anyhow};
use image::RgbImage;
use whitted::film::heatmap::{Scale, write_heatmap};
use whitted::film::metrics::{channel_differences, read_png_rgb8, structural_similarity};
use whitted::film::{Difference, WholeFile};

use super::args::CompareArgs;
use super::failure::Failure;
use super::streams;

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let (a, b) = (read_png_rgb8(&args.a)?, read_png_rgb8(&args.b)?);
    let difference = Difference::between(&a, &b)
        .with_context(|| format!("{} and {}", args.a.display(), args.b.display()))?;
    let similarity = structural_similarity(&a, &b)?;
    if let Some(path) = &args.heatmap {
        heatmap(path, &a, &b).context("--heatmap")?;
    }
    let text =
        if args.json { json(&difference, similarity)? } else { table(&difference, similarity)? };
    streams::write_stdout(text.as_bytes())?;
    match args.fail_above {
        Some(limit) if difference.rmse > limit => Err(Failure::over_limit(anyhow!(
            "the pictures differ by {:.4} of 255 levels (root mean square), more than --fail-above {limit}",
            difference.rmse
        ))),
        _ => Ok(()),
    }
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

fn heatmap(path: &Path, a: &RgbImage, b: &RgbImage) -> Result<(), anyhow::Error> {
    let values = channel_differences(a, b);
    let file = WholeFile::prepare(path)?;
    Ok(file.commit(|writer| write_heatmap(&values, a.width(), &Scale::LEVELS, writer))?)
}
