//! What a render aimed at but did not reach.

use whitted::aa::{AntiAliasing, MOST_RAYS};
use whitted::render::Outcome;

use super::args::RenderArgs;

/// The rays of the pixels that have the most grow about as the error to the power of minus this: from 1024 to 16384 rays
/// it fell to a ninth in the assignment scene, 60 x 40 pixels.
const RAYS_POWER: f64 = 1.25;

/// What was missed, if anything was, by a picture that ended so; no times, since the picture's file has it.
pub(crate) fn missed(
    args: &RenderArgs,
    aa: AntiAliasing,
    outcome: &Outcome,
    estimated_rmse: Option<f64>,
) -> Option<String> {
    if let (Some(limit), Some(_)) = (args.time_limit, outcome.late) {
        return Some(format!(
            "--time-limit {} is too short for one ray in each pixel; nothing was refined",
            given(limit)
        ));
    }
    let (wanted, reached) = (args.max_error?, estimated_rmse?);
    // A picture that was finished in its checkpoint has no outcome.
    if outcome.missed_error.is_none() && reached <= wanted {
        return None;
    }
    let advice = match aa {
        AntiAliasing::Adaptive { most, .. } if wanted > 0.0 && most < MOST_RAYS => {
            let needed = f64::from(most) * (reached / wanted).powf(RAYS_POWER);
            let more = (1..16).map(|k| most.saturating_mul(1 << (2 * k)));
            let more =
                more.take_while(|more| *more < MOST_RAYS).find(|more| f64::from(*more) >= needed);
            format!("allow more, such as --aa adaptive:0,{}", more.unwrap_or(MOST_RAYS).max(4096))
        }
        _ => format!("allow a larger one, such as --max-error {}", rounded_up(reached)),
    };
    Some(format!(
        "--max-error {} is not reached: the estimated error is {} levels with the most rays a pixel may get; {advice}",
        given(wanted),
        short(reached)
    ))
}

/// A number about as a user gives it.
fn given(number: f64) -> String {
    if number > 0.0 && number < 1e-6 { format!("{number:e}") } else { number.to_string() }
}

/// A number with three digits behind the point, or more if it is small.
pub(crate) fn short(number: f64) -> String {
    match number {
        0.0 | 0.01.. => format!("{number:.3}"),
        1e-4..0.01 => format!("{number:.5}"),
        _ => format!("{number:.2e}"),
    }
}

/// An error with one digit that is not below `error`, and above 0.
fn rounded_up(error: f64) -> String {
    let unit = 10_f64.powi(error.max(1e-9).log10().floor() as i32);
    let digits = (-unit.log10()).round().max(0.0) as usize;
    format!("{:.digits$}", (error / unit).ceil().max(1.0) * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_their_digits() {
        let shown = [0.0, 2.1e-5, 0.001_23, 0.0123, 0.5, 25.75].map(short);
        assert_eq!(shown, ["0.000", "2.10e-5", "0.00123", "0.012", "0.500", "25.750"]);
    }

    /// Oracle: what is advised is reached by what was.
    #[test]
    fn an_error_that_is_advised_is_one_that_was_reached() {
        let advised = [0.0123, 0.5, 0.999, 6.2, 25.75].map(rounded_up);
        assert_eq!(advised, ["0.02", "0.5", "1.0", "7", "30"]);
        for error in [1e-7, 3.3e-4, 0.07, 0.3, 1.0, 254.0] {
            let advised: f64 = rounded_up(error).parse().expect("a number");
            assert!(advised > 0.0 && advised >= error * 0.999_999, "{error}: {advised}");
        }
    }
}
