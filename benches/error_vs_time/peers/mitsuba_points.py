"""Radiosities at points by Mitsuba 3's path tracer: mitsuba_points.py SCENE POINTS VALUES SAMPLES SEED

Each sample is a path that starts a little above the point and looks back at it, so that what it sees is the radiance that leaves the point;
times pi that is the radiosity. Lamps are sampled at every bounce, with multiple importance.
"""
import sys
import tempfile

import drjit as dr
import mitsuba as mi
import numpy as np

import scene

LARGEST_BATCH = 1 << 21


def mesh(path, vertices, triangles):
    """A binary PLY file, which Mitsuba reads."""
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    rows = np.zeros(len(triangles), dtype=[("count", "u1"), ("indices", "<i4", 3)])
    rows["count"], rows["indices"] = 3, triangles
    with open(path, "wb") as file:
        file.write(head.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())


def load(path, folder):
    vertices, faces, materials = scene.read(path)
    diffuse = lambda name: {"type": "diffuse", "reflectance": {"type": "rgb", "value": materials[name][0].tolist()}}
    groups = {}
    for face, front, back in scene.sheets(vertices, faces):
        groups.setdefault((front, back), []).extend((face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1))
    description = {"type": "scene"}
    for number, ((front, back), triangles) in enumerate(groups.items()):
        file = f"{folder}/{number}.ply"
        mesh(file, vertices, np.array(triangles))
        bsdf = diffuse(front) if back is None else {"type": "twosided", "front": diffuse(front), "back": diffuse(back)}
        shape = {"type": "ply", "filename": file, "face_normals": True, "bsdf": bsdf}
        if materials[front][1].any():
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": materials[front][1].tolist()}}
        description[f"shape{number}"] = shape
    return mi.load_dict(description)


def batch(lit, integrator, origins, directions, samples, seed):
    """Mean radiance at every point over so many samples."""
    count = len(origins)
    index = dr.arange(mi.UInt32, count * samples) // samples
    vector = lambda table: [dr.gather(mi.Float, mi.Float(np.ascontiguousarray(table[:, axis])), index) for axis in range(3)]
    ray = mi.RayDifferential3f(mi.Point3f(*vector(origins)), mi.Vector3f(*vector(directions)))
    sampler = mi.load_dict({"type": "multijitter", "sample_count": samples})
    sampler.set_samples_per_wavefront(samples)
    sampler.seed(seed, count * samples)
    radiance, _, _ = integrator.sample(lit, sampler, ray)
    radiance = mi.Color3f(radiance)
    sums = dr.zeros(mi.Float, 3 * count)
    for channel in range(3):
        dr.scatter_reduce(dr.ReduceOp.Add, sums, radiance[channel], index * 3 + channel)
    return np.array(sums).reshape(count, 3) / samples


def main():
    path, points, values, samples, seed = *sys.argv[1:4], int(sys.argv[4]), int(sys.argv[5])
    mi.set_variant("llvm_ad_rgb")
    positions, normals = scene.read_points(points)
    with tempfile.TemporaryDirectory() as folder:
        lit = load(path, folder)
        integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 5})
        height = 1e-4 * max(lit.bbox().max - lit.bbox().min)
        origins, directions = (positions + height * normals).astype(np.float32), (-normals).astype(np.float32)

        # Multijittered samples are a square number at once; what is too much for memory is done point by point or pass by pass.
        each = min(samples, 1024)
        at_once = max(1, LARGEST_BATCH // each)
        radiance = np.zeros((len(positions), 3))
        for first in range(0, len(positions), at_once):
            part = slice(first, first + at_once)
            passes = samples // each
            for k in range(passes):
                radiance[part] += batch(lit, integrator, origins[part], directions[part], each, seed * 100003 + first * 64 + k) / passes
    scene.write_values(values, np.pi * radiance)


main()
