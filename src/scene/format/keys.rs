//! The keys of the scene format: their names, what they hold, their ranges and units.

/// What a key holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A number in a range.
    Number(Range),
    /// A whole number from this on.
    Whole(u32),
    Text,
    /// The name of a file.
    File,
    /// Three channels from 0 to 1.
    Color,
    /// Three finite coordinates.
    Vector,
    /// Two whole numbers from 1 on.
    Size,
    /// So many vectors, or that many and more.
    Vectors {
        least: usize,
        most: usize,
    },
    Choice(&'static [&'static str]),
    /// The name of an entry of the named table.
    Name(&'static str),
    Table(&'static [Key]),
    /// A table of exactly one of the keys.
    OneOf(&'static [Key]),
    /// A table of any names.
    Named(&'static Kind),
    List(&'static Kind),
}

/// The numbers that are accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    Any,
    Positive,
    AtLeastZero,
    /// Between 0 and 180, without either.
    Angle,
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) required: bool,
    pub(super) about: &'static str,
}

const fn must(name: &'static str, kind: Kind, about: &'static str) -> Key {
    Key { name, kind, required: true, about }
}

const fn may(name: &'static str, kind: Kind, about: &'static str) -> Key {
    Key { name, kind, required: false, about }
}

const ANY: Kind = Kind::Number(Range::Any);
const POSITIVE: Kind = Kind::Number(Range::Positive);
const WEIGHT: Kind = Kind::Number(Range::AtLeastZero);
const ENDS: Kind = Kind::Choice(&["open", "closed"]);

/// The keys of a scene.
pub(super) const SCENE: &[Key] = &[
    must("resolution", Kind::Size, "width and height of the picture in pixels"),
    must("depth", Kind::Whole(1), "deepest level of recursion; camera rays have level 1"),
    may(
        "cutoff",
        WEIGHT,
        "weight in a sample below which a ray is not cast; 0 (default) casts all",
    ),
    must("background", Kind::Color, "colour of a ray that hits nothing"),
    may("aa", Kind::Text, "anti-aliasing as --aa takes it, unless that is given"),
    may(
        "color_space",
        Kind::Choice(&["srgb", "linear"]),
        "what all colours of the file are: sRGB display values (default) or linear",
    ),
    must("camera", Kind::Table(CAMERA), "the pinhole camera"),
    may("light", Kind::List(&Kind::Table(LIGHT)), "white point lights without fall-off"),
    may("texture", Kind::Named(&Kind::OneOf(TEXTURE)), "textures by name"),
    may("material", Kind::Named(&Kind::Table(MATERIAL)), "materials by name"),
    may("object", Kind::List(&Kind::Table(OBJECT)), "shapes and what they are made of"),
    may("model", Kind::List(&Kind::Table(MODEL)), "models from OBJ files"),
];

pub(super) const CAMERA: &[Key] = &[
    must("eye", Kind::Vector, "where the camera is"),
    must("look_at", Kind::Vector, "a point in the middle of the picture"),
    must("up", Kind::Vector, "a direction that is up in the picture"),
    must(
        "vertical_fov",
        Kind::Number(Range::Angle),
        "angle between the picture's lower and upper edge, in degrees",
    ),
];

pub(super) const LIGHT: &[Key] = &[
    must("position", Kind::Vector, "where the light is"),
    must("intensity", WEIGHT, "how bright it is"),
];

pub(super) const TEXTURE: &[Key] = &[
    must("checker", Kind::Table(CHECKER), "squares in the plane of x and z"),
    must("plaid", Kind::Table(PLAID), "diagonal stripes in the plane of x and y"),
    must(
        "image",
        Kind::File,
        "a PNG or JPEG file beside the scene's, or `builtin:` and a picture of the program",
    ),
];

const CHECKER: &[Key] = &[
    must(
        "even",
        Kind::Color,
        "colour of the square next to the origin towards +x, +z and of every other one",
    ),
    must("odd", Kind::Color, "colour of the rest"),
    must("origin", Kind::Vector, "a corner of a square"),
    must("size", POSITIVE, "side of a square"),
];

const PLAID: &[Key] = &[
    must("ground", Kind::Color, "colour between the stripes"),
    must("stripe", Kind::Color, "colour where stripes cross"),
    must("origin", Kind::Vector, "where the stripes begin"),
    must("size", POSITIVE, "a third of the distance from stripe to stripe along x"),
];

pub(super) const MATERIAL: &[Key] = &[
    may("color", Kind::Color, "the colour, if there is no texture; default white"),
    may("texture", Kind::Name("texture"), "the name of a texture"),
    may("ambient", WEIGHT, "weight of ambient light; default 0"),
    may("diffuse", WEIGHT, "weight of diffuse light; default 0"),
    may("specular", WEIGHT, "weight of the highlight; default 0"),
    may("shininess", WEIGHT, "Phong's exponent; default 1"),
    may("reflection", WEIGHT, "weight of the mirror image; default 0"),
    may("opacity", WEIGHT, "weight of the ambient and diffuse part; default 1"),
    may(
        "transmission",
        WEIGHT,
        "weight of the light that passes at each crossing of the surface; default 0",
    ),
    may(
        "transmission_color",
        Kind::Color,
        "the colour that this light is filtered to; default white",
    ),
    may("ior", POSITIVE, "index of refraction; default 1, which bends nothing"),
];

const OBJECT: &[Key] = &[
    must("material", Kind::Name("material"), "the name of a material"),
    must("shape", Kind::OneOf(SHAPE), "the shape"),
];

const BASE: Key = must("base", Kind::Vector, "the middle of one end");
const TOP: Key = must("top", Kind::Vector, "the middle of the other");

pub(super) const SHAPE: &[Key] = &[
    must(
        "sphere",
        Kind::Table(&[
            must("center", Kind::Vector, "its centre"),
            must("radius", POSITIVE, "its radius"),
        ]),
        "a sphere",
    ),
    must(
        "cylinder",
        Kind::Table(&[
            BASE,
            TOP,
            must("radius", POSITIVE, "its radius"),
            must("ends", ENDS, "whether discs close it"),
        ]),
        "a circular cylinder",
    ),
    must(
        "cone",
        Kind::Table(&[
            must("base", Kind::Vector, "the middle of the base"),
            must("apex", Kind::Vector, "the tip"),
            must("radius", POSITIVE, "the radius of the base"),
            must("ends", ENDS, "whether a disc closes it"),
        ]),
        "a circular cone",
    ),
    must(
        "frustum",
        Kind::Table(&[
            BASE,
            TOP,
            must("base_radius", POSITIVE, "the radius at the base"),
            must("top_radius", POSITIVE, "the radius at the top"),
        ]),
        "the open side of a truncated cone",
    ),
    must(
        "quad",
        Kind::Table(&[
            must("corner", Kind::Vector, "a corner, where the surface coordinates are (0, 0)"),
            must(
                "edges",
                Kind::Vectors { least: 2, most: 2 },
                "the edges from there, along which they go from 0 to 1",
            ),
        ]),
        "a parallelogram, its front where the cross product of the edges points",
    ),
    must(
        "triangle",
        Kind::Table(&[must(
            "vertices",
            Kind::Vectors { least: 3, most: 3 },
            "its corners, counterclockwise seen from the front",
        )]),
        "a triangle",
    ),
    must(
        "polygon",
        Kind::Table(&[must(
            "vertices",
            Kind::Vectors { least: 3, most: 10_000 },
            "its corners, counterclockwise seen from the front",
        )]),
        "a flat polygon, convex or not",
    ),
    must(
        "tetrahedron",
        Kind::Table(&[
            must("base_center", Kind::Vector, "the middle of the base"),
            must("edge", POSITIVE, "the length of an edge"),
            must(
                "turn",
                ANY,
                "direction of the base's first corner from its middle, in degrees: 0 is +z, 90 is +x",
            ),
        ]),
        "a regular tetrahedron, tip up, of six planes",
    ),
];

pub(super) const MODEL: &[Key] = &[
    must("file", Kind::File, "an OBJ file beside the scene's"),
    may("scale", POSITIVE, "scale factor; default 1"),
    may("rotate", Kind::Vector, "turns about x, then y, then z, in degrees; default none"),
    may("translate", Kind::Vector, "translation, after scaling and rotation; default none"),
    may("material", Kind::Name("material"), "the name of a material in place of the model's own"),
];
