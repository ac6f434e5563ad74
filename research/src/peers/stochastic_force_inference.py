"""StochasticForceInference 2 on the sets of `cargo xtask peers`.

    python stochastic_force_inference.py [--parametric] FOLDER...

Each folder holds unwrapped.npy (frames, cells, 2), rings.npy (frames, cells, places for neighbours, 3), columns.npy
(frames, cells, 2, columns) and interval.npy. Writes rival.json into it: coefficients of all columns, with the
base model alone and after PASTIS, by the linear estimator in its form that is robust against errors of positions and
in that for clean data (left alone, the package takes one of the two, which is written as "choice"); with --parametric
also by the estimator that models these errors, which takes minutes for each set.

The columns are written here once more, in JAX and differentiable in the positions, because the estimators need
derivatives; who is next to whom is what it was in the frame at the beginning of an interval. The largest difference
from columns.npy, relative to the size of the column, is written too.
"""

import json
import sys
import time
from pathlib import Path

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp  # noqa: E402
from SFI import OverdampedLangevinInference, TrajectoryCollection, __version__  # noqa: E402
from SFI.statefunc import Basis  # noqa: E402
from SFI.statefunc.nodes.leaf import BaseLeaf  # noqa: E402
from SFI.trajectory import time_series_extra  # noqa: E402

BASE = 4
HOW = ["robust", "clean"]


def turned(f):
    return jnp.stack([-f[..., 1], f[..., 0]], axis=-1)


def corners(x, ring, image, following):
    """Vertices of the polygon of each cell (cells, slots, 2): circumcentres of it and two neighbours."""
    other = x[ring] + image - x[:, None, :]
    after = jnp.take_along_axis(other, following[..., None], axis=1)
    # Slots that only repeat the last neighbour repeat the last vertex.
    last = jnp.argmax(following == 0, axis=1)
    slot = jnp.minimum(jnp.arange(ring.shape[1])[None, :], last[:, None])
    a = jnp.take_along_axis(other, slot[..., None], axis=1)
    b = jnp.take_along_axis(after, slot[..., None], axis=1)
    double = 2.0 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
    aa, bb = jnp.sum(a * a, axis=-1), jnp.sum(b * b, axis=-1)
    centre = jnp.stack([b[..., 1] * aa - a[..., 1] * bb, a[..., 0] * bb - b[..., 0] * aa], axis=-1)
    return centre / double[..., None] + x[:, None, :]


def shapes(v):
    """Perimeters and areas of polygons, and what they and the squares of the sides change by with each vertex."""
    along = jnp.roll(v, -1, axis=1) - v
    square = jnp.sum(along * along, axis=-1)
    length = jnp.where(square > 0, jnp.sqrt(jnp.where(square > 0, square, 1.0)), 0.0)
    unit = along / jnp.where(square > 0, length, 1.0)[..., None]
    after, before = jnp.roll(v, -1, axis=1), jnp.roll(v, 1, axis=1)
    area = 0.5 * jnp.sum(v[..., 0] * after[..., 1] - v[..., 1] * after[..., 0], axis=1)
    dp = jnp.roll(unit, 1, axis=1) - unit
    da = -0.5 * turned(after - before)
    dl = jnp.roll(along, 1, axis=1) - along
    return jnp.sum(length, axis=1), area, dp, da, dl


def columns(x, extras):
    ring = extras["ring"].astype(int)
    following = extras["following"].astype(int)
    v, back = jax.vjp(lambda x: corners(x, ring, extras["image"], following), x)
    # About the cells, so that areas keep their digits.
    p, a, dp, da, dl = shapes(v - x[:, None, :])
    p, a = p[:, None, None], a[:, None, None]
    z = extras["neighbours"][:, None, None]
    forces = [
        -(a - 1) * da,
        dp,
        -p * dp,
        p * turned(dp),
        -turned(dp),
        (a - 1) * turned(da),
        (a - 1) * p * turned(dp),
        -((a - 1) ** 2) * da,
        (z - 6) * dp,
        -dl,
    ]
    fields = jax.vmap(lambda force: back(force)[0])(jnp.stack(forces))
    drift = jnp.broadcast_to(jnp.eye(2)[:, None, :], (2, *x.shape))
    # The order of columns.npy: base, drift, the others.
    return jnp.moveaxis(jnp.concatenate([fields[:BASE], drift, fields[BASE:]]), 0, -1)


