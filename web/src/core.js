// Runs the generated shader kits on textures of a WebGL 2 context. Needs no other library.
//
// All textures have row 0 at the bottom, as WebGL draws them. Depth is linear view depth, > 0, in scene units; 0 is
// background. The caller's GL state is the same before and after every call.
import * as kits from "../generated/kits.js";
export { kits };

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }`;
// Converts a depth buffer. `depth_form`: a, b, c, d of depth = (a + b t) / (c + d t), where t is the stored value, or 1
// minus it; that keeps the precision of far depths. `depth_log`: log2(far + 1), or 0.
const LINEAR = `#version 300 es
precision highp float; precision highp int; uniform highp sampler2D buffer_texture; uniform vec4 depth_form; uniform float depth_log;
uniform bool one_minus, reversed; layout(location = 0) out float depth_out;
void main() {
  float stored = texelFetch(buffer_texture, ivec2(gl_FragCoord.xy), 0).r, t = one_minus ? 1. - stored : stored;
  float depth = depth_log > 0. ? exp2(stored * depth_log) - 1. : (depth_form.x + depth_form.y * t) / (depth_form.z + depth_form.w * t);
  bool surface = (reversed ? stored > 0. : stored < 1.) && depth > 0.;
  depth_out = surface ? depth : 0.;
}`;

/** Returns the view of a projection matrix (column-major, as in GL and three.js) for a picture of a size. */
function viewOfProjection(m, width, height) {
  const orthographic = m[15] == 1, z = orthographic ? 0 : 1;
  const at = (scale, skew, shift, side) => (side + z * skew - (1 - z) * shift) / scale;
  return { width, height, orthographic, left: at(m[0], m[8], m[12], -1), right: at(m[0], m[8], m[12], 1),
           bottom: at(m[5], m[9], m[13], -1), top: at(m[5], m[9], m[13], 1) };
}

/** Returns the uniforms of LINEAR for a projection matrix and the meaning of the depth buffer. */
function depthUniforms(m, { reversed = false, zeroToOne = reversed, logarithmic = 0 }) {
  // Normalized depth is s t + o. Perspective: d = m14 / (n + m10); orthographic: d = (m14 - n) / m10.
  const oneMinus = !reversed, range = zeroToOne ? 1 : 2, s = oneMinus ? -range : range, o = oneMinus ? 1 : 1 - range;
  const form = m[15] == 1 ? [m[14] - o, -s, m[10], 0] : [m[14], 0, o + m[10], s];
  return { form, oneMinus, reversed, log: m[15] == 1 ? 0 : logarithmic && Math.log2(logarithmic + 1) };
}

const DEPTHS = ["depth", "reduced_depth"], ENCODINGS = ["signed", "unsigned", "octahedral"], UNITS = 14;
const FLAGS = ["BLEND", "CULL_FACE", "DEPTH_TEST", "SCISSOR_TEST", "STENCIL_TEST", "RASTERIZER_DISCARD",
               "SAMPLE_COVERAGE", "SAMPLE_ALPHA_TO_COVERAGE", "DITHER"];

/** Sets the state that drawing needs, and returns a function that restores what was there. */
function takeState(gl) {
  const get = (name) => gl.getParameter(gl[name]);
  const flags = FLAGS.map((name) => [gl[name], gl.isEnabled(gl[name])]);
  const [program, vertices, draw, read, unit] =
    ["CURRENT_PROGRAM", "VERTEX_ARRAY_BINDING", "DRAW_FRAMEBUFFER_BINDING", "READ_FRAMEBUFFER_BINDING", "ACTIVE_TEXTURE"].map(get);
  const viewport = get("VIEWPORT"), mask = get("COLOR_WRITEMASK"), buffer = get("UNIFORM_BUFFER_BINDING");
  const block = ["BINDING", "START", "SIZE"].map((name) => gl.getIndexedParameter(gl["UNIFORM_BUFFER_" + name], 0));
  const units = Array.from({ length: UNITS }, (_, k) => {
    gl.activeTexture(gl.TEXTURE0 + k);
    return [get("TEXTURE_BINDING_2D"), get("SAMPLER_BINDING")];
  });
  flags.forEach(([flag]) => gl.disable(flag));
  gl.colorMask(true, true, true, true);
  gl.bindVertexArray(null);
  return () => {
    flags.forEach(([flag, on]) => on && gl.enable(flag));
    gl.colorMask(...mask);
    gl.viewport(...viewport);
    gl.useProgram(program);
    gl.bindVertexArray(vertices);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, draw);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, read);
    if (block[0] && block[2]) gl.bindBufferRange(gl.UNIFORM_BUFFER, 0, ...block);
    else gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, block[0]);
    gl.bindBuffer(gl.UNIFORM_BUFFER, buffer);
    units.forEach(([texture, sampler], k) => {
      gl.activeTexture(gl.TEXTURE0 + k);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.bindSampler(k, sampler);
    });
    gl.activeTexture(unit);
  };
}

/** Returns which targets a context can render to: "float", "half", or throws a sentence that says what is missing. */
function targetsOf(gl) {
  if (!globalThis.WebGL2RenderingContext || !(gl instanceof WebGL2RenderingContext)) throw new Error("Umbrage needs a WebGL 2 context.");
  if (gl.getExtension("EXT_color_buffer_float")) return "float";
  if (gl.getExtension("EXT_color_buffer_half_float")) return "half";
  throw new Error("Umbrage needs render targets of floats: this WebGL 2 context has neither EXT_color_buffer_float nor EXT_color_buffer_half_float.");
}

/** Textures, programs and draws that the kits of one effect share. */
class Runner {
  constructor(gl) {
    this.gl = gl;
    this.targets = targetsOf(gl);
    this.programs = new Map();
    this.planes = new Map();
    this.renew();
    this.block = gl.createBuffer();
    this.sampler = gl.createSampler();
    for (const filter of ["MIN", "MAG"]) gl.samplerParameteri(this.sampler, gl[`TEXTURE_${filter}_FILTER`], gl.NEAREST);
  }

  /** Returns the texture of a key; it is made when first asked for. */
  plane(key, format, width, height) {
    const gl = this.gl;
    if (this.planes.has(key)) return this.planes.get(key);
    const texture = gl.createTexture();
    this.planes.set(key, texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl[format], width, height);
    for (const filter of ["MIN", "MAG"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${filter}_FILTER`], gl.NEAREST);
    return texture;
  }

  formatOf(name, channels, exact) {
    const layout = channels == 1 ? "R" : "RGBA";
    if (this.targets == "float") return layout + "32F";
    if (DEPTHS.includes(name)) return "R32UI";
    if (exact) throw new Error(`Umbrage needs EXT_color_buffer_float for this effect: its plane '${name}' has packed bits, which half floats lose.`);
    return layout + "16F";
  }

  /** Returns the program of a text. Without float targets, depth has the bits of floats: in the samplers `bits` and, if `bitsOut`, the output. */
  program(id, text, bits = [], bitsOut = false) {
    const gl = this.gl, key = [id, ...bits, bitsOut].join();
    if (this.programs.has(key)) return this.programs.get(key);
    for (const name of bits)
      text = text.replace(new RegExp(`sampler2D\\s+${name}\\b`), `usampler2D ${name}`)
        .replace(new RegExp(`texelFetch\\(\\s*${name}\\b[^;]*,\\s*0\\s*\\)`, "g"), "uintBitsToFloat($&)");
    const out = bitsOut && text.match(/out (?:highp )?(float|vec4) (\w+)/);
    if (out) text = text.replace(out[0], `out highp ${out[1] == "float" ? "uint" : "uvec4"} ${out[2]}`)
      .replace(new RegExp(`\\b${out[2]}\\s*=([^;]*);`, "g"), `${out[2]} = floatBitsToUint($1);`);
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, text]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(`${id}: ${gl.getShaderInfoLog(shader)}`);
      gl.deleteShader(shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(`${id}: ${gl.getProgramInfoLog(program)}`);
    const places = {}, place = (name) => (places[name] === undefined ? (places[name] = gl.getUniformLocation(program, name)) : places[name]);
    this.programs.set(key, { program, place });
    return this.programs.get(key);
  }

  attach(targets) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    for (let k = 0; k < 4; ++k) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, targets[k] ?? null, 0);
    gl.drawBuffers(targets.map((_, k) => gl.COLOR_ATTACHMENT0 + k));
  }

  /** Draws a triangle over targets. `inputs`: [sampler name, texture]. `set`: sets further uniforms. */
  draw({ program, place }, inputs, targets, width, height, set) {
    const gl = this.gl;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, texture] of inputs) {
      if (place(name) === null) continue;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.bindSampler(unit, this.sampler);
      gl.uniform1i(place(name), unit++);
    }
    set?.(place);
    this.attach(targets);
    gl.viewport(0, 0, width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** Returns a texture of one pixel for an input that is left out. */
  neutral(name, value) {
    const gl = this.gl, key = "neutral " + value;
    if (this.planes.has(key)) return this.planes.get(key);
    const texture = this.plane(key, this.formatOf("", 4), 1, 1);
    this.attach([texture]);
    gl.clearBufferfv(gl.COLOR, 0, [value, value, value, value]);
    return texture;
  }

  /** Runs a kit. `textures`: name to texture; gets the planes that the kit writes. */
  run({ kit, frames, reducedView, sources }, textures, view, normals = "signed") {
    const gl = this.gl, about = Object.fromEntries(kit.textures.map((texture) => [texture.name, texture]));
    for (const pass of kit.passes) {
      const inputs = pass.inputs.map((name, k) => {
        const texture = textures[name] ?? (about[name].neutral === undefined ? null : this.neutral(name, about[name].neutral));
        if (!texture) throw new Error(`Umbrage: ${pass.effect} needs the texture '${name}'.`);
        return [pass.samplers[k], texture];
      });
      const own = pass.size == "reduced" ? reducedView(view, kit.factor) : view, { width, height } = own;
      const isBits = (name) => this.targets == "half" && DEPTHS.includes(name);
      const program = this.program(pass.file + kit.settings + normals, sources[pass.file].replace(/^#version.*\n/, `$&#define UMBRAGE_NORMALS ${ENCODINGS.indexOf(normals)}\n`),
        pass.samplers.filter((_, k) => isBits(pass.inputs[k])), isBits(pass.outputs[0]));
      if (pass.effect) {
        gl.uniformBlockBinding(program.program, gl.getUniformBlockIndex(program.program, kit.blocks[pass.effect].name), 0);
        gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, this.block);
        gl.bufferData(gl.UNIFORM_BUFFER, frames[pass.effect](own, pass.round), gl.STREAM_DRAW);
      }
      // A plane that was written before gets the other one of two textures, since the pass may read it.
      const written = pass.outputs.map((name) => {
        const format = this.formatOf(name, about[name].channels, about[name].exact);
        const texture = (k) => this.plane(`${name} ${k}`, format, width, height);
        return texture(0) == textures[name] ? texture(1) : texture(0);
      });
      this.draw(program, inputs, written, width, height);
      pass.outputs.forEach((name, k) => { textures[name] = written[k]; });
    }
    return textures;
  }

  /** Frees the textures, and makes new framebuffers, since the old ones would keep the memory of deleted textures. */
  renew() {
    for (const texture of this.planes.values()) this.gl.deleteTexture(texture);
    this.planes.clear();
    for (const name of ["frame", "resolved"]) {
      this.gl.deleteFramebuffer(this[name] ?? null);
      this[name] = this.gl.createFramebuffer();
    }
  }
}

