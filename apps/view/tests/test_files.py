"""Files: dropped on the page, several models, a G-buffer, and a file that changes on the disk."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

from support import PROGRAM, Keys, PageTest, difference, mean

CUBE = """mtllib cube.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
usemtl paint
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 1 5 8 4
f 2 3 7 6
"""
RED = "newmtl paint\nKd 0.9 0.02 0.02\n"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def red_fraction(picture):
    """Returns the fraction of pixels of a thumbnail that are red."""
    pixels = list(zip(picture[0::3], picture[1::3], picture[2::3]))
    return sum(r > 60 and r > 2 * max(g, b) for r, g, b in pixels) / len(pixels)


def radiance_picture(red, green, blue):
    """Returns a Radiance .hdr file of 4 x 2 pixels of one colour, in 256ths."""
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + bytes([red, green, blue, 128]) * 8


class FilesTest(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="umbrage-files-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.watched = cls.write("watched.obj", CUBE.replace("mtllib cube.mtl\n", "").replace("usemtl paint\n", ""))
        cls.words = (cls.watched, "scene:solids?detail=3000", "--look", "lit", "--watch")
        super().setUpClass()

    @classmethod
    def write(cls, name, text):
        """Replaces a file at once, as editors do."""
        path = os.path.join(cls.folder, name)
        with open(path + ".new", "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(path + ".new", path)
        return path

    def model_name(self):
        return self.page("umbrage.state.models.find(model => model.id === umbrage.state.model).name")

    def wait_for_model(self, name):
        self.wait(lambda: self.model_name() == name, "the model " + name)
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_drop_a_model_with_its_material(self):
        self.drop({"cube.mtl": RED.encode(), "cube.obj": CUBE.encode()})
        self.wait_for_model("cube.obj")
        self.assertGreater(red_fraction(self.thumbnail()), 0.1)
        self.assertIn("12 triangles", self.element("status").text)
        self.assertIn("cube.obj", self.browser.title)
        self.screenshot("dropped")

    def test_drop_an_environment(self):
        before = self.thumbnail()
        self.drop({"blue.hdr": radiance_picture(10, 10, 250)})
        self.wait(lambda: self.options().get("hdri-file", "").endswith("/blue.hdr"), "the environment")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])
        after = self.thumbnail()
        self.assertGreater(mean(after[2::3]) - mean(after[0::3]), mean(before[2::3]) - mean(before[0::3]) + 3)  # it is bluer

    def rendered(self, name, *words):
        """Returns the bytes of a file that the program renders."""
        file = os.path.join(self.folder, name)
        subprocess.run([PROGRAM, "render", "scene:solids?detail=3000", "--config", "none", "--look", "lit", "--resolution", "200,120",
                        *words, "-o", file], check=True)
        with open(file, "rb") as data:
            return data.read()

    def test_asks_what_a_picture_is(self):
        self.drop({"sky.png": self.rendered("sky.png")})
        self.wait_for("document.querySelector('#ask').open")
        self.screenshot("ask")
        self.click("#ask button[value=environment]")
        self.wait(lambda: self.options().get("hdri-file", "").endswith("/sky.png"), "the environment")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])

    def test_drop_a_g_buffer(self):
        self.drop({"planes.exr": self.rendered("planes.exr", "--passes", "depth,normal,albedo")})
        self.wait_for_model("planes.exr")
        frame = self.wait_for_rest()
        self.assertEqual([frame["width"], frame["height"]], [200, 120])
        self.assertGreater(difference(self.thumbnail(), [0] * 48 * 30 * 3), 20)
        self.screenshot("gbuffer")
        # The picture moves and grows in the page alone.
        frames, picture = self.page("umbrage.id"), self.thumbnail()
        self.wheel((300, 250), -240)
        self.wait_for("umbrage.state.flat.scale > 1.2")
        self.drag((300, 260), (360, 300))
        self.wait_for("umbrage.state.flat.x !== 0")
        self.assertGreater(difference(picture, self.thumbnail()), 1)
        self.assertEqual(self.page("umbrage.id"), frames)
        self.choose("#technique", "bitmask")
        self.wait_for_rest()
        self.assertEqual(self.errors(), [])
        self.press(Keys.ESCAPE, "f")
        self.wait_for("umbrage.state.flat.scale === 1")

    def test_a_broken_file_is_named_and_the_page_goes_on(self):
        self.drop({"broken.glb": b"glTF is not this"})
        self.wait(lambda: any("broken.glb" in text for text in self.errors()), "the message")
        self.screenshot("broken")
        self.choose("#models", "1")
        self.wait_for("umbrage.state.model === 1")
        self.wait_for_rest()

    def test_arrow_keys_choose_models(self):
        names = self.page("umbrage.state.models.map(model => model.name)")
        self.press(Keys.ARROW_RIGHT)
        self.wait_for_model(names[1])
        self.press(Keys.ARROW_LEFT)
        self.wait_for_model(names[0])
        camera = self.camera()
        self.press(Keys.ARROW_UP)
        self.wait(lambda: self.camera()["back"] != camera["back"], "an orbit by the vertical arrows")
        self.wait_for_rest()

    def test_a_changed_file_is_read_again_with_the_camera_kept(self):
        self.drag((300, 260), (350, 280))
        self.wait_for_rest()
        camera, picture = self.camera(), self.thumbnail()
        cube = self.page("umbrage.state.scenes[0].summary")
        try:
            self.write("watched.obj", TETRAHEDRON)
            self.wait(lambda: self.page("umbrage.state.scenes[0].summary") != cube, "the changed file")
            self.wait_for_rest()
            self.assertEqual(self.camera(), camera)
            self.assertGreater(difference(picture, self.thumbnail()), 1)
        finally:
            self.write("watched.obj", CUBE)
        self.wait(lambda: self.page("umbrage.state.scenes[0].summary") == cube, "the former file")

    def test_uploads_stay_in_their_folder(self):
        self.expected_errors = ["files.*400"]
        answers = self.browser.execute_async_script("""
            const done = arguments[arguments.length - 1];
            Promise.all(["../x.obj", "/etc/y.obj", "..", "", "a\\u0001b"].map(name =>
              fetch(new URL("files?" + new URLSearchParams({drop: "abc", name}), location.href.split("#")[0]), {method: "POST", body: "v 0 0 0"})
                .then(async answer => [answer.status, await answer.json()]))).then(done);""")
        self.assertEqual([status for status, _ in answers], [200, 200, 400, 400, 400], json.dumps(answers))
        self.assertEqual([answer["file"] for _, answer in answers[:2]], ["abc/x.obj", "abc/y.obj"])


if __name__ == "__main__":
    unittest.main()
