# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's zip holds its modules and both libraries, and says which one is missing."""
import sys
import zipfile

from blender_addon import package


def run(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["package.py", *map(str, arguments)])
    return package.main()


def test_both_libraries_are_in_the_zip(monkeypatch, tmp_path):
    engine, runtime, target = tmp_path / "libajar.so", tmp_path / "libajar_runtime.so", tmp_path / "addon.zip"
    engine.write_bytes(b"engine")
    assert run(monkeypatch, target, "--library", engine, "--runtime", runtime) == 1
    assert not target.exists()
    runtime.write_bytes(b"runtime")
    assert run(monkeypatch, target, "--library", engine, "--runtime", runtime) == 0
    with zipfile.ZipFile(target) as archive:
        assert archive.read("ajar/lib/libajar.so") == b"engine"
        assert archive.read("ajar/lib/libajar_runtime.so") == b"runtime"
        assert "ajar/bridge/runtime.py" in archive.namelist()
