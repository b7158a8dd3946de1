//! Links of the Panda-class arm, in the frames of `specs/robots/panda/panda.urdf`.
//!
//! Each pitch joint (2, 4, 6) is a drum cut in two halves: one on the parent, one on the child. The limbs between
//! swing from the middle of the arm to their half of the drum and back.

use std::f64::consts::FRAC_PI_4;

use nalgebra::Vector3;
use robotc_core::model::TriMesh;

use super::part::Part;
use super::shape::{Loft, Section, along_minus_y, along_y, at, between, drum, lathe, moved, rounded_box};

/// A dark disc that closes the outer side of a drum.
fn cap(radius: f64, low: f64, high: f64) -> TriMesh {
    drum(radius, low, high, 0.0)
}

/// A dark ring between two links that turn about a common axis.
fn seam(radius: f64, low: f64, high: f64) -> TriMesh {
    drum(radius, low, high, 0.0)
}

/// All links.
pub(crate) fn parts() -> Vec<Part> {
    vec![link0(), link1(), link2(), link3(), link4(), link5(), link6(), link7(), hand(), finger()]
}

fn link0() -> Part {
    let body = Loft::new(
        [
            Section::oval(0.0, [-0.040, 0.0], [0.108, 0.092], 3.5),
            Section::oval(0.026, [-0.040, 0.0], [0.108, 0.092], 3.5),
            Section::oval(0.075, [-0.012, 0.0], [0.074, 0.069], 2.4),
            Section::circle(0.120, [0.0, 0.0], 0.0575),
            Section::circle(0.137, [0.0, 0.0], 0.0565),
        ],
        [0.004, 0.003],
    )
    .mesh();
    let socket = moved(&rounded_box([0.030, 0.090, 0.052], 0.006, 0.004), [-0.138, 0.0, 0.032]);
    let ring = seam(0.0535, 0.130, 0.1415);
    Part::new("link0", [body.clone()])
        .trim([ring.clone(), socket.clone()])
        .cover("_foot_hull", &[&between(&body, -0.1, 0.05), &socket], Vector3::z())
        .cover("_hull", &[&between(&body, 0.04, 0.2), &ring], Vector3::z())
}

fn link1() -> Part {
    let limb = Loft::new(
        [
            Section::circle(-0.188, [0.0, 0.0], 0.0550),
            Section::circle(-0.130, [0.0, 0.0], 0.0550),
            Section::oval(-0.055, [0.0, -0.040], [0.0555, 0.0560], 2.2),
            Section::oval(0.0, [0.0, -0.054], [0.0540, 0.0480], 2.6),
            Section::oval(0.050, [0.0, -0.054], [0.0500, 0.0460], 2.6),
        ],
        [0.003, 0.045],
    )
    .mesh();
    let shoulder = along_y(&drum(0.0570, -0.107, -0.002, 0.010));
    let ring = seam(0.0525, -0.1915, -0.180);
    Part::new("link1", [limb.clone(), shoulder])
        .trim([ring.clone(), along_y(&cap(0.0420, -0.110, -0.100))])
        .cover("_hull", &[&limb, &ring], Vector3::z())
}

fn link2() -> Part {
    let limb = along_minus_y(
        &Loft::new(
            [
                Section::oval(-0.050, [0.0, 0.054], [0.0500, 0.0460], 2.6),
                Section::oval(0.0, [0.0, 0.054], [0.0540, 0.0480], 2.6),
                Section::oval(0.055, [0.0, 0.040], [0.0555, 0.0560], 2.2),
                Section::circle(0.130, [0.0, 0.0], 0.0550),
                Section::circle(0.191, [0.0, 0.0], 0.0545),
            ],
            [0.045, 0.003],
        )
        .mesh(),
    );
    let shoulder = drum(0.0570, 0.002, 0.107, 0.010);
    let ring = along_minus_y(&seam(0.0520, 0.185, 0.1945));
    Part::new("link2", [limb.clone(), shoulder]).trim([ring.clone(), cap(0.0420, 0.100, 0.110)]).cover(
        "_hull",
        &[&limb, &ring],
        Vector3::y(),
    )
}

fn link3() -> Part {
    let limb = Loft::new(
        [
            Section::circle(-0.1195, [0.0, 0.0], 0.0545),
            Section::circle(-0.085, [0.006, 0.003], 0.0545),
            Section::oval(-0.035, [0.060, 0.034], [0.0560, 0.0540], 2.2),
            Section::oval(0.0, [0.0825, 0.051], [0.0505, 0.0450], 2.6),
            Section::oval(0.046, [0.0825, 0.050], [0.0460, 0.0430], 2.6),
        ],
        [0.003, 0.042],
    )
    .mesh();
    let elbow = moved(&along_y(&drum(0.0535, 0.002, 0.101, 0.010)), [0.0825, 0.0, 0.0]);
    let disc = moved(&along_y(&cap(0.0400, 0.094, 0.104)), [0.0825, 0.0, 0.0]);
    Part::new("link3", [limb.clone(), elbow]).trim([disc]).cover("_hull", &[&limb], Vector3::z())
}

