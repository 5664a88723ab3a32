"""Meshes of triangles as gmsh 2.2 has them in binary: what disk_mesh.py, cylinder_mesh.py and background_mesh.py write."""
import sys
from struct import pack


def write(name, nodes, triangles, lines=None):
    """To standard output: nodes (x, y) in metres, triangles of numbers of nodes from 0 on, all of the physical group `name`.

    lines: {NAME: [(a, b), ..]} edges of physical groups of their own."""
    out = sys.stdout.buffer
    lines = lines or {}
    out.write(b"$MeshFormat\n2.2 1 8\n" + pack("<i", 1) + b"\n$EndMeshFormat\n")
    out.write(b'$PhysicalNames\n%d\n2 1 "%s"\n' % (1 + len(lines), name.encode()))
    for group, called in enumerate(lines, 2):
        out.write(b'1 %d "%s"\n' % (group, called.encode()))
    out.write(b"$EndPhysicalNames\n$Nodes\n%d\n" % len(nodes))
    for n, (x, y) in enumerate(nodes, 1):
        out.write(pack("<iddd", n, x, y, 0))
    out.write(b"\n$EndNodes\n$Elements\n%d\n" % (len(triangles) + sum(map(len, lines.values()))))
    out.write(pack("<iii", 2, len(triangles), 2))
    for e, corners in enumerate(triangles, 1):
        out.write(pack("<6i", e, 1, 1, *(c + 1 for c in corners)))
    e = len(triangles)
    for group, edges in enumerate(lines.values(), 2):
        out.write(pack("<iii", 1, len(edges), 2))
        for e, ends in enumerate(edges, e + 1):
            out.write(pack("<5i", e, group, group, *(c + 1 for c in ends)))
    out.write(b"\n$EndElements\n")
