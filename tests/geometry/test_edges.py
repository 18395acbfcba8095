import numpy as np

from sketchwidget.geometry.edges import edge_distance, edge_graph, edges

SQUARE = np.array([[0.0, 0, 0], [3, 0, 0], [3, 4, 0], [0, 4, 0], [9, 9, 9]])  # the last vertex is in no triangle
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_each_edge_is_there_once():
    assert sorted(tuple(sorted(edge)) for edge in edges(FACES).tolist()) == [(0, 1), (0, 2), (0, 3), (1, 2), (2, 3)]


def test_the_graph_has_the_lengths():
    graph = edge_graph(SQUARE, FACES).toarray()
    assert graph.sum() == 3 + 4 + 5 + 3 + 4 and (graph + graph.T)[0, 2] == 5


def test_distances_are_along_the_edges():
    np.testing.assert_array_equal(edge_distance(SQUARE, FACES, [1]), [3, 0, 4, 7, np.inf])
    np.testing.assert_array_equal(edge_distance(SQUARE, FACES, [1, 3]), [3, 0, 3, 0, np.inf])
    np.testing.assert_array_equal(edge_distance(SQUARE, FACES, [1], limit=3.5), [3, 0, np.inf, np.inf, np.inf])


def test_nothing_is_near_to_none():
    assert np.isinf(edge_distance(SQUARE, FACES, [])).all()
