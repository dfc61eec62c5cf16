"""Reads an OBJ scene in Blender, and writes it as GLB: one-sided, as it was."""

import sys

import bpy

source, target = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=source)
for material in bpy.data.materials:
    material.use_backface_culling = True
bpy.ops.export_scene.gltf(filepath=target, export_format="GLB")
