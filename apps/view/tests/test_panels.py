"""The panel: sliders, parameters, looks, techniques, buffers, light, and comparison."""
import unittest

from support import By, Keys, PageTest, difference, mean


class PanelTest(PageTest):
    def open_sections(self):
        self.browser.execute_script("document.querySelectorAll('#panel details').forEach(part => part.open = true)")

    def hold_shift(self, is_down):
        self.browser.execute_cdp_cmd("Input.dispatchKeyEvent", {
            "type": "keyDown" if is_down else "keyUp", "key": "Shift", "code": "ShiftLeft", "windowsVirtualKeyCode": 16,
            "modifiers": 8 if is_down else 0})

    def test_a_slider_changes_the_picture_and_is_reset(self):
        before = self.thumbnail()
        slider = self.browser.find_element(By.CSS_SELECTOR, "[data-testid='option-ao-strength'] input[type=range]")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", slider)
        box = self.page("(box => [box.left, box.top, box.width, box.height])(arguments[0].getBoundingClientRect())", slider)
        y, middle, left = box[1] + box[3] / 2, box[0] + box[2] / 2, box[0] + 2
        place = float(slider.get_attribute("value"))
        self.drag((box[0] + 8 + place * (box[2] - 16), y), (left, y))
        self.wait(lambda: float(self.options().get("ao-strength", "1")) < 0.05, "an occlusion strength of 0")
        self.assertLess(left, middle)
        self.wait_for_rest()
        bright = self.thumbnail()
        self.assertGreater(mean(bright), mean(before) + 3)  # nothing is occluded
        self.assertEqual(self.element("option-ao-strength").find_element(By.CSS_SELECTOR, "input.number").get_attribute("value"), self.options()["ao-strength"])
        self.click("[data-testid='option-ao-strength'] .undo")
        self.wait(lambda: "ao-strength" not in self.options(), "the default")
        self.wait_for_rest()
        self.assertLess(difference(self.thumbnail(), before), 0.05)
        self.assertTrue(self.page("document.querySelector(\"[data-testid='option-ao-strength'] .undo\").hidden"))

    def test_a_parameter_of_an_effect(self):
        before = self.thumbnail()
        first = self.page("document.querySelector('#effects .row:has(input[type=range])').dataset.testid")
        name = first.removeprefix("parameter-")
        self.browser.execute_script("document.querySelector('#effects details').open = true")
        self.slide(first, 1)
        text = self.wait(lambda: self.options().get("set"), "the parameter")
        self.assertTrue(text[0].startswith(name + "="), text)
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])
        self.assertGreater(difference(before, self.thumbnail()), 0.2)
        self.click("#effects details[open] .reset")
        self.wait(lambda: "set" not in self.options(), "the reset of the section")
        self.wait_for_rest()
        self.assertLess(difference(before, self.thumbnail()), 0.05)

    def test_a_wrong_value_is_named_and_the_page_goes_on(self):
        self.browser.execute_script("document.querySelectorAll('#panel details').forEach(part => part.open = true)")
        # Pictures of the state before, still being decoded when the message comes, do not take it away.
        self.browser.execute_script("""
            const decode = window.createImageBitmap;
            window.decoding = 0;
            window.createImageBitmap = async (...words) => {
              decoding += 1;
              await new Promise(resolve => setTimeout(resolve, 400));
              return decode(...words).finally(() => decoding -= 1);
            };""")
        self.press(Keys.ARROW_LEFT)
        self.wait_for("window.decoding > 0")
        box = self.element("option-background-color").find_element(By.CSS_SELECTOR, "input[type=text]")
        box.send_keys("no-color", Keys.TAB)
        self.wait(lambda: any("--background-color" in text and "no-color" in text for text in self.errors()), "the message")
        self.wait_for("window.decoding === 0")
        self.assertEqual(len(self.errors()), 1)
        self.screenshot("error")
        self.click("[data-testid='option-background-color'] .undo")
        self.wait_for_rest()
        self.wait(lambda: self.errors() == [], "the end of the message")

    def test_every_slider_gives_valid_options(self):
        for look in ("ao", "studio", "cartoon", "bleeding"):
            self.open("#look=" + look)
            self.open_sections()
            rows = self.page("[...document.querySelectorAll('#panel .row:has(input[type=range])')].map(row => row.dataset.testid)")
            self.assertGreater(len(rows), 20)
            for row in rows:
                if row not in ("option-layers", "option-extra-views"):  # their sum is limited
                    self.slide(row, 0.62)
            self.wait(lambda: self.browser.execute_script("return umbrage.frame.id === umbrage.id") or self.errors(), "an answer")
            self.assertEqual(self.errors(), [], look)
            unchanged = self.page("[...document.querySelectorAll('#panel .row:not(.changed):has(input[type=range])')].map(row => row.dataset.testid)")
            self.assertLessEqual(set(unchanged), {"option-layers", "option-extra-views"}, look)

    def test_a_section_follows_its_slider(self):
        self.open_sections()
        before = self.thumbnail()
        self.slide("option-section", 0.5)
        self.wait(lambda: self.options().get("section") == "x=50%", "the plane")
        self.wait_for_rest()
        half = self.thumbnail()
        self.assertGreater(difference(before, half), 0.5)
        self.page("arguments[0].scrollIntoView({block: 'center'})", self.element("option-section"))
        self.screenshot("section")
        self.choose("[data-testid='option-section'] select", "z")
        self.wait(lambda: self.options().get("section") == "z=50%", "the other axis")
        self.wait_for_rest()
        self.assertGreater(difference(half, self.thumbnail()), 0.5)
        box = self.element("option-section").find_element(By.CSS_SELECTOR, "input[type=text]")
        box.clear()
        box.send_keys("z=50% x<40%", Keys.TAB)
        self.wait(lambda: self.options().get("section") == "z=50% x<40%", "both planes")
        self.slide("option-section", 1)
        self.wait(lambda: self.options().get("section") == "z=99% x<40%", "the first plane moved")
        self.assertEqual(self.errors(), [])
        self.click("[data-testid='option-section'] .undo")
        self.wait_for_rest()
        self.assertLess(difference(before, self.thumbnail()), 0.05)

    def test_looks(self):
        looks = self.page("[...document.querySelectorAll('#look option')].map(entry => entry.value)")
        self.assertGreater(len(looks), 5)
        pictures = []
        for look in looks:
            self.choose("#look", look)
            self.wait(lambda: self.options().get("look") == look or look == "studio", look)
            self.wait_for_rest()
            self.assertEqual(self.errors(), [], look)
            pictures.append(self.thumbnail())
        for before, after in zip(pictures, pictures[1:]):
            self.assertGreater(difference(before, after), 0.2)

    def test_techniques_and_qualities(self):
        techniques = self.page("[...document.querySelectorAll('#technique option')].map(entry => entry.value)")
        self.assertGreater(len(techniques), 4)
        for technique in techniques[1:]:
            self.choose("#technique", technique)
            self.wait(lambda: self.options().get("ao") == technique, technique)
            self.wait_for_rest()
            self.assertEqual(self.errors(), [], technique)
        self.choose("#technique", "")
        for quality in ("draft", "high", "ultra"):
            self.click(f"[data-testid='quality-{quality}']")
            self.wait(lambda: self.options().get("quality") == quality, quality)
            self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_settings_change_the_technique_of_a_look(self):
        named = {
            "look=studio": "traced",
            "look=studio&ao-scale=half": "bitmask",
            "look=studio&ao-scale=full": "traced",
            "look=studio&set=bitmask.slices=3": "bitmask",
            "look=studio&set=traced.rays=2": "traced",
            "look=studio&quality=draft": "bitmask",
        }
        for fragment, technique in named.items():
            self.open("#" + fragment)
            self.assertEqual(
                self.page("document.querySelector('#technique option').title"), technique, fragment
            )

    def test_buffers_reference_and_error(self):
        pictures = {}
        for show in ("picture", "depth", "normal", "reference", "error"):
            self.click(f"[data-testid='show-{show}']")
            self.wait(lambda: self.page("umbrage.state.a.show") == show, show)
            self.wait_for_rest()
            self.assertEqual(self.errors(), [], show)
            pictures[show] = self.thumbnail()
            self.screenshot("show_" + show)
        names = list(pictures)
        for before, after in zip(names, names[1:]):
            self.assertGreater(difference(pictures[before], pictures[after]), 0.5, f"{before}, {after}")
        self.wait_for("/RMSE 0\\.\\d+/.test(document.querySelector('#error_number').textContent)")
        self.choose("[data-testid='show-more']", "object_id")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_light_by_dragging(self):
        self.open("#look=lit")
        before = self.thumbnail()
        self.browser.execute_script("document.querySelector('[data-testid=light-ball]').scrollIntoView({block: 'center'})")
        box = self.page("(box => [box.left, box.top, box.width, box.height])(document.querySelector('[data-testid=light-ball]').getBoundingClientRect())")
        at = (box[0] + 0.5 * box[2], box[1] + 0.5 * box[3])
        self.drag(at, (at[0] + 0.3 * box[2], at[1]))
        self.wait(lambda: "light-direction" in self.options(), "a direction of light")
        azimuth, elevation = map(float, self.options()["light-direction"].split(","))
        self.assertGreater(azimuth, 30)
        self.assertAlmostEqual(elevation, 0, delta=3)
        self.wait_for_rest()
        self.assertGreater(difference(before, self.thumbnail()), 1)
        self.screenshot("light")
        self.element("light-ball").send_keys(Keys.ARROW_LEFT)
        self.wait(lambda: self.options()["light-direction"].startswith(f"{azimuth - 5:.0f},"), "the arrow key on the ball")
        self.wait_for_rest()

    def test_background_and_environment(self):
        self.open("#look=lit")
        self.click("[data-testid='option-background-color'] input[type=text]")
        self.element("option-background-color").find_element(By.CSS_SELECTOR, "input[type=text]").send_keys("#ff0000", Keys.TAB)
        self.wait(lambda: self.options().get("background-color") == "#ff0000", "red")
        self.wait_for_rest()
        corner = self.thumbnail()[:3]
        self.assertGreater(corner[0], 200)
        self.assertLess(max(corner[1:]), 40)
        self.click("#section_environment .buttons button")
        self.wait(lambda: self.options().get("hdri-file") == "sky:", "the sky")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_times(self):
        self.click("#section_times summary")
        self.press_key_on_picture(Keys.ARROW_LEFT)
        self.wait_for_rest()
        self.wait_for("document.querySelectorAll('#stages li').length > 3")
        self.browser.execute_script("document.querySelector('#section_times').scrollIntoView()")
        self.screenshot("times")

    def press_key_on_picture(self, key):
        self.browser.find_element(By.CSS_SELECTOR, "#picture").send_keys(key)

    # Comparison.

    def test_shift_shows_the_reference(self):
        before = self.thumbnail()
        samples = self.wait_for("umbrage.frame.samples >= 4 && umbrage.frame.samples")
        self.hold_shift(True)
        self.wait_for("umbrage.frame_b && !document.querySelector('#tag_b').hidden && !document.querySelector('#tag_b').textContent.includes('being drawn')")
        self.wait(lambda: difference(before, self.thumbnail()) > 0.5, "the reference")
        self.assertIn("Reference", self.element("tag-b").text)
        self.screenshot("shift")
        self.assertGreaterEqual(self.page("umbrage.frame.samples"), samples)
        self.hold_shift(False)
        self.wait_for("document.querySelector('#tag_b').hidden")
        self.wait(lambda: difference(before, self.thumbnail()) < 0.5, "the picture of before")
        self.assertGreaterEqual(self.page("umbrage.frame.samples"), samples)

    def test_two_settings(self):
        self.press("k")  # B is a copy of A, beside it
        self.wait_for_rest()
        self.choose("#technique", "bitmask")
        self.wait_for("umbrage.state.a.options.ao === 'bitmask' && umbrage.state.b.options.ao === undefined")
        self.wait_for_rest()
        self.wait_for("!document.querySelector('#divider').hidden")
        self.screenshot("divider")
        half = self.thumbnail()
        box = self.page("(box => [box.left + box.width / 2, box.top + box.height / 2])(document.querySelector('#divider').getBoundingClientRect())")
        width = self.page("document.querySelector('#picture').getBoundingClientRect().width")
        self.drag(box, (0.25 * width, box[1]))
        self.wait_for("Math.abs(umbrage.state.split - 0.25) < 0.02")
        divider = self.element("divider")
        divider.send_keys(Keys.HOME)
        self.wait_for("umbrage.state.split === 0")
        b = self.thumbnail()
        divider.send_keys(Keys.END)
        self.wait_for("umbrage.state.split === 1")
        a = self.thumbnail()
        self.assertGreater(difference(a, b), 0.5)
        self.assertTrue(0.1 < difference(half, a) < difference(a, b))

    def test_flicker_and_difference(self):
        self.press("k")
        self.click("[data-testid='compare-difference']")
        self.wait_for_rest()
        # Both sides have the same settings: what differs at first is the noise of unequal numbers of samples.
        self.wait(lambda: mean(self.thumbnail()) < 0.5, "no difference")
        self.choose("#technique", "bitmask")
        self.wait_for_rest()
        self.wait(lambda: mean(self.thumbnail()) > 0.5, "a difference")
        self.screenshot("difference")
        self.click("[data-testid='compare-flicker']")
        for _ in range(2):
            self.wait_for("!document.querySelector('#tag_a').hidden && document.querySelector('#tag_b').hidden")
            self.wait_for("document.querySelector('#tag_a').hidden && !document.querySelector('#tag_b').hidden")

    def test_two_devices(self):
        self.press("k")
        self.choose("#device", "cpu")
        self.wait_for("umbrage.state.a.device === 'cpu' && !umbrage.state.b.device")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])


if __name__ == "__main__":
    unittest.main()
