//! Which things hang together.

/// Numbers in disjoint sets, each of which is named by its least number.
///
/// Source: Tarjan & van Leeuwen, "Worst-case analysis of set union algorithms", *Journal of the ACM* 31(2) (1984): linking by index,
/// with path halving.
#[derive(Debug, Default)]
pub(super) struct DisjointSets {
    /// A lower number of the same set, or the number itself if it is the least.
    links: Vec<u32>,
}

impl DisjointSets {
    /// Sets of which is known that each number belongs with the one in its place, which is no higher.
    pub(super) fn of_links(links: &[u32]) -> Self {
        Self { links: links.to_vec() }
    }

    /// Begins anew with `count` numbers, each by itself.
    pub(super) fn reset(&mut self, count: usize) {
        self.links.clear();
        self.links.extend(0..count as u32);
    }

    /// The least number of the set that `x` is in.
    pub(super) fn find(&mut self, mut x: u32) -> u32 {
        while self.links[x as usize] != x {
            let next = self.links[self.links[x as usize] as usize];
            self.links[x as usize] = next;
            x = next;
        }
        x
    }

    /// Makes one of the sets that `a` and `b` are in.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.links[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;

    /// Oracle: labels that are all rewritten at every join.
    #[test]
    fn sets_are_those_of_relabelling() {
        let mut random = SplitMix64::new(7);
        let mut sets = DisjointSets::of_links(&[0, 0, 2, 2, 3]);
        assert_eq!([1, 3, 4].map(|x| sets.find(x)), [0, 2, 2]);
        sets.reset(300);
        let mut labels: Vec<u32> = (0..300).collect();
        for _ in 0..200 {
            let [a, b] = [0, 0].map(|_| (random.next_u64() % 300) as u32);
            sets.join(a, b);
            let pair = [labels[a as usize], labels[b as usize]];
            let (low, high) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            labels.iter_mut().filter(|label| **label == high).for_each(|label| *label = low);
        }
        let found: Vec<u32> = (0..300).map(|x| sets.find(x)).collect();
        assert_eq!(found, labels);
        assert!(labels.iter().any(|label| *label != 0));
    }
}
