//! What the values of flags may be.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::DVec3;
use whitted::film::{Share, Tile};
use whitted::scene::generators::MOST_OBJECTS;
use whitted::scene::{ModelPlace, STANDARD_INPUT};

use super::args::Shares;
use super::memory;

/// The longest time limit: about eleven days.
const MOST_SECONDS: f64 = 1e6;

/// The most threads one may ask for: more than machines have, fewer than they refuse to start.
const MOST_THREADS: usize = 4096;

/// A number of digits alone, if it fits.
fn whole<T: FromStr>(text: &str) -> Option<T> {
    let is_whole = text.bytes().all(|byte| byte.is_ascii_digit());
    is_whole.then(|| text.parse().ok()).flatten()
}

/// Two numbers of pixels.
pub(super) fn parse_sides(text: &str) -> Result<[u32; 2], String> {
    let shape = || "give width and height in pixels, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(shape)?;
    let side = |digits: &str| -> Result<u32, String> {
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(shape());
        }
        // A side that does not fit is too long for the memory as well.
        Ok(digits.parse().unwrap_or(u32::MAX))
    };
    let (width, height) = (side(width)?, side(height)?);
    if width == 0 || height == 0 {
        return Err("a picture has at least 1x1 pixels".to_owned());
    }
    if width == u32::MAX || height == u32::MAX {
        limited([width, height])
    } else {
        Ok([width, height])
    }
}

/// Two numbers of pixels of a picture that memory holds as a whole.
pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    limited(parse_sides(text)?)
}

fn limited([width, height]: [u32; 2]) -> Result<[u32; 2], String> {
    let bytes = memory::picture_bytes(width, height);
    if bytes > memory::MOST_BYTES || width == u32::MAX || height == u32::MAX {
        let more = if width == u32::MAX || height == u32::MAX { "more than " } else { "" };
        let (needed, most) = (memory::readable(bytes), memory::readable(memory::MOST_BYTES));
        return Err(format!(
            "needs {more}{needed} of memory; choose a size that needs at most {most}"
        ));
    }
    Ok([width, height])
}

pub(super) fn parse_error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(error) if (0.0..=255.0).contains(&error) => Ok(error),
        _ => Err("give a number of levels from 0 to 255".to_owned()),
    }
}

pub(super) fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= MOST_SECONDS => Ok(seconds),
        _ => Err(format!("give a number of seconds, above 0 and at most {MOST_SECONDS}")),
    }
}

pub(super) fn parse_crop(text: &str) -> Result<Tile, String> {
    let numbers: Vec<u32> = text.split(',').filter_map(whole).collect();
    match *numbers {
        [x0, y0, x1, y1] if text.split(',').count() == 4 => {
            if x0 < x1 && y0 < y1 {
                Ok(Tile { x0, y0, x1, y1 })
            } else {
                Err("the part is empty; X1 and Y1 are the first pixels outside".to_owned())
            }
        }
        _ => Err("give four whole numbers, such as 100,50,200,80".to_owned()),
    }
}

pub(super) fn parse_shares(text: &str) -> Result<Shares, String> {
    let shape = || "give I/N, such as 3/64 or 3/64,7/64, with I from 1 to N".to_owned();
    let mut shares = Vec::new();
    for share in text.split(',') {
        let (index, of) = share.split_once('/').ok_or_else(shape)?;
        let number = |digits: &str| whole(digits).ok_or_else(shape);
        let share = Share { index: number(index)?, of: number(of)? };
        if share.index == 0 || share.index > share.of {
            return Err(shape());
        }
        if shares.contains(&share) {
            return Err(format!("{share} is named twice"));
        }
        shares.push(share);
    }
    Ok(Shares(shares))
}

pub(super) fn parse_depth(text: &str) -> Result<u32, String> {
    match whole(text) {
        Some(depth) if depth > 0 => Ok(depth),
        _ => Err(format!("give a whole number from 1 (camera rays only) to {}", u32::MAX)),
    }
}

pub(super) fn parse_objects(text: &str) -> Result<u32, String> {
    match whole(text) {
        Some(objects @ 1..=MOST_OBJECTS) => Ok(objects),
        _ => Err(format!("give a whole number from 1 to {MOST_OBJECTS}")),
    }
}

