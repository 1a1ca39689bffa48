# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators that run a job share."""
import time

import bpy

from .. import checks, job

STEP = 0.05  # seconds between steps without a user interface


def poll_idle(cls, context):
    """Poll of operators that change what a running bake relies on."""
    if job.manager.running:
        cls.poll_message_set("A bake is running: wait for it, or cancel it")
        return False
    if context.mode.startswith("EDIT"):
        cls.poll_message_set("Leave Edit Mode first")
        return False
    return True


def run_here(on_status=None):
    """Steps the job to its end, for background use. on_status(status) is called between steps."""
    while job.manager.step():
        if on_status:
            on_status(job.manager.status)
        time.sleep(STEP)
    return job.manager.last


def report_end(operator, status):
    """Reports a job's end and its warnings; returns the operator's result."""
    for culprit, text in status.warnings[:20]:
        operator.report({"WARNING"}, f"{culprit}: {text}" if culprit else text)
    if status.result == "failed":
        operator.report({"ERROR"}, status.message)
    elif status.result == "cancelled":
        operator.report({"INFO"}, f"{status.title} cancelled")
    else:
        seconds = time.monotonic() - status.started
        operator.report({"INFO"}, status.message or f"{status.title}: done in {seconds:.1f} s")
    return {"FINISHED"} if status.result == "done" else {"CANCELLED"}


class JobOperator:
    """Modal while the job runs: Esc cancels it, all other input goes on to Blender. The job itself
    is stepped by the manager's timer, so it survives the end of this operator."""

    _timer = None
    _status = None

    @classmethod
    def poll(cls, context):
        return poll_idle(cls, context)

    def scene_is_fit(self, context, **asked):
        """Whether nothing keeps the scene from being baked; reports what does. asked: as checks.check_scene takes it."""
        problems = checks.errors(checks.check_scene(context, **asked))
        if problems:
            self.report({"ERROR"}, "\n".join(map(str, problems)))
        return not problems

    def start(self, context, new_job):
        """Starts a job: to its end without a user interface, else modal."""
        job.manager.start(new_job)
        self._status = new_job.status
        if bpy.app.background:
            return report_end(self, run_here())
        self._timer = context.window_manager.event_timer_add(0.25, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Esc asks the job to stop; the timer shows progress and notices the end."""
        status = self._status
        if status.result != "running":
            self._remove_timer(context)
            return report_end(self, status)
        if event.type == "ESC" and event.value == "PRESS":
            job.manager.cancel()
            return {"RUNNING_MODAL"}
        if event.type == "TIMER":
            context.workspace.status_text_set(
                f"{status.title}: {status.stage} " f"{status.fraction:.0%} | Esc: Cancel"
            )
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """Blender ends the operator (file load, quit); the job goes on."""
        self._remove_timer(context)

    def _remove_timer(self, context):
        context.workspace.status_text_set(None)
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