/** An effect that runs a kit, or several in order, on the caller's textures; see core.d.ts. */
class Effect {
  constructor(gl, kit, options) {
    this.runner = new Runner(gl);
    this.kits = [kit].flat().map((kit) => (options.halfResolution && kits[kit.half]) || kit);
  }

  /** Converts the caller's depth to the plane `depth`; resolves multisampled depth first. */
  linearDepth({ projection, depth, framebuffer, ...meaning }, width, height) {
    const runner = this.runner, gl = runner.gl;
    if (framebuffer !== undefined) depth = this.resolve(framebuffer, width, height);
    const { form, oneMinus, reversed, log } = depthUniforms(projection, meaning);
    const target = runner.plane("linear depth", runner.formatOf("depth", 1), width, height);
    runner.draw(runner.program("linear depth", LINEAR, [], runner.targets == "half"), [["buffer_texture", depth]], [target], width, height, (place) => {
      gl.uniform4f(place("depth_form"), ...form);
      gl.uniform1f(place("depth_log"), log || 0);
      gl.uniform1i(place("one_minus"), oneMinus);
      gl.uniform1i(place("reversed"), reversed);
    });
    return target;
  }

  /** Returns a texture with the depth of a framebuffer, of one sample per pixel. */
  resolve(framebuffer, width, height) {
    const runner = this.runner, gl = runner.gl;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, framebuffer);
    const bits = (part, attachment = framebuffer ? gl[part + "_ATTACHMENT"] : gl[part]) => {
      const get = (name) => gl.getFramebufferAttachmentParameter(gl.READ_FRAMEBUFFER, attachment, gl[name]);
      return get("FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE") == gl.NONE ? 0 : get(`FRAMEBUFFER_ATTACHMENT_${part}_SIZE`);
    };
    const depth = bits("DEPTH"), stencil = bits("STENCIL"), float = depth == 32 ? "F" : "";
    if (!depth) throw new Error("Umbrage: the framebuffer has no depth.");
    const format = stencil ? `DEPTH${depth}${float}_STENCIL8` : `DEPTH_COMPONENT${depth}${float}`;
    const texture = runner.plane("resolved " + format, format, width, height);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, runner.resolved);
    gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, stencil ? gl.DEPTH_STENCIL_ATTACHMENT : gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.DEPTH_BUFFER_BIT, gl.NEAREST);
    return texture;
  }

  render(input) {
    const { width, height, textures: given = {}, normals = "signed" } = input;
    if (!(width > 0 && height > 0)) throw new Error("Umbrage: render() needs a width and a height.");
    if (!input.linearDepth && !input.depth && input.framebuffer === undefined) throw new Error("Umbrage: render() needs a depth texture or a framebuffer.");
    if (!ENCODINGS.includes(normals)) throw new Error(`Umbrage: normals are 'signed', 'unsigned' or 'octahedral', not '${normals}'.`);
    this.resize(width, height);
    const restore = takeState(this.runner.gl), runner = this.runner;
    try {
      const view = { sceneRadius: input.radius ?? 1, depthMin: 0, depthMax: 1, ...viewOfProjection(input.projection, width, height), ...input.view };
      [view.lightX, view.lightY, view.lightZ] = view.light ?? [-0.4479, 0.64697, 0.61711];
      const textures = { ...given };
      // Without float targets, depth is stored in another form, which only the conversion writes.
      if (input.linearDepth && runner.targets == "half") throw new Error("Umbrage: linearDepth needs EXT_color_buffer_float.");
      textures.depth = input.linearDepth ?? this.linearDepth(input, width, height);
      textures.normal ??= runner.run(kits.normals, { depth: textures.depth }, view).normal;
      for (const kit of this.kits) runner.run(kit, textures, view, given.normal ? normals : "signed");
      return textures;
    } finally {
      restore();
    }
  }

  /** Frees the textures of another size. render() does so too. */
  resize(width, height) {
    if (this.size != (this.size = `${width}x${height}`)) this.runner.renew();
  }

  dispose() {
    const runner = this.runner, gl = runner.gl;
    runner.renew();
    for (const { program } of runner.programs.values()) gl.deleteProgram(program);
    runner.programs.clear();
    gl.deleteFramebuffer(runner.frame);
    gl.deleteFramebuffer(runner.resolved);
    gl.deleteBuffer(runner.block);
    gl.deleteSampler(runner.sampler);
  }
}

/** Returns an effect that runs a kit, or several in order. Throws a sentence if the context lacks what it needs. */
export function createEffect(gl, kit, options = {}) {
  return new Effect(gl, kit, options);
}
