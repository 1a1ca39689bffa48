# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.accuracy: error against time for the open file."""
import os

from bpy.props import BoolProperty, FloatProperty, IntProperty
from bpy.types import Operator

from .. import accuracy_job, job, settings
from ..accuracy import study
from . import common


class AJAR_OT_accuracy(common.JobOperator, Operator):
    """Bake along every setting on its own and compare with brute force: how far off the preset is, what the next \
halving of the error costs, which setting buys most. Blender stays usable; Esc cancels. The file stays as it is"""

    bl_idname = "ajar.accuracy"
    bl_label = "Measure Accuracy"

    quick: BoolProperty(
        name="Quick",
        default=True,
        description="Few settings around Draft, minutes; else all settings around the preset, an hour or more",
    )
    points: IntProperty(name="Points", min=0, description="Points of the reference, 0 for the usual number")
    reference_seconds: FloatProperty(
        name="Reference Time", min=0.0, description="Seconds for the reference, 0 for the usual time"
    )
    budget: FloatProperty(name="Budget", min=0.0, description="Seconds for all bakes, 0 for the usual time")

    def execute(self, context):
        """Checks the scene, then runs the measurement."""
        if not self.scene_is_fit(context):
            return {"CANCELLED"}
        given = {name: getattr(self, name) or None for name in study.QUICK}
        options = {
            "out": os.path.dirname(settings.accuracy_page(context.scene)),
            "preset": "draft" if self.quick else context.scene.ajar.preset.lower(),
            "quick": self.quick,
            "limits": study.limits(self.quick, **given),
        }
        return self.start(context, job.Job("Accuracy", context, accuracy_job.accuracy_steps, **options))


class AJAR_OT_accuracy_show(Operator):
    """Open the page of the last measurement"""

    bl_idname = "ajar.accuracy_show"
    bl_label = "Show Accuracy"

    @classmethod
    def poll(cls, context):
        if not os.path.isfile(settings.accuracy_page(context.scene)):
            cls.poll_message_set("Nothing is measured yet")
            return False
        return True

    def execute(self, context):
        """Opens it, and says where it is."""
        page = settings.accuracy_page(context.scene)
        accuracy_job.show_page(page)
        self.report({"INFO"}, page)
        return {"FINISHED"}


CLASSES = (AJAR_OT_accuracy, AJAR_OT_accuracy_show)
