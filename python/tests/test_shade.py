"""Tests of shade: types, strides, memory that is not copied, cameras, outputs."""
import math
import re
import unittest
import warnings
from typing import Any, List, Tuple

import numpy as np

import umbrage
from support import SIZE, SOLIDS, plane_depth
from umbrage import _arrays


class OnlyDlpack:
    """An array that only supports DLPack."""

    def __init__(self, array: np.ndarray) -> None:
        self._array = array

    def __dlpack__(self, **how: object) -> object:
        return self._array.__dlpack__(**how)  # type: ignore[attr-defined]

    def __dlpack_device__(self) -> object:
        return self._array.__dlpack_device__()  # type: ignore[attr-defined]


class OnlyInterface:
    def __init__(self, array: np.ndarray) -> None:
        self._kept = array
        self.__array_interface__ = array.__array_interface__


class OnAGpu(OnlyDlpack):
    def __dlpack_device__(self) -> object:
        return (2, 0)


class NeedsGradient:
    """A mock of a torch tensor that requires a gradient."""

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        raise RuntimeError("Can't call numpy() on Tensor that requires grad. Use tensor.detach().numpy() instead.")


def shade(*arrays: object, **arguments: object) -> umbrage.Picture:
    return umbrage.shade(*arrays, device="cpu", **arguments)  # type: ignore[arg-type]