fn link4() -> Part {
    let limb = along_y(
        &Loft::new(
            [
                Section::oval(-0.046, [0.0, -0.050], [0.0460, 0.0430], 2.6),
                Section::oval(0.0, [0.0, -0.051], [0.0505, 0.0450], 2.6),
                Section::oval(0.035, [-0.0225, -0.034], [0.0560, 0.0540], 2.2),
                Section::circle(0.085, [-0.0765, -0.003], 0.0540),
                Section::circle(0.1205, [-0.0825, 0.0], 0.0535),
            ],
            [0.042, 0.003],
        )
        .mesh(),
    );
    let elbow = drum(0.0535, 0.002, 0.101, 0.010);
    let ring = moved(&along_y(&seam(0.0510, 0.115, 0.1240)), [-0.0825, 0.0, 0.0]);
    Part::new("link4", [limb.clone(), elbow]).trim([cap(0.0400, 0.094, 0.104), ring.clone()]).cover(
        "_hull",
        &[&limb, &ring],
        Vector3::y(),
    )
}

fn link5() -> Part {
    let limb = Loft::new(
        [
            Section::circle(-0.2595, [0.0, 0.0], 0.0535),
            Section::circle(-0.205, [0.0, 0.0], 0.0530),
            Section::oval(-0.120, [0.0, 0.046], [0.0430, 0.0440], 2.3),
            Section::oval(-0.050, [0.0, 0.076], [0.0440, 0.0330], 2.5),
            Section::oval(0.0, [0.0, 0.084], [0.0470, 0.0310], 2.6),
            Section::oval(0.042, [0.0, 0.084], [0.0430, 0.0290], 2.6),
        ],
        [0.003, 0.028],
    )
    .mesh();
    let wrist = along_y(&drum(0.0490, 0.052, 0.117, 0.009));
    Part::new("link5", [limb.clone(), wrist])
        .trim([along_y(&cap(0.0370, 0.110, 0.120))])
        .cover("_upper_hull", &[&between(&limb, -0.3, -0.165)], Vector3::z())
        .cover("_hull", &[&between(&limb, -0.14, 0.1)], Vector3::z())
}

fn link6() -> Part {
    let wrist = drum(0.0490, -0.046, 0.050, 0.010);
    let bridge = Loft::new(
        [
            Section::oval(-0.042, [0.034, 0.0], [0.064, 0.0370], 3.0),
            Section::oval(0.042, [0.034, 0.0], [0.064, 0.0370], 3.0),
        ],
        [0.012, 0.012],
    )
    .mesh();
    let turret = moved(&along_y(&drum(0.0440, -0.050, 0.056, 0.010)), [0.088, 0.0, 0.0]);
    let lamp = moved(&along_y(&cap(0.0300, 0.050, 0.059)), [0.088, 0.0, 0.0]);
    let disc = cap(0.0370, 0.044, 0.053);
    Part::new("link6", [wrist.clone(), bridge.clone(), turret]).trim([disc.clone(), lamp]).cover(
        "_hull",
        &[&wrist, &bridge, &disc],
        Vector3::z(),
    )
}

fn link7() -> Part {
    let body = lathe(
        &[
            [0.0, 0.0525, 0.0],
            [0.0430, 0.0525, 0.003],
            [0.0430, 0.090, 0.006],
            [0.0350, 0.0975, 0.004],
            [0.0350, 0.1, 0.0],
            [0.0, 0.1, 0.0],
        ],
        24,
    );
    let handle = rounded_box([0.052, 0.030, 0.028], 0.009, 0.006)
        .transformed(&at([0.040, 0.040, 0.076], [0.0, 0.0, FRAC_PI_4]));
    Part::new("link7", [body, handle]).trim([seam(0.0320, 0.098, 0.107)])
}

fn hand() -> Part {
    let body = Loft::new(
        [
            Section::oval(0.004, [0.0, 0.0], [0.0300, 0.0620], 3.0),
            Section::oval(0.022, [0.0, 0.0], [0.0310, 0.0950], 3.6),
            Section::oval(0.040, [0.0, 0.0], [0.0310, 0.1010], 4.0),
            Section::oval(0.060, [0.0, 0.0], [0.0280, 0.1010], 4.0),
        ],
        [0.004, 0.003],
    )
    .mesh();
    let flange = drum(0.0315, 0.0, 0.012, 0.001);
    let rail = moved(&rounded_box([0.024, 0.190, 0.012], 0.004, 0.001), [0.0, 0.0, 0.0595]);
    Part::new("hand", [body.clone()]).trim([flange.clone(), rail.clone()]).cover(
        "_hull",
        &[&body, &flange, &rail],
        Vector3::y(),
    )
}

/// The finger on the side of +y: its pad lies in the plane y = 0.
fn finger() -> Part {
    let carriage = moved(&rounded_box([0.021, 0.0215, 0.019], 0.003, 0.0015), [0.0, 0.01525, 0.0105]);
    let blade = Loft::new(
        [
            Section::oval(0.012, [0.0, 0.0150], [0.0100, 0.0095], 6.0),
            Section::oval(0.026, [0.0, 0.0120], [0.0100, 0.0090], 6.0),
            Section::oval(0.038, [0.0, 0.0070], [0.0095, 0.0062], 8.0),
            Section::oval(0.0536, [0.0, 0.0062], [0.0090, 0.0054], 8.0),
        ],
        [0.001, 0.002],
    );
    let blade = Loft { around: 24, steps: 2, ..blade }.mesh();
    let pad = moved(&rounded_box([0.0175, 0.0020, 0.0185], 0.0008, 0.0006), [0.0, 0.0010, 0.0440]);
    Part::new("finger", [carriage, blade]).trim([pad])
}
