# SPDX-License-Identifier: GPL-3.0-or-later
"""Writer of snapshot directories that takes numpy arrays."""

import numpy as np

from .snapshot_io import Writer

_DTYPES = {"f32": np.float32, "u32": np.uint32, "u8": np.uint8, "f64": np.float64}


class ArrayWriter(Writer):
    """Writer with add(): any numpy array, stored as the scalar type asked for."""

    def add(self, values, kind):
        """Appends values (any shape, C order) as kind; returns the array reference, None for None."""
        if values is None:
            return None
        flat = np.ascontiguousarray(values, dtype=_DTYPES[kind]).reshape(-1)
        return self.add_bytes(flat if flat.size else b"", kind)
