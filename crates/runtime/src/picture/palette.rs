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

#[cfg(test)]
mod tests {
    use super::*;

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
