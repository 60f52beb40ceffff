"""Starts `umbrage view` and a headless Chromium for tests of the page."""
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PROGRAM = os.environ["UMBRAGE_PROGRAM"]
SCREENSHOTS = os.environ.get("UMBRAGE_SCREENSHOTS")  # a folder that receives screenshots, to look at
MAX_WAIT_S = 60  # on a loaded machine; a test waits only until its condition holds


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
            self.process.send_signal(2)
        code = self.process.wait(timeout=MAX_WAIT_S)
        self.process.stdout.close()
        self.process.stderr.close()
        return code


def start_browser(width=1280, height=720, **emulated):
    """Starts Chromium with a window whose page has this size, CSS pixels."""
    profile = tempfile.mkdtemp(prefix="umbrage-chromium-")
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or "/usr/bin/chromium"
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync",
                 "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={profile}"):
        options.add_argument(word)
    options.add_experimental_option("prefs", {"download.default_directory": profile})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service(shutil.which("chromedriver") or "/usr/bin/chromedriver"),
                               options=options)
    browser.profile = profile
    resize(browser, width, height, **emulated)
    return browser


def resize(browser, width, height, scale=1, mobile=False):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": mobile})


def end_browser(browser):
    browser.quit()
    shutil.rmtree(browser.profile, ignore_errors=True)


class PageTest(unittest.TestCase):
    """A test with one viewer and one browser for all methods of the class."""

    words = ("scene:solids", "--look", "ao")  # arguments of `umbrage view`

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
        self.assertEqual(errors, [])

    def open(self, fragment=""):
        self.browser.get("about:blank")
        self.browser.get(self.viewer.address + fragment)
        self.wait_for_rest()

    def page(self, expression):
        """Returns the value of a JavaScript expression in the page."""
        return self.browser.execute_script(f"return {expression};")

    def wait(self, condition, what, limit_s=MAX_WAIT_S):
        """Waits until the function `condition` returns something true, and returns it."""
        end = time.monotonic() + limit_s
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            time.sleep(0.02)
        self.fail(f"waited {limit_s} s for {what}: {self.page('JSON.stringify(window.umbrage || null)')}")

    def wait_for_rest(self):
        """Waits for the picture of a still of the newest state."""
        return self.wait(lambda: self.page("window.umbrage?.atRest() ? window.umbrage.frame : null"),
                         "a picture at rest")

    def element(self, test_id):
        return self.browser.find_element(By.CSS_SELECTOR, f"[data-testid='{test_id}']")

    def press(self, *keys):
        ActionChains(self.browser).send_keys(*keys).perform()

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
        return self.page("window.umbrage.state.views[0].options")

    def screenshot(self, name):
        """Writes a screenshot, to look at, if UMBRAGE_SCREENSHOTS names a folder."""
        if SCREENSHOTS:
            os.makedirs(SCREENSHOTS, exist_ok=True)
            self.browser.save_screenshot(os.path.join(SCREENSHOTS, name + ".png"))
