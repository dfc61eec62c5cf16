"""One solve, lit and painted otherwise afterwards: light groups and other materials."""

import numpy as np
import pytest
from conftest import BOX_FACES, BOX_VERTICES, lamp_box

import patchlight

POINTS, UP = np.array([[1.0, 1.5, 0.0], [0.2, 2.9, 0.0]]), [0, 0, 1]


@pytest.fixture(scope="module")
def grouped():
    """A box of two lights, a group each."""
    materials = np.array([0, 0, 0, 0, 1, 2])
    exitance = np.array([[0.0], [1.0], [5.0]])
    scene = patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, materials=materials, reflectance=0.5, exitance=exitance)
    scene = scene.with_light_groups({"floor": ["material material 1"], "ceiling": ["material material 2"]})
    assert scene.light_groups == ["floor", "ceiling"]
    return patchlight.solve(scene, error=0.05)


def test_groups_are_a_sum(grouped):
    assert grouped.light_groups == {"floor": [1.0], "ceiling": [1.0]}
    alone = [grouped.relight({"floor": weight, "ceiling": 1 - weight}) for weight in (1, 0)]
    both = grouped.relight({"floor": 0.25, "ceiling": [3.0]})
    assert both.light_groups == {"floor": [0.25], "ceiling": [3.0]}
    parts = [lit.surfaces.radiosity for lit in alone]
    np.testing.assert_allclose(both.surfaces.radiosity, 0.25 * parts[0] + 3 * parts[1], rtol=1e-6)
    assert 0 < both.error < 1 and both.report is None and both.converged is None


def test_what_groups_refuse(grouped):
    for weights in ({"door": 1.0}, {"floor": -1.0}, {"floor": [1.0, 2.0]}):
        with pytest.raises(patchlight.ArgumentError):
            grouped.relight(weights)
    with pytest.raises(patchlight.ArgumentError):
        lamp_box().with_light_groups("colour")
    with pytest.raises(patchlight.ArgumentError):
        lamp_box().with_light_groups({"lamp": ["material 1"]})
    lit = patchlight.solve(lamp_box(), error=0.2)
    assert lit.light_groups == {}
    with pytest.raises(patchlight.ArgumentError):
        lit.relight({})


def test_paint_makes_a_furnace(tmp_path):
    lit = patchlight.solve(lamp_box(rho=0.6), error=0.05, keep_transport=True)
    names = lamp_box().material_names
    furnace = lit.with_materials(dict.fromkeys(names, 0.5), dict.fromkeys(names, 1.0))
    # The ceiling is sampled, and walls by paths: that has noise, and the claim is its mean square.
    assert 0 < furnace.error < 0.05
    np.testing.assert_allclose(furnace.values(POINTS, UP).radiosity, 2.0, rtol=3 * furnace.error)

    # It is a solution like any other, from which others follow.
    furnace.save(tmp_path / "furnace.solution")
    again = patchlight.load(tmp_path / "furnace.solution").with_materials({names[0]: [0.5]})
    np.testing.assert_allclose(again.values(POINTS, UP).radiosity, 2.0, rtol=3 * furnace.error)

    with pytest.warns(patchlight.LimitWarning):
        lit.with_materials({names[0]: 0.3}, error=1e-9)
    with pytest.raises(patchlight.ArgumentError):
        lit.with_materials({"gold": 0.5})
    with pytest.raises(patchlight.ArgumentError):
        lit.with_materials({names[0]: 1.5})
    with pytest.raises(patchlight.ArgumentError):
        patchlight.solve(lamp_box(), error=0.2).with_materials({names[0]: 0.5})
