# SPDX-License-Identifier: GPL-3.0-or-later
"""The way to the native library: ctypes mirror, snapshot files, worker process (no bpy).

Only snapshot_write imports numpy; everything the worker loads is standard library.
"""
