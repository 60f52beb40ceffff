"""Starts `umbrage view` and a headless Chromium for tests of the page."""
import base64
import glob
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

PROGRAM = os.environ["UMBRAGE_PROGRAM"]
SCREENSHOTS = os.environ.get("UMBRAGE_SCREENSHOTS")  # a folder that receives screenshots, to look at
IS_LONG = "UMBRAGE_LONG" in os.environ  # runs the tests that take minutes at full length
MAX_WAIT_S = float(os.environ.get("UMBRAGE_MAX_WAIT_S", "60"))  # on a loaded machine; tests wait for conditions, not times
BROWSER = shutil.which("chromium") or "/usr/bin/chromium"
DRIVER = shutil.which("chromedriver") or "/usr/bin/chromedriver"

# Returns the frame of the newest state if the page shows it with its settings, not a quick one that comes before.
AT_REST = """
const page = window.umbrage;
if (!page?.connected || page.moving) return null;
const is_newest = frame => frame && frame.id === page.id && !frame.moving && frame.samples > 0, state = page.state;
const is_flat = state.models.find(model => model.id === state.model)?.kind === "gbuffer";
if (!state.scenes[state.model] || !(is_flat || state.cameras[state.model])) return null;
return is_newest(page.frame) && (state.compare === "off" || is_newest(page.frame_b)) ? page.frame : null;
"""

# Returns the picture at 48x30 pixels, red, green and blue of each, composed on black.
THUMBNAIL = """
const small = document.createElement("canvas"), pen = small.getContext("2d");
[small.width, small.height] = [48, 30];
pen.fillRect(0, 0, 48, 30);
pen.imageSmoothingQuality = "high";
pen.drawImage(document.querySelector("#picture"), 0, 0, 48, 30);
return [...pen.getImageData(0, 0, 48, 30).data].filter((_, i) => i % 4 < 3);
"""

# Drops files on the page: arguments are [name, content in base64] pairs.
DROP = """
const transfer = new DataTransfer();
for (const [name, text] of arguments[0])
  transfer.items.add(new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], name));
for (const type of ["dragenter", "dragover", "drop"])
  document.querySelector("#picture").dispatchEvent(new DragEvent(type, {bubbles: true, cancelable: true, dataTransfer: transfer}));
"""


def difference(a, b):
    """Returns the mean absolute difference of two thumbnails, 0 to 255."""
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def mean(values):
    return sum(values) / len(values)


