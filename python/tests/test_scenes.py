"""Scenes from arrays, meshes and files, and what is said about bad ones."""

import types

import numpy as np
import pytest
from conftest import BOX_FACES, BOX_VERTICES, lamp_box

import patchlight

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def quietly(*args, **kwargs):
    with pytest.warns(patchlight.SceneWarning, match="no light"):
        return patchlight.Scene.from_arrays(*args, **kwargs)


def test_shapes_of_materials_say_how_many_channels_there_are():
    for reflectance, exitance, shape in [
        (0.5, 1.0, (1, 1)),
        ([0.1, 0.2, 0.3], 1, (1, 3)),
        (0.5, [1, 2], (1, 2)),
        (np.float32(0.25), np.ones((1, 7), np.float32), (1, 7)),
    ]:
        scene = patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, reflectance=reflectance, exitance=exitance)
        assert scene.reflectance.shape == scene.exitance.shape == shape
        assert scene.channels == shape[1]
    assert (scene.surface_count, scene.area) == (6, pytest.approx(22.0))
    assert (scene.bounds == [[0, 0, 0], [2, 3, 1]]).all()


@pytest.mark.parametrize("dtype", [np.int8, np.uint16, np.int64, np.uint64])
def test_indices_may_have_any_whole_type(dtype):
    assert quietly(SQUARE, np.array([[0, 1, 2, 3]], dtype=dtype)).area == 1


def test_faces_may_have_different_numbers_of_corners():
    scene = quietly(SQUARE + [[0.5, 2, 0]], [[0, 1, 2, 3], [3, 2, 4]])
    assert (scene.surface_count, scene.area) == (2, pytest.approx(1.5))


def test_arrays_that_are_not_contiguous_are_read_right():
    wide = np.zeros((4, 6), order="F")
    wide[:, ::2] = SQUARE
    assert quietly(wide[:, ::2], [[0, 1, 2, 3]]).area == 1


@pytest.mark.parametrize(
    "arguments, error, says",
    [
        (dict(faces=[[0, 1, 9]]), patchlight.SceneError, "vertex 9 does not exist"),
        (dict(faces=[[0, 1, -1]]), patchlight.ArgumentError, "faces holds -1"),
        (dict(faces=[[0.0, 1.0, 2.0]]), patchlight.ArgumentError, "whole numbers"),
        (dict(vertices=[[0, 0], [1, 1]]), patchlight.ArgumentError, r"\(2, 2\)"),
        (dict(vertices=[["a", "b", "c"]]), patchlight.ArgumentError, "must hold numbers"),
        (dict(vertices=[[0, 0, np.nan]] * 3, faces=[[0, 1, 2]]), patchlight.SceneError, "vertex 0 has a coordinate"),
        (dict(reflectance=1.0), patchlight.SceneError, r"reflectance 1 is not in \[0, 1\)"),
        (dict(exitance=[[1], [2]]), patchlight.ArgumentError, "materials="),
        (dict(exitance=[[1], [2]], materials=[2]), patchlight.SceneError, "material 2 does not exist"),
        (dict(materials=[0, 0]), patchlight.ArgumentError, "one for each face"),
        (dict(reflectance=[1, 2], exitance=[1, 2, 3]), patchlight.ArgumentError, "do not fit"),
        (dict(faces=[]), patchlight.SceneError, "no surface"),
        (dict(sides="back"), patchlight.ArgumentError, "front"),
        (dict(colour=1), TypeError, "colour"),
    ],
)
def test_what_is_wrong_is_said(arguments, error, says):
    arguments = {"vertices": SQUARE, "faces": [[0, 1, 2, 3]], **arguments}
    with pytest.raises(error, match=says):
        patchlight.Scene.from_arrays(**arguments)


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(patchlight.SceneError) as caught:
        patchlight.Scene.from_arrays(SQUARE, [[0, 1, 9], [0, 1, 2], [8, 1, 2]], reflectance=-1)
    assert isinstance(caught.value, (patchlight.Error, ValueError))
    found = [(one.kind, one.severity, one.face) for one in caught.value.diagnostics]
    assert found == [("bad_index", "error", 0), ("bad_index", "error", 2), ("bad_material", "error", None)]


def test_repairs_are_warned_of_and_kept():
    with pytest.warns(patchlight.SceneWarning):
        scene = patchlight.Scene.from_arrays(SQUARE, [[0, 1, 2, 3], [0, 1, 1, 0]], exitance=1)
    [noted] = scene.diagnostics
    assert (noted.kind, noted.severity, noted.face) == ("degenerate_face", "repair", 1)
    assert str(noted).startswith("face 2: dropped")


