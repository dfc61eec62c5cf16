"""Reads an OBJ scene in Blender, and writes it as GLB: one-sided, as it was."""

import sys

import bpy


def with_own_vertices(mesh):
    """The same with vertices of its own for each face: of two faces on the same ones, the sides of a sheet, Blender would drop one."""
    faces = [[tuple(mesh.vertices[vertex].co) for vertex in face.vertices] for face in mesh.polygons]
    starts = [sum(len(face) for face in faces[:number]) for number in range(len(faces))]
    made = bpy.data.meshes.new(mesh.name)
    corners = [range(start, start + len(face)) for start, face in zip(starts, faces)]
    made.from_pydata([corner for face in faces for corner in face], [], [list(of) for of in corners])
    for material in mesh.materials:
        made.materials.append(material)
    for face, old in zip(made.polygons, mesh.polygons):
        face.material_index = old.material_index
    return made


source, target = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=source, validate_meshes=False)
for scene_object in bpy.data.objects:
    vertices = [frozenset(face.vertices) for face in scene_object.data.polygons] if scene_object.type == "MESH" else []
    if len(set(vertices)) < len(vertices):
        scene_object.data = with_own_vertices(scene_object.data)
for material in bpy.data.materials:
    material.use_backface_culling = True
bpy.ops.export_scene.gltf(filepath=target, export_format="GLB")
