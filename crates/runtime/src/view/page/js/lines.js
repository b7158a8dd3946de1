// Lines on the graphics card: each segment is an instance of a quad.

import { matrixOf } from './math.js';
import { buffer } from './gl.js';
import { stageAt } from './scene.js';

/** The way of the tool takes the colours of the stages in which it was drawn. */
function stageColours(scene, { ends, colours }) {
  const painted = colours.slice();
  for (let end = 0; end < ends.length / 4; end++) {
    // A point where two stages meet takes the colour of the stage that the segment lies in.
    const first = end - (end % 2);
    const middle = (ends[4 * first + 3] + ends[4 * first + 7]) / 2;
    const stage = stageAt(scene, middle);
    if (!stage) continue;
    const rgb = Number.parseInt(stage.colour.slice(1), 16);
    painted.set([rgb >> 16, (rgb >> 8) & 255, rgb & 255], 4 * end);
  }
  return painted;
}

export class Lines {
  constructor(gl, scene) {
    this.gl = gl;
    this.sets = scene.nodes.flatMap((node, index) =>
      node.lines.map((lines) => ({
        index,
        group: node.group,
        width: lines.width,
        count: lines.ends.length / 8,
        array: this.upload(lines.ends, lines.staged ? stageColours(scene, lines) : lines.colours),
      })),
    );
  }

  upload(ends, colours) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (location, type, normalised, stride, offset) => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 4, type, normalised, stride, offset);
      gl.vertexAttribDivisor(location, 1);
    };
    buffer(gl, gl.ARRAY_BUFFER, ends);
    attribute(0, gl.FLOAT, false, 32, 0);
    attribute(1, gl.FLOAT, false, 32, 16);
    buffer(gl, gl.ARRAY_BUFFER, colours);
    attribute(2, gl.UNSIGNED_BYTE, true, 8, 0);
    attribute(3, gl.UNSIGNED_BYTE, true, 8, 4);
    gl.bindVertexArray(null);
    return array;
  }

  /** Draws the sets of shown groups, faintly where solid things hide them. */
  draw(program, world, shown, pixelRatio) {
    const { gl } = this;
    gl.depthMask(false);
    for (const { index, group, width, count, array } of this.sets) {
      if (!shown.has(group) || !count) continue;
      program.set('u_world_from_node', matrixOf(world[index]));
      program.set('u_width', width * pixelRatio);
      gl.bindVertexArray(array);
      for (const [test, opacity] of [[gl.GREATER, 0.18], [gl.LEQUAL, 1]]) {
        gl.depthFunc(test);
        program.set('u_opacity', opacity);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
      }
    }
    gl.bindVertexArray(null);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
  }
}
