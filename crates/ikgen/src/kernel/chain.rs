//! Forward kinematics of the true chain, and the check and polish that every solution passes.

use super::math::{cos_sin, sqrt};

/// Most joints of a chain.
pub const MAX_JOINTS: usize = 14;

/// A solution is returned only when position (metres) and rotation (Frobenius norm) agree with the pose to this.
pub const TOLERANCE: f64 = 1e-9;

/// A solution that agrees to this is not polished: near singular poses what is missing shows magnified in the joints.
pub const EXACT: f64 = 1e-13;

/// Newton steps within which a polish must halve the distance that is left.
const PATIENCE: usize = 20;

/// The same for candidates that start this near: they lack digits alone. Where one root after the other of an unknown that is nearly
/// free is tried, most of them miss by about this, and lead nowhere.
const NEAR: (f64, usize) = (1e-7, 4);

/// A rigid transform: rotation rows, then position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Position in metres.
    pub position: [f64; 3],
}

/// A moving joint whose axis is the z axis of its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Pose of the joint frame in the frame after the previous joint.
    pub previous_from_joint: Frame,
    /// Whether it slides along its axis instead of turning about it.
    pub slides: bool,
    /// Which variable moves it.
    pub variable: usize,
    /// Joint value for each unit of the variable: 1 unless the joint follows another.
    pub ratio: f64,
}

impl Frame {
    /// The product of two transforms.
    pub fn times(&self, other: &Frame) -> Frame {
        let (a, b) = (&self.rotation, &other.rotation);
        let mut out = *self;
        for i in 0..3 {
            for j in 0..3 {
                out.rotation[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
            }
            let p = &other.position;
            out.position[i] += a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2];
        }
        out
    }

    /// This frame after its joint has moved; `step` is `[cos, sin]`, or `[length, _]` for a sliding joint.
    fn moved(&self, slides: bool, step: [f64; 2]) -> Frame {
        let mut out = *self;
        for i in 0..3 {
            let row = &mut out.rotation[i];
            if slides {
                out.position[i] += step[0] * row[2];
            } else {
                let [x, y, z] = *row;
                *row = [step[0] * x + step[1] * y, step[0] * y - step[1] * x, z];
            }
        }
        out
    }

    /// Distance of two poses: the larger of metres and Frobenius norm of the rotation difference.
    pub fn distance(&self, other: &Frame) -> f64 {
        let (mut rotation, mut position) = (0.0, 0.0);
        for i in 0..3 {
            for j in 0..3 {
                let d = self.rotation[i][j] - other.rotation[i][j];
                rotation += d * d;
            }
            let d = self.position[i] - other.position[i];
            position += d * d;
        }
        // A NaN must not pass as the smaller of the two.
        sqrt(if rotation > position { rotation } else { position }) + 0.0 * (rotation + position)
    }
}

/// `base_from_tip` where each joint has moved by its `[cos, sin]` or `[length, _]`.
pub fn forward(links: &[Link], last_from_tip: &Frame, steps: &[[f64; 2]]) -> Frame {
    let mut at = links[0].previous_from_joint.moved(links[0].slides, steps[0]);
    for (link, step) in links.iter().zip(steps).skip(1) {
        at = at.times(&link.previous_from_joint).moved(link.slides, *step);
    }
    at.times(last_from_tip)
}

/// Brings `values` onto the pose by Newton steps on the true chain; the variables marked in `held` stay.
///
/// The steps are damped by the square of the distance that is left (Yamashita and Fukushima, "On the rate of convergence of the
/// Levenberg-Marquardt method", 2001). Where the ideal chain could move and keep the pose, the true one nearly can: a solution may lie
/// far along that way, and what a long step spoils has to be mended before the next one.
///
/// Returns the distance that is left, the smallest met. Steps may go uphill: where two solutions fall together Newton's method
/// halves its distance to them from far out, but may first have to get there. They end when they lead nowhere: the
/// distance has not fallen to a half within [`PATIENCE`] of them.
pub fn polish(
    links: &[Link],
    last_from_tip: &Frame,
    base_from_tip: &Frame,
    values: &mut [f64],
    held: &[bool],
) -> f64 {
    // Below this a direction in which the tip hardly moves is one in which it does not.
    const LEAST_DAMPING: f64 = 1e-22;
    let n = values.len();
    let mut at = [0.0; MAX_JOINTS];
    at[..n].copy_from_slice(values);
    let mut best = f64::INFINITY;
    let (mut halved, mut since, mut patience) = (f64::INFINITY, 0, PATIENCE);
    for step in 0..50 {
        let (distance, error, columns) = linearise(links, last_from_tip, base_from_tip, &at[..n]);
        if step == 0 && distance < NEAR.0 {
            patience = NEAR.1;
        }
        if distance < best {
            let converged = distance < EXACT && distance > 0.1 * best;
            best = distance;
            values.copy_from_slice(&at[..n]);
            if best < 0.1 * EXACT || converged {
                break;
            }
        } else if best < EXACT || !(distance < f64::INFINITY) {
            break;
        }
        since += 1;
        if best <= 0.5 * halved {
            (halved, since) = (best, 0);
        } else if since >= patience {
            break;
        }
        let step = damped(&columns, &error, LEAST_DAMPING + 0.25 * distance * distance, held, n);
        let mut longest = 0.0f64;
        for i in 0..n {
            longest = longest.max(step[i].abs());
        }
        let scale = if longest > 0.3 { 0.3 / longest } else { 1.0 };
        for i in 0..n {
            at[i] += scale * step[i];
        }
    }
    best
}

