"""Undo and redo, the search in the panel, and the buttons and the hint on the picture."""
import math
import unittest

from support import ActionChains, By, Keys, PageTest, difference


class StepsTest(PageTest):
    def step(self, change, is_done):
        """Makes a change, waits until it is a step, and returns its state."""
        before = self.page("document.querySelector('#undo').disabled")
        change()
        self.wait(is_done, "the change")
        self.wait_for("!document.querySelector('#undo').disabled" if before else "true")
        self.wait_for_rest()
        return self.now()

    def now(self):
        return self.page("[umbrage.options, umbrage.state.cameras, umbrage.state.compare, umbrage.state.b]")

    def undo(self):
        self.press_with(Keys.CONTROL, "z")

    def redo(self):
        actions = ActionChains(self.browser).key_down(Keys.CONTROL).key_down(Keys.SHIFT).send_keys("z")
        actions.key_up(Keys.SHIFT).key_up(Keys.CONTROL).perform()

    def test_undo_and_redo_of_all_changes_in_order(self):
        pictures = [self.thumbnail()]
        states = [self.now()]

        def changed(change, is_done):
            states.append(self.step(change, is_done))
            pictures.append(self.thumbnail())

        changed(lambda: self.choose("#look", "cartoon"), lambda: self.options().get("look") == "cartoon")
        changed(lambda: self.drag_slider("option-ao-strength"), lambda: "ao-strength" in self.options())
        changed(lambda: self.drag((300, 260), (380, 290)), lambda: not self.camera().get("is_home"))
        changed(lambda: self.press("k"), lambda: self.page("umbrage.state.compare === 'divider'"))
        self.assertEqual(len({str(state) for state in states}), 5)
        for state, picture in reversed(list(zip(states[:-1], pictures[:-1]))):
            self.undo()
            self.wait(lambda: self.now() == state, "the state before")
            self.wait_for_rest()
            self.assertLess(difference(self.thumbnail(), picture), 0.5)
        self.assertTrue(self.page("document.querySelector('#undo').disabled"))
        self.undo()
        self.wait_for("document.querySelector('#said').textContent === 'Nothing to undo'")
        for state in states[1:]:
            self.redo()
            self.wait(lambda: self.now() == state, "the state after")
        self.assertTrue(self.page("document.querySelector('#redo').disabled"))
        self.wait_for_rest()
        self.wait_for("location.hash.includes('look=cartoon')")  # the address follows
        self.assertEqual(self.errors(), [])

    def drag_slider(self, test_id):
        slider = self.browser.find_element(By.CSS_SELECTOR, f"[data-testid='{test_id}'] input[type=range]")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", slider)
        box = self.page("(box => [box.left, box.top, box.width, box.height])(arguments[0].getBoundingClientRect())", slider)
        place = 8 + float(slider.get_attribute("value")) * (box[2] - 16)
        self.drag((box[0] + place, box[1] + box[3] / 2), (box[0] + 0.8 * box[2], box[1] + box[3] / 2), steps=8)

    def test_a_drag_with_pauses_is_one_step(self):
        before = self.now()

        def send(kind, x, **more):
            self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": 260, "button": "left", "buttons": 1, **more})

        send("mousePressed", 300, clickCount=1)
        for x in (320, 350, 390):
            send("mouseMoved", x)
            self.wait_for_rest()
            self.wait_for("location.hash.includes('camera-position')")  # longer than a rest
        self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": "mouseReleased", "x": 390, "y": 260, "button": "left", "clickCount": 1})
        self.wait_for("!document.querySelector('#undo').disabled")
        self.undo()
        self.wait(lambda: self.now() == before, "the state before the drag")
        self.assertTrue(self.page("document.querySelector('#undo').disabled"))

    def test_a_new_change_ends_the_redo(self):
        self.step(lambda: self.press("1"), lambda: not self.camera().get("is_home"))
        self.undo()
        self.wait(lambda: self.camera().get("is_home"), "the home camera")
        self.assertFalse(self.page("document.querySelector('#redo').disabled"))
        self.press("3")
        self.wait_for("document.querySelector('#redo').disabled")
        state = self.now()
        self.redo()
        self.assertEqual(self.now(), state)

    def test_ctrl_z_never_tips_the_model(self):
        before = self.now()
        for key in "zy":
            self.press_with(Keys.CONTROL, key)
            self.wait_for("document.querySelector('#said').textContent.startsWith('Nothing to')")
            self.assertEqual(self.now(), before)

    def test_text_that_is_typed_has_its_own_undo(self):
        self.step(lambda: self.press("1"), lambda: not self.camera().get("is_home"))
        camera = self.camera()
        box = self.element("option-ao-strength").find_element(By.CSS_SELECTOR, "input.number")
        box.send_keys("1.5")
        self.undo()
        self.assertEqual(self.camera(), camera)
        self.browser.execute_script("arguments[0].select()", box)
        box.send_keys("0.5", Keys.ENTER)
        self.wait(lambda: self.options().get("ao-strength") == "0.5", "the number")
        self.undo()  # the text has been taken: this is a step of the page
        self.wait(lambda: "ao-strength" not in self.options(), "the number before")
        self.assertEqual([self.camera(), box.get_attribute("value")], [camera, ""])
        self.wait_for_rest()

    # The picture's buttons and hint.

    def test_the_hint_leaves_with_the_first_gesture(self):
        self.browser.execute_script("localStorage.clear()")
        self.open()
        text = self.wait_for("document.querySelector('#hint').checkVisibility() && document.querySelector('#hint').textContent")
        for word in ("Drag", "wheel", "double click"):
            self.assertIn(word, text)
        self.screenshot("hint")
        self.drag((300, 260), (330, 270))
        self.wait_for("document.querySelector('#hint').hidden")
        self.open()
        self.assertTrue(self.page("document.querySelector('#hint').hidden"))

    def test_fit(self):
        self.wheel((300, 250), -400)
        self.wait(lambda: not self.camera().get("is_home"), "the zoom")
        near = self.camera()["distance"]
        self.click("#fit")
        self.wait(lambda: self.camera()["distance"] > 1.2 * near, "the whole model")
        self.click("#undo")
        self.wait(lambda: self.camera()["distance"] == near, "the camera before")
        self.wait_for_rest()

    def test_the_distance_of_two_points(self):
        self.press("5", "7")  # in parallel projection, lengths across the view follow from pixels
        self.wait_for_rest()
        size = self.page("(box => [box.width, box.height])(document.querySelector('#picture').getBoundingClientRect())")
        clicked = [(0.5 * size[0], 0.3 * size[1]), (0.55 * size[0], 0.7 * size[1])]
        camera = self.camera()
        self.click("#measure")
        for count, at in enumerate(clicked, 1):
            self.drag(at, at, steps=1)
            self.wait_for(f"document.querySelector('#measured path').getAttribute('d').split(/[ML]/).length === {2 * count + 1}")
        self.assertEqual(self.camera(), camera)
        path = self.page("document.querySelector('#measured path').getAttribute('d').match(/[\\d.]+/g).map(Number)")
        for drawn, at in zip((path[:2], path[2:4]), clicked):
            self.assertLess(math.dist(drawn, at), 2)
        height = 2 * camera["distance"] * math.tan(math.radians(camera["angle_deg"]) / 2)
        across = math.dist(*clicked) * height / size[1]
        shown = float(self.element("distance").text.split()[0])
        self.assertGreater(shown, 0.99 * across)
        extent = self.page("umbrage.state.scenes[0].extent")
        self.assertLess(shown, 1.01 * math.hypot(across, extent[1]))
        self.assertIn(" × ".join(f"{side:.4g}" for side in extent), self.page("document.querySelector('#model_summary').textContent"))
        self.screenshot("distance")
        self.click("#measure")
        self.assertTrue(self.page("document.querySelector('#distance').hidden"))

    # The search.

    def seen(self):
        """Returns the rows and the sections that are seen."""
        return self.page("""["#sections .row", "#sections details"].map(parts => [...document.querySelectorAll(parts)]
            .filter(part => part.checkVisibility()).map(part => part.dataset.testid))""")

    def search(self, text):
        box = self.element("search")
        box.clear()
        box.send_keys(text)
        return self.seen()

    def test_the_search_filters_rows_and_sections(self):
        rows, sections = self.seen()
        found, places = self.search("edge light")
        self.assertIn("option-rim", found)
        for name in ("option-ao-strength", "option-fill"):
            self.assertNotIn(name, found)
        self.assertIn("section-light", places)
        self.assertLess(len(places), len(sections))
        self.screenshot("search")
        for text in ("ao-strength", "twice as dark"):  # a technical name, and words of a tooltip
            self.assertIn("option-ao-strength", self.search(text)[0])
        self.assertIn("parameter-traced.rays", self.search("rays per pixel")[0])  # in a section that was closed
        self.assertEqual(self.search("no such setting"), [[], []])
        self.assertTrue(self.page("document.querySelector('#none_found').checkVisibility()"))
        self.element("search").send_keys(Keys.ESCAPE)
        self.assertEqual(self.seen(), [rows, sections])
        self.assertEqual(self.page("document.activeElement.id"), "picture")

    def test_a_setting_that_was_found_can_be_changed(self):
        self.search("darkness")
        self.slide("option-ao-strength", 0.9)
        self.wait(lambda: "ao-strength" in self.options(), "the change")
        self.assertIn("option-ao-strength", self.seen()[0])
        self.wait_for_rest()

    def test_names_are_plain(self):
        """Every row has a name of its own in its section, and its technical name in its tooltip."""
        for look in ("studio", "technical", "hatching"):
            self.open("#look=" + look)
            self.browser.execute_script("document.querySelectorAll('#panel details').forEach(part => part.open = true)")
            rows = self.page("""[...document.querySelectorAll("#sections .row[data-kind]")].map(row => [row.closest("details").id,
                row.dataset.testid.replace(/^(option|parameter)-/, ""), row.querySelector("label").firstChild.textContent, row.title])""")
            self.assertGreater(len(rows), 50)
            for section, name, label, title in rows:
                self.assertIn(name, title)
                self.assertRegex(label, r"^[A-Z][\w ,:'-]+$")
                self.assertNotRegex(label, r"(?i)_|\b(ao|hdri|rgb|albedo|epsilon|specular)\b", name)
            names = [(section, label) for section, _, label, _ in rows]
            self.assertEqual(sorted({name for name in names if names.count(name) > 1}), [])


if __name__ == "__main__":
    unittest.main()
