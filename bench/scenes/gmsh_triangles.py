"""Meshes of triangles as gmsh 2.2 has them in binary: what disk_mesh.py and background_mesh.py write."""
import sys
from struct import pack


def write(name, nodes, triangles):
    """To standard output: nodes (x, y) in metres, triangles of numbers of nodes from 0 on, all of the physical group `name`."""
    out = sys.stdout.buffer
    out.write(b"$MeshFormat\n2.2 1 8\n" + pack("<i", 1) + b"\n$EndMeshFormat\n")
    out.write(b'$PhysicalNames\n1\n2 1 "%s"\n$EndPhysicalNames\n' % name.encode())
    out.write(b"$Nodes\n%d\n" % len(nodes))
    for n, (x, y) in enumerate(nodes, 1):
        out.write(pack("<iddd", n, x, y, 0))
    out.write(b"\n$EndNodes\n$Elements\n%d\n" % len(triangles) + pack("<iii", 2, len(triangles), 2))
    for e, corners in enumerate(triangles, 1):
        out.write(pack("<6i", e, 1, 1, *(c + 1 for c in corners)))
    out.write(b"\n$EndElements\n")
