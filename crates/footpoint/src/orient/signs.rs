//! Disjoint sets whose members have a sign relative to each other.

/// Sets of places; each is named by its first place, and a member is *opposed* if its sign differs from that one's.
pub(super) struct SignedSets {
    /// A place of the same set, never a later one; itself for the first.
    up: Vec<u32>,
    /// Whether the sign differs from that of `up`.
    opposed: Vec<bool>,
}

impl SignedSets {
    /// Every place alone.
    pub(super) fn new(count: usize) -> Self {
        Self { up: (0..count as u32).collect(), opposed: vec![false; count] }
    }

    /// The first place of the set, and whether this one is opposed to it.
    pub(super) fn find(&mut self, mut place: usize) -> (usize, bool) {
        let mut opposed = false;
        loop {
            let up = self.up[place] as usize;
            if up == place {
                return (place, opposed);
            }
            // Halve the path: the next search is shorter.
            if self.up[up] as usize != up {
                self.opposed[place] ^= self.opposed[up];
                self.up[place] = self.up[up];
            }
            opposed ^= self.opposed[place];
            place = self.up[place] as usize;
        }
    }

    /// Joins the sets of two places that are opposed to each other or not. `None` if they were in one set already; else
    /// the first place of the joint set.
    pub(super) fn join(&mut self, (a, b): (usize, usize), opposed: bool) -> Option<usize> {
        let ((first_a, opposed_a), (first_b, opposed_b)) = (self.find(a), self.find(b));
        if first_a == first_b {
            return None;
        }
        let (first, second) = (first_a.min(first_b), first_a.max(first_b));
        self.up[second] = first as u32;
        self.opposed[second] = opposed ^ opposed_a ^ opposed_b;
        Some(first)
    }

    /// After this, [`Self::first`] and [`Self::is_opposed`] are right until sets are joined again.
    pub(super) fn settle(&mut self) {
        // Earlier places are settled already.
        for place in 0..self.up.len() {
            let up = self.up[place] as usize;
            if up != place {
                self.opposed[place] ^= self.opposed[up];
                self.up[place] = self.up[up];
            }
        }
    }

    /// The first place of the set, once settled.
    #[inline]
    pub(super) fn first(&self, place: usize) -> usize {
        self.up[place] as usize
    }

    /// Whether the place is opposed to the first of its set, once settled.
    #[inline]
    pub(super) fn is_opposed(&self, place: usize) -> bool {
        self.opposed[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Random;

    #[test]
    fn signs_are_those_of_any_way_between_two_places() {
        let mut random = Random::new(1);
        let count = 500;
        let truth: Vec<bool> = (0..count).map(|_| random.uniform() < 0.5).collect();
        let mut sets = SignedSets::new(count);
        // Two sets: places of equal remainder.
        let mut joined = 0;
        while joined < count - 2 {
            let a = (random.uniform() * count as f64) as usize;
            let b = (a + 2 * (random.uniform() * 50.0) as usize) % count;
            joined += usize::from(sets.join((a, b), truth[a] ^ truth[b]).is_some());
        }
        for a in 0..count {
            assert_eq!(sets.find(a), (a % 2, truth[a] ^ truth[a % 2]));
        }
        sets.settle();
        for a in 0..count {
            assert_eq!((sets.first(a), sets.is_opposed(a)), (a % 2, truth[a] ^ truth[a % 2]));
        }
    }
}
