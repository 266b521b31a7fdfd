"""Binary glTF 2.0 (GLB) of one mesh with vertex colours, as the standard of the Khronos Group lays it out."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

MAGIC, VERSION, JSON_CHUNK, BINARY_CHUNK = b"glTF", 2, b"JSON", b"BIN\0"
FLOAT, UNSIGNED_INT, UNSIGNED_BYTE = 5126, 5125, 5121  # component types
VERTICES, INDICES = 34962, 34963  # targets of buffer views


def glb_of(vertices: np.ndarray, faces: np.ndarray, colours: np.ndarray, material: dict[str, Any]) -> bytes:
    """vertices: (V, 3), m; faces: (F, 3); colours: (V, 4) amounts of light and opacity, 0…255; material: as in glTF."""
    positions = vertices.astype("<f4")
    low, high = positions.min(axis=0).tolist(), positions.max(axis=0).tolist()
    arrays: tuple[tuple[np.ndarray, int, int, str, dict[str, Any]], ...] = (
        (positions, FLOAT, VERTICES, "VEC3", {"min": low, "max": high}),
        (colours.astype("u1"), UNSIGNED_BYTE, VERTICES, "VEC4", {"normalized": True}),
        (faces.astype("<u4").reshape(-1, 1), UNSIGNED_INT, INDICES, "SCALAR", {}),
    )
    views, accessors, binary = [], [], b""
    for k, (array, component, target, kind, more) in enumerate(arrays):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes, "target": target})
        accessors.append({"bufferView": k, "componentType": component, "count": len(array), "type": kind} | more)
        binary += array.tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [material],
        "extensionsUsed": list(material.get("extensions", {})),
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    if not tree["extensionsUsed"]:
        del tree["extensionsUsed"]  # the standard allows no empty list
    chunks = _chunk(JSON_CHUNK, json.dumps(tree).encode(), b" ") + _chunk(BINARY_CHUNK, binary, b"\0")
    return MAGIC + struct.pack("<II", VERSION, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, content: bytes, filling: bytes) -> bytes:
    content += filling * (-len(content) % 4)
    return struct.pack("<I", len(content)) + kind + content
