// The sheet of keys. The table is the one place that lists them.
import { by_id, element } from "./dom.js";

export const kKeys = [
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
      ["Ctrl + Y, Ctrl + Z", "up axis of the model"],
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
      ["Q", "occlusion on, off"],
      ["A", "anti-aliasing on, off (tap)"],
      ["T", "tone curve on, off"],
      ["G", "ground: auto, on, off"],
      ["E", "lines on, off"],
      ["B", "buffer: next"],
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

export function toggle_help() {
  const sheet = by_id("help");
  if (sheet.open) sheet.close();
  else sheet.showModal();
}
