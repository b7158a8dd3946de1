//! Things to grasp. Each stands on z = 0, the origin in the middle of its base.

use std::f64::consts::{PI, TAU};

use robotc_core::model::TriMesh;

use super::shape::{annulus, at, circle, join, lathe, prism, tube};

/// All objects by file name.
pub(crate) fn all() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("mug", mug()),
        ("bracket", bracket()),
        ("flanged_shaft", flanged_shaft()),
        ("gear", gear()),
        ("bolt", bolt()),
        ("stepped_block", stepped_block()),
    ]
}

/// A mug, 72 mm wide without its handle (jaws that open to 80 mm fit round it) and 100 mm high, with a wall of 4 mm;
/// the handle points along +x.
fn mug() -> TriMesh {
    let body = lathe(
        &[
            [0.0, 0.0, 0.0],
            [0.036, 0.0, 0.006],
            [0.036, 0.100, 0.0019],
            [0.032, 0.100, 0.0019],
            [0.032, 0.006, 0.005],
            [0.0, 0.006, 0.0],
        ],
        36,
    );
    let steps = 12;
    let path: Vec<[f64; 2]> = (0..=steps)
        .map(|i| {
            let angle = PI * (0.5 - f64::from(i) / f64::from(steps));
            let reach = |v: f64| v.signum() * libm::pow(v.abs(), 0.8);
            [0.0335 + 0.031 * reach(libm::cos(angle)).max(0.0), 0.052 + 0.030 * reach(libm::sin(angle))]
        })
        .collect();
    join([body, tube(&path, [0.0065, 0.0040], 10)])
}

/// An angle bracket with a rib in its corner, 60 x 40 x 50 mm.
fn bracket() -> TriMesh {
    let (width, depth, height, wall) = (0.060, 0.040, 0.050, 0.008);
    let profile = [[0.0, 0.0], [width, 0.0], [width, wall], [wall, wall], [wall, height], [0.0, height]];
    let rib = [[wall - 0.001, wall - 0.001], [0.040, wall - 0.001], [wall - 0.001, 0.036]];
    let upright = at([-width / 2.0, depth / 2.0, 0.0], [PI / 2.0, 0.0, 0.0]);
    let plates = prism(&profile, [wall / 2.0; 2], 0.0, depth);
    let rib = prism(&rib, [0.016, 0.014], depth / 2.0 - 0.004, depth / 2.0 + 0.004);
    join([plates, rib]).transformed(&upright)
}

/// A shaft of 24 mm standing on its flange of 60 mm, 80 mm high.
fn flanged_shaft() -> TriMesh {
    lathe(
        &[
            [0.0, 0.0, 0.0],
            [0.030, 0.0, 0.001],
            [0.030, 0.012, 0.002],
            [0.016, 0.012, 0.002],
            [0.016, 0.022, 0.0],
            [0.012, 0.024, 0.0],
            [0.012, 0.080, 0.002],
            [0.0, 0.080, 0.0],
        ],
        32,
    )
}

/// A spur gear: 16 teeth, 70 mm across, 24 mm thick, with a bore and a hub 36 mm high.
fn gear() -> TriMesh {
    let (teeth, tip, root, bore) = (16, 0.035, 0.029, 0.008);
    let corners = teeth * 4;
    let angle = |i: usize| TAU * i as f64 / corners as f64;
    let radii = [root, tip, tip, root];
    // Teeth taper: the corners at the tip move together by a quarter of their distance.
    let lean = [-0.1, 0.25, -0.25, 0.1];
    let outside: Vec<[f64; 2]> = (0..corners)
        .map(|i| {
            let turned = angle(i) + lean[i % 4] * TAU / corners as f64;
            [radii[i % 4] * libm::cos(turned), radii[i % 4] * libm::sin(turned)]
        })
        .collect();
    let inside: Vec<[f64; 2]> = circle(corners).map(|[c, s]| [bore * c, bore * s]).collect();
    let hub: Vec<[f64; 2]> = circle(corners).map(|[c, s]| [0.016 * c, 0.016 * s]).collect();
    join([annulus(&outside, &inside, 0.0, 0.024), annulus(&hub, &inside, 0.020, 0.036)])
}

/// A bolt standing on its hexagonal head, 46 mm across flats, shank 28 mm, 78 mm high.
fn bolt() -> TriMesh {
    let corner = 0.023 / libm::cos(PI / 6.0);
    let head: Vec<[f64; 2]> = circle(6).map(|[c, s]| [corner * c, corner * s]).collect();
    let shank =
        lathe(&[[0.0, 0.012, 0.0], [0.014, 0.012, 0.0], [0.014, 0.078, 0.003], [0.0, 0.078, 0.0]], 28);
    join([prism(&head, [0.0; 2], 0.0, 0.019), shank])
}

/// A block of 70 x 44 mm with a step: 45 mm high, 22 mm at the low end.
fn stepped_block() -> TriMesh {
    let (half, depth, step) = (0.035, 0.044, 0.003);
    let profile = [
        [-half, 0.002],
        [-half + 0.002, 0.0],
        [half - 0.002, 0.0],
        [half, 0.002],
        [half, 0.020],
        [half - 0.002, 0.022],
        [step, 0.022],
        [step, 0.043],
        [step - 0.002, 0.045],
        [-half + 0.002, 0.045],
        [-half, 0.043],
    ];
    let upright = at([0.0, depth / 2.0, 0.0], [PI / 2.0, 0.0, 0.0]);
    prism(&profile, [-0.016, 0.011], 0.0, depth).transformed(&upright)
}
