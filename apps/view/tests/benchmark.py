#!/usr/bin/python3
"""Measures the viewer end to end in a headless browser: frames per second while orbiting, time from a slider to the
picture, time until the page is usable, and processor time at rest.

UMBRAGE_PROGRAM=build/bin/umbrage apps/view/tests/benchmark.py MODEL [options of umbrage view]

It prints the median of some runs, with min and max. The window is 1280 x 720 pixels and all of it is the picture.
"""
import os
import statistics
import sys
import time

from support import AT_REST, Viewer, end_browser, resize, start_browser

RUNS = 3
ORBIT_S = 5.0
IDLE_S = 4.0
SLIDER_STEPS = 15
PAUSE_S = 0.4  # between two moves of the slider, in which the picture at rest is begun
SIZE = (1280, 720)

# Orbits by 2 pixels for each animation frame, as a drag of the mouse does, and counts the frames that the page shows.
ORBIT = """
const [seconds, done] = arguments, canvas = document.querySelector("#picture");
canvas.setPointerCapture = () => {};  // there is no such pointer
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

# Moves the slider of the occlusion's strength and waits for the first picture of the new state.
SLIDE = """
const [fraction, done] = arguments, slider = document.querySelector("[data-testid=option-ao-strength] input[type=range]");
const begin = performance.now(), before = umbrage.id;
slider.value = fraction;
slider.dispatchEvent(new Event("input", { bubbles: true }));
const look = () => umbrage.frame.id > before ? done(performance.now() - begin) : setTimeout(look, 1);
look();
"""


def wait_for_rest(browser):
    while not browser.execute_script(AT_REST):
        time.sleep(0.02)


def processor_s(pid):
    """Returns the processor time of a process, seconds."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        words = file.read().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def wait_for_final(browser):
    while not browser.execute_script("return umbrage.frame?.id === umbrage.id && umbrage.frame.final"):
        time.sleep(0.1)


def measure(words):
    """Returns the figures of one run: orbit frames/s, width of its frames, slider ms, load ms, idle percent of a core."""
    viewer = Viewer(*words)
    browser = start_browser(*SIZE)
    browser.set_script_timeout(120)
    try:
        browser.get(viewer.address)
        load_ms = browser.execute_script(
            "return performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd;")
        wait_for_rest(browser)
        browser.execute_script("document.querySelector('#panel_toggle').click()")  # the picture fills the window
        browser.execute_async_script(ORBIT, 1.5)  # finds the resolution
        orbit = browser.execute_async_script(ORBIT, ORBIT_S)
        wait_for_rest(browser)
        slides = []
        for step in range(SLIDER_STEPS):
            time.sleep(PAUSE_S)
            slides.append(browser.execute_async_script(SLIDE, 0.2 + 0.6 * ((7 * step) % SLIDER_STEPS) / SLIDER_STEPS))
        resize(browser, 160, 100)  # so that it is soon refined
        wait_for_final(browser)
        before = processor_s(viewer.process.pid)
        time.sleep(IDLE_S)
        idle = (processor_s(viewer.process.pid) - before) / IDLE_S
        return (orbit["frames"] / orbit["seconds"], statistics.median(orbit["widths"]), statistics.median(slides), load_ms,
                100 * idle)
    finally:
        end_browser(browser)
        viewer.end()


def main(words):
    runs = list(zip(*(measure(words) for _ in range(RUNS))))
    names = ("orbit, frames/s", "orbit, width of a frame in pixels", "slider to picture, ms", "page ready, ms", "idle, % of a core")
    for name, values in zip(names, runs):
        print(f"{name}: {statistics.median(values):.1f} ({min(values):.1f} to {max(values):.1f})")


if __name__ == "__main__":
    main(sys.argv[1:] or ["scene:atrium"])
