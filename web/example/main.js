// The example: a room, drawn with UmbragePass left of the divider and with N8AO right of it.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { EffectComposer } from "three/addons/postprocessing/EffectComposer.js";
import { RenderPass } from "three/addons/postprocessing/RenderPass.js";
import { OutputPass } from "three/addons/postprocessing/OutputPass.js";
import { N8AOPass } from "n8ao";
import { UmbragePass } from "../src/three.js";
import { makeCamera, makeScene } from "../test/scene.js";

const renderer = new THREE.WebGLRenderer();
renderer.shadowMap.enabled = true;
document.body.prepend(renderer.domElement);
const { scene, knot } = makeScene(), camera = makeCamera(1);
const controls = new OrbitControls(camera, renderer.domElement);
controls.target.set(0, 0.9, -0.6);

const pass = new UmbragePass(scene, camera), other = new N8AOPass(scene, camera);
const left = new EffectComposer(renderer), right = new EffectComposer(renderer);
left.addPass(new RenderPass(scene, camera));
for (const [composer, added] of [[left, pass], [right, other]]) {
  composer.addPass(added);
  composer.addPass(new OutputPass());
}
other.configuration.gammaCorrection = false;

const form = document.getElementById("options"), divider = document.getElementById("divider");
let place = 0.5, last = performance.now(), mean = 0;
divider.onpointerdown = (event) => divider.setPointerCapture(event.pointerId);
divider.onpointermove = (event) => { if (divider.hasPointerCapture(event.pointerId)) place = Math.min(Math.max(event.clientX / innerWidth, 0), 1); };

form.oninput = () => {
  for (const input of form.querySelectorAll("input[type=range]")) input.nextElementSibling.value = (+input.value).toFixed(2);
  const alone = form.alone.checked;
  Object.assign(pass, { look: form.look.value, radius: +form.radius.value, intensity: +form.intensity.value, bleeding: +form.bleeding.value,
                        halfResolution: form.halfResolution.checked, output: alone ? "ao" : "picture" });
  Object.assign(other.configuration, { aoRadius: pass.radius, intensity: 5 * pass.intensity, halfRes: pass.halfResolution });
  other.setDisplayMode(alone ? "AO" : "Combined");
};

window.onresize = () => {
  renderer.setSize(innerWidth, innerHeight, false);
  for (const composer of [left, right]) composer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
};

window.drawn = 0;
function frame(now) {
  controls.update();
  if (form.turn.checked) knot.rotation.y += (now - last) / 2000;
  document.getElementById("time").value = `${(mean += (now - last - mean) * 0.05).toFixed(0)} ms`;
  last = now;
  const edge = Math.round(place * innerWidth);
  divider.style.left = edge + "px";
  renderer.setScissorTest(true);
  for (const [composer, from, width] of [[left, 0, edge], [right, edge, innerWidth - edge]]) {
    renderer.setScissor(from, 0, width, innerHeight);
    if (width) composer.render();
  }
  ++window.drawn;
  requestAnimationFrame(frame);
}
window.onresize();
form.oninput();
requestAnimationFrame(frame);
