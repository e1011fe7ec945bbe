"""The benchmark: whole renders by octray and by the other ray tracers that are installed.

>>> from octray import bench
>>> report = bench.run(["sphere"], only=["octray"], repeat=1, threads=[1])
>>> [series.scene for series in report.series]
['empty32x24', 'sphere']

``octray bench`` is this on the command line; docs/performance.md says what came out.
"""

from __future__ import annotations

from octray.bench.result import Report, Run, Series, Status
from octray.bench.run import describe_scenes, run
from octray.bench.table import table

__all__ = ["Report", "Run", "Series", "Status", "describe_scenes", "run", "table"]
