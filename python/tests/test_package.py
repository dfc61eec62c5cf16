"""The package: its stubs, what its wheel carries, and that its notebooks, examples and documentation run."""

import ast
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

import patchlight
from patchlight import _native

INSTALLED = Path(patchlight.__file__).parent


def stub():
    return ast.parse((INSTALLED / "_native.pyi").read_text())


def names(body):
    """The public names that a stub defines, with the parameters of functions."""
    found = {}
    for node in body:
        if isinstance(node, ast.FunctionDef) and (not node.name.startswith("_") or node.name in ("__new__", "__array__")):
            is_property = any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list)
            found[node.name] = None if is_property else [one.arg for one in node.args.args + node.args.kwonlyargs]
    return found


def test_stubs_say_what_there_is():
    classes = {node.name: node for node in stub().body if isinstance(node, ast.ClassDef)}
    functions = names(stub().body)
    there = {name: thing for name, thing in vars(_native).items() if not name.startswith("__")}
    assert set(classes) == {name for name, thing in there.items() if inspect.isclass(thing)}
    assert set(functions) == {name for name, thing in there.items() if not inspect.isclass(thing)}
    for name, node in classes.items():
        of_class = {one for one in names(node.body) if not one.startswith("__")}
        assert of_class == {one for one in vars(there[name]) if not one.startswith("_")}, name


def test_everything_public_is_explained():
    for name in patchlight.__all__:
        thing = getattr(patchlight, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and thing.__module__ == "patchlight":
            for member, value in vars(thing).items():
                assert member.startswith("_") or inspect.getdoc(value), f"{name}.{member}"


def test_signatures_are_those_of_the_stubs():
    def parameters(thing):
        kinds = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
        return [one.name for one in inspect.signature(thing).parameters.values() if one.kind not in kinds]

    for node in stub().body:
        if isinstance(node, ast.ClassDef):
            for name, told in names(node.body).items():
                if told is not None and not name.startswith("__"):
                    there = parameters(getattr(getattr(_native, node.name), name))
                    assert told[: len(there)] == there or set(there) <= set(told), (node.name, name)
    assert set(parameters(patchlight.solve)) <= set(names(stub().body)["solve"])


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks /proc which libraries are loaded")
def test_embree_is_the_one_that_the_wheel_carries(cornell):
    if "embree" not in cornell.backend:
        pytest.skip(f"built without Embree: rays are answered by {cornell.backend}")
    loaded = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if re.search(r"/lib(embree|tbb)", line)}
    assert loaded
    assert {Path(path).parent for path in loaded} == {INSTALLED.parent / "patchlight.libs"}


def run(*arguments, **kwargs):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=300, **kwargs)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_examples_run(tmp_path):
    folder = REPOSITORY / "examples/python"
    told = run(sys.executable, "-W", "error", folder / "room.py", REPOSITORY / "scenes/room.obj", tmp_path / "room.png")
    assert "is claimed" in told and (tmp_path / "room.png").stat().st_size > 10_000
    assert "exactly" in run(sys.executable, "-W", "error", folder / "arrays.py")
    assert {file.name for file in folder.glob("*.py")} == {"room.py", "arrays.py"}


def test_the_documentation_runs(tmp_path):
    # From the top of the repository, where its paths lead; what is written goes elsewhere.
    for page in (REPOSITORY / "docs/python.md", REPOSITORY / "README.md", REPOSITORY / "python/README.md"):
        blocks = re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.DOTALL)
        assert blocks, page
        (tmp_path / "scenes").mkdir(exist_ok=True)
        for file in ("room.obj", "room.mtl"):
            for place in (tmp_path, tmp_path / "scenes"):
                place.joinpath(file).write_bytes((REPOSITORY / "scenes" / file).read_bytes())
        run(sys.executable, "-c", "\n".join(blocks), cwd=tmp_path)


@pytest.mark.parametrize("notebook", sorted((REPOSITORY / "python/notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_notebooks_run(notebook, monkeypatch):
    # The text alone: what a notebook shows is made where it runs.
    text = notebook.read_text()
    assert '"outputs": []' in text and "image/png" not in text
    code = """
import sys, nbclient, nbformat
notebook = nbformat.read(sys.argv[1], as_version=4)
nbclient.NotebookClient(notebook, kernel_name="python3", timeout=240).execute()
shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
assert any("image/png" in output.get("data", {}) for output in shown)
"""
    run(sys.executable, "-c", code, notebook, env={**os.environ, "PYDEVD_DISABLE_FILE_VALIDATION": "1"})
