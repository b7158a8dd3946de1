// A frame: shadow map, depth, occlusion, then backdrop, surfaces, floor and lines.

import { add, length, linear, lookAt, multiply, normalize, orthographic, scale, sub, unproject } from './math.js';
import { Program, Target } from './gl.js';
import { Lines } from './lines.js';
import { Surfaces } from './surfaces.js';

const SHADOW_PIXELS = 2048;
/** From -1..1 to 0..1. */
const HALVED = [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0.5, 0.5, 0.5, 1];

const rgb = (hex) => [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16) / 255);
const light = (hex, strength) => rgb(hex).map((c) => linear(c) * strength);

/** Colours of backdrop and light, by theme. */
const THEMES = {
  light: {
    u_zenith: rgb('#d3dce6'), u_horizon: rgb('#f3f5f8'), u_floor: rgb('#dfe4ea'),
    u_sky: light('#eef4ff', 0.62), u_bounce: light('#e2ddd6', 0.34), u_key_strength: 2.0,
    u_line: [...rgb('#8593a3'), 0.42], u_shade: [...rgb('#1b2532'), 0.62], u_pool: [...rgb('#ffffff'), 0.6],
  },
  dark: {
    u_zenith: rgb('#0d1014'), u_horizon: rgb('#232a33'), u_floor: rgb('#12161b'),
    u_sky: light('#c9d8f0', 0.42), u_bounce: light('#6f6a66', 0.3), u_key_strength: 2.0,
    u_line: [...rgb('#8fa3b8'), 0.3], u_shade: [...rgb('#000000'), 0.75], u_pool: [...rgb('#5a6b80'), 0.4],
  },
};

