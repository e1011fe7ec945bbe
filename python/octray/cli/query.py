"""``octray query``: a scene and an array of rays in, what they meet out."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from octray.cli.answers import JsonLines, Npz, Writer
from octray.cli.cluster_options import cluster_option, started
from octray.cli.exits import Exit, FailureError
from octray.cli.messages import load, preparing
from octray.cli.options import (
    accel_option,
    progress_option,
    quiet_option,
    scene_argument,
    threads_option,
    tree_options,
    tree_values,
)
from octray.cli.output import check_place
from octray.cli.progress import Progress, duration

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from octray import Scene
    from octray.cli.progress import Style
    from octray.cluster import Cluster

    _Rows = npt.NDArray[np.float64]

#: Rays that are in memory at a time.
CHUNK = 65536
MODES = ("first", "all", "count", "any", "inside")


@click.command(
    "query", epilog="Example: octray query part.csg --rays rays.npy --mode all -o chords.npz"
)
@scene_argument
@click.option("--rays", metavar="FILE", help="Rays as an array (N, 6) in a .npy file.")
@click.option(
    "--points", metavar="FILE", help="For inside: points as an array (N, 3) in a .npy file."
)
@click.option(
    "--mode",
    type=click.Choice(MODES),
    default="first",
    show_default=True,
    help="The nearest surface, every interval inside a solid, the number of boundaries, whether"
    " there is any surface, or the solid at each point (or each ray's origin).",
)
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    default="-",
    show_default=True,
    help="Answers, .npz or .jsonl; - is JSON lines on standard output.",
)
@click.option(
    "--whole-line", is_flag=True, help="For all and count: also what lies behind the origins."
)
@click.option(
    "--overlaps",
    type=click.Choice(["regions", "priorities", "objects"]),
    help="For all: whose intervals count where solids overlap; regions by default.",
)
@click.option("--normals", is_flag=True, help="For first and all: unit normals too.")
@cluster_option
@accel_option
@tree_options
@threads_option
@progress_option
@quiet_option
def command(scene: str, facets: bool, strict: bool, **options: Any) -> int:
    """Answer where rays go in SCENE.

    A ray is (ox, oy, oz, dx, dy, dz); distances t are in units of its direction, and t > 0
    counts. The file of rays is read, and the answers are written, piece by piece: neither needs
    to fit into memory.
    """
    query = _Query(scene, options)
    loaded = load(scene, facets=facets, strict=strict, quiet=options["quiet"])
    return query.run(loaded)


class _Query:
    """One invocation, from arguments to exit code."""

    def __init__(self, path: str, options: dict[str, Any]) -> None:
        self.path = path
        self.options = options
        self.mode: str = options["mode"]
        self.method = {"accel": options["accel"], "threads": options["threads"]}
        self._check_arguments()
        self.rows, self.what = self._open_rows()
        self.writer = self._open_writer()
        self.invalid = 0
        self.cluster: Cluster | None = None

    def _check_arguments(self) -> None:
        from octray._core import check_request

        mode, options = self.mode, self.options
        for name, modes in (
            ("whole_line", ("all", "count")),
            ("overlaps", ("all",)),
            ("normals", ("first", "all")),
            ("points", ("inside",)),
        ):
            if options[name] and mode not in modes:
                flag = "--" + name.replace("_", "-")
                raise click.UsageError(f"{flag} goes with --mode {' or '.join(modes)}, not {mode}")
        if bool(options["rays"]) == bool(options["points"]):
            either = "either --rays or --points" if mode == "inside" else "--rays"
            raise click.UsageError(f"--mode {mode} needs {either}")
        try:
            check_request(threads=options["threads"])
        except ValueError as error:
            raise click.UsageError(str(error)) from error

    def _open_rows(self) -> tuple[_Rows, str]:
        """Give the rays or points as an array that stays in its file until a part of it is used."""
        import numpy as np

        from octray._chunks import check_rows

        points = self.options["points"]
        name, width, what = (points, 3, "points") if points else (self.options["rays"], 6, "rays")
        try:
            rows = np.load(name, mmap_mode="r", allow_pickle=False)
        except OSError as error:
            raise FailureError(f"{name}: {error.strerror or error}") from error
        except (ValueError, EOFError) as error:
            raise FailureError(f"{name} is not an array in a .npy file: {error}") from error
        if not isinstance(rows, np.ndarray):
            raise FailureError(f"{name} holds several arrays; expected one, in a .npy file")
        try:
            check_rows(what, rows, width)
        except ValueError as error:
            raise FailureError(f"{name}: {error}") from error
        return rows, what

    def _open_writer(self) -> Writer:
        given: str = self.options["output"]
        if given == "-":
            return JsonLines(None)
        path = Path(given)
        suffix = path.suffix.lower()
        if suffix not in {".npz", ".jsonl"}:
            raise click.UsageError(f"-o {given}: the name must end in .npz or .jsonl (or be -)")
        check_place(path)
        return Npz(path) if suffix == ".npz" else JsonLines(path)

    def run(self, scene: Scene) -> int:
        """Answer for all rays, by workers if so asked."""
        address = self.options["cluster"]
        if address is None:
            return self._run(scene)
        with started(address, quiet=self.options["quiet"]) as self.cluster:
            return self._run(scene)

    def _run(self, scene: Scene) -> int:
        """Say what happened, too."""
        start = time.perf_counter()
        style: Style = "none" if self.options["quiet"] else self.options["progress"]
        done = 0
        try:
            if self.cluster is None:
                with preparing(self.path):
                    scene.prepare(**self.method, **tree_values(self.options))
            with self.writer as writer, Progress("query", style) as progress:
                for columns, rows in self._answers(scene):
                    writer.add(columns)
                    done += rows
                    progress(done / max(len(self.rows), 1))
                writer.finish(self._labels(scene))
        except BrokenPipeError:
            raise
        except OSError as error:
            name = self.options["output"]
            raise FailureError(f"{name}: {error.strerror or error}") from error
        except KeyboardInterrupt:
            if self.options["output"] != "-":
                raise
            click.echo(f"octray: interrupted after {done} of {len(self.rows)}", err=True)
            return Exit.INTERRUPTED
        if not self.options["quiet"]:
            click.echo(self._summary(time.perf_counter() - start), err=True)
        return Exit.OK

    def _answers(self, scene: Scene) -> Any:
        """Columns of answers, and for how many rays they are, chunk by chunk."""
        import numpy as np

        from octray._answers import columns
        from octray._chunks import row_chunks

        options = {name: self.options[name] for name in ("whole_line", "overlaps", "normals")}
        options |= self.method
        if len(self.rows) == 0:
            width = self.rows.shape[1]
            yield columns(scene, self.mode, np.empty((0, width)), options), 0
        if self.cluster is not None and len(self.rows):
            del options["threads"]
            answers = self.cluster.query(
                scene,
                self.mode,
                self.rows,
                chunk=CHUNK,
                trees=tree_values(self.options),
                **options,
            )
            yield from answers
            return
        for part in row_chunks(self.what, self.rows, self.rows.shape[1], CHUNK):
            rows = np.asarray(part, dtype=np.float64)
            if self.what == "rays":
                self.invalid += scene._count_invalid_rays(rows, **self.method)  # noqa: SLF001
            yield columns(scene, self.mode, rows, options), len(rows)

    def _labels(self, scene: Scene) -> dict[str, list[str]]:
        """Names for the ids that the answers hold."""
        if self.mode in {"count", "any"}:
            return {}
        labels = {"object_names": scene.names}
        if self.mode == "all":
            labels["material_names"] = scene.material_names
        return labels

    def _summary(self, seconds: float) -> str:
        name = "standard output" if self.options["output"] == "-" else self.options["output"]
        text = f"{name}: {len(self.rows)} {self.what} in {duration(seconds)}"
        if self.invalid:
            text += f"; {self.invalid} of them with NaN, infinity or no direction, which miss"
        return text
