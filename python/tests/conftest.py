"""Scenes that tests share. Those of files lie in `scenes/` of the repository."""

import signal
from pathlib import Path

import numpy as np
import pytest

import patchlight

REPOSITORY = Path(__file__).resolve().parents[2]

# A box of 2 by 3 by 1 m, seen from inside.
BOX_VERTICES = np.array([[x, y, z] for x in (0, 2) for y in (0, 3) for z in (0, 1)], dtype=float)
BOX_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
FLOOR, CEILING = 4, 5


@pytest.fixture(scope="session")
def repository():
    return REPOSITORY


@pytest.fixture(scope="session")
def cornell():
    """The Cornell box, solved."""
    return patchlight.solve(REPOSITORY / "scenes/cornell.obj", error=0.05)


@pytest.fixture(scope="session")
def office():
    """A scene that takes seconds."""
    return patchlight.Scene.read(REPOSITORY / "scenes/full_office.obj")


@pytest.fixture
def interruptible():
    """Ctrl-C interrupts, also where the tests run in the background of a shell, which ignores it there."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def lamp_box(rho=0.5, exitance=1.0, **more):
    """The box, with a ceiling that emits."""
    emits = np.zeros((2, 1))
    emits[1] = exitance
    materials = np.zeros(6, dtype=int)
    materials[CEILING] = 1
    return patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, materials=materials, reflectance=rho, exitance=emits, **more)
