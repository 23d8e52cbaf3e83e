#!/usr/bin/env python3
"""A model of weak scaling: what a step costs where every process has the same number of smoothed tetrahedra, for 1 to 1,000 processes.

Measured: compute per tetrahedron and step, by PROGRAM as one process with one thread; memory, by PROGRAM as two and as four processes; latency and bandwidth
between two processes. Counted: what the processes send each other, on a cube that is divided as the program divides it. The rest is
the model, `step_times`. docs/mpi.md has its table and its assumptions.

Needs numpy, MPI and a build with it: `python3 cases/speed/scaling.py target/mpi/release/fractum`. `--count CELLS RANKS` prints the counts of a cube alone, to compare with `run.log`.
"""

import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

import numpy as np

from ranks import CASE, MPIRUN, peaks
from table import run

BLOCK_CELLS, BLOCK_NODES = 2048, 1024
BYTES_PER_SUM = 24  # three numbers for each block that has a node
BYTES_PER_BLOCK = 16  # two energies of each block, in a row of the history
BYTES_PER_CHUNK, CHUNK = 32, 4096  # four sums over as many nodes, in a row
BYTES_PER_FORCE = 24  # on a node that every process moves
BYTES_PER_NODE = 48  # displacement and velocity, in a row that looks at all nodes
BITS = 20
WAYS = ((1, 2, 4), (1, 4, 2), (2, 1, 4), (2, 4, 1), (4, 1, 2), (4, 2, 1))

PING = r"""
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
int main(void) {
    MPI_Init(0, 0);
    int rank, sizes[2] = {8, 1 << 20}, rounds[2] = {2000, 100};
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    for (int k = 0; k < 2; ++k) {
        char *out = calloc(sizes[k], 1), *in = calloc(sizes[k], 1);
        double least = 1e9;
        for (int again = 0; again < 10; ++again) {
            MPI_Barrier(MPI_COMM_WORLD);
            double start = MPI_Wtime();
            for (int i = 0; i < rounds[k]; ++i) {
                MPI_Request both[2];
                MPI_Irecv(in, sizes[k], MPI_BYTE, 1 - rank, 0, MPI_COMM_WORLD, both);
                MPI_Isend(out, sizes[k], MPI_BYTE, 1 - rank, 0, MPI_COMM_WORLD, both + 1);
                MPI_Waitall(2, both, MPI_STATUSES_IGNORE);
            }
            double each = (MPI_Wtime() - start) / rounds[k];
            least = each < least ? each : least;
        }
        if (rank == 0) printf("%.9g\n", least);
    }
    MPI_Finalize();
}
"""


class Network(NamedTuple):
    name: str
    latency: float  # [s]
    bandwidth: float  # [B/s], of one process, both ways at once


class Memory(NamedTuple):
    all: float  # of each tetrahedron, on every process [B]
    divided: float  # of those alone whose cells it has


class Counts(NamedTuple):
    """What the process with most of it has, each by itself."""

    blocks: int  # of all processes
    neighbours: int
    nodes: int  # on the boundary of a share
    sums: int  # sent or received for them
    face_nodes: int  # of the loaded face, which every process moves
    log: str  # as process 0 has it in run.log


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program", nargs="?", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--cells", type=int, nargs="+", default=[100_000, 500_000], help="tetrahedra of each process")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 10, 100, 1000])
    parser.add_argument("--latency", type=float, help="[us] between two processes; measured if left out")
    parser.add_argument("--bandwidth", type=float, help="[GB/s]; measured if left out")
    parser.add_argument("--cluster", type=float, nargs=2, default=[2.0, 1.0], metavar=("US", "GB/S"), help="the second network")
    parser.add_argument("--largest", type=int, default=10_000_000, help="tetrahedra of the largest cube that is counted")
    parser.add_argument("--count", type=int, nargs=2, metavar=("CELLS", "RANKS"), help="print the counts of a cube of CELLS^3 cubes")
    options = parser.parse_args()
    if options.count:
        print(counts(*options.count))
        return
    if options.program is None:
        parser.error("PROGRAM is needed")
    latency, bandwidth, source = between_two(options.latency, options.bandwidth)
    networks = [Network("here", latency, bandwidth), Network("cluster", 1e-6 * options.cluster[0], 1e9 * options.cluster[1])]
    for network in networks:
        print(f"{network.name}: {1e6 * network.latency:.2f} us, {1e-9 * network.bandwidth:.2f} GB/s" + (f" ({source})" if network.name == "here" else " (assumed)"))
    measured = [measure(options.program, side(cells)) for cells in options.cells]
    memory = measure_memory(options.program)
    print(f"memory: {memory.all:.0f} bytes of every tetrahedron on each process, {memory.divided:.0f} of those whose cells it has")
    for cells, compute in zip(options.cells, measured):
        print_table(options, cells, compute, memory, networks)


