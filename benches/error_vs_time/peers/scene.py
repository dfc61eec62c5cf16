"""A reader of OBJ and MTL files as far as this benchmark's scenes go: vertices, polygons, Kd, and Ke as radiance."""
import pathlib

import numpy as np


def read(path):
    """Vertices (n, 3); faces as (vertex indices, material name); materials as name -> (Kd, Ke)."""
    path = pathlib.Path(path)
    vertices, faces, materials, material = [], [], {}, None
    for line in path.read_text().splitlines():
        key, *words = line.split() or ["#"]
        if key == "v":
            vertices.append([float(word) for word in words[:3]])
        elif key == "mtllib":
            materials.update(read_materials(path.parent / words[0]))
        elif key == "usemtl":
            material = words[0]
        elif key == "f":
            indices = [int(word.split("/")[0]) for word in words]
            faces.append(([i - 1 if i > 0 else len(vertices) + i for i in indices], material))
    return np.array(vertices), faces, materials


def sheets(vertices, faces):
    """Faces as (vertex indices, material, material of the back or None): two faces on the same corners, one each way round, are a sheet.

    Of two faces in one place a ray would meet either."""
    found = {}
    for face, material in faces:
        corners = tuple(sorted(map(tuple, vertices[face])))
        if corners in found:
            found[corners][2] = material
        else:
            found[corners] = [face, material, None]
    return list(found.values())


def read_materials(path):
    materials, name = {}, None
    for line in path.read_text().splitlines():
        key, *words = line.split() or ["#"]
        if key == "newmtl":
            name = words[0]
            materials[name] = (np.zeros(3), np.zeros(3))
        elif key in ("Kd", "Ke"):
            materials[name][key == "Ke"][:] = [float(word) for word in words[:3]]
    return materials


def read_points(path):
    """Positions and normals."""
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    return table[:, :3], table[:, 3:6]


def write_values(path, values):
    np.savetxt(path, values, delimiter=",", header="B_r,B_g,B_b", comments="", fmt="%.7g")