def test_files_name_their_lines(tmp_path):
    file = tmp_path / "bad.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nf 1 2 3\n")
    with pytest.raises(patchlight.SceneError, match="bad.obj:3: face 1: vertex 3 does not exist") as caught:
        patchlight.Scene.read(file)
    [noted] = caught.value.diagnostics
    assert (noted.kind, str(noted.file), noted.line, noted.face) == ("bad_index", str(file), 3, 0)
    with pytest.raises(OSError, match="cannot be read") as caught:
        patchlight.Scene.read(str(tmp_path / "missing.obj"))
    assert isinstance(caught.value, patchlight.FileError)
    with pytest.raises(patchlight.SceneError, match="unknown kind of file"):
        patchlight.solve(tmp_path / "scene.fbx")


def test_both_sides_make_two_surfaces_of_a_face():
    assert lamp_box().surface_count == 6
    assert lamp_box(sides="both").surface_count == 12


def test_objects_with_vertices_and_faces_are_meshes():
    mesh = types.SimpleNamespace(vertices=BOX_VERTICES, faces=BOX_FACES)
    assert patchlight.Scene.from_mesh(mesh, exitance=1).area == pytest.approx(22.0)
    beside = types.SimpleNamespace(vertices=BOX_VERTICES + [5, 0, 0], faces=BOX_FACES)
    both = patchlight.Scene.from_mesh([mesh, beside], exitance=[[0], [1]], materials=[0, 1])
    assert (both.surface_count, both.bounds[1, 0]) == (12, 7)
    for nothing in (3, object(), [mesh, 3], []):
        with pytest.raises(patchlight.ArgumentError, match="trimesh"):
            patchlight.solve(nothing)


def test_meshes_of_trimesh():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((2, 3, 1))
    box.invert()
    lamp = trimesh.creation.box((0.5, 0.5, 0.1))
    scene = patchlight.Scene.from_mesh([box, lamp], reflectance=0.5, exitance=[[0], [1]], materials=[0, 1])
    assert scene.area == pytest.approx(22 + 0.7)
    assert patchlight.solve(scene, error=0.1).report["energy"]["emitted"] == pytest.approx(0.7)

    box.face_attributes["paint"] = (np.arange(12) < 2).astype(int)
    scene = patchlight.Scene.from_mesh(box, exitance=[[0], [1]], materials="paint")
    assert scene.surface_count == 12
    with pytest.raises(patchlight.ArgumentError, match="it has: paint"):
        patchlight.Scene.from_mesh(box, exitance=[[0], [1]], materials="colour")

    # A scene places its meshes.
    placed = trimesh.Scene()
    placed.add_geometry(box)
    placed.add_geometry(lamp, transform=trimesh.transformations.translation_matrix([0, 0, 5]))
    assert patchlight.Scene.from_mesh(placed, exitance=1).bounds[1, 2] == pytest.approx(5.05)


def test_meshes_of_meshio():
    meshio = pytest.importorskip("meshio")
    points = np.array(SQUARE + [[0.5, 2, 0]], dtype=float)
    cells = [("quad", np.array([[0, 1, 2, 3]])), ("line", np.array([[0, 1]])), ("triangle", np.array([[3, 2, 4]]))]
    mesh = meshio.Mesh(points, cells, cell_data={"lamp": [np.array([0]), np.array([9]), np.array([1])]})
    scene = patchlight.Scene.from_mesh(mesh, exitance=[[0], [2]], materials="lamp")
    assert (scene.surface_count, scene.area) == (2, pytest.approx(1.5))
    with pytest.raises(patchlight.ArgumentError, match="tetra"):
        patchlight.solve(meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 4]]))]))


def test_lights_of_a_file_light_a_scene(tmp_path):
    lights = tmp_path / "lights.toml"
    lights.write_text('[[point]]\nname = "lamp"\nposition = [0.5, 0.5, 2]\nintensity = 12\n')
    scene = quietly(SQUARE, [[0, 1, 2, 3]]).with_lights(lights)
    assert scene.light_names == ["lamp"]
    assert not [noted for noted in scene.diagnostics if "no light" in noted.text]
    value = patchlight.solve(scene).values([0.5, 0.5, 0], [0, 0, 1])
    assert value == pytest.approx(0.5 * 12 / 4, rel=1e-6)
    lights.write_text("[[point]]\nposition = [0, 0]\n")
    with pytest.raises(patchlight.SceneError, match="lights.toml:2: 'position' must be three numbers"):
        scene.with_lights(lights)
