//! Filling one convex part with cells, and covering the cells with balls.

use nalgebra::{Point3, Vector3};

use crate::geom::{ConvexPart, Plane};

/// Cells are halved until their half diagonal is this fraction of the overshoot, or of their depth when they are deep.
const CELL: f64 = 0.33;

/// Deep cells may be this fraction of their depth: large balls cover them anyway.
const DEEP_CELL: f64 = 0.25;

/// Points of the medial region towards which balls are grown.
const AIMS: usize = 40;

/// Of the aims, how many are compared by what their balls cover.
const TRIED: usize = 6;

/// Most faces that a part is known by: they leave about a hundredth of the radius of a ball.
const FACES: usize = 128;

/// Cells that fill a part.
pub(super) struct Net<'a> {
    part: &'a ConvexPart,
    /// Some of its faces: what is below them contains it.
    planes: Vec<Plane>,
    /// Largest distance that a ball may stand out of the part, metres.
    slack: f64,
    /// By x: a ball looks at those beside it only.
    cells: Vec<Cell>,
}

/// A cube, known by the ball around it.
#[derive(Clone, Copy)]
struct Cell {
    centre: Point3<f64>,
    radius: f64,
    /// Depth of the centre in the part; negative outside.
    depth: f64,
}

impl<'a> Net<'a> {
    /// Cells that contain all of the part; balls may stand out of it by `slack` metres.
    pub(super) fn of(part: &'a ConvexPart, slack: f64) -> Self {
        let bounds = part.bounds();
        let mut net = Self { part, planes: coarse(part.planes()), slack, cells: Vec::new() };
        // Cubes about as wide as the thinnest side, so that flat parts are not filled with needles.
        let size = bounds.size();
        let width = size.min().max(2.0 * slack);
        let count = size.map(|s| (s / width).ceil().max(1.0));
        let half = size.component_div(&count) * 0.5;
        for i in 0..count.x as usize {
            for j in 0..count.y as usize {
                for k in 0..count.z as usize {
                    let at = Vector3::new(2 * i + 1, 2 * j + 1, 2 * k + 1).map(|n| n as f64);
                    net.split(bounds.low + half.component_mul(&at), half);
                }
            }
        }
        net.cells.sort_by(|a, b| a.centre.x.total_cmp(&b.centre.x));
        net
    }

    /// Positions of cells whose middles are not beside a ball along x.
    fn beside(&self, ball: &(Point3<f64>, f64)) -> std::ops::Range<usize> {
        let first = self.cells.partition_point(|cell| cell.centre.x < ball.0.x - ball.1);
        let rest = &self.cells[first..];
        first..first + rest.partition_point(|cell| cell.centre.x <= ball.0.x + ball.1)
    }

