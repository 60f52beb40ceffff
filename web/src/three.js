// UmbragePass: the shader kits as a pass of three.js's EffectComposer; options in three.d.ts.
import { Box3, Color, DepthTexture, ExternalTexture, FloatType, GLSL3, HalfFloatType, MeshLambertMaterial, NearestFilter, NoBlending,
         ShaderMaterial, Sphere, Vector3, WebGLRenderTarget } from "three";
import { FullScreenQuad, Pass } from "three/addons/postprocessing/Pass.js";
import { createEffect, kits } from "./core.js";
export { createEffect, kits };

const LOOKS = { ao: [kits.ao], bleeding: [kits.bleeding], toon: [kits.ao, kits.toon, kits.outline] };

// What a material shows of a surface's shape and colour; other properties do not matter for depth, normals and albedo.
const KEPT = ["color", "map", "alphaMap", "alphaTest", "alphaHash", "side", "vertexColors", "flatShading", "normalMap", "normalMapType",
  "normalScale", "bumpMap", "bumpScale", "displacementMap", "displacementScale", "displacementBias", "clippingPlanes", "clipIntersection",
  "wireframe", "visible", "depthTest", "depthWrite", "polygonOffset", "polygonOffsetFactor", "polygonOffsetUnits"];

const COMPOSE = `
in vec2 place; layout(location = 0) out vec4 color;
uniform sampler2D beauty, surface, albedo, ao, indirect, lit, outline;
uniform int look, shown; uniform float intensity, bleeding, lineOpacity; uniform vec3 lineColor;
void main() {
  vec4 under = texture(beauty, place);
  float open = max(1. + (texture(ao, place).r - 1.) * intensity, 0.);
  vec3 result = under.rgb * open;
  if (look == 1) result += texture(albedo, place).rgb * texture(indirect, place).rgb * bleeding;
  if (look == 2) {
    vec3 toon = texture(surface, place).a > 0. ? texture(lit, place).rgb : under.rgb;
    result = mix(toon, lineColor, texture(outline, place).r * lineOpacity);
  }
  color = vec4(shown == 1 ? vec3(open) : result, under.a);
}`;

export class UmbragePass extends Pass {
  constructor(scene, camera, options = {}) {
    super();
    const defaults = { look: "ao", radius: 0, intensity: 1, bleeding: 1, halfResolution: false, lineColor: new Color(0),
                       lineOpacity: 1, light: null, output: "picture", depthTexture: null };
    for (const name of Object.keys(options)) if (!(name in defaults)) throw new Error(`UmbragePass: there is no option '${name}'; options are ${Object.keys(defaults).join(", ")}.`);
    Object.assign(this, { scene, camera }, defaults, options);
    this.bounds = this.effect = null;
    this.materials = new Map();
    this.hidden = new MeshLambertMaterial({ visible: false });
    const names = ["surface", "albedo", "ao", "indirect", "lit", "outline"];
    this.outputs = Object.fromEntries(names.slice(2).map((name) => [name, new ExternalTexture(null)]));
    const uniforms = Object.fromEntries(["beauty", ...names].map((name) => [name, { value: this.outputs[name] ?? null }]));
    for (const name of ["look", "shown", "intensity", "bleeding", "lineOpacity"]) uniforms[name] = { value: 0 };
    uniforms.lineColor = { value: new Color() };
    this.quad = new FullScreenQuad(new ShaderMaterial({
      uniforms, fragmentShader: COMPOSE, glslVersion: GLSL3, depthTest: false, depthWrite: false, blending: NoBlending, toneMapped: false,
      vertexShader: "out vec2 place; void main() { place = uv; gl_Position = vec4(position.xy, 0., 1.); }" }));
  }

  /** Measures the scene anew: its size gives the default radius and the depth range of outlines. Call it if the scene grows. */
  updateBounds() {
    this.bounds = new Box3().setFromObject(this.scene).getBoundingSphere(new Sphere());
    if (!(this.bounds.radius > 0)) this.bounds.set(new Vector3(), 1);
  }

