# SPDX-License-Identifier: GPL-3.0-or-later
"""What every Python test may use: the repository's paths and the bpy-free parts of the add-on."""
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
sys.dont_write_bytecode = True


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def library():
    """Path of the engine library; a test that needs it fails, not skips, without one."""
    path = Path(os.environ.get("AJAR_LIBRARY", ROOT / "build" / "release" / "lib" / "libajar.so"))
    assert path.is_file(), f"{path} is missing: run ./dev build"
    return path


@pytest.fixture(scope="session")
def runtime_library():
    """Path of the run-time library; a test that needs it fails, not skips, without one."""
    built = ROOT / "build" / "release" / "lib" / "libajar_runtime.so"
    path = Path(os.environ.get("AJAR_RUNTIME_LIBRARY", built))
    assert path.is_file(), f"{path} is missing: run ./dev build"
    return path
