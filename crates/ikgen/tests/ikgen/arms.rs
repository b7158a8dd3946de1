//! One arm for each class, from published dimensions.

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::ids::Idx;
use robotc_core::model::{ChainJoint, ChainMotion, ChainVariable, SerialChain};
use robotc_core::{DofIdx, Pose};

/// A chain whose joint frames are all parallel to the base at zero: axis and position of each joint, then of the tip.
pub(crate) fn chain(name: &str, joints: &[([f64; 3], [f64; 3])], tip: [f64; 3]) -> SerialChain {
    let mut at = Vector3::zeros();
    let mut make = |i: usize, axis: &[f64; 3], point: &[f64; 3]| {
        let point = Vector3::from(*point);
        let step = point - at;
        at = point;
        ChainJoint {
            name: format!("j{}", i + 1),
            motion: ChainMotion::Revolute,
            previous_from_joint: Pose::from_parts(Translation3::from(step), UnitQuaternion::identity()),
            axis: Unit::new_normalize(Vector3::from(*axis)),
            variable: i,
            multiplier: 1.0,
            offset: 0.0,
        }
    };
    let joints: Vec<ChainJoint> = joints.iter().enumerate().map(|(i, (a, p))| make(i, a, p)).collect();
    let last = Translation3::from(Vector3::from(tip) - at);
    let variables = (0..joints.len())
        .map(|i| ChainVariable { name: format!("j{}", i + 1), dof: DofIdx::new(i), lower: -3.1, upper: 3.1 })
        .collect();
    // A tip frame that is not parallel to the base.
    let turn = UnitQuaternion::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    SerialChain { name: name.into(), joints, variables, last_from_tip: Pose::from_parts(last, turn) }
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Spherical wrist, axes 2 and 3 parallel (KUKA KR6 R900).
pub(crate) fn kr6() -> SerialChain {
    chain(
        "kr6",
        &[
            ([0.0, 0.0, -1.0], [0.0, 0.0, 0.4]),
            (Y, [0.025, 0.0, 0.4]),
            (Y, [0.48, 0.0, 0.4]),
            ([-1.0, 0.0, 0.0], [0.9, 0.0, 0.435]),
            (Y, [0.9, 0.0, 0.435]),
            ([-1.0, 0.0, 0.0], [0.98, 0.0, 0.435]),
        ],
        [0.98, 0.0, 0.435],
    )
}

/// The same with its last axis 0.02 mm beside the wrist: where the ideal arm loses roots six joints in general are asked.
pub(crate) fn nearly_kr6() -> SerialChain {
    let mut chain = kr6();
    chain.name = "nearly_kr6".into();
    chain.joints[5].previous_from_joint.translation.vector.y += 2e-5;
    chain
}

/// Spherical wrist on a shoulder without any relation between its axes.
pub(crate) fn skew() -> SerialChain {
    chain(
        "skew",
        &[
            (Z, [0.0, 0.0, 0.3]),
            ([0.1, 1.0, 0.2], [0.1, 0.05, 0.5]),
            ([1.0, 0.3, 0.1], [0.4, 0.1, 0.6]),
            (X, [0.8, 0.0, 0.7]),
            (Y, [0.8, 0.0, 0.7]),
            (X, [0.8, 0.0, 0.7]),
        ],
        [0.9, 0.0, 0.7],
    )
}

/// Axes 2, 3 and 4 parallel (Universal Robots UR5).
pub(crate) fn ur5() -> SerialChain {
    chain(
        "ur5",
        &[
            (Z, [0.0, 0.0, 0.089159]),
            (Y, [0.0, 0.13585, 0.089159]),
            (Y, [0.425, 0.01615, 0.089159]),
            (Y, [0.81725, 0.01615, 0.089159]),
            ([0.0, 0.0, -1.0], [0.81725, 0.10915, 0.089159]),
            (Y, [0.81725, 0.10915, -0.005491]),
        ],
        [0.81725, 0.19145, -0.005491],
    )
}

/// The same turned round: axes 3, 4 and 5 parallel.
pub(crate) fn ru5() -> SerialChain {
    chain(
        "ru5",
        &[
            (Y, [0.0, 0.0, 0.1]),
            (Z, [0.0, 0.08, 0.1]),
            (Y, [0.0, 0.16, 0.2]),
            (Y, [0.4, 0.16, 0.2]),
            (Y, [0.75, 0.16, 0.2]),
            (Z, [0.75, 0.25, 0.2]),
        ],
        [0.75, 0.25, 0.3],
    )
}

/// Spherical shoulder on six joints: the arm of `kr6` turned round.
pub(crate) fn shoulder() -> SerialChain {
    chain(
        "shoulder",
        &[
            (X, [0.0, 0.0, 0.3]),
            (Y, [0.0, 0.0, 0.3]),
            (X, [0.0, 0.0, 0.3]),
            (Y, [0.42, 0.0, 0.335]),
            (Y, [0.88, 0.0, 0.335]),
            (Z, [0.91, 0.0, 0.335]),
        ],
        [0.91, 0.0, 0.5],
    )
}

/// Seven joints, spherical shoulder, offset elbow and wrist (Franka Panda).
pub(crate) fn panda() -> SerialChain {
    chain(
        "panda",
        &[
            (Z, [0.0, 0.0, 0.333]),
            (Y, [0.0, 0.0, 0.333]),
            (Z, [0.0, 0.0, 0.649]),
            ([0.0, -1.0, 0.0], [0.0825, 0.0, 0.649]),
            (Z, [0.0, 0.0, 1.033]),
            ([0.0, -1.0, 0.0], [0.0, 0.0, 1.033]),
            ([0.0, 0.0, -1.0], [0.088, 0.0, 1.033]),
        ],
        [0.088, 0.0, 0.926],
    )
}

/// Seven joints, spherical shoulder and wrist (KUKA LBR iiwa).
pub(crate) fn iiwa() -> SerialChain {
    chain(
        "iiwa",
        &[
            (Z, [0.0, 0.0, 0.36]),
            (Y, [0.0, 0.0, 0.36]),
            (Z, [0.0, 0.0, 0.36]),
            ([0.0, -1.0, 0.0], [0.0, 0.0, 0.78]),
            (Z, [0.0, 0.0, 0.78]),
            (Y, [0.0, 0.0, 1.18]),
            (Z, [0.0, 0.0, 1.18]),
        ],
        [0.0, 0.0, 1.306],
    )
}

/// Seven joints, offset shoulder, spherical wrist: the given joint lies between unknown ones (Fetch).
pub(crate) fn fetch() -> SerialChain {
    chain(
        "fetch",
        &[
            (Z, [0.0, 0.0, 0.0]),
            (Y, [0.117, 0.0, 0.06]),
            (X, [0.336, 0.0, 0.06]),
            (Y, [0.469, 0.0, 0.06]),
            (X, [0.666, 0.0, 0.06]),
            (Y, [0.79, 0.0, 0.06]),
            (X, [0.9285, 0.0, 0.06]),
        ],
        [1.095, 0.0, 0.06],
    )
}

/// Five joints: pan, three parallel axes, roll (Katana).
pub(crate) fn katana() -> SerialChain {
    chain(
        "katana",
        &[
            (Z, [0.0, 0.0, 0.1]),
            (Y, [0.0, 0.0, 0.2]),
            (Y, [0.19, 0.0, 0.2]),
            (Y, [0.329, 0.0, 0.2]),
            (X, [0.4, 0.0, 0.2]),
        ],
        [0.5, 0.0, 0.2],
    )
}

/// Four joints: spherical shoulder and elbow (Barrett WAM without its wrist).
pub(crate) fn wam4() -> SerialChain {
    chain(
        "wam4",
        &[(Z, [0.0, 0.0, 0.3]), (Y, [0.0, 0.0, 0.3]), (Z, [0.0, 0.0, 0.3]), (Y, [0.045, 0.0, 0.85])],
        [0.0, 0.0, 1.15],
    )
}

/// Six joints without a triple: a wrist with an offset behind a spherical pair (UFACTORY xArm 6).
pub(crate) fn xarm6() -> SerialChain {
    chain(
        "xarm6",
        &[
            (Z, [0.0, 0.0, 0.267]),
            (Y, [0.0, 0.0, 0.267]),
            (Y, [0.053, 0.0, 0.5515]),
            ([0.0, 0.0, -1.0], [0.1305, 0.0, 0.209]),
            (Y, [0.1305, 0.0, 0.209]),
            ([0.0, 0.0, -1.0], [0.2065, 0.0, 0.112]),
        ],
        [0.2065, 0.0, 0.112],
    )
}

/// A wrist whose last axes meet beside the forearm, on an arm that moves in a plane (FANUC CRX-10iA/L).
pub(crate) fn crx10() -> SerialChain {
    chain(
        "crx10",
        &[
            (Z, [0.0, 0.0, 0.245]),
            (Y, [0.0, 0.0, 0.245]),
            ([0.0, -1.0, 0.0], [0.0, 0.0, 0.955]),
            ([-1.0, 0.0, 0.0], [0.0, 0.0, 0.955]),
            ([0.0, -1.0, 0.0], [0.54, 0.0, 0.955]),
            ([-1.0, 0.0, 0.0], [0.54, -0.15, 0.955]),
        ],
        [0.7, -0.15, 0.955],
    )
}

/// The same with upper arm and forearm of equal length: the wrist can be folded onto the shoulder (FANUC CRX-10iA).
pub(crate) fn crx10_even() -> SerialChain {
    let mut chain = crx10();
    chain.name = "crx10_even".into();
    chain.joints[2].previous_from_joint.translation.vector.z = 0.54;
    chain
}

/// Makes joints slide along their axes.
pub(crate) fn sliding(mut chain: SerialChain, joints: &[usize]) -> SerialChain {
    for i in joints {
        chain.joints[*i].motion = ChainMotion::Prismatic;
        (chain.variables[*i].lower, chain.variables[*i].upper) = (-0.4, 0.6);
    }
    chain
}

/// The chain with a joint that follows an earlier one.
pub(crate) fn following(mut chain: SerialChain, joint: usize, leader: usize, multiplier: f64) -> SerialChain {
    let lost = chain.joints[joint].variable;
    chain.joints[joint].multiplier = multiplier;
    chain.joints[joint].variable = chain.joints[leader].variable;
    chain.variables.remove(lost);
    for joint in &mut chain.joints {
        joint.variable -= usize::from(joint.variable > lost);
    }
    chain
}

/// Two turning joints, a quill and its turn.
pub(crate) fn scara() -> SerialChain {
    let z = |x: f64| (Z, [x, 0.0, 0.2]);
    sliding(chain("scara", &[z(0.0), z(0.3), z(0.55), z(0.55)], [0.55, 0.0, 0.1]), &[2])
}

/// A spherical wrist on two turning joints and one that slides (the Stanford arm).
pub(crate) fn stanford() -> SerialChain {
    let wrist = [0.15, 0.0, 0.9];
    let joints = [(Z, [0.0, 0.0, 0.4]), (Y, [0.0, 0.0, 0.4]), (Z, wrist), (Z, wrist), (Y, wrist), (Z, wrist)];
    sliding(chain("stanford", &joints, [0.15, 0.0, 1.1]), &[2])
}

/// A gantry with a wrist whose last axis does not meet the others.
pub(crate) fn gantry() -> SerialChain {
    let at = [0.2, 0.1, 1.0];
    let joints = [(X, at), (Y, at), (Z, at), (Z, at), (Y, at), (X, [0.3, 0.1, 0.95])];
    sliding(chain("gantry", &joints, [0.4, 0.1, 0.95]), &[0, 1, 2])
}

/// Four joints, the third of which follows the second to keep the fourth upright (a palletiser).
pub(crate) fn palletiser() -> SerialChain {
    let joints = [
        (Z, [0.0, 0.0, 0.3]),
        (Y, [0.1, 0.0, 0.5]),
        (Y, [0.1, 0.0, 1.1]),
        (Y, [0.7, 0.0, 1.1]),
        (Z, [0.8, 0.0, 1.1]),
    ];
    let mut chain = chain("palletiser", &joints, [0.8, 0.0, 1.0]);
    // The last pitch undoes the second one; the elbow is free.
    chain.joints[3].variable = 1;
    chain.joints[3].multiplier = -1.0;
    chain.joints[4].variable = 3;
    chain.variables.pop();
    chain
}

/// The arm as a calibration might find it: axes off by up to 7 mrad, origins by up to 1 mm.
pub(crate) fn calibrated(mut chain: SerialChain, rng: &mut robotc_core::rng::Rng) -> SerialChain {
    for joint in &mut chain.joints {
        let turn = rng.direction().into_inner() * rng.range(0.0, 0.007);
        let shift = rng.direction().into_inner() * rng.range(0.0, 0.001);
        joint.previous_from_joint *=
            Pose::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(turn));
    }
    chain
}

