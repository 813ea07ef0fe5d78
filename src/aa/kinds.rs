//! What the samples of a pixel met, and whether some of it is so small that it was met by chance.

use super::Sample;

/// The kinds that are told apart.
const MOST: usize = 3;

/// The kinds of things in a pixel, by their signatures, if they are few.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinds {
    /// What at least half of the samples met; none where one line of two did.
    main: Option<u32>,
    /// What the others met.
    others: [Option<u32>; MOST - 1],
    /// Whether there are others, but fewer samples of them than lie in a row, or a single line.
    has_few_others: bool,
}

impl Kinds {
    /// What these samples met; `has_lone_line` as [`Lines::lone_errors`](super::lines::Lines::lone_errors) has it.
    pub fn of(samples: &[Sample], has_lone_line: bool) -> Self {
        let mut kinds = [(None, 0); MOST];
        for Sample { signature, .. } in samples {
            let is_own =
                |(kind, _): &&mut (Option<u32>, usize)| kind.is_none_or(|s| s == *signature);
            let Some((kind, count)) = kinds.iter_mut().find(is_own) else { return Self::default() };
            (*kind, *count) = (Some(*signature), *count + 1);
        }
        let Some(main) = kinds.iter().position(|(_, count)| 2 * count >= samples.len()) else {
            return Self::default();
        };
        kinds.swap(0, main);
        let [(main, count), others @ ..] = kinds;
        let rest = samples.len() - count;
        if has_lone_line && rest == count {
            return Self { main: None, others: [main, others[0].0], has_few_others: true };
        }
        Self {
            main,
            others: others.map(|(kind, _)| kind),
            has_few_others: has_lone_line || rest > 0 && rest * rest < samples.len(),
        }
    }

    /// Whether few samples met something else than the others: something thin, or a corner of what is beside the pixel.
    pub fn has_few_others(&self) -> bool {
        self.has_few_others
    }

    /// Which of the others few samples met by chance: it is thin, because it is the main thing in no pixel `around`. The first if all
    /// of them are.
    pub fn small_among(&self, around: &[Self]) -> Option<usize> {
        let goes_on = |kind: Option<u32>| kind.is_some() && around.iter().any(|k| k.main == kind);
        match self.others.map(goes_on) {
            _ if !self.has_few_others => None,
            [false, false] => Some(0),
            // Of two lines either may be the one that met something thin.
            [true, false] if self.main.is_none() => Some(1),
            [false, true] if self.main.is_none() => Some(0),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(signatures: &[u32]) -> Kinds {
        let sample = |signature: &u32| Sample { signature: *signature, ..Sample::default() };
        Kinds::of(&signatures.iter().map(sample).collect::<Vec<Sample>>(), false)
    }

    #[test]
    fn what_few_samples_met_is_small_unless_it_goes_on_beside() {
        let (sky, wall) = (kinds(&[7; 9]), kinds(&[5, 5, 5, 5, 5, 7, 7, 7, 7]));
        for small in [kinds(&[7, 7, 7, 7, 5, 7, 7, 7, 7]), kinds(&[5, 7, 7, 6, 7, 7, 7, 7, 7])] {
            assert!(small.has_few_others() && small.small_among(&[sky, small]) == Some(0));
            assert!(small.small_among(&[sky, wall]).is_none());
        }
        // Three of nine are a row.
        let row = kinds(&[5, 7, 7, 5, 7, 7, 5, 7, 7]);
        for large in [sky, wall, row, kinds(&[1, 2, 3, 4]), kinds(&[1, 2, 3, 3, 2, 1]), kinds(&[])]
        {
            assert!(!large.has_few_others() && large.small_among(&[sky]).is_none());
        }
        assert!(kinds(&[1, 2, 1, 1]).has_few_others() && !kinds(&[1, 2, 1, 2]).has_few_others());
    }

    #[test]
    fn of_two_lines_the_one_is_thin_that_does_not_go_on_beside() {
        let sample = |signature| Sample { signature, ..Sample::default() };
        let wire = Kinds::of(&[5, 7, 5, 7].map(sample), true);
        assert_eq!(wire.small_among(&[kinds(&[7; 4]), wire]), Some(0));
        assert_eq!(wire.small_among(&[kinds(&[5; 4]), wire]), Some(1));
        assert_eq!(wire.small_among(&[kinds(&[5; 4]), kinds(&[7; 4])]), None);
    }
}
