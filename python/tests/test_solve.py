"""Solves: options, limits, progress, threads, and how they end early."""

import os
import signal
import threading
import time

import numpy as np
import pytest
from conftest import BOX_FACES, BOX_VERTICES, lamp_box

import patchlight


def test_a_furnace_is_as_bright_as_it_must_be():
    rho, exitance = np.array([0.3, 0.5, 0.8]), np.array([1.0, 2.0, 0.5])
    scene = patchlight.Scene.from_arrays(BOX_VERTICES, BOX_FACES, reflectance=rho, exitance=exitance)
    lit = patchlight.solve(scene, error=0.01)
    radiosity = lit.values([[1, 1, 0], [0.2, 2.9, 0]], [0, 0, 1]).radiosity
    np.testing.assert_allclose(radiosity, np.broadcast_to(exitance / (1 - rho), (2, 3)), rtol=0.01)


def test_a_solve_says_how_it_went(cornell, repository):
    assert cornell.converged and cornell.stopped_by == "error"
    assert 0 < cornell.error <= 0.05
    assert (cornell.channels, cornell.solver in ("links", "cells")) == (3, True)
    report = cornell.report
    assert report["error"]["estimate"] == cornell.error
    assert report["scene"]["file"] == str(repository / "scenes/cornell.obj")
    assert report["options"]["error"] == 0.05


def test_the_number_of_threads_changes_nothing(repository):
    one, two = (patchlight.solve(repository / "scenes/cornell.obj", error=0.1, threads=threads) for threads in (1, 2))
    assert np.array_equal(one.elements.radiosity, two.elements.radiosity)
    assert np.array_equal(one.render(width=32, height=24), two.render(width=32, height=24))


def test_options_go_by_name_and_type():
    scene = lamp_box()
    lit = patchlight.solve(scene, np.float32(0.1), seed=np.int64(3), solver="links", norm=None, bounds="estimate")
    options = lit.report["options"]
    assert (options["seed"], options["norm"]) == (3, "local")
    for wrong, says in [
        (dict(error=2), "below 1"),
        (dict(sede=1), "unknown option 'sede'"),
        (dict(seed=1.5), "whole number"),
        (dict(seed=-1), "whole number"),
        (dict(seed=True), "whole number"),
        (dict(seed=[1]), "whole number"),
        (dict(solver=3), "links"),
        (dict(time=0), "above 0"),
        (dict(memory="much"), "above 0"),
        (dict(memory=1e-9), "at least"),
        (dict(backend="gpu"), "gpu"),
        (dict(threads=0), "from 1"),
        (dict(sides="both"), "Scene.read"),
        (dict(importance="view"), "error-driven"),
    ]:
        with pytest.raises(patchlight.OptionError, match=says):
            patchlight.solve(scene, **wrong)


def test_options_are_listed():
    options = {option.key: option for option in patchlight.options()}
    assert (options["error"].kind, options["error"].default) == ("real", "0.02")
    assert options["time"].unit == "seconds"
    assert all(option.help and option.range for option in options.values())


def test_a_limit_warns_and_leaves_a_solution(office):
    with pytest.warns(patchlight.LimitWarning, match="the time limit ended the solve"):
        lit = patchlight.solve(office, error=1e-4, time=0.2)
    assert (lit.converged, lit.stopped_by) == (False, "time")
    assert lit.values([0, 0, 0], [0, 1, 0]).radiosity.shape == (3,)


def test_progress_is_told_on_the_thread_that_asks(office):
    told = []

    def progress(stage, fraction):
        told.append((stage, fraction, threading.get_ident()))
        return len(told) == 5

    lit = patchlight.solve(office, error=1e-4, progress=progress)
    assert (lit.converged, lit.stopped_by, len(told)) == (False, "cancelled", 5)
    assert {thread for _, _, thread in told} == {threading.get_ident()}
    assert all(isinstance(stage, str) and (fraction is None or 0 <= fraction <= 1) for stage, fraction, _ in told)


def test_what_progress_raises_ends_the_solve(office):
    def progress(stage, fraction):
        raise LookupError(stage)

    with pytest.raises(LookupError):
        patchlight.solve(office, error=1e-4, progress=progress)
    with pytest.raises(patchlight.ArgumentError, match="progress"):
        patchlight.solve(office, progress=3)