  /** Returns the material that draws depth, normal and albedo of another one's surfaces. */
  surfaceMaterial(from) {
    if (Array.isArray(from)) return from.map((one) => this.surfaceMaterial(one));
    if (from.transparent || from.visible === false) return this.hidden;
    let to = this.materials.get(from);
    if (!to) {
      to = new MeshLambertMaterial({ fog: false });
      to.onBeforeCompile = (shader) => {
        shader.fragmentShader = "layout(location = 1) out highp vec4 umbrageNormal;\n" + shader.fragmentShader
          .replace(/#include <(lights_lambert_fragment|lights_fragment_\w+|aomap_fragment|envmap_fragment|emissivemap_fragment|tonemapping_fragment|colorspace_fragment|dithering_fragment)>/g, "")
          .replace("#include <opaque_fragment>", "gl_FragColor = vec4(diffuseColor.rgb, 1.); umbrageNormal = vec4(normalize(normal), 1.);");
      };
      to.customProgramCacheKey = () => "umbrage";
      this.materials.set(from, to);
      const end = () => { to.dispose(); this.materials.delete(from); };
      from.addEventListener("dispose", end);
      to.addEventListener("dispose", () => from.removeEventListener("dispose", end));
    }
    for (const key of KEPT) if (from[key] !== undefined) to[key] = from[key];
    if (to.userData.version !== from.version) {
      to.userData.version = from.version;
      to.needsUpdate = true;
    }
    return to;
  }

  /** Draws depth, normals and albedo of opaque surfaces. */
  drawSurfaces(renderer, width, height) {
    this.surfaces ??= new WebGLRenderTarget(width, height, { count: 2, type: HalfFloatType, minFilter: NearestFilter, magFilter: NearestFilter,
                                                             depthTexture: new DepthTexture(width, height, FloatType) });
    this.surfaces.setSize(width, height);
    const swapped = [];
    this.scene.traverse((object) => {
      const shape = object.isMesh && object.material;
      if (!shape && !(object.isLine || object.isPoints || object.isSprite)) return;
      swapped.push([object, object.material, object.layers.mask]);
      if (shape) object.material = this.surfaceMaterial(object.material);
      else object.layers.mask = 0;
    });
    const { scene } = this, { background, overrideMaterial } = scene, { autoClear } = renderer, shadows = renderer.shadowMap.autoUpdate;
    const color = renderer.getClearColor(new Color()), alpha = renderer.getClearAlpha(), target = renderer.getRenderTarget();
    try {
      scene.background = scene.overrideMaterial = null;
      renderer.autoClear = renderer.shadowMap.autoUpdate = false;
      renderer.setRenderTarget(this.surfaces);
      renderer.setClearColor(0, 0);
      renderer.clear();
      renderer.render(scene, this.camera);
    } finally {
      for (const [object, material, mask] of swapped) [object.material, object.layers.mask] = [material, mask];
      Object.assign(scene, { background, overrideMaterial });
      renderer.autoClear = autoClear;
      renderer.shadowMap.autoUpdate = shadows;
      renderer.setClearColor(color, alpha);
      renderer.setRenderTarget(target);
    }
  }

  /** Returns the unit vector to the key light in view space, or undefined if the scene has none. */
  keyLight() {
    let from = this.light;
    if (!from) this.scene.traverseVisible((object) => { if (object.isDirectionalLight) from ??= object; });
    if (!from) return undefined;
    // A light without a target, such as a point light, shines on the middle of the scene.
    const world = from.isVector3 ? from.clone() : from.getWorldPosition(new Vector3()).sub(from.target?.getWorldPosition(new Vector3()) ?? this.bounds.center);
    return world.transformDirection(this.camera.matrixWorldInverse).toArray();
  }

  /** Runs the effect of the look, and returns its textures; `textures`: inputs besides depth. */
  shade(renderer, width, height, beauty) {
    const { camera, look } = this, raw = (texture) => renderer.properties.get(texture).__webglTexture;
    if (!LOOKS[look]) throw new Error(`UmbragePass: there is no look '${look}'; looks are ${Object.keys(LOOKS).join(", ")}.`);
    if (!["picture", "ao"].includes(this.output)) throw new Error(`UmbragePass: output is 'picture' or 'ao', not '${this.output}'.`);
    if (!(this.radius >= 0)) throw new Error(`UmbragePass: the radius is 0 or above, not ${this.radius}.`);
    if (this.depthTexture && look != "ao") throw new Error(`UmbragePass: depthTexture suffices for the look 'ao' only; '${look}' needs the colours of surfaces.`);
    const key = `${look} ${this.halfResolution}`;
    if (this.key != key) {
      this.effect?.dispose();
      this.effect = createEffect(renderer.getContext(), LOOKS[look], { halfResolution: this.halfResolution });
      this.key = key;
    }
    if (!this.bounds) this.updateBounds();
    const textures = {};
    if (!this.depthTexture) {
      this.drawSurfaces(renderer, width, height);
      [textures.albedo, textures.normal] = this.surfaces.textures.map(raw);
      textures.direct = raw(beauty);
    }
    const centre = -this.bounds.center.clone().applyMatrix4(camera.matrixWorldInverse).z, { radius } = this.bounds;
    const depthMin = Math.max(centre - radius, camera.near), depthMax = Math.max(Math.min(centre + radius, camera.far), 1.01 * depthMin);
    const { reversedDepthBuffer: reversed = false, logarithmicDepthBuffer } = renderer.capabilities;
    return this.effect.render({
      width, height, textures, reversed, depth: raw(this.depthTexture ?? this.surfaces.depthTexture), projection: camera.projectionMatrix.elements,
      logarithmic: logarithmicDepthBuffer ? camera.far : 0, radius: this.radius || 0.1 * radius,
      view: { depthMin, depthMax, light: look == "toon" ? this.keyLight() : undefined } });
  }

  render(renderer, writeBuffer, readBuffer) {
    const { width, height, texture } = readBuffer, { uniforms } = this.quad.material;
    if (!(width > 0 && height > 0)) return;  // of a hidden page
    const shaded = this.shade(renderer, width, height, texture);
    for (const [name, external] of Object.entries(this.outputs)) external.sourceTexture = shaded[name] ?? shaded.ao;
    uniforms.beauty.value = texture;
    [uniforms.albedo.value, uniforms.surface.value] = this.depthTexture ? [texture, texture] : this.surfaces.textures;
    uniforms.look.value = Object.keys(LOOKS).indexOf(this.look);
    uniforms.shown.value = this.output == "ao" ? 1 : 0;
    uniforms.lineColor.value.set(this.lineColor);
    for (const name of ["intensity", "bleeding", "lineOpacity"]) uniforms[name].value = this[name];
    renderer.setRenderTarget(this.renderToScreen ? null : writeBuffer);
    this.quad.render(renderer);
  }

  dispose() {
    for (const part of [this.effect, this.surfaces?.depthTexture, this.surfaces, this.hidden, ...this.materials.values(), this.quad.material, this.quad]) part?.dispose();
    this.effect = this.key = this.surfaces = null;
    this.materials.clear();
  }
}
