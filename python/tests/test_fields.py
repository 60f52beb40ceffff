"""The fields of requests: those of the C++ structs, the names that the C++ interface sets and the keywords of this package
are those of the table of options, which umbrage.parameters lists."""
import pathlib
import re
import unittest
from typing import Set

import umbrage
from umbrage._lists import keywords_of
from umbrage._native import KEYWORDS

ROOT = pathlib.Path(__file__).parents[2]
RENDER, SHADE, SCENE = (set(umbrage.parameters(owner)) for owner in ("render", "shade", "scene"))
ARGUMENTS = {"model", "more_models", "settings", "passes", "device", "threads"}  # of calls and objects, not parameters


def text_of(file: str) -> str:
    return re.sub(r"//.*", "", (ROOT / file).read_text())


def body(text: str, start: str) -> str:
    """Returns what follows `start`, up to the brace in the first column."""
    at = text.index(start) + len(start)
    return text[at : text.index("\n}", at)]


def members(text: str, struct: str, prefix: str = "") -> Set[str]:
    """Returns the names of the data members of a struct."""
    code = body(text, f"struct {struct} {{")
    for pattern in (r"\{[^{}]*\}", r"<[^<>]*>"):
        while re.search(pattern, code):
            code = re.sub(pattern, "", code)
    code = re.sub(r"\w+\(.*?\) const|=[^,;]*", "", code)
    return {prefix + name for name in re.findall(r"(\w+)\s*[,;]", code)}


def names_set(text: str, *functions: str) -> Set[str]:
    """Returns the parameters that functions set."""
    return {name for function in functions for name in re.findall(r'set\("([\w.]+)"', body(text, function))}


class Fields(unittest.TestCase):
    def same(self, found: Set[str], expected: Set[str]) -> None:
        self.assertEqual(sorted(found - expected), [], "not in the table of options")
        self.assertEqual(sorted(expected - found), [], "only in the table of options")

    def test_request(self) -> None:
        text, of_gbuffer = text_of("renderer/request.h"), text_of("gbuffers/settings.h")
        fields = members(text, "Request") - {"camera", "gbuffer", "values"}  # the last has no row
        fields |= members(text, "CameraSettings", "camera.") | members(of_gbuffer, "GBufferSettings")
        self.same(fields, RENDER | SHADE | SCENE | ARGUMENTS)

    def test_cpp_requests(self) -> None:
        requests, setters = text_of("include/umbrage/requests.hpp"), text_of("include/umbrage/render.hpp")
        fields = members(requests, "RenderRequest") - {"camera", "progress"}
        self.same(fields | members(requests, "CameraRequest", "camera."), RENDER | SCENE | ARGUMENTS)
        common, of_scene = names_set(setters, "void set_common"), names_set(setters, "void set_scene")
        self.same(common | names_set(setters, "void set_camera", "void set_all(const RenderRequest"), RENDER)
        self.same(of_scene, SCENE)
        # FilesRequest::parameters sets the parameters of files that have no member.
        fields = members(requests, "ShadeRequest") | members(requests, "FilesRequest")
        fields -= {"files", "arrays", "left", "right", "bottom", "top", "parameters", "progress"}
        names = common | names_set(setters, "void set_all(const ShadeRequest")
        self.same(fields | {"window"}, names | (ARGUMENTS - {"model", "more_models"}) | {"width", "height"})
        self.assertLessEqual(names, SHADE)

    def test_keywords(self) -> None:
        self.same({"camera." + name for name in umbrage.Camera.__dataclass_fields__}, {n for n in RENDER if "." in n})
        self.assertLessEqual(set(KEYWORDS), RENDER | SHADE)
        of_calls = {"size", "camera", "images", "intrinsics", "mask", "dtype", "out", "progress", "values"}
        for function, of_class, known in (
            (umbrage.render, umbrage.Renderer, RENDER),
            (umbrage.shade, umbrage.Shader, SHADE),
        ):
            keywords = set(keywords_of(function))
            self.assertLessEqual({*keywords_of(of_class)} - keywords, set())
            self.assertLessEqual(keywords - known - ARGUMENTS - of_calls, {KEYWORDS[n] for n in known & set(KEYWORDS)})


if __name__ == "__main__":
    unittest.main()
