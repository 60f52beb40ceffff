// What the page shows: a plain object, and the texts made from it. A side is what can be compared: options of
// `umbrage render` that differ from the defaults, parameters of effects, what is shown, and the device.
import { camera_from, camera_options } from "./camera.js";

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
  split: 0.5,
  gain: 4, // divider, and factor of the difference
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

/// Returns the technique with which a look draws: the one in screen space for a G-buffer, and if one of its parameters or
/// its resolution is set.
export function technique_of_look(side) {
  const look = look_of(side);
  const is_screen_space =
    is_flat() ||
    (side.options["ao-scale"] ?? "full") !== "full" ||
    Object.keys(side.set).some((name) => name.startsWith(`${look?.occlusion}.`));
  return is_screen_space ? look?.occlusion : (look?.techniques[side.options.quality ?? ""] ?? look?.occlusion);
}
export const technique_of = (side) => side.options.ao ?? technique_of_look(side);

/// Returns what is known of the scene for gestures, with the up direction that the options set.
export function scene_for_camera(up_option_direction) {
  const scene = scene_now() ?? { center: [0, 0, 0], radius: 1, up: [0, 1, 0] };
  return { center: scene.center, radius: scene.radius > 0 ? scene.radius : 1, up: up_option_direction ?? scene.up };
}

/// Takes the options of a command line or of a file of settings into a side.
export function take_options(side, options) {
  for (const [name, text] of Object.entries(options ?? {})) {
    if (name === "set") for (const entry of [text].flat()) take_setting(side, entry);
    else if (name === "device") side.device = String(text);
    else if (!kNotSeen.test(name) && !is_default(name, String(text))) side.options[name] = String(text);
  }
}

const is_default = (name, text) =>
  state.hello?.options.some(
    (option) => option.name === name && option.kind === "flag" && text === (option.initial || "false"),
  );

function take_setting(side, entry) {
  const at = String(entry).indexOf("=");
  if (at > 0) side.set[entry.slice(0, at)] = entry.slice(at + 1);
}

export const settings_list = (side) => Object.entries(side.set).map(([name, text]) => `${name}=${text}`);

/// Returns the options of a side as on a command line, with those of the camera.
export function options_of(side) {
  const options = { ...side.options };
  const camera = state.cameras.get(state.model);
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

// The fragment of the address: readable, `&` between entries, only what differs from the defaults.

const quoted = (text) => encodeURIComponent(text).replace(/%(2C|3A|2F|2B|3D|23)/g, (hex) => decodeURIComponent(hex));

function side_entries(side, prefix) {
  const entries = Object.entries(side.options).map(([name, text]) => [prefix + name, text]);
  for (const entry of settings_list(side)) entries.push([prefix + "set", entry]);
  if (side.show !== "picture") entries.push([prefix + "show", side.show]);
  if (side.device) entries.push([prefix + "device", side.device]);
  return entries;
}

/// Returns the whole state as the fragment of an address, without "#".
export function fragment_of_state() {
  const entries = state.models.length && state.model !== state.models[0].id ? [["model", String(state.model)]] : [];
  entries.push(...side_entries(state.a, ""));
  if (state.b) entries.push(["b", ""], ...side_entries(state.b, "b."));
  if (state.compare !== "off") entries.push(["compare", state.compare]);
  if (state.compare === "divider" && state.split !== 0.5) entries.push(["split", state.split.toFixed(3)]);
  const camera = state.cameras.get(state.model);
  if (camera && !camera.is_home && !is_flat())
    entries.push(...Object.entries(camera_options(camera, scene_for_camera())));
  return entries.map(([name, text]) => (text === "" ? name : `${name}=${quoted(text)}`)).join("&");
}

/// Sets the state from a fragment; what it does not name gets its default, for options that of the command line.
export function take_fragment(fragment) {
  const entries = fragment
    .replace(/^#/, "")
    .split("&")
    .filter(Boolean)
    .map((entry) => {
      const at = entry.indexOf("=");
      return at < 0 ? [entry, ""] : [entry.slice(0, at), decoded(entry.slice(at + 1))];
    });
  state.a = new_side();
  state.b = null;
  state.edited = "a";
  state.compare = "off";
  if (!entries.some(([name]) => !/^(model|compare|split)$/.test(name))) take_options(state.a, state.hello.given);
  const camera = {};
  for (const [name, text] of entries) {
    if (name === "model" && state.models.some((model) => model.id === Number(text))) state.model = Number(text);
    else if (name === "compare" && kComparisons.includes(text)) state.compare = text;
    else if (name === "split") state.split = Math.min(1, Math.max(0, Number(text) || 0));
    else if (kCameraNames.includes(name)) camera[name] = text;
    else if (name === "b" || name.startsWith("b.")) take_entry((state.b ??= new_side()), name.slice(2), text);
    else take_entry(state.a, name, text);
  }
  const set = camera_from(camera);
  if (set) state.cameras.set(state.model, set);
}

function take_entry(side, name, text) {
  if (name === "show") side.show = text;
  else if (name && name !== "model" && name !== "compare") take_options(side, { [name]: text });
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/// Set by main.js. changed(moving): the view has changed; `moving` while further changes follow at once.
export const hooks = { changed: () => {}, link: null };
