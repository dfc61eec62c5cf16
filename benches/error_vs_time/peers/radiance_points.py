"""Radiosities at points by Radiance: radiance_points.py SCENE POINTS VALUES OPTIONS

rtrace computes the irradiance H at points that reflect; B = Kd H. Radiance's surfaces reflect on both sides, and cannot emit and reflect.
The reflectance at a point is that of the face it lies in.
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import scene

DIRECT = "-dj 0.7 -ds 0.1 -dt 0 -dc 1"


def reflectances(vertices, faces, materials, positions, normals):
    """Kd of the face that each point lies in: the nearest plane with its normal, among faces whose edges it is within."""
    best = np.full(len(positions), np.inf)
    found = np.zeros((len(positions), 3))
    size = np.ptp(vertices, axis=0).max()
    for face, material in faces:
        corners = vertices[face]
        normal = sum(np.cross(corners[k] - corners[0], corners[k + 1] - corners[0]) for k in range(1, len(face) - 1))
        normal = normal / np.linalg.norm(normal)
        height = np.abs((positions - corners[0]) @ normal)
        inside = (normals @ normal > 0.99) & (height < 1e-5 * size)
        for k in range(len(face)):
            edge = corners[(k + 1) % len(face)] - corners[k]
            inside &= (positions - corners[k]) @ np.cross(normal, edge) > -1e-6 * size * np.linalg.norm(edge)
        nearer = inside & (height < best)
        best[nearer], found[nearer] = height[nearer], materials[material][0]
    return found


def main():
    path, points, values, options = sys.argv[1:5]
    home = pathlib.Path(importlib.util.find_spec("pyradiance").origin).parent
    environment = dict(os.environ, PATH=f"{home}/bin:{os.environ['PATH']}", RAYPATH=f".:{home}/lib")
    vertices, faces, materials = scene.read(path)
    positions, normals = scene.read_points(points)
    size = np.ptp(vertices, axis=0).max()
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/scene.rad", "w") as file:
            for name, (kd, ke) in materials.items():
                kind, numbers = ("light", ke) if ke.any() else ("plastic", [*kd, 0, 0])
                file.write(f"void {kind} {name}\n0\n0\n{len(numbers)} {' '.join(map(str, numbers))}\n")
            for number, (face, material, _) in enumerate(scene.sheets(vertices, faces)):
                corners = " ".join(f"{x:.9g}" for x in vertices[face].ravel())
                file.write(f"{material} polygon p{number}\n0\n0\n{3 * len(face)} {corners}\n")
        with open(f"{folder}/scene.oct", "wb") as file:
            subprocess.run(["oconv", f"{folder}/scene.rad"], stdout=file, env=environment, check=True)
        rays = np.hstack([positions + 1e-5 * size * normals, normals])
        text = "\n".join(" ".join(f"{x:.9g}" for x in ray) for ray in rays) + "\n"
        command = ["rtrace", "-h", "-w", "-I", *DIRECT.split(), *options.split(), f"{folder}/scene.oct"]
        done = subprocess.run(command, input=text, capture_output=True, text=True, env=environment, check=True)
    irradiance = np.array([[float(word) for word in line.split()[:3]] for line in done.stdout.strip().splitlines()])
    scene.write_values(values, reflectances(vertices, faces, materials, positions, normals) * irradiance)


main()
