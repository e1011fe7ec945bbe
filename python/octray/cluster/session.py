"""The cluster as users have it: a context that renders."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from octray.cluster.accounts import Accounts
from octray.cluster.address import Address
from octray.cluster.crew import Crew
from octray.cluster.engine import Engine
from octray.cluster.errors import ClusterError
from octray.cluster.image_space import ImageSpace, Watch
from octray.cluster.queries import Queries
from octray.cluster.shipment import Shipment

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator

    import numpy as np
    import numpy.typing as npt
    from typing_extensions import Self

    from octray import Image, Scene
    from octray._answers import Columns

Distribution = Literal["image", "object"]

#: What ``Cluster.render`` takes of what ``Scene.render`` does.
_SETTINGS = ("size", "spp", "crop", "view", "max_depth", "threshold", "seed", "integrator")


class Cluster:
    """Workers on this machine or on others.

    ``address`` is ``"local"`` (a worker for each processor), ``"local:4"``, ``"HOST:PORT"`` or
    ``"auto"`` (the cluster that runs on this machine). Starting takes a few seconds, so keep it for
    several pictures. A cluster that was joined is left running.
    """

    def __init__(
        self,
        address: str = "local",
        *,
        store_bytes: int = 256 << 20,
        say: Callable[[str], None] | None = None,
    ) -> None:
        """Start or join; ``store_bytes`` is what scenes may take together on a local one."""
        start = time.monotonic()
        parsed = Address.parse(address)
        self.accounts = Accounts()
        self._engine = Engine(parsed, store_bytes)
        try:
            self._crew = Crew(self._engine, parsed.workers, self.accounts)
        except BaseException:
            self._engine.close()
            raise
        if say is not None:
            self._crew.on_message(say)
        self._closed = False
        self._shipped: dict[str, Any] = {}
        self.accounts.start_s = time.monotonic() - start

    def __enter__(self) -> Self:
        """Give the cluster itself."""
        return self

    def __exit__(self, *details: object) -> None:
        """Leave no process behind that was started for it."""
        self.close()

    def close(self) -> None:
        """End the workers, and the cluster if it is ours."""
        if not self._closed:
            self._closed = True
            self._crew.retire()
            self._engine.close(self._crew.pids)

    @property
    def pids(self) -> list[int]:
        """Give the numbers of the workers' processes, on their machines."""
        return [m.hello["pid"] for m in self._crew.members if m.hello is not None]

    def wait_for(self, workers: int, seconds: float = 60.0) -> None:
        """Wait until so many workers are there."""
        end = time.monotonic() + seconds
        while len(self._crew.ready) < workers:
            for _ in self._crew.events():
                pass
            if time.monotonic() > end:
                raise ClusterError(f"{len(self._crew.ready)} of {workers} workers came")

    def _shipment(self, scene: Scene, accel: str, trees: dict[str, Any]) -> Shipment:
        import numpy as np  # noqa: PLC0415 - heavy

        data = np.frombuffer(scene.to_bytes(), dtype=np.uint8)
        # The hash of the content stands at the beginning.
        key = data[16:32].tobytes().hex()
        if key not in self._shipped:
            # An older scene is let go with its last reference.
            self._shipped = {key: self._engine.put(data)}
        return Shipment(f"{key} {accel} {sorted(trees.items())}", self._shipped[key], accel, trees)

    def render(
        self,
        scene: Scene,
        *,
        distribution: Distribution = "image",
        accel: str = "auto",
        trees: dict[str, Any] | None = None,
        progress: Callable[[float, str], None] | None = None,
        checkpoint: str | os.PathLike[str] | None = None,
        resume: bool = False,
        on_interrupt: Literal["raise", "return"] = "raise",
        **settings: Any,
    ) -> Image:
        """Render a picture; its bytes are those of ``scene.render`` with the same settings.

        ``settings`` are those of ``Scene.render``: size, spp, crop, view, max_depth, threshold,
        seed, integrator. ``trees`` are keywords of ``Scene.prepare``. ``progress`` is called with
        the share that is done and a line of figures. ``checkpoint`` keeps what is finished,
        ``resume`` goes on with it.
        """
        from octray._core import TiledPicture  # noqa: PLC0415 - heavy

        unknown = set(settings) - set(_SETTINGS)
        if unknown:
            raise TypeError(f"a cluster's render has no {', '.join(sorted(unknown))}")
        if distribution != "image":
            raise ClusterError("object space is not there yet: use the distribution image")
        place = None if checkpoint is None else Path(checkpoint)
        picture = TiledPicture(scene, **settings)
        before = 0
        if resume and place is not None and place.exists():
            before = len(picture.resume(place.read_bytes()))
        shipment = self._shipment(scene, accel, trees or {})
        # The view decides nothing about the light.
        asked = {name: value for name, value in settings.items() if name != "view"}
        watch = Watch(progress or (lambda _share, _text: None), place)
        start = time.monotonic()
        try:
            ImageSpace(
                self._crew,
                self.accounts,
                shipment,
                picture,
                settings={**asked, "accel": accel},
                watch=watch,
            ).run()
        except KeyboardInterrupt:
            if on_interrupt == "raise":
                raise
        complete = not picture.missing()
        if complete and place is not None:
            place.unlink(missing_ok=True)
        return picture.image(
            {
                "phases": {"render_s": time.monotonic() - start},
                "complete": complete,
                "cost": None,
                "tiles": picture.tiles,
                "finished_tiles": picture.tiles - len(picture.missing()),
                "resumed_tiles": before,
                "cluster": self.accounts.as_dict(),
            }
        )

    def query(
        self,
        scene: Scene,
        mode: str,
        rows: npt.NDArray[np.float64],
        *,
        chunk: int = 65536,
        accel: str = "auto",
        trees: dict[str, Any] | None = None,
        **options: Any,
    ) -> Iterator[tuple[Columns, int]]:
        """Answer rays (N, 6) or points (N, 3): named columns and how many rows, in order.

        ``mode`` is ``first``, ``all``, ``count``, ``any`` or ``inside``; ``whole_line``,
        ``overlaps`` and ``normals`` are those of ``octray query``. The bits are those of the
        methods of ``Scene``.
        """
        import numpy as np  # noqa: PLC0415 - heavy

        usual = {"whole_line": False, "overlaps": None, "normals": False}
        unknown = set(options) - set(usual)
        if unknown:
            raise TypeError(f"a cluster's query has no {', '.join(sorted(unknown))}")
        shipment = self._shipment(scene, accel, trees or {})
        queries = Queries(
            self._crew, self.accounts, shipment, mode, {**usual, **options, "accel": accel}
        )

        def part(index: int) -> npt.NDArray[np.float64]:
            return np.array(rows[index * chunk : (index + 1) * chunk], dtype=np.float64)

        return queries.run(-(-len(rows) // chunk), part)
