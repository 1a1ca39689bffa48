# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.prepare_uvs: lightmap UV layers without a bake."""
from bpy.props import BoolProperty
from bpy.types import Operator

from .. import job
from . import common


class AJAR_OT_prepare_uvs(common.JobOperator, Operator):
    """Unwrap and pack the lightmap UVs (layer AjarLightmap) of all objects that get a lightmap. \
Other UV layers stay as they are"""

    bl_idname = "ajar.prepare_uvs"
    bl_label = "Prepare Lightmap UVs"

    keep_existing: BoolProperty(
        name="Keep Existing",
        default=False,
        description="Keep the charts of existing AjarLightmap layers and only pack them anew",
    )

    def invoke(self, context, _event):
        """Takes the scene's choice unless a script gave one."""
        if not self.properties.is_property_set("keep_existing"):
            self.keep_existing = context.scene.ajar.keep_uvs
        return self.execute(context)

    def execute(self, context):
        """Checks the scene, then runs the layout."""
        if not self.scene_is_fit(context, output=False):
            return {"CANCELLED"}
        return self.start(
            context, job.Job("Lightmap UVs", context, job.layout_steps, keep_existing=self.keep_existing)
        )


CLASSES = (AJAR_OT_prepare_uvs,)
