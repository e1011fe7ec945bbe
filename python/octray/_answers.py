"""Answers to rays and points as named columns: what ``octray query`` writes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from octray._core import Scene

#: Per ray how many intervals it has (``None``: one answer for each ray), and the answers by name.
Columns: TypeAlias = "tuple[npt.NDArray[np.int64] | None, dict[str, npt.NDArray[Any]]]"


def columns(
    scene: Scene, mode: str, rows: npt.NDArray[np.float64], options: dict[str, Any]
) -> Columns:
    """Answer by mode: ``first``, ``all``, ``count``, ``any`` or ``inside``.

    ``options`` are ``accel``, ``threads``, ``whole_line``, ``overlaps`` and ``normals``.
    """
    method = {"accel": options["accel"], "threads": options["threads"]}
    whole_line, normals = options["whole_line"], options["normals"]
    if mode == "first":
        hits = scene.cast_rays(rows, **method)
        found = {"t": hits.t, "object_id": hits.object_id, "face_id": hits.face_id}
        return None, found | ({"normal": hits.normal} if normals else {})
    if mode == "all":
        intervals = scene.list_intersections(
            rows, whole_line=whole_line, overlaps=options["overlaps"] or "regions", **method
        )
        names = ["t_enter", "t_exit", "object_id", "material_id", "face_enter", "face_exit"]
        names += ["normal_enter", "normal_exit"] if normals else []
        return intervals.counts, {name: getattr(intervals, name) for name in names}
    if mode == "count":
        return None, {"count": scene.count_intersections(rows, whole_line=whole_line, **method)}
    if mode == "any":
        return None, {"any": scene.test_occlusions(rows, **method)}
    objects = scene.locate(rows[:, :3], **method)
    return None, {"inside": objects >= 0, "object_id": objects}
