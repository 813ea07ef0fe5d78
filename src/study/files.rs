//! The names of a study's files.

use std::collections::HashSet;

/// The plots that are not of one scene.
const SHARED_PLOTS: [&str; 4] = ["estimate", "objects", "depth", "build"];

/// A scene's name as that of its files; those of several scenes may be the same, but [`file_names`] are not.
pub fn file_name(scene: &str) -> String {
    let plain = scene.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    plain.trim_start_matches('-').to_owned()
}

/// The names of the scenes' files, in the order of the scenes: where one is taken already, by whatever is in a study's
/// folder, it has a number behind it.
pub fn file_names(scenes: &[String]) -> Vec<String> {
    let mut taken: HashSet<String> = SHARED_PLOTS.into_iter().map(str::to_owned).collect();
    let mut names = Vec::new();
    for scene in scenes {
        let plain = file_name(scene);
        let plain = if plain.is_empty() { "scene".to_owned() } else { plain };
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        for name in [plain.clone()].into_iter().chain(numbered) {
            // Some systems do not tell small letters from capitals.
            let own = pictures(&name.to_lowercase());
            let [_, _, errors, plot] = &own;
            if errors != plot && own.iter().all(|stem| !taken.contains(stem)) {
                taken.extend(own);
                names.push(name);
                break;
            }
        }
    }
    names
}

/// The files of a study of these scenes, but for plots of what it did not measure: more than these are not written.
pub fn files(scenes: &[String]) -> Vec<String> {
    let both = |plot: &str| [format!("{plot}.svg"), format!("{plot}.png")];
    let mut files: Vec<String> =
        ["study.csv", "study.json", "study.md", "index.html"].map(str::to_owned).to_vec();
    files.extend(SHARED_PLOTS.into_iter().flat_map(both));
    for name in file_names(scenes) {
        let [picture, rays, error, plot] = pictures(&name);
        files.extend([picture, rays, error].map(|stem| format!("{stem}.png")));
        files.extend(both(&plot));
    }
    files
}

/// The pictures of a scene whose files are called `name`, without extensions: itself, rays, errors, and error against
/// time.
fn pictures(name: &str) -> [String; 4] {
    [name.to_owned(), format!("{name}-rays"), format!("{name}-error"), format!("error-{name}")]
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Row, Trade, charts::charts, plot::Chart},
        *,
    };

    #[test]
    fn files_of_a_scene_have_plain_names() {
        assert_eq!(file_name("spheres:10000"), "spheres-10000");
        assert_eq!(file_name("/models/a crate.obj"), "models-a-crate-obj");
    }

    /// Oracle: no two of the files that come of the names are the same.
    #[test]
    fn files_of_several_scenes_have_names_of_their_own() {
        let names = |scenes: &[&str]| {
            file_names(&scenes.iter().map(|scene| (*scene).to_owned()).collect::<Vec<_>>())
        };
        assert_eq!(names(&["x.toml", "../x.toml", "X.toml"]), ["x-toml", "x-toml-2", "X-toml-3"]);
        assert_eq!(names(&["a-2", "a", "/a", "?"]), ["a-2", "a", "a-3", "scene"]);
        assert_eq!(
            names(&["objects", "a", "a-rays", "error-a"]),
            ["objects-2", "a", "a-rays-2", "error-a-2"]
        );
        let names = names(&[
            "d1/d2/a.toml",
            "d1/d2-a.toml",
            "depth",
            "d1-d2-a-toml-error",
            "error",
            "x",
            "error-x",
        ]);
        let mut files: Vec<String> = names.iter().flat_map(|name| pictures(name)).collect();
        let count = files.len();
        files.sort();
        files.dedup();
        assert_eq!((files.len(), count), (28, 28), "{names:?}");
    }

    #[test]
    fn every_plot_is_among_the_files() {
        let trades = [Trade::Accuracy, Trade::Objects, Trade::Depth, Trade::Size, Trade::Build];
        let rows = trades.map(|trade| Row { trade, ..Row::example("none") });
        let (charts, files) = (charts(&rows), files(&["spheres:10".to_owned()]));
        assert_eq!(charts.len(), 5);
        for Chart { name, .. } in charts {
            assert!(
                ["png", "svg"].iter().all(|kind| files.contains(&format!("{name}.{kind}"))),
                "{name}"
            );
        }
    }
}
