//! MTL material libraries, and what their statements mean in Whitted's terms.

use glam::DVec2;

use super::statement::shown;
use crate::scene::{
    text::{Lines, Tokens, float, integer, name_of},
    warning::Warning,
};

/// A material as its library says it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mtl {
    pub(super) name: String,
    pub(super) diffuse: Option<[f64; 3]>,
    pub(super) specular: Option<[f64; 3]>,
    pub(super) shininess: Option<f64>,
    pub(super) ior: Option<f64>,
    pub(super) dissolve: Option<f64>,
    pub(super) transparency: Option<f64>,
    pub(super) filter: Option<[f64; 3]>,
    pub(super) illum: Option<i64>,
    pub(super) picture: Option<PictureRef>,
}

/// A picture that a material wears.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PictureRef {
    pub(super) name: String,
    pub(super) line: u32,
    pub(super) scale: DVec2,
    pub(super) offset: DVec2,
    pub(super) clamp: bool,
}

/// The materials of a library; what cannot be read in it is put among `warnings`, once for each kind of statement.
pub(super) fn parse(path: &str, text: &[u8], warnings: &mut Vec<Warning>) -> Vec<Mtl> {
    let mut materials: Vec<Mtl> = Vec::new();
    let mut warned: Vec<Vec<u8>> = Vec::new();
    let mut lines = Lines::new(text);
    while let Some((number, line)) = lines.next_line() {
        let mut tokens = Tokens::new(line);
        let Some(word) = tokens.next_word() else { continue };
        let keyword = word.to_ascii_lowercase();
        let done = if keyword == b"newmtl" {
            let name = name_of(tokens.rest_as_name());
            materials.push(Mtl { name, ..Mtl::default() });
            Ok(())
        } else if let Some(material) = materials.last_mut() {
            statement(material, &keyword, tokens, number)
        } else {
            Err("stands before the first `newmtl`; ignored".to_owned())
        };
        if let Err(reason) = done
            && !warned.contains(&keyword)
            && warned.len() < 100
        {
            let message = format!("`{}` {reason}", shown(word));
            warnings.push(Warning { file: path.to_owned(), line: number, message });
            warned.push(keyword);
        }
    }
    materials
}

const SHINES: &str = "makes a surface shine by itself, which is not supported; ignored";

fn statement(m: &mut Mtl, keyword: &[u8], mut tokens: Tokens, line: u32) -> Result<(), String> {
    match keyword {
        b"kd" => m.diffuse = Some(color(tokens)?),
        b"ks" => m.specular = Some(color(tokens)?),
        b"tf" => m.filter = Some(color(tokens)?),
        b"ns" => m.shininess = Some(number(&mut tokens)?),
        b"ni" => m.ior = Some(number(&mut tokens)?),
        b"d" => {
            // `-halo factor` makes it depend on the angle of view; the factor alone is used.
            let rest = tokens;
            if tokens.next_word() != Some(b"-halo") {
                tokens = rest;
            }
            m.dissolve = Some(number(&mut tokens)?);
        }
        b"tr" => m.transparency = Some(number(&mut tokens)?),
        b"illum" => {
            let token = tokens.next_number().ok_or("needs a number; ignored")?;
            let model = integer(token).or_else(|| float(token).map(|x| x as i64));
            m.illum = Some(model.ok_or_else(|| not_understood(token))?);
        }
        b"map_kd" => m.picture = Some(picture(tokens, line)?),
        b"ke" => {
            if color(tokens)? != [0.0; 3] {
                return Err(SHINES.to_owned());
            }
        }
        b"map_ke" => return Err(SHINES.to_owned()),
        b"map_d" => {
            return Err(
                "makes parts of a surface transparent, which is not supported; ignored".to_owned()
            );
        }
        // The light of a scene, roughness, bumps and the like, also of physically based materials: not Whitted's.
        b"ka" | b"km" | b"sharpness" | b"map_ka" | b"map_ks" | b"map_ns" | b"map_aat"
        | b"map_bump" | b"bump" | b"disp" | b"decal" | b"refl" | b"map_refl" | b"norm" | b"pr"
        | b"pm" | b"ps" | b"pc" | b"pcr" | b"aniso" | b"anisor" | b"map_pr" | b"map_pm"
        | b"map_ps" => {}
        _ => return Err("is not known; ignored".to_owned()),
    }
    Ok(())
}

fn not_understood(token: &[u8]) -> String {
    format!("has `{}` where a number should be; ignored", shown(token))
}

fn number(tokens: &mut Tokens) -> Result<f64, String> {
    let token = tokens.next_number().ok_or("needs a number; ignored")?;
    float(token).filter(|x| x.is_finite()).ok_or_else(|| not_understood(token))
}

