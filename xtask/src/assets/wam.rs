//! Links of the Barrett-WAM-class arm, in the frames of `specs/robots/wam/wam.urdf`.
//!
//! Pitch joints are forks: two cheeks on the parent, a drum between them on the child.

use nalgebra::Vector3;
use robotc_core::model::TriMesh;

use super::part::Part;
use super::shape::{Loft, Section, along_minus_y, along_y, between, drum, join, lathe, moved, rounded_box};

/// All links of the arm.
pub(crate) fn parts() -> Vec<Part> {
    vec![
        base(),
        shoulder_yaw(),
        shoulder_pitch(),
        upper_arm(),
        forearm(),
        wrist_yaw(),
        wrist_pitch(),
        wrist_palm(),
    ]
}

/// Two copies, at y and -y.
fn both_sides(mesh: &TriMesh) -> TriMesh {
    join([mesh.clone(), mesh.scaled(Vector3::new(1.0, -1.0, 1.0))])
}

fn base() -> Part {
    let foot = Loft::new(
        [
            Section::oval(0.0, [-0.040, 0.0], [0.180, 0.138], 4.5),
            Section::oval(0.045, [-0.040, 0.0], [0.180, 0.138], 4.5),
            Section::oval(0.090, [-0.020, 0.0], [0.150, 0.132], 3.2),
            Section::circle(0.130, [0.0, 0.0], 0.1250),
            Section::circle(0.152, [0.0, 0.0], 0.1230),
        ],
        [0.006, 0.004],
    )
    .mesh();
    let ring = drum(0.1120, 0.140, 0.1620, 0.0);
    let panel = moved(&rounded_box([0.020, 0.170, 0.060], 0.008, 0.006), [-0.218, 0.0, 0.036]);
    Part::new("base", [foot.clone()])
        .trim([ring.clone(), panel.clone()])
        .cover("_foot_hull", &[&between(&foot, -0.1, 0.06), &panel], Vector3::z())
        .cover("_hull", &[&between(&foot, 0.05, 0.2), &ring], Vector3::z())
}

fn shoulder_yaw() -> Part {
    let column = Loft::new(
        [
            Section::circle(-0.184, [0.0, 0.0], 0.1230),
            Section::circle(-0.160, [0.0, 0.0], 0.1230),
            Section::oval(-0.135, [0.0, 0.0], [0.1000, 0.1400], 3.0),
            Section::oval(-0.106, [0.0, 0.0], [0.0700, 0.1470], 4.0),
        ],
        [0.004, 0.006],
    )
    .mesh();
    let cheek = Loft::new(
        [
            Section::oval(-0.120, [0.0, 0.112], [0.0840, 0.0350], 5.0),
            Section::oval(0.0, [0.0, 0.112], [0.0840, 0.0350], 5.0),
        ],
        [0.0, 0.0],
    );
    let cheek = Loft { steps: 1, ..cheek }.mesh();
    let drums = along_y(&drum(0.0880, 0.0760, 0.1500, 0.008));
    let lids = along_y(&drum(0.0600, 0.1400, 0.1560, 0.003));
    Part::new("shoulder_yaw", [column.clone(), both_sides(&cheek), both_sides(&drums)])
        .trim([both_sides(&lids)])
        .cover("_hull", &[&column], Vector3::z())
}

fn shoulder_pitch() -> Part {
    let hub = drum(0.0640, -0.0735, 0.0735, 0.004);
    let neck = along_minus_y(&lathe(
        &[
            [0.0, 0.0, 0.0],
            [0.0600, 0.0, 0.0],
            [0.0600, 0.066, 0.004],
            [0.0560, 0.078, 0.004],
            [0.0560, 0.112, 0.003],
            [0.0, 0.112, 0.0],
        ],
        24,
    ));
    let ring = along_minus_y(&drum(0.0520, 0.108, 0.1160, 0.0));
    Part::new("shoulder_pitch", [hub, neck]).trim([ring])
}

