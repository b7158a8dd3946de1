// A thin layer over WebGL2.

const PREAMBLE = '#version 300 es\nprecision highp float;\nprecision highp int;\n';

function compile(gl, type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, PREAMBLE + source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
    throw new Error(`${gl.getShaderInfoLog(shader)}\n${source}`);
  }
  return shader;
}

/** A program with its uniforms by name; samplers get texture units in order. */
export class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.handle = gl.createProgram();
    gl.attachShader(this.handle, compile(gl, gl.VERTEX_SHADER, vertex));
    gl.attachShader(this.handle, compile(gl, gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(this.handle);
    if (!gl.getProgramParameter(this.handle, gl.LINK_STATUS)) {
      throw new Error(gl.getProgramInfoLog(this.handle));
    }
    this.uniforms = new Map();
    let units = 0;
    for (let i = 0; i < gl.getProgramParameter(this.handle, gl.ACTIVE_UNIFORMS); i++) {
      const { name, type } = gl.getActiveUniform(this.handle, i);
      const sampler = type === gl.SAMPLER_2D || type === gl.SAMPLER_2D_SHADOW;
      const unit = sampler ? units++ : undefined;
      this.uniforms.set(name, { type, unit, location: gl.getUniformLocation(this.handle, name) });
    }
  }

  /** Makes this the current program with these values; names it does not have are passed over. */
  use(values = {}) {
    const { gl } = this;
    gl.useProgram(this.handle);
    for (const [name, value] of Object.entries(values)) this.set(name, value);
  }

  set(name, value) {
    const { gl } = this;
    const uniform = this.uniforms.get(name);
    if (!uniform) return;
    const { type, unit, location } = uniform;
    if (unit !== undefined) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, value);
      gl.uniform1i(location, unit);
    } else if (type === gl.FLOAT) gl.uniform1f(location, value);
    else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, value);
    else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, value);
    else if (type === gl.FLOAT_VEC4) gl.uniform4fv(location, value);
    else gl.uniformMatrix4fv(location, false, value);
  }
}

/** A picture to draw into: depth alone, or colour alone. */
export class Target {
  constructor(gl, kind) {
    this.gl = gl;
    this.kind = kind;
    this.framebuffer = gl.createFramebuffer();
    this.size = [0, 0];
  }

  resize(width, height) {
    const { gl, kind, size } = this;
    if (size[0] === width && size[1] === height) return;
    this.size = [width, height];
    gl.deleteTexture(this.texture);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, kind === 'colour' ? gl.RGBA8 : gl.DEPTH_COMPONENT24, width, height);
    const filter = kind === 'depth' ? gl.NEAREST : gl.LINEAR;
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    if (kind === 'shadow') {
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    const attachment = kind === 'colour' ? gl.COLOR_ATTACHMENT0 : gl.DEPTH_ATTACHMENT;
    gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, this.texture, 0);
    if (kind !== 'colour') {
      gl.drawBuffers([gl.NONE]);
      gl.readBuffer(gl.NONE);
    }
  }

  /** Makes this what is drawn into, and clears it. */
  begin() {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.viewport(0, 0, ...this.size);
    gl.clear(this.kind === 'colour' ? gl.COLOR_BUFFER_BIT : gl.DEPTH_BUFFER_BIT);
  }
}

/** A buffer that holds `data`. */
export function buffer(gl, target, data, usage = gl.STATIC_DRAW) {
  const handle = gl.createBuffer();
  gl.bindBuffer(target, handle);
  gl.bufferData(target, data, usage);
  return handle;
}
