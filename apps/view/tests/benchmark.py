#!/usr/bin/python3
"""Measures the viewer end to end in a headless browser: frames per second while orbiting, time from a slider to the
picture, time until the page is usable, and processor time at rest.

UMBRAGE_PROGRAM=build/bin/umbrage apps/view/tests/benchmark.py MODEL [options of umbrage view]
"""
import os
import statistics
import sys
import time

from support import Viewer, end_browser, start_browser

ORBIT_S = 6.0
IDLE_S = 5.0
SLIDER_STEPS = 25

# Orbits by 2 pixels for each animation frame, as a drag of the mouse does, and counts the frames that the page shows.
ORBIT = """
const [seconds, done] = arguments, canvas = document.querySelector("canvas");
const send = (type, x, buttons) => canvas.dispatchEvent(new PointerEvent(type, {
  bubbles: true, cancelable: true, pointerId: 1, pointerType: "mouse", isPrimary: true, button: type === "pointermove" ? -1 : 0,
  buttons, clientX: x, clientY: 300 }));
let x = 400, begin = 0, first = 0;
const sizes = [];
send("pointerdown", x, 1);
const step = now => {
  if (!begin) { begin = now; first = window.umbrage.frames; }
  sizes.push(window.umbrage.frame.width);
  send("pointermove", x += 2, 1);
  if (now - begin < 1000 * seconds) return requestAnimationFrame(step);
  send("pointerup", x, 0);
  done({ frames: window.umbrage.frames - first, seconds: (now - begin) / 1000, widths: sizes });
};
requestAnimationFrame(step);
"""

# Changes the first range input and waits for the first frame of the new state.
SLIDE = """
const [fraction, done] = arguments, slider = document.querySelector("input[type=range]");
const begin = performance.now();
slider.value = Number(slider.min) + fraction * (Number(slider.max) - Number(slider.min));
slider.dispatchEvent(new Event("input", { bubbles: true }));
const wanted = window.umbrage.state.id, look = () =>
  window.umbrage.frame.id > wanted || (window.umbrage.state.id > wanted && window.umbrage.frame.id >= window.umbrage.state.id)
    ? done(performance.now() - begin) : setTimeout(look, 1);
look();
"""


def wait_for_rest(browser):
    while not browser.execute_script("return window.umbrage?.atRest()"):
        time.sleep(0.05)


def processor_s(pid):
    """Returns the processor time of a process, seconds."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        words = file.read().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def main(words):
    viewer = Viewer(*words)
    browser = start_browser()
    browser.set_script_timeout(120)
    try:
        browser.get(viewer.address)
        load_ms = browser.execute_script(
            "const n = performance.getEntriesByType('navigation')[0]; return n.domContentLoadedEventEnd;")
        wait_for_rest(browser)
        browser.execute_async_script(ORBIT, 1.0)  # finds the resolution
        orbit = browser.execute_async_script(ORBIT, ORBIT_S)
        wait_for_rest(browser)
        slides = [browser.execute_async_script(SLIDE, (k + 1) / (SLIDER_STEPS + 1)) for k in range(SLIDER_STEPS)]
        while not browser.execute_script("return window.umbrage.frame.final"):
            time.sleep(0.1)
        before = processor_s(viewer.process.pid)
        time.sleep(IDLE_S)
        idle = (processor_s(viewer.process.pid) - before) / IDLE_S
        print(f"orbit {orbit['frames'] / orbit['seconds']:.1f} frames/s at a width of "
              f"{statistics.median(orbit['widths']):.0f} pixels, slider to picture {statistics.median(slides):.0f} ms "
              f"(max {max(slides):.0f}), page ready after {load_ms:.0f} ms, idle {100 * idle:.1f} % of a core")
    finally:
        end_browser(browser)
        viewer.end()


if __name__ == "__main__":
    main(sys.argv[1:] or ["scene:atrium"])