fn upper_arm() -> Part {
    let tube = Loft {
        steps: 2,
        ..Loft::new(
            [
                Section::circle(0.1165, [0.0, 0.0], 0.0555),
                Section::circle(0.170, [0.0, 0.0], 0.0550),
                Section::circle(0.200, [0.0, 0.0], 0.0490),
                Section::circle(0.400, [0.0, 0.0], 0.0470),
                Section::oval(0.450, [0.012, 0.0], [0.0500, 0.0560], 2.4),
                Section::oval(0.492, [0.026, 0.0], [0.0520, 0.0640], 3.5),
            ],
            [0.004, 0.006],
        )
    }
    .mesh();
    let cheek = Loft::new(
        [
            Section::oval(0.470, [0.026, 0.0555], [0.0500, 0.0085], 5.0),
            Section::oval(0.550, [0.045, 0.0555], [0.0480, 0.0085], 5.0),
        ],
        [0.0, 0.0],
    )
    .mesh();
    let drums = moved(&along_y(&drum(0.0490, 0.0470, 0.0640, 0.003)), [0.045, 0.0, 0.55]);
    let lids = moved(&along_y(&drum(0.0330, 0.0600, 0.0680, 0.002)), [0.045, 0.0, 0.55]);
    let cheeks = join([both_sides(&cheek), both_sides(&drums)]);
    Part::new("upper_arm", [tube.clone(), cheeks]).trim([both_sides(&lids)])
}

fn forearm() -> Part {
    let hub = drum(0.0480, -0.0455, 0.0455, 0.004);
    let tube = along_minus_y(
        &Loft::new(
            [
                Section::oval(0.0, [0.0, 0.0], [0.0440, 0.0420], 3.0),
                Section::oval(0.030, [-0.018, 0.0], [0.0470, 0.0430], 2.6),
                Section::circle(0.080, [-0.045, 0.0], 0.0460),
                Section::circle(0.120, [-0.045, 0.0], 0.0450),
                Section::circle(0.234, [-0.045, 0.0], 0.0430),
            ],
            [0.0, 0.003],
        )
        .mesh(),
    );
    let ring = moved(&along_minus_y(&drum(0.0400, 0.228, 0.2375, 0.0)), [-0.045, 0.0, 0.0]);
    Part::new("forearm", [hub, tube.clone()]).trim([ring.clone()]).cover(
        "_hull",
        &[&tube, &ring],
        Vector3::y(),
    )
}

fn wrist_yaw() -> Part {
    let collar = drum(0.0430, -0.0620, -0.0360, 0.004);
    let cheek = Loft::new(
        [
            Section::oval(-0.050, [0.0, 0.0365], [0.0215, 0.0065], 5.0),
            Section::oval(0.0, [0.0, 0.0365], [0.0245, 0.0065], 5.0),
        ],
        [0.0, 0.0],
    )
    .mesh();
    let drums = along_y(&drum(0.0260, 0.0300, 0.0430, 0.003));
    let lids = along_y(&drum(0.0170, 0.0400, 0.0455, 0.001));
    Part::new("wrist_yaw", [collar, both_sides(&cheek), both_sides(&drums)]).trim([both_sides(&lids)])
}

fn wrist_pitch() -> Part {
    let hub = drum(0.0260, -0.0290, 0.0290, 0.003);
    let neck = along_minus_y(&lathe(
        &[
            [0.0, 0.0, 0.0],
            [0.0240, 0.0, 0.0],
            [0.0240, 0.026, 0.003],
            [0.0300, 0.034, 0.003],
            [0.0300, 0.0465, 0.001],
            [0.0, 0.0465, 0.0],
        ],
        24,
    ));
    Part::new("wrist_pitch", [hub, neck])
}

fn wrist_palm() -> Part {
    Part::new("wrist_palm", [drum(0.0430, 0.0475, 0.0600, 0.003)])
}