class Inputs(unittest.TestCase):
    def setUp(self) -> None:
        self.depth = plane_depth()
        self.expected = shade(self.depth).picture

    def test_strides_and_kinds(self) -> None:
        d = self.depth
        wide = np.zeros((32, 48, 3), np.float32)
        wide[..., 1] = d
        alone = np.zeros((33 * 100,), np.uint8)
        offset = alone[1 : 1 + 4 * 48 * 16].view()
        unaligned = np.ndarray((16, 48), np.float32, offset, strides=(4 * 48, 4))
        unaligned[:] = d[:16]
        for array in (
            d[::-1].copy()[::-1],
            d[:, ::-1].copy()[:, ::-1],
            np.asfortranarray(d),
            wide[..., 1],
            np.repeat(np.repeat(d, 2, axis=0), 3, axis=1)[::2, ::3],
            d[:, :, np.newaxis],
            d.astype(np.float64),
            d.astype(">f4"),
            d.tolist(),
            memoryview(d),
            OnlyDlpack(d),
            OnlyInterface(d),
            np.ma.masked_array(d),
        ):
            np.testing.assert_array_equal(shade(array).picture, self.expected)
        np.testing.assert_array_equal(shade(unaligned).picture, shade(d[:16].copy()).picture)
        half = d.astype(np.float16)
        np.testing.assert_array_equal(shade(half).picture, shade(half.astype(np.float32)).picture)
        deep = (d * 10000).astype(np.uint16)
        np.testing.assert_array_equal(shade(deep).picture, shade(deep / np.float32(65535)).picture)

    def test_depth_without_a_surface_is_warned_of(self) -> None:
        depth = self.depth.copy()
        depth[:2, :5] = -0.5
        with self.assertWarnsRegex(umbrage.UmbrageWarning, "10 of 1536 depths are below 0"):
            shade(depth)
        with self.assertWarnsRegex(umbrage.UmbrageWarning, "no surface"):
            umbrage.Shader(device="cpu").shade(np.full_like(depth, np.nan))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            shade(self.depth)

    def test_types_of_every_kind_of_array(self) -> None:
        class OnlyBuffer:  # a memoryview has type and strides
            def __new__(cls, array: np.ndarray) -> memoryview:  # type: ignore[misc]
                return memoryview(array)

        for dtype in ("float32", "float16", "float64", "uint8", "uint16"):
            scale = 80 if dtype.startswith("u") else 1
            packed = np.round(self.depth * scale).astype(dtype)
            divisor = {"uint8": 255, "uint16": 65535}.get(dtype, 1)
            expected = shade(packed.astype(np.float32) / np.float32(divisor)).picture
            wide = np.repeat(packed, 2, axis=1)
            for array in (packed, packed[::-1].copy()[::-1], packed[:, ::-1].copy()[:, ::-1], wide[:, ::2]):
                for carrier in (OnlyDlpack, OnlyInterface, OnlyBuffer):
                    with self.subTest(dtype=dtype, strides=array.strides, carrier=carrier.__name__):
                        taken = _arrays.image_array(carrier(array), "depth")
                        self.assertEqual(taken.dtype, "float32" if dtype == "float64" else dtype)
                        if dtype != "float64":  # float64 is always converted
                            self.assertTrue(np.shares_memory(taken, array))
                        np.testing.assert_array_equal(shade(carrier(array)).picture, expected)
        for dtype in ("int8", "int16", "int32", "int64", "uint32", "uint64"):
            for carrier in (OnlyDlpack, OnlyInterface, OnlyBuffer):
                with self.assertRaisesRegex(umbrage.UsageError, f"`depth` has the dtype {dtype}: it takes float32"):
                    shade(carrier(self.depth.astype(dtype)))

    def test_nothing_is_copied_that_fits(self) -> None:
        d = self.depth
        for array in (d, d[::-1], d[:, ::-1], d.T, d[::2, ::3], d.astype(np.float16), OnlyDlpack(d), memoryview(d)):
            taken = _arrays.image_array(array, "depth")
            image = _arrays.image_of(taken)
            whole = np.asarray(array if not isinstance(array, OnlyDlpack) else d)
            self.assertEqual(image.data, whole.ctypes.data)
            self.assertEqual((image.row_stride, image.pixel_stride), whole.strides)
        ids = np.arange(6, dtype=np.int32).reshape(2, 3)
        self.assertEqual(_arrays.image_of(_arrays.image_array(ids, "object_id")).data, ids.ctypes.data)

    def test_the_library_reads_in_place(self) -> None:
        shader = umbrage.Shader(device="cpu", look="ao")
        normals = np.zeros((3, 32, 48), np.float32)
        normals[2] = 1
        for _ in range(2):
            shader.shade(self.depth, normals.transpose(1, 2, 0))
        self.assertEqual(shader.counter("planes_copied"), 0)

    def test_one_value_for_all_pixels(self) -> None:
        # To the library, a stride of 0 means packed.
        albedo = np.broadcast_to(np.array([1, 0.5, 0], np.float32), (32, 48, 3))
        whole = shade(self.depth, albedo=albedo.copy()).picture
        np.testing.assert_array_equal(shade(self.depth, albedo=albedo).picture, whole)
        np.testing.assert_array_equal(shade(self.depth, albedo=(1, 0.5, 0)).picture, whole)
        self.assertTrue((whole != self.expected).any())

    def test_a_rendered_gbuffer(self) -> None:
        names = ("depth", "normal", "albedo", "object_id")
        rendered = umbrage.render(SOLIDS, size=SIZE, device="cpu", passes=names, camera={"view_angle_deg": 30})
        shaded = shade(*(rendered[name] for name in names[:3]), object_id=rendered["object_id"], fov=30, look="cartoon",
                       passes=("normal", "object_id"), strokes=True)
        there = np.isfinite(rendered["depth"])
        np.testing.assert_allclose(shaded["normal"], rendered["normal"], atol=1e-6)
        np.testing.assert_array_equal(shaded["object_id"][there], rendered["object_id"][there])
        self.assertFalse(shaded["object_id"][~there].any())
        self.assertTrue(shaded.strokes)
        signed = shade(rendered["depth"], object_id=rendered["object_id"].astype(np.int64) % 1000, passes="object_id")
        np.testing.assert_array_equal(signed["object_id"][there], (rendered["object_id"] % 1000)[there])
        other = shade(rendered["depth"], images={"normal": rendered["normal"].transpose(2, 0, 1).copy().transpose(1, 2, 0),
                                                 "layer1.depth": rendered["depth"] * 1.1})
        self.assertEqual(other.picture.shape, (32, 48, 4))

    def test_nothing_where_depth_is_nan(self) -> None:
        holes = np.full((32, 48), np.nan, np.float32)
        self.assertTrue((shade(holes, transparent=True).picture[..., 3] == 0).all())
        masked = np.ma.masked_less(self.depth, 2.9)
        filled = np.where(self.depth < 2.9, np.inf, self.depth)
        np.testing.assert_array_equal(shade(masked).picture, shade(filled).picture)


