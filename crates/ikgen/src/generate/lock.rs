//! Which joints of a redundant chain are given by the caller.

use robotc_core::Seed;
use robotc_core::model::SerialChain;

use crate::jacobian::{jacobian, jacobian_determinant};
use crate::vectors::random;

/// Choices of free variables, best first: none for up to six variables that all matter; of seven each one that leaves a
/// chain that moves well, farthest from the base first; of more as many as are too many, likewise. No choice beyond twelve.
///
/// A chain of up to six variables that has more of them than ways to move (several slides along one direction) gets those
/// given, from the tip, without which it moves as before.
pub(super) fn choices(chain: &SerialChain) -> Vec<Vec<usize>> {
    match chain.variables.len() {
        0..=6 => {
            let whole = freedom(chain, &[]);
            let mut given = Vec::new();
            for v in (0..chain.variables.len()).rev() {
                given.push(v);
                if freedom(chain, &given) < whole {
                    given.pop();
                }
            }
            given.reverse();
            vec![given]
        }
        7 => {
            let score: Vec<f64> = (0..7).map(|v| freedom_without(chain, &[v])).collect();
            let best = score.iter().fold(0.0, |a: f64, b| a.max(*b));
            // A joint whose loss costs most of the freedom (an elbow) is a poor one to give, though not a forbidden one.
            let (mut good, poor): (Vec<usize>, Vec<usize>) =
                (0..7).rev().partition(|v| score[*v] > 0.2 * best);
            good.extend(poor.into_iter().filter(|v| score[*v] > 1e-6 * best));
            good.into_iter().map(|v| vec![v]).collect()
        }
        8..=12 => choices_beside(chain, chain.variables.len(), &[]),
        _ => Vec::new(),
    }
}

/// As [`choices`], for a chain whose first `own` variables alone may be chosen; `given` ones are given in any case.
///
/// As many are chosen as there are more than ways to move: those farthest from the base first that leave these ways, and
/// move well.
pub(super) fn choices_beside(chain: &SerialChain, own: usize, given: &[usize]) -> Vec<Vec<usize>> {
    const MOST: usize = 12;
    let ways = freedom(chain, given);
    let surplus = chain.variables.len() - given.len() - ways;
    let mut good: Vec<(f64, Vec<usize>)> = Vec::new();
    for chosen in subsets(own, surplus) {
        let without = [&chosen[..], given].concat();
        if freedom(chain, &without) == ways {
            good.push((freedom_without(chain, &without), without));
        }
    }
    let best = good.iter().fold(0.0, |a: f64, (score, _)| a.max(*score));
    good.retain(|(score, _)| *score >= 0.2 * best);
    good.into_iter().map(|(_, without)| without).take(MOST).collect()
}

/// Sets of `size` of the numbers below `count`, each ascending, those of the largest numbers first.
fn subsets(count: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let last = (size - 1..count).rev();
    let with = |last: usize| subsets(last, size - 1).into_iter().map(move |rest| [rest, vec![last]].concat());
    last.flat_map(with).collect()
}

/// In how many ways a chain moves at a random place without these variables.
pub(super) fn freedom(chain: &SerialChain, without: &[usize]) -> usize {
    let mut rng = Seed::new(0).split("ikgen freedom").rng();
    let columns = jacobian(chain, &random(chain, &mut rng));
    let left: Vec<usize> = (0..columns.len()).filter(|v| !without.contains(v)).collect();
    if left.is_empty() {
        return 0;
    }
    nalgebra::DMatrix::from_fn(6, left.len(), |i, j| columns[left[j]][i]).rank(1e-3)
}

/// Mean volume of the Jacobian (per radian and metre) without some variables; zero unless six are left.
fn freedom_without(chain: &SerialChain, without: &[usize]) -> f64 {
    let mut rng = Seed::new(0).split("ikgen lock").rng();
    let mut sum = 0.0;
    for _ in 0..200 {
        let values = random(chain, &mut rng);
        sum += jacobian_determinant(chain, &values, without).unwrap_or(0.0).abs();
    }
    sum
}
