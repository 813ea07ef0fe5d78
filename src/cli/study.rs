//! `whitted study`: measures what accuracy costs, and writes it down.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Context;
use whitted::film::heatmap::{Scale, write_heatmap};
use whitted::film::write_rgb8;
use whitted::film::{OutputFile, WholeFile};
use whitted::scene::{self, LoadOptions, Loaded, SceneError};
use whitted::study::{Plan, Portrait, Step, Study, charts, files, report};

use super::args::StudyArgs;
use super::failure::{Failure, warn};
use super::{memory, streams};

/// The pause between two lines about how far it is.
const INTERVAL: Duration = Duration::from_secs(2);

pub(crate) fn run(args: &StudyArgs) -> Result<(), Failure> {
    let plan = plan(args);
    for name in &plan.scenes {
        // A mistyped name, or number, is better found now.
        numbered(name).1.map_or(Ok(()), memory::check_objects)?;
        warn(&load(name)?.warnings, false, args.quiet)?;
    }
    let references = args.output.join("references");
    fs::create_dir_all(&references)
        .with_context(|| format!("{}: the folder cannot be created", references.display()))?;
    for name in files::files(&plan.scenes) {
        file(&args.output, &name)?;
    }

    let progress = Lines::new(args.quiet);
    let study = whitted::study::run(&plan, &|name| Ok(load(name)?.scene), &references, &|step| {
        progress.report(step);
    })?;
    write(args, &study)?;
    if !args.quiet {
        let seconds = progress.started.elapsed().as_secs_f64();
        let page = args.output.join("index.html");
        streams::note(&format!(
            "wrote {} and its tables and plots, {seconds:.1} s",
            page.display()
        ));
    }
    Ok(())
}

fn plan(args: &StudyArgs) -> Plan {
    let mut plan = if args.quick { Plan::quick() } else { Plan::full() };
    if !args.scenes.is_empty() {
        plan.scenes.clear();
        for scene in &args.scenes {
            if !plan.scenes.contains(scene) {
                plan.scenes.push(scene.clone());
            }
        }
    }
    plan.size = args.size.unwrap_or(plan.size);
    plan.repeats = args.repeats.unwrap_or(plan.repeats);
    plan.threads = args.threads;
    plan
}

/// A built-in scene or a file, as [`numbered`] takes it.
fn load(name: &str) -> Result<Loaded, SceneError> {
    let (name, objects) = numbered(name);
    scene::load(name, &LoadOptions { objects, ..LoadOptions::default() })
}

/// A scene, and the number of its objects if there is one behind a colon.
fn numbered(name: &str) -> (&str, Option<u32>) {
    let both = name.rsplit_once(':').and_then(|(scene, n)| Some((scene, n.parse().ok()?)));
    both.map_or((name, None), |(scene, n)| (scene, Some(n)))
}

fn file(folder: &Path, name: &str) -> Result<WholeFile, Failure> {
    Ok(WholeFile::prepare(folder.join(name))?)
}

/// Writes the files of [`files::files`], the rows first.
fn write(args: &StudyArgs, study: &Study) -> Result<(), Failure> {
    let folder = &args.output;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = args.threads.map_or(cores, std::num::NonZero::get);
    let charts = charts::charts(&study.rows);
    let scenes: Vec<String> = study.portraits.iter().map(|p| p.scene.clone()).collect();
    let mut texts = vec![
        ("study.csv".to_owned(), report::csv(&study.rows)),
        ("study.json".to_owned(), report::json(study, threads)?),
        ("study.md".to_owned(), report::markdown(&study.rows)),
        ("index.html".to_owned(), report::html(&study.rows, &charts, &scenes)),
    ];
    texts.extend(charts.iter().map(|chart| (format!("{}.svg", chart.name), chart.svg())));
    for (name, text) in texts {
        file(folder, &name)?.commit(|writer| writer.write_all(text.as_bytes()))?;
    }
    for chart in &charts {
        let plot = chart.pixels();
        file(folder, &format!("{}.png", chart.name))?
            .commit(|writer| write_rgb8(&plot.bytes, plot.width, plot.height, writer))?;
    }
    let mut portraits = study.portraits.iter().zip(files::file_names(&scenes));
    portraits.try_for_each(|(portrait, name)| write_portrait(folder, &name, portrait))
}

fn write_portrait(folder: &Path, name: &str, portrait: &Portrait) -> Result<(), Failure> {
    let Portrait { film, errors, .. } = portrait;
    let width = film.width();
    OutputFile::prepare(folder.join(format!("{name}.png")))?.commit(film, None)?;
    let rays: Vec<f32> = film.samples().iter().map(|rays| *rays as f32).collect();
    file(folder, &format!("{name}-rays.png"))?
        .commit(|writer| write_heatmap(&rays, width, &Scale::rays(64), writer))?;
    file(folder, &format!("{name}-error.png"))?
        .commit(|writer| write_heatmap(errors, width, &Scale::LEVELS, writer))?;
    Ok(())
}

/// Says on standard error how far it is, with the time left.
struct Lines {
    quiet: bool,
    started: Instant,
    last: std::cell::Cell<Option<Instant>>,
}

impl Lines {
    fn new(quiet: bool) -> Self {
        Self { quiet, started: Instant::now(), last: std::cell::Cell::new(None) }
    }

    fn report(&self, step: &Step) {
        let now = Instant::now();
        if self.quiet || self.last.get().is_some_and(|last| now - last < INTERVAL) {
            return;
        }
        self.last.set(Some(now));
        let elapsed = self.started.elapsed().as_secs_f64();
        let left = match step.done {
            done if done > 0.0 => format!("{:.0} s left", elapsed * (step.total / done - 1.0)),
            _ => "starting".to_owned(),
        };
        streams::note(&format!("{:3.0} %, {left}: {}", 100.0 * step.done / step.total, step.what));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_may_have_a_number_of_objects() {
        assert_eq!(load("spheres:7").expect("a scene").scene.primitive_count(), 8);
        for name in ["nowhere", "spheres:many", "assignment:3", "spheres:0"] {
            assert!(load(name).is_err(), "{name}");
        }
    }

    #[test]
    fn scenes_may_be_files() {
        let model = concat!(env!("CARGO_MANIFEST_DIR"), "/models/crate/crate.obj");
        assert!(load(model).expect("a scene").scene.primitive_count() > 10);
    }
}
