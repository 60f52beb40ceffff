"""The page itself: what it loads, how it is read out, used by the keyboard, and laid out."""
import unittest

from support import Keys, PageTest, resize

# Returns pairs of controls of the panel that overlap, and elements whose text is cut off.
LAYOUT_FAULTS = """
const faults = [], is_seen = box => box.width > 0 && box.height > 0;
const name_of = found => found.tagName + " " + (found.id || found.dataset.testid || found.className || found.textContent.slice(0, 30));
const root = document.documentElement;
if (root.scrollWidth > innerWidth) faults.push(`the page is ${root.scrollWidth} pixels wide`);
const all = [...document.querySelectorAll("#panel button, #panel select, #panel input, #panel label, #panel h2, #panel p, footer span, #panel_toggle")]
  .filter(found => found.checkVisibility({ opacityProperty: true, visibilityProperty: true }) && !found.closest(".unseen, svg"));
for (const found of all) {
  const box = found.getBoundingClientRect();
  if (!is_seen(box)) continue;
  if (box.right > innerWidth + 1 || box.left < -1) faults.push(`${name_of(found)} reaches beyond the window`);
  const style = getComputedStyle(found);
  if (found.scrollWidth > found.clientWidth + 1 && style.overflowX !== "visible" && style.display !== "inline" && found.tagName !== "INPUT" && style.textOverflow !== "ellipsis")
    faults.push(`${name_of(found)} is cut off`);
}
const controls = all.filter(found => found.matches("button, select, input:not([type=radio])"));
controls.forEach((a, i) => {
  const p = a.getBoundingClientRect();
  for (const b of controls.slice(i + 1)) {
    const q = b.getBoundingClientRect();
    const width = Math.min(p.right, q.right) - Math.max(p.left, q.left), height = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    if (is_seen(p) && is_seen(q) && width > 2 && height > 2 && a.closest("header") === b.closest("header")) faults.push(`${name_of(a)} overlaps ${name_of(b)}`);
  }
});
return faults;
"""

CONTROL_ROLES = {"button", "checkbox", "combobox", "slider", "spinbutton", "textbox", "radio", "switch", "application",
                 "link", "menuitem", "ColorWell", "DisclosureTriangle"}


