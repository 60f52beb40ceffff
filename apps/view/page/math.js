// Vectors of three doubles as arrays, and numbers as text.

export const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const clamp = (x, min, max) => Math.min(max, Math.max(min, x));
export const radians = (degrees) => (degrees * Math.PI) / 180;
export const degrees = (radians) => (radians * 180) / Math.PI;

/// Returns a / |a|, or `otherwise` for the zero vector.
export function unit(a, otherwise = [0, 0, 1]) {
  const size = length(a);
  return size > 0 && Number.isFinite(size) ? times(a, 1 / size) : otherwise;
}

/// Returns `a` turned about a unit axis, counter-clockwise as seen from its tip.
export function turned(a, axis, angle_rad) {
  const c = Math.cos(angle_rad),
    s = Math.sin(angle_rad);
  return plus(plus(times(a, c), times(cross(axis, a), s)), times(axis, dot(axis, a) * (1 - c)));
}

/// Returns the part of `a` perpendicular to a unit axis, normalized; any perpendicular direction if there is none.
export function perpendicular(a, axis) {
  const rest = minus(a, times(axis, dot(a, axis)));
  if (length(rest) > 1e-9 * (length(a) + 1e-300)) return unit(rest);
  return unit(cross(axis, Math.abs(axis[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0]));
}

/// Parses "1,2.5,-3" or an axis such as "+Y". Returns null for anything else.
export function parse_vector(text) {
  const axis = /^([+-]?)([XYZ])$/i.exec(text ?? "");
  if (axis) {
    const sign = axis[1] === "-" ? -1 : 1;
    return ["X", "Y", "Z"].map((name) => (name === axis[2].toUpperCase() ? sign : 0));
  }
  const values = String(text ?? "")
    .split(",")
    .map((part) => (part.trim() === "" ? NaN : Number(part)));
  return values.length === 3 && values.every(Number.isFinite) ? values : null;
}

/// Returns a number with 7 significant digits of `scale`, without trailing zeros: a far origin keeps its digits.
export function number_text(value, scale) {
  const decimals = clamp(Math.ceil(7 - Math.log10(scale > 0 ? scale : 1)), 0, 100);
  const text = value.toFixed(decimals);
  const short = text.includes(".") && !text.includes("e") ? text.replace(/\.?0+$/, "") : text;
  return short === "-0" ? "0" : short;
}

export const vector_text = (a, scale) => a.map((x) => number_text(x, scale)).join(",");

/// Returns a value of a slider with 3 significant digits.
export const slider_text = (value) => String(Number(value.toPrecision(3)));
