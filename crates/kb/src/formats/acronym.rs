//! The fields of the ACRONYM data set as JSON: 4 x 4 transforms of the gripper in the object's frame, and whether each holds.

use serde::{Deserialize, Serialize};

use super::{FileGrasp, FormatError, GraspFile, pose_of_rows, rows_of_pose};

#[derive(Serialize, Deserialize)]
struct File {
    #[serde(default)]
    object: Object,
    #[serde(default)]
    gripper: Gripper,
    grasps: Grasps,
}

#[derive(Serialize, Deserialize, Default)]
struct Object {
    #[serde(default)]
    file: String,
    #[serde(default = "one")]
    scale: f64,
}

#[derive(Serialize, Deserialize, Default)]
struct Gripper {
    #[serde(default)]
    link: String,
}

#[derive(Serialize, Deserialize)]
struct Grasps {
    transforms: Vec<[[f64; 4]; 4]>,
    /// 1 where the object stayed in the gripper, or how sure that is.
    #[serde(default)]
    object_in_gripper: Vec<f64>,
}

fn one() -> f64 {
    1.0
}

pub(super) fn read(text: &str) -> Result<GraspFile, FormatError> {
    let wrong = |reason: String| FormatError { format: "ACRONYM", reason };
    let file: File = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
    let qualities = &file.grasps.object_in_gripper;
    if !qualities.is_empty() && qualities.len() != file.grasps.transforms.len() {
        let (have, need) = (qualities.len(), file.grasps.transforms.len());
        return Err(wrong(format!("{have} values of object_in_gripper for {need} transforms")));
    }
    let grasp = |(i, rows): (usize, &[[f64; 4]; 4])| {
        let object_from_gripper =
            pose_of_rows(rows).ok_or_else(|| wrong(format!("transform {i} is not a rigid motion")))?;
        let confidence = qualities.get(i).copied().unwrap_or(1.0);
        Ok(FileGrasp { object_from_gripper, closed: Vec::new(), open: Vec::new(), confidence })
    };
    let grasps = file.grasps.transforms.iter().enumerate().map(grasp).collect::<Result<_, _>>()?;
    let (object, gripper_link) = (file.object.file, file.gripper.link);
    Ok(GraspFile { object, gripper_link, joints: Vec::new(), grasps })
}

pub(super) fn write(file: &GraspFile) -> String {
    let rows = |g: &FileGrasp| rows_of_pose(&g.object_from_gripper);
    let file = File {
        object: Object { file: file.object.clone(), scale: 1.0 },
        gripper: Gripper { link: file.gripper_link.clone() },
        grasps: Grasps {
            transforms: file.grasps.iter().map(rows).collect(),
            object_in_gripper: file.grasps.iter().map(|g| g.confidence).collect(),
        },
    };
    serde_json::to_string(&file).expect("numbers and texts are JSON") + "\n"
}
