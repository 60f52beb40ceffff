import type { Camera, Color, ColorRepresentation, DepthTexture, DirectionalLight, Scene, Vector3 } from "three";
import { Pass } from "three/addons/postprocessing/Pass.js";
export { createEffect, kits } from "./core.js";

export interface UmbragePassOptions {
  /** ao: occlusion darkens the picture; bleeding: also light from coloured surfaces; toon: tone steps and outlines. Default ao. */
  look?: "ao" | "bleeding" | "toon";
  /** Radius of occlusion, world units; 0 (default): a tenth of the scene's bounding sphere. */
  radius?: number;
  /** Factor of the occlusion in the looks ao and bleeding, default 1. */
  intensity?: number;
  /** Factor of the light from other surfaces, default 1. */
  bleeding?: number;
  /** Default false. */
  halfResolution?: boolean;
  /** Colour (default black) and opacity (default 1) of outlines. */
  lineColor?: ColorRepresentation;
  lineOpacity?: number;
  /** The light of the look toon: a light, or the direction to it in world space. Default: the scene's first DirectionalLight. */
  light?: DirectionalLight | Vector3 | null;
  /** picture (default), or ao: the occlusion alone. */
  output?: "picture" | "ao";
  /** Depth that another pass has drawn at the composer's size; then the scene is not drawn again. Look ao only. */
  depthTexture?: DepthTexture | null;
}

/** Shades what the passes before have drawn. All options are properties that can change between frames. */
export class UmbragePass extends Pass {
  constructor(scene: Scene, camera: Camera, options?: UmbragePassOptions);
  scene: Scene;
  camera: Camera;
  /** Measures the scene anew: its size gives the default radius and the depth range of outlines. */
  updateBounds(): void;
}
export interface UmbragePass extends Required<Omit<UmbragePassOptions, "lineColor">> { lineColor: Color }
