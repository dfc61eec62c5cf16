"""What solutions hold: values, pictures, elements, links, files."""

import numpy as np
import pytest
import scipy.sparse
from conftest import BOX_FACES, BOX_VERTICES, lamp_box

import patchlight

UP = [0, 1, 0]


def floor(scene_size, count):
    """A grid of points on the floor of the Cornell box: (count, count, 3)."""
    at = np.linspace(0.05, 0.95, count) * scene_size
    x, z = np.meshgrid(at, at)
    return np.stack([x, np.zeros_like(x), z], axis=-1)


def test_values_have_the_axes_of_their_points(cornell):
    grid = floor(cornell.elements.corners.max(), 5)
    values = cornell.values(grid, UP)
    assert values.radiosity.shape == values.standard_error.shape == (5, 5, 3)
    assert values.radiosity.dtype == np.float32
    assert cornell.values(grid[0, 0], UP).radiosity.shape == (3,)
    assert cornell.values(np.zeros((0, 3)), UP).radiosity.shape == (0, 3)
    assert values.lower is None and values.upper is None
    same = cornell.values(grid.astype(np.float64), np.broadcast_to(UP, grid.shape))
    assert np.array_equal(same, values.radiosity, equal_nan=True)


def test_arrays_are_handed_over_and_not_copied(cornell):
    values = cornell.values([0.1, 0, 0.1], UP)
    assert values.radiosity is values.radiosity
    assert np.asarray(values) is values.radiosity
    assert np.asarray(values, dtype=np.float64).dtype == np.float64
    assert np.array(values) is not values.radiosity
    picture = cornell.render(width=8, height=6)
    assert picture.radiance is np.asarray(picture)
    assert not picture.radiance.flags.owndata


def test_points_on_no_surface_have_no_value(cornell):
    values = cornell.values([[1e3, 0, 0], [0.1, 0, 0.1]], UP)
    assert values.missed == 1
    assert np.isnan(values.radiosity[0]).all() and not np.isnan(values.radiosity[1]).any()
    assert values.faces.shape == (2,) and values.faces[0] == -1 and values.faces[1] >= 0
    assert cornell.values([0.1, 0, 0.1], UP).faces.shape == ()


@pytest.mark.parametrize(
    "points, normals, says",
    [
        ([0, 0], UP, "3 coordinates"),
        ([[0, 0, 0]], [[0, 1, 0]] * 2, "a normal for each"),
        ([0, 0, 0], [0, 2, 0], "length 2"),
        ([0, np.inf, 0], UP, "not finite"),
        (["a", "b", "c"], UP, "numbers"),
        (5, UP, "3 coordinates"),
        ([1j, 0, 0], UP, "numbers"),
    ],
)
def test_bad_points_are_refused(cornell, points, normals, says):
    with pytest.raises(patchlight.ArgumentError, match=says):
        cornell.values(points, normals)


def test_proved_bounds_enclose_the_furnace():
    lit = patchlight.solve(lamp_box(rho=0.5), error=0.05, bounds="guaranteed")
    values = lit.values([[1, 1.5, 0], [0.3, 0.2, 0]], [0, 0, 1])
    assert (values.lower <= values.radiosity).all() and (values.radiosity <= values.upper).all()
    surfaces = lit.surfaces
    assert (surfaces.lower <= surfaces.upper).all() and (surfaces.upper < 1 / (1 - 0.5)).all()


def test_elements_cover_the_surfaces(cornell):
    elements, surfaces, nodes = cornell.elements, cornell.surfaces, cornell.nodes
    assert len(elements) >= len(surfaces) and len(nodes) >= len(elements)
    areas = np.bincount(elements.surface, weights=elements.area)
    np.testing.assert_allclose(areas, surfaces.area, rtol=1e-9)

    # Areas follow from corners, too.
    ends = np.cumsum(elements.corner_counts)
    assert ends[-1] == len(elements.corners)
    first = elements.corners[ends[0] - elements.corner_counts[0] : ends[0]]
    across = sum(np.cross(a - first[0], b - first[0]) for a, b in zip(first[1:], first[2:]))
    assert np.linalg.norm(across) / 2 == pytest.approx(elements.area[0])

    # Nodes are numbered as they say, and what is above a node is larger.
    assert np.array_equal(nodes.node, np.arange(len(nodes)))
    assert (nodes.area[nodes.parent] >= nodes.area * (1 - 1e-9)).all()
    assert np.array_equal(nodes.radiosity[elements.node], elements.radiosity)
    assert ((nodes.surface == -1) == (nodes.corner_counts == 0)).all()
    assert elements.lower is None


