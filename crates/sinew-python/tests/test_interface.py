"""Public names: documented, in the stubs, and of the types that a strict checker accepts."""

import ast
import inspect
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import sinew
from sinew import _sinew
from sinew._words import in_python

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
    """And refuses what the sample marks: a setting that is none, a method that is none."""
    pytest.importorskip("mypy")
    shutil.copy(Path(__file__).with_name("typed_sample.py"), tmp_path)
    command = [sys.executable, "-m", "mypy", "--strict", str(tmp_path / "typed_sample.py")]
    checked = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout + checked.stderr


ANNOTATIONS = {
    "path": "str | Path",
    "count": "int",
    "number": "float",
    "flag": "bool",
    "frames": "Frames",
    "text": "str",
    "names": "Sequence[str]",
    "direction": "Literal['auto'] | tuple[float, float, float]",
    "lags": "Mapping[str, float | str]",
}


def test_settings_are_typed_as_the_table_has_them():
    own = inspect.signature(sinew.track).parameters
    due = {}
    for key, _, kind, choices in _sinew.settings_table():
        if key not in own:
            due[key] = f"Literal[{', '.join(map(repr, choices))}]" if kind == "choice" else ANNOTATIONS[kind]
    (settings,) = [
        node
        for node in ast.parse(STUB.with_name("_settings.py").read_text()).body
        if isinstance(node, ast.ClassDef) and node.name == "Settings"
    ]
    typed = {of.target.id: ast.unparse(of.annotation) for of in settings.body if isinstance(of, ast.AnnAssign)}
    assert typed == due


def test_settings_are_listed_with_their_meaning():
    settings = sinew.settings()
    assert settings["fps"].startswith("frames per second")
    assert {"method", "seed", "frames", "smooth", "threads"} <= settings.keys()


@pytest.mark.parametrize(
    ("text", "ours"),
    [
        ("C2 is 3.0 frames late; `--lag C2=3,C3=-1.5` reads", 'C2 is 3.0 frames late; `lag={"C2": 3, "C3": -1.5}` reads'),
        ("raise `--outlier 0.05`", "raise `outlier=0.05`"),
        ("`--any-size` accepts", "`any_size=True` accepts"),
        ("`--frames A..B` takes", "`frames=(A, B)` takes"),
        ("is `--fps` right?", "is `fps` right?"),
        ("`--up auto` or `--up X,Y,Z`", '`up="auto"` or `up=(X, Y, Z)`'),
        ("`--prior` changes nothing with `--method gpapf`", '`prior` changes nothing with `method="gpapf"`'),
        ("give it with `--person 2 --setup`", "give it with `person=2, setup`"),
        ("give `--keypoints DIR --init keypoints`", 'give `keypoints=DIR, init="keypoints"`'),
        ("choose another folder with `-o`, or `--resume`", "choose another folder with `out`, or `resume=True`"),
        ("try\n  sinew track --calibration A.toml --fps 60", 'try\n  sinew.track(calibration="A.toml", fps=60)'),
        ("`sinew sync --trim` finds by how much", "`sinew sync --trim` finds by how much"),
        ("`--no-such-flag` stays", "`--no-such-flag` stays"),
    ],
)
def test_flags_are_said_as_keyword_arguments(text, ours):
    assert in_python(text) == ours
