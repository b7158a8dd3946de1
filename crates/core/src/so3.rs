//! A uniform grid over all rotations, with a direct lookup of the cell of a rotation.
//!
//! Hopf coordinates: a HEALPix pixel for where the z axis points, and equal steps of the turn about it
//! (Yershova, Jain, LaValle and Mitchell, "Generating uniform incremental grids on SO(3) using the Hopf fibration",
//! 2010; Gorski et al., "HEALPix", 2005, equations for the ring scheme). Level L has 72 x 8^L cells of equal volume:
//! 72, 576, 4608.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::OnceLock;

use nalgebra::{UnitQuaternion, Vector3};

/// The grid of one level.
#[derive(Debug, Clone, Copy)]
pub struct RotationGrid {
    sides: usize,
    /// For each direction, the frame whose z axis it is: w, x, y, z.
    frames: &'static [[f64; 4]],
}

/// Levels that a grid may have: the last one has 19 million cells.
pub const LEVELS: u32 = 7;

/// The frames of each level, once they were asked for.
static FRAMES: [OnceLock<Vec<[f64; 4]>>; LEVELS as usize] = [const { OnceLock::new() }; LEVELS as usize];

impl RotationGrid {
    /// The grid with 72 x 8^`level` cells. Panics from level [`LEVELS`] on.
    pub fn new(level: u32) -> Self {
        let sides = 1 << level;
        let frames = FRAMES[level as usize].get_or_init(|| {
            let grid = Self { sides, frames: &[] };
            let numbers = |pixel| {
                let frame = grid.direction_frame(pixel);
                [frame.w, frame.i, frame.j, frame.k]
            };
            (0..grid.directions()).map(numbers).collect()
        });
        Self { sides, frames }
    }

    /// Number of directions: HEALPix pixels.
    pub fn directions(&self) -> usize {
        12 * self.sides * self.sides
    }

    /// Number of turns about each direction.
    pub fn turns(&self) -> usize {
        6 * self.sides
    }

    /// Number of cells. Cell index = direction * turns + turn.
    pub fn len(&self) -> usize {
        self.directions() * self.turns()
    }

    /// A grid always has cells.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The rotation at the centre of a cell.
    pub fn rotation(&self, cell: usize) -> UnitQuaternion<f64> {
        let turn = (cell % self.turns()) as f64 + 0.5;
        let psi = turn * TAU / self.turns() as f64;
        self.direction_frame(cell / self.turns()) * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), psi)
    }

    /// The cell a rotation falls in: the pixel of its z axis, then the nearest turn.
    pub fn cell(&self, rotation: &UnitQuaternion<f64>) -> usize {
        let (w, x, y, z) = (rotation.w, rotation.i, rotation.j, rotation.k);
        let up = Vector3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
        let pixel = self.pixel(&up);
        // The turn about z nearest to what is left of the rotation has the same w and z, but for a factor.
        let [fw, fx, fy, fz] = self.frames[pixel];
        let left_w = fw * w + fx * x + fy * y + fz * z;
        let left_z = fw * z - fz * w - fx * y + fy * x;
        let turns = self.turns();
        // Both signs of a quaternion are one rotation: half turns of (w, z) are whole turns about z.
        let turn = (2.0 * turn_of(left_z, left_w) * turns as f64) as usize % turns;
        pixel * turns + turn
    }

    /// The frame whose z axis is the centre of a pixel.
    fn direction_frame(&self, pixel: usize) -> UnitQuaternion<f64> {
        let (z, phi) = self.pixel_centre(pixel);
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), phi)
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), libm::acos(z))
    }

    /// Height z and azimuth of the centre of a pixel, ring scheme.
    fn pixel_centre(&self, pixel: usize) -> (f64, f64) {
        let n = self.sides;
        let nf = n as f64;
        let cap = 2 * n * (n - 1);
        let total = self.directions();
        let polar = |p: usize| {
            let ring = ((1.0 + ((1 + 2 * p) as f64).sqrt()) / 2.0) as usize;
            let in_ring = p - 2 * ring * (ring - 1);
            let ring = ring as f64;
            (1.0 - ring * ring / (3.0 * nf * nf), (in_ring as f64 + 0.5) * FRAC_PI_2 / ring)
        };
        if pixel < cap {
            polar(pixel)
        } else if pixel < total - cap {
            let p = pixel - cap;
            let ring = p / (4 * n) + n;
            let in_ring = (p % (4 * n)) as f64;
            let shift = if (ring + n).is_multiple_of(2) { 0.5 } else { 0.0 };
            ((2.0 * nf - ring as f64) * 2.0 / (3.0 * nf), (in_ring + shift) * FRAC_PI_2 / nf)
        } else {
            let (z, phi) = polar(total - 1 - pixel);
            (-z, TAU - phi)
        }
    }

    /// The pixel a unit direction falls in, ring scheme.
    fn pixel(&self, direction: &Vector3<f64>) -> usize {
        let n = self.sides;
        let nf = n as f64;
        let z = direction.z.clamp(-1.0, 1.0);
        let quarter = (4.0 * turn_of(direction.y, direction.x)).min(4.0 - 1e-15);
        if z.abs() <= 2.0 / 3.0 {
            let rising = (nf * (0.5 + quarter - z * 0.75)) as usize;
            let falling = (nf * (0.5 + quarter + z * 0.75)) as usize;
            let ring = n + 1 + rising - falling;
            let shift = usize::from(ring.is_multiple_of(2));
            let in_ring = ((rising + falling + 1 + shift - n) / 2) % (4 * n);
            2 * n * (n - 1) + (ring - 1) * 4 * n + in_ring
        } else {
            let within = quarter - (quarter as usize) as f64;
            let reach = nf * (3.0 * (1.0 - z.abs())).sqrt();
            let (rising, falling) = ((within * reach) as usize, ((1.0 - within) * reach) as usize);
            let ring = rising + falling + 1;
            let in_ring = ((quarter * ring as f64) as usize) % (4 * ring);
            if z > 0.0 {
                2 * ring * (ring - 1) + in_ring
            } else {
                self.directions() - 2 * ring * (ring + 1) + in_ring
            }
        }
    }
}

