// What the tests run in the browser; run.mjs calls these functions by name. Planes are arrays, row 0 at the bottom.
import * as THREE from "three";
import { EffectComposer } from "three/addons/postprocessing/EffectComposer.js";
import { RenderPass } from "three/addons/postprocessing/RenderPass.js";
import { OutputPass } from "three/addons/postprocessing/OutputPass.js";
import { UmbragePass, createEffect, kits } from "../src/three.js";
import { makeCamera, makeScene } from "./scene.js";

const text = (data) => btoa(Array.from(new Uint8Array(data.buffer), (byte) => String.fromCharCode(byte)).join(""));
const floats = (base64) => new Float32Array(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer);

function context(withoutExtensions = []) {
  const canvas = document.createElement("canvas"), gl = canvas.getContext("webgl2"), get = gl.getExtension.bind(gl);
  gl.getExtension = (name) => (withoutExtensions.includes(name) ? null : get(name));
  return gl;
}

function upload(gl, width, height, data) {
  const channels = data.length / (width * height), texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, channels == 1 ? gl.R32F : gl.RGB32F, width, height, 0, channels == 1 ? gl.RED : gl.RGB, gl.FLOAT, data);
  return texture;
}

/** Returns one channel or all of a texture of floats (or of their bits). */
function download(gl, texture, width, height, channels, bits = false) {
  const frame = gl.createFramebuffer(), all = bits ? new Uint32Array(4 * width * height) : new Float32Array(4 * width * height);
  const before = gl.getParameter(gl.FRAMEBUFFER_BINDING);
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.readPixels(0, 0, width, height, bits ? gl.RGBA_INTEGER : gl.RGBA, bits ? gl.UNSIGNED_INT : gl.FLOAT, all);
  gl.bindFramebuffer(gl.FRAMEBUFFER, before);
  gl.deleteFramebuffer(frame);
  const result = new Float32Array(channels * width * height), values = bits ? new Float32Array(all.buffer) : all;
  for (let k = 0; k < width * height; ++k) for (let c = 0; c < channels; ++c) result[channels * k + c] = values[4 * k + c];
  return result;
}

function composerOf(renderer, ...passes) {
  const composer = new EffectComposer(renderer);
  for (const pass of passes) composer.addPass(pass);
  composer.render();
  return composer;
}

