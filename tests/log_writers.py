"""Logs of every kind, written by the libraries that others write them with."""

import numpy as np
import polars
import scipy
from rosbags import rosbag1, rosbag2
from rosbags.rosbag2 import StoragePlugin
from rosbags.typesys import Stores, get_typestore

JOINT_STATE = "sensor_msgs/msg/JointState"
FIELDS = ("q", "v", "a", "tau")


def arrays(recording):
    """Matrices of a recording by name, those it has."""
    return {name: getattr(recording, name) for name in FIELDS if getattr(recording, name) is not None}


def named_columns(recording):
    """One array a column, named as in a CSV file."""
    columns = {"time": recording.time}
    for quantity, values in arrays(recording).items():
        columns |= {f"{quantity}_{joint}": values[:, k] for k, joint in enumerate(recording.joint_names)}
    return columns


def write_opensim(path, time, columns, *, degrees=False, header=None, separator="\t"):
    """Write a motion or storage file as OpenSim does.

    Args:
        path: The file.
        time: Time stamps.
        columns: Columns by name.
        degrees: Whether the header says that angles are in degrees; columns are written as they are.
        header: Other lines in the place of the usual ones, between the name and ``endheader``.
        separator: Between cells.
    """
    usual = [
        "version=1",
        f"nRows={len(time)}",
        f"nColumns={len(columns) + 1}",
        f"inDegrees={'yes' if degrees else 'no'}",
        "",
        "Units are S.I. units (second, meters, Newtons, ...)",
        "If the header above contains a line with 'inDegrees', this indicates whether rotational values are in degrees "
        "(yes) or radians (no).",
        "",
    ]
    table = np.column_stack([time, *columns.values()])
    rows = [separator.join(map(repr, row)) for row in table.tolist()]
    lines = ["Coordinates", *(usual if header is None else header), "endheader", separator.join(["time", *columns])]
    path.write_text("\n".join([*lines, *rows]) + "\n", encoding="utf-8")


def write_npz(path, recording):
    with path.open("wb") as file:
        np.savez_compressed(file, time=recording.time, joint_names=recording.joint_names, **arrays(recording))


def write_mat(path, recording):
    """Variables, time as MATLAB's column."""
    cell = np.array(recording.joint_names, dtype=object)
    scipy.io.savemat(path, {"time": recording.time[:, None], "joint_names": cell, **arrays(recording)})


def write_mat_struct(path, recording):
    """One struct, matrices with joints first, compressed."""
    fields = {name: values.T for name, values in arrays(recording).items()}
    fields |= {"time": recording.time, "joint_names": list(recording.joint_names), "operator": "N. N."}
    scipy.io.savemat(path, {"log": fields}, do_compression=True)


def joint_state(store, stamp, names, position, velocity=(), effort=()):
    """One message; ``stamp`` in nanoseconds."""
    time = store.types["builtin_interfaces/msg/Time"](sec=int(stamp // 10**9), nanosec=int(stamp % 10**9))
    given = {"seq": 0} if "seq" in store.types["std_msgs/msg/Header"].__dataclass_fields__ else {}
    header = store.types["std_msgs/msg/Header"](stamp=time, frame_id="", **given)
    values = (np.array(x, dtype=np.float64) for x in (position, velocity, effort))
    return store.types[JOINT_STATE](header, list(names), *values)


def messages(recording, *, start=1_700_000_000 * 10**9):
    """Stamps and fields of the messages that a recording would be."""
    stamps = start + np.round((recording.time - recording.time[0]) * 1e9).astype(np.int64)
    empty = np.empty((len(recording), 0))
    v, tau = (empty if values is None else values for values in (recording.v, recording.tau))
    return [
        (int(stamp), recording.joint_names, *fields) for stamp, *fields in zip(stamps, recording.q, v, tau, strict=True)
    ]


def write_bag(path, topics, *, plugin=StoragePlugin.MCAP, late=0, compress=None):
    """Write a rosbag2.

    Args:
        path: The folder.
        topics: For each topic its messages, as :func:`messages` makes them, or a string for a topic of text.
        plugin: Of the storage.
        late: How long after its stamp a message is received [ns].
        compress: How messages are compressed; None for not at all.
    """
    store = get_typestore(Stores.ROS2_HUMBLE)
    bag = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    if compress is not None:
        bag.set_compression(compress, rosbag2.CompressionFormat.ZSTD)
    with bag:
        for topic, content in topics.items():
            kind = "std_msgs/msg/String" if isinstance(content, str) else JOINT_STATE
            connection = bag.add_connection(topic, kind, typestore=store)
            if isinstance(content, str):
                message = store.types[kind](content)
                bag.write(connection, 1, store.serialize_cdr(message, kind))
                continue
            for stamp, *fields in content:
                raw = store.serialize_cdr(joint_state(store, stamp, *fields), kind)
                bag.write(connection, stamp + late, raw)


def write_bag1(path, content, *, compress=False):
    """Write a ROS 1 bag of messages."""
    store = get_typestore(Stores.ROS1_NOETIC)
    bag = rosbag1.Writer(path)
    if compress:
        bag.set_compression(rosbag1.Writer.CompressionFormat.LZ4)
    with bag:
        connection = bag.add_connection("/joint_states", JOINT_STATE, typestore=store)
        for stamp, *fields in content:
            bag.write(connection, stamp, store.serialize_ros1(joint_state(store, stamp, *fields), JOINT_STATE))


PLATE = ("ground_force_1_v", "ground_force_1_p", "ground_torque_1_")


def plate(force, point, moment, names=PLATE):
    """Columns of a force plate of OpenSim, x forward, y up, z right, of vectors in axes x forward, y left, z up."""
    return {
        f"{name}{axis}": column
        for name, vectors in zip(names, (force, point, moment), strict=True)
        for axis, column in zip("xyz", (vectors[:, 0], vectors[:, 2], -vectors[:, 1]), strict=True)
    }


def write_columns(path, **columns):
    """Write columns in the format that the ending of the file names."""
    if path.suffix == ".npz":
        np.savez(path, **columns)
    elif path.suffix == ".mat":
        scipy.io.savemat(path, columns)
    elif path.suffix == ".parquet":
        polars.DataFrame(columns).write_parquet(path)
    else:
        table, header = np.column_stack(list(columns.values())), ",".join(columns)
        np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.17g", encoding="utf-8")
    return path


WRITERS = {
    "log.parquet": lambda path, log: write_columns(path, **named_columns(log)),
    "log.npz": write_npz,
    "columns.npz": lambda path, log: write_columns(path, **named_columns(log)),
    "log.mat": write_mat,
    "struct.mat": write_mat_struct,
    "mcap_bag": lambda path, log: write_bag(path, {"/joint_states": messages(log), "/chatter": "hello"}),
    "sqlite_bag": lambda path, log: write_bag(path, {"/joint_states": messages(log)}, plugin=StoragePlugin.SQLITE3),
    "ros1.bag": lambda path, log: write_bag1(path, messages(log)),
}
"""Every kind, by the name of a file of it; bags have no accelerations, and their time starts at zero."""

BAGS = ("mcap_bag", "sqlite_bag", "ros1.bag")
