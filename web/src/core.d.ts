/** A generated kit: its passes, the functions that fill its uniform blocks, and its shaders. */
export interface Kit { kit: object; frames: Record<string, (view: object, round: number) => ArrayBuffer>; reducedView: (view: object, factor: number) => object; sources: Record<string, string>; half?: string }

/** The kits in this package. */
export const kits: Record<"ao" | "aoHalf" | "bleeding" | "bleedingHalf" | "normals" | "toon" | "outline", Kit>;

export interface EffectOptions {
  /** Computes occlusion and bleeding for a quarter of the pixels and upsamples them along surfaces. Default false. */
  halfResolution?: boolean;
}

export interface RenderInput {
  width: number;
  height: number;
  /** The camera's projection matrix, column-major. It may be off-centre, orthographic, or with infinite far plane. */
  projection: ArrayLike<number>;
  /** A depth texture, of 16, 24 or 32 bits; or `framebuffer`, or `linearDepth`. */
  depth?: WebGLTexture | null;
  /** A framebuffer, also of several samples a pixel, whose depth is read; null: the canvas. */
  framebuffer?: WebGLFramebuffer | null;
  /** Distance along the view axis in the red channel, scene units; 0: background. */
  linearDepth?: WebGLTexture | null;
  /** Depth 1 is near and 0 far. The depth of the matrix is then 0 to 1, unless `zeroToOne` is false. */
  reversed?: boolean;
  /** Normalized device depth is 0 to 1 (EXT_clip_control). Default: `reversed`. */
  zeroToOne?: boolean;
  /** The far plane if depth is logarithmic, as that of three.js: log2(depth + 1) / log2(far + 1). 0: it is not. */
  logarithmic?: number;
  /** Radius of occlusion, scene units. Default 1. */
  radius?: number;
  /** Inputs of the kits by name: normal, albedo, direct, shadow ... Without `normal`, normals are those of depth. */
  textures?: Record<string, WebGLTexture | null>;
  /** What `textures.normal` holds, in view space: components from -1 to 1 (default), 0 to 1, or octahedral in red and green, 0 to 1. */
  normals?: "signed" | "unsigned" | "octahedral";
  /** For outlines, the depths of the scene; for toon, the unit vector to the light in view space. */
  view?: { depthMin?: number; depthMax?: number; light?: number[] };
}

export interface Effect {
  /** Returns textures by name: depth, normal, and what the kits write: ao, indirect, lit, outline. Valid until the next call. */
  render(input: RenderInput): Record<string, WebGLTexture>;
  /** Frees the textures of another size. */
  resize(width: number, height: number): void;
  /** Frees all GL objects. */
  dispose(): void;
}

/** Returns an effect that runs a kit, or several in order. Throws an Error with a sentence if the context lacks what it needs. */
export function createEffect(gl: WebGL2RenderingContext, kit: Kit | Kit[], options?: EffectOptions): Effect;
