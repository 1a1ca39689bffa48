# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the error of bakes against time along every setting (no bpy; standard library and numpy)."""
