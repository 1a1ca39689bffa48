# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.bake, ajar.cancel, ajar.clear."""
from bpy.types import Operator

from .. import job, settings
from ..apply import clear
from . import common


class AJAR_OT_bake(common.JobOperator, Operator):
    """Bake the lightmaps of this scene. Blender stays usable; Esc cancels"""

    bl_idname = "ajar.bake"
    bl_label = "Bake Lightmaps"

    def execute(self, context):
        """Checks the scene, then runs the job."""
        if not self.scene_is_fit(context):
            return {"CANCELLED"}
        package, report = settings.output_paths(context.scene)
        keep = context.scene.ajar.keep_uvs
        return self.start(
            context,
            job.Job("Bake", context, job.bake_steps, package=package, report=report, keep_existing=keep),
        )


class AJAR_OT_cancel(Operator):
    """Cancel the running bake; the last finished one stays"""

    bl_idname = "ajar.cancel"
    bl_label = "Cancel Bake"

    @classmethod
    def poll(cls, _context):
        if not job.manager.running:
            cls.poll_message_set("No bake is running")
        return job.manager.running

    def execute(self, _context):
        """Asks the job to stop; it ends within a second."""
        job.manager.cancel()
        return {"FINISHED"}


class AJAR_OT_clear(Operator):
    """Remove the preview, the baked images and the lightmap UV layers from this file. Settings, \
tags and files on disk stay"""

    bl_idname = "ajar.clear"
    bl_label = "Clear Bake"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.poll_idle(cls, context)

    def invoke(self, context, event):
        """Asks first."""
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        """Clears the file."""
        count = clear.clear(context.scene)
        self.report({"INFO"}, f"Removed {count} lightmap layers and images")
        return {"FINISHED"}


CLASSES = (AJAR_OT_bake, AJAR_OT_cancel, AJAR_OT_clear)
