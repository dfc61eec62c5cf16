"""Reads a VTP file with PyVista, and prints what is in it as JSON."""

import json
import sys

import pyvista

mesh = pyvista.read(sys.argv[1])
print(
    "JSON",
    json.dumps(
        {
            "area": float(mesh.triangulate().area),
            "cells": mesh.n_cells,
            "points": mesh.n_points,
            "point_data": {name: mesh.point_data[name].tolist() for name in mesh.point_data.keys()},
            "cell_data": {name: mesh.cell_data[name].tolist() for name in mesh.cell_data.keys()},
        }
    ),
)
