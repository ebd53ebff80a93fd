"""Builds the wheel: maturin does, or, where SINEW_LIBRARY names a library that cargo has built, nothing is compiled.

Continuous integration has built everything for the tests of the workspace with other features of some dependencies;
maturin would build all of it once more.
"""

import base64
import hashlib
import os
import zipfile
from pathlib import Path

import maturin
from maturin import (  # noqa: F401
    build_editable,
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

PACKAGE = Path(__file__).resolve().parents[1] / "python"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The wheel's file name."""
    library = os.environ.get("SINEW_LIBRARY")
    if not library:
        return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)
    metadata = Path(metadata_directory or wheel_directory)
    found = sorted(metadata.parent.glob(f"{metadata.name}*/METADATA")) or sorted(metadata.glob("*.dist-info/METADATA"))
    if not found:
        name = prepare_metadata_for_build_wheel(str(metadata), config_settings)
        found = [metadata / name / "METADATA"]
    information = found[0].parent
    tag = next(line[5:] for line in (information / "WHEEL").read_text().splitlines() if line.startswith("Tag: "))
    wheel = f"{information.name.removesuffix('.dist-info')}-{tag}.whl"
    files = {f"sinew/{path.name}": path for path in sorted(PACKAGE.glob("sinew/*")) if path.suffix in (".py", ".pyi")}
    files |= {"sinew/py.typed": PACKAGE / "sinew/py.typed", "sinew/_sinew.abi3.so": Path(library)}
    files |= {f"{information.name}/{path.name}": path for path in sorted(information.iterdir()) if path.name != "RECORD"}
    records = []
    with zipfile.ZipFile(Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, path in files.items():
            content = path.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            archive.writestr(name, content)
            records.append(f"{name},sha256={digest},{len(content)}")
        archive.writestr(f"{information.name}/RECORD", "\n".join([*records, f"{information.name}/RECORD,,", ""]))
    return wheel
