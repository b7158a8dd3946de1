// The scene as the page carries it: a table of contents in JSON, and one block of binary data.

import { linear } from './math.js';

/** Colours of stages, in order of first appearance. */
const STAGE_COLOURS = [
  '#3b82c4', '#e2903b', '#3fa36c', '#8a6fc2', '#cf5b6b', '#2ba5a8', '#b8992e', '#7d8796',
];

function bytesOf(base64) {
  const text = atob(base64.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

/** Reads the scene out of the page. */
export function loadScene(document) {
  const scene = JSON.parse(document.getElementById('scene').textContent);
  const block = bytesOf(document.getElementById('data').textContent);
  const view = (Type, { offset, count }) => new Type(block, offset, count);

  for (const surface of scene.surfaces) {
    surface.vertices = view(Uint16Array, surface.vertices);
    surface.indices = view(surface.wide ? Uint32Array : Uint16Array, surface.indices);
  }
  for (const node of scene.nodes) {
    for (const part of node.parts) {
      part.linear = [...part.colour.slice(0, 3).map(linear), part.colour[3]];
    }
    for (const lines of node.lines) {
      lines.ends = view(Float32Array, lines.ends);
      lines.colours = view(Uint8Array, lines.colours);
    }
    if (node.track) {
      node.times = view(Float32Array, node.track.times);
      node.poses = view(Float32Array, node.track.poses);
    }
  }
  colourStages(scene);
  return scene;
}

/** Gives each stage a colour, the same to stages of the same name. */
function colourStages(scene) {
  const names = [...new Set(scene.stages.map((stage) => stage.name))];
  for (const stage of scene.stages) {
    stage.colour = STAGE_COLOURS[names.indexOf(stage.name) % STAGE_COLOURS.length];
  }
}

/** The stage at a time, or undefined between stages. */
export const stageAt = (scene, time) =>
  scene.stages.findLast((stage) => stage.start <= time + 1e-6 && time <= stage.end + 1e-6);
