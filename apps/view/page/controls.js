// One row of the panel for one entry of the program's tables: {name, technical, help, unit, initial, kind, min, max,
// choices}.
import { element, new_id, is_typed } from "./dom.js";
import { choice_name } from "./names.js";
import { clamp, slider_text } from "./math.js";

const kWide = 50; // ratio of max and min from which a slider is logarithmic
const kLowDefault = 0.35; // place of a default, of the range, below which the slider is bent to have it in the middle
const kUnits = { deg: "°", "scene units": "units of the file" };
const kLengthUnits = { "scene units": "% or units", px: "% or px", "%": "%" }; // a number without % is the latter

/// Returns functions between a value and the place of the slider's thumb, 0 to 1. Wide positive ranges are logarithmic;
/// ranges from 0 have their default in the middle; wide symmetric ranges are finer around 0.
export function scale_of(min, max, initial) {
  if (min > 0 && max / min >= kWide) {
    return { place: (x) => Math.log(x / min) / Math.log(max / min), value: (t) => min * (max / min) ** t };
  }
  if (min === -max && max >= 10) {
    return {
      place: (x) => 0.5 + 0.5 * Math.sign(x) * Math.sqrt(Math.abs(x) / max),
      value: (t) => Math.sign(t - 0.5) * max * (2 * t - 1) ** 2,
    };
  }
  const fraction = (initial - min) / (max - min);
  const power = fraction > 0 && fraction < kLowDefault ? clamp(Math.log(fraction) / Math.log(0.5), 1, 6) : 1;
  return {
    place: (x) => Math.max(0, (x - min) / (max - min)) ** (1 / power),
    value: (t) => min + (max - min) * t ** power,
  };
}

/// Returns the range of the slider, or null for none; the number beside it takes the whole range. Rotations show one turn,
/// lengths 0.1 to 100 percent of the radius, exposure 5 stops, factors 4 times the default.
function range_of(entry) {
  if (entry.kind === "length") return [0.1, 100];
  if (entry.unit === "deg" && entry.max > 360) return [-180, 180];
  const { min, max } = entry,
    initial = parseFloat(entry.initial);
  if (entry.unit === "stops") return [Math.max(min, -5), Math.min(max, 5)];
  if (entry.kind === "number" && min === 0 && initial === 1 && max >= 10) return [0, 4];
  if (min === 0 && max >= 1e5 && initial > 0) return [0, 10 * initial];
  return Number.isFinite(min) && Number.isFinite(max) && min < max && max - min < 1e6 ? [min, max] : null;
}

/// Returns the text of one number with a point where some languages have a comma.
const with_point = (text) => text.replace(/^([^,]*),([^,]*)$/, "$1.$2");
const number_in = (text) => (/^-?[\d.]+(e-?\d+)?%?$/i.test(text ?? "") ? parseFloat(text) : NaN);

/// Returns the number that the slider stands for; lengths in scene units are converted to percent of `radius`.
function slider_number(entry, text, radius) {
  const value = number_in(text);
  return entry.kind === "length" && !text?.endsWith("%") ? (100 * value) / radius : value;
}

