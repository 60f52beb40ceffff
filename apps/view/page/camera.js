// The camera, and all gestures on it as pure functions. A camera keeps its own axes, so that no direction is special:
// {focal, right, up, back: unit axes, back points from the focal point to the eye, distance, angle_deg, orthographic}.
// A scene is {center, radius, up}; sizes are [width, height] of the picture and dx, dy, x, y are in the same unit, from
// the upper left corner.
import { plus, minus, times, dot, cross, length, unit, turned, perpendicular, parse_vector, number_text, vector_text, clamp, degrees, radians } from "./math.js";

const kOrbitPerSide = Math.PI; // angle of a drag over the shorter side of the picture
const kMargin = 1.0; // of the bounding sphere, which few models fill

export const eye_of = (camera) => plus(camera.focal, times(camera.back, camera.distance));

/// Returns the width and height of the plane through the focal point that the picture shows, scene units.
export function window_of(camera, size) {
  const height = 2 * camera.distance * Math.tan(radians(camera.angle_deg) / 2);
  return [(height * size[0]) / size[1], height];
}

/// Returns the camera of the options camera-position and so on, or null if they do not define one.
export function camera_from(options) {
  const eye = parse_vector(options["camera-position"]),
    focal = parse_vector(options["camera-focal-point"]);
  const angle_deg = Number(options["camera-view-angle"] ?? 30);
  if (!eye || !focal || !(angle_deg > 0)) return null;
  const distance = length(minus(eye, focal));
  if (!(distance > 0)) return null;
  const back = unit(minus(eye, focal));
  const up = perpendicular(parse_vector(options["camera-view-up"]) ?? [0, 1, 0], back);
  const orthographic = options["camera-orthographic"] === "true";
  return { focal, back, up, right: cross(up, back), distance, angle_deg, orthographic };
}

/// Returns the options of a camera. Numbers have 7 significant digits of the scene's radius or of the distance.
export function camera_options(camera, scene) {
  const scale = Math.min(scene.radius, camera.distance);
  return {
    "camera-position": vector_text(eye_of(camera), scale),
    "camera-focal-point": vector_text(camera.focal, scale),
    "camera-view-up": vector_text(camera.up, 1),
    "camera-view-angle": number_text(camera.angle_deg, 1000),
    "camera-orthographic": camera.orthographic ? "true" : "false",
  };
}

/// Returns the camera with axes made orthonormal again, which rounding would otherwise lose.
function straightened(camera) {
  const back = unit(camera.back),
    up = perpendicular(camera.up, back);
  return { ...camera, back, up, right: cross(up, back) };
}

function turned_camera(camera, axis, angle_rad) {
  const turn = (a) => turned(a, axis, angle_rad);
  return straightened({ ...camera, back: turn(camera.back), up: turn(camera.up), right: turn(camera.right) });
}

/// Turns about the camera's own right, across the poles, and then about the up direction of the scene; in the other order
/// the right of before would tilt the camera.
export function orbited(camera, dx, dy, size, scene) {
  const per_pixel = kOrbitPerSide / Math.min(size[0], size[1]);
  const sign = dot(camera.up, scene.up) < -1e-6 ? -1 : 1;
  return turned_camera(turned_camera(camera, camera.right, -dy * per_pixel), scene.up, -dx * per_pixel * sign);
}

/// Moves the camera so that the plane through the focal point follows the pointer.
export function panned(camera, dx, dy, size) {
  const per_pixel = window_of(camera, size)[1] / size[1];
  const move = plus(times(camera.right, -dx * per_pixel), times(camera.up, dy * per_pixel));
  return { ...camera, focal: plus(camera.focal, move) };
}

/// Returns the point under a pixel on the plane through the focal point.
export function point_under(camera, at, size) {
  const [width, height] = window_of(camera, size);
  const x = (at[0] / size[0] - 0.5) * width,
    y = (0.5 - at[1] / size[1]) * height;
  return plus(camera.focal, plus(times(camera.right, x), times(camera.up, y)));
}

/// Returns the place of a point in the picture, or null if it is not in front of the camera.
export function place_of_point(camera, point, size) {
  const [width, height] = window_of(camera, size),
    from_focal = minus(point, camera.focal);
  const nearer = camera.orthographic ? 1 : 1 - dot(from_focal, camera.back) / camera.distance;
  if (!(nearer > 0)) return null;
  const x = dot(from_focal, camera.right) / (width * nearer),
    y = dot(from_focal, camera.up) / (height * nearer);
  return [(0.5 + x) * size[0], (0.5 - y) * size[1]];
}

/// Multiplies the distance by `factor`; the point under `at` stays where it is in the picture.
export function zoomed(camera, at, factor, size, scene) {
  const distance = clamp(camera.distance * factor, scene.radius * 1e-5, scene.radius * 1e4);
  const point = point_under(camera, at, size);
  const focal = plus(point, times(minus(camera.focal, point), distance / camera.distance));
  return { ...camera, focal, distance };
}

/// Makes `point` the one that the camera turns about, without a change of the view direction.
export const with_pivot = (camera, point) => ({ ...camera, focal: point });

/// Moves the eye and the focal point; `move`: right, up and forward in units of the distance.
export function flown(camera, move) {
  const step = plus(times(camera.right, move[0]), plus(times(camera.up, move[1]), times(camera.back, -move[2])));
  return { ...camera, focal: plus(camera.focal, times(step, camera.distance)) };
}

/// Shows the whole scene from the same direction.
export function fitted(camera, size, scene) {
  const half = radians(camera.angle_deg) / 2;
  const narrow = Math.atan(Math.tan(half) * Math.min(1, size[0] / size[1]));
  const radius = scene.radius * kMargin;
  const distance = camera.orthographic ? radius / Math.tan(narrow) : radius / Math.sin(narrow);
  return { ...camera, focal: scene.center, distance };
}

/// Returns the camera with which a picture of `size` shows all that one of the size `seen` does, about the same middle.
export function framed(camera, size, seen) {
  const wider = seen[0] / seen[1] / (size[0] / size[1]);
  if (!(wider > 1 && Number.isFinite(wider))) return camera;
  return { ...camera, angle_deg: 2 * degrees(Math.atan(Math.tan(radians(camera.angle_deg) / 2) * wider)) };
}

/// Returns the axes of the model: its up direction, its front and its right side. Y up looks at +Z, Z up at -Y.
export function model_axes(up) {
  const front = Math.abs(up[2]) > 0.9 ? [0, -Math.sign(up[2]), 0] : perpendicular([0, 0, 1], up);
  return { up, front, right: cross(up, front) };
}

/// Looks at the whole scene along an axis: "front", "right", "top" or "corner". A camera that does so already is turned
/// to the opposite side.
export function viewed_from(camera, name, size, scene) {
  const { up, front, right } = model_axes(scene.up);
  const corner = unit(plus(plus(times(front, 0.8), times(right, 0.6)), times(up, 0.5)));
  let back = { front, right, top: up, corner }[name];
  if (dot(back, camera.back) > 1 - 1e-9) back = times(back, -1);
  const above = perpendicular(name === "top" ? times(front, -1) : up, back);
  return fitted({ ...camera, back, up: above, right: cross(above, back) }, size, scene);
}
