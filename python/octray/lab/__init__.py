"""The lab: one scene, many methods, side by side.

>>> from octray import lab
>>> report = lab.run("scenes/hello/hello.pov", size=(64, 48), methods=["auto", "brute"])
>>> [combination.same for combination in report.combinations]
[True, True]

``octray lab`` is this on the command line; docs/lab.md says how to read the figures.
"""

from __future__ import annotations

from octray.lab.result import Combination, Drawings, Group, Report, Status
from octray.lab.run import run
from octray.lab.table import table

__all__ = ["Combination", "Drawings", "Group", "Report", "Status", "run", "table"]
