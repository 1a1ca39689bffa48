# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker with the real engine: bake, layout, cancel, kill, and errors with their culprits."""
import json
import os
import signal
import subprocess
import sys
import time
from array import array

import pytest

from blender_addon.bridge.client import ACCURACY_WORKER, WORKER, WorkerClient
from blender_addon.bridge.snapshot_io import Reader, Writer
from blender_addon.bridge.worker import WISHES

IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0]
CORNERS = [0, 1, 2, 0, 2, 3]
SQUARE = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]
SQUARE_UV = [0, 0, 1, 0, 1, 1, 0, 1]


def write_snapshot(folder, size=16, **settings):
    """A unit square under a constant sky of radiance 1, lightmapped to one page."""
    with Writer(folder) as writer:
        uv = [v for c in CORNERS for v in SQUARE_UV[2 * c : 2 * c + 2]]
        mesh = {
            "name": "Square",
            "vertex_count": 4,
            "triangle_count": 2,
            "positions": writer.add_bytes(array("f", SQUARE), "f32"),
            "corner_vertex": writer.add_bytes(array("I", CORNERS), "u32"),
            "corner_normals": None,
            "triangle_slot": None,
            "uv_layers": [writer.add_bytes(array("f", uv), "f32")],
            "uv_layer_names": ["AjarLightmap"],
            "color_layers": [],
        }
        image = {
            "name": "Grey",
            "width": 2,
            "height": 2,
            "texel": "u8",
            "color": "linear",
            "extend": "repeat",
            "nearest": False,
            "texels": writer.add_bytes(array("B", [128] * 16), "u8"),
        }
        material = {"name": "Matte", "closures": [{"type": "diffuse", "color": {"texture": 0}}]}
        instance = {
            "name": "Square",
            "mesh": 0,
            "transform": IDENTITY,
            "materials": [0],
            "surface": "lightmap",
            "visibility": ["gather", "shadow"],
            "lightmap_layer": 0,
            "page": 0,
        }
        light = {
            "name": "Lamp",
            "type": "point",
            "role": "static",
            "transform": IDENTITY[:11] + [2.0],
            "color": [1, 1, 1],
            "energy": 10.0,
            "radius": 0.1,
            "casts_shadow": True,
        }
        data = {
            "name": "test",
            "settings": {"bounces": 1, "noise_target": 0.0, "samples": 64, **settings},
            "pages": [{"width": size, "height": size}],
            "textures": [image],
            "materials": [material],
            "meshes": [mesh],
            "instances": [instance],
            "lights": [light],
            "sky": {"type": "constant", "color": [1, 1, 1]},
            "warnings": [{"culprit": "X", "text": "from before"}],
        }
        writer.finish(data)
    return folder


def change(folder, edit):
    data = json.loads((folder / "snapshot.json").read_text())
    edit(data)
    (folder / "snapshot.json").write_text(json.dumps(data))


def run(client, seconds=120):
    events, end = [], time.monotonic() + seconds
    while client.running and time.monotonic() < end:
        events += client.poll()
        time.sleep(0.01)
    client.close()
    return events


def bake(tmp_path, library, folder, **options):
    return WorkerClient.bake(
        folder,
        tmp_path / "package",
        tmp_path / "report.json",
        python=sys.executable,
        environment={"AJAR_LIBRARY": str(library)},
        **options,
    )


def test_bake(tmp_path, library):
    events = run(bake(tmp_path, library, write_snapshot(tmp_path / "shot")))
    assert events[-1]["event"] == "done", events[-1]
    assert events[-2]["event"] == "progress" and events[-2]["fraction"] == 1.0
    manifest = json.loads((tmp_path / "package" / "manifest.json").read_text())
    assert (tmp_path / "package" / manifest["pages"][0]["irradiance"]).is_file()
    report = json.loads((tmp_path / "report.json").read_text())
    assert {"culprit": "X", "text": "from before"} in report["warnings"]


@pytest.mark.parametrize(
    "limit, spent, least, most", [(100, 30, 65, 70), (100, 500, 9.9, 10.1), (0, 30, 0, 0)]
)
def test_layout_and_export_count_for_the_time_limit(tmp_path, library, limit, spent, least, most):
    folder = write_snapshot(tmp_path / "shot", time_limit=limit)
    assert run(bake(tmp_path, library, folder, spent=spent))[-1]["event"] == "done"
    report = json.loads((tmp_path / "report.json").read_text())
    assert least <= report["settings"]["time_limit"] <= most


