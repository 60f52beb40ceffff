"""Mouse, wheel, touch and keys: what each does to the camera and to the state."""
import math
import unittest

from support import ActionChains, Keys, PageTest, difference

BEGIN, END = (300, 260), (380, 290)  # of drags over the picture, CSS pixels


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def length(a):
    return math.sqrt(dot(a, a))


def angle_deg(a, b):
    return math.degrees(math.acos(max(-1.0, min(1.0, dot(a, b) / length(a) / length(b)))))


def eye(camera):
    return [f + camera["distance"] * b for f, b in zip(camera["focal"], camera["back"])]


class CameraTest(PageTest):
    def size(self):
        """Returns the size of the picture, CSS pixels."""
        return self.page("(box => [box.width, box.height])(document.querySelector('#picture').getBoundingClientRect())")

    def ray(self, camera, at):
        """Returns the direction from the eye through a pixel of a perspective camera."""
        width, height = self.size()
        half = math.tan(math.radians(camera["angle_deg"]) / 2)
        x, y = (2 * at[0] / width - 1) * half * width / height, (1 - 2 * at[1] / height) * half
        return [x * r + y * u - b for r, u, b in zip(camera["right"], camera["up"], camera["back"])]

    def point(self, camera, at):
        """Returns the point under a pixel on the plane through the focal point."""
        direction = self.ray(camera, at)
        return [e + camera["distance"] * d for e, d in zip(eye(camera), direction)]

    def up(self):
        return self.page("umbrage.state.scenes[umbrage.state.model].up")

    def radius(self):
        return self.page("umbrage.state.scenes[umbrage.state.model].radius")

    def assert_near(self, a, b, tolerance=1e-3):
        self.assertLess(length(minus(a, b)), tolerance * self.radius(), f"{a} is not {b}")

    def assert_drawn(self, before):
        """The newest state is drawn, and looks different."""
        self.wait_for_rest()
        self.assertGreater(difference(before, self.thumbnail()), 0.5)


