// Text that stays at points of the scene.

import { project, transform } from './math.js';

export class Labels {
  constructor(layer, scene) {
    this.items = scene.labels.map((label) => {
      const element = document.createElement('div');
      element.className = 'label';
      element.textContent = label.text;
      layer.append(element);
      return { label, element };
    });
    this.scene = scene;
  }

  /** Moves labels with what they name; those behind the eye or of hidden groups vanish. */
  place(world, shown, camera, width, height) {
    const clipFromWorld = camera.clipFromWorld;
    for (const { label, element } of this.items) {
      const node = label.node === null ? undefined : this.scene.nodes[label.node];
      const at = node ? transform(world[label.node], label.point) : label.point;
      const [x, y, , w] = project(clipFromWorld, at);
      const visible = shown.has('labels') && w > 0 && (!node || shown.has(node.group));
      element.hidden = !visible;
      if (!visible) continue;
      const [left, top] = [((x / w) * 0.5 + 0.5) * width, (0.5 - (y / w) * 0.5) * height];
      element.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px) translate(-50%, calc(-100% - 10px))`;
    }
  }
}
