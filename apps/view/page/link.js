// The connection to the program: states out, frames in. A moving state is sent only when the one before has been
// answered, so that the program always works on the newest; a state at rest is sent at once and replaces any other.

const kRest_ms = 150; // after the last change the view is at rest
const kLost_ms = 5000; // a moving state without an answer no longer holds back the next one

/// Returns the header and the image of a binary message.
function frame_of(data) {
  const size = new DataView(data).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
  return [header, new Blob([new Uint8Array(data, 4 + size)], { type: header.format })];
}

/// Opens the socket of the page. `on` has opened(), text(message), frame(header, blob) and closed(sentence), which says
/// why. An error before the greeting is such a reason: the program does not take the page.
function open_socket(on) {
  const address = new URL("socket", document.baseURI);
  address.protocol = address.protocol.replace("http", "ws");
  address.hash = "";
  const socket = new WebSocket(address);
  let has_opened = false,
    is_greeted = false,
    refusal = "";
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    has_opened = true;
    on.opened();
  };
  socket.onmessage = (event) => {
    if (typeof event.data !== "string") return on.frame(...frame_of(event.data));
    const message = JSON.parse(event.data);
    is_greeted ||= message.type === "hello";
    if (is_greeted || message.type !== "error") on.text(message);
    else refusal = `The program refuses: ${message.message}.`;
  };
  socket.onclose = (event) => {
    const broken = has_opened ? "The connection to the program broke." : "The program does not answer.";
    if (event.reason) refusal ||= `The program refuses: ${event.reason}.`;
    on.closed(refusal || (event.wasClean ? "The program has ended." : broken));
  };
  return socket;
}

/// Ends a socket without a word to its handlers.
function drop_socket(socket) {
  socket.onopen = socket.onmessage = socket.onclose = null;
  socket.close();
}

/// Makes the connection. `make_state()` returns {size, model, views}, or null if there is nothing to ask for.
/// `on` has the functions sending(state), text(message), frame(header, blob), opened() and closed(sentence).
export function new_link(make_state, on) {
  const link = { connected: false, id: 0, sent: 0, socket: null };
  let is_dirty = false,
    is_moving = false,
    rest_timer = 0,
    scheduled = 0,
    waiting = null;

  function send_text(message) {
    if (link.socket?.readyState === WebSocket.OPEN) link.socket.send(JSON.stringify(message));
  }

  function flush() {
    cancelAnimationFrame(scheduled);
    scheduled = 0;
    if (!is_dirty || !link.connected) return;
    if (is_moving && waiting && performance.now() - waiting.since < kLost_ms) return;
    const made = make_state();
    if (!made) return;
    is_dirty = false;
    link.id += 1;
    link.sent += 1;
    const views = new Set(made.views.keys());
    waiting = is_moving ? { id: link.id, views, since: performance.now() } : null;
    const sent = { id: link.id, moving: is_moving, ...made };
    on.sending(sent);
    send_text({ type: "state", ...sent });
  }

  function answered(id, view) {
    if (!waiting || id < waiting.id) return;
    if (view === undefined) waiting = null;
    else if (waiting.views.delete(view) && waiting.views.size === 0) waiting = null;
    if (!waiting) flush();
  }

  /// Tells that the state has changed. `moving`: further changes are likely to follow at once.
  link.changed = (moving) => {
    is_dirty = true;
    clearTimeout(rest_timer);
    if (moving) rest_timer = setTimeout(() => link.changed(false), kRest_ms);
    is_moving = moving;
    if (!moving) flush();
    else if (!scheduled) scheduled = requestAnimationFrame(flush);
  };

  link.send = send_text;
  link.shown = (frame) => send_text({ type: "ack", frame });
  link.is_moving = () => is_moving;

  function set_connected(is_connected) {
    link.connected = is_connected;
    waiting = null;
  }

  /// Connects anew, in place of any connection that there is.
  link.connect = () => {
    if (link.socket) drop_socket(link.socket);
    set_connected(false);
    link.socket = open_socket({
      opened() {
        set_connected(true);
        on.opened();
      },
      text(message) {
        on.text(message);
        if (message.type === "error" && message.id !== undefined) answered(message.id, message.view);
      },
      frame(header, image) {
        answered(header.id, header.view);
        on.frame(header, image);
      },
      closed(sentence) {
        set_connected(false);
        on.closed(sentence);
      },
    });
  };
  return link;
}
