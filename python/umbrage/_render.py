"""The function render and the class Renderer, which renders several pictures of one model."""
from __future__ import annotations

import os
from typing import Any, List, Mapping, Optional, Sequence, Tuple, Union

from . import _native as native
from ._errors import UsageError
from ._foreign import active_values, is_model
from ._job import Job, Where, checked_dtype, shared_bar, requested_outputs
from ._lists import check_keywords, keywords_of, known_parameters
from ._mesh import VALUES
from ._picture import Picture
from ._progress import Progress, check_progress
from ._scene import Scene
from ._suggest import shown


class Renderer(Job):
    """Renders any number of pictures of one model or scene, which is read and prepared once. Memory is reused.

    ::

        with umbrage.Renderer("bunny.obj", size=(640, 480)) as renderer:
            for k in range(36):
                renderer.render({"azimuth_deg": 10 * k}).save(f"bunny_{k:02d}.png")

    `render` may be called any number of times, with different cameras, sizes and parameters. Data that is still valid
    is kept, and after an error further calls are allowed. A returned picture is not changed by later calls. Only one
    thread at a time can use the renderer; others wait. A scene without lights gets lights that are placed relative to
    the camera of each picture; those for a camera inside the scene, such as in a room, are kept.
    """

    _kind = "Renderer"
    _orbits = True  # unless the camera says otherwise

    def __init__(
        self,
        model: Any,
        *,
        size: Tuple[int, int] = (1024, 1024),
        look: Optional[str] = None,
        camera: Where = None,
        passes: Union[str, Sequence[str]] = (),
        quality: Optional[str] = None,
        settings: Optional[Mapping[str, Any]] = None,
        dtype: Any = "uint8",
        device: str = "auto",
        threads: int = 0,
        progress: Progress = None,
        values: Any = None,
        **parameters: Any,
    ) -> None:
        """Arguments and errors are those of umbrage.render. Arguments that describe a picture become the defaults of
        the method `render`."""
        field = _field_of(model, values, parameters.get("color_by"))
        if field is not None:
            parameters["color_by"] = field
        of_scene = {name: parameters.pop(name) for name in _of_scene_alone() if name in parameters}
        check_keywords(parameters, "render", [*keywords_of(render), *known_parameters("scene")])
        check_progress(progress)
        if isinstance(model, Scene) and of_scene:
            raise UsageError(f"`{next(iter(of_scene))}` is a parameter of the scene: set it by Scene.set before adding models")
        is_read = isinstance(model, (str, os.PathLike))
        if field is not None and not isinstance(model, Scene):
            of_scene["color_by"] = field
        if values is not None:
            scene = Scene(**of_scene)
            scene.add_mesh(*_arrays_of(model), values=values if isinstance(values, Mapping) else {field: values})
        else:
            scene = model if isinstance(model, Scene) else Scene(**of_scene) if is_read else Scene.of(model, **of_scene)
        super().__init__(device, threads, scene)
        self._size = _size(size)
        self._camera, self._passes, self._dtype, self._progress = camera, passes, dtype, progress
        self._set_all(settings, look=look, quality=quality, **parameters)
        self._place(self._size, camera)
        self._check_passes(passes)
        checked_dtype(dtype)
        self._job.check(native.lib.umbCheckJob(self._job.pointer))  # before the model is read
        if is_read:
            scene.add(model, progress=progress)

    def prepare(self, *, progress: Progress = None) -> None:
        """Does the work that precedes the first picture: builds the ray-tracing acceleration structure. If it is
        not called, the first call of `render` does this work. Errors: FileError, DeviceError, exceptions of
        `progress`."""
        with self._exclusive(), self._used_scene().reading():
            self._call(native.lib.umbPrepareJob, self._progress if progress is None else progress, is_before=True)

    def render(
        self,
        camera: Where = None,
        *,
        size: Optional[Tuple[int, int]] = None,
        passes: Union[None, str, Sequence[str]] = None,
        dtype: Any = None,
        out: Any = None,
        progress: Progress = None,
        settings: Optional[Mapping[str, Any]] = None,
        **parameters: Any,
    ) -> Picture:
        """Renders one picture. Arguments that are None have the values that were given to Renderer. `settings` and
        parameters also apply to later calls.

        `out`: an array (height, width, 4) or (height, width, 3) for the picture, or a dict from names of passes to
        arrays. Arrays may have any strides. Errors: UsageError, DeviceError, exceptions of `progress`; the outputs are
        then unchanged.
        """
        for name in parameters:
            if name in ("device", "threads", "values", *_of_scene_alone()):
                raise UsageError(f"`{name}` cannot be changed: set it when creating the Renderer")
        check_keywords(parameters, "render", keywords_of(render))
        check_progress(progress)
        self._used_scene().check_filled()
        with self._exclusive(), self._used_scene().reading(), self._rolled_back_on_error():
            at = self._size if size is None else _size(size)
            self._set_all(settings, **parameters)
            self._place(at, self._camera if camera is None else camera)
            wanted = requested_outputs(
                at, self._dtype if dtype is None else dtype, self._passes if passes is None else passes, out, True
            )
            return self._make(at, wanted, self._progress if progress is None else progress)

    def _place(self, size: Tuple[int, int], camera: Where) -> None:
        self._set("width", size[0])
        self._set("height", size[1])
        self._set_camera(camera, self._orbits)

    def _used_scene(self) -> Scene:
        assert self._scene is not None
        return self._scene