class HandsTest(CameraTest):
    def test_left_and_middle_drag_orbit(self):
        for button in ("left", "middle"):
            self.press(Keys.ENTER, "9")  # a camera that is not tilted
            self.wait_for_rest()
            picture, before = self.thumbnail(), self.camera()
            self.drag(BEGIN, END, button)
            after = self.camera()
            self.assert_near(after["focal"], before["focal"])
            self.assertAlmostEqual(after["distance"], before["distance"], places=5)
            # Half a turn per shorter side; the turn about the up axis is seen under the angle to it.
            per_pixel = 180 / min(self.size())
            lifted = angle_deg(before["back"], self.up()) - angle_deg(after["back"], self.up())
            self.assertAlmostEqual(lifted, (END[1] - BEGIN[1]) * per_pixel, delta=0.1)
            plan = [[b - dot(back, self.up()) * u for b, u in zip(back, self.up())]
                    for back in (before["back"], after["back"])]
            self.assertAlmostEqual(angle_deg(*plan), (END[0] - BEGIN[0]) * per_pixel, delta=0.1)
            self.assertAlmostEqual(dot(after["right"], self.up()), 0, places=5)  # it is not tilted
            self.assert_drawn(picture)

    def test_right_and_shift_drag_move(self):
        for button, key in (("right", None), ("left", Keys.SHIFT)):
            self.press(Keys.ENTER)
            self.wait_for_rest()
            picture, before = self.thumbnail(), self.camera()
            self.drag(BEGIN, END, button, key)
            after = self.camera()
            self.assertLess(angle_deg(after["back"], before["back"]), 0.01)
            self.assert_near(self.point(after, END), self.point(before, BEGIN))
            self.assert_drawn(picture)

    def test_wheel_keeps_the_point_under_the_cursor(self):
        picture, before = self.thumbnail(), self.camera()
        at = (400, 200)
        self.wheel(at, -240)
        self.wait(lambda: self.camera()["distance"] < 0.99 * before["distance"], "a smaller distance")
        nearer = self.camera()
        self.assert_near(self.point(nearer, at), self.point(before, at))
        self.assert_drawn(picture)
        self.wheel(at, 240)
        # In proportion to the distance: the opposite turn leads back.
        self.wait(lambda: abs(self.camera()["distance"] / before["distance"] - 1) < 1e-6, "the former distance")
        self.assert_near(self.camera()["focal"], before["focal"])

    def test_pinch_zooms_and_two_fingers_move(self):
        before = self.camera()
        self.touch("touchStart", [(250, 250), (350, 250)])
        for step in range(1, 6):
            self.touch("touchMove", [(250 - 10 * step, 250), (350 + 10 * step, 250)])
        self.touch("touchEnd", [])
        self.wait(lambda: abs(self.camera()["distance"] / before["distance"] - 0.5) < 0.01, "half the distance")
        self.assert_near(self.point(self.camera(), (300, 250)), self.point(before, (300, 250)), 0.01)
        before = self.camera()
        self.touch("touchStart", [(250, 250), (350, 250)])
        for step in range(1, 6):
            self.touch("touchMove", [(250 + 8 * step, 250 + 4 * step), (350 + 8 * step, 250 + 4 * step)])
        self.touch("touchEnd", [])
        self.wait(lambda: length(minus(self.point(self.camera(), (340, 270)), self.point(before, (300, 250))))
                  < 0.01 * self.radius(), "the move of two fingers")
        self.assertAlmostEqual(self.camera()["distance"] / before["distance"], 1, delta=0.01)
        self.assertLess(angle_deg(self.camera()["back"], before["back"]), 0.01)

    def test_one_finger_orbits(self):
        before = self.camera()
        self.touch("touchStart", [BEGIN])
        for step in range(1, 5):
            self.touch("touchMove", [(BEGIN[0] + 20 * step, BEGIN[1])])
        self.touch("touchEnd", [])
        self.wait(lambda: angle_deg(self.camera()["back"], before["back"]) > 10, "an orbit")

    def test_double_click_sets_the_pivot(self):
        before, at = self.camera(), (360, 330)
        for count in (1, 2):
            for kind in ("mousePressed", "mouseReleased"):
                self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {
                    "type": kind, "x": at[0], "y": at[1], "button": "left", "clickCount": count})
        self.wait(lambda: length(minus(self.camera()["focal"], before["focal"])) > 0.05 * self.radius(), "a pivot")
        after = self.camera()
        self.assertLess(angle_deg(after["back"], before["back"]), 0.01)
        self.assertLess(angle_deg(minus(after["focal"], eye(before)), self.ray(before, at)), 0.2)

    def test_the_poles_do_not_lock(self):
        height = self.size()[1]
        elevations, passed = [], []
        for _ in range(8):
            self.drag((300, 100), (300, 100 + height / 5), steps=2)
            camera = self.camera()
            elevations.append(90 - angle_deg(camera["back"], self.up()))
            passed.append(dot(camera["up"], self.up()) < 0)
        # Eight drags of 36 degrees: up to the pole, beyond it and down the other side, never stopped.
        turns = [b - a for a, b in zip(elevations, elevations[1:])]
        self.assertTrue(any(turn > 30 for turn in turns) and any(turn < -30 for turn in turns), elevations)
        self.assertTrue(any(passed) and not all(passed), passed)
        self.wait_for_rest()


