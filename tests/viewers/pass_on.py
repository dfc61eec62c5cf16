"""Reads GLB files with trimesh, and writes them again: pairs of files, from and to."""

import sys

import trimesh

for source, target in zip(sys.argv[1::2], sys.argv[2::2]):
    trimesh.load_scene(source).export(target)
