//! Grasps as arrays for numpy: `numpy.load("mug.npz")["transforms"]`.
//!
//! `transforms` (N x 4 x 4, the gripper's link in the object's frame) and `confidence` (N) for N grasps; `joints` (J),
//! `closed` and `open` (N x J); `object` and `gripper_link`. Only `transforms` has to be there when reading.

use super::archive::{Array, read as read_archive, write as write_archive};
use super::{FileGrasp, FormatError, GraspFile, pose_of_rows, rows_of_pose};

pub(super) fn read(bytes: &[u8]) -> Result<GraspFile, FormatError> {
    let wrong = |reason: String| FormatError { format: "npz", reason };
    let arrays = read_archive(bytes).map_err(wrong)?;
    let numbers = |name: &str| {
        arrays.iter().find_map(|(known, array)| match array {
            Array::Numbers { shape, values } if known == name => Some((shape.as_slice(), values.as_slice())),
            _ => None,
        })
    };
    let texts = |name: &str| {
        arrays.iter().find_map(|(known, array)| match array {
            Array::Texts(texts) if known == name => Some(texts.clone()),
            _ => None,
        })
    };
    let (shape, transforms) = numbers("transforms").ok_or_else(|| wrong("it has no transforms".into()))?;
    let &[count, 4, 4] = shape else {
        return Err(wrong(format!("transforms have the shape {shape:?}, not N x 4 x 4")));
    };
    let joints = texts("joints").unwrap_or_default();
    let rows = |name: &str| match numbers(name) {
        None => Ok(vec![Vec::new(); count]),
        Some((shape, _)) if *shape != [count, joints.len()] => {
            Err(wrong(format!("{name} has the shape {shape:?}, not {count} x {}", joints.len())))
        }
        Some((_, values)) if !values.iter().all(|x| x.is_finite()) => {
            Err(wrong(format!("{name} holds a number that is not finite")))
        }
        Some((_, values)) => {
            Ok((0..count).map(|i| values[i * joints.len()..(i + 1) * joints.len()].to_vec()).collect())
        }
    };
    let (closed, open): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (rows("closed")?, rows("open")?);
    let confidence = match numbers("confidence") {
        None => vec![1.0; count],
        Some((shape, values)) if *shape == [count] && values.iter().all(|x| x.is_finite()) => values.to_vec(),
        Some(_) => return Err(wrong(format!("confidence is not {count} numbers"))),
    };
    let mut grasps = Vec::with_capacity(count);
    for (i, (closed, open)) in closed.into_iter().zip(open).enumerate() {
        let rows = std::array::from_fn(|r| std::array::from_fn(|c| transforms[16 * i + 4 * r + c]));
        let object_from_gripper =
            pose_of_rows(&rows).ok_or_else(|| wrong(format!("transform {i} is not a rigid motion")))?;
        grasps.push(FileGrasp { object_from_gripper, closed, open, confidence: confidence[i] });
    }
    let first = |name: &str| texts(name).and_then(|all| all.into_iter().next()).unwrap_or_default();
    Ok(GraspFile { object: first("object"), gripper_link: first("gripper_link"), joints, grasps })
}

pub(super) fn write(file: &GraspFile) -> Vec<u8> {
    let (count, joints) = (file.grasps.len(), file.joints.len());
    let numbers = |shape: &[usize], values: Vec<f64>| Array::Numbers { shape: shape.to_vec(), values };
    let transforms =
        file.grasps.iter().flat_map(|g| rows_of_pose(&g.object_from_gripper).into_iter().flatten());
    let confidence = file.grasps.iter().map(|g| g.confidence).collect();
    let mut arrays = vec![
        ("transforms", numbers(&[count, 4, 4], transforms.collect())),
        ("confidence", numbers(&[count], confidence)),
        ("joints", Array::Texts(file.joints.clone())),
        ("object", Array::Texts(vec![file.object.clone()])),
        ("gripper_link", Array::Texts(vec![file.gripper_link.clone()])),
    ];
    // Formats without joint values give none for any grasp.
    if file.grasps.iter().all(|g| g.closed.len() == joints) {
        arrays.push((
            "closed",
            numbers(&[count, joints], file.grasps.iter().flat_map(|g| g.closed.clone()).collect()),
        ));
    }
    if file.grasps.iter().all(|g| g.open.len() == joints) {
        arrays.push((
            "open",
            numbers(&[count, joints], file.grasps.iter().flat_map(|g| g.open.clone()).collect()),
        ));
    }
    write_archive(&arrays)
}