export class Renderer {
  constructor(canvas, scene, camera, shaders) {
    const gl = canvas.getContext('webgl2', { antialias: true, alpha: false, powerPreference: 'high-performance' });
    if (!gl) throw new Error('This page needs WebGL 2, which this browser does not offer.');
    this.gl = gl;
    this.canvas = canvas;
    this.scene = scene;
    this.pixelRatio = 1;

    const program = (vertex, fragment) => {
      const lit = /key_arriving|developed/.test(shaders[fragment]);
      return new Program(gl, shaders[vertex], (lit ? shaders['light.glsl'] : '') + shaders[fragment]);
    };
    this.programs = {
      depth: program('surface.vert', 'depth.frag'),
      floorDepth: program('floor.vert', 'depth.frag'),
      openness: program('screen.vert', 'openness.frag'),
      blur: program('screen.vert', 'blur.frag'),
      background: program('screen.vert', 'background.frag'),
      surface: program('surface.vert', 'surface.frag'),
      floor: program('floor.vert', 'floor.frag'),
      line: program('line.vert', 'line.frag'),
    };
    this.shadow = new Target(gl, 'shadow');
    this.depth = new Target(gl, 'depth');
    this.grainy = new Target(gl, 'colour');
    this.openness = new Target(gl, 'colour');
    this.shadow.resize(SHADOW_PIXELS, SHADOW_PIXELS);

    this.surfaces = new Surfaces(gl, scene);
    this.lines = new Lines(gl, scene);
    this.nothing = gl.createVertexArray();
    this.light = this.lightOf(scene, camera);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  /** What does not change from frame to frame: the key light's view of all that ever moves. */
  lightOf({ reach, floor }, camera) {
    // It stands to the left of the opening camera, above it.
    const azimuth = camera.home.azimuth - 0.85;
    const key = normalize([Math.cos(azimuth), Math.sin(azimuth), 1.35]);
    const centre = scale(add(reach.low, reach.high), 0.5);
    const radius = Math.max(length(sub(reach.high, reach.low)) / 2, 0.05);
    const view = lookAt(add(centre, scale(key, 2 * radius)), centre);
    const clip = multiply(orthographic(radius, radius * 0.9, radius * 3.1), view);
    return {
      clip,
      values: {
        u_key: key,
        u_shadow_from_world: multiply(HALVED, clip),
        u_shadow_texel: (2 * radius) / SHADOW_PIXELS,
        u_centre: [...camera.home.target.slice(0, 2), floor],
        u_reach: Math.max(4 * camera.span, 1.2 * radius),
      },
    };
  }

  /** Fits the picture to its element; tells whether the size changed. */
  fit() {
    const { canvas } = this;
    this.pixelRatio = Math.min(window.devicePixelRatio || 1, 2);
    const size = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * this.pixelRatio)));
    const changed = canvas.width !== size[0] || canvas.height !== size[1];
    if (changed) [canvas.width, canvas.height] = size;
    const share = this.pixelRatio > 1 ? 0.5 : 1;
    const coarse = size.map((x) => Math.ceil(x * share));
    for (const target of [this.depth, this.grainy, this.openness]) target.resize(...coarse);
    return changed;
  }

  draw({ world, shown, time, camera, theme, selected }) {
    const { gl, programs, surfaces } = this;
    const eye = camera.eye;
    const screen = [this.canvas.width, this.canvas.height];
    const shared = {
      ...this.light.values,
      ...THEMES[theme],
      u_clip_from_world: camera.clipFromWorld,
      u_eye: eye,
      u_screen: screen,
      u_shadow: this.shadow.texture,
      u_openness: this.openness.texture,
    };
    surfaces.place(world, shown, eye, selected);

    this.drawShadow();
    this.drawOpenness(camera, shared);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, ...screen);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.drawBackground(camera, theme);
    programs.surface.use(shared);
    surfaces.draw(programs.surface, surfaces.solid);

    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    programs.floor.use(shared);
    this.drawTriangle();
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
    gl.depthMask(false);
    programs.surface.use(shared);
    surfaces.draw(programs.surface, surfaces.clear);
    gl.depthMask(true);
    programs.line.use({ ...shared, u_time: time });
    this.lines.draw(programs.line, world, shown, this.pixelRatio);
    gl.disable(gl.BLEND);
  }

  /** Draws one triangle whose corners the program knows. */
  drawTriangle() {
    this.gl.bindVertexArray(this.nothing);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
  }

  drawShadow() {
    const { gl, programs, surfaces } = this;
    this.shadow.begin();
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    programs.depth.use({ u_clip_from_world: this.light.clip });
    surfaces.draw(programs.depth, surfaces.solid);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  drawOpenness(camera, shared) {
    const { gl, programs, surfaces } = this;
    this.depth.begin();
    programs.depth.use(shared);
    surfaces.draw(programs.depth, surfaces.solid);
    programs.floorDepth.use(shared);
    this.drawTriangle();

    gl.disable(gl.DEPTH_TEST);
    const clipFromView = camera.clipFromView;
    this.grainy.begin();
    programs.openness.use({
      u_depth: this.depth.texture,
      u_view_from_clip: unproject(clipFromView),
      u_scale: [clipFromView[0], clipFromView[5]],
      u_radius: 0.06 * camera.span,
    });
    this.drawTriangle();

    const [width, height] = this.depth.size;
    for (const [from, to, step] of [
      [this.grainy, this.openness, [1 / width, 0]],
      [this.openness, this.grainy, [0, 1 / height]],
    ]) {
      to.begin();
      programs.blur.use({
        u_depth: this.depth.texture, u_grainy: from.texture, u_step: step, u_range: camera.range,
      });
      this.drawTriangle();
    }
    shared.u_openness = this.grainy.texture;
    gl.enable(gl.DEPTH_TEST);
  }

  drawBackground(camera, theme) {
    const { gl, programs } = this;
    const [right, up, back] = camera.axes();
    const tan = Math.tan(camera.fovY / 2);
    const [x, y] = camera.middle;
    gl.depthMask(false);
    programs.background.use({
      ...THEMES[theme],
      u_right: scale(right, tan * camera.aspect),
      u_up: scale(up, tan),
      u_ahead: sub(scale(right, -x * tan * camera.aspect), add(back, scale(up, y * tan))),
    });
    this.drawTriangle();
    gl.depthMask(true);
  }
}
