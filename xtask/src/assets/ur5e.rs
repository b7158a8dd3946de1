//! Links of the UR5e-class arm and its gripper, in the frames of `specs/robots/ur5e/ur5e.urdf`.
//!
//! Housings are drums about the joint axes with coloured lids on their outer sides; tubes join them.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;
use robotc_core::model::TriMesh;

use super::part::Part;
use super::shape::{Loft, Section, along_minus_x, along_minus_y, along_y, drum, lathe, moved, rounded_box};

/// All links.
pub(crate) fn parts() -> Vec<Part> {
    vec![base(), shoulder(), upper_arm(), forearm(), wrist_1(), wrist_2(), wrist_3(), palm(), jaw()]
}

/// A lid with its rounded rim up.
fn lid(radius: f64, low: f64, high: f64) -> TriMesh {
    lathe(&[[0.0, low, 0.0], [radius, low, 0.0], [radius, high, (high - low) * 0.8], [0.0, high, 0.0]], 24)
}

/// A lid with its rounded rim down.
fn lid_below(radius: f64, low: f64, high: f64) -> TriMesh {
    lathe(&[[0.0, low, 0.0], [radius, low, (high - low) * 0.8], [radius, high, 0.0], [0.0, high, 0.0]], 24)
}

fn base() -> Part {
    let foot = lathe(
        &[
            [0.0, 0.0, 0.0],
            [0.0745, 0.0, 0.002],
            [0.0745, 0.016, 0.004],
            [0.0610, 0.024, 0.006],
            [0.0590, 0.097, 0.003],
            [0.0, 0.097, 0.0],
        ],
        32,
    );
    let socket = moved(&rounded_box([0.050, 0.024, 0.034], 0.006, 0.004), [0.0, -0.066, 0.044]);
    Part::new("base", [foot]).trim([socket])
}

fn shoulder() -> Part {
    let column = drum(0.0590, -0.0640, 0.020, 0.004);
    let housing = along_y(&drum(0.0600, -0.0760, 0.0560, 0.004));
    Part::new("shoulder", [column, housing]).trim([along_y(&lid(0.0585, 0.0550, 0.0680))])
}

fn upper_arm() -> Part {
    let shoulder = drum(0.0600, 0.0780, 0.1900, 0.004);
    let elbow = moved(&drum(0.0570, 0.0810, 0.1860, 0.004), [-0.425, 0.0, 0.0]);
    let tube = moved(
        &along_minus_x(&lathe(
            &[
                [0.0, 0.010, 0.0],
                [0.0530, 0.010, 0.0],
                [0.0530, 0.088, 0.006],
                [0.0480, 0.100, 0.006],
                [0.0460, 0.330, 0.006],
                [0.0500, 0.345, 0.006],
                [0.0500, 0.410, 0.0],
                [0.0, 0.410, 0.0],
            ],
            24,
        )),
        [0.0, 0.0, 0.138],
    );
    let lids = [lid(0.0585, 0.1890, 0.2010), moved(&lid(0.0555, 0.1850, 0.1970), [-0.425, 0.0, 0.0])];
    Part::new("upper_arm", [shoulder, elbow, tube]).trim(lids)
}

fn forearm() -> Part {
    let elbow = drum(0.0570, -0.0470, 0.0790, 0.004);
    let wrist = moved(&drum(0.0440, -0.0330, 0.0790, 0.004), [-0.3922, 0.0, 0.0]);
    let tube = moved(
        &along_minus_x(&lathe(
            &[
                [0.0, 0.010, 0.0],
                [0.0470, 0.010, 0.0],
                [0.0470, 0.080, 0.006],
                [0.0420, 0.092, 0.006],
                [0.0375, 0.320, 0.006],
                [0.0400, 0.335, 0.006],
                [0.0400, 0.385, 0.0],
                [0.0, 0.385, 0.0],
            ],
            24,
        )),
        [0.0, 0.0, 0.009],
    );
    let lids = [
        lid_below(0.0555, -0.0580, -0.0460),
        moved(&lid_below(0.0425, -0.0430, -0.0320), [-0.3922, 0.0, 0.0]),
    ];
    Part::new("forearm", [elbow, wrist, tube]).trim(lids)
}

fn wrist_1() -> Part {
    let housing = drum(0.0440, -0.0525, 0.0420, 0.004);
    let stub = along_minus_y(&drum(0.0430, 0.0, 0.0505, 0.003));
    Part::new("wrist_1", [housing, stub]).trim([lid(0.0425, 0.0410, 0.0520)])
}

fn wrist_2() -> Part {
    let housing = drum(0.0440, -0.0475, 0.0420, 0.004);
    let stub = along_y(&drum(0.0430, 0.0, 0.0505, 0.003));
    Part::new("wrist_2", [housing, stub]).trim([lid(0.0425, 0.0410, 0.0520)])
}

fn wrist_3() -> Part {
    let housing = lathe(
        &[
            [0.0, -0.0475, 0.0],
            [0.0430, -0.0475, 0.003],
            [0.0430, -0.0220, 0.005],
            [0.0375, -0.0160, 0.003],
            [0.0375, 0.0, 0.001],
            [0.0, 0.0, 0.0],
        ],
        24,
    );
    Part::new("wrist_3", [housing])
}

/// Body of the gripper, z towards the tips, jaws slide along x.
fn palm() -> Part {
    let coupling = drum(0.0375, 0.0, 0.013, 0.001);
    let body = Loft::new(
        [
            Section::circle(0.012, [0.0, 0.0], 0.0370),
            Section::oval(0.030, [0.0, 0.0], [0.0420, 0.0370], 2.4),
            Section::oval(0.056, [0.0, 0.0], [0.0640, 0.0330], 4.0),
            Section::oval(0.074, [0.0, 0.0], [0.0680, 0.0300], 5.0),
        ],
        [0.002, 0.004],
    )
    .mesh();
    let rail = moved(&rounded_box([0.128, 0.026, 0.010], 0.003, 0.001), [0.0, 0.0, 0.0755]);
    Part::new("palm", [body.clone()]).trim([coupling, rail]).cover("_hull", &[&body], Vector3::x())
}

/// The jaw on the side of +x: its pad lies in the plane x = 0. Origin at the height of the rail.
fn jaw() -> Part {
    let carriage = moved(&rounded_box([0.023, 0.030, 0.020], 0.004, 0.002), [0.0145, 0.0, 0.0110]);
    let blade = Loft {
        around: 24,
        steps: 2,
        ..Loft::new(
            [
                Section::oval(0.016, [0.0145, 0.0], [0.0105, 0.0130], 6.0),
                Section::oval(0.028, [0.0110, 0.0], [0.0090, 0.0120], 6.0),
                Section::oval(0.040, [0.0075, 0.0], [0.0060, 0.0112], 8.0),
                Section::oval(0.072, [0.0068, 0.0], [0.0053, 0.0105], 8.0),
            ],
            [0.001, 0.002],
        )
    }
    .mesh();
    let pad = rounded_box([0.0300, 0.0200, 0.0024], 0.0010, 0.0006);
    let pad = pad.transformed(&super::shape::at([0.0012, 0.0, 0.0560], [0.0, FRAC_PI_2, 0.0]));
    Part::new("jaw", [carriage, blade]).trim([pad])
}
