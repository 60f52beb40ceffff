// Pointer, wheel, touch and keys. `act` has the actions:
//   gesture(change): camera -> camera, with (size, scene); flat(dx, dy, factor, at) of a G-buffer; pivot(at); click(at);
//   hold(is_held): Shift; tap(name): a key of flying that was let go at once; key(event) and command(event), the latter
//   with Ctrl: return whether the key has a meaning; fly(move): right, up and forward, of this instant.
import { by_id, is_typed, keep, kept } from "./dom.js";
import { size_shown } from "./stage.js";
import { orbited, panned, zoomed } from "./camera.js";
import { is_flat } from "./state.js";
import { clamp } from "./math.js";

const kWheelPerPixel = 0.0015, // logarithm of the zoom factor; 15 % for the usual notch of 100 pixels
  kPixelsPerLine = 33, // of wheels that count lines, 3 of which are a notch
  kPixelsPerPage = 400,
  kMaxPixels = 400, // of one event, which a fast wheel exceeds
  kPinchFactor = 6, // a pinch on a touchpad comes as a wheel with Ctrl, in small steps
  kMaxStep_s = 0.1, // of flying: a late frame makes no leap
  kMaxClick = 4, // movement of a press that is no drag, CSS pixels
  kHold_ms = 160,
  kFlyPerSecond = 0.7;
const kFlyKeys = { w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], r: [0, 1, 0], v: [0, -1, 0] };

function place_in_picture(event) {
  const box = by_id("picture").getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

function zoom_by(act, factor, at) {
  if (is_flat()) act.flat(0, 0, 1 / factor, at);
  else act.gesture((camera, size, scene) => zoomed(camera, at, factor, size, scene));
}

function pan_by(act, dx, dy) {
  if (is_flat()) act.flat(dx, dy, 1, null);
  else act.gesture((camera, size) => panned(camera, dx, dy, size));
}

/// Two fingers move and zoom together.
function pinch(act, points, event) {
  const [a, b] = [...points.values()];
  const before = { middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], span: Math.hypot(a[0] - b[0], a[1] - b[1]) };
  points.set(event.pointerId, place_in_picture(event));
  const [c, d] = [...points.values()];
  const middle = [(c[0] + d[0]) / 2, (c[1] + d[1]) / 2],
    span = Math.hypot(c[0] - d[0], c[1] - d[1]);
  pan_by(act, middle[0] - before.middle[0], middle[1] - before.middle[1]);
  if (before.span > 0 && span > 0) zoom_by(act, before.span / span, middle);
}

function attach_pointer(act, shift) {
  const canvas = by_id("picture"),
    points = new Map();
  let button = 0,
    is_pan = false,
    began = [0, 0];
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    began = place_in_picture(event);
    points.set(event.pointerId, began);
    button = event.button;
    is_pan = button === 2 || event.shiftKey;
    if (is_pan) shift.cancel();
    if (button === 1) event.preventDefault(); // no automatic scrolling
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = points.get(event.pointerId);
    if (!before) return;
    if (points.size === 2) return pinch(act, points, event);
    const now = place_in_picture(event),
      dx = now[0] - before[0],
      dy = now[1] - before[1];
    points.set(event.pointerId, now);
    if (points.size > 2 || (dx === 0 && dy === 0)) return;
    if (is_pan || is_flat()) pan_by(act, dx, dy);
    else act.gesture((camera, size, scene) => orbited(camera, dx, dy, size, scene));
  });
  const release = (event) => points.delete(event.pointerId);
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("lostpointercapture", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("click", (event) => {
    const [x, y] = place_in_picture(event);
    if (Math.hypot(x - began[0], y - began[1]) < kMaxClick) act.click([x, y]);
  });
  canvas.addEventListener("dblclick", (event) => act.pivot(place_in_picture(event)));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const unit = [1, kPixelsPerLine, kPixelsPerPage][event.deltaMode];
      const pixels = clamp(event.deltaY * unit, -kMaxPixels, kMaxPixels) * (event.ctrlKey ? kPinchFactor : 1);
      zoom_by(act, Math.exp(pixels * kWheelPerPixel), place_in_picture(event));
    },
    { passive: false },
  );
}

/// Shift alone, held for a moment, shows B; with a drag or another key it does not.
function new_shift(act) {
  let timer = 0,
    is_held = false;
  const set = (is_now) => {
    clearTimeout(timer);
    if (is_now !== is_held) act.hold((is_held = is_now));
  };
  return {
    down: () => {
      clearTimeout(timer);
      timer = setTimeout(() => set(true), kHold_ms);
    },
    up: () => set(false),
    cancel: () => set(false),
  };
}

