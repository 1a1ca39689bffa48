# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes, bakes and references in this process, as arrays."""
import ctypes as c
import json
import os
import time

import numpy as np

from .. import model
from ..bridge import abi
from ..bridge.library import check
from ..bridge.snapshot_io import Reader
from . import engine

LAYER_STDERR, LAYER_AHD, LAYER_SH = 1, 6, 4
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def threads():
    """Processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Stopwatch:
    """Seconds of this process's processor time per processor: wall-clock time on a machine that is not
    busy with anything else."""

    def __init__(self):
        self._wall, self._processor = time.perf_counter(), time.process_time()

    def wall(self):
        return time.perf_counter() - self._wall

    def seconds(self):
        return (time.process_time() - self._processor) / threads()


class SceneFile:
    """What a snapshot says of elements and of where surfaces lie on the lightmap pages."""

    def __init__(self, folder):
        self.folder = str(folder)
        with Reader(self.folder, "snapshot") as reader:
            self.data = reader.data
            self._meshes = [self._load(reader, mesh) for mesh in self.data["meshes"]]
        self.elements = self.data.get("elements") or []

    @staticmethod
    def _load(reader, mesh):
        values = lambda reference, kind: np.array(reader.values(reference, kind))  # noqa: E731
        return {
            "positions": values(mesh["positions"], "f32").reshape(-1, 3),
            "corners": values(mesh["corner_vertex"], "u32").reshape(-1, 3),
            "uv": [values(layer, "f32").reshape(-1, 3, 2) for layer in mesh["uv_layers"]],
        }

    def weights(self, given=None):
        """Weight of every element: the scene's own, or as given by name."""
        known = {e["name"]: float(e["weight"]) for e in self.elements}
        for name, weight in (given or {}).items():
            if name not in known:
                raise ValueError(f"the scene has no light set, door or toggle named {name}")
            known[name] = weight
        return np.array(list(known.values()), np.float32)

    def _corner_weights(self, points):
        u, v = points["u"], points["v"]
        return np.stack([1.0 - u - v, u, v], axis=1)

    def page_uv(self, points):
        """(page, uv) of points, uv in [0,1]^2."""
        pages, uv = np.zeros(len(points), int), np.zeros((len(points), 2))
        weights = self._corner_weights(points)
        for k, p in enumerate(points):
            instance = self.data["instances"][p["instance"]]
            corners = self._meshes[instance["mesh"]]["uv"][instance["lightmap_layer"]][p["triangle"]]
            pages[k] = instance["page"]
            uv[k] = weights[k] @ corners * instance["uv_scale"] + instance["uv_offset"]
        return pages, uv

    def positions(self, points):
        """World positions of points, m."""
        out, weights = np.zeros((len(points), 3)), self._corner_weights(points)
        for k, p in enumerate(points):
            instance = self.data["instances"][p["instance"]]
            mesh = self._meshes[instance["mesh"]]
            local = weights[k] @ mesh["positions"][mesh["corners"][p["triangle"]]]
            matrix = np.array(instance["transform"]).reshape(3, 4)
            out[k] = matrix[:, :3] @ local + matrix[:, 3]
        return out


def product_of(weights):
    """Share of a term in a state: the product of its elements' weights."""
    return lambda elements: float(np.prod([weights[e] for e in elements]))


class Lightmaps:
    """One finished bake: light of a state on every page, with how long it took. mixes: shares of its terms, by element
    ids, in further states."""

    def __init__(self, library, scene, weights, cancelled=engine.never, mixes=(), **settings):
        watch = Stopwatch()
        with engine.Bake(library, scene.folder, cancelled, **settings) as bake:
            self.seconds, self.wall = watch.seconds(), watch.wall()
            pages = range(len(bake.pages))
            base = [bake.layer(p, engine.LAYER_IRRADIANCE) for p in pages]
            self.base = [page @ LUMINANCE for page in base]
            shares = [product_of(weights), *mixes]
            self.light, *self.mixed = zip(*(_mix(bake, p, page, shares) for p, page in enumerate(base)))
            self.validity = [bake.layer(p, engine.LAYER_VALIDITY)[..., 0] for p in pages]
            self.stderr = [bake.layer(p, LAYER_STDERR)[..., 0] for p in pages]
            self.packed = [bake.layer(p, LAYER_AHD) for p in pages]
            self.sh = [bake.layer(p, LAYER_SH) for p in pages] if settings.get("keep_sh") else None
            self.report = bake.report()

    def luminance(self, pages, uv, mix=None):
        """Luminance at points as a game shows it, W/m^2; of the state, or of a mix by number."""
        return lookup(
            [page @ LUMINANCE for page in (self.light if mix is None else self.mixed[mix])], pages, uv
        )

    def luminance_page(self, page):
        """Luminance of the state on a page, bottom row first."""
        return self.light[page] @ LUMINANCE