/// Robots of Diankov's thesis that come without a URDF, at zero, from their original files: joint axes and points as OpenRAVE's COLLADA
/// files and Klampt's `hrp2.rob` have them.
pub(crate) fn of_the_thesis() -> Vec<SerialChain> {
    let minus = |axis: [f64; 3]| axis.map(|x| 0.0 - x);
    let kr5 = [
        (minus(Z), [0.0, 0.0, 0.0]),
        (Y, [0.075, 0.0, 0.335]),
        (Y, [0.075, 0.0, 0.7]),
        (minus(X), [0.293, 0.0, 0.79]),
        (Y, [0.48, 0.0, 0.79]),
        (minus(X), [0.56, 0.0, 0.79]),
    ];
    let pa10 = [
        (Z, [0.0, 0.0, 0.315]),
        (Y, [0.0, 0.0, 0.315]),
        (Z, [0.0, 0.0, 0.315]),
        (Y, [0.0, 0.0, 0.765]),
        (Z, [0.0, 0.0, 0.765]),
        (Y, [0.0, 0.0, 1.265]),
        (Z, [0.0, 0.0, 1.265]),
    ];
    let manus = [
        (minus(Y), [0.045416, -0.147592, 0.467052]),
        (minus(X), [-0.084734, 0.302408, 0.467052]),
        (minus(X), [-0.084734, 0.302408, 0.872052]),
        (minus(Z), [-0.054734, 0.302408, 1.04805]),
        (Y, [-0.054734, 0.302408, 1.20305]),
        (minus(Z), [-0.054734, 0.302408, 1.20305]),
    ];
    let shoulder = [0.008, -0.25, 0.181];
    let hrp2 = [
        (Y, shoulder),
        (X, shoulder),
        (Z, shoulder),
        (Y, [0.008, -0.25, -0.069]),
        (Z, [0.008, -0.25, -0.319]),
        (Y, [0.008, -0.25, -0.319]),
    ];
    // The other source of the PA-10 has its wrist 2.5 mm off.
    let mut offset_pa10 = pa10;
    offset_pa10[5].1[0] = -0.0025;
    offset_pa10[6].1[0] = -0.0025;
    vec![
        chain("kuka_kr5_r850", &kr5, [0.56, 0.0, 0.79]),
        chain("mitsubishi_pa10", &pa10, [0.0, 0.0, 1.345]),
        chain("mitsubishi_pa10_openhrp", &offset_pa10, [-0.0025, 0.0, 1.345]),
        chain("exactdynamics_manus", &manus, [-0.0833026, 0.302408, 1.26517]),
        chain("aist_hrp2", &hrp2, [0.0299, -0.25, -0.40425]),
    ]
}

/// All of them.
pub(crate) fn all() -> Vec<SerialChain> {
    vec![
        kr6(),
        nearly_kr6(),
        skew(),
        ur5(),
        ru5(),
        shoulder(),
        panda(),
        iiwa(),
        fetch(),
        katana(),
        wam4(),
        xarm6(),
        crx10(),
        crx10_even(),
        scara(),
        stanford(),
        gantry(),
        palletiser(),
    ]
}