def long_bake(tmp_path, library):
    folder = write_snapshot(tmp_path / "shot", 512, samples=65536, bounces=8, bounce_samples=4096)
    client, events = bake(tmp_path, library, folder), []
    while not any(e["event"] == "progress" for e in events) and client.running:
        events += client.poll()
        time.sleep(0.01)
    return client


def test_cancel(tmp_path, library):
    client = long_bake(tmp_path, library)
    client.cancel()
    begin = time.monotonic()
    assert run(client)[-1]["event"] == "cancelled"
    assert time.monotonic() - begin < 2.0
    assert client._process.returncode == 2 and not (tmp_path / "package").exists()


def test_kill_leaves_the_old_package(tmp_path, library):
    assert run(bake(tmp_path, library, write_snapshot(tmp_path / "shot")))[-1]["event"] == "done"
    before = sorted((p.name, p.stat().st_size) for p in (tmp_path / "package").iterdir())
    client = long_bake(tmp_path, library)
    os.kill(client.pid, signal.SIGKILL)
    assert "signal 9" in run(client)[-1]["message"]
    assert sorted((p.name, p.stat().st_size) for p in (tmp_path / "package").iterdir()) == before


@pytest.mark.parametrize("how", ["stdin", "term"])
def test_other_ways_to_cancel(tmp_path, library, how):
    client = long_bake(tmp_path, library)
    client._process.stdin.close() if how == "stdin" else os.kill(client.pid, signal.SIGTERM)
    assert run(client)[-1]["event"] == "cancelled"


@pytest.mark.parametrize(
    "edit, culprit",
    [
        (lambda d: d["instances"][0].update(mesh=7), "Square"),
        (lambda d: d["meshes"][0]["positions"].update(count=11), "Square"),
        (lambda d: d["materials"][0]["closures"][0].update(type="velvet"), "Matte"),
        (lambda d: d["textures"][0].update(width=3), "Grey"),
        (lambda d: d["settings"].update(typo=1), "settings"),
    ],
)
def test_errors_name_the_culprit(tmp_path, library, edit, culprit):
    folder = write_snapshot(tmp_path / "shot")
    change(folder, edit)
    final = run(bake(tmp_path, library, folder))[-1]
    assert final["event"] == "error" and final["culprit"] == culprit, final
    assert not (tmp_path / "package").exists()


ELEMENTS = [
    {"name": "Lamps", "kind": "light_set", "weight": 2.0, "combine": False},
    {"name": "Gate", "kind": "door", "weight": 0.0, "combine": True, "bounce": False},
    {"name": "Vase", "kind": "toggle", "weight": 1.0},
]


def with_elements(folder, edit=lambda data: None):
    """The square as the closed leaf of a door, its lamp in a light set."""

    def add(data):
        data["elements"] = [dict(element) for element in ELEMENTS]
        data["instances"][0].update(element=1, open_pose=False)
        data["lights"][0]["light_set"] = 0
        data["settings"].update(combinations="NONE", term_threshold=0.5)
        edit(data)

    change(write_snapshot(folder), add)
    return folder


def test_elements(tmp_path, library):
    events = run(bake(tmp_path, library, with_elements(tmp_path / "shot")))
    assert events[-1]["event"] == "done", events[-1]


@pytest.mark.parametrize(
    "edit, culprit, words",
    [
        (lambda d: d["elements"][0].update(weight=-1.0), "Lamps", "weight"),
        (lambda d: d["elements"][1].update(weight=1.5), "Gate", "openness"),
        (lambda d: d["elements"][2].update(kind="window"), "Vase", "window"),
        (lambda d: d["instances"][0].update(element=0), "Square", "light set"),
        (lambda d: d["instances"][0].update(element=2, open_pose=True), "Square", "open pose"),
        (lambda d: d["instances"][0].update(light_set=1), "Square", "light set"),
        (lambda d: d["lights"][0].update(light_set=7), "Lamp", "element"),
        (lambda d: d["settings"].update(combinations="SOME"), "settings", "SOME"),
    ],
)
def test_wrong_elements_name_the_culprit(tmp_path, library, edit, culprit, words):
    final = run(bake(tmp_path, library, with_elements(tmp_path / "shot", edit)))[-1]
    assert final["event"] == "error" and final["culprit"] == culprit and words in final["message"], final