/// The name of a scene to study, in which a number of spheres is one that there may be.
pub(super) fn parse_studied(text: &str) -> Result<String, String> {
    if text == STANDARD_INPUT {
        return Err("a study loads its scenes several times; name a file".to_owned());
    }
    match text.strip_prefix("spheres:").map(parse_objects) {
        Some(Err(advice)) => Err(format!("{advice} after `spheres:`")),
        _ => Ok(text.to_owned()),
    }
}

pub(super) fn parse_repeats(text: &str) -> Result<u32, String> {
    match whole(text) {
        Some(repeats @ 1..=1000) => Ok(repeats),
        _ => Err("give a whole number from 1 to 1000".to_owned()),
    }
}

pub(super) fn parse_threads(text: &str) -> Result<NonZeroUsize, String> {
    match whole::<NonZeroUsize>(text) {
        Some(threads) if threads.get() <= MOST_THREADS => Ok(threads),
        _ => Err(format!("give a whole number from 1 to {MOST_THREADS}")),
    }
}

/// A file name with numbers behind it; what is not numeric belongs to the name.
pub(super) fn parse_model(text: &str) -> Result<ModelPlace, String> {
    let (mut name, mut size, mut at) = (text, None, None);
    if let Some((rest, number)) = name.rsplit_once('*')
        && let Ok(number) = number.parse::<f64>()
    {
        if !(number > 0.0 && number.is_finite()) {
            return Err(format!("the size is {number}, but must be positive and finite"));
        }
        (name, size) = (rest, Some(number));
    }
    if let Some((rest, place)) = name.rsplit_once('@')
        && let Ok(place) = parse_vector(place)
    {
        (name, at) = (rest, Some(place));
    }
    if name.is_empty() {
        return Err("give a file, such as model.obj or model.obj@0,0,-80*5".to_owned());
    }
    if name == STANDARD_INPUT {
        return Err("a model cannot come from standard input; name a file".to_owned());
    }
    let is_followed = [".obj@", ".obj*"].iter().any(|part| name.to_lowercase().contains(part));
    if is_followed && !Path::new(name).exists() {
        return Err(
            "what follows the file must be a place and a size, or one of them, such as model.obj@0,0,-80*5"
                .to_owned(),
        );
    }
    Ok(ModelPlace { path: PathBuf::from(name), at, size })
}

pub(super) fn parse_vector(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect::<Option<_>>()
        .unwrap_or_default();
    match numbers.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err("give three numbers, such as 1,2.5,-3".to_owned()),
    }
}

pub(super) fn parse_direction(text: &str) -> Result<DVec3, String> {
    match text {
        "x" | "+x" => Ok(DVec3::X),
        "y" | "+y" => Ok(DVec3::Y),
        "z" | "+z" => Ok(DVec3::Z),
        "-x" => Ok(DVec3::NEG_X),
        "-y" => Ok(DVec3::NEG_Y),
        "-z" => Ok(DVec3::NEG_Z),
        _ => match parse_vector(text) {
            Ok(vector) if vector != DVec3::ZERO => Ok(vector),
            Ok(_) => Err("the zero vector points nowhere".to_owned()),
            Err(_) => Err("give x, y, z, -x, -y, -z or three numbers, such as 0,0,1".to_owned()),
        },
    }
}

