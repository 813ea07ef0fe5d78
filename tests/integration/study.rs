//! A study of a few pixels: every trade has its rows, tables and plots, and converged pictures are kept.

use whitted::{
    accel::Preset,
    scene::{load_builtin, load_builtin_of},
    study::{Plan, Trade, charts, report, run},
};

#[test]
fn a_small_study_is_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = Plan {
        scenes: vec!["assignment".to_owned()],
        objects: vec![1, 20],
        builds: vec![20, 3_000],
        sizes: vec![[8, 8]],
        size: [16, 16],
        small_size: [12, 12],
        reference_rays: 16,
        repeats: 2,
        ..Plan::quick()
    };
    let load = |name: &str| match name.split_once(':') {
        Some((_, objects)) => load_builtin_of("spheres", Some(objects.parse().expect("a number"))),
        None => load_builtin(name),
    };
    let steps = std::cell::Cell::new(0);
    let study = run(&plan, &load, folder.path(), &|step| {
        assert!(step.done <= step.total * 1.01, "{step:?}");
        steps.set(steps.get() + 1);
    })
    .expect("a study");
    assert!(steps.get() > 30);
    let count = |trade| study.rows.iter().filter(|row| row.trade == trade).count();
    let trades = [Trade::Accuracy, Trade::Objects, Trade::Size, Trade::Depth, Trade::Build];
    let (modes, few) = (plan.modes.len(), plan.few_modes.len());
    assert_eq!(trades.map(count), [modes, 2 * few, few, 6, 2 * Preset::ALL.len()]);
    assert!(study.rows.iter().all(|row| row.seconds > 0.0 && row.measured_rmse.is_finite()));
    let builds: Vec<_> = study.rows.iter().filter(|row| row.trade == Trade::Build).collect();
    assert!(builds.iter().all(|row| row.build_seconds > 0.0));
    for builds in builds.chunks(Preset::ALL.len()) {
        let presets: Vec<&str> = builds.iter().map(|row| row.build.as_str()).collect();
        assert_eq!(presets, ["fast", "auto", "thorough"]);
        assert_eq!(builds[1].relative_seconds, 1.0);
        let picture = |k: usize| (builds[k].measured_rmse, builds[k].rays);
        assert!(picture(0) == picture(1) && picture(1) == picture(2), "{builds:?}");
    }
    let names: Vec<String> =
        charts::charts(&study.rows).into_iter().map(|chart| chart.name).collect();
    assert_eq!(names, ["error-assignment", "estimate", "objects", "depth", "build"]);
    for chart in charts::charts(&study.rows) {
        let (svg, pixels) = (chart.svg(), chart.pixels());
        assert!(
            svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"),
            "{svg}"
        );
        assert_eq!(pixels.bytes.len() as u32, 3 * pixels.width * pixels.height);
    }
    let page = report::html(&study.rows, &charts::charts(&study.rows), &plan.scenes);
    assert!(page.contains("objects.svg") && page.contains("assignment-rays.png"));

    // Again: the converged pictures are read, not rendered. One is made black in between, which all of its rows show and no others.
    let entries = std::fs::read_dir(folder.path()).expect("the folder");
    let paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    let of_accuracy = |path: &&std::path::PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy();
        name.starts_with("assignment-") && name.contains("-16x16-")
    };
    let kept = paths.iter().find(of_accuracy).expect("a converged picture");
    std::fs::write(kept, [0; 16 * 16 * 12]).expect("written");
    let again = run(&plan, &load, folder.path(), &|_| ()).expect("a study");
    for (a, b) in study.rows.iter().zip(&again.rows) {
        assert_eq!((a.rays, &a.mode), (b.rays, &b.mode));
        if a.trade == Trade::Accuracy {
            assert!(a.measured_rmse < 50.0 && b.measured_rmse > 100.0, "{a:?}, {b:?}");
        } else {
            assert_eq!(a.measured_rmse, b.measured_rmse, "{b:?}");
        }
    }
}