function number_control(entry, id, describe, change, radius) {
  const is_length = entry.kind === "length",
    limits = range_of(entry);
  const box = element("input", {
    type: is_length ? "text" : "number",
    id,
    class: "number",
    "aria-describedby": describe,
    step: entry.kind === "integer" ? 1 : "any",
    min: is_length ? undefined : entry.min,
    max: is_length ? undefined : entry.max,
    autocomplete: "off",
    spellcheck: "false",
    placeholder: Number.isNaN(number_in(entry.initial)) ? "auto" : entry.initial,
    on_change: () => change(with_point(box.value.trim()) || undefined, false),
  });
  const parts = [box];
  let slider = null,
    scale = null;
  if (limits) {
    const initial = slider_number(entry, entry.initial, radius());
    scale = scale_of(limits[0], limits[1], initial);
    const steps = entry.kind === "integer" && limits[1] - limits[0] <= 32;
    slider = element("input", {
      type: "range",
      min: 0,
      max: 1,
      step: steps ? 1 / (limits[1] - limits[0]) / 4 : 0.002,
      "aria-describedby": describe,
    });
    const take = (moving) => {
      const raw = scale.value(Number(slider.value));
      change(entry.kind === "integer" ? String(Math.round(raw)) : slider_text(raw) + (is_length ? "%" : ""), moving);
    };
    slider.addEventListener("input", () => take(true));
    slider.addEventListener("change", () => take(false));
    slider.setAttribute("aria-labelledby", `${id}_label`);
    parts.unshift(slider);
  }
  const show = (text) => {
    if (!is_typed(box) || text === undefined) box.value = text ?? "";
    if (!slider) return;
    const value = slider_number(entry, text ?? entry.initial, radius());
    const place = Number.isNaN(value) ? 0.5 : clamp(scale.place(value), 0, 1);
    if (document.activeElement !== slider || Math.abs(place - Number(slider.value)) > 0.02) slider.value = place;
    slider.style.setProperty("--place", place);
    slider.setAttribute("aria-valuetext", `${text ?? entry.initial ?? "automatic"} ${entry.unit ?? ""}`);
  };
  return { parts, show, has_slider: !!slider };
}

function choice_control(entry, id, describe, change) {
  const has_initial = entry.choices.includes(entry.initial);
  const select = element("select", {
    id,
    "aria-describedby": describe,
    on_change: () => change(select.value || undefined, false),
  });
  if (!has_initial) select.append(element("option", { value: "", text: entry.initial?.replace(/^auto: /, "") || "default" }));
  const full = entry.set ?? entry.name;
  for (const choice of entry.choices)
    select.append(element("option", { value: choice, text: choice_name(full, choice), title: choice }));
  return { parts: [select], show: (text) => (select.value = text ?? (has_initial ? entry.initial : "")) };
}

function flag_control(entry, id, describe, change) {
  const is_on = entry.initial === "true" || entry.initial === "on";
  const box = element("input", {
    type: "checkbox",
    id,
    role: "switch",
    "aria-describedby": describe,
    on_change: () => change(box.checked === is_on ? undefined : String(box.checked), false),
  });
  return {
    parts: [box],
    show: (text) => (box.checked = text === undefined ? is_on : text === "true" || text === "on"),
  };
}

/// Returns "#rrggbb" of any colour that the program takes, or null.
export function hex_of(text) {
  const parts = String(text ?? "")
    .split(",")
    .map(Number);
  if (parts.length === 3 && parts.every((x) => x >= 0 && x <= 1)) {
    return (
      "#" +
      parts
        .map((x) =>
          Math.round(x * 255)
            .toString(16)
            .padStart(2, "0"),
        )
        .join("")
    );
  }
  const pen = (hex_of.pen ??= document.createElement("canvas").getContext("2d"));
  pen.fillStyle = "#010203";
  pen.fillStyle = text ?? "";
  return /^#[0-9a-f]{6}$/.test(pen.fillStyle) && pen.fillStyle !== "#010203" ? pen.fillStyle : null;
}

function color_control(entry, id, describe, change) {
  const well = element("input", {
    type: "color",
    "aria-labelledby": `${id}_label`,
    on_input: () => change(well.value, true),
    on_change: () => change(well.value, false),
  });
  const box = element("input", {
    type: "text",
    id,
    "aria-describedby": describe,
    placeholder: "auto",
    autocomplete: "off",
    spellcheck: "false",
    on_change: () => change(box.value.trim() || undefined, false),
  });
  const show = (text) => {
    if (!is_typed(box) || text === undefined) box.value = text ?? "";
    well.value = hex_of(text) ?? "#808080";
    well.classList.toggle("empty", text === undefined);
  };
  return { parts: [well, box], show };
}

function text_control(entry, id, describe, change) {
  const box = element("input", {
    type: "text",
    id,
    "aria-describedby": describe,
    placeholder: entry.initial || "auto",
    autocomplete: "off",
    spellcheck: "false",
    on_change: () => change(box.value.trim() || undefined, false),
  });
  return {
    parts: [box],
    show: (text) => (!is_typed(box) || text === undefined ? (box.value = text ?? "") : 0),
  };
}