class Viewer:
    """A running `umbrage view`. `address` is that of its page."""

    def __init__(self, *words):
        self.process = subprocess.Popen(
            [PROGRAM, "view", "--no-open", "--config", "none", *words],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        if not re.fullmatch(r"http://[^/]+/[0-9a-f]{32}/", self.address):
            raise AssertionError(f"no address: {self.address!r} {self.process.stderr.read()!r}")

    def end(self):
        """Ends the program as Ctrl-C does. Returns its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(timeout=MAX_WAIT_S)
        finally:
            self.process.kill()
            self.process.stdout.close()
            self.process.stderr.close()


def start_browser(width=960, height=600, **emulated):
    """Starts Chromium with a window whose page has this size, CSS pixels."""
    profile = tempfile.mkdtemp(prefix="umbrage-chromium-")
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync",
                 "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={profile}"):
        options.add_argument(word)
    options.add_experimental_option("prefs", {"download.default_directory": os.path.join(profile, "downloads")})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service(DRIVER), options=options)
    browser.profile = profile
    resize(browser, width, height, **emulated)
    return browser


def resize(browser, width, height, scale=1, mobile=False):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": mobile})
    # The page observes its new size when it is painted next; before, it would still rest.
    browser.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")


def end_browser(browser):
    browser.quit()
    shutil.rmtree(browser.profile, ignore_errors=True)


class PageTest(unittest.TestCase):
    """A test with one viewer and one browser for all methods of the class."""

    words = ("scene:solids?detail=3000", "--look", "ao")  # arguments of `umbrage view`
    expected_errors = ()  # patterns of messages on the console that a test causes on purpose

    @classmethod
    def setUpClass(cls):
        cls.viewer = Viewer(*cls.words)
        try:
            cls.browser = start_browser()
        except BaseException:
            cls.viewer.end()
            raise

    @classmethod
    def tearDownClass(cls):
        end_browser(cls.browser)
        cls.viewer.end()

    def setUp(self):
        self.open()

    def tearDown(self):
        """Fails on any error that the page reported on its console."""
        errors = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]
        unexpected = [error for error in errors if not any(re.search(known, error) for known in self.expected_errors)]
        self.assertEqual(unexpected, [])

    def open(self, fragment="", address=None):
        self.browser.get("about:blank")
        self.browser.get((address or self.viewer.address) + fragment)
        self.wait_for_rest()

    def page(self, expression, *arguments):
        """Returns the value of a JavaScript expression in the page."""
        return self.browser.execute_script(f"return {expression};", *arguments)

    def wait(self, condition, what, limit_s=MAX_WAIT_S):
        """Waits until the function `condition` returns something true, and returns it."""
        end = time.monotonic() + limit_s
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            time.sleep(0.01)
        self.fail(f"waited {limit_s} s for {what}; errors: {self.errors()}, frame and state: "
                  + self.page("JSON.stringify([umbrage.id, umbrage.frame, umbrage.frame_b, {...umbrage.state, hello: 0}])")[:2000])

    def wait_for(self, expression, what=None, limit_s=MAX_WAIT_S):
        """Waits until a JavaScript expression is true, and returns it."""
        return self.wait(lambda: self.page(expression), what or expression, limit_s)

    def wait_for_rest(self):
        """Waits for the picture of a still of the newest state. Returns the header of its frame."""
        return self.wait(lambda: self.browser.execute_script(AT_REST), "a picture at rest")

    def wait_for_final(self):
        """Waits for the picture that is refined no further."""
        self.wait_for_rest()
        return self.wait_for("umbrage.frame.id === umbrage.id && umbrage.frame.final && umbrage.frame", "a final picture")

    def thumbnail(self):
        return self.browser.execute_script(THUMBNAIL)

    def errors(self):
        """Returns the messages in the page's boxes of errors."""
        return self.page("[...document.querySelectorAll('[data-testid=error] span')].map(box => box.textContent)")

    def element(self, test_id):
        return self.browser.find_element(By.CSS_SELECTOR, f"[data-testid='{test_id}']")

    def click(self, selector):
        """Opens the sections around an element, scrolls to it and clicks it."""
        self.browser.execute_script("""
            const found = document.querySelector(arguments[0]);
            for (let at = found; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
            found.scrollIntoView({block: "center"});""", selector)
        self.browser.find_element(By.CSS_SELECTOR, selector).click()

    def choose(self, selector, value):
        """Chooses an entry of a select element, in sections that it opens."""
        self.browser.execute_script("""
            for (let at = document.querySelector(arguments[0]); at; at = at.parentElement)
              if (at.tagName === "DETAILS") at.open = true;""", selector)
        Select(self.browser.find_element(By.CSS_SELECTOR, selector)).select_by_value(value)

    def slide(self, test_id, place):
        """Moves the slider of a row, 0 to 1, as a drag does, and lets it go."""
        self.wait_for(f"""document.querySelector("[data-testid='{test_id}'] input[type=range]")""", "the slider " + test_id)
        self.browser.execute_script("""
            const slider = document.querySelector(`[data-testid="${arguments[0]}"] input[type=range]`);
            slider.value = arguments[1];
            for (const type of ["input", "change"]) slider.dispatchEvent(new Event(type, {bubbles: true}));""", test_id, place)

    def press(self, *keys):
        ActionChains(self.browser).send_keys(*keys).perform()

    def press_with(self, modifier, key):
        ActionChains(self.browser).key_down(modifier).send_keys(key).key_up(modifier).perform()

    def drag(self, begin, end, button="left", key=None, steps=4):
        """Drags the mouse over the picture, in CSS pixels of the page."""
        numbers = {"left": ("left", 1), "middle": ("middle", 4), "right": ("right", 2)}
        name, bit = numbers[button]
        modifiers = 8 if key == Keys.SHIFT else 0

        def send(kind, x, y, **more):
            self.browser.execute_cdp_cmd("Input.dispatchMouseEvent",
                                         {"type": kind, "x": x, "y": y, "modifiers": modifiers, **more})

        send("mouseMoved", *begin)
        send("mousePressed", *begin, button=name, buttons=bit, clickCount=1)
        for step in range(1, steps + 1):
            x, y = (a + (b - a) * step / steps for a, b in zip(begin, end))
            send("mouseMoved", x, y, button=name, buttons=bit)
        send("mouseReleased", *end, button=name, clickCount=1)

    def wheel(self, at, delta):
        self.browser.execute_cdp_cmd("Input.dispatchMouseEvent",
                                     {"type": "mouseWheel", "x": at[0], "y": at[1], "deltaX": 0, "deltaY": delta})

    def touch(self, kind, points):
        self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {
            "type": kind, "touchPoints": [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]})

    def options(self):
        """Returns the options of the newest state: name and text."""
        return self.page("umbrage.options")

    def camera(self):
        """Returns the camera as the page keeps it: focal, right, up, back, distance, angle_deg, orthographic."""
        return self.page("umbrage.state.cameras[umbrage.state.model]")

    def drop(self, files):
        """Drops files on the page: names and bytes."""
        self.browser.execute_script(DROP, [[name, base64.b64encode(data).decode()] for name, data in files.items()])

    def download(self, pattern):
        """Waits for a file that the page gives the user. Returns its bytes, and removes it."""
        folder = os.path.join(self.browser.profile, "downloads")
        found = self.wait(lambda: [name for name in glob.glob(os.path.join(folder, pattern))
                                   if not name.endswith(".crdownload")], f"the download {pattern}")
        with open(found[0], "rb") as file:
            data = file.read()
        os.remove(found[0])
        return data

    def screenshot(self, name):
        """Writes a screenshot, to look at, if UMBRAGE_SCREENSHOTS names a folder."""
        if SCREENSHOTS:
            os.makedirs(SCREENSHOTS, exist_ok=True)
            self.browser.save_screenshot(os.path.join(SCREENSHOTS, name + ".png"))
