// The page of `umbrage view`: connects the parts.
import { by_id, announce, complain, complain_of_unknown, forgive, element } from "./dom.js";
import { state, hooks, view_of, side_b, side_edited, scene_now, model_now, scene_for_camera, is_flat, fragment_of_state, take_fragment, home_camera } from "./state.js";
import { device_name } from "./names.js";
import { parse_vector, clamp } from "./math.js";
import { camera_from, flown, viewed_from, with_pivot, point_under } from "./camera.js";
import { new_link } from "./link.js";
import { stage, draw, show_frame, forget_b, forget_sent, newest_id, note_state, needs_b, size_asked, size_shown, watch_size, update_flicker, attach_divider } from "./stage.js";
import { is_measuring, toggle_measure, add_point, length_text } from "./measure.js";
import { make_panels, refresh_panels } from "./panels.js";
import { compare_section, refresh_compare } from "./compare.js";
import { times_section, note_time, draw_times, ms_text } from "./graph.js";
import { take_section, refresh_take, save } from "./take.js";
import { attach_search } from "./search.js";
import { attach_files, with_upload_names } from "./files.js";
import { attach_hands } from "./hands.js";
import { attach_steps, note_step } from "./steps.js";
import { press, press_command, toggle_anti_aliasing, attach_theme, toggle_panel, make_help } from "./keys.js";

const kFragment_ms = 300,
  kRate_ms = 1000,
  kPatience_ms = 400,
  kMinFlatScale = 0.1, // of a G-buffer, 1 fits the window: small enough to see all of its edge
  kMaxFlatScale = 64, // one pixel is a square that is easily seen
  kNarrow = "(max-width: 46em)";
const moving_times = [];
const refused = [0, 0];  // of each view, the last state that could not be drawn
let refresh_scheduled = 0,
  fragment_timer = 0,
  own_fragment = null,
  panels_are_flat,
  waiting_timer = 0;

const link = new_link(make_state, { sending: note_state, text: take_message, frame: take_frame, opened, closed });

// The scene that gestures use: with the up direction of the options.
const scene_of_hands = () => scene_for_camera(parse_vector(state.a.options.up));

function make_state() {
  if (!state.hello || !model_now()) return null;
  const views = [view_of(state.a)];
  if (needs_b()) views.push(view_of(side_b()));
  return { size: size_asked(), model: state.model, views };
}

/// Makes the panel for a model or for a G-buffer, which have different options.
function build_panels() {
  panels_are_flat = is_flat();
  const { first, groups, last } = make_panels();
  by_id("sections").replaceChildren(...first, compare_section(), ...groups, ...last, times_section(), take_section());
  by_id("section_times").addEventListener("toggle", draw_times);
}

function refresh() {
  refresh_scheduled = 0;
  if (!state.hello) return;
  if (panels_are_flat !== is_flat()) build_panels();
  refresh_panels();
  refresh_compare();
  refresh_take();
  draw();
}

function schedule_refresh() {
  if (!refresh_scheduled) refresh_scheduled = requestAnimationFrame(refresh);
}

function remember() {
  clearTimeout(fragment_timer);
  fragment_timer = setTimeout(() => {
    note_step();
    own_fragment = fragment_of_state();
    if (location.hash.slice(1) !== own_fragment)
      history.replaceState(null, "", own_fragment ? `#${own_fragment}` : location.pathname);
  }, kFragment_ms);
}

/// Takes the address, whose unknown entries are named and removed.
function take_address() {
  complain_of_unknown(take_fragment(location.hash), "The link");
}

/// B is no longer that of the state, unless it is drawn with it.
function leave_b() {
  if (!stage.is_held) stage.wants_b = false;
  if (!needs_b()) forget_b(link.id);
}

function changed(moving) {
  leave_b();
  link.changed(moving);
  expect_frame();
  schedule_refresh();
  remember();
}

function set_camera(camera, moving) {
  state.cameras.set(state.model, { ...camera, is_home: false });
  leave_b();
  link.changed(moving);
  expect_frame();
  remember();
}

let last_pick = {}; // the model whose point was asked for last, and what takes the answer

/// Asks which point of the model is at a place of the picture. `take` receives it, or null, unless the model changes.
function ask_point(at, take) {
  last_pick = { model: state.model, take };
  const size = size_shown();
  link.send({ type: "pick", id: link.id, at: [at[0] / size[0], at[1] / size[1]] });
}

