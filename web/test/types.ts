import { PerspectiveCamera, Scene } from "three";
import { createEffect, kits } from "../src/core.js";
import { UmbragePass } from "../src/three.js";

const pass = new UmbragePass(new Scene(), new PerspectiveCamera(), { look: "toon", radius: 0.5, halfResolution: true });
pass.lineColor.set("navy");
// @ts-expect-error: there is no such look
pass.look = "cartoon";
const effect = createEffect({} as WebGL2RenderingContext, [kits.ao, kits.outline], { halfResolution: true });
export const ao: WebGLTexture = effect.render({ width: 4, height: 4, projection: new Float32Array(16), depth: null, radius: 1 }).ao;
// @ts-expect-error: a picture has a height
effect.render({ width: 4, projection: [] });
