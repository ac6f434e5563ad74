"""Losses of one's own, differentiated through the velocities by JAX."""

import numpy as np
import pytest

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)

from voronudge.jax import velocities  # noqa: E402


def test_gradients_are_differences():
    rng = np.random.default_rng(2)
    positions = jax.numpy.asarray(rng.uniform(0, 6, (36, 2)))
    measured = jax.numpy.asarray(rng.normal(size=(36, 2)))

    @jax.jit
    def loss(positions, parameters):
        return ((velocities(positions, parameters, (6.0, 6.0)) - measured) ** 2).mean()

    parameters = {"alpha": 0.4, "P_0": 3.8}
    by_position, by_parameter = jax.grad(loss, argnums=(0, 1))(positions, parameters)
    h = 1e-6
    for name in parameters:
        ends = [loss(positions, {**parameters, name: parameters[name] + sign * h}) for sign in (1, -1)]
        assert np.isclose(by_parameter[name], (ends[0] - ends[1]) / (2 * h), rtol=1e-6)
    step = rng.normal(size=(36, 2))
    ends = [loss(positions + sign * h * step, parameters) for sign in (1, -1)]
    assert np.isclose((by_position * step).sum(), (ends[0] - ends[1]) / (2 * h), rtol=1e-6)
