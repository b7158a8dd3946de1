//! Lofts: smooth bodies through oval sections at right angles to z.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Point3;
use robotc_core::model::TriMesh;

use super::{Ring, circle, skin};

/// Steps of a rounded end.
const END_STEPS: usize = 3;

/// An oval at a height: |x/a|^power + |y/b|^power = 1 about a centre. Power 2 is an ellipse, 4 nearly a rectangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    pub z: f64,
    pub centre: [f64; 2],
    pub half: [f64; 2],
    pub power: f64,
}

impl Section {
    /// A circle about the z axis moved to `centre`.
    pub(crate) fn circle(z: f64, centre: [f64; 2], radius: f64) -> Self {
        Self { z, centre, half: [radius; 2], power: 2.0 }
    }

    /// An oval.
    pub(crate) fn oval(z: f64, centre: [f64; 2], half: [f64; 2], power: f64) -> Self {
        Self { z, centre, half, power }
    }

    fn numbers(&self) -> [f64; 5] {
        [self.centre[0], self.centre[1], self.half[0], self.half[1], self.power]
    }

    fn ring(&self, inset: f64, around: usize) -> Ring {
        let bend = |v: f64| v.signum() * libm::pow(v.abs(), 2.0 / self.power);
        let half = self.half.map(|h| (h - inset).max(0.0));
        circle(around)
            .map(|[c, s]| {
                Point3::new(self.centre[0] + half[0] * bend(c), self.centre[1] + half[1] * bend(s), self.z)
            })
            .collect()
    }
}

/// A body through sections of growing z.
#[derive(Debug, Clone)]
pub(crate) struct Loft {
    /// At least two, of growing z.
    pub sections: Vec<Section>,
    /// Radii that the lower and the upper end are rounded with.
    pub ends: [f64; 2],
    /// Points of a ring.
    pub around: usize,
    /// Rings between two sections.
    pub steps: usize,
}

impl Loft {
    /// A loft with 24 points round and 3 rings per section.
    pub(crate) fn new(sections: impl Into<Vec<Section>>, ends: [f64; 2]) -> Self {
        Self { sections: sections.into(), ends, around: 24, steps: 3 }
    }

    /// The closed surface.
    pub(crate) fn mesh(&self) -> TriMesh {
        let (first, last) = (self.sections[0].z, self.sections[self.sections.len() - 1].z);
        let mut rings = Vec::new();
        for step in 0..END_STEPS {
            let angle = FRAC_PI_2 * step as f64 / END_STEPS as f64;
            let (inset, rise) =
                (self.ends[0] * (1.0 - libm::sin(angle)), self.ends[0] * (1.0 - libm::cos(angle)));
            if self.ends[0] > 0.0 {
                rings.push(self.section(first + rise).ring(inset, self.around));
            }
        }
        let (low, high) = (first + self.ends[0], last - self.ends[1]);
        rings.push(self.section(low).ring(0.0, self.around));
        for pair in self.sections.windows(2) {
            for step in 1..=self.steps {
                let z = pair[0].z + (pair[1].z - pair[0].z) * step as f64 / self.steps as f64;
                if z > low + 1e-4 && z < high - 1e-4 {
                    rings.push(self.section(z).ring(0.0, self.around));
                }
            }
        }
        rings.push(self.section(high).ring(0.0, self.around));
        for step in (0..END_STEPS).rev() {
            let angle = FRAC_PI_2 * step as f64 / END_STEPS as f64;
            let (inset, drop) =
                (self.ends[1] * (1.0 - libm::sin(angle)), self.ends[1] * (1.0 - libm::cos(angle)));
            if self.ends[1] > 0.0 {
                rings.push(self.section(last - drop).ring(inset, self.around));
            }
        }
        skin(&rings)
    }

    /// The section at a height, by a cubic that does not overshoot between sections.
    fn section(&self, z: f64) -> Section {
        let s = &self.sections;
        let i = s.windows(2).position(|pair| z <= pair[1].z).unwrap_or(s.len() - 2);
        let width = s[i + 1].z - s[i].z;
        let t = ((z - s[i].z) / width).clamp(0.0, 1.0);
        let (t2, t3) = (t * t, t * t * t);
        let v: [f64; 5] = std::array::from_fn(|k| {
            let (p, q) = (s[i].numbers()[k], s[i + 1].numbers()[k]);
            let (from, to) = (self.slope(i, k) * width, self.slope(i + 1, k) * width);
            p * (2.0 * t3 - 3.0 * t2 + 1.0)
                + from * (t3 - 2.0 * t2 + t)
                + q * (3.0 * t2 - 2.0 * t3)
                + to * (t3 - t2)
        });
        Section { z, centre: [v[0], v[1]], half: [v[2], v[3]], power: v[4] }
    }

    /// Slope of a number at a section: harmonic mean of its neighbours, zero at a turning point and at the ends.
    fn slope(&self, i: usize, k: usize) -> f64 {
        let s = &self.sections;
        if i == 0 || i + 1 == s.len() {
            return 0.0;
        }
        let rise = |a: &Section, b: &Section| (b.numbers()[k] - a.numbers()[k]) / (b.z - a.z);
        let (before, after) = (rise(&s[i - 1], &s[i]), rise(&s[i], &s[i + 1]));
        if before * after <= 0.0 { 0.0 } else { 2.0 * before * after / (before + after) }
    }
}

/// A box centred at the origin: `corner` rounds its four edges along z, `edge` the others (`edge <= corner`).
pub(crate) fn rounded_box(size: [f64; 3], corner: f64, edge: f64) -> TriMesh {
    let [a, b, c] = size.map(|s| s / 2.0);
    let mut rings = Vec::new();
    for (sign, steps) in [(-1.0, [0, 1, 2]), (1.0, [2, 1, 0])] {
        for step in steps {
            let angle = FRAC_PI_2 * f64::from(step) / 2.0;
            let (inset, drop) = (edge * (1.0 - libm::sin(angle)), edge * (1.0 - libm::cos(angle)));
            rings.push(rounded_rectangle([a - inset, b - inset], corner - inset, sign * (c - drop)));
        }
    }
    skin(&rings)
}

fn rounded_rectangle(half: [f64; 2], radius: f64, z: f64) -> Ring {
    let steps = 3;
    let mut ring = Ring::new();
    for (quarter, [x, y]) in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].into_iter().enumerate() {
        for step in 0..=steps {
            let angle = FRAC_PI_2 * (quarter as f64 + f64::from(step) / f64::from(steps));
            ring.push(Point3::new(
                x * (half[0] - radius) + radius * libm::cos(angle),
                y * (half[1] - radius) + radius * libm::sin(angle),
                z,
            ));
        }
    }
    ring
}
