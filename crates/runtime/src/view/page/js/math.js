// Vectors are arrays of 3. A pose is an array of 7: translation, then quaternion x y z w.
// Matrices are column-major arrays of 16, as WebGL takes them.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const normalize = (a) => scale(a, 1 / (length(a) || 1));
export const mix = (a, b, s) => a + (b - a) * s;
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

/** Turns vector `v` by quaternion `q`. */
export function rotate([x, y, z, w], v) {
  const u = [x, y, z];
  const t = scale(cross(u, v), 2);
  return add(add(v, scale(t, w)), cross(u, t));
}

/** `a_from_c = a_from_b * b_from_c`. */
export function compose(ab, bc) {
  const q = ab.slice(3);
  const [ax, ay, az, aw] = q;
  const [bx, by, bz, bw] = bc.slice(3);
  return [
    ...add(ab, rotate(q, bc)),
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/** `a_from_b * p_in_b`. */
export const transform = (ab, p) => add(rotate(ab.slice(3), p), ab);

/** `b_from_a` of `a_from_b`. */
export function inverse(ab) {
  const q = [-ab[3], -ab[4], -ab[5], ab[6]];
  return [...scale(rotate(q, ab), -1), ...q];
}

/** Pose `s` of the way from `a` to `b`; their quaternions are on the same side. */
export function between(a, b, s) {
  const pose = a.map((x, i) => mix(x, b[i], s));
  const norm = Math.hypot(pose[3], pose[4], pose[5], pose[6]) || 1;
  for (let i = 3; i < 7; i++) pose[i] /= norm;
  return pose;
}

/** Matrix of a pose. */
export function matrixOf([tx, ty, tz, x, y, z, w]) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    tx, ty, tz, 1,
  ];
}

export function multiply(a, b) {
  const out = new Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** Looking from `eye` to `target`, z up: x right, y up, z back. */
export function lookAt(eye, target, up = [0, 0, 1]) {
  const back = normalize(sub(eye, target));
  const right = normalize(cross(up, back));
  const above = cross(back, right);
  return [
    right[0], above[0], back[0], 0,
    right[1], above[1], back[1], 0,
    right[2], above[2], back[2], 0,
    -dot(right, eye), -dot(above, eye), -dot(back, eye), 1,
  ];
}

/** A perspective whose axis meets the picture at `middle`, each coordinate in -1..1. */
export function perspective(fovY, aspect, near, far, middle) {
  const f = 1 / Math.tan(fovY / 2);
  const depth = near - far;
  const [x, y] = middle;
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, -x, -y, (far + near) / depth, -1, 0, 0, (2 * far * near) / depth, 0];
}

/** The inverse of a perspective. */
export const unproject = (m) =>
  [1 / m[0], 0, 0, 0, 0, 1 / m[5], 0, 0, 0, 0, 0, 1 / m[14], m[8] / m[0], m[9] / m[5], -1, m[10] / m[14]];

export function orthographic(halfWidth, near, far) {
  const depth = near - far;
  return [1 / halfWidth, 0, 0, 0, 0, 1 / halfWidth, 0, 0, 0, 0, 2 / depth, 0, 0, 0, (far + near) / depth, 1];
}

/** Homogeneous clip coordinates of a point. */
export const project = (m, p) =>
  [0, 1, 2, 3].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);

/** Linear light of an sRGB component. */
export const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
