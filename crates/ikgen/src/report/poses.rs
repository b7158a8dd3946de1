//! Joint vectors at which a solver is tried: random ones, and those where axes line up.

use robotc_core::Seed;
use robotc_core::model::SerialChain;
use robotc_core::rng::Rng;

use crate::jacobian::jacobian_determinant;
pub use crate::vectors::{random, slides};

/// A named set of joint vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSet {
    /// random, wrist, elbow, shoulder, zero, grid90 or near.
    pub name: &'static str,
    /// Whether the generating joint vector must be among the answers.
    pub regular: bool,
    /// The joint vectors.
    pub vectors: Vec<Vec<f64>>,
}

/// All sets, `poses` vectors each at most; `given` are the free variables of the solver.
///
/// - random: uniform over a full turn, lengths over their limits;
/// - wrist, elbow, shoulder: random, then the fifth, third or second joint that is solved for is moved to a root of the
///   Jacobian's determinant (chains with six joints to solve for only);
/// - zero: all variables zero;
/// - grid90: every angle a multiple of 90 degrees, all of them if they are no more than `poses`, else drawn;
/// - near: as wrist, elbow and shoulder, but off by 1e-9 to 1e-3, log-uniform.
pub fn sets(chain: &SerialChain, given: &[usize], poses: usize, seed: Seed) -> Vec<PoseSet> {
    let stream = |name: &str| seed.split(name).rng();
    let mut rng = stream("random");
    let mut sets = vec![PoseSet {
        name: "random",
        regular: true,
        vectors: (0..poses).map(|_| random(chain, &mut rng)).collect(),
    }];
    let solved_for: Vec<usize> = (0..chain.variables.len()).filter(|v| !given.contains(v)).collect();
    for (name, joint) in [("wrist", 4), ("elbow", 2), ("shoulder", 1)] {
        let mut rng = stream(name);
        let vectors = match solved_for.get(joint) {
            Some(v) if solved_for.len() == 6 => singular(chain, given, *v, poses, &mut rng),
            _ => Vec::new(),
        };
        sets.push(PoseSet { name, regular: false, vectors });
    }
    let mut rng = stream("near");
    let mut near = Vec::new();
    for (set, joint) in sets[1..].iter().zip([4, 2, 1]) {
        for vector in set.vectors.iter().take(poses.div_ceil(3)) {
            let mut vector = vector.clone();
            let size = libm::pow(10.0, rng.range(-9.0, -3.0));
            vector[solved_for[joint]] += if rng.unit() < 0.5 { -size } else { size };
            near.push(vector);
        }
    }
    let zero = vec![0.0; chain.variables.len()];
    sets.push(PoseSet { name: "zero", regular: false, vectors: vec![zero] });
    sets.push(PoseSet { name: "grid90", regular: false, vectors: grid(chain, poses, &mut stream("grid90")) });
    sets.push(PoseSet { name: "near", regular: false, vectors: near });
    sets
}

/// Random vectors with one joint moved to where the determinant changes its sign.
fn singular(
    chain: &SerialChain,
    given: &[usize],
    joint: usize,
    poses: usize,
    rng: &mut Rng,
) -> Vec<Vec<f64>> {
    use std::f64::consts::{FRAC_PI_2, PI};
    const STEPS: usize = 48;
    let mut found = Vec::new();
    if slides(chain)[joint] {
        return found;
    }
    for _ in 0..4 * poses {
        if found.len() == poses {
            break;
        }
        let mut vector = random(chain, rng);
        let start = vector[joint];
        let mut at = |x: f64| {
            vector[joint] = x;
            jacobian_determinant(chain, &vector, given).unwrap_or(f64::NAN)
        };
        let step = 2.0 * PI / STEPS as f64;
        let bracket = (0..STEPS).map(|k| start + step * k as f64).find(|x| at(*x) * at(x + step) < 0.0);
        let Some(mut low) = bracket else { continue };
        let mut high = low + step;
        let sign = at(low);
        while high - low > 1e-15 * (1.0 + low.abs()) {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if at(middle) * sign > 0.0 { low = middle } else { high = middle }
        }
        let mut root = 0.5 * (low + high);
        let quarter = (root / FRAC_PI_2).round() * FRAC_PI_2;
        if (root - quarter).abs() < 1e-9 {
            root = quarter;
        }
        vector[joint] = root;
        found.push(vector);
    }
    found
}

fn grid(chain: &SerialChain, poses: usize, rng: &mut Rng) -> Vec<Vec<f64>> {
    let slides = slides(chain);
    let n = slides.len();
    let all = 4usize.checked_pow(n as u32).filter(|all| *all <= poses);
    let draw = |index: usize| {
        (0..n)
            .map(|v| {
                if slides[v] {
                    0.0
                } else {
                    ((index >> (2 * v) & 3) as f64 - 1.0) * std::f64::consts::FRAC_PI_2
                }
            })
            .collect()
    };
    match all {
        Some(all) => (0..all).map(draw).collect(),
        None => (0..poses).map(|_| draw(rng.bits() as usize)).collect(),
    }
}
