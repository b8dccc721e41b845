//! The longest part of a reach that never rises across a contour.

use crate::subdomains::Band;

/// The stretches that are kept, ascending: water can run along them and never rise, and their length together is the
/// greatest possible. Each stretch has its length, and the band of its sub-domain; none outside the frame, where nothing is
/// kept.
///
/// Dynamic programming from stretch to stretch. A choice is dropped if another one is at least as long and leaves the water
/// at least as high. `n` stretches across `m` levels take at most `n` times `m` steps.
pub(super) fn longest_descent(stretches: &[(Option<Band>, f64)]) -> Vec<usize> {
    let mut ways = Ways { ways: vec![Way { height: f64::INFINITY, length: 0.0, last: None }], links: Vec::new() };
    for (stretch, &(band, length)) in stretches.iter().enumerate() {
        if let Some(band) = band {
            ways.extend_by(stretch, heights(band), length);
        }
    }
    ways.longest()
}

/// The lowest and the highest height of water in a band: strictly inside it on land, and the height of a lake in it.
fn heights(band: Band) -> [f64; 2] {
    if band.lo < band.hi { [band.lo.next_up(), band.hi.next_down()] } else { [band.lo, band.hi] }
}

/// One choice from the stretches so far.
#[derive(Clone, Copy)]
struct Way {
    /// The highest height that water can have at its end.
    height: f64,
    length: f64,
    /// Its last stretch, as a place in the links.
    last: Option<usize>,
}

/// The choices that remain. Their heights descend, and their lengths ascend.
struct Ways {
    ways: Vec<Way>,
    /// The stretches of the choices, each with the one before it.
    links: Vec<(usize, Option<usize>)>,
}

impl Ways {
    /// Adds a stretch to each choice that can run on into it. The choices without it remain too, if they are better.
    fn extend_by(&mut self, stretch: usize, [lowest, highest]: [f64; 2], length: f64) {
        let above = self.ways.partition_point(|way| way.height >= highest);
        let reaching = self.ways.partition_point(|way| way.height >= lowest);
        // Of those that end above this stretch, only the longest matters. The others keep their heights inside the band.
        let from = above.saturating_sub(1);
        let mut longer = self.ways[from..reaching].to_vec();
        for way in &mut longer {
            self.links.push((stretch, way.last));
            *way =
                Way { height: way.height.min(highest), length: way.length + length, last: Some(self.links.len() - 1) };
        }
        let longest = longer.last().map_or(0.0, |way| way.length);
        let mut lower = self.ways.split_off(reaching);
        lower.retain(|way| way.length > longest);
        self.ways.truncate(above);
        // A way that ends exactly as high as the first of these is shorter.
        self.ways.pop_if(|way| longer.first().is_some_and(|first| way.height == first.height));
        self.ways.extend(longer);
        self.ways.extend(lower);
    }

    /// The stretches of the longest choice.
    fn longest(&self) -> Vec<usize> {
        let mut next = self.ways.last().and_then(|way| way.last);
        let mut stretches = Vec::new();
        while let Some(link) = next {
            let (stretch, before) = self.links[link];
            stretches.push(stretch);
            next = before;
        }
        stretches.reverse();
        stretches
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::subdomains::is_above;

    fn band((lo, hi): (f64, f64)) -> Option<Band> {
        Some(Band { lo, hi })
    }

    #[test]
    fn all_of_a_reach_that_falls_is_kept() {
        let bands = [(30.0, 40.0), (20.0, 30.0), (20.0, 20.0), (20.0, 20.0), (10.0, 20.0), (0.0, 10.0)];
        assert_eq!(longest_descent(&bands.map(|b| (band(b), 1.0))), [0, 1, 2, 3, 4, 5]);
        assert!(longest_descent(&[]).is_empty());
        assert!(longest_descent(&[(None, 9.0)]).is_empty());
    }

    #[test]
    fn the_choice_is_made_over_the_whole_reach() {
        // Contour by contour, each of the rises is worth more than what lies lower before it.
        let bands =
            [((30.0, 40.0), 9.0), ((0.0, 10.0), 8.0), ((10.0, 20.0), 9.0), ((20.0, 30.0), 10.0), ((0.0, 10.0), 18.0)];
        let kept = longest_descent(&bands.map(|(b, length)| (band(b), length)));
        assert_eq!(kept, [0, 3, 4]);
        let bands =
            [((20.0, 30.0), 6.0), ((0.0, 10.0), 4.0), ((10.0, 20.0), 5.0), ((0.0, 10.0), 1.0), ((30.0, 40.0), 8.0)];
        let kept = longest_descent(&bands.map(|(b, length)| (band(b), length)));
        assert_eq!(kept, [0, 2, 3]);
    }

    proptest! {
        #[test]
        fn nothing_longer_can_be_kept(
            stretches in prop::collection::vec((prop::option::weighted(0.9, (0..5_u8, 0..3_u8)), 0..6_u8), 0..10)
        ) {
            let stretches: Vec<(Option<Band>, f64)> = stretches
                .into_iter()
                .map(|(b, length)| {
                    let band = b.map(|(lo, width)| Band { lo: f64::from(lo), hi: f64::from(lo + width) });
                    (band, f64::from(length))
                })
                .collect();
            let length = |kept: &[usize]| kept.iter().map(|&k| stretches[k].1).sum::<f64>();
            let falls = |kept: &[usize]| {
                let bands: Option<Vec<Band>> = kept.iter().map(|&k| stretches[k].0).collect();
                bands.is_some_and(|bands| (0..bands.len()).all(|j| (0..j).all(|i| !is_above(bands[j], bands[i]))))
            };
            let kept = longest_descent(&stretches);
            prop_assert!(falls(&kept), "{kept:?}");
            let most = (0..1_u32 << stretches.len())
                .map(|bits| (0..stretches.len()).filter(|k| bits >> k & 1 == 1).collect::<Vec<usize>>())
                .filter(|choice| falls(choice))
                .map(|choice| length(&choice))
                .fold(0.0, f64::max);
            prop_assert_eq!(length(&kept), most);
        }
    }
}
