"""Velocities as a function that JAX can differentiate.

>>> import jax, jax.numpy as jnp, numpy as np
>>> from voronudge.jax import velocities
>>> jax.config.update("jax_enable_x64", True)
>>> positions = jnp.asarray(np.random.default_rng(1).uniform(0, 6, (36, 2)))
>>> def loss(alpha):
...     return (velocities(positions, {"alpha": alpha, "P_0": 3.8}, (6.0, 6.0)) ** 2).sum()
>>> slope = jax.grad(loss)(0.3)
"""

from __future__ import annotations

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from .tissue import Tissue


def _tissue(positions, box) -> Tissue:
    return Tissue(np.asarray(positions), box)


@partial(jax.custom_vjp, nondiff_argnums=(2,))
def velocities(positions, parameters, box=None):
    """Velocities (N, 2) of cells at positions (N, 2), as `Tissue.velocities` has them, zero for cells without one.

    ``parameters`` is a dict of numbers by the names ``K_A``, ``K_P``, ``P_0`` and ``alpha``; ``box`` is fixed. Derivatives are
    taken at frozen topology. Enable ``jax_enable_x64``: without it all is rounded to single precision.
    """
    return _forward(positions, parameters, box)[0]


def _forward(positions, parameters, box):
    shape = jax.ShapeDtypeStruct(positions.shape, positions.dtype)

    def call(positions, parameters):
        plain = {name: float(value) for name, value in parameters.items()}
        v = _tissue(positions, box).velocities(**plain)
        return np.nan_to_num(v).astype(shape.dtype)

    return jax.pure_callback(call, shape, positions, parameters), (positions, parameters)


def _backward(box, saved, w):
    positions, parameters = saved
    shapes = jax.ShapeDtypeStruct(positions.shape, positions.dtype), {
        name: jax.ShapeDtypeStruct((), jnp.result_type(value)) for name, value in parameters.items()
    }

    def call(positions, parameters, w):
        plain = {name: float(value) for name, value in parameters.items()}
        by_position, by_parameter = _tissue(positions, box).vjp(np.asarray(w), **plain)
        slopes = {name: np.asarray(by_parameter[name], dtype=shapes[1][name].dtype) for name in plain}
        return by_position.astype(shapes[0].dtype), slopes

    return jax.pure_callback(call, shapes, positions, parameters, w)


velocities.defvjp(_forward, _backward)
