"""Renders a mesh made with NumPy: numpy_mesh.py wave.png [size]"""
import sys

import numpy as np

import umbrage


def grid(side: int) -> "tuple[np.ndarray, np.ndarray]":
    """Returns the points of a square, (side, side, 2), and the quads between them."""
    points = np.stack(np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side)), axis=-1)
    corner = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel()
    quads = np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1)
    return points, quads


def main() -> None:
    target, size = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 512
    points, quads = grid(200)
    x, y = points[..., 0], points[..., 1]
    z = 0.25 * np.cos(9 * np.hypot(x, y)) * np.exp(-1.5 * (x * x + y * y))
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    # Float colors are linear light; 8-bit integers are sRGB.
    colors = np.stack([0.6 + 1.4 * z, 0.45 + 0 * z, 0.5 - 1.4 * z], axis=-1).reshape(-1, 3).clip(0, 1)

    scene = umbrage.Scene(vertices, quads, colors=colors, up="+Z")
    print("bounds", scene.bounds.tolist())
    with umbrage.Renderer(scene, size=(size, size * 3 // 4), passes=("depth",)) as renderer:
        for k, azimuth in enumerate((0, 40)):
            picture = renderer.render({"azimuth_deg": azimuth, "elevation_deg": 15})
            picture.save(target.replace(".png", f"_{k}.png"))
        print(renderer.device, picture, "nearest", picture["depth"].min())


if __name__ == "__main__":
    main()
