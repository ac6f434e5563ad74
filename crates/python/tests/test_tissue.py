"""Arrays in and out: the numbers are those of the program and of an independent code."""

import json
import time

import numpy as np
import pytest
import voronudge
from voronudge import Tissue


@pytest.fixture(scope="module")
def reference(fixtures):
    folder = fixtures / "reference-small"
    truth = json.loads((folder / "parameters.json").read_text())
    arrays = {path.stem: np.load(path) for path in folder.glob("*.npy")}
    return Tissue(arrays["positions"], (5.5, 4.0)), truth, arrays


def random_tissue(cells=64, seed=3):
    side = np.sqrt(cells)
    return Tissue(np.random.default_rng(seed).uniform(0, side, (cells, 2)), (side, side))


def test_all_agrees_with_an_independent_code(reference):
    tissue, parameters, arrays = reference
    assert np.allclose(tissue.velocities(**parameters), arrays["velocities"], rtol=0, atol=1e-10)
    assert np.allclose(tissue.jacobian(**parameters).toarray(), arrays["jacobian"], rtol=0, atol=1e-9)
    assert np.allclose(tissue.areas, arrays["areas"], rtol=0, atol=1e-11)
    assert np.allclose(tissue.perimeters, arrays["perimeters"], rtol=0, atol=1e-11)
    assert np.allclose(tissue.stress(**parameters), arrays["stress"], rtol=0, atol=1e-10)


@pytest.mark.parametrize("effects", [{}, {"drift": [0.1, -0.2], "odd_diffusion": 0.2}])
def test_numbers_are_those_of_the_program_to_the_last_bit(effects):
    tissue = random_tissue()
    parameters = {"P_0": 3.7, "alpha": 0.4}
    report = voronudge.evaluate(
        positions=tissue.positions, box=(8, 8), jacobian=True, effect=effects, quiet=True, **parameters
    )
    found = report.arrays
    assert np.array_equal(found["velocities"], tissue.velocities(effects=effects, **parameters))
    assert np.array_equal(found["jacobian"], tissue.jacobian(effects=effects, **parameters).toarray())
    assert np.array_equal(found["areas"], tissue.areas) and np.array_equal(found["perimeters"], tissue.perimeters)


@pytest.mark.parametrize("effects", [{}, {"drift": [0.1, -0.2], "alpha_area": 0.3}, {"odd_diffusion": 0.2, "internal_drag": 0.5}])
def test_products_with_the_jacobian_are_differences(effects):
    tissue = random_tissue()
    rng = np.random.default_rng(5)
    parameters = {"P_0": 3.9, "alpha": 0.6, "effects": effects}
    step, w = rng.normal(size=(64, 2)), rng.normal(size=(64, 2))
    h = 1e-6
    moved = [Tissue(tissue.positions + sign * h * step, (8, 8)).velocities(**parameters) for sign in (1, -1)]
    difference = (moved[0] - moved[1]) / (2 * h)
    jvp = tissue.jvp(step, **parameters)
    assert np.abs(jvp - difference).max() < 1e-6 * max(1, np.abs(difference).max())
    by_position, by_parameter = tissue.vjp(w, **parameters)
    assert np.isclose((by_position * step).sum(), (jvp * w).sum(), rtol=1e-10)
    dense = tissue.jacobian(**parameters).toarray()
    assert np.allclose(dense.T @ w.ravel(), by_position.ravel(), rtol=1e-10, atol=1e-12)
    assert np.allclose(tissue.jacobian(**parameters).to_scipy() @ step.ravel(), jvp.ravel(), rtol=1e-10, atol=1e-12)

    def loss(name, change, index=None):
        changed = {**parameters, "effects": {id: np.array(v, dtype=float) for id, v in effects.items()}}
        if name in effects:
            if index is None:
                changed["effects"][name] = float(changed["effects"][name] + change)
            else:
                changed["effects"][name][index] += change
        else:
            default = {"K_A": 0.1, "K_P": 1.0}.get(name)
            changed[name] = parameters.get(name, default) + change
        return (tissue.velocities(**changed) * w).sum()

    assert list(by_parameter) == ["K_A", "K_P", "P_0", "alpha", *sorted(effects, key=list(effects).index)]
    for name, slope in by_parameter.items():
        for index, own in enumerate(np.atleast_1d(slope)):
            where = index if np.ndim(slope) else None
            difference = (loss(name, h, where) - loss(name, -h, where)) / (2 * h)
            assert np.isclose(own, difference, rtol=1e-6, atol=1e-6), name


def test_polygons_fill_the_box():
    tissue = random_tissue()
    assert np.isclose(tissue.areas.sum(), 64)
    for polygon, area in zip(tissue.polygons(), tissue.areas):
        x, y = polygon.T
        assert np.isclose(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum(), area)
    indices, starts = tissue.neighbours
    assert starts[-1] == len(indices) == 6 * 64


def test_cells_at_the_rim_of_an_open_field_have_no_velocity():
    positions = np.random.default_rng(1).uniform(0, 12, (144, 2))
    tissue = Tissue(positions)
    v = tissue.velocities(alpha=0.2)
    assert 0 < np.isnan(v).all(axis=1).sum() < 144
    assert tissue.box is None and not tissue.counts[np.isnan(v).any(axis=1)].any()
    by_position, by_parameter = tissue.vjp(np.ones((144, 2)), alpha=0.2)
    assert np.isfinite(by_position).all() and np.isfinite(by_parameter["alpha"])


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Tissue([[0, 0], [1, np.nan], [2, 1]], (3, 3)), "not a usable position"),
        (lambda: Tissue(np.zeros((4, 3)), (3, 3)), r"\(cells, 2\)"),
        (lambda: Tissue(np.zeros(4), (3, 3)), r"\(cells, 2\)"),
        (lambda: Tissue("cells", (3, 3)), "no array of numbers"),
        (lambda: Tissue([[0, 0], [0, 0], [1, 1]], (3, 3)), "same point"),
        (lambda: Tissue(np.eye(2), (3, -3)), "box side y"),
        (lambda: Tissue(np.eye(2), (3, 3, 3)), "two"),
        (lambda: random_tissue().velocities(p0=3), "no parameter 'p0'|no parameter \"p0\""),
        (lambda: random_tissue().velocities(P_0=float("nan")), "P_0 is not a finite number"),
        (lambda: random_tissue().velocities(effects={"drif": 1}), "no effect"),
        (lambda: random_tissue().velocities(effects={"drift": 1}), "1 coefficients are given, but there are 2"),
        (lambda: random_tissue().vjp(np.ones((3, 2))), "3 rows"),
    ],
)
def test_faults_are_told_with_a_hint(make, message):
    with pytest.raises(voronudge.Error, match=message) as caught:
        make()
    assert caught.value.hint and isinstance(caught.value, ValueError)


def test_threads_go_on_beside_a_long_call():
    from concurrent.futures import ThreadPoolExecutor

    tissue = random_tissue(20000)
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(lambda: [tissue.vjp(np.ones((20000, 2))) for _ in range(3)])
        ticks = 0
        while not running.done():
            time.sleep(0.002)
            ticks += 1
    assert ticks > 10


def test_mean_field_theory_has_the_verified_signs():
    table = voronudge.mean_field(P_0=3.5, alpha=0.2)
    assert np.isclose(table["K_odd"], -np.sqrt(3) * 0.2)
    assert table["phase"] == "odd elastic solid"
    assert np.isclose(table["prestress"][0][1], -table["prestress"][1][0])
