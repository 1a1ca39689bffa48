# SPDX-License-Identifier: GPL-3.0-or-later
"""ajar.check: the pre-flight list."""
import bpy
from bpy.types import Operator

from .. import checks

_ICONS = {"ERROR": "CANCEL", "WARNING": "ERROR"}


class AJAR_OT_check(Operator):
    """List what would stop a bake or make it look wrong, with remedies"""

    bl_idname = "ajar.check"
    bl_label = "Check Scene"

    def execute(self, context):
        """Reports each finding; in the user interface it also opens a list."""
        findings = checks.check_scene(context)
        for finding in findings:
            # An ERROR report would raise in scripts: this operator finds problems, it has none.
            self.report({"WARNING"}, str(finding))
        if not findings:
            self.report({"INFO"}, "Ready to bake")
        if not bpy.app.background and context.window:
            context.window_manager.popup_menu(
                lambda menu, _: _draw(menu.layout, findings), title="Check", icon="CHECKMARK"
            )
        return {"FINISHED"}


def _draw(layout, findings):
    if not findings:
        layout.label(text="Ready to bake", icon="CHECKMARK")
    for finding in findings:
        column = layout.column(align=True)
        where = f"{finding.culprit}: " if finding.culprit else ""
        column.label(text=where + finding.text, icon=_ICONS[finding.level])
        column.label(text=finding.remedy, icon="BLANK1")


CLASSES = (AJAR_OT_check,)