class KeysTest(CameraTest):
    """Each key of the sheet has a test here."""

    tested = set()

    def change(self, keys, changes, *presses):
        """Presses keys and waits until `changes(camera before, camera now)`; then until the program has drawn it."""
        KeysTest.tested.update(keys)
        before = self.camera()
        for press in presses or [lambda: self.press(*keys)]:
            press()
        self.wait(lambda: changes(before, self.camera()), f"the effect of {keys}")
        self.wait_for_rest()

    def said(self, key, text, *more):
        """Presses a key and waits until the page says this."""
        KeysTest.tested.add(key.upper())
        if more:
            self.press_with(*more)
        else:
            self.press(key)
        self.wait_for(f"document.querySelector('#said').textContent.toLowerCase().includes({text!r})", f"'{text}' after {key}")

    def test_camera_keys(self):
        self.wheel((300, 250), -400)
        self.change("F", lambda a, b: b["distance"] > 1.2 * a["distance"])
        self.assert_near(self.camera()["focal"], self.page("umbrage.state.scenes[0].center"))
        views = {}
        for key in "1379":
            self.change(key, lambda a, b: angle_deg(a["back"], b["back"]) > 20)
            views[key] = self.camera()["back"]
        self.assertLess(abs(dot(views["1"], views["3"])), 1e-6)
        self.assertLess(angle_deg(views["7"], self.up()), 0.01)
        self.change("9", lambda a, b: dot(a["back"], b["back"]) < -0.999)
        self.change("5", lambda a, b: b["orthographic"] and not a["orthographic"])
        self.assertEqual(self.options()["camera-orthographic"], "true")
        KeysTest.tested.add("ENTER")
        self.press(Keys.ENTER)
        self.wait_for("umbrage.state.cameras[0].is_home")
        self.wait_for_rest()

    def test_flying(self):
        # The key, and the axis of the camera along which it moves.
        for key, axis, sign in (("w", "back", -1), ("s", "back", 1), ("a", "right", -1), ("d", "right", 1), ("r", "up", 1), ("v", "up", -1)):
            KeysTest.tested.add(key.upper())
            before = self.camera()

            def moved(camera):
                return sign * dot(minus(camera["focal"], before["focal"]), before[axis])

            self.browser.execute_script("document.querySelector('#picture').dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true}))", key)
            self.wait(lambda: moved(self.camera()) > 0.05 * before["distance"], f"flying by {key}")
            self.browser.execute_script("document.querySelector('#picture').dispatchEvent(new KeyboardEvent('keyup', {key: arguments[0], bubbles: true}))", key)
            self.assertAlmostEqual(moved(self.camera()), length(minus(self.camera()["focal"], before["focal"])), delta=0.01 * before["distance"])
        self.wait_for_rest()
        still = self.camera()
        self.assertEqual(self.camera(), still)

    def test_arrows_and_zoom(self):
        KeysTest.tested.update("↑↓←→+−")
        step = 180 / 24
        for key in (Keys.ARROW_LEFT, Keys.ARROW_RIGHT, Keys.ARROW_UP, Keys.ARROW_DOWN):
            self.change("", lambda a, b: 0.5 * step < angle_deg(a["back"], b["back"]) < 1.1 * step, lambda: self.press(key))
        for key in (Keys.ARROW_LEFT, Keys.ARROW_UP):
            KeysTest.tested.add("CTRL + ARROWS")
            self.change("", lambda a, b: length(minus(a["focal"], b["focal"])) > 0.01 * self.radius() and a["back"] == b["back"],
                        lambda: self.press_with(Keys.CONTROL, key))
        self.change("+", lambda a, b: b["distance"] < 0.9 * a["distance"])
        self.change("", lambda a, b: b["distance"] > 1.1 * a["distance"], lambda: self.press("-"))

    def test_up_axis(self):
        KeysTest.tested.add("U")
        for axis in ("+Z", "+Y"):
            picture = self.thumbnail()
            self.press("u")
            self.wait(lambda: self.options().get("up") == axis, f"the up axis {axis}")
            self.assert_drawn(picture)
            up = {"+Z": [0, 0, 1], "+Y": [0, 1, 0]}[axis]
            self.assertGreater(dot(self.camera()["up"], up), 0.5)

    def test_undo_redo_and_save(self):
        before = self.camera()
        self.change("1", lambda a, b: angle_deg(a["back"], b["back"]) > 20)
        changed = self.camera()
        redo = ActionChains(self.browser).key_down(Keys.CONTROL).key_down(Keys.SHIFT).send_keys("z")
        redo.key_up(Keys.SHIFT).key_up(Keys.CONTROL)
        for name, again in (("CTRL + SHIFT + Z", redo.perform), ("CTRL + Y", lambda: self.press_with(Keys.CONTROL, "y"))):
            self.said("Ctrl + Z", "undone", Keys.CONTROL, "z")
            self.assertEqual(self.camera(), before)
            again()
            self.wait_for("document.querySelector('#said').textContent === 'Redone'")
            self.assertEqual(self.camera(), changed)
            KeysTest.tested.add(name)
        self.wait_for_rest()
        self.said("Ctrl + S", "saved", Keys.CONTROL, "s")
        self.assertEqual(self.download("*.png")[:4], b"\x89PNG")

    def test_occlusion_and_anti_aliasing(self):
        picture = self.thumbnail()
        self.said("q", "none")
        self.assertEqual(self.options()["ao"], "none")
        self.assert_drawn(picture)
        self.said("q", "traced")
        tap = "for (const kind of ['keydown', 'keyup']) dispatchEvent(new KeyboardEvent(kind, {key: 'a'}))"
        self.browser.execute_script(tap)
        self.wait(lambda: self.options().get("anti-aliasing") == "1", "anti-aliasing off")
        self.browser.execute_script(tap)
        self.wait(lambda: "anti-aliasing" not in self.options(), "anti-aliasing on")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_tone_ground_and_lines(self):
        self.said("t", "tone curve off")
        self.said("e", "no lines")
        self.open("#look=cartoon")
        picture = self.thumbnail()
        self.said("e", "off")
        self.assertEqual(self.options()["set"], ["outline.opacity=0"])
        self.assert_drawn(picture)
        self.said("e", "on")
        self.assertNotIn("set", self.options())
        for state in ("on", "off", "auto"):
            self.said("g", f"ground: {state}")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_buffers(self):
        KeysTest.tested.add("B")
        shown = set()
        for _ in range(3):
            self.press("b")
            shown.add(self.page("umbrage.state.a.show"))
            self.wait_for_rest()
        self.assertEqual(len(shown), 3)

    def test_comparison_keys(self):
        KeysTest.tested.update(["X", "C", "K", "SHIFT (HOLD)"])
        self.press("x")
        self.wait_for("umbrage.state.compare === 'b' && !document.querySelector('#tag_b').hidden")
        self.press("x")
        self.wait_for("umbrage.state.compare === 'off' && document.querySelector('#tag_b').hidden")
        modes = []
        for _ in range(5):
            self.press("c")
            modes.append(self.page("umbrage.state.compare"))
        self.assertEqual(modes, ["b", "divider", "flicker", "difference", "off"])
        self.press("k")
        self.wait_for("umbrage.state.b && umbrage.state.compare === 'divider'")
        self.wait_for_rest()

    def test_page_keys(self):
        KeysTest.tested.update(["P", "L", "H", "ESC", "O", "/", "M"])
        self.press("p")
        self.wait_for("!document.querySelector('#panel').checkVisibility() || document.querySelector('#panel').getBoundingClientRect().left >= innerWidth")
        self.press("p")
        self.wait_for("document.querySelector('#panel').getBoundingClientRect().right <= innerWidth + 1")
        for theme in ("dark", "", "dark", ""):
            self.press("l")
            self.wait_for(f"document.documentElement.dataset.theme === '{theme}'")
        self.press("/")
        self.wait_for("document.activeElement.id === 'search'")
        self.press(Keys.ESCAPE)
        for is_on in ("true", "false"):
            self.press("m")
            self.wait_for(f"document.querySelector('#measure').getAttribute('aria-pressed') === '{is_on}'")
        self.press("h")
        self.wait_for("document.querySelector('#help').open")
        self.press("h")
        self.wait_for("!document.querySelector('#help').open")
        self.press("h")
        self.press(Keys.ESCAPE)
        self.wait_for("!document.querySelector('#help').open")
        self.browser.execute_script("document.querySelector('#technique').focus()")
        self.press(Keys.ESCAPE)
        self.wait_for("document.activeElement.id === 'picture'")
        self.browser.execute_script("""document.querySelector('#file_any').addEventListener('click', event => {
            event.preventDefault();
            window.was_asked = true;
        })""")
        self.press("o")
        self.wait_for("window.was_asked")

    def test_z_the_sheet_lists_only_tested_keys(self):
        # The name sorts it behind the other tests of the class, which fill the set.
        sheet = self.page("[...document.querySelectorAll('#keys section')].slice(1).flatMap(part => [...part.querySelectorAll('kbd')]).map(key => key.textContent)")
        self.assertGreater(len(sheet), 20)
        listed = set()
        for text in sheet:
            parts = [text] if len(text) > 1 and ("+ " in text or "(" in text) else text.split(" ")
            listed.update(key.strip().upper() for part in parts for key in part.split(","))
        self.assertEqual(listed - KeysTest.tested, set())


if __name__ == "__main__":
    unittest.main()
