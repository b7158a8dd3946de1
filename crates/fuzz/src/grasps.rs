//! Files of grasps that other programs write.

use robotc_kb::formats::{GraspFile, GraspFormat};

/// Any bytes as each of the formats: an error, or grasps that are written in every format and, but for rounding, read again.
pub(crate) fn grasps(bytes: &[u8]) {
    const FORMATS: [GraspFormat; 3] = [GraspFormat::IsaacGrasp, GraspFormat::Acronym, GraspFormat::Npz];
    for format in FORMATS {
        let Ok(file) = GraspFile::read(bytes, format) else { continue };
        // What a format cannot say is left out, so only the one that it came from has to give all grasps back.
        for other in FORMATS {
            let written = file.write(other);
            if other == format {
                let again = GraspFile::read(&written, format).expect("what was written is read");
                assert_eq!(again.grasps.len(), file.grasps.len());
            }
        }
    }
}