def _mix(bake, page, base, shares):
    """Light of a page, one for each choice of shares."""
    out = [base.copy() for _ in shares]
    for elements, read in bake.terms():
        parts = [share(elements) for share in shares]
        if any(parts):
            light = read(page, base.shape)
            for total, part in zip(out, parts):
                total += np.float32(part) * light
    return out


def lookup(layers, pages, uv):
    """Bilinear values of per-page layers (height, width, ...) at uv; texel centres lie at (i + 0.5) / size."""
    out = np.zeros((len(uv),) + layers[0].shape[2:])
    for number, layer in enumerate(layers):
        here = pages == number
        height, width = layer.shape[:2]
        x = np.clip(uv[here, 0] * width - 0.5, 0, width - 1)
        y = np.clip(uv[here, 1] * height - 0.5, 0, height - 1)
        x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
        x1, y1 = np.minimum(x0 + 1, width - 1), np.minimum(y0 + 1, height - 1)
        fx, fy = x - x0, y - y0
        shape = (-1,) + (1,) * (layer.ndim - 2)
        fx, fy = fx.reshape(shape), fy.reshape(shape)
        low = layer[y0, x0] * (1 - fx) + layer[y0, x1] * fx
        out[here] = low * (1 - fy) + (layer[y1, x0] * (1 - fx) + layer[y1, x1] * fx) * fy
    return out


class Reference:
    """Brute force answers at random points."""

    def __init__(
        self,
        library,
        scene,
        weights,
        bounces,
        points,
        seconds,
        seed=0,
        normal=(0, 0, 1),
        door_bounces=abi.NONE,
        cancelled=engine.never,
    ):
        watch = Stopwatch()
        settings = abi.ReferenceSettings()
        library.ajar_reference_settings_init(c.byref(settings))
        settings.points, settings.bounces, settings.batches = points, bounces, 1 << 30
        settings.time_limit, settings.seed = seconds, seed
        settings.normal[:] = normal
        settings.door_bounces = door_bounces
        settings.weight_count = len(weights)
        settings.weights = np.ascontiguousarray(weights, np.float32).ctypes.data_as(abi.floats)
        self.points, self.batches = _trace(library, scene.folder, settings, cancelled)
        self.luminance = self.points["irradiance"] @ LUMINANCE
        self.stderr = self.points["standard_error"].astype(float)
        self.wall = watch.wall()


def _trace(library, folder, settings, cancelled):
    handle, batches = abi.Handle(), c.c_uint32()
    with engine.snapshot_scene(library, folder) as (scene, _):
        check(library, library.ajar_reference_start(scene, c.byref(settings), c.byref(handle)))
    try:
        check(library, engine.wait(library, "reference", handle, cancelled))
        array = (abi.ReferencePoint * settings.points)()
        check(library, library.ajar_reference_read(handle, array, settings.points, c.byref(batches)))
    finally:
        library.ajar_reference_release(c.byref(handle))
    return np.array(np.ctypeslib.as_array(array)), batches.value


def presets():
    """Settings of the presets by name."""
    return {name.lower(): values for name, values in model.PRESETS.items()}


def combinations():
    """Choices of combinations, fewest first."""
    return list(abi.COMBINATIONS)


def write_json(path, value):
    """JSON with short numbers."""
    path.write_text(json.dumps(value, indent=1, default=float) + "\n", encoding="utf-8")
