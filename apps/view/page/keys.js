// What each key does, apart from flying and Shift (hands.js), and the sheet that lists the keys.
import { by_id, announce, element, keep, kept } from "./dom.js";
import { state, hooks, side_edited, look_of, technique_of, is_flat, scene_now } from "./state.js";
import { set_option, set_parameter, effects_in_use } from "./panels.js";
import { name_of, choice_name } from "./names.js";
import { fitted } from "./camera.js";
import { next_comparison, keep_as_b, set_comparison } from "./compare.js";
import { move_by_key, zoom_by_key } from "./hands.js";
import { toggle_measure } from "./measure.js";
import { undo, redo } from "./steps.js";
import { save } from "./take.js";

const kArrows = { arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, -1], arrowdown: [0, 1] };
let occlusion_before; // the technique that Q turns back on

function toggle_occlusion() {
  const side = side_edited();
  if (technique_of(side) === "none") set_option("ao", occlusion_before);
  else {
    occlusion_before = side.options.ao;
    set_option("ao", "none");
  }
  announce(`Ambient shadow: ${name_of("effect", technique_of(side))}`);
}

export function toggle_anti_aliasing() {
  const is_off = side_edited().options["anti-aliasing"] === "1";
  set_option("anti-aliasing", is_off ? undefined : "1");
  announce(`Smooth edges ${is_off ? "on" : "off"}`);
}

/// Switches a parameter of an effect between its default and `off`, if the look runs the effect.
function toggle_parameter(name, off, what) {
  if (!effects_in_use().includes(name.split(".")[0])) {
    return announce(`The look ${name_of("look", look_of(side_edited()).name)} has no ${what}`);
  }
  const is_off = side_edited().set[name] === off;
  set_parameter(name, is_off ? undefined : off);
  announce(`${what[0].toUpperCase()}${what.slice(1)} ${is_off ? "on" : "off"}`);
}

function next_ground() {
  const next = { undefined: "on", auto: "on", on: "off", off: undefined }[side_edited().options.ground];
  set_option("ground", next);
  announce(`Ground: ${choice_name("ground", next ?? "auto")}`);
}

function next_buffer() {
  const inputs = [...document.querySelectorAll("input[name=show]")];
  const at = inputs.findIndex((input) => input.value === side_edited().show);
  side_edited().show = inputs[(at + 1) % inputs.length].value;
  hooks.changed(false);
  announce(`Shown: ${name_of("show", side_edited().show)}`);
}

/// Sets the other up axis of the model, +Y or +Z, and looks at the model from its corner.
function next_up() {
  const up = side_edited().options.up ?? (scene_now()?.up[2] > 0.9 ? "+Z" : "+Y"),
    axis = up === "+Z" ? "+Y" : "+Z";
  set_option("up", axis);
  hooks.view("corner");
  announce(`Up axis ${axis}`);
}

function next_theme() {
  const opposite = matchMedia("(prefers-color-scheme: dark)").matches ? "light" : "dark";
  const next = document.documentElement.dataset.theme ? "" : opposite;
  set_theme(next);
  announce(`Page: ${next || "as the system"}`);
}

export function set_theme(name) {
  document.documentElement.dataset.theme = name;
  keep("theme", name);
  hooks.refresh?.();
}

export function toggle_panel(is_open = document.body.classList.contains("no_panel")) {
  document.body.classList.toggle("no_panel", !is_open);
  by_id("panel_toggle").setAttribute("aria-expanded", String(is_open));
}

function begin_search() {
  toggle_panel(true);
  by_id("search").select();
}

export function attach_theme() {
  document.documentElement.dataset.theme = kept("theme");
  by_id("theme").addEventListener("click", next_theme);
  by_id("panel_toggle").addEventListener("click", () => toggle_panel());
  by_id("help_open").addEventListener("click", toggle_help);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => hooks.refresh?.());
}