/// The direction of (x, y) as a share of a whole turn counted from the x axis, 0 to 1, good to 1e-8; 0 for no direction.
///
/// Five times as fast as an arc tangent, with the same bits everywhere: for what only has to fall into one of many bins.
pub fn turn_of(y: f64, x: f64) -> f64 {
    /// atan(t) / (2 pi t) as a polynomial in t^2 for t up to 1, through its values at Chebyshev's nodes.
    const C: [f64; 8] = [
        0.1591549243110539,
        -0.05304922746356155,
        0.03177840673706189,
        -0.02228692852433096,
        0.015706787203546034,
        -0.009363046013328165,
        0.003784787083817939,
        -0.0007257134340003916,
    ];
    let (along, across) = (x.abs(), y.abs());
    let steep = across > along;
    let (low, high) = if steep { (along, across) } else { (across, along) };
    let t = if high > 0.0 { low / high } else { 0.0 };
    let s = t * t;
    let (s2, s4) = (s * s, s * s * (s * s));
    let tail = (C[4] + C[5] * s) + (C[6] + C[7] * s) * s2;
    let eighth = t * ((C[0] + C[1] * s) + (C[2] + C[3] * s) * s2 + tail * s4);
    let quarter = if steep { 0.25 - eighth } else { eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if y < 0.0 { 1.0 - half } else { half }
}

/// Angle of the rotation between two rotations, radians, 0 to pi.
pub fn angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let relative = (a.inverse() * b).into_inner();
    let angle = 2.0 * libm::atan2(relative.imag().norm(), relative.w.abs());
    angle.min(PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seed;

    #[test]
    fn centres_lie_in_their_own_cells() {
        for level in 0..3 {
            let grid = RotationGrid::new(level);
            assert_eq!(grid.len(), 72 * 8usize.pow(level));
            for cell in 0..grid.len() {
                assert_eq!(grid.cell(&grid.rotation(cell)), cell, "level {level}");
            }
        }
    }

    #[test]
    fn turns_are_those_of_the_arc_tangent() {
        for k in 0..100_000 {
            let angle = (f64::from(k) + 0.5) * TAU / 100_000.0;
            let (sine, cosine) = angle.sin_cos();
            assert!((turn_of(3.0 * sine, 3.0 * cosine) - angle / TAU).abs() < 2e-8, "{angle}");
        }
        assert_eq!(turn_of(0.0, 0.0), 0.0);
        for (y, x, turn) in [(0.0, 2.0, 0.0), (2.0, 0.0, 0.25), (0.0, -2.0, 0.5), (-2.0, 0.0, 0.75)] {
            assert!((turn_of(y, x) - turn).abs() < 1e-15);
        }
    }

    #[test]
    fn cells_are_small_and_equally_likely() {
        for (level, reach) in [(0, 1.1), (1, 0.56), (2, 0.29)] {
            let grid = RotationGrid::new(level);
            let mut rng = Seed::new(5).rng();
            let mut hits = vec![0u32; grid.len()];
            let draws = 40 * grid.len();
            for _ in 0..draws {
                let rotation = rng.rotation();
                let cell = grid.cell(&rotation);
                hits[cell] += 1;
                let distance = angle_between(&rotation, &grid.rotation(cell));
                assert!(distance < reach, "level {level}: {distance}");
            }
            let chi2: f64 = hits.iter().map(|&h| (f64::from(h) - 40.0).powi(2) / 40.0).sum();
            let freedom = grid.len() as f64 - 1.0;
            assert!(chi2 < freedom + 6.0 * (2.0 * freedom).sqrt(), "level {level}: chi2 {chi2} of {freedom}");
        }
    }
}