/// One value is a grey.
fn color(mut tokens: Tokens) -> Result<[f64; 3], String> {
    let first = tokens;
    if let Some(kind @ (b"spectral" | b"xyz")) = tokens.next_word() {
        return Err(format!("is given as `{}`, which is not supported; ignored", shown(kind)));
    }
    let mut tokens = first;
    let r = number(&mut tokens)?;
    let rest = tokens;
    if tokens.next_number().is_none() {
        return Ok([r; 3]);
    }
    tokens = rest;
    let g = number(&mut tokens)?;
    if { tokens }.next_number().is_none() {
        return Err("has two numbers where one or three should be; ignored".to_owned());
    }
    Ok([r, g, number(&mut tokens)?])
}

fn picture(mut tokens: Tokens, line: u32) -> Result<PictureRef, String> {
    let (mut scale, mut offset, mut clamp) = (DVec2::ONE, DVec2::ZERO, false);
    loop {
        let before = tokens;
        let option = tokens.next_word().unwrap_or_default().to_ascii_lowercase();
        match option.as_slice() {
            b"-s" => scale = two_of_three(&mut tokens, DVec2::ONE),
            b"-o" => offset = two_of_three(&mut tokens, DVec2::ZERO),
            b"-t" => _ = two_of_three(&mut tokens, DVec2::ZERO),
            b"-clamp" => clamp = tokens.next_word() == Some(b"on"),
            b"-mm" => {
                tokens.next_word();
                tokens.next_word();
            }
            b"-blendu" | b"-blendv" | b"-boost" | b"-texres" | b"-bm" | b"-imfchan" | b"-type"
            | b"-cc" | b"-colorspace" => _ = tokens.next_word(),
            _ => {
                let name = name_of(before.rest_as_name());
                if name.is_empty() {
                    return Err("names no picture; ignored".to_owned());
                }
                return Ok(PictureRef { name, line, scale, offset, clamp });
            }
        }
    }
}

/// The first two of one to three numbers; a file name that is a number is left alone.
fn two_of_three(tokens: &mut Tokens, default: DVec2) -> DVec2 {
    let mut values = default.to_array();
    for k in 0..3_usize {
        let before = *tokens;
        let value = tokens.next_word().and_then(float).filter(|x| x.is_finite());
        let is_last = { *tokens }.next_word().is_none();
        match value {
            Some(x) if !is_last => {
                if let Some(place) = values.get_mut(k) {
                    *place = x;
                }
            }
            _ => {
                *tokens = before;
                break;
            }
        }
    }
    DVec2::from_array(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> (Mtl, Vec<String>) {
        let mut warnings = Vec::new();
        let mut materials = parse("m.mtl", text.as_bytes(), &mut warnings);
        let warnings = warnings.iter().map(ToString::to_string).collect();
        (materials.pop().expect("a material"), warnings)
    }

    #[test]
    fn pictures_keep_their_options_and_names() {
        let picture =
            |text: &str| one(&format!("newmtl a\nmap_Kd {text}")).0.picture.expect("a picture");
        let p = picture("-blendu off -s 2 3 1 -o 0.5 -bm 0.2 -clamp on my wood.png # old");
        assert_eq!((p.name.as_str(), p.clamp), ("my wood.png", true));
        assert_eq!((p.scale, p.offset), (DVec2::new(2.0, 3.0), DVec2::new(0.5, 0.0)));
        let p = picture("-s 1 1 42");
        assert_eq!((p.name.as_str(), p.scale), ("42", DVec2::ONE));
        assert_eq!(picture("-mm 0 1 C:\\tex\\a#1.jpg").name, "C:\\tex\\a#1.jpg");
    }

    #[test]
    fn odd_statements_are_warned_about_once_a_kind() {
        let (m, warnings) =
            one("Kd 1 1 1\nnewmtl a\n KD 0.8\nKs spectral x.rfl\nNs hard\nNs soft\n\
            Tr 0 0\nd -halo 0.5\nillum 2.0\nKa 1\nmap_Kd -s 1 1\nKe 0 0 0\nKe 0 1 0\nmap_d a.png\n\
            Tf 1 0\nkdd 1 1 1\nbump a.png");
        assert_eq!((m.diffuse, m.transparency, m.dissolve), (Some([0.8; 3]), Some(0.0), Some(0.5)));
        assert_eq!((m.illum, m.specular, m.shininess), (Some(2), None, None));
        assert_eq!(warnings.len(), 7, "{warnings:#?}");
        assert!(warnings[3].starts_with("m.mtl:13: `Ke` makes"), "{}", warnings[3]);
        assert!(warnings[4].starts_with("m.mtl:14: `map_d` makes"), "{}", warnings[4]);
        assert!(warnings[5].starts_with("m.mtl:15: `Tf` has two"), "{}", warnings[5]);
        assert!(warnings[6].starts_with("m.mtl:16: `kdd` is not"), "{}", warnings[6]);
        assert!(warnings[0].starts_with("m.mtl:1: `Kd` stands before"), "{}", warnings[0]);
        assert!(warnings[2].starts_with("m.mtl:5: `Ns` has `hard`"), "{}", warnings[2]);
    }
}
