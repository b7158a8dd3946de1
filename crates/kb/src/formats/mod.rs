//! Grasps in the formats that other programs read and write: one file for each.
//!
//! These formats give the pose of a link of the gripper, its palm, in the object's frame, where a [`Grasp`] gives that of the
//! tool; [`GraspFile`] stands between the two.

mod acronym;
mod archive;
mod isaac_grasp;
mod npz;

use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion};
use robotc_core::robot::Robot;
use robotc_core::{Gripper, Pose};
use robotc_planning::grasp::Grasp;
use thiserror::Error;

/// Grasps of one object by one gripper as other programs know them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GraspFile {
    /// What the object is called; a path or a frame, as the file says.
    pub object: String,
    /// The link of the gripper whose pose is given.
    pub gripper_link: String,
    /// Joints of the gripper, in the order of the values of each grasp.
    pub joints: Vec<String>,
    /// The grasps, in the order of the file.
    pub grasps: Vec<FileGrasp>,
}

/// A grasp as other programs know it.
#[derive(Debug, Clone, PartialEq)]
pub struct FileGrasp {
    /// The gripper's link in the object's frame.
    pub object_from_gripper: Pose,
    /// Joint values when closed; empty when the format has none.
    pub closed: Vec<f64>,
    /// Joint values to approach with; empty when the format has none.
    pub open: Vec<f64>,
    /// From 0 to 1.
    pub confidence: f64,
}

/// The formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GraspFormat {
    /// The YAML of Isaac Sim's grasp editor.
    IsaacGrasp,
    /// The fields of the ACRONYM data set (Eppner, Mousavian and Fox 2021) as JSON.
    Acronym,
    /// Arrays of numpy.
    Npz,
}

/// Why a text is not a file of grasps.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("not a valid {format} file: {reason}")]
pub struct FormatError {
    format: &'static str,
    reason: String,
}

impl GraspFile {
    /// The grasps of a set. Confidence is the score as a share of the best.
    pub fn of(object: &str, robot: &Robot, gripper: &Gripper, grasps: &[Grasp]) -> Self {
        let best = grasps.iter().map(|g| g.score).fold(f64::MIN_POSITIVE, f64::max);
        let one = |g: &Grasp| FileGrasp {
            object_from_gripper: g.object_from_tool * gripper.palm_from_tool.inverse(),
            closed: g.closed.clone(),
            open: gripper.preshapes[g.preshape].values.clone(),
            confidence: (g.score / best).clamp(0.0, 1.0),
        };
        Self {
            object: object.to_owned(),
            gripper_link: robot.model.links()[gripper.palm].name.clone(),
            joints: gripper.dofs.iter().map(|&d| robot.model.dofs()[d].name.clone()).collect(),
            grasps: grasps.iter().map(one).collect(),
        }
    }

    /// The bytes of a file in a format. What the format cannot say is left out: ACRONYM has one width for the fingers, and no joint
    /// names.
    pub fn write(&self, format: GraspFormat) -> Vec<u8> {
        match format {
            GraspFormat::IsaacGrasp => isaac_grasp::write(self).into_bytes(),
            GraspFormat::Acronym => acronym::write(self).into_bytes(),
            GraspFormat::Npz => npz::write(self),
        }
    }

    /// Reads the bytes of a file.
    pub fn read(bytes: &[u8], format: GraspFormat) -> Result<Self, FormatError> {
        let text = |format| {
            let wrong = |_| FormatError { format, reason: "it is not text in UTF-8".into() };
            std::str::from_utf8(bytes).map_err(wrong)
        };
        match format {
            GraspFormat::IsaacGrasp => isaac_grasp::read(text("isaac_grasp")?),
            GraspFormat::Acronym => acronym::read(text("ACRONYM")?),
            GraspFormat::Npz => npz::read(bytes),
        }
    }
}

/// The pose of a transform by rows; `None` when it is none, to single precision.
fn pose_of_rows(rows: &[[f64; 4]; 4]) -> Option<Pose> {
    if !rows.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
    let rigid = (matrix.transpose() * matrix - Matrix3::identity()).abs().max() < 1e-4;
    if !rigid || matrix.determinant() < 0.0 || rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return None;
    }
    let place = [rows[0][3], rows[1][3], rows[2][3]];
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    Some(Pose::from_parts(Translation3::from(place), rotation))
}