/// Flying: the held keys move the camera every frame. `A` starts after a moment, since a tap has another meaning.
function new_flight(act) {
  const held = new Map();
  let last = 0,
    running = 0;
  const step = (now) => {
    const seconds = Math.min(kMaxStep_s, (now - last) / 1000),
      move = [0, 0, 0];
    last = now;
    for (const [name, since] of held) {
      if (name === "a" && held.size === 1 && performance.now() - since < kHold_ms) continue;
      kFlyKeys[name].forEach((x, i) => (move[i] += x * seconds * kFlyPerSecond));
    }
    if (move.some((x) => x !== 0)) act.fly(move);
    running = held.size ? requestAnimationFrame(step) : 0;
  };
  return {
    down: (name) => {
      if (!held.has(name)) held.set(name, performance.now());
      if (running) return;
      last = performance.now();
      running = requestAnimationFrame(step);
    },
    /// Returns whether the key was only tapped.
    up: (name) => {
      const since = held.get(name);
      held.delete(name);
      return since !== undefined && performance.now() - since < kHold_ms;
    },
    stop: () => held.clear(),
  };
}

/// Returns what of the keyboard belongs to the focused control: "all", "some" (arrows, Enter, Space) or "none".
function taken_by(target) {
  if (!(target instanceof Element) || target.id === "picture" || target === document.body) return "none";
  if (target.matches("select, textarea, input:not([type=range], [type=checkbox], [type=radio], [type=color])"))
    return "all";
  return target.closest("button, input, summary, [role=slider], a, pre, dialog") ? "some" : "none";
}

const kNative = /^(Enter| |Tab|Home|End|PageUp|PageDown|Arrow.*)$/;

function attach_keys(act, shift) {
  const flight = new_flight(act);
  addEventListener("keydown", (event) => {
    const taken = taken_by(event.target);
    const types = taken === "all" && !event.target.matches("select");
    const is_command = (event.ctrlKey || event.metaKey) && !event.altKey;
    if (event.key === "Shift" && !types && !event.repeat && !is_command) return shift.down();
    shift.cancel();
    // In a text that is being typed, Undo and Redo are the browser's.
    const is_text_key = is_typed(event.target) && event.key.toLowerCase() !== "s";
    if (is_command && !is_text_key && !document.querySelector("dialog[open]") && act.command(event)) {
      event.preventDefault();
      return;
    }
    if (event.key === "Escape" && !document.querySelector("dialog[open]")) return by_id("picture").focus();
    if (taken === "all" || (taken === "some" && kNative.test(event.key)) || event.altKey || event.metaKey) return;
    if (document.querySelector("dialog[open]") && event.key.toLowerCase() !== "h") return;
    const name = event.key.toLowerCase();
    if (!event.ctrlKey && kFlyKeys[name] && !is_flat()) {
      event.preventDefault();
      return flight.down(name);
    }
    if (act.key(event)) event.preventDefault();
  });
  addEventListener("keyup", (event) => {
    if (event.key === "Shift") shift.up();
    if (flight.up(event.key.toLowerCase())) act.tap(event.key.toLowerCase());
  });
  addEventListener("blur", () => {
    flight.stop();
    shift.cancel();
  });
}

/// Says how to move the view, until the first gesture on the first visit.
function attach_hint() {
  const picture = by_id("picture"),
    hint = by_id("hint");
  const end = () => {
    if (!hint.hidden) keep("hint", "seen");
    hint.hidden = true;
  };
  hint.hidden = kept("hint") !== "";
  by_id("hint_close").addEventListener("click", end);
  picture.addEventListener("pointermove", (event) => event.buttons && end());
  picture.addEventListener("wheel", end, { passive: true });
}

export function attach_hands(act) {
  attach_hint();
  const shift = new_shift(act);
  attach_pointer(act, shift);
  attach_keys(act, shift);
}

/// Orbits by the steps dx and dy of an arrow key, or moves, which is all that a G-buffer does.
export function move_by_key(act, dx, dy, is_pan) {
  const size = size_shown(),
    step = Math.min(size[0], size[1]) / 24;
  if (is_pan || is_flat()) pan_by(act, -dx * step, -dy * step);
  else act.gesture((camera, shown, scene) => orbited(camera, dx * step, dy * step, shown, scene));
}

export const zoom_by_key = (act, factor) =>
  zoom_by(
    act,
    factor,
    size_shown().map((side) => side / 2),
  );
