//! Colours: linear RGB inside the program, sRGB only where pictures come in or go out.

/// A colour in linear light with Rec. 709 primaries, one `f32` a channel; 1 is the brightest a film shows.
pub type Rgb = glam::Vec3;

/// The linear value of an sRGB display value in `[0, 1]`.
///
/// Source: IEC 61966-2-1 (1999).
pub fn srgb_to_linear(display: f64) -> f64 {
    if display <= 0.04045 { display / 12.92 } else { ((display + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB display value of a linear value in `[0, 1]`; the inverse of [`srgb_to_linear`].
///
/// Source: IEC 61966-2-1 (1999).
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear colour of three sRGB display values in `[0, 1]`.
pub fn from_srgb(display: [f64; 3]) -> Rgb {
    Rgb::from_array(display.map(|c| srgb_to_linear(c) as f32))
}
