#!/usr/bin/env python3
"""The cantilever as a solid of any Poisson's ratio: `python3 elasticity.py [NU ...]`, with NumPy and SciPy.

Prints the first frequency of the clamped-free beam of 1 x 0.1 x 0.1 m, and the deflection of its end under a shear traction of
1 kN. A clamp that keeps the section from contracting makes both stiffer, of which beam theory knows nothing. A quarter of
the section, spectral elements of order 4 that are smaller towards the clamp and the sides, 13,020 unknowns.
"""

import sys

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as solve
from numpy.polynomial.legendre import Legendre

E, RHO, LOAD, ORDER = 30e9, 2400.0, 1000.0, 4
ALONG = np.concatenate([[0, 0.005, 0.0125, 0.025, 0.05], np.linspace(0.1, 1, 11)])
ACROSS = np.array([0, 0.04, 0.05])


def points():
    """Places, weights and derivatives of Gauss, Lobatto and Legendre on [-1, 1]."""
    p = Legendre.basis(ORDER)
    x = np.concatenate([[-1], np.sort(p.deriv().roots().real), [1]])
    apart = x[:, None] - x[None, :] + np.eye(ORDER + 1)
    d = p(x)[:, None] / (p(x)[None, :] * apart)
    np.fill_diagonal(d, 0)
    d[0, 0], d[-1, -1] = -ORDER * (ORDER + 1) / 4, ORDER * (ORDER + 1) / 4
    return x, 2 / (ORDER * (ORDER + 1) * p(x) ** 2), d


X, WEIGHT, D = points()


def line(edges):
    inner = [(a + b) / 2 + (b - a) / 2 * X[1:] for a, b in zip(edges[:-1], edges[1:])]
    return np.concatenate([[edges[0]], *inner])


def element(half, tensor):
    """Stiffness of a box, and the volume of its points."""
    one = np.eye(ORDER + 1)
    volume = np.kron(np.kron(WEIGHT, WEIGHT), WEIGHT) * half.prod()
    gradient = [np.kron(np.kron(D, one), one), np.kron(np.kron(one, D), one), np.kron(np.kron(one, one), D)]
    gradient = [g / h for g, h in zip(gradient, half)]
    product = [[a.T @ (volume[:, None] * b) for b in gradient] for a in gradient]
    stiffness = np.einsum("ijkl,jlab->iakb", tensor, np.array(product))
    return stiffness.reshape(3 * len(volume), -1), volume


def beam(nu):
    """First frequency [Hz] and deflection [m]."""
    lam, mu, one = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), np.eye(3)
    tensor = lam * np.einsum("ij,kl->ijkl", one, one)
    tensor += mu * (np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one))
    x, y = line(ALONG), line(ACROSS)
    count = len(x) * len(y) ** 2
    number = np.arange(count).reshape(len(x), len(y), len(y))
    rows, columns, values, mass = [], [], [], np.zeros(3 * count)
    for a, length in enumerate(np.diff(ALONG)):
        for b, width in enumerate(np.diff(ACROSS)):
            for c, height in enumerate(np.diff(ACROSS)):
                stiffness, volume = element(np.array([length, width, height]) / 2, tensor)
                span = [slice(ORDER * i, ORDER * (i + 1) + 1) for i in (a, b, c)]
                nodes = number[tuple(span)].ravel()
                unknowns = np.concatenate([nodes, count + nodes, 2 * count + nodes])
                rows.append(np.repeat(unknowns, len(unknowns)))
                columns.append(np.tile(unknowns, len(unknowns)))
                values.append(stiffness.ravel())
                np.add.at(mass, unknowns, RHO * np.tile(volume, 3))
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    stiffness = sparse.csr_matrix(entries, shape=(3 * count, 3 * count))
    # Bent along y: nothing moves at the clamp, along x and z at y = 0, along z at z = 0.
    held = np.zeros((3, *number.shape), bool)
    held[:, 0], held[0, :, 0], held[2, :, 0], held[2, :, :, 0] = True, True, True, True
    free = np.flatnonzero(~held.ravel())
    stiffness = stiffness[free][:, free].tocsc()
    square = solve.eigsh(stiffness, k=1, M=sparse.diags(mass[free]).tocsc(), sigma=0)[0][0]
    share = np.zeros(len(y))
    for b, width in enumerate(np.diff(ACROSS)):
        share[ORDER * b : ORDER * (b + 1) + 1] += WEIGHT * width / 2 / ACROSS[-1]
    share = np.outer(share, share).ravel()
    load, moved, end = np.zeros(3 * count), np.zeros(3 * count), count + number[-1].ravel()
    load[end] = LOAD / 4 * share
    moved[free] = solve.splu(stiffness).solve(load[free])
    return np.sqrt(square) / (2 * np.pi), moved[end] @ share


for nu in [float(word) for word in sys.argv[1:]] or [0, 0.1, 0.2, 0.3, 0.4]:
    frequency, deflection = beam(nu)
    print(f"nu = {nu:4.2f}: {frequency:.4f} Hz, {1e3 * deflection:.5f} mm")
