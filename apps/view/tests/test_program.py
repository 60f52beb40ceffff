"""The program behind the page: its end, its addresses, many states, and its memory."""
import http.client
import os
import statistics
import time
import unittest
import urllib.parse

from support import IS_LONG, MAX_WAIT_S, PageTest, Viewer, end_browser, start_browser

FRAMES = 10000 if IS_LONG else 300
MAX_GROWTH_BYTES = 20 << 20

# Sends states with a growing camera angle over an own socket and acknowledges each frame. Returns the frames.
STORM = """
const [count, done] = arguments, address = new URL("socket", document.baseURI);
address.protocol = "ws:";
address.hash = "";
const socket = new WebSocket(address), frames = [], errors = [], options = umbrage.options;
socket.binaryType = "arraybuffer";
socket.onopen = () => {
  for (let id = 1; id <= count; ++id)
    socket.send(JSON.stringify({ type: "state", id, moving: id < count, size: [320, 200], model: 0,
      views: [{ options: { ...options, "camera-view-angle": String(20 + 20 * id / count) }, show: "picture" }] }));
};
socket.onmessage = ({ data }) => {
  if (typeof data === "string") {
    if (JSON.parse(data).type === "error") errors.push(data);
    return;
  }
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, new DataView(data).getUint32(0, true))));
  frames.push(header);
  socket.send(JSON.stringify({ type: "ack", frame: header.frame }));
  if (header.id === count && header.samples > 0) { socket.close(); done({ frames, errors }); }
};
"""

# Orbits by 2 pixels for each picture that the page shows, until it has shown `count`.
ORBIT = """
const [count, done] = arguments, canvas = document.querySelector("#picture"), first = umbrage.frames;
const send = (type, x, buttons) => canvas.dispatchEvent(new PointerEvent(type, { bubbles: true, cancelable: true, pointerId: 1,
  pointerType: "mouse", isPrimary: true, button: type === "pointermove" ? -1 : 0, buttons, clientX: x, clientY: 300 }));
canvas.setPointerCapture = () => {};
let x = 300, shown = -1;
send("pointerdown", x, 1);
const step = () => {
  if (umbrage.frames !== shown) {
    shown = umbrage.frames;
    send("pointermove", x += 2, 1);
  }
  if (shown - first < count) return setTimeout(step, 2);
  send("pointerup", x, 0);
  done(shown - first);
};
step();
"""

# Connects without ever acknowledging a frame, and asks for pictures.
SLOW_CLIENT = """
const done = arguments[0], address = new URL("socket", document.baseURI);
address.protocol = "ws:";
address.hash = "";
window.slow = new WebSocket(address);
slow.onopen = () => {
  for (let id = 1; id <= 50; ++id)
    slow.send(JSON.stringify({ type: "state", id, moving: true, size: [320, 200], model: 0, views: [{ options: umbrage.options, show: "picture" }] }));
  done(true);
};
"""


def resident_bytes(pid):
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


class ProgramTest(PageTest):
    def request(self, path, method="GET", **headers):
        host = urllib.parse.urlsplit(self.viewer.address).netloc
        connection = http.client.HTTPConnection(host, timeout=MAX_WAIT_S)
        try:
            connection.request(method, path, headers=headers)
            answer = connection.getresponse()
            return answer.status, answer.read().decode(errors="replace"), answer.headers
        finally:
            connection.close()

    def test_addresses(self):
        token = urllib.parse.urlsplit(self.viewer.address).path
        for path in ("/", "/" + "0" * 32 + "/", token[:-2] + "/", token + "other", token + "../etc/passwd", "/favicon.ico"):
            status, text, _ = self.request(path)
            self.assertEqual(status, 404, path)
            self.assertNotIn(token.strip("/"), text)
        status, text, headers = self.request(token)
        self.assertEqual(status, 200)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertEqual(self.request(token, "DELETE")[0], 405)
        status, _, _ = self.request(token + "socket", Origin="http://example.com", Upgrade="websocket", Connection="Upgrade",
                                    **{"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version": "13"})
        self.assertEqual(status, 403)

    def test_a_storm_is_answered_by_the_last_state(self):
        self.browser.set_script_timeout(MAX_WAIT_S)
        answer = self.browser.execute_async_script(STORM, 1000)
        self.assertEqual(answer["errors"], [])
        ids = [frame["id"] for frame in answer["frames"]]
        self.assertEqual(ids, sorted(ids))
        self.assertEqual(ids[-1], 1000)
        moving = [frame for frame in answer["frames"] if frame["moving"]]
        self.assertLess(len(moving), 500)  # older states are left out

    def test_a_slow_client_does_not_stall_others(self):
        self.browser.execute_async_script(SLOW_CLIENT)
        before = self.page("umbrage.frames")
        self.drag((300, 260), (360, 270))
        self.wait_for_rest()
        self.assertGreater(self.page("umbrage.frames"), before)
        self.browser.execute_script("slow.close()")

    def resident_at_rest(self):
        """Returns the min of readings over a second, since memory is given back after the last picture is sent."""
        readings = []
        for _ in range(10):
            time.sleep(0.1)
            readings.append(resident_bytes(self.viewer.process.pid))
        return min(readings)

    def test_frames_leave_no_memory(self):
        """Compares what is resident at rest, when the program has given back what it used while the model moved."""
        self.browser.set_script_timeout(60 * MAX_WAIT_S)
        self.browser.execute_async_script(ORBIT, 150)
        resident = []
        for _ in range(6):
            self.assertGreaterEqual(self.browser.execute_async_script(ORBIT, FRAMES // 3), FRAMES // 3)
            self.wait_for_final()
            resident.append(self.resident_at_rest())
        growth = statistics.median(resident[3:]) - statistics.median(resident[:3])  # of FRAMES frames
        self.assertLess(growth, MAX_GROWTH_BYTES)


class EndTest(unittest.TestCase):
    def test_ctrl_c_and_once(self):
        browser = start_browser(640, 400)
        self.addCleanup(end_browser, browser)
        test = ProgramTest()
        test.browser, test.viewer = browser, Viewer(*ProgramTest.words)
        self.addCleanup(test.viewer.end)
        test.open()
        self.assertTrue(test.page("document.querySelector('#ended').hidden"))
        self.assertEqual(test.viewer.end(), 0)
        test.wait_for("!document.querySelector('#ended').hidden && !umbrage.connected", "the banner")
        test.screenshot("ended")
        once = test.viewer = Viewer(*ProgramTest.words, "--once")
        self.addCleanup(once.end)
        test.open()
        browser.refresh()  # a reload is no end
        test.wait_for_rest()
        self.assertIsNone(once.process.poll())
        browser.get("about:blank")
        self.assertEqual(once.process.wait(timeout=MAX_WAIT_S), 0)


if __name__ == "__main__":
    unittest.main()
