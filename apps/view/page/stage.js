// The picture: decodes frames and draws them, one side or both in comparison.
import { by_id, is_calm } from "./dom.js";
import { state, is_flat, scene_now, side_b, technique_of, look_of } from "./state.js";
import { name_of, device_name } from "./names.js";
import { draw_measure } from "./measure.js";
import { clamp } from "./math.js";

const kMaxPixelRatio = 2,
  kMinSide = 16,
  kMaxSide = 8192;
const kFlicker_ms = 500,
  kCalmFlicker_ms = 1200;

/// `pictures`: the newest frame of each side, {bitmap, header}. `is_held`: B is shown while a key is held. `wants_b`: B is
/// kept after that, until the state changes. `b_after`: B belongs to the state shown only in frames of a later id.
/// `sent`: the newest state, {id, moving, size, model, views}; `since`: for each side, the state since which it shows the same;
/// Infinity: no state shows it.
export const stage = {
  pictures: [null, null],
  is_held: false,
  wants_b: false,
  b_after: 0,
  phase: 0,
  frames: 0,
  last: null,
  sent: null,
  since: [Infinity, Infinity],
};

const needs_canvas = () => by_id("picture");

/// Returns the size of the picture to ask for, device pixels.
export function size_asked() {
  const canvas = needs_canvas();
  const size = is_flat() ? (scene_now()?.size ?? [canvas.width, canvas.height]) : [canvas.width, canvas.height];
  return size.map((side) => clamp(Math.round(side), kMinSide, kMaxSide));
}

/// Returns the size of the picture on the page, CSS pixels.
export function size_shown() {
  const box = needs_canvas().getBoundingClientRect();
  return [Math.max(1, box.width), Math.max(1, box.height)];
}

/// Calls `resized` whenever the canvas has got another size.
export function watch_size(resized) {
  const fit = () => {
    const canvas = needs_canvas(),
      ratio = Math.min(devicePixelRatio || 1, kMaxPixelRatio);
    const box = by_id("stage").getBoundingClientRect();
    const width = Math.max(kMinSide, Math.round(box.width * ratio)),
      height = Math.max(kMinSide, Math.round(box.height * ratio));
    if (canvas.width === width && canvas.height === height) return;
    canvas.width = width;
    canvas.height = height;
    draw();
    resized();
  };
  new ResizeObserver(fit).observe(by_id("stage"));
  fit();
}

export const needs_b = () => state.compare !== "off" || stage.is_held || stage.wants_b;

/// Takes note of a state before it is sent. A side that shows the same as before goes on: the program begins nothing anew,
/// and frames that come for the state before count as frames of this one.
export function note_state(sent) {
  const before = stage.sent;
  const shown = ({ size, model, views }, side) => JSON.stringify([size, model, views[side]]);
  stage.sent = structuredClone(sent);
  stage.since[1] = sent.views.length > 1 ? stage.since[1] : Infinity;
  for (const side of sent.views.keys()) {
    const view = sent.views[side];
    const is_known = !!before && !before.moving && stage.since[side] < Infinity;
    view.goes_on = is_known && !sent.moving && shown(before, side) === shown(stage.sent, side);
    if (!view.goes_on) stage.since[side] = sent.id;
    if (stage.pictures[side]) relabel(stage.pictures[side].header);
  }
}

/// Returns the newest state that shows a side as the state `id` does.
export const newest_id = (id, side) => (id >= stage.since[side] ? stage.sent.id : id);

function relabel(header) {
  header.id = newest_id(header.id, header.view);
}

/// Forgets what was sent, before a new connection: nothing goes on.
export function forget_sent() {
  stage.sent = null;
  stage.since = [Infinity, Infinity];
}

/// Decodes and draws a frame, unless a newer one is shown. `shown(header)` is called in either case.
export async function show_frame(header, blob, shown) {
  let bitmap = null;
  try {
    bitmap = await createImageBitmap(blob);
  } finally {
    relabel(header);
    const old = stage.pictures[header.view];
    const is_wanted = header.view === 0 || header.id > stage.b_after;
    const is_newer =
      bitmap &&
      is_wanted &&
      (!old || header.id > old.header.id || (header.id === old.header.id && header.frame > old.header.frame));
    if (is_newer) {
      old?.bitmap.close();
      stage.pictures[header.view] = { bitmap, header };
      stage.frames += 1;
      if (header.view === 0) stage.last = header;
      draw();
    } else {
      bitmap?.close();
    }
    shown(header, !!is_newer);
  }
}

/// Drops the picture of B, and those that come for states up to `id`: they show another camera or other settings.
export function forget_b(id) {
  stage.pictures[1]?.bitmap.close();
  stage.pictures[1] = null;
  stage.b_after = id;
  stage.since[1] = Infinity;
}

