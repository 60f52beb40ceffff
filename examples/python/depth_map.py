"""Shades the depth map of a neural network as a relief: depth_map.py disparity.npy relief.png

Networks such as MiDaS and Depth Anything return disparity, which has no unit; larger values are nearer. A
torch tensor on the CPU can be passed without conversion. Without an input file, a synthetic depth map is used.
"""
import sys

import numpy as np

import umbrage


def synthetic_disparity(width: int = 320, height: int = 240) -> np.ndarray:
    """Returns the disparity of some hills."""
    y, x = np.mgrid[-1 : 1 : height * 1j, -1.3 : 1.3 : width * 1j]
    hills = sum(np.exp(-(((x - a) ** 2 + (y - b) ** 2) / 0.1)) for a, b in ((-0.6, 0), (0.5, 0.3), (0.2, -0.5)))
    return (1 + 0.5 * hills + 0.2 * y).astype(np.float32)


def depth_of(disparity: np.ndarray, nearest: float = 1.0, farthest: float = 3.0) -> np.ndarray:
    """Converts disparity to distance. The disparity determines 1 / distance except for a scale and an offset: they are
    chosen so that nearly all distances are between `nearest` and `farthest`."""
    low, high = np.percentile(disparity, (1, 99))
    fraction = np.clip((disparity - low) / max(high - low, 1e-6), 0, None)
    return 1 / (1 / farthest + fraction * (1 / nearest - 1 / farthest))


def main() -> None:
    source, target = (sys.argv[1:] + [None] * 2)[:2] if len(sys.argv) > 2 else (None, sys.argv[-1])
    disparity = np.load(source) if source else synthetic_disparity()
    depth = depth_of(np.squeeze(disparity))
    shaded = umbrage.shade(depth, fov=50, look="studio", passes=("ao",))
    shaded.save(target)
    print(f"{target}: {shaded.width} x {shaded.height}, mean visibility {np.mean(shaded['ao']):.2f}")


if __name__ == "__main__":
    main()