def test_a_function_may_refuse_memory(repository):
    scene, asked = patchlight.Scene.read(repository / "scenes/cornell.obj"), []

    def wants(most):
        def refuse(size):
            asked.append((size, threading.get_ident()))
            return size > most

        return refuse

    full = patchlight.solve(scene, error=0.02, solver="links", memory=wants(float("inf")))
    most = max(size for size, _ in asked)
    assert full.converged and most > full.memory_bytes
    assert all(isinstance(size, int) and thread == threading.get_ident() for size, thread in asked)
    with pytest.warns(patchlight.LimitWarning, match="memory"):
        less = patchlight.solve(scene, error=0.02, solver="links", memory=wants(most - 1))
    assert less.stopped_by == "memory" and not less.converged
    assert len(less.links) <= len(full.links)
    # None, and what is not True, refuses nothing.
    assert patchlight.solve(scene, error=0.5, memory=lambda size: None).converged


def test_what_the_memory_function_raises_ends_the_solve(cornell, repository):
    scene = repository / "scenes/cornell.obj"

    def fail(size):
        raise LookupError(size)

    with pytest.raises(LookupError):
        patchlight.solve(scene, error=0.02, solver="links", memory=fail)
    # Threads wait for the answer, so it cannot ask them for more; afterwards they are free.
    with pytest.raises(patchlight.ArgumentError, match="must not solve"):
        patchlight.solve(scene, error=0.02, solver="links", memory=lambda size: cornell.values([0.1, 0, 0.1], [0, 1, 0]))
    assert cornell.values([0.1, 0, 0.1], [0, 1, 0]).missed == 0


def test_values_and_pictures_that_are_cancelled_raise(cornell):
    camera = cornell.camera(width=2000, height=2000)
    with pytest.raises(patchlight.Cancelled):
        cornell.render(camera, progress=lambda stage, fraction: True)


def test_the_bar_is_for_people_alone(cornell, monkeypatch, capsys):
    cornell.render(width=200, height=150, progress=True)
    assert capsys.readouterr().err == ""

    import patchlight._progress as progress

    class Terminal:
        def __init__(self):
            self.text = ""

        def write(self, text):
            self.text += text

        def flush(self):
            pass

    terminal = Terminal()
    bar = progress.Bar(terminal)
    bar("refine", 0.5)
    bar("gather", None)
    bar.close()
    assert "refine" in terminal.text and "50%" in terminal.text
    assert terminal.text.split("\r")[-2].strip() == ""


@pytest.mark.parametrize("what", ["solve", "values", "render"])
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_ends_what_would_take_minutes(office, cornell, what):
    # The signal comes when the work is under way.
    begun = threading.Event()

    def interrupt():
        begun.wait()
        time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGINT)

    def progress(stage, fraction):
        begun.set()

    camera = cornell.camera(width=8000, height=8000)
    points = np.random.default_rng(1).uniform(0, 1, (2_000_000, 3)) * [1, 0, 1]
    killer = threading.Thread(target=interrupt)
    killer.start()
    with pytest.raises(KeyboardInterrupt):
        if what == "solve":
            patchlight.solve(office, error=1e-4, progress=progress)
        elif what == "values":
            cornell.values(points, [0, 1, 0], progress=progress)
        else:
            cornell.render(camera, progress=progress)
    killer.join()


def test_other_threads_go_on_meanwhile(office):
    # If the solve held Python's lock, no thread would tick in that second.
    ticks, done = 0, threading.Event()

    def tick():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.01)

    ticker = threading.Thread(target=tick)
    with pytest.warns(patchlight.LimitWarning):
        ticker.start()
        patchlight.solve(office, error=1e-4, time=1)
    done.set()
    ticker.join()
    assert ticks > 5


def test_many_threads_use_one_solution(cornell):
    points, up = np.tile([0.3, 0.0, 0.3], (300, 1)) * np.random.default_rng(1).uniform(0.5, 1.5, (300, 3)), [0, 1, 0]
    alone = cornell.values(points, up).radiosity
    found = [None] * 4
    threads = [
        threading.Thread(target=lambda k=k: found.__setitem__(k, cornell.values(points, up).radiosity)) for k in range(len(found))
    ]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(one, alone, equal_nan=True) for one in found)


def test_a_forked_process_is_told_and_may_solve_itself(cornell):
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        # Whatever happens here, pytest must not go on in two processes.
        answer = b"nothing"
        try:
            signal.alarm(60)
            try:
                cornell.values([0, 0, 0], [0, 1, 0])
            except patchlight.ResourceError:
                lit = patchlight.solve(lamp_box(), error=0.1, backend="obvhs")
                answer = b"solved" if lit.converged else b"not solved"
        finally:
            os.write(write, answer)
            os._exit(0)
    os.close(write)
    answer = os.read(read, 100)
    os.waitpid(child, 0)
    assert answer == b"solved"
