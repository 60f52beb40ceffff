// Time per stage of the newest frame, as a stacked bar with a legend, and the times of the last frames.
import { by_id, element, section } from "./dom.js";
import { stage } from "./stage.js";

const kColors = 8,
  kHistory = 60;
const past = [];
let drawn = null;

export function times_section() {
  return section(
    "times",
    "Drawing time",
    false,
    element("div", { id: "stack", role: "img" }),
    element("ol", { id: "stages" }),
    element("canvas", { id: "history", height: 36, role: "img", "aria-label": "Times of the last frames" }),
    element("p", { class: "summary", id: "history_text" }),
  );
}

/// Returns a time for display.
export const ms_text = (ms) =>
  ms < 9.95 ? `${ms.toFixed(1)} ms` : ms < 9950 ? `${Math.round(ms)} ms` : `${(ms / 1000).toFixed(1)} s`;

/// Remembers the time of a frame.
export function note_time(header) {
  if (header.view !== 0 || !(header.ms >= 0)) return;
  past.push(header.ms);
  if (past.length > kHistory) past.shift();
}

/// Draws if the section is open and there is something new.
export function draw_times() {
  const header = stage.last;
  if (!header || header === drawn || !by_id("section_times")?.open) return;
  drawn = header;
  const stages = (header.stages ?? []).filter(([, ms]) => ms > 0),
    total = stages.reduce((sum, [, ms]) => sum + ms, 0) || 1;
  const color = (i) => `var(--s${i % kColors})`;
  by_id("stack").replaceChildren(
    ...stages.map(([name, ms], i) =>
      element("span", { style: `flex-grow:${ms / total};background:${color(i)}`, title: `${name} ${ms_text(ms)}` }),
    ),
  );
  by_id("stack").setAttribute("aria-label", `Time of the frame: ${ms_text(header.ms)}`);
  by_id("stages").replaceChildren(
    ...stages.map(([name, ms], i) =>
      element(
        "li",
        {},
        element("i", { style: `background:${color(i)}` }),
        element("span", { text: name }),
        element("b", { text: ms_text(ms) }),
      ),
    ),
  );
  draw_history();
}

function draw_history() {
  const canvas = by_id("history"),
    pen = canvas.getContext("2d");
  canvas.width = Math.max(1, canvas.clientWidth * devicePixelRatio);
  canvas.height = Math.max(1, canvas.clientHeight * devicePixelRatio);
  const max = Math.max(...past, 1),
    step = canvas.width / kHistory;
  pen.fillStyle = getComputedStyle(canvas).color;
  past.forEach((ms, i) => {
    const height = Math.max(1, (ms / max) * canvas.height);
    pen.fillRect(i * step, canvas.height - height, Math.max(1, step - 1), height);
  });
  const sorted = [...past].sort((a, b) => a - b);
  by_id("history_text").textContent =
    `last ${past.length === 1 ? "frame" : `${past.length} frames`}: median ${ms_text(sorted[sorted.length >> 1])}, max ${ms_text(max)}`;
}
