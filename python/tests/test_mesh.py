"""The lit mesh: its arrays, against physics and against values; pictures and files of it; how it ends early."""

import os
import signal
import threading
import time

import numpy as np
import pytest
from conftest import BOX_FACES, BOX_VERTICES, lamp_box

import patchlight

UP = [0, 1, 0]


@pytest.fixture(scope="module")
def lit():
    """A box under its ceiling, of one channel."""
    return patchlight.solve(lamp_box(rho=0.5), error=0.05)


@pytest.fixture(scope="module")
def mesh(lit):
    return lit.mesh(error=0.05)


def areas(mesh):
    a, b, c = (mesh.nodes[mesh.elements[:, corner]] for corner in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_arrays_fit_each_other(lit, mesh):
    nodes, elements = mesh.nodes, mesh.elements
    assert nodes.shape == (nodes.shape[0], 3) and nodes.dtype == np.float64
    assert elements.shape == (len(mesh), 6) and elements.dtype == np.int64
    assert mesh.surface.shape == (len(mesh),) and mesh.surface.dtype == np.int64
    assert mesh.radiosity.shape == (len(nodes), 1) and mesh.radiosity.dtype == np.float32
    assert mesh.standard_error.shape == (len(mesh),) and (mesh.standard_error >= 0).all()
    assert np.array_equal(np.unique(elements), np.arange(len(nodes)))
    assert 0 < mesh.measured <= mesh.claimed <= 0.05

    # Middles lie between their corners, and corners are counter-clockwise from inside.
    for middle, (one, other) in zip((3, 4, 5), ((0, 1), (1, 2), (2, 0))):
        between = (nodes[elements[:, one]] + nodes[elements[:, other]]) / 2
        np.testing.assert_allclose(nodes[elements[:, middle]], between, atol=1e-9)
    a, b, c = (nodes[elements[:, corner]] for corner in range(3))
    inwards = BOX_VERTICES.mean(axis=0) - a
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), inwards) > 0).all()
    np.testing.assert_allclose(np.bincount(mesh.surface, weights=areas(mesh)), lit.surfaces.area, rtol=1e-6)


def test_what_is_emitted_is_absorbed(lit, mesh):
    # Of B, all but what is emitted is the part rho of what arrives; the mean over a quadratic element is that of the middles of its edges.
    emitted = np.array([1.0 if material else 0.0 for material in lit.surfaces.material])[mesh.surface]
    mean = mesh.radiosity[mesh.elements[:, 3:], 0].mean(axis=1)
    absorbed = (areas(mesh) * (1 - 0.5) * (mean - emitted) / 0.5).sum()
    assert absorbed == pytest.approx((areas(mesh) * emitted).sum(), rel=lit.error + mesh.claimed)


def test_in_a_furnace_all_is_equally_bright():
    rho, exitance = np.array([0.3, 0.5, 0.8]), np.array([1.0, 2.0, 0.5])
    lit = patchlight.solve(patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, reflectance=rho, exitance=exitance), error=0.02)
    radiosity = lit.mesh().radiosity
    np.testing.assert_allclose(radiosity, np.broadcast_to(exitance / (1 - rho), radiosity.shape), rtol=0.05)


def test_values_are_the_quadratic_function_of_the_nodes(mesh):
    # In the middle of an element corners count -1/9, and middles of edges 4/9.
    on_the_floor = mesh.elements[np.abs(mesh.nodes[mesh.elements][:, :, 2]).max(axis=1) < 1e-9]
    middles = mesh.nodes[on_the_floor[:, :3]].mean(axis=1)
    expected = mesh.radiosity[on_the_floor, 0] @ np.array([-1, -1, -1, 4, 4, 4]) / 9
    values = mesh.values(middles.reshape(-1, 1, 3), [0, 0, 1])
    assert values.shape == (len(middles), 1, 1) and values.dtype == np.float32
    np.testing.assert_allclose(values[:, 0, 0], expected, rtol=1e-4)
    assert np.isnan(mesh.values([1e3, 0, 0], UP)).all()
    with pytest.raises(patchlight.ArgumentError, match="3 coordinates"):
        mesh.values([0, 0], UP)


def test_values_are_near_those_of_the_solution(lit, mesh):
    points = np.random.default_rng(3).uniform([0, 0, 0], [2, 3, 0], (500, 3))
    gathered, read = lit.values(points, [0, 0, 1]).radiosity, mesh.values(points, [0, 0, 1])
    off = np.sqrt(np.mean(((read - gathered) / np.maximum(gathered, np.median(gathered))) ** 2))
    assert off <= mesh.claimed + 0.05