class Arguments(unittest.TestCase):
    def setUp(self) -> None:
        self.depth = plane_depth()

    def test_cameras(self) -> None:
        top = math.tan(math.radians(30))
        window = (-top * 1.5, top * 1.5, -top, top)
        wide = shade(self.depth, fov=60).picture
        np.testing.assert_array_equal(wide, shade(self.depth, window=window).picture)
        self.assertTrue((wide != shade(self.depth).picture).any())
        np.testing.assert_array_equal(shade(self.depth).picture, shade(self.depth, fov=55).picture)
        shade(self.depth, orthographic=True, window=(-1.5, 1.5, -1, 1))
        near, far = 1.0, 10.0
        buffer = far * (self.depth - near) / (self.depth * (far - near))
        seen = shade(buffer, depth_kind="window", near=near, far=far, passes="depth")["depth"]
        np.testing.assert_allclose(seen, self.depth, rtol=1e-4)
        self.assertEqual(shade(self.depth, view_from_normal=np.eye(3)).height, 32)

    def test_sequences(self) -> None:
        before = plane_depth()
        after = before.copy()
        after[:4, :4] *= 40  # a far object enters
        for sequence in (False, True):
            with umbrage.Shader(look="ao", settings={"bitmask.radius": "5%"}, device="cpu", sequence=sequence) as shader:
                first, second = shader.shade(before).picture, shader.shade(after).picture
            same = (first[16:, 16:] == second[16:, 16:]).all()
            self.assertEqual(same, sequence)

    def test_effects(self) -> None:
        made = shade(self.depth, effects=("bitmask", "denoise"))
        self.assertEqual(list(made), ["ao"])
        with self.assertRaises(umbrage.UsageError):
            made.picture
        self.assertIsNone(made._repr_png_())
        np.testing.assert_array_equal(shade(self.depth, effects="bitmask,denoise", passes="ao")["ao"], made["ao"])
        self.assertEqual(list(shade(self.depth, effects=("bitmask",), passes=("ao", "normal"))), ["ao", "normal"])

    def test_a_shader_is_used_again(self) -> None:
        shader = umbrage.Shader(fov=60, device="cpu")
        alone = shader.shade(self.depth).picture
        colored = shader.shade(self.depth, albedo=(1, 0, 0)).picture
        self.assertTrue((alone != colored).any())
        np.testing.assert_array_equal(shader.shade(self.depth).picture, alone)  # the albedo is not kept
        self.assertEqual(shader.shade(self.depth[:20, :20]).picture.shape, (20, 20, 4))
        shader.set("look", "ao")
        self.assertTrue((shader.shade(self.depth).picture != alone).any())

    def test_out(self) -> None:
        expected = shade(self.depth, passes="ao")
        for dtype in (np.uint8, np.float32, np.float16, np.uint16):
            out = np.zeros((32, 48, 4), dtype)
            self.assertIs(shade(self.depth, out=out).picture, out)
            np.testing.assert_array_equal(out, shade(self.depth, dtype=dtype).picture)
        ao = np.zeros((32, 96), np.float32)[:, ::-2]
        made = shade(self.depth, out={"ao": ao})
        np.testing.assert_array_equal(ao, expected["ao"])
        np.testing.assert_array_equal(made.picture, expected.picture)
        raw = bytearray(32 * 48 * 4)
        shade(self.depth, out=memoryview(raw).cast("B", (32, 48, 4)))
        self.assertEqual(bytes(raw), expected.picture.tobytes())


class Positions(unittest.TestCase):
    def test_a_point_map_gives_depth_and_camera(self) -> None:
        y, x = np.mgrid[0:32, 0:48]
        u, v = (x + 0.5 - 24) / 40, (y + 0.5 - 16) / 40  # a focal length of 40 pixels; y is down, z is forward
        depth = 4 + np.sin(0.3 * x) + 0.5 * np.cos(0.4 * y)
        points = np.stack([u * depth, v * depth, depth], -1)
        mask = x > 5
        points[~mask] = (3, 1, 9)
        picture = shade(position=points, mask=mask, albedo=(0.5, 0.5, 0.5), passes="depth")
        np.testing.assert_allclose(picture["depth"][mask], depth[mask], rtol=1e-5)
        self.assertTrue(np.isinf(picture["depth"][~mask]).all())
        self.assertTrue(any("fitted to positions" in fact for fact in picture.facts), picture.facts)
        with self.assertRaisesRegex(umbrage.UsageError, r"`normal` has the shape \(2, 2, 3\): `position` has"):
            shade(position=points, normal=np.ones((2, 2, 3)))


