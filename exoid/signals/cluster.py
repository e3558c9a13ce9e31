"""Recordings on the workers of a Dask cluster."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError

from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import POSE_COLUMNS, BasePose
from .external_log import external_columns, external_of
from .log import FIELDS, PARTIAL
from .readers import QUANTITIES
from .recording import Recording
from .recordings import RecordingFile, Recordings, changed_item

TIMEOUT = "10s"
"""Time for a scheduler to answer."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False, repr=False)
class Cluster:
    """Recordings on the workers of a Dask cluster, on which exoid must be installed.

    Work runs where the recordings are and returns small results: R factors, sums over lags, noise covariances. Rows
    stay on the workers. Estimators that use the rows themselves (huber, gls, ml) need recordings in memory or on disk.

    Attributes:
        client: A ``distributed.Client``.
        futures: One future for each recording, or for a result of it.
    """

    client: Any
    futures: tuple[Any, ...]

    @staticmethod
    def of_files(client: Any, recordings: Recordings) -> Cluster:  # noqa: ANN401 - Dask is an extra
        """Let workers read files from a shared disk, each time they need them.

        Args:
            client: A ``distributed.Client``, or the address of a scheduler.
            recordings: The files, such as ``Recordings.from_folder(path)``.

        Returns:
            The recordings on the cluster.

        Raises:
            ExoidError: Dask is not installed, or no scheduler answers at the address.
        """
        client = connect(client)
        return Cluster(client, tuple(client.submit(_same, item, pure=False) for item in recordings.items))

    @staticmethod
    def of_bag(client: Any, bag: Any) -> Cluster:  # noqa: ANN401
        """Take a ``dask.bag.Bag`` of :class:`exoid.Recording`, which is computed and stays on the workers.

        Args:
            client: A ``distributed.Client``, or the address of a scheduler.
            bag: The bag.

        Returns:
            The recordings on the cluster.

        Raises:
            ExoidError: As for :meth:`of_files`.
        """
        client = connect(client)
        parts = client.compute(bag.map_partitions(list).to_delayed())
        counts = client.gather([client.submit(len, part) for part in parts])
        pairs = [(part, k) for part, count in zip(parts, counts, strict=True) for k in range(count)]
        return Cluster(client, tuple(client.submit(_item, part, k) for part, k in pairs))

    @staticmethod
    def of_array(client: Any, array: Any, columns: Sequence[str]) -> Cluster:  # noqa: ANN401
        """Take a ``dask.array.Array`` of samples by columns; each chunk of rows is a separate recording.

        Args:
            client: A ``distributed.Client``, or the address of a scheduler.
            array: Samples, (N, k), in chunks of many seconds, as the filters distort the ends of each.
            columns: Names of the k columns as in a CSV file: "time", "q_hip", …, "tau_hip", …, "i_hip", "f_hip", ….
                Wrenches are in the axes of their links, about their origins.

        Returns:
            The recordings on the cluster.

        Raises:
            ExoidError: As for :meth:`of_files`, or columns do not fit the array.
        """
        client, columns = connect(client), tuple(columns)
        if len(columns) != array.shape[1] or "time" not in columns:
            raise ExoidError(
                f"an array of {array.shape[1]} columns, {len(columns)} names: {', '.join(columns)}",
                remedy='name all of them, "time" and "q_<joint>" among them',
            )
        parts = client.compute(array.rechunk({1: -1}).to_delayed().ravel().tolist())
        return Cluster(client, tuple(client.submit(_recorded, part, columns) for part in parts))

    def __len__(self) -> int:
        return len(self.futures)

    def __repr__(self) -> str:
        return f"Cluster({len(self)} recordings)"

    def changed(self, change: Callable[[Recording], Recording]) -> Cluster:
        """Change each recording, those on disk when they are read.

        Args:
            change: Function of a recording.

        Returns:
            The changed recordings on the cluster.
        """
        submit = self.client.submit
        return Cluster(self.client, tuple(submit(changed_item, change, f, pure=False) for f in self.futures))

    def keep(self, work: Callable[[Any], Any]) -> Cluster:
        """Apply a function to each recording, and keep the results on the workers.

        Args:
            work: Function of a recording.

        Returns:
            The results on the cluster.
        """
        return Cluster(self.client, tuple(self.client.submit(_work, work, f, pure=False) for f in self.futures))

    def map(self, work: Callable[[Any], T]) -> list[T]:
        """Apply a function to each recording, and gather the results.

        Args:
            work: Function of a recording.

        Returns:
            The results, in the order of the recordings.

        Raises:
            ExoidError: The function raises it, or workers die repeatedly.
        """
        from distributed import KilledWorker  # noqa: PLC0415 - an extra

        try:
            packed = self.client.gather(list(self.keep(partial(_packed, work)).futures))
        except KilledWorker as error:
            raise ExoidError("workers of the cluster died repeatedly", remedy="give them more memory") from error
        return [pickle.loads(each) for each in packed]


def _packed(work: Callable[[Any], Any], item: Any) -> bytes:  # noqa: ANN401
    """Pickle the result, as Dask itself turns small named tuples into plain ones."""
    return pickle.dumps(work(item))


def connect(client: Any) -> Any:  # noqa: ANN401
    """Connect to the scheduler of a Dask cluster."""
    if not isinstance(client, str):
        return client
    try:
        import distributed  # noqa: PLC0415 - an extra
    except ImportError:
        raise ExoidError("Dask is not installed", remedy="pip install 'exoid[scale]'") from None
    try:
        return distributed.Client(client, timeout=TIMEOUT)
    except (OSError, ValueError, TypeError) as error:
        raise ExoidError(
            f"no Dask scheduler answers ({type(error).__name__})",
            where=client,
            remedy="start one with `dask scheduler`, and name it tcp://host:port",
        ) from None


def _work(work: Callable[[Any], T], item: Any) -> T:  # noqa: ANN401
    """Run on a worker."""
    return work(item.load() if isinstance(item, RecordingFile) else item)


def _same(item: T) -> T:
    return item


def _item(part: Sequence[T], index: int) -> T:
    return part[index]


def _recorded(part: ArrayLike, columns: tuple[str, ...]) -> Recording:
    """Make a recording of a chunk of an array."""
    table = dict(zip(columns, np.asarray(part, dtype=np.float64).T, strict=True))
    joints = tuple(name[2:] for name in columns if name.startswith("q_"))
    arrays: dict[str, Any] = {}
    nothing = np.full(len(table["time"]), np.nan)
    for quantity in QUANTITIES:
        names = [f"{quantity}_{joint}" for joint in joints]
        there = [name in table for name in names]
        if any(there) if quantity in PARTIAL else all(there):
            arrays[FIELDS.get(quantity, quantity)] = np.column_stack([table.get(name, nothing) for name in names])
    base = [table[name] for name in BASE_COLUMNS if name in table]
    if base and len(base) < len(BASE_COLUMNS):
        raise ExoidError("some columns of the base are missing", remedy=f"give all of {', '.join(BASE_COLUMNS)}")
    moving = BaseMotion(np.column_stack(base[:3]), np.column_stack(base[3:])) if base else None
    if moving is not None and set(POSE_COLUMNS) <= table.keys():
        pose = np.column_stack([table[name] for name in POSE_COLUMNS])
        moving = replace(moving, pose=BasePose(pose[:, :3], pose[:, 3:]))
    external = external_of({name: table[name] for name in external_columns(columns, "")}, {})
    return Recording(table["time"], **arrays, joint_names=joints, base=moving, **external)
