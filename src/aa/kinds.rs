//! What the samples of a pixel met, and whether some of it is so small that it was met by chance.

use super::Sample;

/// The kinds that are told apart.
const MOST: usize = 3;

/// The kinds of things in a pixel, by their signatures, if they are few.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinds {
    /// What at least half of the samples met.
    main: Option<u32>,
    /// What the others met.
    others: [Option<u32>; MOST - 1],
    /// Whether there are others, but fewer samples of them than lie in a row.
    has_few_others: bool,
}

impl Kinds {
    /// What these samples met.
    pub fn of(samples: &[Sample]) -> Self {
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
        Self {
            main,
            others: others.map(|(kind, _)| kind),
            has_few_others: rest > 0 && rest * rest < samples.len(),
        }
    }

    /// Whether few samples met something else than the others: something thin, or a corner of what is beside the pixel.
    pub fn has_few_others(&self) -> bool {
        self.has_few_others
    }

    /// Whether what few samples met is not the main thing in any pixel `around`: it is thin, and met by chance.
    pub fn are_small_among(&self, around: impl Iterator<Item = Self>) -> bool {
        let is_other = |main: Option<u32>| main.is_some() && self.others.contains(&main);
        self.has_few_others && !around.into_iter().any(|kinds| is_other(kinds.main))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(signatures: &[u32]) -> Kinds {
        let sample = |signature: &u32| Sample { signature: *signature, ..Sample::default() };
        Kinds::of(&signatures.iter().map(sample).collect::<Vec<Sample>>())
    }

    #[test]
    fn what_few_samples_met_is_small_unless_it_goes_on_beside() {
        let (sky, wall) = (kinds(&[7; 9]), kinds(&[5, 5, 5, 5, 5, 7, 7, 7, 7]));
        for small in [kinds(&[7, 7, 7, 7, 5, 7, 7, 7, 7]), kinds(&[5, 7, 7, 6, 7, 7, 7, 7, 7])] {
            assert!(small.has_few_others() && small.are_small_among([sky, small].into_iter()));
            assert!(!small.are_small_among([sky, wall].into_iter()));
        }
        // Three of nine are a row.
        let row = kinds(&[5, 7, 7, 5, 7, 7, 5, 7, 7]);
        for large in [sky, wall, row, kinds(&[1, 2, 3, 4]), kinds(&[1, 2, 3, 3, 2, 1]), kinds(&[])]
        {
            assert!(!large.has_few_others() && !large.are_small_among([sky].into_iter()));
        }
        assert!(kinds(&[1, 2, 1, 1]).has_few_others() && !kinds(&[1, 2, 1, 2]).has_few_others());
    }
}
