"""From arrays and meshes to the parts that a scene is made of: what is said about shapes is said here, what is wrong with numbers in Rust."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ._errors import ArgumentError


class Parts(NamedTuple):
    """What a scene is made of. `Scene.of_parts` in Rust takes these in this order."""

    vertices: Any  # (V, 3), in metres
    corners: Any  # indices of vertices, face after face
    counts: Any  # (F,): how many corners each face has
    materials: Any  # (F,): rows of what follows
    reflectance: Any  # (M, C)
    exitance: Any  # (M, C), in W/m^2
    sides: str


class _Faces(NamedTuple):
    vertices: np.ndarray
    corners: np.ndarray
    counts: np.ndarray


def arrays(
    vertices: Any, faces: Any, *, reflectance: Any = 0.5, exitance: Any = 0.0, materials: Any = None, sides: str = "front"
) -> Parts:
    """The parts of `Scene.from_arrays`."""
    mesh = _Faces(_vertices(vertices), *_flat(faces))
    return _parts(mesh, materials, reflectance, exitance, sides)


def of_mesh(mesh: Any, *, reflectance: Any = 0.5, exitance: Any = 0.0, materials: Any = None, sides: str = "front") -> Parts:
    """The parts of `Scene.from_mesh`."""
    meshes = _meshes(mesh)
    each = [_faces(one) for one in meshes]

    # One mesh after another.
    starts = np.cumsum([0] + [len(one.vertices) for one in each])
    corners = [one.corners + start for one, start in zip(each, starts)]
    whole = _Faces(
        np.concatenate([one.vertices for one in each]), np.concatenate(corners), np.concatenate([one.counts for one in each])
    )

    # Materials: a name of what each mesh knows of its faces, a number for each mesh, or for each face.
    if isinstance(materials, str):
        materials = np.concatenate([_face_data(one, materials) for one in meshes])
    elif materials is not None and len(meshes) > 1 and np.shape(materials) == (len(meshes),):
        materials = np.repeat(np.asarray(materials), [len(one.counts) for one in each])
    return _parts(whole, materials, reflectance, exitance, sides)


def _parts(mesh: _Faces, materials: Any, reflectance: Any, exitance: Any, sides: str) -> Parts:
    reflectance, exitance = _by_material(reflectance, exitance)
    faces = len(mesh.counts)
    if materials is None:
        if len(reflectance) != 1:
            raise ArgumentError(f"there are {len(reflectance)} materials: say with materials= which of them each face has")
        materials = np.zeros(faces, dtype=np.int64)
    materials = np.asarray(materials)
    if materials.shape != (faces,):
        raise ArgumentError(f"materials has the shape {materials.shape}, it must be ({faces},): one for each face")
    return Parts(*mesh, materials, reflectance, exitance, sides)


def _by_material(reflectance: Any, exitance: Any) -> tuple[np.ndarray, np.ndarray]:
    """Both as arrays (M, C). Numbers stand for all channels, rows for all materials."""
    both = [np.atleast_2d(np.asarray(numbers)) for numbers in (reflectance, exitance)]
    try:
        reflectance, exitance = np.broadcast_arrays(*both)
    except ValueError:
        shapes = " and ".join(str(numbers.shape) for numbers in both)
        raise ArgumentError(f"reflectance and exitance have the shapes {shapes}, materials by channels, which do not fit") from None
    if reflectance.ndim != 2:
        raise ArgumentError(f"reflectance and exitance have {reflectance.ndim} axes, they must be (materials, channels)")
    return reflectance, exitance


def _vertices(vertices: Any) -> np.ndarray:
    vertices = np.asarray(vertices)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise ArgumentError(f"vertices has the shape {vertices.shape}, it must be (vertices, 3)")
    return vertices


def _flat(faces: Any) -> tuple[np.ndarray, np.ndarray]:
    """Corners of all faces, and how many each has; of an array, or of sequences of different lengths."""
    try:
        table = np.asarray(faces)
    except ValueError:
        table = None
    if table is None or table.dtype == object:
        rows = [np.asarray(row) for row in faces]
        if any(row.ndim != 1 for row in rows):
            raise ArgumentError("faces must be sequences of indices of vertices")
        counts = np.array([len(row) for row in rows], dtype=np.int64)
        return np.concatenate(rows), counts
    if table.size == 0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    if table.ndim != 2:
        raise ArgumentError(f"faces has the shape {table.shape}, it must be (faces, corners), or a sequence of sequences")
    return table.reshape(-1), np.full(len(table), table.shape[1], dtype=np.int64)


def _meshes(mesh: Any) -> Sequence[Any]:
    # A scene of trimesh places its meshes itself.
    if hasattr(mesh, "geometry") and hasattr(mesh, "dump"):
        mesh = mesh.dump()
    meshes = [mesh] if _is_mesh(mesh) else list(mesh) if isinstance(mesh, Iterable) else []
    if not meshes or not all(_is_mesh(one) for one in meshes):
        raise ArgumentError(
            "a scene is made of a Scene, a path, or meshes with vertices and faces (trimesh) or points and cells (meshio), "
            f"not of {type(mesh).__name__}"
        )
    return meshes


def _is_mesh(mesh: Any) -> bool:
    return all(hasattr(mesh, name) for name in ("vertices", "faces")) or all(hasattr(mesh, name) for name in ("points", "cells"))


# Cells of meshio that are faces, and those that are left out as in files: points and lines have no area.
_FACES = ("triangle", "quad", "polygon")
_WITHOUT_AREA = ("vertex", "line", "line3")


def _faces(mesh: Any) -> _Faces:
    if hasattr(mesh, "faces"):
        return _Faces(_vertices(mesh.vertices), *_flat(mesh.faces))
    flat = [_flat(block.data) for block in _blocks(mesh)]
    corners = np.concatenate([corners for corners, _ in flat] or [np.zeros(0, dtype=np.int64)])
    counts = np.concatenate([counts for _, counts in flat] or [np.zeros(0, dtype=np.int64)])
    return _Faces(_vertices(mesh.points), corners, counts)


def _blocks(mesh: Any) -> list[Any]:
    """The blocks of faces of a mesh of meshio."""
    kinds = {block.type for block in mesh.cells}
    others = sorted(kinds.difference(_FACES, _WITHOUT_AREA))
    if others:
        raise ArgumentError(f"cells of type {', '.join(others)} are no faces; give their surfaces as triangle, quad or polygon")
    return [block for block in mesh.cells if block.type in _FACES]


def _face_data(mesh: Any, name: str) -> np.ndarray:
    """What a mesh knows of its faces by this name."""
    known = mesh.face_attributes if hasattr(mesh, "faces") else mesh.cell_data
    if name not in known:
        raise ArgumentError(f"a mesh has no '{name}' of its faces; it has: {', '.join(known) or 'nothing'}")
    if hasattr(mesh, "faces"):
        return np.asarray(known[name])
    blocks = [np.asarray(data) for block, data in zip(mesh.cells, known[name]) if block.type in _FACES]
    return np.concatenate(blocks)
