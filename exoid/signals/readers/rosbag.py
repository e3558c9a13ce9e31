"""``sensor_msgs/JointState`` in ROS bags: rosbag2 folders, MCAP and sqlite3 files, and ROS 1 bags."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.tools.file_bounds import most_memory, reading, refuse_expansion, size_on_disk
from exoid.tools.reader_process import read_in_child

from .options import ReadRequest
from .table import Table, array_table, needs

JOINT_STATE = "sensor_msgs/msg/JointState"

FIELDS = {"q": "position", "v": "velocity", "tau": "effort"}

REMEDY = "check that the recorder closed the bag (ros2 bag reindex), and that folder and metadata.yaml belong together"


class _Message(NamedTuple):
    """One JointState."""

    number: int
    stamp: int
    joints: tuple[str, ...]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    effort: NDArray[np.float64]


def read_rosbag(file: str, request: ReadRequest) -> Table:
    """Read the joint states of one topic: ``time``, ``q_<joint>`` and, where given, ``v_`` and ``tau_``."""
    # Time starts at the first message. Messages may list their joints in any order. Messages without any
    # requested joint are skipped. A field that is empty or NaN in all messages was not measured. Message
    # definitions stored in the bag are ignored.
    if find_spec("rosbags") is None:
        raise needs("rosbags", "bags")
    with reading("a bag", REMEDY):
        wanted: ReadRequest = {"joint_names": None, "columns": {}, "topic": None, "stamps": "header", **request}
        needed = {key: wanted[key] for key in ("joint_names", "columns", "topic", "stamps")}
        numbers, columns = read_in_child(bag_columns, file, request=needed)
        return array_table(file, columns, numbers, "message")


def bag_columns(file: str, request: ReadRequest) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Read numbers of messages and columns in this process, whose memory a compressed bag may fill."""
    with reading("a bag", REMEDY):
        messages = list(_messages(Path(file), request))
    if not messages:
        raise UnreadableInputError("no joint states in the topic", remedy="choose another topic")
    joints, messages = _common_joints(messages, request)
    numbers = np.array([message.number for message in messages])
    columns: dict[str, NDArray[Any]] = {"time": _seconds(messages, request)}
    for symbol, field in FIELDS.items():
        values = _matrix(messages, joints, field)
        if values is not None:
            columns.update({f"{symbol}_{joint}": column for joint, column in zip(joints, values.T, strict=True)})
    return numbers, columns


def _messages(path: Path, request: ReadRequest) -> Iterator[_Message]:
    """Joint states of the topic, numbered from 0."""
    from rosbags import rosbag1, rosbag2  # noqa: PLC0415 - an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415

    first = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    decode = store.deserialize_ros1 if first else store.deserialize_cdr
    with (rosbag1.Reader if first else rosbag2.Reader)(path) as bag:
        topic = _topic({connection.topic: connection.msgtype for connection in bag.connections}, request.get("topic"))
        chosen = [connection for connection in bag.connections if connection.topic == topic]
        size, room = 0, most_memory(size_on_disk(path))
        for number, (_, received, raw) in enumerate(bag.messages(connections=chosen)):
            size += len(raw)
            if size > room:
                refuse_expansion(size, path)
            state: Any = decode(raw, JOINT_STATE)
            stamp = state.header.stamp
            since = received if request["stamps"] == "received" else int(stamp.sec) * 10**9 + int(stamp.nanosec)
            fields = (np.array(getattr(state, field), dtype=np.float64) for field in FIELDS.values())
            yield _Message(number, since, tuple(state.name), *fields)


def _topic(kinds: Mapping[str, str], asked: str | None) -> str:
    """Select the requested topic, or the only one of joint states."""
    fit = [topic for topic, kind in kinds.items() if kind == JOINT_STATE]
    listed = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(kinds.items())[:20]) or "no topics"
    if asked is not None and asked not in fit:
        raise UnreadableInputError(
            f"no topic {asked!r} of {JOINT_STATE}; the bag has: {listed}", remedy="name one of those"
        )
    if asked is None and len(fit) != 1:
        what = f"{len(fit)} topics of joint states: {', '.join(fit)}" if fit else f"no joint states, but: {listed}"
        record = f"record a topic of {JOINT_STATE}"
        remedy, command = ('choose with topic="..." (--topic)', "choose with --topic") if fit else (record, record)
        raise UnreadableInputError(what, remedy=remedy, command=command)
    return asked if asked is not None else fit[0]


def _common_joints(messages: list[_Message], request: ReadRequest) -> tuple[tuple[str, ...], list[_Message]]:
    """Joints to read, and the messages with these joints."""
    layouts = {message.joints: message.number for message in messages}
    for joints, number in layouts.items():
        if len(set(joints)) < len(joints):
            raise UnreadableInputError(
                f"a joint is named twice: {', '.join(joints)}",
                where=f"message {number}",
                remedy="correct the publisher",
            )
    if request["joint_names"] is None:
        if len({frozenset(joints) for joints in layouts}) > 1:
            found = "; ".join(", ".join(joints) for joints in layouts)
            raise UnreadableInputError(
                f"messages hold different joints: {found[:300]}",
                remedy="choose some with joint_names",
                command="record the joints of one publisher, or choose its topic with --topic",
            )
        return messages[0].joints, messages
    every = dict.fromkeys(joint for joints in layouts for joint in joints)
    asked = {request["columns"].get(f"q_{joint}", f"q_{joint}")[2:] for joint in request["joint_names"]}
    joints = tuple(joint for joint in every if joint in asked) or tuple(every)
    kept = [message for message in messages if not set(joints).isdisjoint(message.joints)]
    for message in kept:
        missing = [joint for joint in joints if joint not in message.joints]
        if missing:
            raise UnreadableInputError(
                f"no {', '.join(missing)} beside {', '.join(message.joints)}",
                where=f"message {message.number}",
                remedy="choose joints that one publisher sends together",
            )
    return joints, kept


def _seconds(messages: Sequence[_Message], request: ReadRequest) -> FloatArray:
    """Time since the first message [s]."""
    stamps = np.array([message.stamp for message in messages], dtype=np.int64)
    if request["stamps"] == "header" and not stamps.any():
        raise UnreadableInputError(
            "the headers have no time stamps",
            remedy='pass stamps="received" (--received) to take the time at which the bag received each message',
            command="give --received to take the time at which the bag received each message",
        )
    return np.asarray((stamps - stamps[0]) / 1e9)


def _matrix(messages: Sequence[_Message], joints: Sequence[str], field: str) -> FloatArray | None:
    """One field of all messages, (N, n), joints in one order; None if no message has it."""
    given = np.array([len(getattr(message, field)) > 0 for message in messages])
    if not given.any():
        return None
    if not given.all():
        number = messages[int((~given).argmax())].number
        raise UnreadableInputError(
            f"{field} is empty, but not in all messages",
            where=f"message {number}",
            remedy="choose a topic that always has it",
        )
    out = np.empty((len(messages), len(joints)))
    columns: dict[tuple[str, ...], list[int]] = {}
    for row, message in enumerate(messages):
        values = getattr(message, field)
        if len(values) != len(message.joints):
            raise UnreadableInputError(
                f"{len(values)} values of {field} for {len(message.joints)} joints",
                where=f"message {message.number}",
                remedy="correct the publisher",
            )
        if message.joints not in columns:
            columns[message.joints] = [message.joints.index(joint) for joint in joints]
        out[row] = values[columns[message.joints]]
    return None if np.isnan(out).all() else out