def _of_scene_alone() -> List[str]:
    """Returns the parameters of scenes that are not also those of pictures."""
    return [name for name in known_parameters("scene") if name not in known_parameters("render")]


def _arrays_of(model: Any) -> Tuple[Any, Any]:
    """Returns vertices and faces of a model that consists of arrays. Errors: UsageError."""
    if isinstance(model, (tuple, list)) and len(model) == 2 and not is_model(model[0]):
        return model[0], model[1]
    if hasattr(model, "shape"):
        return model, None
    raise UsageError(f"`values` is for a model (vertices, faces), not {shown(model)}")


def _field_of(model: Any, values: Any, color_by: Any) -> Optional[str]:
    """Returns the name of the values to show; None: none. Errors: UsageError."""
    if color_by is True:
        color_by = active_values(model)
        if color_by is None:
            raise UsageError(f"`color_by` cannot be True: {shown(model)} has no values that are shown")
    if color_by is None and values is not None:
        if isinstance(values, Mapping) and len(values) != 1:
            raise UsageError(f"`color_by` is missing: `values` has {', '.join(map(repr, values)) or 'none'}")
        color_by = next(iter(values)) if isinstance(values, Mapping) else VALUES
    return None if color_by is None else str(color_by)


def _size(size: Any) -> Tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise UsageError(f"`size` takes (width, height), such as (1024, 1024), not {shown(size)}") from None
    return native.int32(width, "width"), native.int32(height, "height")


def render(
    model: Any,
    *,
    size: Tuple[int, int] = (1024, 1024),
    look: Optional[str] = None,
    camera: Where = None,
    passes: Union[str, Sequence[str]] = (),
    quality: Optional[str] = None,
    settings: Optional[Mapping[str, Any]] = None,
    dtype: Any = "uint8",
    out: Any = None,
    device: str = "auto",
    threads: int = 0,
    progress: Progress = None,
    values: Any = None,
    **parameters: Any,
) -> Picture:
    """Renders a model.

    ::

        umbrage.render("bunny.obj", camera={"azimuth_deg": 30}, passes=("depth", "ao")).save("bunny.png")

    model: a path or a list of paths, "scene:NAME", an umbrage.Scene, or what Scene.add takes.
    size: (width, height) in pixels, 1 to 16384 each.
    look: a name of umbrage.looks(); default: "studio".
    quality: "draft", "normal", "high", "ultra"; default: chosen by the look.
    camera: a Camera or a dict of its members.
    passes: passes to return besides the picture: "depth", "normal", "ao", ..., or "all".
    settings: a dict of parameters, such as {"bitmask.radius": "15%"}: see umbrage.parameters("bitmask").
    dtype: type of the picture, "uint8", "uint16", "float16" or "float32". Passes are float32, ids uint32.
    out: an array for the picture, or a dict from names of passes to arrays: see Renderer.render.
    values: values of a model (vertices, faces) that are shown as colours, as for Scene.add_mesh; one array needs no
    `color_by`. color_by: name of the values to show, of files, too; True: those that PyVista shows.
    device: "cpu", "vulkan", "vulkan:N" or "auto". threads: number of CPU threads; 0: all.
    progress: True shows a progress bar; a function is called with the fraction that is done, 0 to 1, about 20 times a
    second, in the calling thread; it cancels the work by returning False or raising an exception. Ctrl-C always
    cancels.
    Other keywords: names of umbrage.parameters("render") or ("scene"), such as `anti_aliasing=4` or `up="+Z"`.

    Errors: UsageError; FileError; DeviceError; Cancelled; exceptions of `progress`.
    """
    with shared_bar(progress) as shared, Renderer(
        model,
        size=size,
        look=look,
        camera=camera,
        passes=passes,
        quality=quality,
        settings=settings,
        dtype=dtype,
        device=device,
        threads=threads,
        progress=shared,
        values=values,
        **parameters,
    ) as renderer:
        renderer._orbits = False
        return renderer.render(out=out)
