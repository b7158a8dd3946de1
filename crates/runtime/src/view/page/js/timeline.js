// Where everything is at a time.

import { between, compose } from './math.js';

/** `parent_from_node` at a time. */
function sample(node, time) {
  const { times, poses } = node;
  if (!times) return node.pose;
  const at = (i) => Array.from(poses.subarray(7 * i, 7 * i + 7));
  const last = times.length - 1;
  if (time <= times[0]) return at(0);
  if (time >= times[last]) return at(last);
  let low = 0;
  let high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return between(at(low), at(high), (time - times[low]) / (times[high] - times[low]));
}

/** `world_from_node` of all nodes at a time; a parent comes before its children. */
export function worldPoses(nodes, time) {
  const world = [];
  for (const node of nodes) {
    const pose = sample(node, time);
    world.push(node.parent === null ? pose : compose(world[node.parent], pose));
  }
  return world;
}

/** Time that runs, stops, and starts again at the end. */
export class Clock {
  constructor(duration) {
    this.duration = duration;
    this.time = 0;
    this.playing = false;
    this.looping = true;
    this.speed = 1;
    this.pause = 0;
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.pause = 0;
  }

  toggle(playing = !this.playing) {
    if (playing && this.time >= this.duration) this.time = 0;
    this.playing = playing && this.duration > 0;
  }

  /** Lets `seconds` of the wall clock pass. A loop rests for a moment before it starts again. */
  advance(seconds) {
    if (!this.playing) return;
    this.time += seconds * this.speed;
    if (this.time < this.duration) return;
    this.time = this.duration;
    if (!this.looping) {
      this.playing = false;
      return;
    }
    this.pause += seconds;
    if (this.pause > 1.2) this.seek(0);
  }
}