def print_table(options, cells, compute, memory, networks):
    print(f"\n{cells:,} tetrahedra of each process: {1e9 * compute:.1f} ns per tetrahedron and step\n")
    print("| processes | neighbours | nodes shared | kB sent | compute [ms] | exchange here, cluster [ms] | efficiency here, cluster | with a face loaded | GB of each process |")
    print("|---|---|---|---|---|---|---|---|---|")
    for ranks in options.ranks:
        found = scaled_counts(ranks, cells, options.largest)
        times = [step_times(found, ranks, cells, compute, network) for network in networks]
        work = times[0].compute
        cut = lambda *parts: ", ".join(f"{100 * work / (work + sum(getattr(of, part) for part in parts)):.0f} %" for of in times)
        exchange = ", ".join(f"{1e3 * of.exchange:.2f}" for of in times)
        print(f"| {ranks:,} | {found.neighbours} | {found.nodes:,} | {1e-3 * BYTES_PER_SUM * found.sums:,.0f} | {1e3 * work:.1f} | {exchange}"
              f" | {cut('exchange')} | {cut('exchange', 'faces')}"
              f" | {1e-9 * cells * (memory.divided + memory.all * ranks):,.2f} |", flush=True)
    ranks = options.ranks[-1]
    whole = [step_times(scaled_counts(ranks, cells, options.largest), ranks, cells, compute, network) for network in networks]
    rows, nodes = (", ".join(f"{1e3 * getattr(of, part):,.2f}" for of in whole) for part in ("row", "all_nodes"))
    print(f"\nOn {ranks:,} processes, in addition [ms]: a row of the history {rows}; places and velocities of all nodes, where a probe looks at them, {nodes}.")


class Times(NamedTuple):
    compute: float
    exchange: float  # of the nodes on the boundary, and the word that all processes tell each other
    faces: float  # of the nodes of the loaded face, which every process moves
    row: float  # of energies of all blocks, and sums over all nodes
    all_nodes: float  # of their displacements and velocities


def step_times(found, ranks, cells, compute, network):
    """Seconds of a step [s]. Messages to one process after the other, at once both ways; nothing overlaps with work."""
    if ranks == 1:
        return Times(cells * compute, *[0.0] * 4)
    send = lambda messages, size: messages * network.latency + size / network.bandwidth
    tree, nodes = math.ceil(math.log2(ranks)), cells * ranks / 6
    return Times(
        compute=cells * compute,
        exchange=send(found.neighbours, BYTES_PER_SUM * found.sums) + send(tree, 8 * tree),
        faces=send(tree, BYTES_PER_FORCE * found.face_nodes),
        row=send(2 * tree, BYTES_PER_BLOCK * found.blocks + BYTES_PER_CHUNK * nodes / CHUNK),
        all_nodes=send(2 * tree, BYTES_PER_NODE * nodes),
    )


def side(tetrahedra):
    """Cubes of six tetrahedra along an edge."""
    return max(round((tetrahedra / 6) ** (1 / 3)), 1)


def scaled_counts(ranks, cells, largest, most=100):
    """Counts of many processes. Cubes beyond `largest` are counted with smaller shares, whose surface grows as a surface does; the surface of a
    share does not grow further beyond `most` of them, where most have neighbours all around."""
    counted = min(ranks, most)
    n = side(min(cells * counted, largest))
    found = counts(n, counted)
    surface = (cells * counted / (6 * n**3)) ** (2 / 3)
    volume = cells * ranks / (6 * n**3)
    return found._replace(
        blocks=round(found.blocks * volume),
        nodes=round(found.nodes * surface),
        sums=round(found.sums * surface),
        face_nodes=round(found.face_nodes * volume ** (2 / 3)),
    )


KNOWN = {}


def counts(n, ranks):
    """Divides a cube of n^3 cubes of six tetrahedra as the program does, and counts what processes share."""
    if (n, ranks) not in KNOWN:
        KNOWN[n, ranks] = count_cube(n, ranks)
    return KNOWN[n, ranks]


