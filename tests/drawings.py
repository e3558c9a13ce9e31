"""What a scene's commands put where, worked out as a browser does: by the tree of paths."""

import base64
import json
import re
import zlib

import numpy as np
from scipy.spatial.transform import Rotation

import exoid
from exoid import Leg
from exoid.leg.description import describe


def places(scene, time=None):
    """Place of every path that a command names, in the world, (4, 4); of a replay, at a time [s]."""
    local = {}
    for command in scene.commands:
        if command["type"] == "set_transform":
            local[command["path"]] = np.array(command["matrix"]).reshape(4, 4).T
        elif command["type"] == "set_object":
            local.setdefault(command["path"], np.eye(4))
        elif command["type"] == "set_animation" and time is not None:
            for animation in command["animations"]:
                local[animation["path"]] = animated(local.get(animation["path"], np.eye(4)), animation["clip"], time)
    return {path: _chain(local, path) for path in local}


def animated(still, clip, time):
    """Place in an animation: what its tracks say, and the rest as it stood."""
    rotation, scale, position = still[:3, :3], np.ones(3), still[:3, 3]
    for track in clip["tracks"]:
        frame = round(time * clip["fps"])
        assert track["keys"][frame]["time"] == frame
        value = np.array(track["keys"][frame]["value"])
        if track["name"] == ".position":
            position = value
        elif track["name"] == ".scale":
            rotation, scale = np.eye(3), value
        else:
            rotation = Rotation.from_quat(value).as_matrix()
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation * scale, position
    return out


def objects(scene):
    """Three.js object at each path."""
    return {c["path"]: c["object"] for c in scene.commands if c["type"] == "set_object"}


def mounts(scene):
    """Path of the frame of each joint, leg by leg; its body is the child "body"."""
    return [path.removesuffix("/axis") for path in objects(scene) if path.endswith("/axis")]


def root(scene):
    """Path of the torso of the first leg."""
    return "/".join(mounts(scene)[0].split("/")[:3])


def meshes(drawn):
    """Geometry, material and place of each mesh of a three.js object."""
    geometries = {g["uuid"]: g for g in drawn["geometries"]}
    materials = {m["uuid"]: m for m in drawn["materials"]}
    return [
        (geometries[mesh["geometry"]], materials[mesh["material"]], np.array(mesh["matrix"]).reshape(4, 4).T)
        for mesh in drawn["object"]["children"]
    ]


def unpacked(html, name):
    """Text of a packed script in a page."""
    (packed,) = re.findall(rf'<script id="{name}" type="text/plain">([^<]*)</script>', html)
    return zlib.decompress(base64.b64decode(packed)).decode()


def scene_of(html):
    """The scene in a page."""
    return json.loads(unpacked(html, "scene"))


def _chain(local, path):
    names = path.split("/")[1:]
    out = np.eye(4)
    for end in range(1, len(names) + 1):
        out = out @ local.get("/" + "/".join(names[:end]), np.eye(4))
    return out


SHANK = "/exoid/left leg/left_hip/body/left_knee/body/shape"
"""Path of the shank's visuals."""


def leg_with(visual, materials=""):
    """BLEEX's left leg whose shank has these elements instead of its own visuals."""
    text = exoid.load_leg("bleex").description.text
    shank = r'(<link name="left_shank">).*?(<inertial>.*?</inertial>).*?</link>'
    text = re.sub(shank, lambda found: f"{found[1]}{found[2]}{visual}</link>", text, flags=re.DOTALL)
    text = re.sub(r"(<robot [^>]*>)", lambda found: found[1] + materials, text, count=1)
    return Leg.from_description(describe(text), ("left_hip", "left_knee", "left_ankle"))


def mesh_visual(filename, inside=""):
    return f'<visual><geometry><mesh filename="{filename}"/></geometry>{inside}</visual>'
