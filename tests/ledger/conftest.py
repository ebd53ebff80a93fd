"""What the tests share: the program and a simulated walk."""

import os
import subprocess
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def program():
    """The program `sinew`."""
    named = os.environ.get("SINEW_PROGRAM")
    if named is None or not Path(named).is_file():
        pytest.skip("no program: SINEW_PROGRAM names it")
    return named


@pytest.fixture(scope="session")
def call(program):
    """Runs the program in a folder; what it said."""

    def run(folder, *words):
        ended = subprocess.run([program, *map(str, words)], capture_output=True, text=True, cwd=folder)
        # 4: a diagnostic failed, which is no matter here.
        assert ended.returncode in (0, 4), ended.stderr
        return ended.stdout

    return run


@pytest.fixture(scope="session")
def walk(call, tmp_path_factory):
    """The folder of a simulated recording of two seconds at 30 frames a second, in which somebody stands in the first and walks in the second."""
    folder = tmp_path_factory.mktemp("walk")
    call(folder, "simulate", "--duration", 2, "--seed", 3, "-o", "walk")
    return folder / "walk"
