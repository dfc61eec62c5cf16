"""Patchlight: diffuse global illumination of polygonal scenes, with an error figure.

>>> import patchlight
>>> lit = patchlight.solve("room.obj", error=0.02)
>>> lit.values(points, normals).radiosity

Lengths are in metres, radiosities and exitances in W/m^2, radiances in W/m^2/sr.
"""

from ._errors import (
    ArgumentError,
    BackendError,
    Cancelled,
    Error,
    FileError,
    InternalError,
    LimitWarning,
    OptionError,
    ResourceError,
    SceneError,
    SceneWarning,
)
from ._native import (
    Camera,
    Diagnostic,
    Links,
    Mesh,
    Nodes,
    Option,
    Picture,
    Scene,
    Solution,
    Values,
    __version__,
    load,
    options,
    solve,
)

__all__ = [
    "ArgumentError",
    "BackendError",
    "Camera",
    "Cancelled",
    "Diagnostic",
    "Error",
    "FileError",
    "InternalError",
    "LimitWarning",
    "Links",
    "Mesh",
    "Nodes",
    "Option",
    "OptionError",
    "Picture",
    "ResourceError",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Solution",
    "Values",
    "__version__",
    "load",
    "options",
    "solve",
]