class Mistakes(unittest.TestCase):
    def refused(self, text: str, *arrays: object, **arguments: object) -> None:
        with self.assertRaisesRegex(umbrage.UsageError, text) as caught:
            shade(*arrays, **arguments)
        self.assertEqual(caught.exception.code, 2)

    def test_inputs(self) -> None:
        d = plane_depth()
        self.refused("shape", d[0])
        self.refused("squeeze", d[np.newaxis, np.newaxis])
        self.refused("one channel", np.zeros((32, 48, 3), np.float32))
        self.refused("channels first", d, np.zeros((3, 32, 48), np.float32))
        self.refused("48 x 31", d, np.zeros((31, 48, 3), np.float32))
        self.refused("channels", d, np.zeros((32, 48, 2), np.float32))
        self.refused("0 x 0|0 pixels|no values", np.zeros((0, 0), np.float32))
        self.refused("0 pixels|no values", np.zeros((0, 48), np.float32))
        self.refused("20000", np.broadcast_to(np.float32(1), (1, 20000)))
        self.refused("complex", d.astype(np.complex64))
        self.refused("int64", d.astype(np.int64))
        self.refused("object", np.array([[None]]))
        self.refused("has the dtype", [["depth"]])
        self.refused("CPU", OnAGpu(d))
        self.refused("`depth` cannot be read as an array", NeedsGradient())
        self.refused("ids have 32 bits", d, object_id=np.full((32, 48), 2**40))
        self.refused("ids are integers", d, object_id=np.full((32, 48), "a"))
        self.refused("two images", d, images={"depth": d})
        self.refused("normal", d, images={"normals": d})
        self.refused("layer1|layer2", d, images={"layer2.depth": d})

    def test_outputs(self) -> None:
        d = plane_depth()
        read_only = np.zeros((32, 48, 4), np.uint8)
        read_only.flags.writeable = False
        self.refused("written", d, out=read_only)
        self.refused("share memory", d, out=np.lib.stride_tricks.as_strided(np.zeros(9999, np.uint8), (32, 48, 4), (48, 1, 1)))
        self.refused("has the dtype float64", d, out=np.zeros((32, 48, 4)))
        self.refused("takes an array", d, out=[[1]])
        self.refused("pixels", d, out=np.zeros((32, 47, 4), np.uint8))
        self.refused("channels", d, out=np.zeros((32, 48, 2), np.uint8))
        self.refused("32-bit", d, out=np.zeros((32, 48, 4), np.uint32))
        both = np.zeros((32, 48), np.float32)
        self.refused("share memory", d, out={"ao": both, "depth": both})
        self.refused("aoo", d, out={"aoo": both})
        self.refused("still read", d, out={"ao": d})
        rgbd = np.zeros((32, 48, 4), np.float32)
        rgbd[..., 3] = d
        self.refused("still read", rgbd[..., 3], out=rgbd)
        made = shade(rgbd[..., 3], out={"normal": rgbd[..., :3]})  # interleaved
        np.testing.assert_array_equal(made["normal"], shade(d, passes="normal")["normal"])

    def test_arguments(self) -> None:
        d = plane_depth()
        self.refused("fov", d, fov=180)
        self.refused("fov", d, fov=60, window=(-1, 1, -1, 1))
        self.refused("window", d, window=(1, -1, -1, 1))
        self.refused("window", d, window=(1, -1))
        self.refused("window", d, orthographic=True)
        self.refused("depth_kind", d, depth_kind="z")
        self.refused("near", d, near=math.inf)
        self.refused("dtype", d, dtype="int8")
        self.refused("dtype", d, dtype="nothing")
        self.refused("bitmask", d, effects="bitmusk")
        self.refused("look", d, look=3)
        self.refused("threads", d, threads=-1)
        self.refused("threads", d, threads="all")
        self.refused("null character", d, look="ao\0")
        self.refused("nix", d, nix=1)


