//! Colours for pictures.

/// A colour for the `index`-th of many things side by side: neighbours differ clearly in hue.
pub(super) fn distinct(index: usize) -> [f32; 4] {
    // Steps of the golden angle never come back to a hue they passed.
    let hue = (index as f32 * 0.618_034).fract() * 6.0;
    let [saturation, value] = [0.55, if index.is_multiple_of(2) { 0.90 } else { 0.75 }];
    let channel = |shift: f32| {
        let k = (shift + hue) % 6.0;
        value * (1.0 - saturation * k.min(4.0 - k).clamp(0.0, 1.0))
    };
    [channel(5.0), channel(3.0), channel(1.0), 1.0]
}

/// The colour of a share from 0 to 1: from dark violet over blue and green to yellow, lighter and lighter, so that the order is
/// seen without hue too.
pub(super) fn ramp(share: f32) -> [f32; 4] {
    const STOPS: [[f32; 3]; 5] =
        [[0.20, 0.06, 0.36], [0.20, 0.28, 0.58], [0.10, 0.52, 0.57], [0.38, 0.74, 0.36], [0.98, 0.89, 0.20]];
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (at as usize).min(STOPS.len() - 2);
    let along = at - below as f32;
    let [r, g, b] =
        std::array::from_fn(|i| STOPS[below][i] + along * (STOPS[below + 1][i] - STOPS[below][i]));
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_lighter() {
        let light = |share: f32| {
            let [r, g, b, _] = ramp(share);
            0.21 * r + 0.72 * g + 0.07 * b
        };
        assert!((0..100).all(|k| light(k as f32 / 100.0) < light((k + 1) as f32 / 100.0)));
        assert_eq!((ramp(-1.0), ramp(2.0)), (ramp(0.0), ramp(1.0)));
    }

    #[test]
    fn neighbours_differ() {
        let apart = |a: [f32; 4], b: [f32; 4]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max);
        for i in 0..64 {
            assert!(distinct(i).iter().all(|c| (0.0..=1.0).contains(c)));
            for j in i + 1..i + 4 {
                assert!(apart(distinct(i), distinct(j)) > 0.1, "{i} and {j}");
            }
        }
    }
}