const act = {
  gesture(change) {
    const camera = state.cameras.get(state.model);
    if (camera && !is_flat()) set_camera(change(camera, size_shown(), scene_of_hands()), true);
  },
  flat(dx, dy, factor, at) {
    const view = state.flat,
      size = size_shown(),
      scale = clamp(view.scale * factor, kMinFlatScale, kMaxFlatScale),
      by = scale / view.scale;
    const middle = at ? [at[0] - size[0] / 2, at[1] - size[1] / 2] : [0, 0];
    state.flat = {
      scale,
      x: middle[0] + (view.x - middle[0]) * by + dx,
      y: middle[1] + (view.y - middle[1]) * by + dy,
    };
    draw();
    remember();
  },
  click: (at) => is_measuring() && ask_point(at, add_point),
  pivot(at) {
    if (is_measuring()) return;
    if (is_flat()) return hooks.reset();
    const turn_about = (point) => point && act.gesture((camera) => with_pivot(camera, point));
    if (state.hello.picks) return ask_point(at, turn_about);
    act.gesture((camera, shown) => with_pivot(camera, point_under(camera, at, shown)));
  },
  hold(is_held) {
    if (is_flat() && !state.b) return is_held && announce("A G-buffer has no ray-traced reference: keep a state as B");
    stage.is_held = is_held;
    stage.wants_b ||= is_held;
    if (is_held && state.compare === "off") link.changed(false);
    draw();
  },
  fly: (move) => act.gesture((camera) => flown(camera, move)),
  tap: (name) => name === "a" && toggle_anti_aliasing(),
  key: (event) => press(act, event),
  command: (event) => press_command(event),
};

Object.assign(hooks, {
  link,
  changed,
  remember,
  redraw: draw,
  refresh: schedule_refresh,
  status: show_work,
  take_camera(options) {
    const camera = camera_from(options);
    if (camera) set_camera(camera, false);
  },
  view: (name) => act.gesture((camera, size, scene) => viewed_from(camera, name, size, scene)),
  reset() {
    state.flat = { scale: 1, x: 0, y: 0 };
    const home = home_camera(state.model);
    if (home) state.cameras.set(state.model, home);
    changed(false);
  },
  taken() {
    forget_b(link.id);
    show_models();
    changed(false);
    update_flicker();
  },
  next_model(step) {
    const at = state.models.findIndex((model) => model.id === state.model);
    select_model(state.models[(at + step + state.models.length) % state.models.length].id);
  },
});

let model_before = null; // the one shown before a file was opened

function select_model(id) {
  if (id === state.model) return;
  state.model = id;
  state.flat = { scale: 1, x: 0, y: 0 };
  forget_b(link.id);
  show_models();
  changed(false);
  announce(model_now().name);
}

function show_models() {
  const list = by_id("models");
  list.replaceChildren(...state.models.map((model) => element("option", { value: model.id, text: model.name })));
  list.value = state.model;
  by_id("no_model").hidden = state.models.length > 0;
  show_hint();
  document.title = model_now() ? `${model_now().name} · Umbrage` : "Umbrage";
  show_summary();
}

function show_hint() {
  const zoom = matchMedia("(pointer: coarse)").matches ? "pinch to zoom" : "wheel to zoom",
    texts = is_flat()
      ? ["Drag to move", zoom, "double click to fit"]
      : ["Drag to turn", zoom, "double click to centre"];
  by_id("hint_text").textContent = texts.join("\u00a0· ");
}

function show_summary() {
  const scene = scene_now();
  const extent = scene?.extent ? ` · ${scene.extent.map(length_text).join(" × ")} units` : "";
  by_id("model_summary").textContent = (scene?.summary ?? "") + extent;
  by_id("model_summary").title = extent ? "Size of the model along x, y and z, in the units of its file" : "";
  by_id("warnings").replaceChildren(...(scene?.warnings ?? []).map((text) => element("li", { text: with_upload_names(text) })));
}

/// Says that a picture is being drawn if it takes longer than a moment.
function expect_frame() {
  clearTimeout(waiting_timer);
  waiting_timer = setTimeout(() => {
    if (!link.connected || link.is_moving() || !stage.last || stage.last.id >= link.id) return;
    by_id("progress_text").textContent = "Drawing…";
  }, kPatience_ms);
}

// Messages of the program.

function take_message(message) {
  const take = {
    hello: take_hello,
    models: take_models,
    model: take_model,
    environment: take_environment,
    pick: take_pick,
    status: (m) => show_work(m.text, m.progress),
    error: take_error,
    device: (m) => show_device(m.device),
  }[message.type];
  take?.(message);
}

function take_hello(hello) {
  const is_again = !!state.hello;
  state.hello = hello;
  state.models = hello.models ?? [];
  if (!is_again) take_address();
  note_step();
  state.scenes.clear();
  build_panels();
  show_device(hello.device);
  by_id("version").textContent = hello.version ?? "";
  show_models();
  changed(false);
  refresh();
  update_flicker();
}

function take_models(message) {
  state.models = message.models;
  if (message.select !== undefined && message.select !== null) {
    model_before = state.model;
    state.model = message.select;
  }
  show_models();
  changed(false);
}

/// Goes back to the model before one that cannot be read, which leaves the list.
function leave_unreadable_model() {
  if (scene_now() || model_before === null || model_before === state.model) return;
  state.models = state.models.filter((model) => model.id !== state.model);
  state.model = model_before;
  model_before = null;
  show_models();
  changed(false);
}

/// A model has been read, or read again: then the camera stays where it is.
function take_model(message) {
  state.scenes.set(message.model, message);
  const camera = state.cameras.get(message.model),
    home = home_camera(message.model);
  if (home && (!camera || camera.is_home)) state.cameras.set(message.model, home);
  if (message.model === state.model) {
    show_summary();
    changed(false);
  }
}

