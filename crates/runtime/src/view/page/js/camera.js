// A camera that goes round a target, z up. The same mathematics is in camera.rs, where tests use it.

import { add, clamp, cross, dot, length, lookAt, multiply, normalize, perspective, scale, sub } from './math.js';

const MARGIN = 1.06;
const NARROW = 900;
/** What controls take from the left, top and bottom of a wide and of a narrow picture, pixels. */
const TAKEN_WIDE = [268, 0, 92];
const TAKEN_NARROW = [0, 64, 122];
const STEEPEST = 1.55;

export class Camera {
  constructor({ azimuth, elevation, fov_y: fovY }, focus) {
    this.fovY = fovY;
    this.corners = focus.flatMap(({ low, high }) =>
      [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? high : low)[k])),
    );
    const least = [0, 1, 2].map((k) => Math.min(...this.corners.map((p) => p[k])));
    const most = [0, 1, 2].map((k) => Math.max(...this.corners.map((p) => p[k])));
    /** Diagonal of what is framed, metres. */
    this.span = length(sub(most, least));
    this.home = { azimuth, elevation, target: scale(add(least, most), 0.5) };
    this.resize(1280, 720);
  }

  /** Goes back to where everything can be seen. */
  frame() {
    this.wanted = { ...this.home, distance: 1 };
    this.wanted.distance = this.framingDistance();
    this.touched = false;
  }

  /** Jumps to where it was going. */
  settle() {
    this.now = { ...this.wanted };
  }

  /** Takes over the size of the picture, in pixels of the style sheet. */
  resize(width, height) {
    this.aspect = width / height;
    const [left, top, bottom] = width < NARROW ? TAKEN_NARROW : TAKEN_WIDE;
    /** Middle and share of the part of the picture that no control covers. */
    this.middle = [left / width, (bottom - top) / height];
    this.share = [1 - left / width, Math.max(1 - (top + bottom) / height, 0.2)];
    if (!this.touched) {
      this.frame();
      this.settle();
    }
  }

  /** The distance from which all corners are in the picture. */
  framingDistance() {
    const { target } = this.home;
    const [right, up, back] = this.axes(this.home);
    const tanY = Math.tan(this.fovY / 2) / MARGIN;
    const tanX = tanY * this.aspect;
    const needed = this.corners.map((corner) => {
      const p = sub(corner, target);
      const across = Math.abs(dot(p, right)) / (tanX * this.share[0]);
      return dot(p, back) + Math.max(across, Math.abs(dot(p, up)) / (tanY * this.share[1]));
    });
    return Math.max(...needed);
  }

  axes({ azimuth, elevation } = this.now) {
    const back = [
      Math.cos(elevation) * Math.cos(azimuth),
      Math.cos(elevation) * Math.sin(azimuth),
      Math.sin(elevation),
    ];
    const right = normalize(cross([0, 0, 1], back));
    return [right, cross(back, right), back];
  }

  get eye() {
    return add(this.now.target, scale(this.axes()[2], this.now.distance));
  }

  /** Distances of the nearest and the farthest thing that can be seen. */
  get range() {
    return [this.now.distance * 0.02, this.now.distance * 40];
  }

  get clipFromView() {
    return perspective(this.fovY, this.aspect, ...this.range, this.middle);
  }

  get clipFromWorld() {
    return multiply(this.clipFromView, lookAt(this.eye, this.now.target));
  }

  /** Direction in the world of the ray through a point of the picture, each coordinate in -1..1, y up. */
  ray(x, y) {
    const [right, up, back] = this.axes();
    const tan = Math.tan(this.fovY / 2);
    const across = scale(right, (x - this.middle[0]) * tan * this.aspect);
    return normalize(sub(add(across, scale(up, (y - this.middle[1]) * tan)), back));
  }

  orbit(dx, dy) {
    this.touched = true;
    this.wanted.azimuth -= dx;
    this.wanted.elevation = clamp(this.wanted.elevation + dy, -STEEPEST, STEEPEST);
  }

  /** Moves the target with the pointer; arguments in heights of the picture. */
  pan(dx, dy) {
    this.touched = true;
    const [right, up] = this.axes();
    const height = 2 * this.now.distance * Math.tan(this.fovY / 2);
    this.wanted.target = add(add(this.wanted.target, scale(right, -dx * height)), scale(up, dy * height));
  }

  zoom(factor) {
    this.touched = true;
    const reach = this.framingDistance();
    this.wanted.distance = clamp(this.wanted.distance * factor, reach * 0.02, reach * 8);
  }

  lookTo(target) {
    this.touched = true;
    this.wanted.target = target;
  }

  /** Eases towards where it is wanted; tells whether it still moves. */
  advance(seconds) {
    const s = 1 - Math.exp(-seconds * 16);
    let change = 0;
    for (const key of ['azimuth', 'elevation', 'distance']) {
      const step = (this.wanted[key] - this.now[key]) * s;
      this.now[key] += step;
      change += Math.abs(step);
    }
    const step = scale(sub(this.wanted.target, this.now.target), s);
    this.now.target = add(this.now.target, step);
    return change + Math.abs(step[0]) + Math.abs(step[1]) + Math.abs(step[2]) > 1e-5;
  }
}

/** Lets mouse and fingers drive the camera; `changed` is called after each move. */
export function control(canvas, camera, changed) {
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, width: Math.hypot(a.x - b.x, a.y - b.y) };
  };

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.classList.add('held');
  });
  canvas.addEventListener('pointermove', (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer) return;
    const height = canvas.clientHeight;
    const before = pointers.size > 1 ? spread() : { ...pointer };
    Object.assign(pointer, { x: event.clientX, y: event.clientY });
    if (pointers.size > 1) {
      const after = spread();
      camera.pan((after.x - before.x) / height, (after.y - before.y) / height);
      camera.zoom(before.width / Math.max(after.width, 1));
    } else {
      const [dx, dy] = [pointer.x - before.x, pointer.y - before.y];
      if (event.buttons & 6 || event.shiftKey) camera.pan(dx / height, dy / height);
      else camera.orbit((dx / height) * 4, (dy / height) * 4);
    }
    changed();
  });
  const release = (event) => {
    pointers.delete(event.pointerId);
    if (!pointers.size) canvas.classList.remove('held');
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === 1 ? 24 : 1);
      camera.zoom(Math.exp(clamp(pixels, -240, 240) * 0.0014));
      changed();
    },
    { passive: false },
  );
}