window.tests = {
  /** Runs kits on planes; returns the planes `wanted`. */
  planes({ kit, width, height, planes, projection, radius, halfResolution, view, wanted }) {
    const gl = context(), effect = createEffect(gl, kits[kit], { halfResolution });
    const { depth, ...textures } = Object.fromEntries(Object.entries(planes).map(([name, plane]) => [name, upload(gl, width, height, floats(plane))]));
    const shaded = effect.render({ width, height, projection, radius, textures, view, linearDepth: depth });
    const result = Object.fromEntries(wanted.map(([name, channels]) => [name, text(download(gl, shaded[name], width, height, channels))]));
    if (gl.getError()) throw new Error("a GL error");
    return result;
  },
  /** Draws the scene by three.js with UmbragePass; returns its planes and camera. */
  three({ width, height, orthographic = false, depthBits, samples, parameters = {}, options = {}, without = [] }) {
    const gl = context(without), renderer = new THREE.WebGLRenderer({ canvas: gl.canvas, context: gl, ...parameters });
    renderer.setSize(width, height);
    const { scene } = makeScene(), camera = makeCamera(width / height, orthographic), pass = new UmbragePass(scene, camera, { radius: 0.5, ...options });
    const composer = composerOf(renderer, new RenderPass(scene, camera), pass);
    const raw = (texture) => renderer.properties.get(texture).__webglTexture;
    let shaded, input;
    if (depthBits || samples) {
      const target = new THREE.WebGLRenderTarget(width, height, { samples: samples ?? 0,
        depthTexture: depthBits ? new THREE.DepthTexture(width, height, depthBits == 16 ? THREE.UnsignedShortType : THREE.UnsignedIntType) : null });
      renderer.setRenderTarget(target);
      renderer.render(scene, camera);
      renderer.setRenderTarget(null);
      input = depthBits ? { depth: raw(target.depthTexture) } : { framebuffer: renderer.properties.get(target).__webglMultisampledFramebuffer };
      shaded = createEffect(gl, kits.ao).render({ width, height, radius: 0.5, projection: camera.projectionMatrix.elements, textures: { normal: raw(pass.surfaces.textures[1]) }, ...input });
    } else {
      shaded = pass.shade(renderer, width, height, composer.readBuffer.texture);
    }
    const { targets } = pass.effect.runner, depth = download(gl, shaded.depth, width, height, 1, targets == "half");
    // The truth of depth: rays at 64 pixels. SwiftShader places corners to 1/16 of a pixel, which slopes enlarge.
    const ray = new THREE.Raycaster(), view = new THREE.Vector3();
    let depthError = 0;
    for (let k = 0; k < 64; ++k) {
      const x = (k % 8 + 0.5) * width / 8 | 0, y = ((k >> 3) + 0.5) * height / 8 | 0;
      ray.setFromCamera(new THREE.Vector2((x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1), camera);
      const hit = ray.intersectObject(scene, true)[0];
      const truth = hit ? -view.copy(hit.point).applyMatrix4(camera.matrixWorldInverse).z : 0;
      depthError = Math.max(depthError, Math.abs(depth[y * width + x] - truth) / (truth || 1));
    }
    const result = { depthError, depth: text(depth), ao: text(download(gl, shaded.ao, width, height, 1)), normal: text(download(gl, shaded.normal, width, height, 3)),
                     reversed: renderer.capabilities.reversedDepthBuffer, logarithmic: renderer.capabilities.logarithmicDepthBuffer, targets };
    if (gl.getError()) throw new Error("a GL error");
    return result;
  },
  /** Draws a look on the page's canvas, for a screenshot. */
  picture({ width, height, options }) {
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(width, height);
    renderer.shadowMap.enabled = true;
    document.body.replaceChildren(renderer.domElement);
    document.body.style.margin = 0;
    const { scene } = makeScene(), camera = makeCamera(width / height);
    composerOf(renderer, new RenderPass(scene, camera), new UmbragePass(scene, camera, options), new OutputPass());
    const gl = renderer.getContext(), data = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
    const result = { error: gl.getError(), mean: 0, black: 0, colored: 0 };
    for (let k = 0; k < data.length; k += 4) {
      const rgb = data.slice(k, k + 3), max = Math.max(...rgb), min = Math.min(...rgb);
      result.mean += max / (width * height);
      result.black += (max < 20) / (width * height);
      result.colored += (max - min > 60) / (width * height);
    }
    return result;
  },
  /** Counts GL objects that remain after 100 resizes, and after dispose(). */
  leaks() {
    const gl = context(), live = {};
    for (const kind of ["Texture", "Framebuffer", "Buffer", "Sampler", "Program", "Shader", "Renderbuffer"]) {
      const objects = live[kind] = new Set(), create = gl["create" + kind].bind(gl), remove = gl["delete" + kind].bind(gl);
      gl["create" + kind] = (...args) => { const object = create(...args); objects.add(object); return object; };
      gl["delete" + kind] = (object) => { objects.delete(object); remove(object); };
    }
    const counts = () => ({ ...Object.fromEntries(Object.entries(live).map(([kind, objects]) => [kind, objects.size])), ...renderer.info.memory });
    const renderer = new THREE.WebGLRenderer({ canvas: gl.canvas, context: gl }), { scene } = makeScene(), camera = makeCamera(1);
    const pass = new UmbragePass(scene, camera);  // and two others, so that both buffers of the composer are in use
    const composer = composerOf(renderer, new RenderPass(scene, camera), new OutputPass(), new OutputPass());
    const draw = (k) => (composer.setSize(16 + k % 9, 16 + k % 7), composer.render());
    draw(1);
    const without = counts();
    composer.insertPass(pass, 1);
    const looks = [];
    for (const [look, halfResolution] of [["ao", false], ["ao", true], ["bleeding", true], ["toon", false]]) {
      Object.assign(pass, { look, halfResolution });
      draw(1);
      const before = counts();
      for (let k = 0; k < 101; ++k) draw(k);
      draw(1);
      looks.push({ look, before, after: counts() });
    }
    composer.removePass(pass);
    pass.dispose();
    draw(1);
    return { without, looks, after: counts() };
  },
  /** Returns the names of GL state that render() changed. */
  state() {
    const gl = context(), width = 20, height = 10, effect = createEffect(gl, kits.ao);
    const depth = upload(gl, width, height, new Float32Array(width * height).fill(2)), buffer = gl.createBuffer();
    const flags = ["BLEND", "CULL_FACE", "DEPTH_TEST", "SCISSOR_TEST", "STENCIL_TEST", "RASTERIZER_DISCARD"];
    for (const flag of flags) gl.enable(gl[flag]);
    gl.colorMask(true, false, true, false);
    gl.viewport(1, 2, 3, 4);
    gl.bindVertexArray(gl.createVertexArray());
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, gl.createFramebuffer());
    gl.bindBuffer(gl.UNIFORM_BUFFER, buffer);
    gl.bufferData(gl.UNIFORM_BUFFER, 512, gl.STATIC_DRAW);
    gl.bindBufferRange(gl.UNIFORM_BUFFER, 0, buffer, 0, 256);
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, depth);
    gl.bindSampler(3, gl.createSampler());
    const names = [...flags, "DITHER", "COLOR_WRITEMASK", "VIEWPORT", "VERTEX_ARRAY_BINDING", "DRAW_FRAMEBUFFER_BINDING", "READ_FRAMEBUFFER_BINDING",
      "UNIFORM_BUFFER_BINDING", "ACTIVE_TEXTURE", "TEXTURE_BINDING_2D", "SAMPLER_BINDING", "CURRENT_PROGRAM"];
    const all = () => [...names.map((name) => gl.getParameter(gl[name])), ...["BINDING", "SIZE"].map((name) => gl.getIndexedParameter(gl["UNIFORM_BUFFER_" + name], 0))];
    const same = (a, b) => a === b || (a?.length && Array.from(a).every((v, k) => v === b[k])), before = all();
    effect.render({ width, height, linearDepth: depth, projection: new THREE.PerspectiveCamera(50, 2, 1, 10).projectionMatrix.elements });
    return { changed: all().map((value, k) => (same(value, before[k]) ? "" : names[k] ?? "uniform block")).filter((name) => name), error: gl.getError() };
  },
  /** Returns the message of what createEffect or render throws. */
  refusal({ kit, without = [], input }) {
    try {
      const gl = context(without), effect = createEffect(gl, kits[kit]);
      const depth = upload(gl, 8, 8, new Float32Array(64).fill(0.5));
      effect.render({ width: 8, height: 8, depth, projection: new THREE.PerspectiveCamera(50, 1, 1, 10).projectionMatrix.elements, ...input });
      return "";
    } catch (error) {
      return error.message;
    }
  },
};
