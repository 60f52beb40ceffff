"""Umbrage: screen-space shading for 3D models and G-buffers.

    import umbrage
    umbrage.render("bunny.obj", size=(1024, 1024), look="studio").save("bunny.png")
    umbrage.shade(depth, fov=40).picture
    umbrage.shade("render.exr").save("shaded.png")

docs/python.md is the guide. Errors are UmbrageError with `code`; see its subclasses.
"""
from ._errors import Cancelled, DeviceError, FileError, InternalError, UmbrageError, UmbrageWarning, UsageError
from ._job import Camera
from ._lists import Parameter, devices, effects, file_formats, looks, occlusions, parameters, scenes
from ._native import lib as _lib
from ._native import version_text as _version_text
from ._picture import Picture, Stroke
from ._render import Renderer, render
from ._scene import Scene
from ._shade import FileInfo, Shader, info, shade

__version__: str = _version_text(_lib.umbGetVersion())

__all__ = [
    "Camera",
    "Cancelled",
    "DeviceError",
    "FileError",
    "FileInfo",
    "InternalError",
    "Parameter",
    "Picture",
    "Renderer",
    "Scene",
    "Shader",
    "Stroke",
    "UmbrageError",
    "UmbrageWarning",
    "UsageError",
    "devices",
    "effects",
    "file_formats",
    "info",
    "looks",
    "occlusions",
    "parameters",
    "render",
    "scenes",
    "shade",
]
