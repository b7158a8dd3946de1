// Which part a ray meets first.

import { add, compose, cross, dot, inverse, rotate, scale, sub, transform } from './math.js';

/** Entry of a ray into a box, or Infinity. */
function enterBox(origin, direction, low, size) {
  let enter = 0;
  let leave = Infinity;
  for (let k = 0; k < 3; k++) {
    const a = (low[k] - origin[k]) / direction[k];
    const b = (low[k] + size[k] - origin[k]) / direction[k];
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave ? enter : Infinity;
}

/** Distance along a ray to the nearest triangle of a surface, or Infinity. */
function hitSurface(surface, origin, direction) {
  const { vertices, indices, low, size } = surface;
  const corner = (i) => [0, 1, 2].map((k) => low[k] + (vertices[5 * i + k] / 65535) * size[k]);
  let nearest = Infinity;
  for (let i = 0; i < indices.length; i += 3) {
    const a = corner(indices[i]);
    const ab = sub(corner(indices[i + 1]), a);
    const ac = sub(corner(indices[i + 2]), a);
    const p = cross(direction, ac);
    const determinant = dot(ab, p);
    if (Math.abs(determinant) < 1e-15) continue;
    const fromA = sub(origin, a);
    const u = dot(fromA, p) / determinant;
    const q = cross(fromA, ab);
    const v = dot(direction, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1) continue;
    const distance = dot(ac, q) / determinant;
    if (distance > 0 && distance < nearest) nearest = distance;
  }
  return nearest;
}

/** The node that a ray meets first, with the point in the world; undefined when it meets none. */
export function pick(scene, shown, world, origin, direction) {
  let best = { distance: Infinity };
  scene.nodes.forEach((node, index) => {
    if (!shown.has(node.group)) return;
    for (const part of node.parts) {
      const surface = scene.surfaces[part.surface];
      const partFromWorld = inverse(compose(world[index], part.pose));
      const from = transform(partFromWorld, origin);
      const along = rotate(partFromWorld.slice(3), direction);
      if (enterBox(from, along, surface.low, surface.size) >= best.distance) continue;
      const distance = hitSurface(surface, from, along);
      if (distance < best.distance) best = { distance, index };
    }
  });
  if (best.index === undefined) return undefined;
  return { index: best.index, point: add(origin, scale(direction, best.distance)) };
}
