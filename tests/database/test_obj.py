"""OBJ files as registered meshes."""

import numpy as np
import pytest
from tiny_head import FACES, VERTICES, write_obj

from sketchwidget.database.obj import read_obj, read_registered
from sketchwidget.face import Template


@pytest.fixture
def file(tmp_path):
    write_obj(tmp_path / "head.obj")
    return tmp_path / "head.obj"


def test_vertices_stay_in_order_and_quads_whole(file):
    mesh = read_obj(file)
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    assert mesh.quads[0].tolist() == FACES[0]


def test_triangle_repeats_its_third_corner(file):
    assert read_obj(file).quads[-1].tolist() == [72, 73, 74, 74]


def test_texture_normals_colours_and_exponents_are_understood(tmp_path):
    file = tmp_path / "a.obj"
    file.write_text("v 1e0 2 3 0.5 0.5 0.5\nv\t4 5 6 1 1 1\nv 7 8 9 0 0 0\nvn 0 0 1\nf 1/7/1 2//1 3\n")
    mesh = read_obj(file)
    np.testing.assert_array_equal(mesh.vertices, [[1, 2, 3], [4, 5, 6], [7, 8, 9]])
    assert mesh.quads.tolist() == [[0, 1, 2, 2]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello", "it has 0 vertices and 0 faces"),
        ("\x00\xff", "no OBJ"),
        ("v 0 0 0\n", "1 vertices and 0 faces"),
        ("v 0 0\nf 1 1 1\n", "a vertex is three numbers"),
        ("v a b c\nf 1 1 1\n", "a vertex is three numbers"),
        ("v 0 0 0\nf 1 1 x\n", "a face three or four whole ones"),
        ("v 0 0 0\nf 1 1 1 1 1\n", "three or four corners"),
        ("v 0 0 0\nf 1 1\n", "three or four corners"),
        ("v 0 0 0\nf 1 1 1\nf 1 1\n", "three or four whole ones"),
        ("v 0 0 0\nf 1 1 2\n", "among its 1 vertices"),
        ("v 0 0 0\nf 1 1 -1\n", "counted from 1"),
        ("v 0 0 0\nv 0 nan 0\nf 1 2 1\n", "vertex 2 is at"),
        ("v 0 0 inf\nf 1 1 1\n", "vertex 1 is at"),
    ],
)
def test_what_is_no_mesh_is_refused_by_name(tmp_path, text, message):
    (tmp_path / "odd.obj").write_text(text)
    with pytest.raises(ValueError, match=r"odd\.obj.*" + message):
        read_obj(tmp_path / "odd.obj")


def test_another_topology_is_refused(file, tmp_path):
    first = read_obj(file)
    write_obj(tmp_path / "more.obj", [*VERTICES, [0, 0, 0]])
    with pytest.raises(ValueError, match=r"more\.obj has 76 vertices and .*head\.obj has 75"):
        read_registered(tmp_path / "more.obj", first)
    write_obj(tmp_path / "turned.obj", faces=[*FACES[1:], FACES[0]])
    with pytest.raises(ValueError, match=r"turned\.obj has other faces"):
        read_registered(tmp_path / "turned.obj", first)
    with pytest.raises(FileNotFoundError, match=r"none\.obj"):
        read_registered(tmp_path / "none.obj", first)


def test_only_quads_are_refined_and_a_mesh_that_is_not_stays_as_it_is():
    quads, parts = np.array([[0, 1, 2, 3], [3, 2, 4, 4]]), np.array([0, 0, 0, 1, 1], dtype=np.uint8)
    landmarks = np.zeros(68, dtype=np.int32)
    template = Template(quads, parts, {}, landmarks, refined=False)
    assert template.faces.tolist() == [[0, 1, 2], [3, 2, 4], [0, 2, 3]]
    np.testing.assert_array_equal(template.subdivision.toarray(), np.eye(5))
    np.testing.assert_array_equal(template.fine_parts, parts)
    with pytest.raises(ValueError, match="given one with 1 triangles"):
        Template(quads, parts, {}, landmarks)