def basis(chosen):
    """Some columns as a basis of all cells together."""
    leaf = BaseLeaf(
        func=lambda x, extras: columns(x, extras)[..., np.asarray(chosen)],
        rank=1,
        dim=2,
        n_features=len(chosen),
        pdepth=1,
        particles_input=True,
        extras_keys=("ring", "image", "following", "neighbours"),
    )
    return Basis(leaf)


def movie(folder):
    x = np.load(folder / "unwrapped.npy")
    rings = np.load(folder / "rings.npy")
    ring = rings[..., 0].astype(int)
    slots = ring.shape[2]
    # Slots behind the last neighbour repeat it.
    same = (rings[:, :, 1:] == rings[:, :, :-1]).all(axis=-1)
    count = slots - same[:, :, ::-1].cumprod(axis=2).sum(axis=2)
    following = np.minimum(np.arange(slots) + 1, slots - 1)[None, None, :] + 0 * ring
    following = np.where(np.arange(slots) >= count[..., None] - 1, 0, following)
    extras = {
        "ring": ring,
        "image": rings[..., 1:],
        "following": following,
        "neighbours": count.astype(float),
    }
    return x, extras


def fit(data, chosen, how):
    inference = OverdampedLangevinInference(data)
    if how == "parametric":
        inference.infer_force(basis(chosen))
    else:
        inference.compute_diffusion_constant()
        inference.infer_force_linear(basis(chosen), preset=how)
    return inference


def spread(coefficients, chosen, count):
    every = np.zeros(count)
    every[np.asarray(chosen)] = np.asarray(coefficients)
    return every.tolist()


def judge(folder):
    x, extras = movie(folder)
    exact = np.load(folder / "columns.npy")
    count = exact.shape[-1]
    mine = np.stack([columns(jnp.asarray(x[f]), {k: jnp.asarray(e[f]) for k, e in extras.items()}) for f in range(len(x))])
    size = np.sqrt((exact**2).mean(axis=(0, 1, 2)))
    found = {"version": __version__, "difference": float((np.abs(mine - exact).max(axis=(0, 1, 2)) / size).max())}
    wrapped = {key: time_series_extra(value) for key, value in extras.items()}
    data = TrajectoryCollection.from_arrays(X=x, dt=float(np.load(folder / "interval.npy")[0]), extras_global=wrapped)
    own = OverdampedLangevinInference(data)
    own.compute_diffusion_constant()
    found["choice"] = "robust" if own.Lambda_trace > 0 else "clean"
    for how in HOW:
        begun = time.time()
        try:
            before = fit(data, list(range(BASE)), how)
            all_columns = list(range(count))
            after = fit(data, all_columns, how)
            base = spread(before.force_coefficients, range(BASE), count)
            after.sparsify_force(criterion="PASTIS")
            support = [int(k) for k in np.asarray(after.force_support)]
            chosen = np.asarray(after.force_coefficients).ravel()
            if len(chosen) == count:
                chosen = chosen[np.asarray(support)]
            found[how] = {"before": base, "after": spread(chosen, support, count)}
        except Exception as error:  # A method that fails on a set has found nothing.
            found[how] = {"error": f"{type(error).__name__}: {error}"[:300]}
        found[how]["seconds"] = time.time() - begun
    (folder / "rival.json").write_text(json.dumps(found, indent=1))
    print(folder.name, json.dumps({how: found[how].get("error", "ok") for how in HOW}), file=sys.stderr, flush=True)


if __name__ == "__main__":
    names = sys.argv[1:]
    if "--parametric" in names:
        names.remove("--parametric")
        HOW.append("parametric")
    for name in names:
        judge(Path(name))
