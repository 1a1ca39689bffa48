# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender scene -> snapshot directory (bpy and numpy). Leaves the user's scene as it was.

Units: metres (Blender lengths are metres whatever the scene's unit scale says), watts,
radians, scene-linear Rec.709.
"""