def test_pictures_are_read_off(lit, mesh):
    camera = lit.camera(width=40, height=30)
    picture = mesh.render(camera)
    assert picture.radiance.shape == picture.standard_error.shape == (30, 40, 1)
    gathered = lit.render(camera).radiance
    # At edges either takes rays of its own.
    off = np.median(np.abs(picture.radiance - gathered)) / np.median(picture.standard_error)
    assert 0.1 < off < 1.5
    assert picture.radiance.mean() == pytest.approx(gathered.mean(), rel=mesh.claimed + lit.error)
    assert mesh.render("fov=60", width=8, height=6).radiance.shape == (6, 8, 1)
    assert mesh.render(width=8, height=6)._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(patchlight.ArgumentError, match="camera"):
        mesh.render(3)


def test_files_hold_four_triangles_an_element(mesh, tmp_path):
    mesh.write_ply(tmp_path / "box.ply")
    header = (tmp_path / "box.ply").read_bytes().split(b"end_header\n")[0].decode()
    assert f"element face {4 * len(mesh)}\n" in header
    with pytest.raises(patchlight.ArgumentError, match="ply"):
        mesh.write_ply(tmp_path / "box.obj")
    with pytest.raises(patchlight.FileError):
        mesh.write_ply(tmp_path / "no" / "box.ply")


def test_meshio_takes_it(mesh, tmp_path):
    meshio = pytest.importorskip("meshio")
    made = meshio.Mesh(mesh.nodes, [("triangle6", mesh.elements)], point_data={"radiosity": mesh.radiosity})
    made.write(tmp_path / "box.vtu")
    again = meshio.read(tmp_path / "box.vtu")
    assert np.array_equal(again.cells_dict["triangle6"], mesh.elements)


def test_a_solution_may_have_one_of_its_own(tmp_path):
    lit = patchlight.solve(lamp_box(), error=0.1, lit_mesh=True)
    mesh, whole = lit.mesh(), lit.report["lit_mesh"]["whole"]["estimate"]
    assert lit.converged and whole <= 0.1
    assert whole == pytest.approx(np.hypot(lit.error, mesh.claimed))
    lit.save(tmp_path / "box.solution")
    again = patchlight.load(tmp_path / "box.solution").mesh()
    assert (again.measured, again.claimed) == (mesh.measured, mesh.claimed)
    assert np.array_equal(again.nodes, mesh.nodes) and np.array_equal(again.elements, mesh.elements)
    assert np.array_equal(again.radiosity, mesh.radiosity) and np.array_equal(again.surface, mesh.surface)
    assert len(lit.mesh(error=0.9)) <= len(mesh)


def test_the_number_of_threads_changes_nothing():
    one, two = (patchlight.solve(lamp_box(), error=0.1, threads=threads).mesh() for threads in (1, 2))
    assert np.array_equal(one.nodes, two.nodes) and np.array_equal(one.radiosity, two.radiosity)


def test_what_cannot_be_is_said(lit):
    for wrong in (0, -1, 1, float("nan"), float("inf")):
        with pytest.raises(patchlight.OptionError, match="error"):
            lit.mesh(error=wrong)
    with pytest.raises(patchlight.ArgumentError, match="progress"):
        lit.mesh(error=0.5, progress=3)


def test_an_error_that_cannot_be_claimed_is_warned_of():
    # A small square under a far lamp: few elements are all that may be, and what is asked for is below what numbers can tell.
    square, lamp = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[-5, -5, 20], [-5, 5, 20], [5, 5, 20], [5, -5, 20]])
    vertices, faces = np.concatenate([0.1 * square, lamp]), [[0, 1, 2, 3], [4, 5, 6, 7]]
    scene = patchlight.Scene.from_arrays(vertices, faces, materials=[0, 1], reflectance=[[0.5], [0.0]], exitance=[[0.0], [10.0]])
    lit = patchlight.solve(scene, error=0.1)
    with pytest.warns(patchlight.LimitWarning, match="nothing more can be gained"):
        assert lit.mesh(error=1e-300).claimed > 1e-300


def test_the_progress_function_ends_it(office):
    lit = patchlight.solve(office, error=0.5)
    with pytest.raises(patchlight.Cancelled):
        lit.mesh(error=0.01, progress=lambda stage, fraction: True)


@pytest.mark.parametrize("what", ["mesh", "values"])
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_ends_what_would_take_minutes(office, lit, mesh, what):
    coarse = patchlight.solve(office, error=0.5) if what == "mesh" else None
    points = np.random.default_rng(1).uniform([0, 0, 0], [2, 3, 0], (20_000_000, 3)) if what == "values" else None
    killer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    killer.start()
    with pytest.raises(KeyboardInterrupt):
        coarse.mesh(error=0.005) if what == "mesh" else mesh.values(points, [0, 0, 1])
        # What is done before the signal comes is not ended by it.
        time.sleep(10)
    killer.join()
