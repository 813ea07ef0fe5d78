//! The statements of a part of an OBJ file.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use super::{
    lists::{NONE, Obj, Smoothing},
    parts::Counts,
};
use crate::scene::text::{Lines, Tokens, float, integer, name_of};

/// The most corners of one polygon; cutting a larger one into triangles could take minutes.
const MOST_CORNERS: usize = 10_000;

/// What holds from a face on, as far as its part of the file says it; what it does not say goes on from the part
/// before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Said {
    /// The face, counted from the first of the part.
    pub(super) first_face: u32,
    /// A place in the materials of the part.
    pub(super) material: Option<u32>,
    pub(super) smoothing: Option<Smoothing>,
}

/// Reads a part of a file: whole statements, which may use what parts before it define.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// The contents; faces end within the part's own lists, and there are no sections.
    pub(super) obj: Obj,
    /// What was said, face by face; the last of it holds at the end of the part.
    pub(super) said: Vec<Said>,
    before: Counts,
    material_numbers: HashMap<String, u32>,
    material: Option<u32>,
    smoothing: Option<Smoothing>,
}

impl Part {
    /// Reads the statements of `text`, before which the file holds `before`.
    ///
    /// # Errors
    /// The line of the first that cannot be right, and why.
    pub(super) fn read(text: &[u8], before: Counts) -> Result<Self, (u32, String)> {
        let mut part = Self { before, ..Self::default() };
        let mut lines = Lines::after(before.lines, text);
        while let Some((number, line)) = lines.next_line() {
            part.statement(number, line).map_err(|reason| (number, reason))?;
        }
        part.note_said();
        Ok(part)
    }

    #[inline]
    fn statement(&mut self, number: u32, line: &[u8]) -> Result<(), String> {
        let mut tokens = Tokens::new(line);
        let Some(keyword) = tokens.next_word() else {
            return Ok(());
        };
        match keyword {
            b"v" => self.position(tokens)?,
            b"vt" => self.texcoord(number, tokens)?,
            b"vn" => self.normal(number, tokens)?,
            b"f" | b"fo" => self.face(number, tokens)?,
            b"usemtl" => self.use_material(number, &name_of(tokens.rest_as_name())),
            b"mtllib" => {
                self.obj.libraries.push((name_of(tokens.rest_as_name()), number));
            }
            b"s" => self.smooth(tokens.next_word()),
            b"o" => self.obj.tallies.objects.add(number),
            b"g" => self.obj.tallies.groups.add(number),
            b"l" | b"p" => self.obj.tallies.lines.add(number),
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"bzp" | b"bsp"
            | b"cdc" | b"cdp" | b"res" => self.obj.tallies.free_form.add(number),
            // How other programs display or group; nothing a ray meets.
            b"mg" | b"lod" | b"bevel" | b"c_interp" | b"d_interp" | b"usemap" | b"maplib"
            | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" | b"call" | b"csh" => {}
            _ => self.unknown(number, keyword),
        }
        Ok(())
    }

    fn position(&mut self, mut tokens: Tokens) -> Result<(), String> {
        let position = vector(&mut tokens, "v")?;
        if !position.is_finite() {
            return Err(format!("coordinate ({position}) is not finite"));
        }
        let mut more = [0.0; 4];
        let mut count = 0;
        while let Some(token) = tokens.next_number() {
            let value = float(token).ok_or_else(|| no_number("v", token))?;
            if count < 4 {
                more[count] = value;
            }
            count += 1;
        }
        let color = match count {
            3 => Some([more[0], more[1], more[2]]),
            4 => Some([more[1], more[2], more[3]]),
            _ => None, // nothing, or a weight, which only free-form curves use
        };
        let obj = &mut self.obj;
        if color.is_some() || !obj.colors.is_empty() {
            obj.colors.resize(obj.positions.len(), Vec3::ONE);
            let color = color.map_or(Vec3::ONE, |c| DVec3::from_array(c).as_vec3());
            obj.colors.push(color);
        }
        obj.positions.push(position);
        Ok(())
    }

    fn texcoord(&mut self, number: u32, mut tokens: Tokens) -> Result<(), String> {
        let u = component(&mut tokens, "vt")?;
        let v = match tokens.next_number() {
            Some(token) => float(token).ok_or_else(|| no_number("vt", token))?,
            None => 0.0,
        };
        let mut uv = Vec2::new(u as f32, v as f32);
        if !uv.is_finite() {
            self.obj.tallies.bad_texcoords.add(number);
            uv = Vec2::ZERO;
        }
        self.obj.texcoords.push(uv);
        Ok(())
    }

    fn normal(&mut self, number: u32, mut tokens: Tokens) -> Result<(), String> {
        let normal = vector(&mut tokens, "vn")?;
        let largest = normal.abs().max_element();
        let unit = if normal.is_finite() && largest > 0.0 {
            (normal / largest).normalize().as_vec3()
        } else {
            self.obj.tallies.bad_normals.add(number);
            Vec3::ZERO
        };
        self.obj.normals.push(unit);
        Ok(())
    }

