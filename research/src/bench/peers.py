"""Rows of the table for tessellations by scipy and freud, of as many points: those that are installed."""
import sys
import time

try:
    import numpy as np
except ImportError:
    sys.exit("numpy is not installed for this Python")


def scipy_delaunay(points, side):
    from scipy.spatial import Delaunay

    return lambda: Delaunay(points)


def freud_voronoi(points, side):
    import freud

    box, r = freud.box.Box.square(side), np.c_[points - side / 2, np.zeros(len(points))]
    freud.parallel.set_num_threads(1)
    return lambda: freud.locality.Voronoi().compute((box, r))


for peer in (scipy_delaunay, freud_voronoi):
    for cells in map(int, sys.argv[1:]):
        side = cells**0.5
        points = np.random.default_rng(7).uniform(0, side, (cells, 2))
        try:
            once = peer(points, side)
        except ImportError as missing:
            print(f"{missing.name} is not installed for this Python", file=sys.stderr)
            break
        times = []
        while len(times) < 3 or (sum(times) < 1.5 and len(times) < 1000):
            start = time.perf_counter()
            once()
            times.append(time.perf_counter() - start)
            if sum(times) > 12:
                break
        least, median = (1e9 * t / cells for t in (min(times), sorted(times)[len(times) // 2]))
        print(f"| {peer.__name__.replace('_', ', ')} | {cells} | 1 | {least:.1f} | {median:.1f} | | |")