/// The transform of a pose, by rows.
fn rows_of_pose(pose: &Pose) -> [[f64; 4]; 4] {
    let matrix = pose.to_homogeneous();
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

#[cfg(test)]
mod tests {
    use robotc_core::Seed;

    use super::*;

    fn some() -> GraspFile {
        let mut rng = Seed::new(1).rng();
        let mut one = || FileGrasp {
            object_from_gripper: Pose::from_parts(
                Translation3::new(rng.normal(), 1e-7 * rng.normal(), rng.normal()),
                rng.rotation(),
            ),
            closed: vec![0.012, 1e-9],
            open: vec![0.04, 0.04],
            confidence: rng.unit(),
        };
        let grasps = (0..5).map(|_| one()).collect();
        let joints = vec!["left joint".to_owned(), "right: \"joint\"".to_owned()];
        GraspFile { object: "a \"mug\"".into(), gripper_link: "palm".into(), joints, grasps }
    }

    fn assert_poses_agree(a: &GraspFile, b: &GraspFile) {
        assert_eq!(a.grasps.len(), b.grasps.len());
        for (a, b) in a.grasps.iter().zip(&b.grasps) {
            let between = a.object_from_gripper.inv_mul(&b.object_from_gripper);
            assert!(between.translation.vector.norm() < 1e-12 && between.rotation.angle() < 1e-9);
            assert!((a.confidence - b.confidence).abs() < 1e-12);
        }
    }

    #[test]
    fn isaac_grasps_come_back_whole() {
        let file = some();
        let back = GraspFile::read(&file.write(GraspFormat::IsaacGrasp), GraspFormat::IsaacGrasp).unwrap();
        assert_poses_agree(&file, &back);
        assert_eq!((&back.object, &back.gripper_link), (&file.object, &file.gripper_link));
        assert_eq!(back.joints, file.joints);
        assert!(back.grasps.iter().all(|g| g.closed == [0.012, 1e-9] && g.open == [0.04, 0.04]));
    }

    #[test]
    fn acronym_poses_and_qualities_come_back() {
        let file = some();
        let back = GraspFile::read(&file.write(GraspFormat::Acronym), GraspFormat::Acronym).unwrap();
        assert_poses_agree(&file, &back);
        assert_eq!((&back.object, &back.gripper_link), (&file.object, &file.gripper_link));
    }

    #[test]
    fn arrays_come_back_whole() {
        let file = some();
        let back = GraspFile::read(&file.write(GraspFormat::Npz), GraspFormat::Npz).unwrap();
        assert_poses_agree(&file, &back);
        assert_eq!((&back.object, &back.gripper_link), (&file.object, &file.gripper_link));
        assert_eq!(back.joints, file.joints);
        assert!(back.grasps.iter().all(|g| g.closed == [0.012, 1e-9] && g.open == [0.04, 0.04]));
        let none = GraspFile { grasps: Vec::new(), ..file };
        assert_eq!(GraspFile::read(&none.write(GraspFormat::Npz), GraspFormat::Npz), Ok(none));
    }

    #[test]
    fn files_of_others_are_read_and_broken_ones_refused() {
        let isaac = "format: isaac_grasp\nformat_version: 1.0\nobject_frame_link: /World/mug\n\
            gripper_frame_link: /World/hand\ngrasps:\n  grasp_1:\n    confidence: 0.5\n    position: [0, 0, 0.1]\n    \
            orientation: {w: 2.0, xyz: [0, 0, 0]}\n    cspace_position: {finger: 0.02}\n    \
            pregrasp_cspace_position: {finger: 0.04}\n";
        let file = GraspFile::read(isaac.as_bytes(), GraspFormat::IsaacGrasp).unwrap();
        assert_eq!((file.joints.len(), file.grasps[0].closed[0]), (1, 0.02));
        assert_eq!(file.grasps[0].object_from_gripper, Pose::translation(0.0, 0.0, 0.1));
        for broken in [
            "",
            "format: other",
            "format: isaac_grasp\ngrasps: [1]",
            &isaac.replace("w: 2.0", "w: 0.0"),
            &isaac.replace("0.1]", ".nan]"),
            "{\"grasps\": {\"transforms\": [[[1]]]}}",
        ] {
            assert!(GraspFile::read(broken.as_bytes(), GraspFormat::IsaacGrasp).is_err(), "{broken}");
            assert!(GraspFile::read(broken.as_bytes(), GraspFormat::Acronym).is_err(), "{broken}");
        }
    }
}