def test_links_are_a_sparse_matrix_of_form_factors():
    # In a closed box all that leaves an element arrives: over its own links and those of the nodes above it.
    scene = patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, reflectance=0.5, exitance=1)
    lit = patchlight.solve(scene, error=0.02, solver="links")
    links, nodes, elements = lit.links, lit.nodes, lit.elements
    matrix = scipy.sparse.csr_array((links.data, links.indices, links.indptr), shape=links.shape)
    matrix.check_format()
    assert matrix.nnz == len(links) and matrix.shape == (len(nodes), len(nodes))
    assert links.indices.dtype == links.indptr.dtype
    assert np.array_equal(np.repeat(np.arange(len(nodes)), np.diff(links.indptr)), links.receivers)

    own, parent, found = matrix.sum(axis=1), nodes.parent, np.zeros(len(elements))
    node = elements.node
    while True:
        found += own[node]
        if (parent[node] == node).all():
            break
        # The root gathers from nothing, so it may be met more than once.
        assert own[0] == 0
        node = parent[node]
    assert np.average(found, weights=elements.area) == pytest.approx(1, abs=0.005)


def test_links_are_reciprocal(repository):
    # A_r F_rs = A_s F_sr, where both are linked.
    lit = patchlight.solve(repository / "scenes/cornell.obj", error=0.05, solver="links")
    links, area = lit.links, lit.nodes.area
    pairs = zip(links.receivers.tolist(), links.indices.tolist())
    flow = dict(zip(pairs, area[links.receivers] * links.unoccluded))
    both = [(flow[r, s], flow[s, r]) for r, s in flow if (s, r) in flow]
    assert len(both) >= 100
    np.testing.assert_allclose(*zip(*both), rtol=1e-9)


def test_cameras_are_kept_and_said(cornell):
    camera = cornell.camera(eye=[1, 2, 3], width=64, height=48)
    assert (camera.eye, camera.width, camera.height) == ([1, 2, 3], 64, 48)
    assert eval(repr(camera)) == camera == patchlight.Camera(camera.eye, camera.target, camera.up, camera.field_of_view, width=64, height=48)
    picture = cornell.render(str(camera), width=64, height=48)
    assert np.array_equal(picture, cornell.render(camera))
    assert picture.camera == camera
    for wrong, says in [("eye", "no '='"), (3, "must be a Camera"), ("fov=200", "below 180")]:
        with pytest.raises(patchlight.ArgumentError, match=says):
            cornell.render(wrong)
    for wrong in (dict(width=0), dict(eye=[1, 2]), dict(fov=3)):
        with pytest.raises(patchlight.ArgumentError):
            cornell.camera(**wrong)
    with pytest.raises(patchlight.ArgumentError, match="same point"):
        patchlight.Camera([0, 0, 0], [0, 0, 0], UP)


def test_pictures_show_and_save_themselves(cornell, tmp_path):
    picture = cornell.render(width=40, height=30)
    assert picture.radiance.shape == picture.standard_error.shape == (30, 40, 3)
    assert picture._repr_png_().startswith(b"\x89PNG\r\n\x1a\n")
    picture.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == picture.png()
    picture.save(str(tmp_path / "a.exr"))
    assert (tmp_path / "a.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"

    # What is changed in the array is changed in the picture.
    before = picture.png(exposure=0)
    picture.radiance[:15] = 0
    assert picture.png(exposure=0) != before
    for path, exposure, error in [("a.bmp", None, ValueError), ("missing/a.png", None, OSError), ("b.exr", 1.0, ValueError)]:
        with pytest.raises(error):
            picture.save(tmp_path / path, exposure)
    with pytest.raises(patchlight.ArgumentError):
        picture.png(exposure=np.nan)


def test_a_solution_is_the_same_when_it_is_read_again(cornell, tmp_path):
    file = tmp_path / "cornell.solution"
    cornell.save(file)
    again = patchlight.load(file, threads=1)
    grid = floor(cornell.elements.corners.max(), 4)
    assert np.array_equal(again.values(grid, UP), cornell.values(grid, UP), equal_nan=True)
    assert (again.error, again.converged, again.stopped_by, again.report) == (None,) * 4

    cornell.export(tmp_path / "a.ply")
    assert (tmp_path / "a.ply").read_bytes().startswith(b"ply\n")
    file.write_bytes(file.read_bytes()[:-20])
    with pytest.raises(patchlight.FileError):
        patchlight.load(file)
    with pytest.raises(OSError):
        patchlight.load(tmp_path / "missing")
    with pytest.raises(patchlight.OptionError):
        patchlight.load(file, backend="gpu")


def test_sensors_measure_in_the_air(cornell):
    above = np.array([[0.28, 0.45, 0.28], [0.28, 9.0, 0.28]])
    irradiance, error = cornell.irradiances(above, UP)
    assert irradiance.shape == error.shape == (2, 3) and irradiance.dtype == np.float32
    assert (irradiance[0] > 0).all() and (error[0] > 0).all() and (error[0] < irradiance[0]).all()
    assert (irradiance[1] == 0).all()
    with pytest.raises(patchlight.Cancelled):
        cornell.irradiances(np.tile(above, (100_000, 1)), UP, progress=lambda stage, fraction: True)