/// Returns the action of a key, or undefined.
function action_of(act, key) {
  const view = (name) => () => hooks.view(name);
  return {
    f: is_flat() ? () => hooks.reset() : () => act.gesture((camera, size, scene) => fitted(camera, size, scene)),
    1: view("front"),
    3: view("right"),
    7: view("top"),
    9: view("corner"),
    5: () => act.gesture((camera) => ({ ...camera, orthographic: !camera.orthographic })),
    enter: () => hooks.reset(),
    "+": () => zoom_by_key(act, 1 / 1.15),
    "=": () => zoom_by_key(act, 1 / 1.15),
    "-": () => zoom_by_key(act, 1.15),
    m: toggle_measure,
    u: is_flat() ? undefined : next_up,
    o: () => by_id("open").click(),
    q: toggle_occlusion,
    t: () => toggle_parameter("output.tone", "none", "tone curve"),
    g: next_ground,
    e: () => toggle_parameter("outline.opacity", "0", "lines"),
    b: next_buffer,
    c: next_comparison,
    x: () => set_comparison(state.compare === "b" ? "off" : "b"),
    k: keep_as_b,
    p: () => toggle_panel(),
    l: next_theme,
    h: toggle_help,
    "?": toggle_help,
    "/": begin_search,
  }[key];
}

/// Handles a key pressed with Ctrl or Cmd that is not one of the picture. Returns whether it has a meaning.
export function press_command(event) {
  const key = event.key.toLowerCase();
  if (key === "z" || key === "y") {
    const is_redo = key === "y" || event.shiftKey,
      is_done = is_redo ? redo() : undo();
    announce(is_done ? (is_redo ? "Redone" : "Undone") : `Nothing to ${is_redo ? "redo" : "undo"}`);
  } else if (key === "s" && !event.shiftKey) save();
  else return false;
  return true;
}

/// Handles a key. Returns whether it has a meaning.
export function press(act, event) {
  const key = event.key.toLowerCase(),
    arrow = kArrows[key];
  if (arrow) {
    const is_choice = state.models.length > 1 && arrow[0] !== 0 && !event.ctrlKey && !event.shiftKey;
    if (is_choice) hooks.next_model(arrow[0]);
    else move_by_key(act, arrow[0], arrow[1], event.ctrlKey);
    return true;
  }
  const action = event.ctrlKey ? undefined : action_of(act, key);
  action?.();
  return !!action;
}

// The sheet of keys. The table is the one place that lists them.

const kKeys = [
  [
    "Pointer",
    [
      ["Left or middle drag", "orbit"],
      ["Right drag, Shift + drag", "move"],
      ["Wheel, pinch", "zoom to the pointer"],
      ["Two fingers", "move"],
      ["Double click", "turn about this point"],
    ],
  ],
  [
    "Undo, save, search",
    [
      ["Ctrl + Z", "undo"],
      ["Ctrl + Shift + Z  Ctrl + Y", "redo"],
      ["Ctrl + S", "save the picture"],
      ["/", "search the settings"],
    ],
  ],
  [
    "Camera",
    [
      ["F", "fit"],
      ["1  3  7  9", "front, right, top, corner; again: opposite"],
      ["5", "parallel projection"],
      ["Enter", "reset the camera"],
      ["W A S D", "fly (hold)"],
      ["R  V", "fly up, down (hold)"],
      ["↑ ↓ ← →", "orbit; Shift + ← → with several models"],
      ["Ctrl + arrows", "move"],
      ["+  −", "zoom"],
      ["U", "up axis of the model: Y, Z"],
    ],
  ],
  [
    "Models",
    [
      ["← →", "previous, next model, if there are several"],
      ["O", "open files"],
    ],
  ],
  [
    "Picture",
    [
      ["Q", "ambient shadow on, off"],
      ["A", "smooth edges on, off (tap)"],
      ["T", "tone curve on, off"],
      ["G", "ground: automatic, on, off"],
      ["E", "lines on, off"],
      ["B", "show the next image"],
      ["M", "measure: click two points"],
    ],
  ],
  [
    "Compare",
    [
      ["Shift (hold)", "show B, or the reference"],
      ["X", "keep B in view"],
      ["C", "next comparison"],
      ["K", "copy A to B"],
    ],
  ],
  [
    "Page",
    [
      ["P", "panel"],
      ["L", "light or dark page"],
      ["H", "this sheet"],
      ["Esc", "back to the picture"],
    ],
  ],
];

export function make_help() {
  const group = ([title, keys]) =>
    element(
      "section",
      {},
      element("h3", { text: title }),
      element(
        "dl",
        {},
        ...keys.flatMap(([key, what]) => [
          element("dt", {}, ...key.split(/ {2}/).map((text) => element("kbd", { text }))),
          element("dd", { text: what }),
        ]),
      ),
    );
  by_id("keys").replaceChildren(...kKeys.map(group));
}

function toggle_help() {
  const sheet = by_id("help");
  if (sheet.open) sheet.close();
  else sheet.showModal();
}
