"""The Python of the pages runs, block after block."""

import re
from pathlib import Path

import numpy as np
import pytest

import sinew

CRATE = Path(__file__).resolve().parents[1]


@pytest.fixture
def names(walk, recording, setup, monkeypatch, tmp_path):
    """What a reader of the guide has: a recording in the folder, arrays of it."""
    pytest.importorskip("matplotlib", reason="no matplotlib")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    (tmp_path / "Calib.toml").write_bytes((recording / "Calib.toml").read_bytes())
    (tmp_path / "pose").symlink_to(recording / "pose", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    for name, value in {"FRAMES": "0..4", "LAYOUT": "BODY_25B", "SETUP": str(setup)}.items():
        monkeypatch.setenv(f"SINEW_{name}", value)
    return {
        "keypoints": walk.keypoints,
        "poses": walk.poses,
        "seen": np.moveaxis(walk.keypoints[:, :, 0], 1, 2),
        "starts": np.zeros((4, 2)),
        "log_likelihoods": np.array([-1.0, -2.0, -3.0]),
    }


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("page", [CRATE / "README.md", CRATE / "../../docs/guide/python.md"], ids=["readme", "guide"])
def test_blocks_run(page, names):
    if not page.is_file():
        pytest.skip("no page beside the package")
    text = page.read_text(encoding="utf-8").replace("HALPE_26", "BODY_25B")
    blocks = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert blocks
    for block in blocks:
        exec(block, names)
    assert isinstance(names["result"], sinew.Result)