pub(super) fn parse_angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("give an angle in degrees, between 0 and 180".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_whole_numbers() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        assert_eq!(parse_size("1X1"), Ok([1, 1]));
        for text in
            ["", "x", "640", "640x", "x480", "6e2x4", "-1x2", "+1x2", "1x2x3", "1.5x2", "1 x2"]
        {
            assert!(parse_size(text).expect_err(text).ends_with("such as 640x480"), "{text}");
        }
        for text in ["0x1", "1x0", "0x99999999999999999999999"] {
            assert_eq!(parse_size(text), Err("a picture has at least 1x1 pixels".to_owned()));
        }
    }

    /// Oracle: 16 bytes of film, 3 of levels, at most 3 of file make 22 a pixel; 2³⁴ / 22 pixels fit.
    #[test]
    fn sizes_are_limited_by_the_memory_they_need() {
        let fit = (1_u64 << 34) / 22;
        assert!(parse_size(&format!("{fit}x1")).is_ok());
        assert!(parse_size(&format!("1x{}", fit + 1)).is_err());
        let error = parse_size("100000x100000").expect_err("too large");
        assert_eq!(error, "needs 204.9 GiB of memory; choose a size that needs at most 16.0 GiB");
        let error = parse_size("99999999999999999999x1").expect_err("too large");
        assert!(error.starts_with("needs more than 88.0 GiB"), "{error}");
    }

    #[test]
    fn shares_are_counted_from_one_and_named_once() {
        let share = |index, of| Share { index, of };
        assert_eq!(parse_shares("3/64"), Ok(Shares(vec![share(3, 64)])));
        assert_eq!(parse_shares("3/64,1/2"), Ok(Shares(vec![share(3, 64), share(1, 2)])));
        for text in ["", "3", "0/4", "5/4", "1/0", "-1/4", "1/4,", "a/b", "+1/4", "1/99999999999"] {
            assert!(parse_shares(text).expect_err(text).starts_with("give I/N"), "{text}");
        }
        assert!(parse_shares("1/4,1/4").expect_err("twice").contains("1/4 is named twice"));
    }

    #[test]
    fn models_are_read_from_the_right() {
        let model = |text: &str| {
            let place = parse_model(text).expect(text);
            (place.path.display().to_string(), place.at.map(|v| v.to_array()), place.size)
        };
        assert_eq!(model("a.obj"), ("a.obj".to_owned(), None, None));
        assert_eq!(
            model("a.obj@1,-2,3e1*4"),
            ("a.obj".to_owned(), Some([1.0, -2.0, 30.0]), Some(4.0))
        );
        assert_eq!(model("a*b@c.obj*.5"), ("a*b@c.obj".to_owned(), None, Some(0.5)));
        assert_eq!(model("a@1,2,3@4,5,6"), ("a@1,2,3".to_owned(), Some([4.0, 5.0, 6.0]), None));
        assert_eq!(model("a*2@1,2,3"), ("a*2".to_owned(), Some([1.0, 2.0, 3.0]), None));
        assert_eq!(model("a@1,2.obj"), ("a@1,2.obj".to_owned(), None, None));
        for text in ["", "*2", "@1,2,3", "a*0", "a*-1", "a*inf"] {
            assert!(parse_model(text).is_err(), "{text}");
        }
    }

    #[test]
    fn directions_are_axes_or_vectors() {
        assert_eq!(parse_direction("z"), Ok(DVec3::Z));
        assert_eq!(parse_direction("-y"), Ok(DVec3::NEG_Y));
        assert_eq!(parse_direction("0, 1,-2"), Ok(DVec3::new(0.0, 1.0, -2.0)));
        for text in ["", "w", "0,0,0", "1,2", "1,2,3,4", "1,2,nan"] {
            assert!(parse_direction(text).is_err(), "{text}");
        }
        assert!(
            parse_angle("0").is_err() && parse_angle("180").is_err() && parse_angle("x").is_err()
        );
    }

    #[test]
    fn depth_threads_objects_and_repeats_start_at_one() {
        assert_eq!(parse_depth("1"), Ok(1));
        assert_eq!(parse_threads("4096").map(NonZeroUsize::get), Ok(4096));
        assert_eq!(parse_objects("50000000"), Ok(50_000_000));
        assert_eq!(parse_repeats("1000"), Ok(1000));
        for text in ["0", "-1", "+1", "two", "", " 1", "1.5", "99999999999999999999"] {
            assert!(parse_depth(text).is_err() && parse_threads(text).is_err(), "{text}");
            assert!(parse_objects(text).is_err() && parse_repeats(text).is_err(), "{text}");
        }
        assert!(parse_threads("4097").is_err() && parse_repeats("1001").is_err());
        assert!(parse_crop("0,0,+5,5").is_err());
    }
}
