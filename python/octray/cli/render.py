"""``octray render``: a scene file in, a picture out."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import click

from octray.cli.cluster_options import cluster_option, started
from octray.cli.exits import Exit, FailureError
from octray.cli.messages import RejectedSceneError, load, preparing
from octray.cli.options import (
    accel_option,
    picture_options,
    progress_option,
    quiet_option,
    scene_argument,
    threads_option,
    tree_options,
    tree_values,
)
from octray.cli.output import Output
from octray.cli.progress import Progress, duration
from octray.cli.report import Report

if TYPE_CHECKING:
    from pathlib import Path

    from octray import Image, Scene
    from octray.cli.progress import Style
    from octray.cluster import Accounts


@click.command("render", epilog="Example: octray render part.stl -o part.png --size 1920x1080")
@scene_argument
@click.option(
    "-o", "--output", metavar="FILE", help="Picture, .png or .exr; - is standard output (PNG)."
)
@picture_options
@click.option(
    "--view-from",
    type=click.Choice(["front", "back", "left", "right", "top", "bottom", "iso"]),
    help="Show everything from this side, in a parallel projection.",
)
@accel_option
@tree_options
@click.option(
    "--dump-cells",
    metavar="FILE",
    help="Write the octree's occupied cells with the primitives that they touch.",
)
@click.option("--load-cells", metavar="FILE", help="Build the octree from such a list.")
@threads_option
@click.option(
    "--integrator",
    type=click.Choice(["whitted", "cost"]),
    default="whitted",
    show_default=True,
    help=(
        "What a pixel shows: light (Whitted's recursive ray tracing), or what the same rays cost: "
        "in a PNG a heat map, in an EXR steps, surfaces and triangles tested per sample."
    ),
)
@click.option(
    "--view",
    type=click.Choice(["neutral", "standard", "raw"]),
    help="How light becomes colours in a PNG; by default what suits the file.",
)
@click.option(
    "--preview", is_flag=True, help="Write a coarse picture at once, then ever finer ones."
)
@click.option(
    "--resume",
    is_flag=True,
    help="Go on where an interrupted rendering of the same picture stopped: with FILE.ckpt.",
)
@cluster_option
@click.option(
    "--distribution",
    type=click.Choice(["image", "object"]),
    default="image",
    show_default=True,
    help="With --cluster: every worker has the whole scene, or a part of it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one report object.")
@progress_option
@quiet_option
@click.option("-v", "--verbose", is_flag=True, help="Say what the rendering cost.")
def command(scene: str, **options: Any) -> int:
    """Render SCENE to a picture.

    SCENE is a POV-Ray (.pov), OpenSCAD (.csg) or NFF (.nff) scene, or an OBJ, PLY or STL mesh,
    which gets a camera and lights of its own. The picture is SCENE's name with .png in the
    current directory, unless -o says something else.
    """
    return _Run(scene, options).run()


class _Run:
    """One invocation, from arguments to exit code."""

    def __init__(self, path: str, options: dict[str, Any]) -> None:
        self.path = path
        self.options = options
        if options["output"] == "-" and options["as_json"]:
            raise click.UsageError("-o - and --json both want standard output")
        if options["output"] == "-" and options["preview"]:
            raise click.UsageError("--preview writes the picture several times: -o cannot be -")
        if options["resume"] and (options["output"] == "-" or options["integrator"] == "cost"):
            raise click.UsageError("--resume needs a picture of light in a file")
        if options["cluster"]:
            for name in ("preview", "dump_cells", "load_cells", "threads"):
                if options[name]:
                    flag = "--" + name.replace("_", "-")
                    raise click.UsageError(f"{flag} does not go with --cluster")
        elif options["distribution"] != "image":
            raise click.UsageError("--distribution needs --cluster")
        self.report = Report(path, options)
        self.output: Output | None = None
        self.accounts: Accounts | None = None
        self.style: Style = "none" if options["quiet"] else options["progress"]

    def run(self) -> int:
        """Render; say what happened; print the report whatever happens after the arguments."""
        self._check_arguments()
        try:
            code = self._render()
        except FailureError as error:
            self._say(f"octray: error: {error}")
            self.report.error = str(error)
            if isinstance(error, RejectedSceneError):
                self.report.add_messages(error.diagnostics)
            code = error.code
        except KeyboardInterrupt:
            self._say(f"octray: interrupted; {self._what_is_there()}")
            code = Exit.INTERRUPTED
        if self.options["as_json"]:
            click.echo(self.report.to_json(code))
        return code

    @staticmethod
    def _say(text: str) -> None:
        click.echo(text, err=True)

    def _check_arguments(self) -> None:
        """Refuse what cannot be rendered before any file is read."""
        from octray._core import check_request

        try:
            check_request(
                **{
                    name: self.options[name]
                    for name in (
                        *("size", "spp", "threads", "crop", "max_depth", "threshold"),
                        *("view", "integrator"),
                    )
                }
            )
        except ValueError as error:
            raise click.UsageError(str(error)) from error

    def _render(self) -> Exit:
        options = self.options
        output = self.output = Output(options["output"], self.path)
        scene = self._load()
        if options["cluster"]:
            return self._on_cluster(scene, output)
        with self._phase("build"):
            self._prepare(scene)
        image = self._trace(scene, output)
        self.report.add_rendering(image.report)
        self._warn_of_checkpoint(image)
        if not image.complete:
            return self._keep_partial(image, output)
        return self._finish(image, output)

    def _finish(self, image: Image, output: Output) -> Exit:
        options = self.options
        start = time.perf_counter()
        output.write(image, options["view"])
        self.report.phases["write_s"] = time.perf_counter() - start
        self.report.add_output(output, image)
        if not options["quiet"]:
            self._say(self._summary(output, image))
            if image.report["cost"] is not None:
                self._say(f"  {self._scale(image)}")
        if options["verbose"]:
            self._say(self.accounts.table() if self.accounts is not None else self.report.details())
        return Exit.OK

    def _checkpoint(self, output: Output) -> Path | None:
        """Give the file beside the picture that keeps what is finished."""
        if output.to_stdout or self.options["integrator"] == "cost":
            return None
        path = output.path.with_name(output.path.name + ".ckpt")
        if self.options["resume"] and not path.exists() and not self.options["quiet"]:
            self._say(f"octray: there is no {path}: starting afresh")
        return path

    def _warn_of_checkpoint(self, image: Image) -> None:
        error = image.report["checkpoint"].get("error")
        if error:
            self._say(f"octray: warning: {image.report['checkpoint']['path']}: {error}")

    def _on_cluster(self, scene: Scene, output: Output) -> Exit:
        """Render by workers; what is the same for all pictures is in ``_finish``."""
        options = self.options
        names = ("size", "spp", "crop", "view", "max_depth", "threshold", "integrator")
        checkpoint = self._checkpoint(output)
        with (
            started(options["cluster"], quiet=options["quiet"]) as cluster,
            Progress("render", self.style) as progress,
        ):
            self.accounts = cluster.accounts
            try:
                image = cluster.render(
                    scene,
                    distribution=options["distribution"],
                    accel=options["accel"],
                    trees=tree_values(options),
                    progress=progress.with_detail,
                    checkpoint=checkpoint,
                    resume=options["resume"],
                    on_interrupt="return",
                    **{name: options[name] for name in names},
                )
            except ValueError as error:
                raise click.UsageError(str(error)) from error
            except OSError as error:
                raise FailureError(f"{error.filename}: {error.strerror or error}") from error
        self.report.add_rendering(image.report)
        if not image.complete:
            self._say(
                f"octray: interrupted; {checkpoint or output.name} has what was finished,"
                " go on with --resume"
                if checkpoint is not None and checkpoint.exists()
                else f"octray: interrupted; {self._what_is_there()}"
            )
            return Exit.INTERRUPTED
        return self._finish(image, output)

    def _prepare(self, scene: Scene) -> None:
        options = self.options
        how: dict[str, Any] = {"accel": options["accel"], "threads": options["threads"]}
        try:
            with preparing(self.path):
                scene.prepare(cells=options["load_cells"], **how, **tree_values(options))
            if options["dump_cells"]:
                scene.dump_cells(options["dump_cells"], **how)
        except ValueError as error:
            raise click.UsageError(str(error)) from error
        except OSError as error:
            raise FailureError(f"{error.filename}: {error.strerror or error}") from error

    def _load(self) -> Scene:
        with self._phase("import"):
            scene = load(
                self.path,
                facets=self.options["facets"],
                strict=self.options["strict"],
                quiet=self.options["quiet"],
            )
        self.report.add_messages(scene.diagnostics)
        if self.options["viewall"] or self.options["view_from"]:
            try:
                if self.options["view_from"]:
                    scene.view_from(self.options["view_from"])
                else:
                    scene.view_all()
            except ValueError as error:
                raise FailureError(f"{self.path}: {error}", Exit.SCENE) from error
        return scene

    def _trace(self, scene: Scene, output: Output) -> Image:
        options = self.options
        view = options["view"]
        with Progress("render", self.style) as progress:
            try:
                return scene.render(
                    **{
                        name: options[name]
                        for name in (
                            *("size", "spp", "threads", "accel", "crop", "view"),
                            "integrator",
                        )
                    },
                    max_depth=options["max_depth"],
                    threshold=options["threshold"],
                    progress=progress,
                    preview=(lambda image: output.write(image, view))
                    if options["preview"]
                    else None,
                    on_interrupt="return",
                    checkpoint=self._checkpoint(output),
                    resume=options["resume"],
                )
            except ValueError as error:
                raise click.UsageError(str(error)) from error

    def _keep_partial(self, image: Image, output: Output) -> Exit:
        if image.report["finished_pixels"] == 0 or output.to_stdout:
            self._say(f"octray: interrupted; {self._what_is_there()}")
            return Exit.INTERRUPTED
        output.write(image, self.options["view"])
        self.report.add_output(output, image)
        share = image.report["finished_pixels"] / (image.width * image.height)
        text = f"octray: interrupted; {output.name} has the {share:.0%} that were finished"
        if image.report["checkpoint"].get("exists"):
            text += "; --resume goes on from there"
        self._say(text)
        return Exit.INTERRUPTED

    def _what_is_there(self) -> str:
        if self.output is not None and self.output.written:
            return f"{self.output.name} has the picture as it was last shown"
        return "nothing was written"

    def _phase(self, name: str) -> _Phase:
        return _Phase(name, self.report, Progress(name, self.style))

    def _summary(self, output: Output, image: Image) -> str:
        phases = self.report.phases
        if self.accounts is not None:
            start = self.accounts.start_s
            return (
                f"{output.name}: {image.width}x{image.height} on"
                f" {len(self.accounts.workers)} workers in {duration(sum(phases.values()) + start)}"
                f" (import {duration(phases['import_s'])}, start {duration(start)},"
                f" render {duration(phases['render_s'])})"
            )
        rays = image.report["rays"]["total"]
        rate = rays / max(phases["render_s"], 1e-9)
        mega = 1e6
        unit, scale = ("M", mega) if rate >= mega else ("k", 1e3)
        return (
            f"{output.name}: {image.width}x{image.height} in {duration(sum(phases.values()))}"
            f" (import {duration(phases['import_s'])}, build {duration(phases['build_s'])},"
            f" render {duration(phases['render_s'])}), {rate / scale:.3g} {unit}rays/s"
        )

    @staticmethod
    def _scale(image: Image) -> str:
        cost = image.report["cost"]
        weights = cost["weights"]
        return (
            f"colours of a PNG: black is {cost['low']:g}, the brightest {cost['high']:.3g} or more"
            " (99.5 % of the pixels are below), in tests of one surface per sample; a step weighs"
            f" {weights['step']:g}, a triangle {weights['triangle']:g}"
        )


class _Phase:
    """Times a phase that has no progress of its own; shows its name on a terminal."""

    def __init__(self, name: str, report: Report, progress: Progress) -> None:
        self._name = name
        self._report = report
        self._progress = progress
        self._start = 0.0

    def __enter__(self) -> None:
        self._start = time.perf_counter()
        self._progress.__enter__()
        self._progress.announce()

    def __exit__(self, *details: object) -> None:
        self._progress.__exit__()
        self._report.phases[f"{self._name}_s"] = time.perf_counter() - self._start