class Values(unittest.TestCase):
    """Values that are not what they are to be are converted if there is no doubt, and warned of."""

    made: umbrage.Picture

    @classmethod
    def setUpClass(cls) -> None:
        passes = ("depth", "normal", "albedo")
        cls.made = umbrage.render(SOLIDS, size=(160, 120), device="cpu", passes=passes, camera={"view_angle_deg": 40})

    def shaded(self, normal: Any, albedo: Any = None, **arguments: Any) -> Tuple[np.ndarray, List[str]]:
        camera = {} if "intrinsics" in arguments or "focal_length_px" in arguments else {"fov": 40}
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            picture = shade(self.made["depth"], normal, albedo, **camera, **arguments).picture
        return picture.astype(int), [str(each.message) for each in caught]

    def test_encoded_normals_are_decoded(self) -> None:
        normal = self.made["normal"]
        expected, said = self.shaded(normal)
        self.assertEqual(said, [])
        bytes_ = np.rint((normal + 1) * 127.5)
        for encoded in ((normal + 1) / 2, bytes_, bytes_.astype(np.uint8), np.rint((normal + 1) * 32767.5).astype(np.uint16)):
            picture, said = self.shaded(encoded)
            self.assertLess(np.abs(picture - expected).mean(), 0.5)
            self.assertRegex(" ".join(said), "^`normal` has components from 0 to .*`normal_encoding` unsigned")
            again, said = self.shaded(encoded, normal_encoding="unsigned")
            self.assertEqual(said, [])
            np.testing.assert_array_equal(again, picture)
        self.assertEqual(self.shaded(normal * 3)[1], [])  # only longer

    def test_normals_of_other_axes_are_warned_of(self) -> None:
        normal = self.made["normal"]
        expected, _ = self.shaded(normal)
        world = normal @ np.array([[0.6, 0, -0.8], [0.48, 0.8, 0.36], [0.64, -0.6, 0.48]], np.float32)
        for other, space in ((normal * np.float32([1, -1, -1]), "x right, y down, z away"), (world, "world space")):
            wrong, said = self.shaded(other)
            self.assertGreater(np.abs(wrong - expected).mean(), 5)
            self.assertEqual(len(said), 1)
            self.assertIn(space, said[0])
            rotation = re.search(r"`view_from_normal` (\S+) converts", said[0])
            assert rotation, said
            right, said = self.shaded(other, view_from_normal=[float(number) for number in rotation[1].split(",")])
            self.assertEqual(said, [])
            self.assertLess(np.abs(right - expected).mean(), 1)
        noise = np.random.default_rng(1).normal(size=normal.shape).astype(np.float32)
        self.assertRegex(" ".join(self.shaded(noise)[1]), "normals and depth do not fit, .*may be wrong")

    def test_colours_above_1_are_warned_of(self) -> None:
        normal, albedo = self.made["normal"], self.made["albedo"]
        self.assertEqual(self.shaded(normal, albedo)[1], [])
        for bright in (albedo * 255, 3 * albedo, (200, 180, 160)):
            self.assertRegex(" ".join(self.shaded(normal, bright)[1]), r"^`albedo` has values up to .* from 0 to 1: \(x / 255\) \*\* 2.2 ")
        beauty = np.rint(np.pad(albedo * 255, ((0, 0), (0, 0), (0, 1)), constant_values=1))
        self.assertRegex(" ".join(self.shaded(normal, beauty=beauty)[1]), "^`beauty` has values up to ")
        self.assertEqual(self.shaded(normal, beauty=beauty / 20)[1], [])  # light may be bright

    def test_intrinsics_of_another_size_are_warned_of(self) -> None:
        normal, focal = self.made["normal"], 60 / math.tan(math.radians(20))
        matrix = np.array([[focal, 0, 79.5], [0, focal, 59.5], [0, 0, 1]])
        self.assertEqual(self.shaded(normal, intrinsics=matrix)[1], [])
        said = " ".join(self.shaded(normal, intrinsics=matrix * [[3], [3], [1]])[1])
        self.assertRegex(said, r"centre of the intrinsics, \(238.5, 178.5\), .* 160 x 120 pixels: .* must be scaled")
        said = " ".join(self.shaded(None, focal_length_px=(focal, focal, 80, 10))[1])
        self.assertRegex(said, "far from the middle of 160 x 120 pixels")


class CamerasAndMasks(unittest.TestCase):
    def test_intrinsics_are_the_window_of_the_picture(self) -> None:
        depth = plane_depth()
        height, width = depth.shape
        focal = 0.9 * height
        top, right = height / 2 / focal, width / 2 / focal
        expected = umbrage.shade(depth, window=(-right, right, -top, top)).picture
        for camera in (
            {"intrinsics": [[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]]},
            {"intrinsics": np.array([[[focal / width, 0, 0.5], [0, focal / height, 0.5], [0, 0, 1]]])},
            {"focal_length_px": focal},
        ):
            np.testing.assert_allclose(umbrage.shade(depth, **camera).picture, expected, atol=1)

    def test_mask_gives_the_background(self) -> None:
        depth = plane_depth()
        mask = np.ones(depth.shape, bool)
        mask[: depth.shape[0] // 2] = False
        result = umbrage.shade(depth, mask=mask, passes=("depth",))["depth"]
        self.assertTrue(np.isinf(result[~mask]).all())
        np.testing.assert_array_equal(result[mask], depth[mask])


if __name__ == "__main__":
    unittest.main()