/// Returns the place of a bitmap on the canvas: [x, y, width, height].
function place_of(bitmap, canvas) {
  if (is_flat()) {
    const fit = Math.min(canvas.width / bitmap.width, canvas.height / bitmap.height) * state.flat.scale;
    const width = bitmap.width * fit,
      height = bitmap.height * fit;
    const ratio = canvas.width / size_shown()[0];
    return [
      (canvas.width - width) / 2 + state.flat.x * ratio,
      (canvas.height - height) / 2 + state.flat.y * ratio,
      width,
      height,
    ];
  }
  const width = (bitmap.width / bitmap.height) * canvas.height;
  if (Math.abs(width / canvas.width - 1) < 0.03) return [0, 0, canvas.width, canvas.height];
  return [(canvas.width - width) / 2, 0, width, canvas.height];
}

function put(pen, picture) {
  if (!picture) return;
  const [x, y, width, height] = place_of(picture.bitmap, pen.canvas);
  pen.imageSmoothingEnabled = !is_flat() || width < 2 * picture.bitmap.width;
  pen.imageSmoothingQuality = picture.header.moving ? "low" : "high";
  pen.drawImage(picture.bitmap, x, y, width, height);
}

/// Draws the absolute difference times the gain, a power of 2.
function put_difference(pen, a, b) {
  pen.fillStyle = "#000";
  pen.fillRect(0, 0, pen.canvas.width, pen.canvas.height);
  put(pen, a);
  pen.globalCompositeOperation = "difference";
  put(pen, b);
  pen.globalCompositeOperation = "lighter";
  for (let gain = 1; gain < state.gain; gain *= 2) pen.drawImage(pen.canvas, 0, 0);
  pen.globalCompositeOperation = "source-over";
}

/// Returns which sides are seen now: "a", "b", "divider" or "difference".
export function seen_now() {
  if (stage.is_held) return state.compare === "b" ? "a" : "b";
  if (state.compare === "flicker") return stage.phase ? "b" : "a";
  return state.compare === "off" ? "a" : state.compare;
}

export function draw() {
  const canvas = needs_canvas(),
    pen = canvas.getContext("2d"),
    [a, b] = stage.pictures;
  const seen = seen_now();
  pen.clearRect(0, 0, canvas.width, canvas.height);
  if (seen === "difference" && a && b) put_difference(pen, a, b);
  else put(pen, seen === "b" ? (b ?? a) : (a ?? b));
  if (seen === "divider" && b) {
    const x = Math.round(state.split * canvas.width);
    pen.save();
    pen.beginPath();
    pen.rect(x, 0, canvas.width - x, canvas.height);
    pen.clip();
    pen.clearRect(x, 0, canvas.width - x, canvas.height);
    put(pen, b);
    pen.restore();
  }
  draw_measure(size_shown());
  draw_tags(seen, !b || (!!a && !a.header.moving && b.header.id < a.header.id));
}

function name_of_side(side) {
  const technique = technique_of(side),
    what = side.show !== "picture" ? name_of("show", side.show) : technique && name_of("effect", technique);
  const look = look_of(side)?.name;
  return [look && name_of("look", look), what, side.options.quality, device_name(side.device)].filter(Boolean).join(" · ");
}

/// `is_late`: the picture of B is missing or older than that of A.
function draw_tags(seen, is_late) {
  const show = (id, is_seen, text) => {
    const tag = by_id(id);
    tag.hidden = !is_seen;
    if (tag.textContent !== text) tag.textContent = text;
  };
  const is_compared = needs_b() && (stage.is_held || state.compare !== "off");
  show("tag_a", is_compared && seen !== "b", "A  " + name_of_side(state.a));
  show("tag_b", is_compared && seen !== "a", "B  " + name_of_side(side_b()) + (is_late ? " is being drawn" : ""));
  by_id("divider").hidden = seen !== "divider";
  by_id("divider").style.left = `${state.split * 100}%`;
  by_id("divider").setAttribute("aria-valuenow", Math.round(state.split * 100));
  needs_canvas().classList.toggle("see_through", state.a.options["no-background"] === "true");
}

/// Starts or stops to flicker.
export function update_flicker() {
  const is_on = state.compare === "flicker" && !document.hidden;
  if (is_on === !!update_flicker.timer) return;
  clearInterval(update_flicker.timer);
  update_flicker.timer =
    is_on &&
    setInterval(
      () => {
        stage.phase = 1 - stage.phase;
        draw();
      },
      is_calm() ? kCalmFlicker_ms : kFlicker_ms,
    );
}

/// Makes the divider follow pointer and arrow keys.
export function attach_divider(changed) {
  const divider = by_id("divider");
  const set = (split) => {
    state.split = clamp(split, 0, 1);
    draw();
    changed();
  };
  divider.addEventListener("pointerdown", (event) => {
    divider.setPointerCapture(event.pointerId);
    event.stopPropagation();
  });
  divider.addEventListener("pointermove", (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    const box = by_id("stage").getBoundingClientRect();
    set((event.clientX - box.left) / box.width);
  });
  divider.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
    if (!step || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    set(state.split + step);
  });
}
