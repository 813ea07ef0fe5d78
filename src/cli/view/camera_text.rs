//! The camera in words that the program reads back.

use glam::DVec3;
use whitted::scene::CameraPlan;

use super::super::args::SceneArgs;

/// The flags on the camera that the user gave and that do not change as one looks around.
pub(super) fn given_flags(seen: &SceneArgs) -> String {
    let mut given = String::new();
    if let Some(up) = seen.up {
        given = format!(" --up {}", numbers(up.to_array(), ","));
    }
    if let Some(fov) = seen.fov {
        given = format!("{given} --fov {fov:?}");
    }
    given
}

/// The camera as flags, those given at the end, and as TOML; with all digits.
pub(super) fn camera_text(plan: &CameraPlan, given: &str) -> String {
    let CameraPlan { eye, look_at, up, vertical_fov } = plan;
    let [eye, look_at, up] = [eye, look_at, up].map(DVec3::to_array);
    format!(
        "--eye {} --look-at {}{given}\ncamera = {{ eye = [{}], look_at = [{}], up = [{}], vertical_fov = {vertical_fov:?} }}\n",
        numbers(eye, ","),
        numbers(look_at, ","),
        numbers(eye, ", "),
        numbers(look_at, ", "),
        numbers(up, ", "),
    )
}

fn numbers(numbers: [f64; 3], between: &str) -> String {
    numbers.map(|x| format!("{x:?}")).join(between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, Command};
    use clap::Parser;
    use whitted::scene::Orbit;

    fn seen(flags: &[&str]) -> SceneArgs {
        let args = Args::try_parse_from([&["whitted", "view"], flags].concat()).expect("flags");
        let Command::View(args) = args.command else { panic!("view") };
        args.seen
    }

    fn plan(seen: &SceneArgs) -> CameraPlan {
        *seen.load(None).expect("a scene").scene.camera_plan()
    }

    /// Oracle: the program's own parsers.
    #[test]
    fn the_camera_that_is_printed_is_read_back_to_the_last_bit() {
        let first = seen(&["--up", "0,2,0.5", "--fov", "33.3"]);
        let mut orbit = Orbit::new(plan(&first), None);
        orbit.turn(12.3, 4.5);
        orbit.zoom(0.77);
        let text = camera_text(orbit.plan(), &given_flags(&first));
        let (flags, toml) = text.split_once('\n').expect("two lines");
        let words: Vec<&str> = flags.split(' ').collect();
        assert_eq!(plan(&seen(&words)), *orbit.plan());
        let table: toml::Table = toml.parse().expect("TOML");
        let vector = |name: &str| {
            let values = table["camera"][name].as_array().expect("a list").clone();
            let values: Vec<f64> = values.iter().map(|v| v.as_float().expect("a number")).collect();
            DVec3::from_slice(&values)
        };
        let read = CameraPlan {
            eye: vector("eye"),
            look_at: vector("look_at"),
            up: vector("up"),
            vertical_fov: table["camera"]["vertical_fov"].as_float().expect("a number"),
        };
        assert_eq!(read, *orbit.plan());
    }
}
