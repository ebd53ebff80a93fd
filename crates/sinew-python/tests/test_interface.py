"""Public names: documented, in the stubs, and of the types that a strict checker accepts."""

import ast
import inspect
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import sinew
from sinew import _sinew

STUB = Path(sinew.__file__).with_name("_sinew.pyi")


def public(module):
    return [(name, getattr(module, name)) for name in module.__all__]


@pytest.mark.parametrize("module", [sinew, sinew.samplers, sinew.particles])
def test_every_public_name_says_what_it_is(module):
    for name, value in public(module):
        if not isinstance(value, str):
            assert inspect.getdoc(value), name
        if inspect.isclass(value):
            for member, of in vars(value).items():
                if not member.startswith("_") and (callable(of) or isinstance(of, property)):
                    assert inspect.getdoc(getattr(value, member)), f"{name}.{member}"


def test_the_stub_has_what_the_library_has():
    tree = ast.parse(STUB.read_text())
    stubbed = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    there = {name for name in dir(_sinew) if not name.startswith("_")}
    assert set(stubbed) == there
    for name, node in stubbed.items():
        value = getattr(_sinew, name)
        if isinstance(node, ast.ClassDef):
            members = {of.name for of in node.body if isinstance(of, ast.FunctionDef) and not of.name.startswith("_")}
            assert members == {of for of in vars(value) if not of.startswith("_")}, name
        else:
            assert arguments(node) == list(inspect.signature(value).parameters), name


def arguments(node):
    return [of.arg for of in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]]


def test_methods_have_the_arguments_of_the_stub():
    for node in ast.parse(STUB.read_text()).body:
        if not isinstance(node, ast.ClassDef):
            continue
        value = getattr(_sinew, node.name)
        for method in node.body:
            is_property = any(isinstance(of, ast.Name) and of.id == "property" for of in method.decorator_list)
            if is_property or (method.name.startswith("_") and method.name != "__new__"):
                continue
            if method.name == "__new__":
                assert arguments(method)[1:] == list(inspect.signature(value).parameters), node.name
            else:
                assert arguments(method) == list(inspect.signature(getattr(value, method.name)).parameters)


def test_a_strict_checker_accepts_what_users_write(tmp_path):
    pyright = shutil.which("pyright", path=str(Path(sys.executable).parent)) or shutil.which("pyright")
    if pyright is None:
        pytest.skip("no pyright")
    shutil.copy(Path(__file__).with_name("typed_sample.py"), tmp_path)
    (tmp_path / "pyrightconfig.json").write_text(json.dumps({"typeCheckingMode": "strict"}))
    command = [pyright, "--pythonpath", sys.executable, "-p", str(tmp_path)]
    checked = subprocess.run(command, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout


def test_settings_are_listed_with_their_meaning():
    settings = sinew.settings()
    assert settings["fps"].startswith("frames per second")
    assert {"method", "seed", "frames", "smooth", "threads"} <= settings.keys()
