// What the page shows: a plain object, and the texts made from it. A side is what can be compared: options of
// `umbrage render` that differ from the defaults, parameters of effects, what is shown, and the device.
import { camera_from, camera_options } from "./camera.js";

const kSplit = 0.5; // place of the divider, of the width
const kGain = 4; // factor of the difference
export const kGains = [1, 4, 16];

export const state = {
  hello: null, // the tables of the program
  models: [], // [{id, name, kind}]
  model: 0, // id of the model shown
  scenes: new Map(), // id -> the message "model"
  cameras: new Map(), // id -> camera
  a: new_side(),
  b: null,
  edited: "a", // the side that the panel changes
  compare: "off", // one of kComparisons
  split: kSplit,
  gain: kGain,
  flat: { scale: 1, x: 0, y: 0 }, // view of a G-buffer, in the page only
};

export const kComparisons = ["off", "b", "divider", "flicker", "difference"];
// Options that belong to a file or to the process, not to what is seen.
const kNotSeen = /^(resolution|passes|svg|bits|threads|isa|device|MODEL|output|camera-.*)$/;
const kCameraNames = ["position", "focal-point", "view-up", "view-angle", "orthographic"].map(
  (name) => `camera-${name}`,
);

export function new_side() {
  return { options: {}, set: {}, show: "picture", device: "" };
}

export const copy_of = (side) => structuredClone(side);
export const side_edited = () => (state.edited === "b" && state.b ? state.b : state.a);
/// Returns side B: the second state, or the reference of A.
export const side_b = () => state.b ?? { ...state.a, show: "reference" };
export const scene_now = () => state.scenes.get(state.model);
export const model_now = () => state.models.find((model) => model.id === state.model);
export const is_flat = () => model_now()?.kind === "gbuffer";
/// The look of a G-buffer depends on its planes, which the program may tell.
export const default_look = () => scene_now()?.look ?? "studio";
export const look_of = (side) => {
  const name = side.options.look ?? default_look();
  return state.hello?.looks.find((look) => look.name === name) ?? state.hello?.looks[0];
};

/// Returns the technique with which a look draws, from the table of looks.
export function technique_of_look(side) {
  const look = look_of(side);
  if (is_flat() || !look) return look?.gbuffer_technique;
  const texts = { ...side.options, ...side.set };
  const is_set = ({ name, text }) => name in texts && (text === undefined || texts[name] === text);
  const change = look.technique_changes.find(is_set);
  return change?.technique ?? look.techniques[side.options.quality ?? ""] ?? look.gbuffer_technique;
}
export const technique_of = (side) => side.options.ao ?? technique_of_look(side);

/// Returns what is known of the scene for gestures, with the up direction that the options set.
export function scene_for_camera(up_option_direction) {
  const scene = scene_now() ?? { center: [0, 0, 0], radius: 1, up: [0, 1, 0] };
  return { center: scene.center, radius: scene.radius > 0 ? scene.radius : 1, up: up_option_direction ?? scene.up };
}

/// Takes the options of a command line or of a file of settings into a side; an empty text is the default of an option.
/// Returns the names that the program does not know, which are left out.
export function take_options(side, options) {
  const unknown = [];
  for (const [name, value] of Object.entries(options ?? {})) {
    if (name === "set") unknown.push(...[value].flat().filter((entry) => !take_setting(side, String(entry))));
    else if (name === "device") side.device = String(value);
    else if (!kNotSeen.test(name) && !take_option(side, name, String(value))) unknown.push(name);
  }
  return unknown;
}

function take_option(side, name, text) {
  const option = state.hello.options.find((entry) => entry.name === name);
  if (!option) return false;
  const is_default = text === "" || (option.kind === "flag" && text === (option.initial || "false"));
  if (is_default) delete side.options[name];
  else side.options[name] = text;
  return true;
}

function take_setting(side, entry) {
  const [name, ...rest] = entry.split("="),
    text = rest.join("=");
  const is_known = state.hello.effects.some((effect) =>
    effect.parameters.some((parameter) => `${effect.name}.${parameter.name}` === name),
  );
  if (is_known && text === "") delete side.set[name];
  else if (is_known) side.set[name] = text;
  return is_known;
}

/// Returns the side that the command line sets.
function given_side() {
  const side = new_side();
  take_options(side, state.hello.given);
  return side;
}

/// Returns the camera with which a model is first seen, or null before the model is read.
export function home_camera(model) {
  const home = camera_from(state.scenes.get(model)?.camera ?? {});
  return home && { ...home, is_home: true };
}

export const settings_list = (side) => Object.entries(side.set).map(([name, text]) => `${name}=${text}`);

/// Returns the options of a side as on a command line, with those of the camera, by default that of the view.
export function options_of(side, camera = state.cameras.get(state.model)) {
  const options = { ...side.options };
  if (camera && !is_flat()) Object.assign(options, camera_options(camera, scene_for_camera()));
  if (Object.keys(side.set).length) options.set = settings_list(side);
  return options;
}

