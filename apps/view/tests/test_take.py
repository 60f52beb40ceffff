"""What is taken away: saved files, copied texts, settings and links, which all give the same picture."""
import base64
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import PROGRAM, By, Keys, PageTest, difference, resize

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
LIBRARY = os.environ.get("UMBRAGE_LIBRARY")
COMPILER = os.environ.get("UMBRAGE_COMPILER", "c++")


# Returns how many colour values of two PNG files, in base64, differ, and the max difference.
COMPARE = """
const [first, second, done] = arguments;
const pixels = async text => {
  const blob = new Blob([Uint8Array.from(atob(text), c => c.charCodeAt(0))], {type: "image/png"}), bitmap = await createImageBitmap(blob);
  const pen = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  pen.drawImage(bitmap, 0, 0);
  return pen.getImageData(0, 0, bitmap.width, bitmap.height).data;
};
Promise.all([pixels(first), pixels(second)]).then(([a, b]) => {
  if (a.length !== b.length) return done([a.length, b.length]);
  const differences = [...a].map((x, i) => Math.abs(x - b[i])).filter(x => x);
  done([differences.length, Math.max(0, ...differences)]);
});
"""


# Compares a PNG, in base64, with the canvas, both of one width around their middle, made smaller, which removes noise. Gives
# the mean difference, 0 to 255, and that of the PNG made 2 % larger.
DIFFERENCE_FROM_CANVAS = """
const [text, done] = arguments, canvas = document.querySelector("#picture");
const width = 100, height = Math.round(width * canvas.height / canvas.width);
const pixels = (image, scale) => {
  const pen = new OffscreenCanvas(width, height).getContext("2d"), high = image.height / image.width * width * scale;
  pen.imageSmoothingQuality = "high";
  pen.drawImage(image, (1 - scale) / 2 * width, (height - high) / 2, scale * width, high);
  return pen.getImageData(0, 0, width, height).data;
};
const mean = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / (0.75 * a.length);
createImageBitmap(new Blob([Uint8Array.from(atob(text), c => c.charCodeAt(0))])).then(image => {
  const seen = pixels(canvas, 1);
  done([mean(seen, pixels(image, 1)), mean(seen, pixels(image, 1.02))]);
});
"""


def run(words, folder, **more):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, **more)
    if done.returncode:
        raise AssertionError(f"{words} ended with {done.returncode}: {done.stderr}")


def read(folder, name):
    with open(os.path.join(folder, name), "rb") as file:
        return file.read()


