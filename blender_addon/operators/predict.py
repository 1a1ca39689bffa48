# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.predict: what a bake would take."""
from bpy.types import Operator

from .. import job, predict_job
from . import common


class AJAR_OT_predict(common.JobOperator, Operator):
    """Find out from a pilot of seconds how long a bake of this file would take with Draft, Preview and Production. \
Blender stays usable; Esc cancels. The file stays as it is"""

    bl_idname = "ajar.predict"
    bl_label = "Predict Times"

    def execute(self, context):
        """Checks the scene, then runs the pilots."""
        if not self.scene_is_fit(context):
            return {"CANCELLED"}
        return self.start(context, job.Job("Prediction", context, predict_job.predict_steps))


CLASSES = (AJAR_OT_predict,)