/// Distance to the pose, its six-vector (metres, radians), and the column of each variable.
pub fn linearise(
    links: &[Link],
    last_from_tip: &Frame,
    base_from_tip: &Frame,
    values: &[f64],
) -> (f64, [f64; 6], [[f64; 6]; MAX_JOINTS]) {
    let mut at = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
    let mut axes = [([0.0; 3], [0.0; 3]); MAX_JOINTS];
    for (link, axis) in links.iter().zip(&mut axes) {
        at = at.times(&link.previous_from_joint);
        *axis = (at.rotation.map(|row| row[2]), at.position);
        let value = link.ratio * values[link.variable];
        at = at.moved(link.slides, if link.slides { [value, 0.0] } else { cos_sin(value) });
    }
    at = at.times(last_from_tip);
    let mut error = [0.0; 6];
    for i in 0..3 {
        error[i] = base_from_tip.position[i] - at.position[i];
    }
    for column in 0..3 {
        let a = at.rotation.map(|row| row[column]);
        let b = base_from_tip.rotation.map(|row| row[column]);
        let turn = cross(a, b);
        for i in 0..3 {
            error[3 + i] += 0.5 * turn[i];
        }
    }
    let mut columns = [[0.0; 6]; MAX_JOINTS];
    for (link, (z, p)) in links.iter().zip(&axes) {
        let column = &mut columns[link.variable];
        let arm = [at.position[0] - p[0], at.position[1] - p[1], at.position[2] - p[2]];
        let linear = if link.slides { *z } else { cross(*z, arm) };
        for i in 0..3 {
            column[i] += link.ratio * linear[i];
            if !link.slides {
                column[3 + i] += link.ratio * z[i];
            }
        }
    }
    (at.distance(base_from_tip), error, columns)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The step `x` of the variables that makes `|columns x - error|^2 + damping |x|^2` least; held ones stay.
///
/// By reflections of the columns with the damping below them: where axes nearly line up the products of the normal equations would lose
/// the digits that tell which way to go.
fn damped(
    columns: &[[f64; 6]; MAX_JOINTS],
    error: &[f64; 6],
    damping: f64,
    held: &[bool],
    n: usize,
) -> [f64; MAX_JOINTS] {
    const ROWS: usize = 6 + MAX_JOINTS;
    let root = sqrt(damping);
    let mut m = [[0.0; ROWS]; MAX_JOINTS];
    let mut right = [0.0; ROWS];
    right[..6].copy_from_slice(error);
    for i in 0..n {
        if held[i] {
            m[i][6 + i] = 1.0;
        } else {
            m[i][..6].copy_from_slice(&columns[i]);
            m[i][6 + i] = root;
        }
    }
    let mut diagonal = [0.0; MAX_JOINTS];
    for k in 0..n {
        // Rows of the damping of later variables are still empty.
        let end = 7 + k;
        let mut mirror = m[k];
        let mut square = 0.0;
        for x in &mirror[k..end] {
            square += x * x;
        }
        let length = if mirror[k] < 0.0 { -sqrt(square) } else { sqrt(square) };
        diagonal[k] = -length;
        let factor = 1.0 / (square + mirror[k].abs() * length.abs());
        mirror[k] += length;
        let reflect = |column: &mut [f64; ROWS]| {
            let mut sum = 0.0;
            for r in k..end {
                sum += mirror[r] * column[r];
            }
            for r in k..end {
                column[r] -= factor * sum * mirror[r];
            }
        };
        for column in &mut m[k + 1..n] {
            reflect(column);
        }
        reflect(&mut right);
    }
    let mut step = [0.0; MAX_JOINTS];
    for i in (0..n).rev() {
        let mut sum = right[i];
        for j in i + 1..n {
            sum -= m[j][i] * step[j];
        }
        step[i] = if held[i] { 0.0 } else { sum / diagonal[i] };
    }
    step
}