def test_missing_snapshot_and_library(tmp_path, library):
    final = run(bake(tmp_path, library, tmp_path / "none"))[-1]
    assert final["event"] == "error" and "none" in final["message"]
    final = run(bake(tmp_path, tmp_path / "no.so", write_snapshot(tmp_path / "shot")))[-1]
    assert final["event"] == "error" and "not installed" in final["message"]


def test_layout(tmp_path, library):
    with Writer(tmp_path, "layout") as writer:
        mesh = {
            "name": "Square",
            "vertex_count": 4,
            "positions": writer.add_bytes(array("f", SQUARE), "f32"),
            "corner_vertex": writer.add_bytes(array("I", [0, 1, 2, 3]), "u32"),
            "polygon_start": writer.add_bytes(array("I", [0]), "u32"),
            "polygon_size": writer.add_bytes(array("I", [4]), "u32"),
            "corner_edge_sharp": None,
            "corner_uv": None,
            "users": [
                {"name": "A", "transform": IDENTITY},
                {"name": "B", "transform": IDENTITY, "texel_scale": 2.0},
            ],
        }
        writer.finish({"settings": {"texels_per_meter": 16.0, "atlas_size": 256}, "meshes": [mesh]})
    events = run(
        WorkerClient.layout(tmp_path, python=sys.executable, environment={"AJAR_LIBRARY": str(library)})
    )
    assert events[-1]["event"] == "done", events[-1]
    with Reader(tmp_path, "layout_result") as reader:
        (answer,) = reader.data["meshes"]
        uv = reader.values(answer["corner_uv"], "f32", 8)
        assert min(uv) >= 0.0 and max(uv) <= 1.0 and len(answer["users"]) == 2
        first, second = (user["texels_per_meter"] for user in answer["users"])
        assert second == pytest.approx(2 * first, rel=0.1)


def test_worker_uses_only_the_standard_library():
    code = (
        "import sys, runpy; sys.argv = ['worker.py', '-h']\n"
        f"try: runpy.run_path({str(WORKER)!r}, run_name='__main__')\nexcept SystemExit: pass\n"
        "bad = {m.split('.')[0] for m in sys.modules} & {'numpy', 'bpy', 'blender_addon'}\nassert not bad, bad"
    )
    subprocess.run([sys.executable, "-S", "-s", "-E", "-B", "-c", code], check=True, capture_output=True)


def test_predictions_for_several_settings(tmp_path, library):
    folder = write_snapshot(tmp_path / "shot", 64)
    wishes = {
        name: {"samples": 64, "bounces": 2, "noise_target": noise}
        for name, noise in (("A", 0.2), ("B", 0.01))
    }
    (folder / WISHES).write_text(json.dumps(wishes), encoding="utf-8")
    events = run(
        WorkerClient.predict(folder, python=sys.executable, environment={"AJAR_LIBRARY": str(library)})
    )
    assert events[-1]["event"] == "done", events[-1]
    assert list(events[-1]["predicted"]) == ["A", "B"] and events[-1]["texels"] > 1000
    assert all(seconds > 0.0 for seconds in events[-1]["predicted"].values())
    plan = events[-1]["plans"]["B"]
    assert {e["name"]: e["status"] for e in plan["effects"]}["sky"] == "simulated"
    assert (
        plan["predicted_memory_parts"]["pages"] > 64 * 64 * 4 and plan["predicted_memory_parts"]["terms"] == 0
    )
    assert sum(plan["predicted_stages"].values()) == pytest.approx(events[-1]["predicted"]["B"], rel=0.5)
    shares = [e["fraction"] for e in events if e["event"] == "progress"]
    assert shares == sorted(shares) and shares[-1] == 1.0


def test_measuring_without_numpy_says_so(tmp_path, library):
    command = [
        sys.executable,
        "-S",
        "-s",
        "-E",
        "-B",
        str(ACCURACY_WORKER),
        str(tmp_path),
        "--out",
        str(tmp_path),
    ]
    ended = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        env={**os.environ, "AJAR_LIBRARY": str(library)},
    )
    last = json.loads(ended.stdout.splitlines()[-1])
    assert last["event"] == "error" and "numpy" in last["message"] and sys.executable in last["message"]
