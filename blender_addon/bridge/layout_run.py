# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a layout request directory through the library and writes the answer beside it."""

import ctypes as c

from . import abi
from .library import BakeError, check, read_warnings
from .scene_builder import fill_settings
from .snapshot_io import Reader, SnapshotError, Writer


def run_layout(library, directory, cancelled=lambda: False):
    """layout.json -> layout_result.json; returns [(culprit, text)], or None if cancelled."""
    try:
        with Reader(directory, "layout") as reader:
            return _run(library, directory, reader, cancelled)
    except (SnapshotError, KeyError) as error:
        raise BakeError(abi.ERROR_INPUT, f"bad layout request: {error}", str(directory)) from error


def _run(library, directory, reader, cancelled):
    settings = fill_settings(library, reader.data.get("settings", {}), "layout_settings")
    layout = abi.Handle()
    check(library, library.ajar_layout_create(c.byref(settings), c.byref(layout)))
    try:
        for mesh in reader.data["meshes"]:
            _add_mesh(library, layout, reader, mesh)
        if cancelled():
            return None
        check(library, library.ajar_layout_run(layout))
        if cancelled():
            return None
        warnings = read_warnings(library, layout, "layout")
        _write_result(library, layout, directory, reader.data["meshes"], warnings)
        return warnings
    finally:
        library.ajar_layout_release(c.byref(layout))


def _add_mesh(library, layout, reader, mesh):
    desc = abi.LayoutMeshDesc()
    library.ajar_layout_mesh_desc_init(c.byref(desc))
    desc.name = mesh["name"].encode("utf-8", "replace")
    corners, polygons = mesh["corner_vertex"]["count"], mesh["polygon_start"]["count"]
    desc.vertex_count, desc.corner_count, desc.polygon_count = mesh["vertex_count"], corners, polygons
    pointer = reader.pointer
    desc.positions = pointer(mesh["positions"], "f32", 3 * mesh["vertex_count"])
    desc.corner_vertex = pointer(mesh["corner_vertex"], "u32", corners)
    desc.polygon_start = pointer(mesh["polygon_start"], "u32", polygons)
    desc.polygon_size = pointer(mesh["polygon_size"], "u32", polygons)
    desc.corner_edge_sharp = pointer(mesh.get("corner_edge_sharp"), "u8", corners)
    desc.corner_uv = pointer(mesh.get("corner_uv"), "f32", 2 * corners)
    users = mesh["users"]
    desc.user_count = len(users)
    desc.user_transforms = (c.c_double * (12 * len(users)))(*(v for u in users for v in u["transform"]))
    desc.user_texel_scale = (c.c_float * len(users))(*(u.get("texel_scale", 1.0) for u in users))
    check(library, library.ajar_layout_add_mesh(layout, c.byref(desc), c.byref(c.c_uint32())))


def _write_result(library, layout, directory, meshes, warnings):
    with Writer(directory, "layout_result") as writer:
        answer = [
            {
                "name": mesh["name"],
                "corner_uv": _mesh_uv(library, layout, index, mesh["corner_vertex"]["count"], writer),
                "users": [_user(library, layout, index, user) for user in range(len(mesh["users"]))],
            }
            for index, mesh in enumerate(meshes)
        ]
        writer.finish(
            {
                "pages": _pages(library, layout),
                "meshes": answer,
                "warnings": [{"culprit": who, "text": text} for who, text in warnings],
            }
        )


def _pages(library, layout):
    count, width, height = c.c_uint32(), c.c_uint32(), c.c_uint32()
    check(library, library.ajar_layout_page_count(layout, c.byref(count)))
    pages = []
    for page in range(count.value):
        check(library, library.ajar_layout_page_size(layout, page, c.byref(width), c.byref(height)))
        pages.append({"width": width.value, "height": height.value})
    return pages


def _mesh_uv(library, layout, mesh, corners, writer):
    uv = (c.c_float * (2 * corners))()
    check(library, library.ajar_layout_mesh_uv(layout, mesh, uv, len(uv)))
    return writer.add_bytes(uv, "f32")


def _user(library, layout, mesh, user):
    page, density = c.c_uint32(), c.c_float()
    scale, offset = (c.c_float * 2)(), (c.c_float * 2)()
    check(
        library, library.ajar_layout_user(layout, mesh, user, c.byref(page), scale, offset, c.byref(density))
    )
    return {
        "page": page.value,
        "scale": list(scale),
        "offset": list(offset),
        "texels_per_meter": density.value,
    }
