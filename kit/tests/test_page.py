"""Runs a kit in GLSL ES in Chromium, and compares its occlusion with that of the CPU."""
import base64
import functools
import http.server
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "apps/view/tests")]
import umbrage  # noqa: E402
from support import PROGRAM, end_browser, start_browser  # noqa: E402

WIDTH, HEIGHT, ANGLE = 256, 192, 33.0

# Draws the planes by the package's core; returns `ao` and the name of the driver.
DRAW = """
const [planes, projection, radius, done] = arguments;
import("/src/core.js").then(({ createEffect, kits }) => {
  const gl = document.createElement("canvas").getContext("webgl2"), width = %d, height = %d;
  const upload = (text, channels) => {
    const texture = gl.createTexture(), data = new Float32Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, channels == 1 ? gl.R32F : gl.RGB32F, width, height, 0,
      channels == 1 ? gl.RED : gl.RGB, gl.FLOAT, data);
    return texture;
  };
  const shaded = createEffect(gl, kits.ao).render({ width, height, projection, radius,
    linearDepth: upload(planes[0], 1), textures: { normal: upload(planes[1], 3) } });
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, shaded.ao, 0);
  const values = new Float32Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
  done([Array.from(values.filter((_, k) => k %% 4 == 0)), gl.getError()]);
}).catch(error => done([String(error), -1]));
""" % (WIDTH, HEIGHT)


def serve(folder):
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    handler.log_message = lambda *words: None
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


class PageTest(unittest.TestCase):
    def test_occlusion_is_that_of_the_cpu(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder)
            for name, effects, *settings in (("normals", "normals"),
                                             ("ao", "bitmask,denoise", "--set", "bitmask.radius=100%")):
                subprocess.run([PROGRAM, "shaders", effects, "--language", "glsl-es", "-o", page / name, *settings], check=True)
            (page / "generated").mkdir()
            (page / "generated/kits.js").write_text(
                'export * as normals from "../normals/frame.js";\nexport * as ao from "../ao/frame.js";\n')
            (page / "src").symlink_to(ROOT / "web/src")
            (page / "index.html").write_text("<!doctype html><title>kit</title>")
            planes = umbrage.render("scene:solids", size=(WIDTH, HEIGHT), look="ao", occlusion="bitmask", occlusion_radius=0.4,
                                    device="cpu", anti_aliasing=1, camera={"view_angle_deg": ANGLE},
                                    passes=["depth", "normal", "ao"])
            depth, normal, expected = (numpy.flipud(planes[name]).astype("float32") for name in ("depth", "normal", "ao"))
            depth = numpy.where(numpy.isfinite(depth), depth, 0).astype("float32")
            top = numpy.tan(numpy.radians(ANGLE / 2))
            projection = [0.0] * 16
            projection[0], projection[5], projection[10], projection[11], projection[14] = HEIGHT / WIDTH / top, 1 / top, -1, -1, -1
            server, browser = serve(folder), start_browser()
            try:
                browser.get(f"http://127.0.0.1:{server.server_address[1]}/index.html")
                browser.set_script_timeout(300)
                texts = [base64.b64encode(numpy.ascontiguousarray(plane).tobytes()).decode() for plane in (depth, normal)]
                ao, error = browser.execute_async_script(DRAW, texts, projection, 0.4)
            finally:
                end_browser(browser)
                server.shutdown()
            self.assertEqual(error, 0, ao)
            difference = numpy.abs(numpy.reshape(ao, (HEIGHT, WIDTH)) - expected)[depth > 0]
            print(f"largest difference {difference.max():.2g}, within .004: {100 * (difference <= .004).mean():.3f} %")
            self.assertGreaterEqual((difference <= 0.004).mean(), 0.999)
            self.assertLess(expected[depth > 0].min(), 0.5)  # there is occlusion to compare


if __name__ == "__main__":
    unittest.main()
