"""Runs the example and compares its occlusion with that of the program for the same depth: OPENGL_AO UMBRAGE KIT OUT"""
import subprocess
import sys

import numpy as np

example, umbrage, kit, out = sys.argv[1:]


def plane(file):
    kind, size, scale, texels = open(file, "rb").read().split(b"\n", 3)
    return np.frombuffer(texels, "<f4").reshape([int(n) for n in size.split()][::-1])


subprocess.run([example, kit, out], check=True)
subprocess.run([umbrage, "shade", out + "_depth.pfm", "--depth-kind", "planar", "--repair", "off",
                "--window=-0.72,0.72,-0.45,0.45", "--scene-radius", "8", "--effects", "normals,bitmask,denoise",
                "--passes", "ao", "--device", "cpu", "-o", out + "_expected.pfm"], check=True)
ao, expected = plane(out + "_ao.pfm"), plane(out + "_expected.pfm")
far = np.abs(ao - expected) > 0.004
print(f"max difference {np.abs(ao - expected).max():.5f}, above .004: {far.sum()} of {far.size}")
sys.exit(not (far.mean() <= 0.001 and expected.min() < 0.3 and (expected < 0.9).mean() > 0.02))
