"""Pictures and queries on several machines.

``Cluster`` is what users need: a context that has workers and renders on them. The picture has the
same bytes as without it, for any number of workers and whatever happens to them.

How it is made, from the bottom:

* ``engine`` starts, joins and leaves the execution engine, Ray; ``node`` is a machine's part in a
  cluster. No other module imports it.
* ``worker`` is what runs in the other processes: a class without any of Ray in it.
* ``crew`` has one actor for each place where a worker can be, and turns what becomes of calls into
  events: *ready*, *answer*, *lost*. It greets every process before anything is asked of it (the
  same version and the same binary, or it is refused), greets it again when it has died and come
  back, and finds nodes that join later.
* ``ledger`` says what is missing, what is under way with whom, and what has been answered: every
  piece counts once, however often it was given out.
* ``image_space`` and ``queries`` are *distributions*: they give out pieces through a ledger to a
  crew and put the answers together. Every worker has the whole scene (``shipment``).
* ``accounts`` are what processes report with each answer: memory, time, bytes.

**A second distribution** (object space: every worker has a part of the scene, rays travel between
them) plugs in beside ``image_space``: a class that is given a ``Crew``, makes its own calls with
``Crew.call(member, method, ..., tag=...)``, reads ``Crew.events()`` and keeps its own ``Ledger`` of
batches; methods of workers are added in ``worker``. What is lost comes back as a *lost* event with
the tag of the call, whose keys ``Ledger.lost`` puts back. ``Cluster.render`` chooses. Nothing else
here depends on what is distributed.

Only actors are used, never plain tasks of the engine (those can hang when a link is cut), and calls
are never repeated by the engine: the ledger does that.
"""

from octray.cluster.accounts import Accounts
from octray.cluster.address import Address
from octray.cluster.errors import ClusterError, MissingExtraError
from octray.cluster.session import Cluster

__all__ = ["Accounts", "Address", "Cluster", "ClusterError", "MissingExtraError"]