    /// Largest height of a point over the faces.
    fn height(&self, point: &Point3<f64>) -> f64 {
        self.planes.iter().map(|plane| plane.height(point)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn split(&mut self, centre: Point3<f64>, half: Vector3<f64>) {
        let radius = half.norm();
        let depth = -self.height(&centre);
        if depth < -radius {
            return; // Beyond a face with all that is in it.
        }
        if radius <= CELL * self.slack || radius <= DEEP_CELL * depth {
            self.cells.push(Cell { centre, radius, depth });
            return;
        }
        // Halved along the sides that are long: a cell becomes a cube.
        let longest = half.max();
        let parts = half.map(|h| if h > 0.6 * longest { 2_usize } else { 1 });
        let small = half.zip_map(&parts, |h, n| h / n as f64);
        for i in 0..parts.x {
            for j in 0..parts.y {
                for k in 0..parts.z {
                    let side =
                        |n: usize, i: usize, h: f64| if n == 1 { 0.0 } else { h * (2.0 * i as f64 - 1.0) };
                    let shift = Vector3::new(
                        side(parts.x, i, small.x),
                        side(parts.y, j, small.y),
                        side(parts.z, k, small.z),
                    );
                    self.split(centre + shift, small);
                }
            }
        }
    }

    /// Balls that cover all cells.
    pub(super) fn balls(&self) -> Vec<(Point3<f64>, f64)> {
        let aims = self.aims();
        let middle = self.part.bounding_sphere().0;
        // From the outside in: corners and edges leave the least choice.
        let mut order: Vec<usize> = (0..self.cells.len()).collect();
        let far = |i: &usize| (self.cells[*i].centre - middle).norm_squared();
        order.sort_by(|a, b| far(b).total_cmp(&far(a)).then(a.cmp(b)));
        let mut covered = vec![0_u32; self.cells.len()];
        let mut balls: Vec<(Point3<f64>, f64)> = Vec::new();
        for cell in order {
            if covered[cell] == 0 {
                let ball = self.best_ball(&self.cells[cell], &aims, &covered);
                self.count(&ball, &mut covered, |n| n + 1);
                balls.push(ball);
            }
        }
        // What later balls have made superfluous goes, the smallest first.
        let mut order: Vec<usize> = (0..balls.len()).collect();
        order.sort_by(|&a, &b| balls[a].1.total_cmp(&balls[b].1).then(a.cmp(&b)));
        let mut kept = vec![true; balls.len()];
        for ball in order {
            let beside = self.beside(&balls[ball]);
            let mut cells = self.cells[beside.clone()].iter().zip(&covered[beside]);
            let needed = cells.any(|(cell, &n)| n == 1 && holds(&balls[ball], cell));
            if !needed {
                self.count(&balls[ball], &mut covered, |n| n - 1);
                kept[ball] = false;
            }
        }
        let balls = balls.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(ball, _)| ball);
        balls.collect()
    }

    fn count(&self, ball: &(Point3<f64>, f64), covered: &mut [u32], change: impl Fn(u32) -> u32) {
        let beside = self.beside(ball);
        for (cell, n) in self.cells[beside.clone()].iter().zip(&mut covered[beside]) {
            if holds(ball, cell) {
                *n = change(*n);
            }
        }
    }

    /// Deep points, far from each other.
    fn aims(&self) -> Vec<Point3<f64>> {
        let deepest = self.cells.iter().map(|c| c.depth).fold(0.0, f64::max);
        // Every cell climbs away from the nearest face for a while; what it reaches is deep where it is.
        let candidates: Vec<Point3<f64>> = self
            .cells
            .iter()
            .filter(|cell| cell.depth > 0.25 * deepest)
            .step_by(1 + self.cells.len() / 2000)
            .map(|cell| self.climb(cell.centre))
            .collect();
        let Some(&first) = candidates.first() else { return vec![] };
        let mut aims = vec![first];
        let mut nearest: Vec<f64> = candidates.iter().map(|c| (c - first).norm_squared()).collect();
        while aims.len() < AIMS {
            let mut best = 0;
            for (i, d) in nearest.iter().enumerate() {
                if *d > nearest[best] {
                    best = i;
                }
            }
            if nearest[best] < self.slack * self.slack {
                break;
            }
            let next = candidates[best];
            aims.push(next);
            for (d, c) in nearest.iter_mut().zip(&candidates) {
                *d = d.min((c - next).norm_squared());
            }
        }
        aims
    }

    fn climb(&self, mut point: Point3<f64>) -> Point3<f64> {
        const STEPS: usize = 6;
        for step in 0..STEPS {
            let mut nearest = (f64::NEG_INFINITY, Vector3::zeros());
            for plane in &self.planes {
                let height = plane.height(&point);
                if height > nearest.0 {
                    nearest = (height, plane.normal.into_inner());
                }
            }
            let length = 0.5 * self.slack.max(-nearest.0) * (1.0 - step as f64 / STEPS as f64);
            let next = point - nearest.1 * length;
            if self.height(&next) < nearest.0 {
                point = next;
            }
        }
        point
    }

    /// A ball that covers the cell and as much as possible of what is not covered yet.
    fn best_ball(&self, cell: &Cell, aims: &[Point3<f64>], covered: &[u32]) -> (Point3<f64>, f64) {
        // In place of a better one: the ball around the cell itself.
        let own = (cell.centre, (cell.depth + self.slack).max(cell.radius));
        let mut balls: Vec<(Point3<f64>, f64)> = aims.iter().map(|aim| self.towards(cell, aim)).collect();
        balls.sort_by(|a, b| b.1.total_cmp(&a.1));
        balls.truncate(TRIED);
        balls.push(own);
        let gain = |ball: &(Point3<f64>, f64)| {
            let beside = self.beside(ball);
            let cells = self.cells[beside.clone()].iter().zip(&covered[beside]);
            cells.filter(|&(cell, &n)| n == 0 && holds(ball, cell)).count()
        };
        let mut best = (own, 0);
        for ball in balls {
            let gained = gain(&ball);
            if gained > best.1 {
                best = (ball, gained);
            }
        }
        best.0
    }

    /// The ball farthest on the way from the cell to the aim that still covers the cell.
    ///
    /// A ball about c covers the cell when |c - cell| + cell radius <= depth(c) + slack. On the way, the distance grows
    /// evenly and the height over each face changes evenly, so that each face gives one bound.
    fn towards(&self, cell: &Cell, aim: &Point3<f64>) -> (Point3<f64>, f64) {
        let way = aim - cell.centre;
        let length = way.norm();
        let mut share: f64 = 1.0;
        for plane in &self.planes {
            let height = plane.height(&cell.centre);
            // cell radius + s length <= -(height + s rise) + slack
            let (room, cost) = (self.slack - height - cell.radius, length + plane.normal.dot(&way));
            if cost > 0.0 {
                share = share.min((room / cost).max(0.0));
            }
        }
        // A hair less, for rounding.
        let centre = cell.centre + way * (share * (1.0 - 1e-9));
        (centre, (self.slack - self.height(&centre)).max(cell.radius))
    }
}

/// Faces that point in all directions, no more than are needed to follow a shape closely.
fn coarse(planes: &[Plane]) -> Vec<Plane> {
    let mut chosen: Vec<Plane> = planes.first().copied().into_iter().collect();
    let turned = |a: &Plane, b: &Plane| 1.0 - a.normal.dot(&b.normal);
    let mut nearest: Vec<f64> = planes.iter().map(|plane| turned(plane, &planes[0])).collect();
    while chosen.len() < planes.len().min(FACES) {
        let mut best = 0;
        for (i, away) in nearest.iter().enumerate() {
            if *away > nearest[best] {
                best = i;
            }
        }
        chosen.push(planes[best]);
        for (away, plane) in nearest.iter_mut().zip(planes) {
            *away = away.min(turned(plane, &planes[best]));
        }
    }
    chosen
}

/// Whether a ball contains the ball around a cell.
fn holds(ball: &(Point3<f64>, f64), cell: &Cell) -> bool {
    let room = ball.1 - cell.radius;
    room >= 0.0 && (cell.centre - ball.0).norm_squared() <= room * room
}
