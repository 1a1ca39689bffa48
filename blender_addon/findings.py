# SPDX-License-Identifier: GPL-3.0-or-later
"""One line of the pre-flight list."""
from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """What is wrong with culprit, and the remedy. Errors stop a bake, warnings do not."""

    level: str  # 'ERROR' or 'WARNING'
    culprit: str
    text: str
    remedy: str

    def __str__(self):
        where = f"{self.culprit}: " if self.culprit else ""
        return f"{where}{self.text}. {self.remedy}."


def error(culprit, text, remedy):
    """A finding that stops a bake."""
    return Finding("ERROR", culprit, text, remedy)


def warning(culprit, text, remedy):
    """A finding that does not."""
    return Finding("WARNING", culprit, text, remedy)