/// A slider for the first plane of a text such as "x=50%", the buttons of its axis, and the text, which may have more planes.
function plane_control(entry, id, describe, change) {
  const kPlane = /^([xyz])([=<>])([-\d.]+)%/i;
  const percent_at = (place) => Math.round(2 + 196 * place) / 2; // 1 to 99: beyond, nothing is cut
  let now = "";
  const set = (axis, percent, moving) => {
    const found = now.match(kPlane),
      plane = `${axis ?? found?.[1] ?? "x"}${found?.[2] ?? "="}${percent ?? found?.[3] ?? 50}%`;
    change(found ? now.replace(kPlane, plane) : plane, moving);
  };
  const slider = element("input", {
    type: "range",
    min: 0,
    max: 1,
    step: 0.005,
    "aria-describedby": describe,
    "aria-labelledby": `${id}_label`,
  });
  slider.addEventListener("input", () => set(null, percent_at(slider.value), true));
  slider.addEventListener("change", () => set(null, percent_at(slider.value), false));
  const axes = element("select", {
    "aria-label": "Axis of the plane",
    on_change: () => (axes.value ? set(axes.value, null, false) : change(undefined, false)),
  });
  for (const axis of ["", "x", "y", "z"]) axes.append(element("option", { value: axis, text: axis || "off" }));
  const text = text_control({ ...entry, initial: "x=50%" }, id, describe, change);
  const show = (value) => {
    now = value ?? "";
    text.show(value);
    const found = now.match(kPlane);
    axes.value = found?.[1].toLowerCase() ?? "";
    const place = clamp(((found?.[3] ?? 50) - 1) / 98, 0, 1);
    if (document.activeElement !== slider || Math.abs(place - Number(slider.value)) > 0.02) slider.value = place;
    slider.style.setProperty("--place", place);
    slider.setAttribute("aria-valuetext", value ?? "off");
  };
  return { parts: [slider, axes, ...text.parts], show, has_slider: true };
}

const kControls = {
  integer: number_control,
  number: number_control,
  length: number_control,
  choice: choice_control,
  flag: flag_control,
  color: color_control,
};

/// Makes a row. `access`: get() returns the text or undefined, set(text or undefined, moving), radius() of the scene.
/// Returns {root, refresh}.
export function row(entry, label, access, testid) {
  const id = new_id(),
    describe = `${id}_help`;
  const make =
    entry.name === "section" ? plane_control : kControls[entry.kind === "choice" && !entry.choices?.length ? "text" : entry.kind] ?? text_control;
  const control = make(entry, id, describe, access.set, access.radius);
  const undo = element("button", {
    type: "button",
    class: "undo",
    title: "Reset",
    "aria-label": `Reset ${label}`,
    text: "↺",
    on_click: () => {
      access.set(undefined, false);
      control.parts[0].focus();
    },
  });
  const unit = (entry.kind === "length" ? kLengthUnits : kUnits)[entry.unit] ?? entry.unit,
    tooltip = `${entry.help}\n${entry.technical}`,
    is_short = unit?.length === 1 && control.has_slider && !entry.initial?.endsWith(unit);
  const root = element(
    "div",
    { class: "row", "data-testid": testid, "data-kind": entry.kind, title: tooltip },
    element(
      "label",
      { for: id, id: `${id}_label` },
      `${label} `,
      unit && !is_short && unit !== "%" ? element("span", { class: "unit", text: unit }) : null,
    ),
    element(
      "div",
      { class: control.has_slider ? "control slides" : "control" },
      ...control.parts,
      is_short ? element("span", { class: "unit", text: unit, "aria-hidden": "true" }) : null,
    ),
    undo,
    element("small", { class: "help", id: describe, text: entry.help }),
  );
  const refresh = () => {
    const text = access.get();
    control.show(text);
    root.classList.toggle("changed", text !== undefined);
    undo.hidden = text === undefined;
  };
  refresh();
  return { root, refresh };
}
