# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshot directories: what is written is read back, and damage is refused."""
import json
from array import array

import pytest

from blender_addon.bridge.snapshot_io import ALIGNMENT, Reader, SnapshotError, Writer, write_text_whole


def write(
    folder, arrays=((array("f", [1.5, -2.0]), "f32"), (array("B", [7]), "u8"), (array("d", [3.25]), "f64"))
):
    with Writer(folder) as writer:
        references = [writer.add_bytes(values, kind) for values, kind in arrays]
        writer.finish({"arrays": references})
    return references


def test_round_trip(tmp_path):
    references = write(tmp_path)
    assert all(r["offset"] % ALIGNMENT == 0 for r in references)
    with Reader(tmp_path) as reader:
        assert list(reader.values(references[0], "f32")) == [1.5, -2.0]
        assert reader.pointer(references[2], "f64", 1)[0] == 3.25
        assert reader.pointer(None, "f32") is None
        assert reader.data["version"] == 1


def test_empty_arrays(tmp_path):
    (reference,) = write(tmp_path, ((b"", "u32"),))
    assert reference["count"] == 0
    with Reader(tmp_path) as reader:
        assert not reader.values(reference, "u32")


@pytest.mark.parametrize(
    "change",
    [
        {"count": 3000},
        {"offset": 1 << 40},
        {"offset": -64},
        {"offset": 2},
        {"type": "u32"},
        {"type": "x"},
        {"count": -1},
    ],
)
def test_bad_reference(tmp_path, change):
    reference = {**write(tmp_path)[0], **change}
    with Reader(tmp_path) as reader, pytest.raises(SnapshotError):
        reader.pointer(reference, "f32")


def test_wrong_count(tmp_path):
    reference = write(tmp_path)[0]
    with Reader(tmp_path) as reader, pytest.raises(SnapshotError, match="2 scalars, not 3"):
        reader.pointer(reference, "f32", 3)


def test_other_version_and_missing_files(tmp_path):
    with pytest.raises(SnapshotError, match="cannot read"):
        Reader(tmp_path)
    write(tmp_path)
    (tmp_path / "snapshot.json").write_text(json.dumps({"version": 99}))
    with pytest.raises(SnapshotError, match="version 99"):
        Reader(tmp_path)
    (tmp_path / "snapshot.json").write_text("{")
    with pytest.raises(SnapshotError):
        Reader(tmp_path)


def test_failed_write_leaves_no_json(tmp_path):
    write(tmp_path)
    with pytest.raises(RuntimeError):
        with Writer(tmp_path) as writer:
            writer.add_bytes(b"1234", "u8")
            raise RuntimeError
    assert not list(tmp_path.iterdir())


def test_whole_text(tmp_path):
    path = tmp_path / "report.json"
    write_text_whole(path, "old")
    write_text_whole(path, "new")
    assert path.read_text() == "new" and list(tmp_path.iterdir()) == [path]


def test_numpy_writer(tmp_path):
    np = pytest.importorskip("numpy")
    from blender_addon.bridge.snapshot_write import ArrayWriter

    with ArrayWriter(tmp_path) as writer:
        reference = writer.add(np.arange(6, dtype=np.int64).reshape(2, 3).T, "u32")
        assert writer.add(None, "f32") is None
        empty = writer.add(np.zeros((0, 3)), "f32")
        writer.finish({})
    with Reader(tmp_path) as reader:
        assert list(reader.values(reference, "u32")) == [0, 3, 1, 4, 2, 5]
        assert empty["count"] == 0
