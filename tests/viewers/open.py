"""Opens a GLB in Blender, and prints what is in it as JSON."""

import json
import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
meshes = [thing.data for thing in bpy.data.objects if thing.type == "MESH"]
uv = [[list(corner.uv) for corner in layer.data] for mesh in meshes for layer in mesh.uv_layers]
images = [image for image in bpy.data.images if image.size[0] > 0]
print(
    "JSON",
    json.dumps(
        {
            "area": sum(polygon.area for mesh in meshes for polygon in mesh.polygons),
            "uv_layers": [len(mesh.uv_layers) for mesh in meshes],
            "uv_in_page": all(-1e-6 <= x <= 1 + 1e-6 for layer in uv for corner in layer for x in corner),
            "colours": [[attribute.name for attribute in mesh.color_attributes] for mesh in meshes],
            "images": [list(image.size) for image in images],
            # Rows from the bottom, as Blender has them; sRGB as in the file, since its pixels are not yet linear.
            "pixels": [round(255 * x) for image in images for x in image.pixels],
        }
    ),
)
