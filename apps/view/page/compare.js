// The section that compares two states of one view: A, and B or the ray-traced reference.
import { element, section, segments, by_id, announce } from "./dom.js";
import { state, hooks, copy_of, side_edited, kComparisons, kGains } from "./state.js";
import { name_of, device_name } from "./names.js";
import { draw, stage, update_flicker } from "./stage.js";

let modes = null,
  edited = null,
  gain = null,
  device = null;

export function set_comparison(mode) {
  state.compare = mode;
  stage.phase = 0;
  hooks.changed(false);
  update_flicker();
  draw();
}

export function next_comparison() {
  const next = kComparisons[(kComparisons.indexOf(state.compare) + 1) % kComparisons.length];
  set_comparison(next);
  announce(next === "off" ? "Comparison off" : `Compare: ${next === "b" ? "B alone" : next}`);
}

export function keep_as_b() {
  state.b = copy_of(state.a);
  if (state.compare === "off") state.compare = "divider";
  hooks.changed(false);
  announce("B is a copy of A; change one of them");
}

function swap() {
  if (!state.b) return;
  [state.a, state.b] = [state.b, state.a];
  hooks.changed(false);
}

function drop_b() {
  state.b = null;
  state.edited = "a";
  hooks.changed(false);
}

export function edit_side(name) {
  if (name === "b" && !state.b) keep_as_b();
  state.edited = name;
  hooks.changed(false);
}

export function compare_section() {
  modes = segments(
    "Compare",
    "compare",
    [
      ["off", "Off"],
      ["b", "B", "show B alone"],
      ["divider", "Halves", "A to the left of a divider, B to its right"],
      ["flicker", "In turn", "show A and B one after the other"],
      ["difference", "Difference", "show how much B differs from A"],
    ],
    set_comparison,
  );
  edited = segments(
    "The panel changes",
    "edited",
    [
      ["a", "A"],
      ["b", "B"],
    ],
    edit_side,
  );
  gain = segments(
    "Difference, times",
    "gain",
    kGains.map((factor) => [String(factor), String(factor)]),
    (value) => {
      state.gain = Number(value);
      draw();
      hooks.remember();
    },
  );
  const button = (id, text, title, act) => element("button", { type: "button", id, text, title, on_click: act });
  device = element(
    "select",
    {
      id: "device",
      "data-testid": "device",
      on_change: () => {
        side_edited().device = device.value;
        hooks.changed(false);
      },
    },
    element("option", { value: "", text: "as started" }),
    ...(state.hello.devices ?? []).map((entry) =>
      element("option", { value: entry.name, text: device_name(`${entry.name}: ${entry.summary}`), title: entry.name }),
    ),
  );
  return section(
    "compare",
    "Compare",
    false,
    modes.root,
    element("p", { class: "summary", id: "b_is" }),
    gain.root,
    element(
      "div",
      { class: "buttons" },
      button("keep_b", "Copy A to B", "Keep the present state as B", keep_as_b),
      button("swap", "Swap", "Exchange A and B", swap),
      button("drop_b", "B = reference", "Compare with the ray-traced reference", drop_b),
    ),
    edited.root,
    element(
      "div",
      { class: "row wide" },
      element("label", { for: "device", text: name_of("option", "device") }),
      element("div", { class: "control" }, device),
    ),
  );
}

export function refresh_compare() {
  modes.show(state.compare);
  edited.show(state.edited);
  gain.show(String(state.gain));
  gain.root.hidden = state.compare !== "difference";
  by_id("swap").disabled = by_id("drop_b").disabled = !state.b;
  by_id("b_is").textContent = state.b
    ? "B is a state of its own."
    : "B is the ray-traced reference. Hold Shift to see it.";
  device.value = side_edited().device;
  document.body.dataset.edited = state.b ? state.edited : "";
}
