//! Numbers as C's `strtod` spells them, and indices.

/// Powers of ten that a double holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// The double nearest to the number that all of `token` spells, as `strtod` does: decimal or hexadecimal, with or
/// without digits before or after the point, infinities and NaN included.
pub fn float(token: &[u8]) -> Option<f64> {
    plain(token).or_else(|| any(token))
}

/// A plain decimal of up to 15 digits, in which both the digits and the power of ten are exact, so that one division or
/// multiplication rounds correctly (Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990).
#[inline]
fn plain(token: &[u8]) -> Option<f64> {
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, token),
    };
    let (mut mantissa, mut count, mut scale, mut after_point) = (0_u64, 0_u32, 0_usize, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                count += 1;
                scale += usize::from(after_point);
                if count > 15 {
                    return None;
                }
            }
            b'.' if !after_point => after_point = true,
            _ => return None,
        }
    }
    if count == 0 {
        return None;
    }
    let value = mantissa as f64 / EXACT_POWERS[scale];
    Some(if negative { -value } else { value })
}

fn any(token: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(token).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let (sign, size) = match text.as_bytes() {
        [b'-', ..] => (-1.0, &text[1..]),
        [b'+', ..] => (1.0, &text[1..]),
        _ => (1.0, text),
    };
    let lower = size.to_ascii_lowercase();
    if lower.starts_with("nan(") && lower.ends_with(')') {
        return Some(f64::NAN);
    }
    hexadecimal(lower.strip_prefix("0x")?.as_bytes()).map(|value| sign * value)
}

/// Hexadecimal digits with a point and a binary exponent, in lower case.
fn hexadecimal(text: &[u8]) -> Option<f64> {
    let (digits, exponent) = match text.iter().position(|&byte| byte == b'p') {
        Some(at) => (&text[..at], std::str::from_utf8(&text[at + 1..]).ok()?),
        None => (text, "0"),
    };
    let count = exponent.trim_start_matches(['+', '-']);
    if count.is_empty() || !count.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let far = if exponent.starts_with('-') { -100_000 } else { 100_000 };
    let mut exponent = exponent.parse::<i64>().map_or(far, |e| e.clamp(-100_000, 100_000));
    let (mut mantissa, mut seen, mut after_point) = (0_u64, false, false);
    for &byte in digits {
        if byte == b'.' && !after_point {
            after_point = true;
            continue;
        }
        let digit = char::from(byte).to_digit(16)?;
        seen = true;
        if mantissa >> 60 == 0 {
            mantissa = mantissa << 4 | u64::from(digit);
            exponent -= if after_point { 4 } else { 0 };
        } else {
            mantissa |= u64::from(digit != 0); // only whether there is more
            exponent += if after_point { 0 } else { 4 };
        }
    }
    seen.then(|| {
        let exponent = exponent.clamp(-4000, 4000) as i32;
        let half = exponent / 2;
        let power = |e: i32| 2.0_f64.powi(e);
        // In three steps, so that no power is out of range while the value is in it.
        mantissa as f64 * power(half / 2) * power(half - half / 2) * power(exponent - half)
    })
}

/// The whole number that `token` spells; one that does not fit is the nearest that does.
#[inline]
pub fn integer(token: &[u8]) -> Option<i64> {
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, token),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for &byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value.saturating_mul(10).saturating_add(i64::from(byte - b'0'));
    }
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the standard library's correctly rounded conversion.
    #[test]
    fn plain_decimals_round_correctly() {
        let mut state = 1_u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let digits = format!("{}", state >> (state & 63));
            let point = (state >> 32) as usize % (digits.len() + 1);
            for text in [
                format!("-{}.{}", &digits[..point], &digits[point..]),
                format!("{digits}e-{point}"),
            ] {
                let value = float(text.as_bytes()).expect(&text);
                assert_eq!(value.to_bits(), text.parse::<f64>().expect(&text).to_bits(), "{text}");
            }
        }
    }

    #[test]
    fn whatever_strtod_takes_is_read() {
        for (text, value) in [
            ("1", 1.0),
            ("+1.", 1.0),
            (".5", 0.5),
            ("-.5E+1", -5.0),
            ("1e-400", 0.0),
            ("1e400", f64::INFINITY),
            ("-INFINITY", f64::NEG_INFINITY),
            ("inf", f64::INFINITY),
            ("0x1.8p3", 12.0),
            ("-0XaP-1", -5.0),
            ("0x1p-1074", 5e-324),
            ("0x.8", 0.5),
            ("0x1p99999999999999999999", f64::INFINITY),
        ] {
            assert_eq!(float(text.as_bytes()), Some(value), "{text}");
        }
        for text in ["nan", "-NaN", "nan(0x7)"] {
            assert!(float(text.as_bytes()).expect(text).is_nan());
        }
        for text in ["", "-", ".", "1,5", "1e", "0x", "0xg", "1.5abc", "--1", "1.2.3", "0x1p", "e5"]
        {
            assert_eq!(float(text.as_bytes()), None, "{text}");
        }
        assert!(float(b"-0").expect("zero").is_sign_negative());
    }

    #[test]
    fn indices_saturate() {
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"+7"), Some(7));
        assert_eq!(integer(b"99999999999999999999"), Some(i64::MAX));
        for text in ["", "-", "1.0", "1e3", "a"] {
            assert_eq!(integer(text.as_bytes()), None, "{text}");
        }
    }
}