/// Returns a side as the program takes it.
export function view_of(side) {
  const view = { options: options_of(side), show: side.show };
  if (side.device) view.device = side.device;
  return view;
}

// The fragment of the address: readable, `&` between entries, only what differs from the command line. An empty text is
// the default of an option that the command line sets.

const quoted = (text) => encodeURIComponent(text).replace(/%(2C|3A|2F|2B|3D|23)/g, (hex) => decodeURIComponent(hex));

/// Returns [name, text] of what differs between two objects; the text is empty for what `base` alone has.
function differing(object, base) {
  const names = new Set([...Object.keys(object), ...Object.keys(base)]);
  return [...names].filter((name) => object[name] !== base[name]).map((name) => [name, object[name] ?? ""]);
}

function side_entries(side, prefix) {
  const base = given_side();
  const entries = differing(side.options, base.options);
  for (const [name, text] of differing(side.set, base.set)) entries.push(["set", `${name}=${text}`]);
  if (side.show !== base.show) entries.push(["show", side.show]);
  if (side.device !== base.device) entries.push(["device", side.device]);
  return entries.map(([name, text]) => [prefix + name, text]);
}

/// Returns the whole state as the fragment of an address, without "#".
export function fragment_of_state() {
  const entries = state.models.length && state.model !== state.models[0].id ? [["model", String(state.model)]] : [];
  entries.push(...side_entries(state.a, ""));
  if (state.b) entries.push(["b", ""], ...side_entries(state.b, "b."));
  if (state.compare !== "off") entries.push(["compare", state.compare]);
  if (state.split !== kSplit) entries.push(["split", state.split.toFixed(3)]);
  if (state.gain !== kGain) entries.push(["gain", String(state.gain)]);
  const camera = state.cameras.get(state.model);
  if (camera && !camera.is_home && !is_flat())
    entries.push(...Object.entries(camera_options(camera, scene_for_camera())));
  return entries.map(([name, text]) => (name === "b" ? name : `${name}=${quoted(text)}`)).join("&");
}

/// Returns [name, text] of each entry of a fragment.
const entries_of = (fragment) =>
  fragment
    .replace(/^#/, "")
    .split("&")
    .filter(Boolean)
    .map((entry) => {
      const [name, ...rest] = entry.split("=");
      return [name, decoded(rest.join("="))];
    });

/// Sets what a fragment can name to that of the command line.
function reset() {
  state.model = state.models[0]?.id ?? 0;
  state.a = given_side();
  state.b = null;
  state.edited = "a";
  state.compare = "off";
  state.split = kSplit;
  state.gain = kGain;
  reset_cameras();
}

function reset_cameras() {
  state.cameras.clear();
  for (const id of state.scenes.keys()) {
    const home = home_camera(id);
    if (home) state.cameras.set(id, home);
  }
}

/// Sets the state from a fragment; what it does not name gets its default, for options that of the command line. Returns
/// the names that are not known, which are left out.
export function take_fragment(fragment) {
  const camera = {},
    unknown = [];
  reset();
  for (const [name, text] of entries_of(fragment)) {
    if (name === "model") state.model = state.models.find((model) => String(model.id) === text)?.id ?? state.model;
    else if (name === "compare") state.compare = kComparisons.includes(text) ? text : "off";
    else if (name === "split") state.split = Math.min(1, Math.max(0, Number(text) || 0));
    else if (name === "gain") state.gain = kGains.includes(Number(text)) ? Number(text) : kGain;
    else if (kCameraNames.includes(name)) camera[name] = text;
    else if (name === "b") state.b ??= given_side();
    else if (name.startsWith("b.")) unknown.push(...take_entry((state.b ??= given_side()), name.slice(2), text));
    else unknown.push(...take_entry(state.a, name, text));
  }
  const set = camera_from(camera);
  if (set) state.cameras.set(state.model, set);
  return unknown;
}

/// Returns all that a user sets, as a text. It does not change when a model is read, whose camera is then that of before.
export function state_text() {
  const { model, a, b, compare, split, gain, flat } = state;
  const cameras = [...state.cameras].filter(([, camera]) => !camera.is_home);
  return JSON.stringify({ model, a, b, compare, split, gain, flat, cameras });
}

/// Sets the state from such a text; a model that has left the list is not chosen.
export function take_state_text(text) {
  const { model, cameras, ...others } = JSON.parse(text);
  Object.assign(state, others);
  if (state.models.some((entry) => entry.id === model)) state.model = model;
  if (!state.b) state.edited = "a";
  reset_cameras();
  for (const [id, camera] of cameras) state.cameras.set(id, camera);
}

function take_entry(side, name, text) {
  if (name !== "show") return take_options(side, { [name]: text });
  side.show = text || "picture";
  return [];
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/// Set by main.js. changed(moving): the view has changed; `moving` while further changes follow at once. remember():
/// something that only the address and the history keep has changed. taken(): the whole state has been replaced.
/// redraw(): what is drawn over the picture has changed.
export const hooks = { changed: () => {}, remember: () => {}, taken: () => {}, redraw: () => {}, link: null };
