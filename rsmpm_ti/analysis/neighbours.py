"""Which points lie near each other, and the sets that hang together through neighbours. NumPy and SciPy only."""

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


def pairs_within(x: np.ndarray, reach: float, p: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """Indices (a, b), a < b, of all pairs of points x [n, dim] at most `reach` apart, in the norm p; each pair once."""
    a, b = cKDTree(x).query_pairs(reach, p=p, output_type="ndarray").reshape(-1, 2).T
    return a, b


def components(count: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Label of the connected set of each of `count` points, [count], of which a[k] and b[k] are joined."""
    if count == 0:
        return np.zeros(0, dtype=int)
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def neighbour_graph(x: np.ndarray, reach: float) -> csr_array:
    """Distances [m] between points x [n, dim] at most `reach` apart, [n, n], each pair once."""
    a, b = pairs_within(x, reach)
    # a particle may fail twice in one position, and an edge of length 0 would be no edge
    length = np.maximum(np.linalg.norm(x[a] - x[b], axis=1), 1e-9 * reach)
    a, b = a.astype(np.int32), b.astype(np.int32)  # dijkstra of SciPy 1.13 takes no other indices
    return csr_array(coo_array((length, (a, b)), shape=(len(x), len(x))))


def bands_of(graph: csr_array) -> np.ndarray:
    """Label of the connected set of each point of a neighbour graph, [n]."""
    return connected_components(graph, directed=False)[1]
