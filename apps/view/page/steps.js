// Undo and redo: one history of the whole state, whatever has changed it. A step ends when the state rests; while a
// pointer is held it does not, so that a drag or a slider's movement is one step.
import { by_id } from "./dom.js";
import { state, state_text, take_state_text, hooks } from "./state.js";

const kMaxSteps = 500;
const undone = [],
  done = [], // states before the present one, the newest last
  held = new Set(); // pointers that are down
let present = null;

function show_steps() {
  by_id("undo").disabled = !done.length;
  by_id("redo").disabled = !undone.length;
}

/// Takes note of the state if it differs from the one noted last. The first one begins the history.
export function note_step() {
  const text = state_text();
  if (!state.hello || held.size || text === present) return;
  if (present !== null) {
    done.push(present);
    if (done.length > kMaxSteps) done.shift();
    undone.length = 0;
  }
  present = text;
  show_steps();
}

/// Goes to the newest state of `from` that differs from the present one, as one whose model has been closed may not.
/// Returns whether there is one.
function go(from, to) {
  held.clear();
  note_step();
  const start = present;
  while (from.length && present === start) {
    take_state_text(from.pop());
    present = state_text();
  }
  if (present !== start) {
    to.push(start);
    hooks.taken();
  }
  show_steps();
  return present !== start;
}

export const undo = () => go(done, undone);
export const redo = () => go(undone, done);

/// Ends a step before each press of a button or of a key, and after a pointer is let go.
export function attach_steps() {
  const release = (event) => held.delete(event.pointerId) && hooks.remember();
  addEventListener(
    "pointerdown",
    (event) => {
      if (event.isPrimary) held.clear();
      note_step();
      held.add(event.pointerId);
    },
    true,
  );
  // The list of a select element takes the end of the press.
  addEventListener("pointermove", (event) => event.buttons || release(event), true);
  addEventListener("pointerup", release, true);
  addEventListener("pointercancel", release, true);
  addEventListener("keydown", (event) => event.repeat || note_step(), true);
  by_id("undo").addEventListener("click", undo);
  by_id("redo").addEventListener("click", redo);
}
