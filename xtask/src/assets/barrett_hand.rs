//! Links of the three-finger hand of BarrettHand class, in the frames of `specs/robots/wam/wam.urdf`.
//!
//! Fingers 1 and 2 turn about the palm on an arm that runs in a slot below the palm plate; finger 3 is fixed.

use nalgebra::Vector3;
use robotc_core::model::TriMesh;

use super::part::Part;
use super::shape::{Loft, Section, along_x, along_y, drum, join, moved, rounded_box};

/// All links of the hand; the three fingers share theirs.
pub(crate) fn parts() -> Vec<Part> {
    vec![palm(), knuckle(), inner(), outer()]
}

fn palm() -> Part {
    let body = Loft::new(
        [
            Section::circle(0.0, [0.0, 0.0], 0.0430),
            Section::circle(0.012, [0.0, 0.0], 0.0430),
            Section::oval(0.034, [0.0, 0.003], [0.0450, 0.0440], 2.4),
        ],
        [0.002, 0.003],
    )
    .mesh();
    let plate = Loft::new(
        [
            Section::oval(0.0525, [0.0, 0.0], [0.0410, 0.0290], 3.0),
            Section::oval(0.062, [0.0, 0.0], [0.0430, 0.0300], 3.0),
            Section::oval(0.071, [0.0, 0.0], [0.0430, 0.0300], 3.0),
        ],
        [0.002, 0.004],
    )
    .mesh();
    let core = Loft::new(
        [
            Section::oval(0.030, [0.0, 0.0], [0.0100, 0.0300], 3.0),
            Section::oval(0.056, [0.0, 0.0], [0.0100, 0.0300], 3.0),
        ],
        [0.0, 0.0],
    )
    .mesh();
    let mount = moved(&rounded_box([0.0230, 0.0400, 0.0560], 0.005, 0.003), [0.0, 0.0380, 0.0470]);
    let pin = moved(&along_x(&drum(0.0125, -0.0063, 0.0063, 0.001)), [0.0, 0.050, 0.0754]);
    Part::new("palm", [body, plate, mount, pin]).trim([core])
}

/// The link that spreads fingers 1 and 2: an arm along x and an upright that carries the inner joint.
fn knuckle() -> Part {
    let pivot = drum(0.0125, -0.0060, 0.0100, 0.002);
    let arm = moved(&rounded_box([0.0560, 0.0225, 0.0150], 0.004, 0.002), [0.0300, 0.0, 0.0020]);
    let upright = moved(&rounded_box([0.0220, 0.0225, 0.0290], 0.005, 0.002), [0.0500, 0.0, 0.0090]);
    let pin = moved(&along_y(&drum(0.0125, -0.0063, 0.0063, 0.001)), [0.0500, 0.0, 0.0339]);
    Part::new("knuckle", [arm, upright, pin]).trim([pivot])
}

/// Two cheeks of a fork about z.
fn fork(radius: f64, inside: f64, outside: f64) -> TriMesh {
    let cheek = drum(radius, inside, outside, 0.001);
    join([cheek.clone(), cheek.scaled(Vector3::new(1.0, 1.0, -1.0))])
}

/// The inner link, along x; it closes towards +y.
fn inner() -> Part {
    let forks = fork(0.0115, 0.0066, 0.0108);
    let beam = Loft {
        around: 16,
        steps: 2,
        ..Loft::new(
            [
                // Along x: the first half width is along -z of the link, the second along y.
                Section::oval(0.004, [0.0, 0.0000], [0.0106, 0.0080], 4.0),
                Section::oval(0.020, [0.0, 0.0005], [0.0106, 0.0088], 4.0),
                Section::oval(0.058, [0.0, 0.0025], [0.0098, 0.0075], 4.0),
            ],
            [0.0, 0.003],
        )
    }
    .mesh();
    let tongue = moved(&drum(0.0090, -0.0055, 0.0055, 0.001), [0.06994, 0.003, 0.0]);
    let web = moved(&rounded_box([0.0180, 0.0130, 0.0110], 0.002, 0.001), [0.0600, 0.0025, 0.0]);
    let pad = moved(&rounded_box([0.0300, 0.0040, 0.0150], 0.0015, 0.0010), [0.0340, 0.0098, 0.0]);
    Part::new("inner", [forks, along_x(&beam), tongue, web]).trim([pad])
}

/// The finger tip, along x; it closes towards +y.
fn outer() -> Part {
    let forks = fork(0.0092, 0.0058, 0.0103);
    let beam = Loft {
        around: 16,
        steps: 2,
        ..Loft::new(
            [
                Section::oval(0.0080, [0.0, 0.0000], [0.0102, 0.0075], 4.0),
                Section::oval(0.0220, [0.0, -0.0005], [0.0098, 0.0078], 3.5),
                Section::oval(0.0580, [0.0, 0.0010], [0.0075, 0.0058], 2.6),
            ],
            [0.001, 0.005],
        )
    }
    .mesh();
    let pad = moved(&rounded_box([0.0340, 0.0040, 0.0130], 0.0015, 0.0010), [0.0330, 0.0068, 0.0]);
    Part::new("outer", [forks, along_x(&beam)]).trim([pad])
}
