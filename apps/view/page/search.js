// The search in the panel: leaves the settings in whose names and tooltips all its words occur.
import { by_id } from "./dom.js";

const kSettings = ".row, fieldset, .buttons, .save, .ball, #shows";

/// Returns the texts of a part of the panel, its tooltips and its technical names.
const texts_of = (part) =>
  [part.textContent, ...[part, ...part.querySelectorAll("*")].flatMap((at) => [at.title, at.dataset?.testid])]
    .join(" ")
    .toLowerCase();

/// Shows of a section what is found. Returns whether there is anything.
function search_section(section, words) {
  const has_all = (text) => words.every((word) => text.includes(word));
  const [head, ...parts] = section.children,
    is_whole = has_all(texts_of(head));
  let is_found = is_whole;
  for (const part of parts) {
    const is_in = is_whole || (part.matches(kSettings) && has_all(texts_of(part)));
    part.classList.toggle("left_out", !is_in);
    is_found ||= is_in;
  }
  section.classList.toggle("left_out", !is_found);
  if (words.length) {
    section.dataset.was_open ??= section.open;
    section.open = is_found;
  } else if (section.dataset.was_open) {
    section.open = section.dataset.was_open === "true";
    delete section.dataset.was_open;
  }
  return is_found;
}

export function refresh_search() {
  const words = by_id("search").value.toLowerCase().split(/\s+/).filter(Boolean);
  const found = [...by_id("sections").querySelectorAll("details")].filter((section) => search_section(section, words));
  by_id("none_found").hidden = found.length > 0;
}

export function attach_search() {
  const box = by_id("search");
  box.addEventListener("input", refresh_search);
  box.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    box.value = "";
    refresh_search();
  });
}