class TakeTest(PageTest):
    def setUp(self):
        super().setUp()
        self.folder = tempfile.mkdtemp(prefix="umbrage-take-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.click("#section_take summary") if not self.page("document.querySelector('#section_take').open") else None
        self.choose("#save_size", "")
        for name, value in (("save_width", 160), ("save_height", 100)):
            self.browser.execute_script("document.querySelector('#' + arguments[0]).value = arguments[1]", name, value)

    def change_settings(self):
        """Sets options of several kinds: camera, numbers, a choice, a colour and a parameter."""
        self.drag((300, 260), (340, 280))
        self.choose("#technique", "bitmask")
        self.slide("option-ao-strength", 0.9)
        self.slide("parameter-bitmask.steps", 0.6)
        box = self.element("option-background-color").find_element(By.CSS_SELECTOR, "input[type=text]")
        self.browser.execute_script("""arguments[0].value = '#204060';
            arguments[0].dispatchEvent(new Event('change', {bubbles: true}));""", box)
        self.wait(lambda: {"ao", "ao-strength", "set", "background-color"} <= self.options().keys(), "the options")
        self.wait_for_rest()

    def save(self, ending="png"):
        self.choose("#save_format", ending)
        self.click("#save")
        data = self.download("*." + ending)
        self.wait_for("!document.querySelector('#save').disabled")
        self.assertEqual(self.errors(), [])
        return data

    def size_of(self, png):
        return [int.from_bytes(png[at:at + 4], "big") for at in (16, 20)]

    def assert_same_picture(self, a, b):
        texts = [base64.b64encode(data).decode() for data in (a, b)]
        self.assertEqual(self.browser.execute_async_script(COMPARE, *texts), [0, 0])

    def copied(self, button):
        self.click("#" + button)
        text = self.page("document.querySelector('#copied').textContent")
        self.screenshot(button)
        return text

    def test_the_copied_command_draws_the_saved_picture(self):
        self.change_settings()
        saved = self.save()
        command = self.copied("copy_command")
        words = shlex.split(command)
        self.assertEqual(words[:2], ["umbrage", "render"])
        run([PROGRAM, *words[1:], "--config", "none"], self.folder)
        self.assertEqual(read(self.folder, "picture.png"), saved)
        # The picture of the page is that of the command as well, apart from size and averaging.
        self.assertEqual(saved[:4], b"\x89PNG")

    def test_the_copied_python_draws_the_saved_picture(self):
        if not LIBRARY:
            self.skipTest("UMBRAGE_LIBRARY names no library")
        self.change_settings()
        saved = self.save()
        text = self.copied("copy_python")
        run([sys.executable, "-c", text], self.folder, env={**os.environ, "PYTHONPATH": os.path.join(SOURCE, "python")})
        self.assert_same_picture(read(self.folder, "picture.png"), saved)

    def test_the_copied_cpp_draws_the_saved_picture(self):
        if not LIBRARY:
            self.skipTest("UMBRAGE_LIBRARY names no library")
        self.change_settings()
        saved = self.save()
        with open(os.path.join(self.folder, "picture.cpp"), "w", encoding="utf-8") as file:
            file.write(self.copied("copy_cpp"))
        run([COMPILER, "-std=c++20", "-I", os.path.join(SOURCE, "include"), "picture.cpp", "-o", "draw", LIBRARY,
             "-Wl,-rpath," + os.path.dirname(LIBRARY)], self.folder)
        run(["./draw"], self.folder)
        self.assert_same_picture(read(self.folder, "picture.png"), saved)

    def test_settings_are_a_configuration_file(self):
        self.change_settings()
        saved = self.save()
        self.click("#settings_save")
        settings = self.download("*.json")
        self.assertEqual(json.loads(settings)["ao"], "bitmask")
        with open(os.path.join(self.folder, "settings.json"), "wb") as file:
            file.write(settings)
        run([PROGRAM, "render", self.words[0], "--config", "settings.json", "--resolution", "160,100", "-o", "picture.png"], self.folder)
        self.assertEqual(read(self.folder, "picture.png"), saved)
        # The page takes the file back.
        options = self.options()
        self.open("#look=lit")
        self.browser.find_element(By.CSS_SELECTOR, "#settings_file").send_keys(os.path.join(self.folder, "settings.json"))
        self.wait(lambda: self.options() == options, "the loaded settings")
        self.wait_for_rest()

    def differing(self, saved):
        """Returns the mean and the max difference, 0 to 255, of a saved PNG from the canvas, where the two have one size."""
        return self.browser.execute_async_script(DIFFERENCE_FROM_CANVAS, base64.b64encode(saved).decode())

    def test_the_saved_picture_is_the_one_of_the_view(self):
        # Of any shape of the window: at the same size it has the same framing.
        try:
            for width, height, scale in ((800, 400, 1), (320, 480, 1), (400, 300, 2)):
                resize(self.browser, width, height, scale)
                self.open("#show=albedo")  # has no noise
                self.drag((150, 160), (190, 180))
                self.wait_for_final()
                self.click("#save_now")
                saved = self.download("*.png")
                self.assertEqual(self.size_of(saved), self.page("[umbrage.frame.width, umbrage.frame.height]"))
                mean_difference, moved = self.differing(saved)
                self.assertLess(mean_difference, 0.01)
                self.assertGreater(moved, 3)  # a picture that is 2 % larger differs
        finally:
            resize(self.browser, 960, 600)

    def test_sizes_of_the_saved_picture(self):
        seen = self.wait_for_rest()
        for factor in (1, 2, 4):
            self.choose("#save_size", str(factor))
            self.browser.execute_script("document.querySelector('#picture').focus()")
            self.press_with(Keys.CONTROL, "s")
            self.assertEqual(self.size_of(self.download("*.png")), [factor * seen["width"], factor * seen["height"]])
            self.wait_for("!document.querySelector('#save').disabled")

    def test_an_own_size_shows_all_of_the_view(self):
        # A narrow picture shows the width of the view: its middle is the canvas, made smaller.
        self.click("[data-testid='show-albedo']")
        self.wait_for_final()
        size = [200, 300]
        for name, value in zip(("save_width", "save_height"), size):
            self.browser.execute_script("document.querySelector('#' + arguments[0]).value = arguments[1]", name, value)
        for _ in range(2):  # perspective, then parallel projection
            saved = self.save()
            self.assertEqual(self.size_of(saved), size)
            mean_difference, moved = self.differing(saved)
            self.assertLess(mean_difference, 2.5)  # the edges of one are made smooth by the change of size
            self.assertGreater(moved, 1.8 * mean_difference)
            self.press(Keys.ESCAPE, "5")
            self.wait_for_final()

    def test_what_is_saved_of_a_comparison(self):
        self.press(Keys.ESCAPE, "k")
        self.wait_for_rest()
        self.choose("#technique", "none")  # of A
        self.wait(lambda: self.options().get("ao") == "none", "the change of A")
        note = self.wait_for("document.querySelector('#take_note').textContent")
        self.assertIn("A alone", note)
        a = self.save()
        self.press(Keys.ESCAPE, "x")
        self.wait_for("umbrage.state.compare === 'b' && document.querySelector('#take_note').hidden")
        self.assertNotEqual(self.save(), a)

    def test_exr_and_svg(self):
        self.assertEqual(self.save("exr")[:4], b"\x76\x2f\x31\x01")
        self.open("#look=cartoon")
        svg = self.save("svg")
        self.assertIn(b"<svg", svg)

    def test_an_impossible_size_is_refused(self):
        self.expected_errors = ["save.*400"]
        self.browser.execute_script("document.querySelector('#save_width').value = 1000000")
        self.click("#save")
        self.wait(lambda: any("Not saved" in text for text in self.errors()), "the refusal")
        self.assertIn("width", self.errors()[0])
        self.wait_for("!document.querySelector('#save').disabled")

    def test_reload_and_link_restore_the_state(self):
        self.change_settings()
        options, picture = self.options(), self.thumbnail()
        self.wait_for("location.hash.includes('ao=bitmask') && location.hash.includes('camera-position')")
        self.browser.refresh()
        self.wait_for_rest()
        self.assertEqual(self.options(), options)
        self.assertLess(difference(self.thumbnail(), picture), 0.5)
        link = self.page("location.href")
        first = self.browser.current_window_handle
        self.browser.switch_to.new_window("tab")
        try:
            resize(self.browser, 960, 600)
            self.browser.get(link)
            self.wait_for_rest()
            self.assertEqual(self.options(), options)
            self.assertLess(difference(self.thumbnail(), picture), 0.5)
            # The tabs are independent of each other.
            self.press("9")
            self.wait_for_rest()
            self.assertNotEqual(self.options(), options)
        finally:
            self.browser.close()
            self.browser.switch_to.window(first)
        self.assertEqual(self.options(), options)
        self.press("1")
        self.wait_for_rest()


if __name__ == "__main__":
    unittest.main()
