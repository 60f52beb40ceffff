"""Writes a chart of spheres as a glTF file: metalness grows upwards, roughness to the right.

    python3 material_chart.py chart.gltf && umbrage chart.gltf -o chart.png
"""

import base64
import json
import math
import struct
import sys

SIDE = 5
SLICES, STACKS = 96, 48

normals, indices = [], []
for i in range(STACKS + 1):
    for k in range(SLICES + 1):
        down, around = math.pi * i / STACKS, 2 * math.pi * k / SLICES
        normals.append((math.sin(down) * math.cos(around), math.cos(down), -math.sin(down) * math.sin(around)))
for i in range(STACKS):
    for k in range(SLICES):
        a, b = i * (SLICES + 1) + k, (i + 1) * (SLICES + 1) + k
        indices += [a, b, b + 1] * (i < STACKS - 1) + [a, b + 1, a + 1] * (i > 0)
vectors = struct.pack(f"<{3 * len(normals)}f", *[c for n in normals for c in n])  # on a unit sphere, also positions
binary = vectors + struct.pack(f"<{len(indices)}H", *indices)

nodes, meshes, materials = [], [], []
for k in range(SIDE * SIDE):
    row, column = divmod(k, SIDE)
    nodes.append({"mesh": k, "translation": [2.2 * column, 2.2 * row, 0]})
    meshes.append({"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "material": k}]})
    rough = {"metallicFactor": row / (SIDE - 1), "roughnessFactor": column / (SIDE - 1)}
    materials.append({"pbrMetallicRoughness": {"baseColorFactor": [0.95, 0.63, 0.37, 1], **rough}})
uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
accessors = [
    {"bufferView": 0, "componentType": 5126, "count": len(normals), "type": "VEC3", "min": [-1] * 3, "max": [1] * 3},
    {"bufferView": 1, "componentType": 5123, "count": len(indices), "type": "SCALAR"},
]
views = [
    {"buffer": 0, "byteLength": len(vectors)},
    {"buffer": 0, "byteOffset": len(vectors), "byteLength": len(binary) - len(vectors)},
]
chart = {
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": list(range(len(nodes)))}],
    "nodes": nodes,
    "meshes": meshes,
    "materials": materials,
    "accessors": accessors,
    "bufferViews": views,
    "buffers": [{"byteLength": len(binary), "uri": uri}],
}
with open(sys.argv[1], "w", encoding="utf-8") as file:
    json.dump(chart, file)
