// Surfaces on the graphics card. A surface that many parts share is drawn once, with an instance for each part.

import { compose, dot, matrixOf, sub } from './math.js';
import { buffer } from './gl.js';

const FLOATS = 19;
const STRIDE = 4 * FLOATS;

export class Surfaces {
  constructor(gl, scene) {
    this.gl = gl;
    this.scene = scene;
    this.instances = scene.nodes
      .flatMap((node, index) => node.parts.map((part) => ({ node, index, part })))
      .sort((a, b) => a.part.surface - b.part.surface);
    this.data = new Float32Array(Math.max(this.instances.length, 1) * FLOATS);
    this.buffer = buffer(gl, gl.ARRAY_BUFFER, this.data.byteLength, gl.DYNAMIC_DRAW);
    this.arrays = scene.surfaces.map((surface) => this.upload(surface));
  }

  upload({ vertices, indices }) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    buffer(gl, gl.ARRAY_BUFFER, vertices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 10, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 2, gl.SHORT, true, 10, 6);
    buffer(gl, gl.ELEMENT_ARRAY_BUFFER, indices);
    for (let i = 2; i < 7; i++) {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribDivisor(i, 1);
    }
    gl.bindVertexArray(null);
    return array;
  }

  /** Puts every shown part where its node is: solid parts by surface, then clear ones from far to near. */
  place(world, shown, eye, selected) {
    const { gl, data } = this;
    const visible = this.instances.filter(({ node }) => shown.has(node.group));
    const away = ({ index }) => dot(sub(world[index], eye), sub(world[index], eye));
    const solid = visible.filter(({ part }) => part.colour[3] >= 1);
    const clear = visible.filter(({ part }) => part.colour[3] < 1).sort((a, b) => away(b) - away(a));
    this.solid = [];
    this.clear = [];
    let at = 0;
    const put = (runs, { index, part }) => {
      const m = matrixOf(compose(world[index], part.pose));
      data.set([m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14]], at * FLOATS);
      data.set(part.linear, at * FLOATS + 12);
      data.set([part.roughness, part.metallic, index === selected ? 1 : 0], at * FLOATS + 16);
      const run = runs.at(-1);
      if (run?.surface === part.surface) run.count++;
      else runs.push({ surface: part.surface, first: at, count: 1 });
      at++;
    };
    solid.forEach((instance) => put(this.solid, instance));
    clear.forEach((instance) => put(this.clear, instance));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, data.subarray(0, at * FLOATS));
  }

  /** Draws runs of instances with the current program. */
  draw(program, runs) {
    const { gl } = this;
    for (const { surface, first, count } of runs) {
      const { low, size, indices, wide } = this.scene.surfaces[surface];
      program.set('u_low', low);
      program.set('u_size', size);
      gl.bindVertexArray(this.arrays[surface]);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
      const start = first * STRIDE;
      for (let row = 0; row < 4; row++) gl.vertexAttribPointer(2 + row, 4, gl.FLOAT, false, STRIDE, start + 16 * row);
      gl.vertexAttribPointer(6, 3, gl.FLOAT, false, STRIDE, start + 64);
      gl.drawElementsInstanced(
        gl.TRIANGLES, indices.length, wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, 0, count,
      );
    }
    gl.bindVertexArray(null);
  }
}
