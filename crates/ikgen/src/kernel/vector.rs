//! Vectors, and turns about lines.

use super::math::sqrt;

/// Three coordinates.
pub type Vector = [f64; 3];

/// Inner product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Sum.
pub fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Difference.
pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Multiple.
pub fn times(a: Vector, x: f64) -> Vector {
    [a[0] * x, a[1] * x, a[2] * x]
}

/// `(x, y)` at length one; nothing for lengths that are not above `least`.
pub fn unit(x: f64, y: f64, least: f64) -> Option<[f64; 2]> {
    let n = sqrt(x * x + y * y);
    if n > least && n < f64::INFINITY { Some([x / n, y / n]) } else { None }
}

/// The opposite of a turn given by cosine and sine.
pub fn back(turn: [f64; 2]) -> [f64; 2] {
    [turn[0], -turn[1]]
}

/// A line about which things turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Unit direction.
    pub direction: Vector,
    /// A point on it.
    pub point: Vector,
}

impl Line {
    /// A vector turned by `[cos, sin]`.
    pub fn turned(&self, v: Vector, turn: [f64; 2]) -> Vector {
        let along = times(self.direction, dot(self.direction, v));
        let across = cross(self.direction, v);
        plus(along, plus(times(minus(v, along), turn[0]), times(across, turn[1])))
    }

    /// A point turned by `[cos, sin]`.
    pub fn carried(&self, p: Vector, turn: [f64; 2]) -> Vector {
        plus(self.point, self.turned(minus(p, self.point), turn))
    }

    /// The motion of turning by `[cos, sin]`.
    pub fn motion(&self, turn: [f64; 2]) -> Motion {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| self.turned(e, turn));
        let row = |i: usize| [x[i], y[i], z[i]];
        Motion { rows: [row(0), row(1), row(2)], place: self.carried([0.0; 3], turn) }
    }

    /// A line turned by `[cos, sin]`.
    pub fn moved(&self, line: &Line, turn: [f64; 2]) -> Line {
        Line { direction: self.turned(line.direction, turn), point: self.carried(line.point, turn) }
    }
}

/// A rigid motion: rows of its rotation, and where it takes the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Rotation matrix, row by row.
    pub rows: [Vector; 3],
    /// Image of the origin.
    pub place: Vector,
}

impl Motion {
    /// A vector after the motion.
    pub fn turned(&self, v: Vector) -> Vector {
        [dot(self.rows[0], v), dot(self.rows[1], v), dot(self.rows[2], v)]
    }

    /// A line after the motion.
    pub fn moved(&self, line: &Line) -> Line {
        Line { direction: self.turned(line.direction), point: plus(self.turned(line.point), self.place) }
    }

    /// This motion after another.
    pub fn after(&self, first: &Motion) -> Motion {
        let [a, b, c] = first.rows;
        let columns = [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]].map(|v| self.turned(v));
        let row = |i: usize| [columns[0][i], columns[1][i], columns[2][i]];
        Motion { rows: [row(0), row(1), row(2)], place: plus(self.turned(first.place), self.place) }
    }

    /// The motion back.
    pub fn inverse(&self) -> Motion {
        let [a, b, c] = self.rows;
        let rows = [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]];
        let place = Motion { rows, place: [0.0; 3] }.turned(self.place);
        Motion { rows, place: times(place, -1.0) }
    }
}