def count_cube(n, ranks):
    block_of_slot, node_of_slot, first = divide(n, ranks)
    count = (n + 1) ** 3
    rank_of_slot = np.searchsorted(first, block_of_slot, side="right") - 1
    rank_and_node = np.unique(node_of_slot * ranks + rank_of_slot)
    node, rank = np.divmod(rank_and_node, ranks)
    ranks_of_node = np.bincount(node, minlength=count)
    shared = ranks_of_node[node] > 1
    nodes = np.bincount(rank[shared], minlength=ranks)
    others = ranks_of_node[node_of_slot] - 1
    sent = np.bincount(rank_of_slot, weights=others, minlength=ranks).astype(int)
    # A process gets what all have of its nodes, but its own.
    slots_of_node = np.bincount(node_of_slot, minlength=count)
    received = np.bincount(rank, weights=slots_of_node[node], minlength=ranks).astype(int) - np.bincount(rank_of_slot, minlength=ranks)
    pairs = [np.zeros(0, int)]
    node, rank = node[shared], rank[shared]
    for apart in range(1, ranks_of_node.max()):
        same = node[apart:] == node[:-apart]
        pairs += [rank[apart:][same] * ranks + rank[:-apart][same], rank[:-apart][same] * ranks + rank[apart:][same]]
    neighbours = np.bincount(np.unique(np.concatenate(pairs)) // ranks, minlength=ranks)
    on_face = np.arange(count) // (n + 1) ** 2 == n
    # Process 0 of the case of ranks.py: all nodes of the loaded face are moved by every process, those of the held one by the processes around them. It
    # tells the forces on nodes of the face that it has.
    mine = rank_of_slot == 0
    own = np.zeros(count, bool)
    own[node_of_slot[mine]] = True
    by_others = np.zeros(count, bool)
    by_others[node_of_slot[~mine]] = True
    told = BYTES_PER_SUM * others[mine].sum() + BYTES_PER_FORCE * (own & on_face).sum()
    log = f"process 0 of {ranks}: {first[1]} blocks, {(own | on_face).sum()} nodes, {(own & by_others).sum()} shared, {told} bytes"
    return Counts(int(first[-1]), int(neighbours.max()), int(nodes.max()), int(max(sent.max(), received.max())), int(on_face.sum()), log)


def divide(n, ranks):
    """Blocks of edges with their tetrahedra around them: block and node of every slot, and the first block of each process."""
    at = np.arange(n)
    corner = ((at[:, None, None] * (n + 1) + at[:, None]) * (n + 1) + at).ravel()
    stride = np.array([sum(s for bit, s in ((1, (n + 1) ** 2), (2, n + 1), (4, 1)) if way & bit) for way in range(8)])
    # An edge leads from its lower node along some of the axes: it is named by both.
    tetrahedra = [np.cumsum([0, *way]) for way in WAYS]
    edges_of = lambda ways: [(corner + stride[ways[a]]) * 8 + (ways[b] - ways[a]) for a in range(4) for b in range(a + 1, 4)]
    around = np.zeros(8 * (n + 1) ** 3, np.int8)
    for ways in tetrahedra:
        for edge in edges_of(ways):
            around[edge] += 1
    edges = np.flatnonzero(around)
    node, way = np.divmod(edges, 8)
    x, rest = np.divmod(node, (n + 1) ** 2)
    y, z = np.divmod(rest, n + 1)
    middles = [2 * x + (way & 1), 2 * y + (way >> 1 & 1), 2 * z + (way >> 2)]
    order = np.argsort(hilbert_index([(m * ((2**BITS - 1) / (2 * n))).astype(np.uint32) for m in middles]), kind="stable")
    block_of_edge = np.zeros(len(around), np.int32)
    block_of_edge[edges[order]] = np.arange(len(edges)) // BLOCK_CELLS
    # The ring around an edge has as many nodes as tetrahedra, one more at the surface, which is left out.
    weights = np.add.reduceat(around[edges[order]].astype(np.int64) + 1, np.arange(0, len(edges), BLOCK_CELLS))
    keys = [np.zeros(0, np.int64)]
    for ways in tetrahedra:
        blocks = [block_of_edge[edge] for edge in edges_of(ways)]
        for k, block in enumerate(blocks):
            new = np.logical_and.reduce([block != before for before in blocks[:k]]) if k else np.ones(len(block), bool)
            keys += [block[new].astype(np.int64) * (n + 1) ** 3 + corner[new] + stride[at] for at in ways]
        keys = [np.unique(np.concatenate(keys))]
    block_of_slot, node_of_slot = np.divmod(keys[0], (n + 1) ** 3)
    if np.bincount(block_of_slot).max() > BLOCK_NODES:
        raise SystemExit("the program would halve a block of this cube")
    return block_of_slot, node_of_slot, runs_of_blocks(weights, ranks)


def runs_of_blocks(weights, ranks):
    """First block of each process, and the end: a block goes where its middle lies."""
    middles = np.cumsum(weights) - weights / 2
    inner = np.searchsorted(middles, weights.sum() * np.arange(1, ranks) / ranks)
    return np.array([0, *inner, len(weights)])


def hilbert_index(cell):
    """As in crates/fractum-mesh/src/renumber.rs."""
    x = [axis.copy() for axis in cell]
    level = 1 << (BITS - 1)
    while level > 1:
        below = np.uint32(level - 1)
        for axis in range(3):
            set_ = np.where(x[axis] & np.uint32(level), below, np.uint32(0))
            swap = (x[0] ^ x[axis]) & below & ~set_
            x[0] = x[0] ^ (swap | set_)
            x[axis] = x[axis] ^ swap
        level >>= 1
    x[1] = x[1] ^ x[0]
    x[2] = x[2] ^ x[1]
    flip = np.zeros_like(x[0])
    level = 1 << (BITS - 1)
    while level > 1:
        flip ^= np.where(x[2] & np.uint32(level), np.uint32(level - 1), np.uint32(0))
        level >>= 1
    key = np.zeros(len(flip), np.uint64)
    for bit in range(BITS - 1, -1, -1):
        for axis in x:
            key = key << np.uint64(1) | ((axis ^ flip) >> np.uint32(bit) & np.uint32(1)).astype(np.uint64)
    return key


def measure(program, n, rounds=5):
    """Least time per tetrahedron and step of one process with one thread [s]."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_cube(folder, n)
        times = []
        for _ in range(rounds):
            results = folder / "results"
            run([program, "run", folder / "case.toml", "-o", results, "--overwrite", "--quiet", "--threads", 1])
            summary = json.loads((results / "summary.json").read_text())
            phases = summary["wall"]["phases"]
            times.append((sum(phases.values()) - phases["output"]) / summary["time"]["steps"])
    return min(times) / (6 * n**3)


def measure_memory(program, n=44):
    """Memory of a process beside the one that writes results, by a cube on two and on four processes less a small one."""
    def peak(n, count):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            write_cube(folder, n)
            return 2**20 * peaks(program, folder, count)[-1]

    program_alone, two, four = peak(4, 2), peak(n, 2), peak(n, 4)
    divided, cells = 4 * (two - four), 6 * n**3
    return Memory((two - 0.5 * divided - program_alone) / cells, divided / cells)


def write_cube(folder, n):
    box = f"from ranks import write_box; write_box({str(folder / 'cube.msh')!r}, ({n},) * 3, (1.0,) * 3)"
    subprocess.run([sys.executable, "-c", box], cwd=pathlib.Path(__file__).parent, check=True)
    (folder / "case.toml").write_text(CASE)


def between_two(latency, bandwidth):
    """Latency [s] and bandwidth [B/s] between two processes, and where they are from."""
    source = "given"
    if latency is None or bandwidth is None:
        source = "assumed: no MPI here"
        found = (1.0, 5.0)
        if shutil.which("mpicc") and shutil.which("mpirun"):
            with tempfile.TemporaryDirectory() as folder:
                pathlib.Path(folder, "ping.c").write_text(PING)
                subprocess.run(["mpicc", "-O2", "ping.c", "-o", "ping"], cwd=folder, check=True)
                out = subprocess.run([*MPIRUN, "2", "./ping"], cwd=folder, check=True, capture_output=True, text=True).stdout
            short, long = map(float, out.split())
            found, source = (1e6 * short, 1e-9 * 2**20 / (long - short)), "least of ten, two processes of this machine that send to each other"
        latency, bandwidth = (given or own for given, own in zip((latency, bandwidth), found))
    return 1e-6 * latency, 1e9 * bandwidth, source


if __name__ == "__main__":
    main()
