"""Builds the Python package with the library in it. scripts/wheel puts more libraries into the package, which needs no build."""
import os
import re
import shutil
import subprocess

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before 70.1
    from wheel.bdist_wheel import bdist_wheel

ROOT = os.path.dirname(os.path.abspath(__file__))
BUILD = os.path.join(ROOT, "build-python")
PLATFORM = os.environ.get("UMBRAGE_PLATFORM")  # set by scripts/wheel


class Build(build_py):  # type: ignore[misc]
    """Adds the library, and the program with which it reads models, to the package."""

    def run(self) -> None:
        super().run()
        if PLATFORM:
            return
        folder = os.environ.get("UMBRAGE_BUILD", BUILD)
        if folder == BUILD:
            options = ["-DCMAKE_BUILD_TYPE=Release", "-DBUILD_SHARED_LIBS=ON", "-DUMBRAGE_BUILD_TESTS=OFF"]
            subprocess.check_call(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *options])
            subprocess.check_call(["cmake", "--build", folder, "--target", "umbrage_shared", "umbrage-import"])
        for file in ("libumbrage.so.1", "bin/umbrage-import"):
            shutil.copy(os.path.join(folder, file), os.path.join(self.build_lib, "umbrage"))


class Wheel(bdist_wheel):  # type: ignore[misc]
    """A wheel for any Python 3 on one platform: it contains the library but no compiled Python module."""

    def get_tag(self):  # type: ignore[no-untyped-def]
        return ("py3", "none", PLATFORM or super().get_tag()[2])


class Binary(Distribution):  # type: ignore[misc]
    def has_ext_modules(self) -> bool:
        return True


def version() -> str:
    """Returns the version of the C interface."""
    with open(os.path.join(ROOT, "include/umbrage/umbrage.h")) as header:
        return ".".join(re.findall(r"define UMB_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header.read()))


os.makedirs(BUILD, exist_ok=True)
setup(
    name="umbrage",
    version=version(),
    description="Screen-space shading for 3D models and G-buffers",
    license="MIT",
    python_requires=">=3.8",
    install_requires=["numpy>=1.17"],
    packages=["umbrage"],
    package_dir={"": "python"},
    package_data={"umbrage": ["py.typed", "*.inc", "*.so.*", "umbrage-import", "licences/*"]},
    zip_safe=False,
    distclass=Binary,
    cmdclass={"bdist_wheel": Wheel, "build_py": Build},
    options={"build": {"build_base": os.path.join(BUILD, "package")}, "egg_info": {"egg_base": BUILD}},
)