function take_environment(message) {
  side_edited().options["hdri-file"] = message.file;
  changed(false);
}

function take_pick(message) {
  if (last_pick.model === state.model) last_pick.take(message.point);
}

/// An error of a view is shown until that view is drawn; another one, a notice, until it is dismissed.
function take_error(message) {
  const is_of_view = message.view !== undefined;
  if (is_of_view) {
    clearTimeout(waiting_timer);
    refused[message.view] = newest_id(message.id, message.view);
  }
  show_work("", 0);
  const is_unreadable = is_of_view && !scene_now() && model_before !== null;
  complain(with_upload_names(message.message), is_of_view && !is_unreadable ? `view${message.view}` : undefined);
  if (is_unreadable) leave_unreadable_model();
}

function take_frame(header, blob) {
  show_frame(header, blob, (shown_header, is_shown) => {
    link.shown(shown_header.frame);
    if (!is_shown) return;
    if (shown_header.id > refused[shown_header.view]) forgive(`view${shown_header.view}`);
    note_time(shown_header);
    if (shown_header.view === 0) show_state(shown_header);
    draw_times();
  });
}

// The status line.

function show_device(name) {
  by_id("device_name").textContent = device_name(name ?? "");
  by_id("device_name").title = name ?? "";
}

function show_work(text, progress) {
  by_id("work").textContent = text ? `${text}${progress > 0 ? ` ${Math.round(progress * 100)} %` : ""}` : "";
  by_id("progress").style.transform = `scaleX(${text ? progress || 0.02 : 0})`;
}

function show_state(header) {
  const now = performance.now();
  show_work("", 0);
  if (header.moving) moving_times.push(now);
  while (moving_times.length && now - moving_times[0] > kRate_ms) moving_times.shift();
  const pictures = header.samples > 1 ? `, ${header.samples} pictures` : "";
  const rest = header.final ? `Finished${pictures}` : header.samples > 0 ? `Refining${pictures}` : "Drawing…";
  by_id("progress_text").textContent = header.moving ? `Pictures per second: ${moving_times.length}` : rest;
  by_id("progress_text").title = header.moving ? "" : `Average of pictures: ${header.samples}`;
  by_id("frame_size").textContent = `${header.width} × ${header.height} pixels`;
  by_id("frame_time").textContent = `drawn in ${ms_text(header.ms)}`;
  show_error_number(header);
}

/// Screen readers hear the number of the first picture at rest and of the final one.
function show_error_number(header) {
  const error = header.error,
    number = by_id("error_number");
  number.setAttribute("aria-live", !header.moving && (header.samples <= 1 || header.final) ? "polite" : "off");
  number.textContent = error
    ? `Error of the ambient shadow, from 0 to 1: RMSE ${error.rmse.toPrecision(3)}, mean ${error.mean.toPrecision(3)}. ` +
      "White is right, red too bright, blue too dark; full colour from 0.1."
    : "";
}

// The connection.

function opened() {
  forget_sent();
  by_id("reconnect").disabled = false;
  by_id("ended").hidden = true;
  document.body.dataset.connected = "true";
}

function closed(sentence) {
  by_id("reconnect").disabled = false;
  by_id("ended_why").textContent = sentence;
  by_id("ended").hidden = false;
  document.body.dataset.connected = "false";
  show_work("", 0);
}

function start() {
  attach_theme();
  toggle_panel(!matchMedia(kNarrow).matches);
  make_help();
  attach_files();
  attach_hands(act);
  attach_divider(remember);
  attach_steps();
  by_id("save_now").addEventListener("click", save);
  by_id("measure").addEventListener("click", toggle_measure);
  by_id("fit").addEventListener("click", () => act.key({ key: "f" }));
  attach_search();
  watch_size(() => {
    link.changed(true);
    schedule_refresh();
  });
  by_id("models").addEventListener("change", (event) => select_model(Number(event.target.value)));
  by_id("reconnect").addEventListener("click", () => {
    by_id("reconnect").disabled = true;
    link.connect();
  });
  addEventListener("hashchange", () => {
    if (!state.hello || location.hash.slice(1) === own_fragment) return;
    state.flat = { scale: 1, x: 0, y: 0 };
    take_address();
    hooks.taken();
  });
  document.addEventListener("visibilitychange", update_flicker);
  link.connect();
}

/// What tests read.
window.umbrage = {
  get state() {
    return structuredClone({
      ...state,
      scenes: Object.fromEntries(state.scenes),
      cameras: Object.fromEntries(state.cameras),
    });
  },
  get options() {
    return view_of(state.a).options;
  },
  get frame() {
    return stage.last;
  },
  get frame_b() {
    return stage.pictures[1]?.header ?? null;
  },
  get frames() {
    return stage.frames;
  },
  get id() {
    return link.id;
  },
  get moving() {
    return link.is_moving();
  },
  get connected() {
    return link.connected;
  },
};

start();