class PageItselfTest(PageTest):
    def open_sections(self):
        self.browser.execute_script("document.querySelectorAll('#panel details').forEach(part => part.open = true)")

    def test_loads_itself_alone(self):
        self.assertEqual(self.browser.title, "scene:solids?detail=3000 · Umbrage")
        own = self.page("performance.getEntriesByType('resource').map(entry => entry.name)")
        self.assertEqual([name for name in own if not name.startswith(("blob:", "data:", self.viewer.address))], [])
        self.assertEqual(self.page("[...document.querySelectorAll('link[rel=stylesheet], script[src], img[src^=http], iframe')].length"), 0)
        self.assertEqual(self.errors(), [])
        frame = self.wait_for_rest()
        box = self.page("(box => [box.width, box.height])(document.querySelector('#picture').getBoundingClientRect())")
        self.assertEqual([frame["width"], frame["height"]], [round(side) for side in box])
        self.assertEqual(frame["format"], "image/png")
        try:
            resize(self.browser, 320, 240)  # is soon refined
            self.wait_for_final()
            self.assertIn("Finished", self.element("progress").text)
        finally:
            resize(self.browser, 960, 600)

    def test_every_control_has_a_name(self):
        self.open_sections()
        tree = self.browser.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        controls = [node for node in tree if not node["ignored"] and node["role"]["value"] in CONTROL_ROLES]
        self.assertGreater(len(controls), 100)
        unnamed = [node for node in controls if not node.get("name", {}).get("value", "").strip()]
        self.assertEqual([(node["role"]["value"], node.get("backendDOMNodeId")) for node in unnamed], [])
        # Sliders say their value with its unit, rows their help.
        silent = self.page("[...document.querySelectorAll('#panel input[type=range]')].filter(slider => !slider.getAttribute('aria-valuetext')).length")
        self.assertEqual(silent, 0)
        helpless = self.page("[...document.querySelectorAll('#panel .row small')].filter(help => !help.textContent.trim()).map(help => help.id)")
        self.assertEqual(helpless, [])

    def test_keyboard_alone_suffices(self):
        seen = []
        for _ in range(60):
            self.press(Keys.TAB)
            seen.append(self.page("document.activeElement.id || document.activeElement.closest('[data-testid]')?.dataset.testid || document.activeElement.tagName"))
            if "option-ao-strength" in seen:
                break
        for name in ("picture", "panel_toggle", "open", "look", "technique", "option-ao-strength"):
            self.assertIn(name, seen)
        # The focus is on the slider now: arrows change it, not the camera.
        outline = self.page("getComputedStyle(document.activeElement).outlineStyle + getComputedStyle(document.activeElement).boxShadow")
        self.assertNotEqual(outline, "nonenone", "the focus is not seen")
        camera = self.camera()
        self.press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.wait(lambda: "ao-strength" in self.options(), "the arrow keys on a slider")
        self.assertEqual(self.camera(), camera)
        self.press(Keys.ESCAPE, Keys.ARROW_RIGHT)
        self.wait(lambda: self.camera() != camera, "the arrow keys on the picture")
        self.wait_for_rest()

    def test_large_text(self):
        try:
            for width, height in ((1280, 720), (960, 600), (600, 800)):
                resize(self.browser, width, height)
                self.browser.execute_script("document.documentElement.style.fontSize = '200%'")
                self.wait_for("document.querySelector('#panel_toggle').checkVisibility()")
                self.open_sections()
                if width == 600:
                    self.browser.execute_script("if (document.body.classList.contains('no_panel')) document.querySelector('#panel_toggle').click()")
                self.screenshot(f"large_text_{width}")
                self.assertEqual(self.browser.execute_script(LAYOUT_FAULTS), [], width)
        finally:
            resize(self.browser, 960, 600)

    def test_narrow_window(self):
        try:
            resize(self.browser, 600, 800)
            self.open()
            self.screenshot("narrow")
            self.assertEqual(self.browser.execute_script(LAYOUT_FAULTS), [])
            self.element("panel-toggle").click()
            self.open_sections()
            self.wait_for("document.querySelector('#panel').getBoundingClientRect().width > 200")
            self.screenshot("narrow_panel")
            self.assertEqual(self.browser.execute_script(LAYOUT_FAULTS), [])
        finally:
            resize(self.browser, 960, 600)

    def test_the_status_line_never_changes_the_picture(self):
        # A line that wraps by its text would resize the picture, which draws it again and changes the text.
        self.press("p")  # the line is as wide as the window
        try:
            for width, height, text in ((160, 100, "100%"), (260, 200, "100%"), (420, 300, "200%")):
                resize(self.browser, width, height)
                self.browser.execute_script("document.documentElement.style.fontSize = arguments[0]", text)
                self.wait_for_rest()
                size = self.page("document.querySelector('#picture').height")
                for key in (Keys.ARROW_LEFT, Keys.ARROW_RIGHT):
                    self.press(key)
                    self.wait_for_rest()
                    state = self.page("umbrage.id")
                    self.wait_for("umbrage.frame.samples >= 8 || umbrage.id > arguments[0] + 3".replace("arguments[0]", str(state)))
                    self.assertEqual([self.page("umbrage.id"), self.page("document.querySelector('#picture').height")], [state, size])
        finally:
            resize(self.browser, 960, 600)

    def test_dark_and_light(self):
        def brightness(selector):
            return self.page("(color => color.match(/[\\d.]+/g).slice(0, 3).reduce((sum, x) => sum + Number(x), 0))"
                             f"(getComputedStyle(document.querySelector('{selector}')).backgroundColor)")

        levels = {}
        try:
            for scheme in ("light", "dark"):
                self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                    "features": [{"name": "prefers-color-scheme", "value": scheme}]})
                levels[scheme] = self.wait(lambda: brightness("body"), "a color of the panel")
                self.screenshot(scheme)
        finally:
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        self.assertGreater(levels["light"], 600)
        self.assertLess(levels["dark"], 250)


if __name__ == "__main__":
    unittest.main()