    fn face(&mut self, number: u32, mut tokens: Tokens) -> Result<(), String> {
        let start = self.obj.corners.len();
        while let Some(token) = tokens.next_number() {
            self.corner(token)?;
        }
        let count = self.obj.corners.len() - start;
        if count > MOST_CORNERS {
            return Err(format!("polygon of {count} corners, but at most {MOST_CORNERS} are read"));
        }
        if count < 3 {
            self.obj.tallies.short_faces.add(number);
            self.obj.corners.truncate(start);
            self.obj.corner_texcoords.truncate(start);
            self.obj.corner_normals.truncate(start);
            return Ok(());
        }
        self.note_said();
        self.obj.ends.push(self.obj.corners.len() as u32);
        self.obj.lines.push(number);
        Ok(())
    }

    /// Notes the material and smoothing of the next face, if they are not those of the last.
    fn note_said(&mut self) {
        let first_face = self.obj.ends.len() as u32;
        let said = Said { first_face, material: self.material, smoothing: self.smoothing };
        if self.said.last().is_none_or(|last| Said { first_face, ..*last } != said) {
            self.said.push(said);
        }
    }

    #[inline]
    fn corner(&mut self, token: &[u8]) -> Result<(), String> {
        let obj = &mut self.obj;
        let mut parts = token.split(|&byte| byte == b'/');
        let mut index = |count: usize, what: &str| -> Result<u32, String> {
            match parts.next() {
                None | Some([]) => Ok(NONE),
                Some(digits) => {
                    place(digits, count).ok_or_else(|| bad_index(token, digits, count, what))
                }
            }
        };
        let Counts { positions, texcoords, normals, .. } = self.before;
        let position = index(positions + obj.positions.len(), "position")?;
        let texcoord = index(texcoords + obj.texcoords.len(), "texture coordinate")?;
        let normal = index(normals + obj.normals.len(), "normal")?;
        if position == NONE || parts.next().is_some() {
            return Err(format!(
                "corner `{}` is not of the form v, v/vt, v//vn or v/vt/vn",
                shown(token)
            ));
        }
        let before = obj.corners.len();
        obj.corners.push(position);
        for (list, index) in
            [(&mut obj.corner_texcoords, texcoord), (&mut obj.corner_normals, normal)]
        {
            if index != NONE || !list.is_empty() {
                list.resize(before, NONE);
                list.push(index);
            }
        }
        Ok(())
    }

    fn use_material(&mut self, line: u32, name: &str) {
        let obj = &mut self.obj;
        let number = *self.material_numbers.entry(name.to_owned()).or_insert_with(|| {
            obj.materials.push((name.to_owned(), line));
            obj.materials.len() as u32 - 1
        });
        self.material = Some(number);
    }

    fn smooth(&mut self, word: Option<&[u8]>) {
        self.obj.tallies.smoothing_said = true;
        self.smoothing = Some(match word {
            None | Some(b"off" | b"OFF" | b"Off" | b"null") => Smoothing::Off,
            Some(word) => match integer(word) {
                Some(0) => Smoothing::Off,
                Some(group) => Smoothing::Group(group as u32),
                None => Smoothing::Group(1), // `s on`, as some write
            },
        });
    }

    fn unknown(&mut self, line: u32, keyword: &[u8]) {
        if self.obj.tallies.unknown.count == 0 {
            self.obj.tallies.unknown_word = shown(keyword);
        }
        self.obj.tallies.unknown.add(line);
    }
}

/// The place in a list of `count` that an index from 1, or back from the end, means.
#[inline]
fn place(digits: &[u8], count: usize) -> Option<u32> {
    let index = integer(digits)?;
    let place = match usize::try_from(index) {
        Ok(from_start) => from_start.checked_sub(1)?,
        Err(_) => count.checked_sub(usize::try_from(index.unsigned_abs()).ok()?)?,
    };
    (place < count).then_some(place as u32)
}

#[cold]
fn bad_index(token: &[u8], digits: &[u8], count: usize, what: &str) -> String {
    if integer(digits).is_none() {
        return format!("corner `{}`: `{}` is not a whole number", shown(token), shown(digits));
    }
    let number = shown(digits);
    match count {
        0 => format!("{what} index {number}, but no {what} comes before it"),
        1 => format!("{what} index {number} is out of range, must be 1 or -1"),
        _ => {
            format!("{what} index {number} is out of range, must be 1 to {count} or -1 to -{count}")
        }
    }
}

fn vector(tokens: &mut Tokens, keyword: &str) -> Result<DVec3, String> {
    let mut next = || component(tokens, keyword);
    Ok(DVec3::new(next()?, next()?, next()?))
}

#[inline]
fn component(tokens: &mut Tokens, keyword: &str) -> Result<f64, String> {
    if let Some(token) = tokens.next_number() {
        float(token).ok_or_else(|| no_number(keyword, token))
    } else {
        let count = if keyword == "vt" { "a number" } else { "three numbers" };
        Err(format!("`{keyword}` needs {count}"))
    }
}

#[cold]
fn no_number(keyword: &str, token: &[u8]) -> String {
    format!("`{keyword}`: `{}` is not a number", shown(token))
}

/// A token for a message, cut where it would fill the screen.
pub(super) fn shown(token: &[u8]) -> String {
    let name = name_of(&token[..token.len().min(40)]);
    if token.len() > 40 { format!("{name}…") } else { name }
}
