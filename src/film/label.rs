//! What a picture file says about itself: enough to know whether two files belong together.

use std::fmt;

use super::Tile;

/// What decides the pixels of a picture, and which of them a file holds.
///
/// Threads, tiles, paths and times are left out on purpose: the same picture is the same bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The program and its version.
    pub software: String,
    /// The [hash](crate::scene::Scene::hash) of the scene.
    pub scene: String,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The other options that decide pixels, as `name=value` with spaces between them.
    pub options: String,
    /// The part that the file holds, if not all.
    pub part: Option<Tile>,
    /// Which share of how many the part is, if the picture was cut by [`share`](super::share).
    pub share: Option<Share>,
    /// How many pixels of the part are not rendered yet.
    pub missing: u64,
    /// What is wrong with the picture although all of it is rendered: it missed its goal.
    pub warning: Option<String>,
}

/// One of equal shares of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Share {
    /// How many shares there are.
    pub of: u32,
    /// Which one it is, counted from 1.
    pub index: u32,
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// The names under which a label stands in a file, in their order there.
const NAMES: [&str; 7] = ["Software", "Scene", "Options", "Part", "Tile", "Missing", "Warning"];

impl Label {
    /// The program and version of this build.
    pub fn this_software() -> String {
        concat!("whitted ", env!("CARGO_PKG_VERSION")).to_owned()
    }

    /// The part of the picture that the file holds.
    pub fn place(&self) -> Tile {
        let [x1, y1] = self.size;
        self.part.unwrap_or(Tile { x0: 0, y0: 0, x1, y1 })
    }

    /// The label of the whole picture of which this is a part.
    #[must_use]
    pub fn whole(&self) -> Self {
        Self { part: None, share: None, missing: 0, ..self.clone() }
    }

    /// Names and values as they stand in a file.
    pub fn entries(&self) -> Vec<(&'static str, String)> {
        let [width, height] = self.size;
        let part = self.part.map(|Tile { x0, y0, x1, y1 }| format!("{x0},{y0},{x1},{y1}"));
        let values = [
            Some(self.software.clone()),
            Some(self.scene.clone()),
            Some(format!("size={width}x{height} {}", self.options)),
            part,
            self.share.map(|share| share.to_string()),
            (self.missing > 0).then(|| self.missing.to_string()),
            self.warning.clone(),
        ];
        NAMES.into_iter().zip(values).filter_map(|(name, value)| Some((name, value?))).collect()
    }

    /// The label that these entries of a file make; none if it has no complete one.
    pub fn from_entries<'a>(entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Option<Self> {
        let mut found = [None; NAMES.len()];
        for (name, value) in entries {
            if let Some(place) = NAMES.iter().position(|known| *known == name) {
                found[place] = Some(value);
            }
        }
        let [software, scene, options, part, share, missing, warning] = found;
        let (size, options) = options?.strip_prefix("size=")?.split_once(' ')?;
        let (width, height) = size.split_once('x')?;
        let size = [width.parse().ok()?, height.parse().ok()?];
        let part = match part {
            None => None,
            Some(text) => Some(tile(text, size)?),
        };
        let share = match share {
            None => None,
            Some(text) => {
                let (index, of) = text.split_once('/')?;
                Some(Share { index: index.parse().ok()?, of: of.parse().ok()? })
            }
        };
        let missing = missing.map_or(Some(0), |text| text.parse().ok())?;
        let (software, scene, options) = (software?.into(), scene?.into(), options.into());
        let warning = warning.map(str::to_owned);
        Some(Self { software, scene, size, options, part, share, missing, warning })
    }

    /// In what `self` and `other`, which a file has, are of different pictures; empty if they are of one.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let mut found = Vec::new();
        let mut compare = |what: &str, ours: &str, theirs: &str| {
            if ours != theirs {
                let absent = |value: &str| {
                    if value.is_empty() { "not given".to_owned() } else { value.to_owned() }
                };
                found.push(format!("{what}: {} here, {} there", absent(ours), absent(theirs)));
            }
        };
        compare("version", &self.software, &other.software);
        compare("scene", short(&self.scene), short(&other.scene));
        let size = |size: [u32; 2]| format!("{}x{}", size[0], size[1]);
        compare("size", &size(self.size), &size(other.size));
        let options = |text: &str| -> Vec<(String, String)> {
            let pairs = text.split(' ').filter_map(|pair| pair.split_once('='));
            pairs.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
        };
        let (ours, theirs) = (options(&self.options), options(&other.options));
        let value = |of: &[(String, String)], name: &str| {
            of.iter().find(|(n, _)| n == name).map_or(String::new(), |(_, value)| value.clone())
        };
        for (name, our_value) in &ours {
            compare(name, our_value, &value(&theirs, name));
        }
        for (name, their_value) in &theirs {
            if !ours.iter().any(|(ours, _)| ours == name) {
                compare(name, "", their_value);
            }
        }
        found
    }
}

/// Enough of a hash for people.
fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

fn tile(text: &str, [width, height]: [u32; 2]) -> Option<Tile> {
    let numbers: Vec<u32> = text.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
    let [x0, y0, x1, y1] = numbers[..] else { return None };
    (x0 < x1 && x1 <= width && y0 < y1 && y1 <= height).then_some(Tile { x0, y0, x1, y1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label() -> Label {
        Label {
            software: "whitted 9.9".to_owned(),
            scene: "0123456789abcdef".to_owned(),
            size: [64, 48],
            options: "aa=grid:2 depth=6".to_owned(),
            part: Some(Tile { x0: 8, y0: 0, x1: 16, y1: 48 }),
            share: Some(Share { index: 2, of: 8 }),
            missing: 7,
            warning: Some("--max-error 1 is not reached: 2".to_owned()),
        }
    }

    fn read(label: &Label) -> Option<Label> {
        let entries = label.entries();
        Label::from_entries(entries.iter().map(|(name, value)| (*name, value.as_str())))
    }

    #[test]
    fn labels_read_back_as_they_are_written() {
        assert_eq!(read(&label()), Some(label()));
        assert_eq!(read(&label().whole()), Some(label().whole()));
        assert_eq!(label().whole().entries().len(), 4);
        assert_eq!(label().whole().place(), Tile { x0: 0, y0: 0, x1: 64, y1: 48 });
    }

    #[test]
    fn broken_labels_are_none() {
        for (name, value) in [
            ("Options", "aa=grid:2"),
            ("Options", "size=64 aa=none"),
            ("Part", "0,0,65,1"),
            ("Part", "5,0,5,1"),
            ("Part", "0,0,1"),
            ("Tile", "2"),
            ("Missing", "-1"),
        ] {
            let mut entries = label().entries();
            entries.retain(|(known, _)| *known != name);
            entries.push((name, value.to_owned()));
            let entries = entries.iter().map(|(name, value)| (*name, value.as_str()));
            assert_eq!(Label::from_entries(entries), None, "{name} {value}");
        }
        assert_eq!(Label::from_entries([("Software", "GIMP")]), None);
    }

    #[test]
    fn differences_name_what_differs_and_ignore_the_place() {
        assert_eq!(label().differences(&label().whole()), [""; 0]);
        let other =
            Label { options: "aa=none depth=6 max-error=2".to_owned(), size: [64, 49], ..label() };
        assert_eq!(
            label().differences(&other),
            [
                "size: 64x48 here, 64x49 there",
                "aa: grid:2 here, none there",
                "max-error: not given here, 2 there"
            ]
        );
    }
}
