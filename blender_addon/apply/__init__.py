# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes bake results back: UV layers, images, preview materials. Never touches artists' nodes."""
