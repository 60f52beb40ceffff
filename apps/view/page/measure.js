// Measures the distance of two points of the model that are clicked, in the units of its file, and draws the line.
import { by_id, announce } from "./dom.js";
import { state, hooks, is_flat } from "./state.js";
import { place_of_point } from "./camera.js";
import { minus, length } from "./math.js";

const kDigits = 4;
let measured = null, // null: nothing is measured
  measured_model = 0; // that of the points

export const is_measuring = () => measured !== null && !is_flat();
export const length_text = (x) => String(Number(x.toPrecision(kDigits)));

export function toggle_measure() {
  if (is_flat() && !measured) return announce("Distances are measured in models");
  measured = measured ? null : [];
  measured_model = state.model;
  by_id("measure").setAttribute("aria-pressed", String(is_measuring()));
  by_id("picture").classList.toggle("measuring", is_measuring());
  announce(measured ? "Click two points of the model" : "Measuring off");
  hooks.redraw();
}

/// Takes a point of the model, or null where there is none. The third begins anew.
export function add_point(point) {
  if (!measured) return;
  if (!point) return announce("There is no surface at this place");
  measured = measured.length === 2 || measured_model !== state.model ? [point] : [...measured, point];
  measured_model = state.model;
  if (measured.length === 2) announce(`Distance: ${length_text(length(minus(...measured)))} units of the file`);
  hooks.redraw();
}

/// Draws the points and their distance into the picture of `size` on the page.
export function draw_measure(size) {
  const camera = state.cameras.get(state.model),
    is_shown = is_measuring() && measured_model === state.model && !!camera;
  const places = is_shown ? measured.map((point) => place_of_point(camera, point, size)).filter(Boolean) : [];
  const path = places.map(([x, y], i) => `${i ? "L" : "M"}${x} ${y}`).join("");
  const dots = places.map(([x, y]) => `M${x - 3} ${y}a3 3 0 1 0 6 0a3 3 0 1 0-6 0`).join("");
  for (const part of by_id("measured").children) part.setAttribute("d", path + dots);
  const tag = by_id("distance");
  tag.hidden = places.length < 2;
  if (tag.hidden) return;
  tag.textContent = `${length_text(length(minus(...measured)))} units`;
  tag.style.left = `${(places[0][0] + places[1][0]) / 2}px`;
  tag.style.top = `${(places[0][1] + places[1][1]) / 2}px`;
}
