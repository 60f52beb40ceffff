"""Builds the wheel: scripts/wheel puts the libraries into the package first."""
import os
import re

from setuptools import Distribution, setup
from wheel.bdist_wheel import bdist_wheel


class Wheel(bdist_wheel):  # type: ignore[misc]
    """A wheel for any Python 3 on one platform: it contains the library but no compiled Python module."""

    def get_tag(self):  # type: ignore[no-untyped-def]
        return ("py3", "none", os.environ["UMBRAGE_PLATFORM"])


class Binary(Distribution):  # type: ignore[misc]
    def has_ext_modules(self) -> bool:
        return True


def version() -> str:
    """Returns the version of the C interface."""
    with open(os.environ["UMBRAGE_HEADER"]) as header:
        return ".".join(re.findall(r"define UMB_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header.read()))


setup(
    name="umbrage",
    version=version(),
    description="Screen-space shading for 3D models and G-buffers",
    license="MIT",
    python_requires=">=3.8",
    install_requires=["numpy>=1.17"],
    packages=["umbrage"],
    package_data={"umbrage": ["py.typed", "*.inc", "*.so.*", "umbrage-import", "licences/*"]},
    zip_safe=False,
    distclass=Binary,
    cmdclass={"bdist_wheel": Wheel},
)
