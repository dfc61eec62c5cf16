"""A closed box whose faces all emit and reflect alike, from arrays: every radiosity is E / (1 - rho).

    python arrays.py
"""

import numpy as np
import scipy.sparse

import patchlight

# The corners of the box, and its faces seen from inside.
vertices = np.array([[x, y, z] for x in (0, 2) for y in (0, 3) for z in (0, 1)], dtype=float)
faces = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
rho, exitance = np.array([0.3, 0.5, 0.8]), np.array([1.0, 2.0, 0.5])
scene = patchlight.Scene.from_arrays(vertices, faces, reflectance=rho, exitance=exitance)

told = []
lit = patchlight.solve(scene, error=0.01, progress=lambda stage, fraction: told.append(stage))
radiosity = lit.values([[1, 1, 0], [0.2, 2.9, 0]], [0, 0, 1]).radiosity
print(radiosity, "W/m^2, exactly", exitance / (1 - rho))
np.testing.assert_allclose(radiosity, np.broadcast_to(exitance / (1 - rho), radiosity.shape), rtol=0.01)

# The links as a matrix: what leaves a node arrives somewhere, so the form factors of none add up to more than 1.
links = lit.links
matrix = scipy.sparse.csr_array((links.data, links.indices, links.indptr), shape=links.shape)
print(f"{matrix.nnz} links between {matrix.shape[0]} nodes")
