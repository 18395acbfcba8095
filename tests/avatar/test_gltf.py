import json
import shutil
import struct
import subprocess
import sysconfig
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sketchwidget.avatar.neck import neck_cap
from sketchwidget.avatar.performance import performances

_VALIDATE = """const validator = require('gltf-validator'), fs = require('fs');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))
  .then(report => console.log(JSON.stringify(report.issues)));"""


@pytest.fixture(scope="module")
def file(avatar, tmp_path_factory):
    path = tmp_path_factory.mktemp("glb") / "head.glb"
    avatar.export(path)
    return path


@pytest.fixture(scope="module")
def document(file):
    data = file.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length])


def test_every_expression_is_a_target_by_arkits_name(document, template):
    meshes = {mesh["name"]: mesh for mesh in document["meshes"]}
    assert tuple(meshes["head"]["extras"]["targetNames"]) == template.action_names
    assert len(meshes["head"]["primitives"][0]["targets"]) == 52
    assert meshes["left_eye"]["extras"]["targetNames"] == [
        "eyeLookUpLeft",
        "eyeLookDownLeft",
        "eyeLookInLeft",
        "eyeLookOutLeft",
    ]


def test_ready_performances_are_animations(document):
    assert [animation["name"] for animation in document["animations"]] == list(performances())
    for animation in document["animations"]:
        assert animation["channels"] and all(
            channel["target"]["path"] == "weights" for channel in animation["channels"]
        )


def test_trimesh_reads_the_same_head(avatar, file):
    scene = trimesh.load(file)
    assert set(scene.geometry) == {"head", "left_eye", "right_eye"}
    head = scene.geometry["head"]
    cut = len(np.unique(neck_cap(avatar.model)))
    count = len(avatar.face.vertices) - sum(len(eye.vertices) for eye in avatar.eyes) + cut
    assert head.vertices.shape == (count, 3) and head.visual.material.baseColorTexture.size == avatar.texture.shape[:2]
    assert np.allclose(scene.extents * 1000, np.ptp(avatar.face.vertices, axis=0), atol=0.01)


ROUNDING_MM = 0.5 * 1000 / 2**15 + 2e-6  # half a step of the file's grid, and what float32 may be off


def test_targets_in_the_file_are_the_rig(avatar, document, file):
    """Sparse displacements read back by hand."""
    data = file.read_bytes()
    start = 20 + struct.unpack("<I", data[12:16])[0] + 8
    mesh = document["meshes"][0]
    number = mesh["extras"]["targetNames"].index("jawOpen")
    sparse = document["accessors"][mesh["primitives"][0]["targets"][number]["POSITION"]]["sparse"]

    def read(view, kind):
        view = document["bufferViews"][view]
        return np.frombuffer(data, kind, view["byteLength"] // 4, start + view["byteOffset"])

    moved = read(sparse["values"]["bufferView"], np.float32).reshape(-1, 3)
    members = np.delete(np.arange(len(avatar.face.vertices)), np.concatenate([eye.vertices for eye in avatar.eyes]))
    members = np.concatenate([members, np.unique(neck_cap(avatar.model))])
    at = members[read(sparse["indices"]["bufferView"], np.uint32)]
    assert np.allclose(moved * 1000, avatar.rig["jawOpen"][at], rtol=0, atol=ROUNDING_MM)
    others = np.setdiff1d(members, at)
    assert np.abs(avatar.rig["jawOpen"][others]).max() <= ROUNDING_MM


def test_the_skin_is_closed_at_the_neck(avatar):
    """Only the slits of eyes and mouth are open: below the chin no edge has a triangle on one side only."""
    model = avatar.model
    skin = model.template.fine_parts == 0
    faces = np.concatenate([model.faces[skin[model.faces].all(axis=1)], neck_cap(model)])
    edges, count = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0, return_counts=True)
    border = edges[count == 1]
    assert count.max() == 2
    assert model.mean[border, 1].min() > model.mean[model.landmarks[8], 1] - 1
    a, b, c = (model.mean[neck_cap(model)[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 1] < 1e-6).all()


def test_only_glb_holds_an_avatar(avatar, tmp_path):
    with pytest.raises(ValueError, match=r"\.glb"):
        avatar.export(tmp_path / "head.obj")


def test_the_khronos_validator_finds_nothing(file, tmp_path_factory):
    scripts = sysconfig.get_path("scripts")  # where the wheel of Node.js puts it
    node, npm = (shutil.which(name) or shutil.which(name, path=scripts) for name in ("node", "npm"))
    if not node or not npm:
        pytest.skip("Node.js is not here")
    folder = tmp_path_factory.mktemp("node")
    got = subprocess.run(
        [npm, "install", "--prefix", folder, "--no-audit", "--no-fund", "gltf-validator@2.0.0-dev.3.10"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    if got.returncode or not Path(folder, "node_modules", "gltf-validator").is_dir():
        pytest.skip("npm does not reach gltf-validator")
    result = subprocess.run([node, "-e", _VALIDATE, file], cwd=folder, capture_output=True, text=True, check=True)
    issues = json.loads(result.stdout)
    assert issues["numErrors"] == 0 and issues["numWarnings"] == 0, issues["messages"]
